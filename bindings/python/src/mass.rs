// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Mass, and meshes of shapes.

use palpate::field::{Mass, MassLimits};
use palpate::mesh::{ContourOptions, MOST_TRIANGLES};
use pyo3::prelude::*;

use crate::answers::Fields;
use crate::arrays::table;
use crate::error::OrRaise;
use crate::interrupt::abandonable;
use crate::mesh::{self, PyMesh};
use crate::shape::{AnyShape, PyShape};

#[pymethods]
impl PyShape {
    /// The mass at a density [kg/m³], in the plane [kg/m²], with centroid and moments, and bounds on their errors.
    ///
    /// Cells are cut until the error of the volume is below `tolerance`, a share of it, 1e-3 if left out, or there are
    /// `cells` of them, 3 000 000 if left out. After Ctrl-C they are cut on in a thread that nobody waits for.
    ///
    /// Raises `ShapeError` if the shape has no bounds, or the density or the tolerance is not positive.
    ///
    /// >>> import palpate as pp, math
    /// >>> mass = pp.ball(0.5).mass(density=1000)
    /// >>> abs(mass.volume - math.pi / 6) <= mass.volume_error <= 1e-3 * mass.volume
    /// True
    #[pyo3(signature = (density = 1000.0, *, tolerance = None, cells = None))]
    fn mass<'py>(
        &self,
        py: Python<'py>,
        density: f64,
        tolerance: Option<f64>,
        cells: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let usual = MassLimits::default();
        let limits = MassLimits {
            tolerance: tolerance.unwrap_or(usual.tolerance),
            cells: cells.unwrap_or(usual.cells),
        };
        match self.made(py)?.clone() {
            AnyShape::Planar(shape) => {
                let found =
                    abandonable(py, move || shape.mass(density, limits))?.or_raise(py)?;
                told(py, &found)?.with("inertia", found.polar_inertia())?.of_class("Mass")
            }
            AnyShape::Spatial(shape) => {
                let found =
                    abandonable(py, move || shape.mass(density, limits))?.or_raise(py)?;
                let inertia = table(py, found.inertia().concat(), 3)?;
                told(py, &found)?.with("inertia", inertia)?.of_class("Mass")
            }
        }
    }

    /// The surface in triangles, closed, facing outwards, with sharp edges; of shapes in space.
    ///
    /// Either `cell` is the size of the cells [m]: parts thinner than two may be lost. Or `tolerance` is how large the
    /// field on a triangle may be [m], of an exact shape how far a triangle may be from the surface: triangles are
    /// as large as that allows, which is proven. `most_triangles`, ten million if left out, refuses larger meshes.
    ///
    /// Raises `MeshError` if the shape has no bounds, no cell sees the surface, the tolerance is not reached or the
    /// triangles are too many, `TypeError` unless one of `cell` and `tolerance` is given.
    ///
    /// >>> import palpate as pp
    /// >>> mesh = pp.cuboid([0.3, 0.2, 0.1]).mesh(cell=0.017)
    /// >>> mesh.is_watertight, round(mesh.report().enclosed, 9)
    /// (True, 0.006)
    /// >>> near = pp.ball(0.5).mesh(tolerance=1e-3)
    /// >>> bool(abs(pp.ball(0.5).distance(near.vertices)).max() <= 1e-3)
    /// True
    #[pyo3(signature = (*, cell = None, tolerance = None, most_triangles = None))]
    fn mesh(
        &self,
        py: Python<'_>,
        cell: Option<f64>,
        tolerance: Option<f64>,
        most_triangles: Option<usize>,
    ) -> PyResult<PyMesh> {
        let most_triangles = most_triangles.unwrap_or(MOST_TRIANGLES);
        let of = |cell| ContourOptions { most_triangles, ..ContourOptions::with_cell(cell) };
        mesh::of_shape(
            py,
            &self.solid(py, "mesh")?,
            cell.map(of),
            tolerance.map(|t| (t, of(f64::INFINITY))),
        )
    }
}

fn told<'py, const D: usize>(py: Python<'py>, found: &Mass<D>) -> PyResult<Fields<'py>> {
    Fields::of(py, found)?.with("mass", found.mass())?.with("mass_error", found.mass_error())
}
