// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Poses and rotations as Python gives them.
//!
//! A pose in space is a translation, seven numbers `x y z qx qy qz qw`, or a matrix of four rows; in the plane a
//! translation, three numbers `x y angle` with the angle in radians, or a matrix of three rows.

use palpate::field::{Pose, Rotation, Vector};
use pyo3::exceptions::{PyKeyError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{few, misshapen, numbers};
use crate::error::OrRaise;

/// A turn as the caller tells it: one of its ways.
pub(crate) struct Turn<'py> {
    pub(crate) axis: Option<Bound<'py, PyAny>>,
    pub(crate) degrees: Option<f64>,
    pub(crate) radians: Option<f64>,
    pub(crate) quaternion: Option<Bound<'py, PyAny>>,
    pub(crate) matrix: Option<Bound<'py, PyAny>>,
}

impl Turn<'_> {
    pub(crate) fn in_the_plane(self, py: Python<'_>) -> PyResult<Rotation<2>> {
        match self {
            Self { axis: None, quaternion: None, matrix: None, degrees, radians } => {
                Rotation::<2>::from_angle(angle(degrees, radians)?).or_raise(py)
            }
            Self {
                axis: None,
                quaternion: None,
                matrix: Some(rows),
                degrees: None,
                radians: None,
            } => Rotation::from_rows(square(&rows)?).or_raise(py),
            _ => Err(PyTypeError::new_err(
                "in 2D a turn is one of degrees=, radians= and matrix=",
            )),
        }
    }

    pub(crate) fn in_space(self, py: Python<'_>) -> PyResult<Rotation<3>> {
        match self {
            Self { axis: Some(axis), quaternion: None, matrix: None, degrees, radians } => {
                Rotation::from_axis_angle(point::<3>(&axis, "axis")?, angle(degrees, radians)?)
                    .or_raise(py)
            }
            Self {
                axis: None,
                quaternion: Some(quaternion),
                matrix: None,
                degrees: None,
                radians: None,
            } => {
                Rotation::from_quaternion(point::<4>(&quaternion, "quaternion")?.0).or_raise(py)
            }
            Self {
                axis: None,
                quaternion: None,
                matrix: Some(rows),
                degrees: None,
                radians: None,
            } => Rotation::from_rows(square(&rows)?).or_raise(py),
            _ => Err(PyTypeError::new_err(
                "in 3D a turn is an axis with degrees= or radians=, or quaternion=, or matrix=",
            )),
        }
    }
}

/// An angle [rad], of which one of two units is given.
pub(crate) fn angle(degrees: Option<f64>, radians: Option<f64>) -> PyResult<f64> {
    match (degrees, radians) {
        (Some(degrees), None) => Ok(degrees.to_radians()),
        (None, Some(radians)) => Ok(radians),
        _ => Err(PyTypeError::new_err("exactly one of degrees= and radians= must be given")),
    }
}

/// The rows of a square matrix.
fn square<const D: usize>(given: &Bound<'_, PyAny>) -> PyResult<[[f64; D]; D]> {
    let array = numbers(given, "matrix")?;
    let (numbers, shape) = (array.as_doubles()?, array.shape());
    if *shape != [D, D] {
        return Err(misshapen("matrix", &format!("({D}, {D})"), shape));
    }
    Ok(std::array::from_fn(|i| std::array::from_fn(|k| numbers[D * i + k])))
}

/// A pose of a shape of dimension `D`.
pub(crate) trait Posed: Sized {
    /// What a pose may be, in words.
    const FORMS: &'static str;

