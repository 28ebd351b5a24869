// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The class `Mesh`: triangles in space, and outlines of segments in the plane.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use palpate::field::{Aabb, Point, Pose, Shape, Vector};
use palpate::grid::{Inside, Volume};
use palpate::mesh::{
    ContourOptions, FittedMesh, Format, Mesh, MeshSheet, Outline, Report, Solid, TriangleMesh,
    read_file,
};
use palpate::query::{ElementMemory, PlacedMesh, Query, Undecided};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::answers::{self, Fields};
use crate::arrays::{misshapen, numbers, row, table};
use crate::ending::detach;
use crate::error::OrRaise;
use crate::grid::{along_the_first, named};
use crate::interrupt::{abandonable, interruptible, unless_asked};
use crate::pool;
use crate::poses;
use crate::query::query;
use crate::shape::{AnyShape, PyShape};

/// A mesh in the plane or in space.
enum AnyMesh {
    Planar(Arc<Outline>),
    Spatial(Arc<TriangleMesh>),
}

impl From<Outline> for AnyMesh {
    fn from(mesh: Outline) -> Self {
        Self::Planar(Arc::new(mesh))
    }
}

impl From<TriangleMesh> for AnyMesh {
    fn from(mesh: TriangleMesh) -> Self {
        Self::Spatial(Arc::new(mesh))
    }
}

/// Does the same with a mesh of either dimension.
macro_rules! of_either {
    ($any:expr, $mesh:ident => $done:expr) => {
        match $any {
            AnyMesh::Planar($mesh) => $done,
            AnyMesh::Spatial($mesh) => $done,
        }
    };
}

/// Triangles in space, or segments in the plane.
///
/// Vertices are an array of shape (n, D) [m], faces one of shape (m, D) with the numbers of their vertices from 0, in an
/// order in which the solid is on the left in the plane, and normals lead out of it in space. A mesh of another library
/// can be given instead if it has `vertices` and `faces`, as those of trimesh have.
///
/// >>> import palpate as pp
/// >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
/// >>> mesh = pp.Mesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
/// >>> mesh.is_watertight, mesh.shape().distance([0.2, 0.2, -0.5])
/// (True, 0.5)
#[pyclass(frozen, module = "palpate", name = "Mesh")]
pub(crate) struct PyMesh(AnyMesh);

