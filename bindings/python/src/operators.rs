// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Operators on shapes, with their numbers by name as in scene files.

use palpate::field::operator::{Copies, Profile};
use palpate::field::{Shape, ShapeError};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::error::OrRaise;
use crate::shape::{AnyShape, PyShape};

/// What makes one shape of several of one dimension.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Combination {
    Union,
    Intersection,
    Difference,
    SymmetricDifference,
    SmoothUnion(Profile, f64),
    SmoothIntersection(Profile, f64),
    SmoothDifference(Profile, f64),
    Displaced(f64),
    Morphed(f64),
}

impl Combination {
    fn of<const D: usize>(self, mut shapes: Vec<Shape<D>>) -> Result<Shape<D>, ShapeError> {
        match self {
            Self::Union => Shape::union(shapes),
            Self::Intersection => Shape::intersection(shapes),
            Self::SymmetricDifference => Shape::symmetric_difference(shapes),
            Self::SmoothUnion(profile, width) => Shape::smooth_union(shapes, profile, width),
            Self::SmoothIntersection(profile, width) => {
                Shape::smooth_intersection(shapes, profile, width)
            }
            _ => {
                let first = shapes.remove(0);
                match self {
                    Self::SmoothDifference(profile, width) => {
                        first.smooth_difference(shapes, profile, width)
                    }
                    Self::Displaced(height) => first.displaced(shapes.remove(0), height),
                    Self::Morphed(progress) => first.morphed(shapes.remove(0), progress),
                    _ => first.difference(shapes),
                }
            }
        }
    }
}

/// Makes one shape of several, of which there is one at least.
pub(crate) fn combined(
    py: Python<'_>,
    shapes: Vec<PyShape>,
    how: Combination,
) -> PyResult<PyShape> {
    let (mut planar, mut spatial) = (Vec::new(), Vec::new());
    for shape in shapes {
        match shape.made(py)? {
            AnyShape::Planar(shape) => planar.push(shape.clone()),
            AnyShape::Spatial(shape) => spatial.push(shape.clone()),
        }
    }
    match (planar.len(), spatial.len()) {
        (0, 0) => Err(PyValueError::new_err("at least one shape is needed, got none")),
        (_, 0) => how.of(planar).or_raise(py).map(PyShape::from),
        (0, _) => how.of(spatial).or_raise(py).map(PyShape::from),
        (flat, solid) => Err(PyValueError::new_err(format!(
            "all shapes must have the same dimension, got {flat} of 2D and {solid} of 3D: extrude or revolve what is flat"
        ))),
    }
}

/// Shapes one by one, or in a list or another iterable.
pub(crate) fn listed(given: &Bound<'_, PyTuple>) -> PyResult<Vec<PyShape>> {
    let mut shapes = Vec::with_capacity(given.len());
    for item in given {
        if let Ok(shape) = item.extract::<PyShape>() {
            shapes.push(shape);
            continue;
        }
        let wrong = |found: &Bound<'_, PyAny>| {
            let kind =
                found.get_type().name().map_or_else(|_| "?".into(), |name| name.to_string());
            PyTypeError::new_err(format!("shapes must be of the class Shape, got {kind}"))
        };
        for shape in item.try_iter().map_err(|_| wrong(&item))? {
            let shape = shape?;
            shapes.push(shape.extract().map_err(|_| wrong(&shape))?);
        }
    }
    Ok(shapes)
}

/// A profile by the name that it has in scene files.
pub(crate) fn named(name: &str) -> PyResult<Profile> {
    Profile::named(name).ok_or_else(|| {
        let known = Profile::ALL.map(Profile::name).join(", ");
        PyValueError::new_err(format!("profile must be one of {known}, got {name:?}"))
    })
}

/// The number of an axis by its name.
pub(crate) fn axis(name: &str, dimension: usize) -> PyResult<usize> {
    let axes = &["x", "y", "z"][..dimension];
    axes.iter().position(|axis| *axis == name).ok_or_else(|| {
        let known = axes.join(", ");
        PyValueError::new_err(format!(
            "the axis must be one of {known} in {dimension}D, got {name:?}"
        ))
    })
}

/// The copies along an axis: a spacing [m] for copies without end, or `{"spacing": …, "first": …, "last": …}`.
pub(crate) fn copies(row: Option<&Bound<'_, PyAny>>) -> PyResult<Copies> {
    let Some(row) = row else { return Ok(Copies::One) };
    let Ok(row) = row.cast::<PyDict>() else {
        return Ok(Copies::Endless { spacing: row.extract()? });
    };
    let unknown = row.keys().iter().find(|key| {
        !["spacing", "first", "last"].iter().any(|known| key.eq(*known).unwrap_or(false))
    });
    if let Some(key) = unknown {
        let problem = format!("a row has spacing, first and last, not {key}");
        return Err(PyTypeError::new_err(problem));
    }
    let spacing = row.get_item("spacing")?;
    let spacing = spacing.ok_or_else(|| PyTypeError::new_err("a row needs its spacing"))?;
    let spacing = spacing.extract()?;
    match (row.get_item("first")?, row.get_item("last")?) {
        (None, None) => Ok(Copies::Endless { spacing }),
        (Some(first), Some(last)) => {
            Ok(Copies::Between { spacing, first: first.extract()?, last: last.extract()? })
        }
        _ => Err(PyTypeError::new_err("first and last go together")),
    }
}

