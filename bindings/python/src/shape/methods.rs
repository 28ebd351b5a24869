// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Operators as methods of shapes.

use palpate::field::operator::Copies;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::{AnyShape, PyShape, of_either};
use crate::error::OrRaise;
use crate::operators::{self, Combination, combined, named};
use crate::poses::{self, Turn};

#[pymethods]
impl PyShape {
    fn __or__(&self, py: Python<'_>, other: Self) -> PyResult<Self> {
        self.joined(py, &other, Combination::Union)
    }

    fn __and__(&self, py: Python<'_>, other: Self) -> PyResult<Self> {
        self.joined(py, &other, Combination::Intersection)
    }

    fn __sub__(&self, py: Python<'_>, other: Self) -> PyResult<Self> {
        self.joined(py, &other, Combination::Difference)
    }

    fn __xor__(&self, py: Python<'_>, other: Self) -> PyResult<Self> {
        self.joined(py, &other, Combination::SymmetricDifference)
    }

    /// What is in this shape or in any of the others, as `|`.
    ///
    /// Raises `ValueError` if shapes are of both dimensions, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).union(pp.cuboid([1, 1, 1])) == pp.ball(0.5) | pp.cuboid([1, 1, 1])
    /// True
    #[pyo3(signature = (*others))]
    fn union(&self, others: &Bound<'_, PyTuple>) -> PyResult<Self> {
        self.with(others, Combination::Union)
    }

    /// What is in this shape and in all others, as `&`.
    ///
    /// Raises `ValueError` if shapes are of both dimensions, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).intersection(pp.cuboid([1, 1, 1])) == pp.ball(0.5) & pp.cuboid([1, 1, 1])
    /// True
    #[pyo3(signature = (*others))]
    fn intersection(&self, others: &Bound<'_, PyTuple>) -> PyResult<Self> {
        self.with(others, Combination::Intersection)
    }

    /// What is in this shape and in none of the others, as `-`.
    ///
    /// Raises `ValueError` if shapes are of both dimensions, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).difference(pp.ball(0.4)).distance([0, 0, 0])
    /// 0.4
    #[pyo3(signature = (*others))]
    fn difference(&self, others: &Bound<'_, PyTuple>) -> PyResult<Self> {
        self.with(others, Combination::Difference)
    }

    /// What is in an odd number of the shapes, as `^`.
    ///
    /// Raises `ValueError` if shapes are of both dimensions, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).symmetric_difference(pp.ball(0.4)).distance([0, 0, 0])
    /// 0.4
    #[pyo3(signature = (*others))]
    fn symmetric_difference(&self, others: &Bound<'_, PyTuple>) -> PyResult<Self> {
        self.with(others, Combination::SymmetricDifference)
    }

    /// The union, its creases filled: where two distances are equal, the surface moves by `width` [m].
    ///
    /// `profile` is quadratic, cubic, quartic, circular, root, exponential or circular_geometrical.
    ///
    /// Raises `ShapeError` if the width is not positive, `ValueError` if shapes are of both dimensions or no profile has the
    /// name, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).smooth_union(pp.ball(0.4), width=0.01).promise.lipschitz
    /// 1.0
    #[pyo3(signature = (*others, width, profile = "quadratic"))]
    fn smooth_union(
        &self,
        others: &Bound<'_, PyTuple>,
        width: f64,
        profile: &str,
    ) -> PyResult<Self> {
        self.with(others, Combination::SmoothUnion(named(profile)?, width))
    }

    /// The intersection, its edges rounded off: where two distances are equal, the surface moves by `width` [m].
    ///
    /// `profile` is quadratic, cubic, quartic, circular, root, exponential or circular_geometrical.
    ///
    /// Raises `ShapeError` if the width is not positive, `ValueError` if shapes are of both dimensions or no profile has the
    /// name, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).smooth_intersection(pp.ball(0.4), width=0.01).promise.lipschitz
    /// 1.0
    #[pyo3(signature = (*others, width, profile = "quadratic"))]
    fn smooth_intersection(
        &self,
        others: &Bound<'_, PyTuple>,
        width: f64,
        profile: &str,
    ) -> PyResult<Self> {
        self.with(others, Combination::SmoothIntersection(named(profile)?, width))
    }