#[pymethods]
impl PyMesh {
    #[new]
    #[pyo3(signature = (vertices, faces = None))]
    fn new(vertices: &Bound<'_, PyAny>, faces: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let Some(faces) = faces else {
            let has = |name| vertices.hasattr(name);
            if !(has("vertices")? && has("faces")?) {
                let kind = vertices.get_type().name()?;
                let problem = format!(
                    "a mesh has vertices and faces, got a {kind}: files are read by Mesh.load"
                );
                return Err(PyTypeError::new_err(problem));
            }
            let (vertices, faces) = (vertices.getattr("vertices")?, vertices.getattr("faces")?);
            return Self::new(&vertices, Some(&faces));
        };
        let points = numbers(vertices, "vertices")?;
        match points.shape() {
            [_, 2] => Ok(Self(of_arrays::<2, 2>(vertices, faces)?.into())),
            [_, 3] => Ok(Self(of_arrays::<3, 3>(vertices, faces)?.into())),
            shape => Err(misshapen("vertices", "(n, 2) or (n, 3)", shape)),
        }
    }

    /// Reads triangles from a file of OBJ, STL, PLY or GLB, with coordinates in metres; `scale` is the length of
    /// another unit of the file [m], 0.001 for millimetres.
    ///
    /// Raises `MissingFileError` if there is no such file, `MeshError` if it holds no mesh.
    ///
    /// >>> import palpate as pp, tempfile, os
    /// >>> file = os.path.join(tempfile.mkdtemp(), "cube.stl")
    /// >>> pp.cuboid([1, 1, 1]).mesh(cell=0.3).save(file)
    /// >>> pp.Mesh.load(file).is_watertight
    /// True
    #[staticmethod]
    #[pyo3(signature = (file, *, scale = 1.0))]
    fn load(py: Python<'_>, file: PathBuf, scale: f64) -> PyResult<Self> {
        let mesh = detach(py, || read_file(&file)).or_raise(py)?;
        let mesh = if scale == 1.0 { mesh } else { mesh.scaled(scale).or_raise(py)? };
        Ok(Self(mesh.into()))
    }

    /// The surface where samples of a scanner have a value, an array of shape (n, m, k); closed, around the samples above
    /// it, or below it if `inside` is "below". What the array cuts off is closed half a step beyond its border.
    ///
    /// `spacing` is how far samples are apart along each axis [m], one number or three; `origin` where the first one is,
    /// 0 if left out. The values are no distances: of `shape()` the distance to the surface is known, the surface itself
    /// to about a step. Samples are kept in single precision. Files of scanners are in `Scene` files, as `volume`.
    ///
    /// Raises `GridError` if no surface has the value, a sample is not finite or an axis has fewer than two, `ValueError`
    /// if an array has another shape.
    ///
    /// >>> import palpate as pp, numpy as np
    /// >>> x, y, z = np.meshgrid(*[np.linspace(-1, 1, 41)] * 3, indexing="ij")
    /// >>> mesh = pp.Mesh.of_volume(1000 * np.exp(-(x * x + y * y + z * z)), 700, spacing=0.05, origin=[-1, -1, -1])
    /// >>> bool(abs(np.linalg.norm(mesh.vertices, axis=1) - np.sqrt(-np.log(0.7))).max() < 0.01)
    /// True
    #[staticmethod]
    #[pyo3(signature = (samples, value, *, spacing, origin = None, inside = "above"))]
    fn of_volume(
        samples: &Bound<'_, PyAny>,
        value: f64,
        spacing: &Bound<'_, PyAny>,
        origin: Option<&Bound<'_, PyAny>>,
        inside: &str,
    ) -> PyResult<Self> {
        let py = samples.py();
        let inside = named("inside", inside, Inside::ALL.map(|own| (own.name(), own)))?;
        let sides: [f64; 3] = match spacing.extract::<f64>() {
            Ok(side) => [side; 3],
            Err(_) => poses::point::<3>(spacing, "spacing")?.0,
        };
        let steps = std::array::from_fn(|axis| Vector::unit(axis) * sides[axis]);
        let origin =
            origin.map_or(Ok(Vector::ZERO), |origin| poses::point(origin, "origin"))?;
        if let Some(axis) = sides.iter().position(|side| !(*side > 0.0 && side.is_finite())) {
            let side = sides[axis];
            let problem = format!("spacing[{axis}] must be positive and finite, got {side} m");
            return Err(PyValueError::new_err(problem));
        }
        let (array, counts) = along_the_first(samples)?;
        let [n, m, k] = counts[..] else {
            return Err(misshapen("samples", "(n, m, k)", &counts));
        };
        let values = array.as_doubles()?.iter().map(|sample| *sample as f32).collect();
        let volume = Volume::new([n, m, k], origin, steps, values).or_raise(py)?;
        let volume = volume.with_inside(inside);
        let mesh = abandonable(py, move || volume.surface(value))?.or_raise(py)?;
        Ok(Self(mesh.into()))
    }

    /// Writes triangles to a file of OBJ, STL, PLY or GLB, by its ending. A file that is there is replaced when the
    /// new one is whole.
    ///
    /// Raises `ValueError` if the ending is none of these, `OSError` if the file cannot be written.
    ///
    /// >>> import palpate as pp, tempfile, os
    /// >>> pp.ball(0.5).mesh(cell=0.1).save(os.path.join(tempfile.mkdtemp(), "ball.ply"))
    fn save(&self, py: Python<'_>, file: PathBuf) -> PyResult<()> {
        let AnyMesh::Spatial(mesh) = &self.0 else {
            return Err(PyValueError::new_err(
                "outlines have no files: save a mesh of triangles",
            ));
        };
        let format = Format::of(&file).ok_or_else(|| {
            PyValueError::new_err("the name of a mesh must end in .obj, .stl, .ply or .glb")
        })?;
        let mut bytes = Vec::new();
        detach(py, || mesh.write(format, &mut bytes))?;
        replace(py, &file, &bytes)
    }

    /// 2 in the plane, 3 in space.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).mesh(cell=0.1).dimension
    /// 3
    #[getter]
    fn dimension(&self) -> usize {
        match self.0 {
            AnyMesh::Planar(_) => 2,
            AnyMesh::Spatial(_) => 3,
        }
    }

    /// The vertices [m], shape (n, D).
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).mesh(cell=0.1).vertices.shape[1]
    /// 3
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_either!(&self.0, mesh => rows(py, mesh.vertices()))
    }

    /// The numbers of the vertices of each triangle or segment, shape (m, D).
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).mesh(cell=0.1).faces.dtype
    /// dtype('uint32')
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_either!(&self.0, mesh => {
            let columns = mesh.elements().first().map_or(self.dimension(), |e| e.len());
            let numbers: Vec<u32> = mesh.elements().iter().flatten().copied().collect();
            row(py, numbers).call_method1("reshape", (mesh.elements().len(), columns))
        })
    }

    /// Whether each edge has two triangles, or each vertex two segments, that agree on the inside.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).mesh(cell=0.1).is_watertight
    /// True
    #[getter]
    fn is_watertight(&self, py: Python<'_>) -> bool {
        of_either!(&self.0, mesh => detach(py, || mesh.report()).is_watertight())
    }

    /// What the mesh is: counts of what is wrong with it, its surface and what it encloses.
    ///
    /// >>> import palpate as pp
    /// >>> report = pp.cuboid([1, 1, 1]).mesh(cell=0.3).report()
    /// >>> report.boundary, round(report.enclosed, 6)
    /// (0, 1.0)
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_either!(&self.0, mesh => report(py, &detach(py, || mesh.report())))
    }

    /// The solid that the mesh bounds, as a shape: the distance to the nearest face, negative inside.
    ///
    /// What is wrong is mended, and `findings` says in words what was. Faces that bound no solid are refused; with a
    /// `thickness` [m] they are a plate. Corners at open edges are joined where that closes edges: those that are equal
    /// up to rounding, or those at most `weld_within` apart [m].
    ///
    /// Raises `MeshError` if the mesh bounds no solid, or `weld_within` is more than half of an edge.
    ///
    /// >>> import palpate as pp
    /// >>> solid = pp.ball(0.5).mesh(cell=0.05).shape()
    /// >>> solid.promise.outside, bool(abs(solid.distance([0, 1, 0]) - 0.5) < 0.01)
    /// ('exact', True)
    #[pyo3(signature = (*, thickness = None, weld_within = None))]
    fn shape(
        &self,
        py: Python<'_>,
        thickness: Option<f64>,
        weld_within: Option<f64>,
    ) -> PyResult<PyShape> {
        if thickness.is_some() && weld_within.is_some() {
            return Err(PyValueError::new_err(
                "a plate takes its faces as they are: leave weld_within or thickness out",
            ));
        }
        of_either!(&self.0, mesh => {
            let mesh = Arc::clone(mesh);
            match thickness {
                None => {
                    let work = move || match weld_within {
                        None => Solid::from_mesh(&mesh),
                        Some(within) => Solid::from_mesh_within(&mesh, within),
                    };
                    Ok(Shape::from(abandonable(py, work)?.or_raise(py)?.0).into())
                }
                Some(thickness) => {
                    let work = move || MeshSheet::from_mesh(&mesh, thickness);
                    Ok(Shape::from(abandonable(py, work)?.or_raise(py)?).into())
                }
            }
        })
    }

    /// What is found and mended where the mesh becomes a solid, in words; nothing if it is one as it is.
    ///
    /// Raises `MeshError` if the mesh bounds no solid.
    ///
    /// >>> import palpate as pp
    /// >>> mesh = pp.ball(0.5).mesh(cell=0.1)
    /// >>> mesh.findings(), pp.Mesh(mesh.vertices, mesh.faces[1:]).findings()[:9]
    /// ('', '1 opening')
    fn findings(&self, py: Python<'_>) -> PyResult<String> {
        of_either!(&self.0, mesh => {
            let mesh = Arc::clone(mesh);
            let solid = abandonable(py, move || Solid::from_mesh(&mesh))?.or_raise(py)?;
            Ok(solid.1.to_string())
        })
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        of_either!(&self.0, mesh => {
            format!("<palpate.Mesh: {}>", detach(py, || mesh.report()))
        })
    }

    fn __len__(&self) -> usize {
        of_either!(&self.0, mesh => mesh.elements().len())
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let Ok(other) = other.cast::<Self>() else { return false };
        match (&self.0, &other.get().0) {
            (AnyMesh::Planar(one), AnyMesh::Planar(two)) => same(one, two),
            (AnyMesh::Spatial(one), AnyMesh::Spatial(two)) => same(one, two),
            _ => false,
        }
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, mesh) = (slf.py(), slf.get());
        let arrays = (mesh.vertices(py)?, mesh.faces(py)?);
        Ok((slf.get_type(), arrays).into_pyobject(py)?.into_any())
    }
}

