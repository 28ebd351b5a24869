// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The class `Shape`, of both dimensions.

mod methods;

use palpate::field::Shape;
use palpate::scene::WrittenShape;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::answers::{self, Fields};
use crate::call::detached_in;
use crate::chain::Chain;
use crate::error::OrRaise;
use crate::evaluate::{self, Slopes};
use crate::operators::{Combination, combined, listed};
use crate::pool;
use crate::text;

/// A shape in the plane or in space.
#[derive(Clone, PartialEq)]
pub(crate) enum AnyShape {
    Planar(Shape<2>),
    Spatial(Shape<3>),
}

/// Does the same with a shape of either dimension.
macro_rules! of_either {
    ($any:expr, $shape:ident => $done:expr) => {
        match $any {
            $crate::shape::AnyShape::Planar($shape) => $done,
            $crate::shape::AnyShape::Spatial($shape) => $done,
        }
    };
}
pub(crate) use of_either;

impl From<Shape<2>> for AnyShape {
    fn from(shape: Shape<2>) -> Self {
        Self::Planar(shape)
    }
}

impl From<Shape<3>> for AnyShape {
    fn from(shape: Shape<3>) -> Self {
        Self::Spatial(shape)
    }
}

impl AnyShape {
    /// Its dimension, 2 or 3.
    pub(crate) const fn dimension(&self) -> usize {
        match self {
            Self::Planar(_) => 2,
            Self::Spatial(_) => 3,
        }
    }
}

/// A body in the plane or in space, as a field: the signed distance to its surface, or a bound of it.
///
/// Shapes come from constructors (`ball`, `cuboid`, …), operators and texts. They cannot change; two are equal if
/// they are made alike. `repr` is the expression that makes a shape again; of a mesh or a function it names what it
/// is. `|`, `&`, `-` and `^` are union, intersection, difference and symmetric difference.
///
/// >>> import palpate as pp
/// >>> cup = pp.cylinder(0.04, 0.09) - pp.cylinder(0.037, 0.08).translated([0, 0.01, 0])
/// >>> eval(repr(cup), vars(pp)) == cup
/// True
#[pyclass(frozen, module = "palpate", name = "Shape", from_py_object)]
#[derive(Clone)]
pub(crate) struct PyShape(Chain);

impl<T: Into<AnyShape>> From<T> for PyShape {
    fn from(shape: T) -> Self {
        Self(Chain::of(shape.into()))
    }
}

impl PyShape {
    /// The shape itself, made now if it was not.
    pub(crate) fn made(&self, py: Python<'_>) -> PyResult<&AnyShape> {
        self.0.made(py)
    }

    /// This shape with another at the end of its chain.
    fn joined(&self, py: Python<'_>, other: &Self, how: Combination) -> PyResult<Self> {
        Ok(Self(self.0.joined(py, other.made(py)?, how)?))
    }
}

#[pymethods]
impl PyShape {
    /// 2 in the plane, 3 in space.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5, dimension=2).dimension
    /// 2
    #[getter]
    fn dimension(&self) -> usize {
        self.0.dimension()
    }