    /// This shape without the others, the edges of the cuts rounded off: where two distances are equal, the surface moves by `width` [m].
    ///
    /// `profile` is quadratic, cubic, quartic, circular, root, exponential or circular_geometrical.
    ///
    /// Raises `ShapeError` if the width is not positive, `ValueError` if shapes are of both dimensions or no profile has the
    /// name, `TypeError` if one is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).smooth_difference(pp.ball(0.4), width=0.01).promise.lipschitz
    /// 1.0
    #[pyo3(signature = (*others, width, profile = "quadratic"))]
    fn smooth_difference(
        &self,
        others: &Bound<'_, PyTuple>,
        width: f64,
        profile: &str,
    ) -> PyResult<Self> {
        self.with(others, Combination::SmoothDifference(named(profile)?, width))
    }

    /// This shape with its surface moved outwards where another field is positive, by `height` [m] at most.
    ///
    /// Raises `ShapeError` if the height is not finite.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).displaced(pp.ball(0.1).repeated(x=0.3, y=0.3, z=0.3), height=0.01).bounds[1].round(2)
    /// array([0.51, 0.51, 0.51])
    #[pyo3(signature = (by, *, height))]
    fn displaced(&self, py: Python<'_>, by: Self, height: f64) -> PyResult<Self> {
        combined(py, vec![self.clone(), by], Combination::Displaced(height))
    }

    /// A shape on the way from this one to another: this at a `progress` of 0, the other at 1.
    ///
    /// Raises `ShapeError` if the progress is not between 0 and 1.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).morphed(pp.ball(0.3), progress=0.5).distance([1, 0, 0])
    /// 0.6
    #[pyo3(signature = (into, *, progress))]
    fn morphed(&self, py: Python<'_>, into: Self, progress: f64) -> PyResult<Self> {
        combined(py, vec![self.clone(), into], Combination::Morphed(progress))
    }

    /// This shape moved by `offset` [m], D numbers.
    ///
    /// Raises `ShapeError` if a number is not finite, `ValueError` if there are not D of them.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).translated([0, 1, 0]).distance([0, 2, 0])
    /// 0.5
    fn translated(&self, offset: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = offset.py();
        of_either!(self.made(py)?, shape => {
            let offset = poses::point(offset, "offset")?;
            shape.clone().translated(offset).or_raise(py).map(Self::from)
        })
    }

    /// This shape turned about the origin.
    ///
    /// In space about an axis, by `degrees` or `radians`; in the plane by `degrees` or `radians` alone, from x to y. Or by
    /// `matrix`, its rows, or in space by `quaternion`, x, y, z, w.
    ///
    /// Raises `ShapeError` if the axis is zero or a number is not finite, `TypeError` unless one way is given.
    ///
    /// >>> import palpate as pp
    /// >>> pp.cuboid([2, 1, 1]).rotated([0, 0, 1], degrees=90).distance([0, 1.5, 0])
    /// 0.5
    /// >>> pp.cuboid([2, 1]).rotated(degrees=90).distance([0, 1.5])
    /// 0.5
    #[pyo3(signature = (axis = None, *, degrees = None, radians = None, quaternion = None, matrix = None))]
    fn rotated(
        &self,
        py: Python<'_>,
        axis: Option<Bound<'_, PyAny>>,
        degrees: Option<f64>,
        radians: Option<f64>,
        quaternion: Option<Bound<'_, PyAny>>,
        matrix: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let turn = Turn { axis, degrees, radians, quaternion, matrix };
        match self.made(py)? {
            AnyShape::Planar(shape) => {
                shape.clone().rotated(turn.in_the_plane(py)?).or_raise(py).map(Self::from)
            }
            AnyShape::Spatial(shape) => {
                shape.clone().rotated(turn.in_space(py)?).or_raise(py).map(Self::from)
            }
        }
    }