fn report<'py, const D: usize>(
    py: Python<'py>,
    found: &Report<D>,
) -> PyResult<Bound<'py, PyAny>> {
    let Aabb { min, max } = found.bounds;
    Fields::new(py)
        .with("elements", found.elements)?
        .with("vertices", found.vertices)?
        .with("unreferenced", found.unreferenced)?
        .with("coincident", found.coincident)?
        .with("degenerate", found.degenerate)?
        .with("duplicates", found.duplicates)?
        .with("boundary", found.boundary)?
        .with("non_manifold", found.non_manifold)?
        .with("inconsistent", found.inconsistent)?
        .with("bounds", table(py, [min.0, max.0].concat(), D)?)?
        .with("surface", found.surface)?
        .with("enclosed", found.enclosed)?
        .with("is_watertight", found.is_watertight())?
        .with("in_words", found.to_string())?
        .of_class("MeshReport")
}

fn same<const N: usize, const D: usize>(one: &Mesh<N, D>, two: &Mesh<N, D>) -> bool {
    one.vertices() == two.vertices() && one.elements() == two.elements()
}

fn rows<'py, const D: usize>(
    py: Python<'py>,
    points: &[Point<D>],
) -> PyResult<Bound<'py, PyAny>> {
    table(py, points.iter().flat_map(|p| p.0).collect(), D)
}