    /// The shapes of arrays that are one.
    const SHAPES: [&'static [usize]; 3];

    /// From the numbers of an array of this shape.
    fn of(py: Python<'_>, numbers: &[f64], shape: &[usize]) -> Option<PyResult<Self>>;
}

fn translation<const D: usize>(numbers: &[f64]) -> Vector<f64, D> {
    Vector(std::array::from_fn(|i| numbers[i]))
}

/// The rotation and translation of a matrix with a row of zeros and one at its end.
fn of_matrix<const D: usize>(py: Python<'_>, numbers: &[f64]) -> PyResult<Pose<D>> {
    let row = |i: usize| &numbers[i * (D + 1)..(i + 1) * (D + 1)];
    let last = row(D);
    if last[..D].iter().any(|x| *x != 0.0) || last[D] != 1.0 {
        let problem = format!("the last row of a pose must be zeros and a one, got {last:?}");
        return Err(PyValueError::new_err(problem));
    }
    let rows = std::array::from_fn(|i| std::array::from_fn(|k| row(i)[k]));
    let rotation = Rotation::from_rows(rows).or_raise(py)?;
    Ok(Pose::new(rotation, Vector(std::array::from_fn(|i| row(i)[D]))))
}

impl Posed for Pose<2> {
    const FORMS: &'static str = "(2,), (3,) or (3, 3)";
    const SHAPES: [&'static [usize]; 3] = [&[2], &[3], &[3, 3]];

    fn of(py: Python<'_>, numbers: &[f64], shape: &[usize]) -> Option<PyResult<Self>> {
        match shape {
            [2] => Some(Ok(Self::translation(translation(numbers)))),
            [3] => Some(
                Rotation::<2>::from_angle(numbers[2])
                    .or_raise(py)
                    .map(|rotation| Self::new(rotation, translation::<2>(numbers))),
            ),
            [3, 3] => Some(of_matrix(py, numbers)),
            _ => None,
        }
    }
}

impl Posed for Pose<3> {
    const FORMS: &'static str = "(3,), (7,) or (4, 4)";
    const SHAPES: [&'static [usize]; 3] = [&[3], &[7], &[4, 4]];

    fn of(py: Python<'_>, numbers: &[f64], shape: &[usize]) -> Option<PyResult<Self>> {
        match shape {
            [3] => Some(Ok(Self::translation(translation(numbers)))),
            [7] => {
                let quaternion = std::array::from_fn(|i| numbers[3 + i]);
                let rotation = Rotation::from_quaternion(quaternion).or_raise(py);
                Some(rotation.map(|rotation| Self::new(rotation, translation::<3>(numbers))))
            }
            [4, 4] => Some(of_matrix(py, numbers)),
            _ => None,
        }
    }
}

/// One pose.
pub(crate) fn one<P: Posed>(given: &Bound<'_, PyAny>) -> PyResult<P> {
    called(given, "pose")
}

/// One pose, by the name of its argument.
fn called<P: Posed>(given: &Bound<'_, PyAny>, what: &str) -> PyResult<P> {
    let array = numbers(given, what)?;
    let (numbers, shape) = (array.as_doubles()?, array.shape());
    P::of(given.py(), &numbers, shape).unwrap_or_else(|| Err(misshapen(what, P::FORMS, shape)))
}

/// One pose, or that of a body that stays where it is.
pub(crate) fn or_identity<const D: usize>(given: Option<&Bound<'_, PyAny>>) -> PyResult<Pose<D>>
where
    Pose<D>: Posed,
{
    given.map_or_else(|| Ok(Pose::identity()), one)
}

/// The poses of bodies by their names.
pub(crate) fn named<B: Copy, P: Posed>(
    poses: &Bound<'_, PyDict>,
    bodies: &[(String, B)],
) -> PyResult<Vec<(B, P)>> {
    let mut all = Vec::with_capacity(poses.len());
    for (name, pose) in poses {
        let name: String = name.extract()?;
        all.push((body(&name, bodies)?, called(&pose, &format!("poses[{name:?}]"))?));
    }
    Ok(all)
}

/// The body of a name.
pub(crate) fn body<B: Copy>(name: &str, bodies: &[(String, B)]) -> PyResult<B> {
    let found = bodies.iter().find(|(own, _)| *own == name);
    found.map(|(_, body)| *body).ok_or_else(|| {
        let known: Vec<&str> = bodies.iter().map(|(name, _)| name.as_str()).collect();
        let known = known.join(", ");
        PyKeyError::new_err(format!("no body is called {name:?}: there are {known}"))
    })
}

/// Many poses: one for each row of the first axis.
pub(crate) fn many<P: Posed>(given: &Bound<'_, PyAny>) -> PyResult<Vec<P>> {
    let array = numbers(given, "poses")?;
    let (numbers, shape) = (array.as_doubles()?, array.shape());
    let wrong = || misshapen("poses", &format!("(n, …) with … of {}", P::FORMS), shape);
    let [count, each @ ..] = shape else { return Err(wrong()) };
    let size: usize = each.iter().product();
    // Whether one pose can have this shape, also where there is none.
    if !P::SHAPES.contains(&each) {
        return Err(wrong());
    }
    let mut poses = Vec::with_capacity(*count);
    for i in 0..*count {
        let pose =
            P::of(given.py(), &numbers[i * size..(i + 1) * size], each).ok_or_else(wrong)?;
        poses.push(pose.map_err(|error| at_index(given.py(), "poses", i, error))?);
    }
    Ok(poses)
}

/// The exception of one of many, which says which one: of the same class, with what it knows.
pub(crate) fn at_index(py: Python<'_>, all: &str, index: usize, error: PyErr) -> PyErr {
    let named = || -> PyResult<PyErr> {
        let problem = format!("{all}[{index}]: {}", error.value(py));
        let named = error.get_type(py).call1((problem,))?;
        if let Ok(known) = error.value(py).getattr("__dict__") {
            named.getattr("__dict__")?.call_method1("update", (known,))?;
        }
        Ok(PyErr::from_value(named))
    };
    named().unwrap_or(error)
}

/// A point or a direction.
pub(crate) fn point<const D: usize>(
    given: &Bound<'_, PyAny>,
    what: &str,
) -> PyResult<Vector<f64, D>> {
    if let Some(point) = few(given) {
        return Ok(Vector(point));
    }
    let array = numbers(given, what)?;
    let found = <[f64; D]>::try_from(&*array.as_doubles()?);
    match (found, array.shape()) {
        (Ok(point), [_]) => Ok(Vector(point)),
        (_, shape) => Err(misshapen(what, &format!("({D},)"), shape)),
    }
}

/// Many points or directions, or one.
pub(crate) fn points<const D: usize>(
    given: &Bound<'_, PyAny>,
    what: &str,
) -> PyResult<Vec<Vector<f64, D>>> {
    let array = numbers(given, what)?;
    match array.shape() {
        [sides] | [_, sides] if *sides == D => {
            let numbers = array.as_doubles()?;
            let (points, _) = numbers.as_chunks::<D>();
            Ok(points.iter().copied().map(Vector).collect())
        }
        shape => Err(misshapen(what, &format!("(n, {D}) or ({D},)"), shape)),
    }
}