/// Makes the functions of Python that combine a list of shapes.
macro_rules! functions {
    ($($(#[$doc:meta])* $name:ident: $how:expr;)*) => {
        $($(#[$doc])*
        #[pyfunction]
        #[pyo3(signature = (*shapes))]
        pub(crate) fn $name(shapes: &Bound<'_, PyTuple>) -> PyResult<PyShape> {
            combined(shapes.py(), listed(shapes)?, $how)
        })*
    };
}

functions! {
    /// What is in any of the shapes, as `|`. Shapes one by one, or in one list.
    ///
    /// Raises `ValueError` if shapes are of both dimensions, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> row = pp.union(pp.ball(0.1).translated([x, 0, 0]) for x in range(3))
    /// >>> row.distance([2, 0, 0])
    /// -0.1
    union: Combination::Union;
    /// What is in all of the shapes, as `&`. Shapes one by one, or in one list.
    ///
    /// Raises `ValueError` if shapes are of both dimensions, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.intersection(pp.ball(0.5), pp.ball(0.5).translated([0.6, 0, 0])).distance([0.3, 0, 0])
    /// -0.2
    intersection: Combination::Intersection;
    /// What is in the first shape and in none of the others, as `-`. Shapes one by one, or in one list.
    ///
    /// Raises `ValueError` if shapes are of both dimensions, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> holes = [pp.cylinder(0.1, 1).translated([x, 0, 0]) for x in (-0.2, 0.2)]
    /// >>> pp.difference(pp.cuboid([1, 0.1, 0.5]), holes).distance([0.2, 0, 0])
    /// 0.1
    difference: Combination::Difference;
    /// What is in an odd number of the shapes, as `^`. Shapes one by one, or in one list.
    ///
    /// Raises `ValueError` if shapes are of both dimensions, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.symmetric_difference(pp.ball(0.5), pp.ball(0.4)).distance([0, 0, 0])
    /// 0.4
    symmetric_difference: Combination::SymmetricDifference;
}

/// Makes the functions of Python that combine a list of shapes smoothly.
macro_rules! smooth_functions {
    ($($(#[$doc:meta])* $name:ident: $how:path;)*) => {
        $($(#[$doc])*
        #[pyfunction]
        #[pyo3(signature = (*shapes, width, profile = "quadratic"))]
        pub(crate) fn $name(
            shapes: &Bound<'_, PyTuple>,
            width: f64,
            profile: &str,
        ) -> PyResult<PyShape> {
            combined(shapes.py(), listed(shapes)?, $how(named(profile)?, width))
        })*
    };
}

smooth_functions! {
    /// The union of shapes, its creases filled: where two distances are equal, the surface moves by `width` [m]. `profile` is quadratic, cubic, quartic, circular, root, exponential or
    /// circular_geometrical.
    ///
    /// Raises `ShapeError` if the width is not positive, `ValueError` if shapes are of both dimensions or no profile has the
    /// name, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.smooth_union(pp.ball(0.5), pp.ball(0.5), width=0.01).distance([1, 0, 0])
    /// 0.49
    smooth_union: Combination::SmoothUnion;
    /// The intersection of shapes, its edges rounded off: where two distances are equal, the surface moves by `width` [m]. `profile` is quadratic, cubic, quartic, circular, root, exponential or
    /// circular_geometrical.
    ///
    /// Raises `ShapeError` if the width is not positive, `ValueError` if shapes are of both dimensions or no profile has the
    /// name, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.smooth_intersection(pp.ball(0.5), pp.ball(0.5), width=0.01).distance([1, 0, 0])
    /// 0.51
    smooth_intersection: Combination::SmoothIntersection;
    /// The first shape without the others, the edges of the cuts rounded off by `width` [m]. `profile` is quadratic, cubic, quartic, circular, root, exponential or
    /// circular_geometrical.
    ///
    /// Raises `ShapeError` if the width is not positive, `ValueError` if shapes are of both dimensions or no profile has the
    /// name, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.smooth_difference(pp.ball(0.5), pp.ball(0.4), width=0.001).distance([0, 0, 0])
    /// 0.4
    smooth_difference: Combination::SmoothDifference;
}