/// A mesh of vertices and the numbers of those of each element.
fn of_arrays<const N: usize, const D: usize>(
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
) -> PyResult<Mesh<N, D>> {
    let py = vertices.py();
    let points = numbers(vertices, "vertices")?;
    let points: Vec<Point<D>> = points
        .as_doubles()?
        .chunks_exact(D)
        .map(|point| Vector(std::array::from_fn(|i| point[i])))
        .collect();
    let faces = numbers(faces, "faces")?;
    if !matches!(faces.shape(), [_, columns] if *columns == N) {
        return Err(misshapen("faces", &format!("(m, {N})"), faces.shape()));
    }
    let faces = faces.as_doubles()?;
    let is_number = |x: &f64| x.fract() == 0.0 && (0.0..4_294_967_296.0).contains(x);
    if let Some(place) = faces.iter().position(|x| !is_number(x)) {
        let problem = format!(
            "faces[{}, {}] must be the number of a vertex, from 0, got {}",
            place / N,
            place % N,
            faces[place]
        );
        return Err(PyValueError::new_err(problem));
    }
    let elements = faces.chunks_exact(N).map(|face| std::array::from_fn(|i| face[i] as u32));
    Mesh::new(points, elements.collect()).or_raise(py)
}

/// A mesh of a shape, by cells of a size or a tolerance [m].
pub(crate) fn of_shape(
    py: Python<'_>,
    shape: &Shape<3>,
    by_cells: Option<ContourOptions>,
    by_tolerance: Option<(f64, ContourOptions)>,
) -> PyResult<PyMesh> {
    let pool = pool::of_at_least_one(1)?;
    let mesh = match (by_cells, by_tolerance) {
        (Some(options), None) => {
            let made = interruptible(py, &pool, |stop| {
                TriangleMesh::of_shape_with(shape, &options, &mut |_| unless_asked(stop))
            })?;
            made.or_raise(py)?
        }
        (None, Some((tolerance, options))) => {
            let made = interruptible(py, &pool, |stop| {
                let mut progress = |_| unless_asked(stop);
                let fitted =
                    FittedMesh::by_tolerance(shape, tolerance, &options, &mut progress)?;
                fitted.within(tolerance)
            })?;
            made.or_raise(py)?
        }
        _ => {
            let problem = "one of cell= and tolerance= must be given";
            return Err(PyTypeError::new_err(problem));
        }
    };
    Ok(PyMesh(mesh.into()))
}

/// Writes a file beside the one that it then replaces.
pub(crate) fn replace(py: Python<'_>, file: &Path, bytes: &[u8]) -> PyResult<()> {
    py.import("palpate._files")?.call_method1("replace", (file, bytes))?;
    Ok(())
}

/// Does the same with a shape and a mesh of either dimension.
macro_rules! of_shape_and_mesh {
    ($py:expr, $of:expr, $with:expr, |$shape:ident, $mesh:ident| $done:expr) => {{
        let own = match $with.cast::<PyMesh>() {
            Ok(mesh) => mesh.clone(),
            Err(_) => Bound::new($py, PyMesh::new($with, None)?)?,
        };
        match ($of.made($py)?, &own.get().0) {
            (AnyShape::Planar($shape), AnyMesh::Planar($mesh)) => $done,
            (AnyShape::Spatial($shape), AnyMesh::Spatial($mesh)) => $done,
            (shape, _) => {
                let (shape, mesh) = (shape.dimension(), own.get().dimension());
                let problem = format!(
                    "shape and mesh must have the same dimension, got {shape}D and {mesh}D"
                );
                Err(PyValueError::new_err(problem))
            }
        }
    }};
}