    /// This shape moved by a pose.
    ///
    /// A pose is a translation of D numbers; in space x, y, z, qx, qy, qz, qw or a matrix of shape (4, 4); in the plane x,
    /// y and an angle [rad] or a matrix of shape (3, 3).
    ///
    /// Raises `ValueError` if the pose has another shape, `ShapeError` if a number is not finite or it is no rotation.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).placed([0, 1, 0, 0, 0, 0, 1]).distance([0, 2, 0])
    /// 0.5
    fn placed(&self, pose: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = pose.py();
        of_either!(self.made(py)?, shape => {
            shape.clone().placed(&poses::one(pose)?).or_raise(py).map(Self::from)
        })
    }

    /// This shape scaled about the origin by a factor.
    ///
    /// Raises `ShapeError` if the factor is not positive and finite.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).scaled(2).distance([0, 2, 0])
    /// 1.0
    fn scaled(&self, factor: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = factor.py();
        let factor: f64 = factor.extract().map_err(|_| {
            let problem = "factor must be one number: `stretched` takes one for each axis";
            PyTypeError::new_err(problem)
        })?;
        of_either!(self.made(py)?, shape => shape.clone().scaled(factor).or_raise(py).map(Self::from))
    }

    /// This shape scaled by a factor along each axis. Its values are bounds.
    ///
    /// Raises `ShapeError` if a factor is not positive and finite.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).stretched([1, 2, 1]).promise.outside
    /// 'bound'
    fn stretched(&self, factors: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = factors.py();
        of_either!(self.made(py)?, shape => {
            let factors = poses::point(factors, "factors")?;
            shape.clone().stretched(factors).or_raise(py).map(Self::from)
        })
    }

    /// This shape grown by a length [m], or shrunk if it is negative.
    ///
    /// Raises `ShapeError` if the length is not finite.
    ///
    /// >>> import palpate as pp
    /// >>> pp.cuboid([1, 1, 1]).offset(0.1).distance([1, 0, 0])
    /// 0.4
    fn offset(&self, py: Python<'_>, distance: f64) -> PyResult<Self> {
        of_either!(self.made(py)?, shape => shape.clone().offset(distance).or_raise(py).map(Self::from))
    }

    /// A wall of this thickness [m] on the surface of this shape.
    ///
    /// Raises `ShapeError` if the thickness is not positive.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).shell(0.02).distance([0, 0, 0])
    /// 0.49
    fn shell(&self, py: Python<'_>, thickness: f64) -> PyResult<Self> {
        of_either!(self.made(py)?, shape => shape.clone().shell(thickness).or_raise(py).map(Self::from))
    }

    /// This shape cut at the coordinate planes and pulled apart by a length along each axis [m].
    ///
    /// Raises `ShapeError` if a length is negative.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).elongated([0, 2, 0]).bounds[1]
    /// array([0.5, 1.5, 0.5])
    fn elongated(&self, lengths: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = lengths.py();
        of_either!(self.made(py)?, shape => {
            let lengths = poses::point(lengths, "lengths")?;
            shape.clone().elongated(lengths).or_raise(py).map(Self::from)
        })
    }

    /// The part of this shape at positive coordinates of an axis, "x", "y" or "z", and its mirror image.
    ///
    /// Raises `ValueError` if the axis is none of the shape's.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.1).translated([1, 0, 0]).mirrored("x").distance([-1, 0, 0])
    /// -0.1
    fn mirrored(&self, py: Python<'_>, axis: &str) -> PyResult<Self> {
        let axis = operators::axis(axis, self.0.dimension())?;
        of_either!(self.made(py)?, shape => shape.clone().mirrored(axis).or_raise(py).map(Self::from))
    }

