// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where two shapes touch, and how far apart they are.

use palpate::field::Shape;
use palpate::query::{Manifold, ManifoldSettings, Query, Ray, Tolerance};
use pyo3::prelude::*;

use crate::answers::{Fields, contacts};
use crate::call::detached;
use crate::error::OrRaise;
use crate::poses;
use crate::shape::PyShape;

/// Does the same with two shapes of either dimension.
macro_rules! of_both {
    ($py:expr, $one:expr, $two:expr, |$a:ident, $b:ident| $done:expr) => {
        match ($one.made($py)?, $two.made($py)?) {
            ($crate::shape::AnyShape::Planar($a), $crate::shape::AnyShape::Planar($b)) => $done,
            ($crate::shape::AnyShape::Spatial($a), $crate::shape::AnyShape::Spatial($b)) => {
                $done
            }
            (one, two) => {
                let (one, two) = (one.dimension(), two.dimension());
                let problem =
                    format!("both shapes must have the same dimension, got {one}D and {two}D");
                Err(pyo3::exceptions::PyValueError::new_err(problem))
            }
        }
    };
}

pub(crate) use of_both;

/// A query with what a caller asks of its answers.
pub(crate) fn query<const D: usize>(tolerance: Option<f64>, budget: Option<u32>) -> Query<D> {
    let query = Query::new();
    let query = match tolerance {
        None => query,
        Some(length) => query.with_tolerance(Tolerance::Absolute(length)),
    };
    match budget {
        None => query,
        Some(budget) => query.with_budget(budget),
    }
}

/// How far apart two bodies are, between proven bounds. Of bodies that overlap it is minus the diameter of the largest
/// ball in both, and not the penetration; see `penetration`.
///
/// `tolerance` is how far apart the bounds may be [m], a ten-thousandth of the smaller body if left out; `budget` how
/// often the fields are evaluated at most, 200 000 if left out.
///
/// Raises `QueryError` if neither body has bounds or the tolerance is negative, `ValueError` if the shapes' dimensions
/// differ.
///
/// >>> import palpate as pp
/// >>> found = pp.separation(pp.ball(0.5), pp.ball(0.5).translated([1.5, 0, 0]), tolerance=1e-6)
/// >>> found.lower <= 0.5 <= found.upper, found.stop
/// (True, 'converged')
#[pyfunction]
#[pyo3(signature = (a, b, *, tolerance = None, budget = None))]
pub(crate) fn separation<'py>(
    py: Python<'py>,
    a: &PyShape,
    b: &PyShape,
    tolerance: Option<f64>,
    budget: Option<u32>,
) -> PyResult<Bound<'py, PyAny>> {
    of_both!(py, a, b, |a, b| {
        let found = detached(py, || query(tolerance, budget).separation(a, b))?.or_raise(py)?;
        Fields::of(py, &found)?.of_class("Separation")
    })
}

/// How far the second body must move to leave the first, by the shortest way, between proven bounds: zero if they are
/// apart or only touch.
///
/// No translation shorter than `lower` separates the bodies, and one of the length `upper` along `best.direction` does;
/// `upper` is infinite if none was found. Of convex bodies the bounds are as close as `tolerance`; of others the budget
/// may end first, as `stop` says.
///
/// `tolerance` is how far apart the bounds may be [m], a ten-thousandth of the smaller body if left out; `budget` how
/// often the fields are evaluated at most, 200 000 if left out.
///
/// Raises `QueryError` if neither body has bounds or the tolerance is negative, `ValueError` if the shapes' dimensions
/// differ.
///
/// >>> import palpate as pp
/// >>> found = pp.penetration(pp.cuboid([1, 1, 1]), pp.ball(0.1), tolerance=1e-4)
/// >>> found.lower <= 0.6 <= found.upper, found.stop
/// (True, 'converged')
#[pyfunction]
#[pyo3(signature = (a, b, *, tolerance = None, budget = None))]
pub(crate) fn penetration<'py>(
    py: Python<'py>,
    a: &PyShape,
    b: &PyShape,
    tolerance: Option<f64>,
    budget: Option<u32>,
) -> PyResult<Bound<'py, PyAny>> {
    of_both!(py, a, b, |a, b| {
        let found =
            detached(py, || query(tolerance, budget).penetration(a, b))?.or_raise(py)?;
        Fields::of(py, &found)?.of_class("PenetrationBounds")
    })
}

/// Whether two bodies overlap, proven. The answer is undecided if `budget` evaluations prove neither.
///
/// Raises `QueryError` if neither body has bounds, `ValueError` if the shapes' dimensions differ.
///
/// >>> import palpate as pp
/// >>> pp.overlap(pp.ball(0.5), pp.ball(0.5).translated([0.9, 0, 0])).overlaps
/// True
#[pyfunction]
#[pyo3(signature = (a, b, *, budget = None))]
pub(crate) fn overlap<'py>(
    py: Python<'py>,
    a: &PyShape,
    b: &PyShape,
    budget: Option<u32>,
) -> PyResult<Bound<'py, PyAny>> {
    of_both!(py, a, b, |a, b| {
        let found = detached(py, || query(None, budget).overlap(a, b))?.or_raise(py)?;
        Fields::of(py, &found)?.with("overlaps", found.is_hit())?.of_class("Overlap")
    })
}