/// Which elements of a mesh touch a shape, with the contacts on each; `gap` [m] is how near is near enough. The mesh is a
/// `Mesh`, or what has `vertices` and `faces`; `pose` is where it is, as of `Shape.placed`.
///
/// `tolerance` is how far apart the bounds may be [m], a ten-thousandth of the smaller body if left out; `budget` how
/// often the field is evaluated at most, 200 000 if left out.
///
/// Raises `QueryError` if the gap or the tolerance is negative, `ValueError` if the dimensions differ.
///
/// >>> import palpate as pp
/// >>> found = pp.mesh_contacts(pp.ball(0.5).translated([0, 0.95, 0]), pp.cuboid([1, 1, 1]).mesh(cell=0.3))
/// >>> len(found) > 0, bool(abs(found.contacts.gap.min() + 0.05) < 1e-3)
/// (True, True)
#[pyfunction]
#[pyo3(signature = (shape, mesh, *, pose = None, gap = 0.0, tolerance = None, budget = None))]
pub(crate) fn mesh_contacts<'py>(
    py: Python<'py>,
    shape: &PyShape,
    mesh: &Bound<'py, PyAny>,
    pose: Option<&Bound<'py, PyAny>>,
    gap: f64,
    tolerance: Option<f64>,
    budget: Option<u32>,
) -> PyResult<Bound<'py, PyAny>> {
    of_shape_and_mesh!(py, shape, mesh, |shape, mesh| {
        let pose = poses::or_identity(pose)?;
        contacts(py, shape, (mesh, pose), query(tolerance, budget).with_gap(gap))
    })
}

/// Which elements of a mesh touch a shape, without contacts: faster than `mesh_contacts`, whose arguments it has.
///
/// Raises `QueryError` if the gap is negative, `ValueError` if the dimensions differ.
///
/// >>> import palpate as pp
/// >>> mesh = pp.cuboid([1, 1, 1]).mesh(cell=0.3)
/// >>> len(pp.mesh_hits(pp.ball(0.5), mesh, pose=[0, 0.95, 0]).hits) > 0
/// True
#[pyfunction]
#[pyo3(signature = (shape, mesh, *, pose = None, gap = 0.0, tolerance = None, budget = None))]
pub(crate) fn mesh_hits<'py>(
    py: Python<'py>,
    shape: &PyShape,
    mesh: &Bound<'py, PyAny>,
    pose: Option<&Bound<'py, PyAny>>,
    gap: f64,
    tolerance: Option<f64>,
    budget: Option<u32>,
) -> PyResult<Bound<'py, PyAny>> {
    of_shape_and_mesh!(py, shape, mesh, |shape, mesh| {
        let (pose, shape, mesh) = (poses::or_identity(pose)?, shape.clone(), Arc::clone(mesh));
        let mut query = query(tolerance, budget).with_gap(gap);
        let work = move || query.mesh_hits(&shape, PlacedMesh::new(&mesh, pose));
        let found = abandonable(py, work)?.or_raise(py)?;
        hits(py, &found.hits, &found.undecided, found.evaluations)?.of_class("MeshHits")
    })
}

/// What both questions about meshes answer.
fn hits<'py>(
    py: Python<'py>,
    hits: &[u32],
    undecided: &[Undecided],
    evaluations: u32,
) -> PyResult<Fields<'py>> {
    Fields::new(py)
        .with("hits", row(py, hits.to_vec()))?
        .with("undecided", row(py, undecided.iter().map(|open| open.element).collect()))?
        .with("lower", row(py, undecided.iter().map(|open| open.lower).collect()))?
        .with("upper", row(py, undecided.iter().map(|open| open.upper).collect()))?
        .with("evaluations", evaluations)
}

fn contacts<'py, const N: usize, const D: usize>(
    py: Python<'py>,
    shape: &Shape<D>,
    (mesh, pose): (&Arc<Mesh<N, D>>, Pose<D>),
    mut query: Query<D>,
) -> PyResult<Bound<'py, PyAny>>
where
    Query<D>: ElementMemory<N, D>,
{
    let (shape, mesh) = (shape.clone(), Arc::clone(mesh));
    let work = move || query.mesh_contacts(&shape, PlacedMesh::new(&mesh, pose));
    let found = abandonable(py, work)?.or_raise(py)?;
    let all: Vec<_> = found.contacts.iter().map(|found| found.contact).collect();
    hits(py, &found.hits, &found.undecided, found.evaluations)?
        .with("contacts", answers::contacts(py, &all)?)?
        .with("elements", row(py, found.contacts.iter().map(|found| found.element).collect()))?
        .of_class("MeshContacts")
}
