// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes sampled on grids.

use palpate::field::{Shape, Vector};
use palpate::grid::{Grid, GridKernel, GridOptions, Lattice, Resolution, Store};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::{Numbers, misshapen, numbers};
use crate::call::detached_in;
use crate::error::OrRaise;
use crate::interrupt::{interruptible, unless_asked};
use crate::pool;
use crate::poses::point;
use crate::shape::{PyShape, of_either};

/// The nodes of a grid that scenes bake.
pub(crate) const MOST_NODES: usize = 1 << 25;

/// More nodes are a mistake.
const MOST_EVER: usize = 1 << 31;

#[pymethods]
impl PyShape {
    /// This shape sampled on a grid, a shape of its own: a distance and a gradient then take the same short time
    /// everywhere, whatever this shape costs.
    ///
    /// Either `tolerance` says how far values near the surface may be off those of this shape [m], which is certified,
    /// or `cell` how far samples are apart [m]; `promise.deviation` has what was reached. `kernel` is "quadratic",
    /// smooth, to be touched, or "trilinear"; `store` "f32", "i16" or "i8"; `band` keeps only what lies within so many
    /// cells of the surface. More than `most_nodes` samples are refused, 33 554 432 if left out; a grid of more than that
    /// cannot be pickled, nor stand in a scene file. `threads` share the
    /// work, 0 for all processors; the bits do not depend on how many.
    ///
    /// Raises `GridError` if the shape has no bounds, a value is not finite or the grid would take too much memory,
    /// `TypeError` unless one of `tolerance` and `cell` is given.
    ///
    /// >>> import palpate as pp
    /// >>> grid = pp.ball(0.05).baked(tolerance=2e-4)
    /// >>> grid.promise.deviation.value <= 2e-4, bool(abs(grid.distance([0.06, 0, 0]) - 0.01) <= 2e-4)
    /// (True, True)
    #[pyo3(signature = (*, tolerance = None, cell = None, kernel = "quadratic", store = "f32", band = None, most_nodes = None, threads = 1))]
    fn baked(
        &self,
        py: Python<'_>,
        tolerance: Option<f64>,
        cell: Option<f64>,
        kernel: &str,
        store: &str,
        band: Option<f64>,
        most_nodes: Option<usize>,
        threads: isize,
    ) -> PyResult<Self> {
        let resolution = match (tolerance, cell) {
            (Some(tolerance), None) => Resolution::Tolerance(tolerance),
            (None, Some(cell)) => Resolution::Cell(cell),
            _ => {
                let problem = "one of tolerance= and cell= must be given";
                return Err(PyTypeError::new_err(problem));
            }
        };
        let mut options = GridOptions::with_resolution(resolution);
        options.kernel = named("kernel", kernel, GridKernel::ALL.map(|own| (own.name(), own)))?;
        options.store = named("store", store, Store::ALL.map(|own| (own.name(), own)))?;
        options.band = band;
        options.most_nodes = most_nodes.unwrap_or(MOST_NODES);
        if options.most_nodes > MOST_EVER {
            let problem =
                format!("most_nodes must be at most {MOST_EVER}, got {}", options.most_nodes);
            return Err(PyValueError::new_err(problem));
        }
        of_either!(self.made(py)?, shape => Ok(baked(py, shape, &options, threads)?.into()))
    }
}

/// A shape of samples at the nodes of a lattice: an array with an axis for each dimension [m], negative inside and
/// positive in the two outer layers.
///
/// `cell` is how far nodes are apart [m], `origin` the place of the first one, 0 if left out. `kernel` is "trilinear",
/// which goes through the samples, or "quadratic", a spline with the samples as coefficients: smooth, to be touched, and
/// it rounds them off. Samples are kept in single precision: the field's steepness comes from them, how far its values
/// are off distances is not known.
///
/// Raises `GridError` if a value at the border is not positive or one is not finite, `ValueError` if there are not two
/// or three axes.
///
/// >>> import palpate as pp, numpy as np
/// >>> x, y, z = np.meshgrid(*[np.linspace(-1, 1, 41)] * 3, indexing="ij")
/// >>> ball = pp.from_samples(np.sqrt(x * x + y * y + z * z) - 0.5, cell=0.05, origin=[-1, -1, -1])
/// >>> bool(abs(ball.distance([0.7, 0, 0]) - 0.2) < 0.005), ball.promise.outside
/// (True, 'lipschitz')
#[pyfunction]
#[pyo3(signature = (samples, *, cell, origin = None, kernel = "quadratic"))]
pub(crate) fn from_samples(
    samples: &Bound<'_, PyAny>,
    cell: f64,
    origin: Option<&Bound<'_, PyAny>>,
    kernel: &str,
) -> PyResult<PyShape> {
    let kernel = named("kernel", kernel, GridKernel::ALL.map(|own| (own.name(), own)))?;
    let (array, counts) = along_the_first(samples)?;
    let values = array.as_doubles()?;
    match counts[..] {
        [n, m] => of_samples([n, m], &values, cell, origin, kernel, samples.py()),
        [n, m, k] => of_samples([n, m, k], &values, cell, origin, kernel, samples.py()),
        _ => Err(misshapen("samples", "(n, m) or (n, m, k)", &counts)),
    }
}

/// The samples of an array along its first axis first, as the core wants them, and its shape.
pub(crate) fn along_the_first<'py>(
    samples: &Bound<'py, PyAny>,
) -> PyResult<(Numbers<'py>, Vec<usize>)> {
    let turned = samples.py().import("numpy")?.call_method1("transpose", (samples,))?;
    let array = numbers(&turned, "samples")?;
    let counts = array.shape().iter().rev().copied().collect();
    Ok((array, counts))
}

fn of_samples<const D: usize>(
    counts: [usize; D],
    values: &[f64],
    cell: f64,
    origin: Option<&Bound<'_, PyAny>>,
    kernel: GridKernel,
    py: Python<'_>,
) -> PyResult<PyShape>
where
    PyShape: From<Shape<D>>,
{
    let origin = origin.map_or_else(|| Ok(Vector::ZERO), |origin| point(origin, "origin"))?;
    let lattice = Lattice { origin, cell, counts };
    let pool = pool::of_at_least_one(1)?;
    let work = || Grid::from_samples(lattice, values, kernel, Store::F32);
    let grid = detached_in(py, &pool, work)?.or_raise(py)?;
    Ok(Shape::from(grid).into())
}

fn baked<const D: usize>(
    py: Python<'_>,
    shape: &Shape<D>,
    options: &GridOptions,
    threads: isize,
) -> PyResult<Shape<D>> {
    let pool = pool::of_at_least_one(threads)?;
    let made = interruptible(py, &pool, |stop| {
        Grid::bake_with(shape, options, &|_| unless_asked(stop))
    })?;
    Ok(made.or_raise(py)?.into())
}

/// What a name stands for.
pub(crate) fn named<T: Copy, const N: usize>(
    what: &str,
    name: &str,
    known: [(&str, T); N],
) -> PyResult<T> {
    let found = known.iter().find(|(own, _)| *own == name);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names = known.map(|(own, _)| format!("{own:?}")).join(", ");
        PyValueError::new_err(format!("{what} must be one of {names}, got {name:?}"))
    })
}