/// The points at which two bodies are nearest to each other, or deepest in each other.
///
/// `tolerance` is how far apart the bounds may be [m], a ten-thousandth of the smaller body if left out; `budget` how
/// often the fields are evaluated at most, 200 000 if left out.
///
/// Raises `QueryError` if neither body has bounds or the tolerance is negative, `ValueError` if the shapes' dimensions
/// differ.
///
/// >>> import palpate as pp
/// >>> found = pp.closest_points(pp.ball(0.5), pp.ball(0.5).translated([1.5, 0, 0]))
/// >>> found.best.point_a.round(3)
/// array([0.5, 0. , 0. ])
#[pyfunction]
#[pyo3(signature = (a, b, *, tolerance = None, budget = None))]
pub(crate) fn closest_points<'py>(
    py: Python<'py>,
    a: &PyShape,
    b: &PyShape,
    tolerance: Option<f64>,
    budget: Option<u32>,
) -> PyResult<Bound<'py, PyAny>> {
    of_both!(py, a, b, |a, b| {
        let found =
            detached(py, || query(tolerance, budget).closest_points(a, b))?.or_raise(py)?;
        Fields::of(py, &found)?.of_class("ClosestPoints")
    })
}

/// Contacts that span where two bodies touch or are nearer than `margin` [m].
///
/// Contacts are at least `spacing` apart [m], and at most `most`. Left out, they fit the smaller body: 0.2 % and 4 % of
/// its size, and 32.
///
/// `tolerance` is how far apart the bounds may be [m], a ten-thousandth of the smaller body if left out; `budget` how
/// often the fields are evaluated at most, 200 000 if left out.
///
/// Raises `QueryError` if neither body has bounds or a length is negative, `ValueError` if the shapes' dimensions
/// differ.
///
/// >>> import palpate as pp
/// >>> found = pp.manifold(pp.cuboid([1, 1, 1]), pp.cuboid([1, 1, 1]).translated([0, 0.999, 0]))
/// >>> len(found) >= 4, bool((abs(found.contacts.gap + 0.001) < 2e-4).all())
/// (True, True)
#[pyfunction]
#[pyo3(signature = (a, b, *, margin = None, spacing = None, most = None, tolerance = None, budget = None))]
pub(crate) fn manifold<'py>(
    py: Python<'py>,
    a: &PyShape,
    b: &PyShape,
    margin: Option<f64>,
    spacing: Option<f64>,
    most: Option<usize>,
    tolerance: Option<f64>,
    budget: Option<u32>,
) -> PyResult<Bound<'py, PyAny>> {
    of_both!(py, a, b, |a, b| {
        let found = detached(py, || {
            let change = |own| settings(own, margin, spacing, most);
            query(tolerance, budget).manifold_with(a, b, change)
        })?;
        manifold_of(py, &found.or_raise(py)?)
    })
}

/// Settings with what a caller asks of contacts.
pub(crate) fn settings(
    own: ManifoldSettings,
    margin: Option<f64>,
    spacing: Option<f64>,
    most: Option<usize>,
) -> ManifoldSettings {
    ManifoldSettings {
        margin: margin.unwrap_or(own.margin),
        spacing: spacing.unwrap_or(own.spacing),
        most: most.unwrap_or(own.most),
        ..own
    }
}

pub(crate) fn manifold_of<'py, const D: usize>(
    py: Python<'py>,
    found: &Manifold<D>,
) -> PyResult<Bound<'py, PyAny>> {
    Fields::of(py, found)?
        .with("contacts", contacts(py, &found.contacts)?)?
        .of_class("Manifold")
}

/// The first surface along a ray of a length [m]: the first place at which the field is at most the tolerance. Before it
/// the field is positive, proven: no surface is passed over. `direction` may have any length but 0.
///
/// `tolerance` is how far apart the bounds may be [m], a ten-thousandth of the smaller of shape and ray if left out;
/// `budget` how often the field is evaluated at most, 200 000 if left out.
///
/// Raises `QueryError` if the direction is zero, or the length or the tolerance is negative.
///
/// >>> import palpate as pp
/// >>> pp.cast_ray(pp.ball(0.5), [0, 2, 0], [0, -1, 0]).best.point.round(3)
/// array([0. , 0.5, 0. ])
#[pyfunction]
#[pyo3(signature = (shape, origin, direction, length = 1e3, *, tolerance = None, budget = None))]
pub(crate) fn cast_ray<'py>(
    shape: &PyShape,
    origin: &Bound<'py, PyAny>,
    direction: &Bound<'py, PyAny>,
    length: f64,
    tolerance: Option<f64>,
    budget: Option<u32>,
) -> PyResult<Bound<'py, PyAny>> {
    crate::shape::of_either!(shape.made(origin.py())?, shape => {
        cast(shape, (origin, direction, length), &mut query(tolerance, budget))
    })
}

fn cast<'py, const D: usize>(
    shape: &Shape<D>,
    (origin, direction, length): (&Bound<'py, PyAny>, &Bound<'py, PyAny>, f64),
    query: &mut Query<D>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = origin.py();
    let (origin, direction) =
        (poses::point(origin, "origin")?, poses::point(direction, "direction")?);
    let ray = Ray::new(origin, direction, length).or_raise(py)?;
    let found = detached(py, || query.cast_ray(shape, &ray))?.or_raise(py)?;
    Fields::of(py, &found)?.of_class("RayCast")
}
