// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fields that are functions of Python.

use numpy::IntoPyArray;
use palpate::field::{Aabb, Bounds, CustomField, Point, Promise, Shape, Vector};
use pyo3::exceptions::{PyRecursionError, PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::numbers;
use crate::call;
use crate::ending::attached;
use crate::shape::PyShape;

/// Half of the step of central differences, as a share of the size of what is looked at.
const STEP: f64 = 1e-6;

/// So deep may a function ask shapes of functions: Python's own limit comes after the end of the stack.
const DEEPEST: u32 = 32;

/// A field of which only values are known.
pub(crate) struct Function<const D: usize> {
    function: Py<PyAny>,
    promise: Promise<D>,
    step: f64,
}

impl<const D: usize> Function<D> {
    /// What Python calls the function.
    pub(crate) fn name(&self) -> String {
        let name = attached(|py| {
            let own = self.function.bind(py);
            let name =
                own.getattr("__qualname__").or_else(|_| own.get_type().getattr("__qualname__"));
            name.ok().map(|name| name.to_string())
        });
        name.flatten().unwrap_or_else(|| "callable".to_owned())
    }

    /// The values at points; NaN where the function raises or has raised.
    fn values(&self, points: &[Point<D>], values: &mut [f64]) {
        if call::has_failed() {
            return values.fill(f64::NAN);
        }
        let before = call::deeper();
        let asked = attached(|py| {
            // A search over a function may take long.
            py.check_signals()?;
            if call::depth() > DEEPEST {
                let problem = "a function asks a shape of itself, without end";
                return Err(PyRecursionError::new_err(problem));
            }
            let coordinates: Vec<f64> = points.iter().flat_map(|p| p.0).collect();
            let array = coordinates.into_pyarray(py);
            let array = array.call_method1("reshape", (points.len(), D))?;
            let answer = self.function.bind(py).call1((array,))?;
            let answer = numbers(&answer, "the answer of the function")?;
            if answer.shape() != [points.len()] {
                let problem = format!(
                    "the function must answer {} points with an array of shape ({},), got {:?}",
                    points.len(),
                    points.len(),
                    answer.shape()
                );
                return Err(PyValueError::new_err(problem));
            }
            values.copy_from_slice(&answer.as_doubles()?);
            for (p, value) in points.iter().zip(&mut *values) {
                if p.0.iter().any(|x| x.is_nan()) {
                    *value = f64::NAN;
                }
            }
            // Bounds of a search cannot hold what is no number.
            let wrong = points
                .iter()
                .zip(&*values)
                .find(|(p, value)| p.is_finite() && !value.is_finite());
            match wrong {
                None => Ok(()),
                Some((p, value)) => {
                    let problem = format!("the function answers {value} at {:?}", p.0);
                    Err(PyValueError::new_err(problem))
                }
            }
        });
        call::set_depth(before);
        let ended =
            || Err(PyRuntimeError::new_err("Python ends: functions are called no more"));
        if let Err(error) = asked.unwrap_or_else(ended) {
            values.fill(f64::NAN);
            call::fail(error);
        }
    }
}

impl<const D: usize> std::fmt::Debug for Function<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name())
    }
}

impl<const D: usize> CustomField<D> for Function<D> {
    fn distance(&self, p: Point<D>) -> f64 {
        let mut value = [0.0];
        self.values(&[p], &mut value);
        value[0]
    }

    fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        let (mut value, mut slope) = ([0.0], [Vector::ZERO]);
        self.distances_gradients(&[p], &mut value, &mut slope);
        (value[0], slope[0])
    }

    fn distances(&self, points: &[Point<D>], distances: &mut [f64]) {
        self.values(points, distances);
    }

    fn distances_gradients(
        &self,
        points: &[Point<D>],
        distances: &mut [f64],
        gradients: &mut [Vector<f64, D>],
    ) {
        // Each point, and two beside it along each axis.
        let each = 1 + 2 * D;
        let mut all = Vec::with_capacity(points.len() * each);
        for p in points {
            all.push(*p);
            for k in 0..D {
                for side in [-self.step, self.step] {
                    let mut beside = *p;
                    beside.0[k] += side;
                    all.push(beside);
                }
            }
        }
        let mut values = vec![0.0; all.len()];
        self.values(&all, &mut values);
        let answers = distances.iter_mut().zip(gradients).zip(values.chunks_exact(each));
        for ((distance, gradient), own) in answers {
            *distance = own[0];
            let slope = |k: usize| (own[2 + 2 * k] - own[1 + 2 * k]) / (2.0 * self.step);
            *gradient = Vector(std::array::from_fn(slope));
        }
    }

    fn promise(&self) -> &Promise<D> {
        &self.promise
    }
}