    /// The signed distance at points [m]: negative inside.
    ///
    /// Points are an array of shape (..., D), or one point of D numbers, which gives a float. Arrays of float32 give
    /// float32, all others float64; arrays in C order are read without a copy. NaN in gives NaN out. `out` takes the
    /// answers; it has the shape of the points without their last axis, their dtype, and C order. The work is shared by
    /// `threads` threads, 0 for all processors, without the interpreter's lock.
    ///
    /// Raises `ValueError` if `points` or `out` have another shape, `TypeError` if they are no real numbers.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).distance([0.0, 2.0, 0.0])
    /// 1.5
    /// >>> pp.ball(0.5).distance([[0, 2, 0], [0, 0, 0]])
    /// array([ 1.5, -0.5])
    #[pyo3(signature = (points, *, out = None, threads = 1))]
    fn distance<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        threads: isize,
    ) -> PyResult<Bound<'py, PyAny>> {
        evaluate::distance(self.made(points.py())?, points, out, threads)
    }

    /// As `distance`, for whoever takes a function.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5)([0.0, 2.0, 0.0])
    /// 1.5
    #[pyo3(signature = (points, *, out = None, threads = 1))]
    fn __call__<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        threads: isize,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.distance(points, out, threads)
    }

    /// The gradients of the distance at points, of the shape of the points; see `distance`.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).gradient([[0.0, 2.0, 0.0]])
    /// array([[0., 1., 0.]])
    #[pyo3(signature = (points, *, out = None, threads = 1))]
    fn gradient<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        threads: isize,
    ) -> PyResult<Bound<'py, PyAny>> {
        let shape = self.made(points.py())?;
        let outs = [("", None), ("out", out)];
        Ok(evaluate::distance_gradient(shape, points, outs, threads)?.1)
    }

    /// The signed distances at points [m] and their gradients, of which `out` may have two arrays; see `distance`.
    ///
    /// >>> import palpate as pp
    /// >>> distances, gradients = pp.ball(0.5).distance_gradient([[0.0, 2.0, 0.0]])
    /// >>> distances, gradients
    /// (array([1.5]), array([[0., 1., 0.]]))
    #[pyo3(signature = (points, *, out = None, threads = 1))]
    fn distance_gradient<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        out: Option<(Bound<'py, PyAny>, Bound<'py, PyAny>)>,
        threads: isize,
    ) -> PyResult<Slopes<'py>> {
        let (distances, gradients) = out.unzip();
        let outs = [("out[0]", distances.as_ref()), ("out[1]", gradients.as_ref())];
        evaluate::distance_gradient(self.made(points.py())?, points, outs, threads)
    }

    /// What the field says at a point: value, gradient, the surface near it, and what is promised there.
    ///
    /// Raises `QueryError` if the point is not finite, `ValueError` if it has not D numbers.
    ///
    /// >>> import palpate as pp
    /// >>> pp.ball(0.5).at([0.0, 2.0, 0.0]).surface
    /// array([0. , 0.5, 0. ])
    fn at<'py>(&self, point: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate::at(self.made(point.py())?, point)
    }

    /// What the field promises of its values.
    ///
    /// >>> import palpate as pp
    /// >>> str(pp.ball(0.5).promise)
    /// 'exact outside, exact inside'
    #[getter]
    fn promise<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_either!(self.made(py)?, shape => {
            let promise = shape.promise();
            Fields::of(py, promise)?.with("in_words", promise.in_words())?.of_class("Promise")
        })
    }

    /// The corners of a box that holds the body, shape (2, D) [m]; None if it has none.
    ///
    /// >>> import palpate as pp
    /// >>> pp.cuboid([1, 2, 4]).bounds
    /// array([[-0.5, -1. , -2. ],
    ///        [ 0.5,  1. ,  2. ]])
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        of_either!(self.made(py)?, shape => answers::bounds(py, shape.promise()))
    }

    /// The text of the shape, as it stands in scene files.
    ///
    /// Raises `SceneError` if a part of the shape cannot be written, as a function.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Shape.from_json(pp.ball(0.5).to_json())
    /// ball(radius=0.5)
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        of_either!(self.made(py)?, shape => Ok(WrittenShape::of(shape).or_raise(py)?.to_json()))
    }

    /// The shape of a text as it stands in scene files.
    ///
    /// Raises `SceneError` with the place in the text if it is no shape.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Shape.from_json('{ "ball": { "radius": 0.5 } }', dimension=2)
    /// ball(radius=0.5, dimension=2)
    #[staticmethod]
    #[pyo3(signature = (text, *, dimension = 3))]
    fn from_json(py: Python<'_>, text: &str, dimension: usize) -> PyResult<Self> {
        let written = WrittenShape::from_json(text).or_raise(py)?;
        // Grids of the shape are baked here.
        let pool = pool::of_at_least_one(1)?;
        match dimension {
            2 => Ok(detached_in(py, &pool, || written.build::<2>())?.or_raise(py)?.into()),
            3 => Ok(detached_in(py, &pool, || written.build::<3>())?.or_raise(py)?.into()),
            other => {
                Err(PyValueError::new_err(format!("dimension must be 2 or 3, got {other}")))
            }
        }
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        of_either!(self.made(py)?, shape => Ok(text::of(shape)))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let py = other.py();
        match other.cast::<Self>() {
            Ok(other) => Ok(other.get().made(py)? == self.made(py)?),
            Err(_) => Ok(false),
        }
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        // 0.0 and -0.0 are equal, so their hashes must be.
        let text = self.__repr__(py)?.replace("-0.0,", "0.0,").replace("-0.0]", "0.0]");
        text.replace("-0.0)", "0.0)").into_pyobject(py)?.hash()
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (String, usize))> {
        let py = slf.py();
        let shape = slf.get();
        let rebuild = py.import("palpate._pickled")?.getattr("shape")?;
        Ok((rebuild, (shape.to_json(py)?, shape.dimension())))
    }
}

impl PyShape {
    /// What combines this shape with others.
    fn with(&self, others: &Bound<'_, PyTuple>, how: Combination) -> PyResult<Self> {
        let mut shapes = vec![self.clone()];
        shapes.extend(listed(others)?);
        combined(others.py(), shapes, how)
    }

    /// The shape in space that an operator needs.
    pub(crate) fn solid(&self, py: Python<'_>, operator: &str) -> PyResult<Shape<3>> {
        match self.made(py)? {
            AnyShape::Spatial(shape) => Ok(shape.clone()),
            AnyShape::Planar(_) => {
                let problem = format!("{operator} needs a shape in 3D, got one in 2D");
                Err(PyTypeError::new_err(problem))
            }
        }
    }

    /// The shape in the plane that an operator needs.
    fn profile(&self, py: Python<'_>, operator: &str) -> PyResult<Shape<2>> {
        match self.made(py)? {
            AnyShape::Planar(shape) => Ok(shape.clone()),
            AnyShape::Spatial(_) => {
                let problem = format!("{operator} needs a shape in 2D, got one in 3D");
                Err(PyTypeError::new_err(problem))
            }
        }
    }
}