    /// Copies of this shape along axes, each without end at a spacing [m], or counted by a dict as in scene files.
    ///
    /// Raises `ShapeError` if a spacing is less than half the width of the shape, `TypeError` for z in 2D or a row that is neither
    /// a number nor such a dict.
    ///
    /// >>> import palpate as pp
    /// >>> row = pp.ball(0.1).repeated(x={"spacing": 1.0, "first": 0, "last": 2})
    /// >>> row.distance([[2, 0, 0], [3, 0, 0]])
    /// array([-0.1,  0.9])
    #[pyo3(signature = (*, x = None, y = None, z = None))]
    fn repeated(
        &self,
        py: Python<'_>,
        x: Option<Bound<'_, PyAny>>,
        y: Option<Bound<'_, PyAny>>,
        z: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let [x, y, z] = [&x, &y, &z].map(|row| operators::copies(row.as_ref()));
        let (x, y, z) = (x?, y?, z?);
        match self.made(py)? {
            AnyShape::Planar(_) if z != Copies::One => {
                Err(PyTypeError::new_err("there is no z in 2D: repeat along x or y"))
            }
            AnyShape::Planar(shape) => {
                shape.clone().repeated([x, y]).or_raise(py).map(Self::from)
            }
            AnyShape::Spatial(shape) => {
                shape.clone().repeated([x, y, z]).or_raise(py).map(Self::from)
            }
        }
    }

    /// This shape bent: turned in the plane of x and y by an angle for each metre of x.
    ///
    /// Raises `ShapeError` if the angle is not finite or the shape has no bounds to bend, `TypeError` unless one of `degrees` and
    /// `radians` is given.
    ///
    /// >>> import palpate as pp
    /// >>> pp.cuboid([1, 0.1, 0.1]).bent(degrees=90).promise.outside
    /// 'lipschitz'
    #[pyo3(signature = (*, degrees = None, radians = None))]
    fn bent(
        &self,
        py: Python<'_>,
        degrees: Option<f64>,
        radians: Option<f64>,
    ) -> PyResult<Self> {
        let rate = poses::angle(degrees, radians)?;
        of_either!(self.made(py)?, shape => shape.clone().bent(rate).or_raise(py).map(Self::from))
    }

    /// This shape twisted: turned about y by an angle for each metre of y. In space alone.
    ///
    /// Raises `ShapeError` if the angle is not finite or the shape has no bounds to twist, `TypeError` if it is one of
    /// the plane.
    ///
    /// >>> import palpate as pp
    /// >>> pp.cuboid([0.1, 1, 0.1]).twisted(degrees=90).promise.outside
    /// 'lipschitz'
    #[pyo3(signature = (*, degrees = None, radians = None))]
    fn twisted(
        &self,
        py: Python<'_>,
        degrees: Option<f64>,
        radians: Option<f64>,
    ) -> PyResult<Self> {
        let rate = poses::angle(degrees, radians)?;
        self.solid(py, "twisted")?.twisted(rate).or_raise(py).map(Self::from)
    }

    /// This shape of the plane as a solid: its x and y become x and z, and it gets a height along y [m].
    ///
    /// Raises `ShapeError` if the height is not positive, `TypeError` if the shape is one of space.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5, dimension=2).extruded(1).distance([0, 1, 0])
    /// 0.5
    fn extruded(&self, py: Python<'_>, height: f64) -> PyResult<Self> {
        self.profile(py, "extruded")?.extruded(height).or_raise(py).map(Self::from)
    }

    /// This shape of the plane turned about y: its x becomes the distance from that axis.
    ///
    /// Raises `TypeError` if the shape is one of space.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.1, dimension=2).translated([0.5, 0]).revolved().distance([0, 0, 0.5])
    /// -0.1
    fn revolved(&self, py: Python<'_>) -> PyResult<Self> {
        self.profile(py, "revolved")?.revolved().or_raise(py).map(Self::from)
    }
}