/// A shape of a function of Python, which gives the values at points: an array of shape (n, D) in, one of shape (n,) out.
///
/// `lipschitz` is the most that values may differ by, over the distance of their points; everything that is proven rests
/// on it: 1 of a distance. `bounds` are the corners of a box that holds the body, shape (2, D) [m]. Gradients are central
/// differences, with a step of 1e-6 of the box's diagonal to either side, or of 1e-6 m without a box. Such a shape is
/// opaque: it can be asked, but not written, pickled or felt, so it stands in no `Scene` or `World`. A function that holds
/// its own shape keeps both alive. Searches ask few points at a time, which is slow in Python: sample the
/// function at the nodes of a lattice and take `from_samples` where that matters. Threads of the core call the function,
/// one at a time where Python has its lock.
///
/// Raises `ValueError` if `lipschitz` is not positive and finite; a question raises what the function raises while it
/// is asked.
///
/// >>> import palpate as pp, numpy as np
/// >>> waves = pp.from_function(lambda p: p[:, 1] - 0.01 * np.sin(20 * p[:, 0]), lipschitz=1.02)
/// >>> waves.distance([0, 0.5, 0]), waves.promise.outside
/// (0.5, 'lipschitz')
#[pyfunction]
#[pyo3(signature = (function, *, lipschitz, bounds = None, dimension = 3))]
pub(crate) fn from_function(
    function: Bound<'_, PyAny>,
    lipschitz: f64,
    bounds: Option<&Bound<'_, PyAny>>,
    dimension: usize,
) -> PyResult<PyShape> {
    if !function.is_callable() {
        return Err(PyTypeError::new_err("function must be callable"));
    }
    if !(lipschitz > 0.0 && lipschitz.is_finite()) {
        let problem = format!("lipschitz must be positive and finite, got {lipschitz}");
        return Err(PyValueError::new_err(problem));
    }
    match dimension {
        2 => Ok(made::<2>(function, lipschitz, bounds)?.into()),
        3 => Ok(made::<3>(function, lipschitz, bounds)?.into()),
        _ => Err(PyValueError::new_err(format!("dimension must be 2 or 3, got {dimension}"))),
    }
}

fn made<const D: usize>(
    function: Bound<'_, PyAny>,
    lipschitz: f64,
    bounds: Option<&Bound<'_, PyAny>>,
) -> PyResult<Shape<D>> {
    let aabb = match bounds {
        None => None,
        Some(given) => {
            let array = numbers(given, "bounds")?;
            let corners = array.as_doubles()?;
            if array.shape() != [2, D] {
                let expected = format!("(2, {D})");
                return Err(crate::arrays::misshapen("bounds", &expected, array.shape()));
            }
            let corner = |row: usize| Vector(std::array::from_fn(|k| corners[row * D + k]));
            let (min, max) = (corner(0), corner(1));
            let is_box = (0..D).all(|k| min[k] <= max[k] && (max[k] - min[k]).is_finite());
            if !is_box {
                let problem =
                    "bounds must be the lower corner, then the upper one, both finite";
                return Err(PyValueError::new_err(problem));
            }
            Some(Aabb { min, max })
        }
    };
    let size = aabb.map_or(1.0, |aabb| 2.0 * aabb.half_extents().norm());
    let promise = Promise::lipschitz(aabb.map(Bounds::of_box), lipschitz);
    let step = STEP * if size > 0.0 { size } else { 1.0 };
    Ok(Shape::custom(Function { function: function.unbind(), promise, step }))
}
