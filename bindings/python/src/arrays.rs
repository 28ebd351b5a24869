// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Arrays of NumPy, as rows of numbers and back.
//!
//! Arrays in C order are read and written where they lie. All others are copied into C order first, by NumPy.

use std::borrow::Cow;

use numpy::{
    Element, IntoPyArray, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn,
    PyReadwriteArrayDyn, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyList, PyTuple};

/// Numbers as a caller gave them, in C order and in the precision of the answer.
pub(crate) enum Numbers<'py> {
    Double(PyReadonlyArrayDyn<'py, f64>),
    Single(PyReadonlyArrayDyn<'py, f32>),
}

impl Numbers<'_> {
    pub(crate) fn shape(&self) -> &[usize] {
        match self {
            Self::Double(array) => array.shape(),
            Self::Single(array) => array.shape(),
        }
    }

    /// In double precision.
    pub(crate) fn as_doubles(&self) -> PyResult<Cow<'_, [f64]>> {
        Ok(match self {
            Self::Double(array) => Cow::Borrowed(array.as_slice()?),
            Self::Single(array) => {
                Cow::Owned(array.as_slice()?.iter().map(|x| f64::from(*x)).collect())
            }
        })
    }
}

/// An array of the wrong shape.
pub(crate) fn misshapen(what: &str, expected: &str, found: &[usize]) -> PyErr {
    let found = said(found);
    PyValueError::new_err(format!("{what} must have the shape {expected}, got {found}"))
}

/// A shape as NumPy writes it.
fn said(shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(ToString::to_string).collect();
    match &sides[..] {
        [only] => format!("({only},)"),
        sides => format!("({})", sides.join(", ")),
    }
}

/// A list or a tuple of `N` numbers, which needs no array.
pub(crate) fn few<const N: usize>(given: &Bound<'_, PyAny>) -> Option<[f64; N]> {
    if let Ok(list) = given.cast_exact::<PyList>() {
        return each(list.len(), list.iter());
    }
    let tuple = given.cast_exact::<PyTuple>().ok()?;
    each(tuple.len(), tuple.iter())
}

/// So many numbers, if all are some: booleans are numbers of Python, and none of an array.
fn each<'py, const N: usize>(
    count: usize,
    items: impl Iterator<Item = Bound<'py, PyAny>>,
) -> Option<[f64; N]> {
    let mut numbers = [0.0; N];
    if count != N {
        return None;
    }
    for (number, item) in numbers.iter_mut().zip(items) {
        *number = if item.is_instance_of::<PyBool>() { None } else { item.extract().ok() }?;
    }
    Some(numbers)
}

/// An array of real numbers in C order: single precision stays, all else becomes double precision.
pub(crate) fn numbers<'py>(given: &Bound<'py, PyAny>, what: &str) -> PyResult<Numbers<'py>> {
    let py = given.py();
    if let Ok(array) = given.cast_exact::<PyArrayDyn<f64>>()
        && array.is_c_contiguous()
        && is_aligned::<f64>(array.data())
    {
        return Ok(Numbers::Double(array.try_readonly().map_err(|_| busy(what))?));
    }
    let numpy = py.import("numpy")?;
    if given.is_instance(&numpy.getattr("ma")?.getattr("MaskedArray")?)? {
        let problem =
            format!("{what} must not be a masked array: fill it first, by .filled(…)");
        return Err(PyTypeError::new_err(problem));
    }
    let array = numpy.call_method1("asarray", (given,)).map_err(|error| {
        // Whatever else is raised, as where an array computes itself, is not about the numbers.
        if !error.is_instance_of::<PyTypeError>(py) && !error.is_instance_of::<PyValueError>(py)
        {
            return error;
        }
        let problem = format!("{what} must be an array of real numbers: {}", error.value(py));
        let named = PyTypeError::new_err(problem);
        named.set_cause(py, Some(error));
        named
    })?;
    let array = array.cast_into::<PyUntypedArray>()?;
    let dtype = array.dtype();
    if !matches!(dtype.kind(), b'f' | b'i' | b'u') {
        let problem = format!("{what} must be real numbers, got an array of {dtype}");
        return Err(PyTypeError::new_err(problem));
    }
    let is_single = dtype.kind() == b'f' && dtype.itemsize() == 4;
    let wanted = if is_single { f32::get_dtype(py) } else { f64::get_dtype(py) };
    let is_aligned: bool = array.getattr("flags")?.getattr("aligned")?.extract()?;
    let array = if array.is_c_contiguous() && dtype.is_equiv_to(&wanted) && is_aligned {
        array.into_any()
    } else {
        // `ascontiguousarray` would make a row of a single number.
        let name = if is_single { "float32" } else { "float64" };
        let options = pyo3::types::PyDict::new(py);
        options.set_item("dtype", name)?;
        options.set_item("order", "C")?;
        options.set_item("copy", true)?;
        numpy.call_method("array", (&array,), Some(&options))?
    };
    Ok(if is_single {
        Numbers::Single(
            array.cast_into::<PyArrayDyn<f32>>()?.try_readonly().map_err(|_| busy(what))?,
        )
    } else {
        Numbers::Double(
            array.cast_into::<PyArrayDyn<f64>>()?.try_readonly().map_err(|_| busy(what))?,
        )
    })
}

/// Whether numbers may be read and written here.
fn is_aligned<T>(place: *mut T) -> bool {
    place.is_aligned()
}

fn busy(what: &str) -> PyErr {
    PyValueError::new_err(format!(
        "{what} must not share memory with another argument, nor be written by another thread meanwhile"
    ))
}

/// Where numbers are written: an array of the caller, or a new one.
pub(crate) fn place<'py, T: Element>(
    py: Python<'py>,
    out: Option<&Bound<'py, PyAny>>,
    shape: &[usize],
    what: &str,
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let Some(out) = out.filter(|out| !out.is_none()) else {
        return Ok(PyArrayDyn::zeros(py, shape, false));
    };
    let name = T::get_dtype(py);
    let array = out.cast::<PyArrayDyn<T>>().map_err(|_| {
        let found = out
            .getattr("dtype")
            .and_then(|dtype| Ok(format!("an array of {}", dtype.str()?)))
            .or_else(|_| out.get_type().name().map(|name| name.to_string()))
            .unwrap_or_default();
        PyTypeError::new_err(format!("{what} must be an array of {name}, got {found}"))
    })?;
    if array.shape() != shape {
        return Err(misshapen(what, &said(shape), array.shape()));
    }
    if !array.is_c_contiguous() || !is_aligned(array.data()) {
        return Err(PyValueError::new_err(format!(
            "{what} must be in C order and aligned, as np.empty makes it"
        )));
    }
    Ok(array.clone())
}

/// The numbers of an array to write to.
pub(crate) fn writable<'py, T: Element>(
    array: &Bound<'py, PyArrayDyn<T>>,
    what: &str,
) -> PyResult<PyReadwriteArrayDyn<'py, T>> {
    array.try_readwrite().map_err(|error| {
        let is_writable =
            array.getattr("flags").and_then(|flags| flags.getattr("writeable")?.extract());
        match is_writable {
            Ok(false) => {
                PyValueError::new_err(format!("{what} must be writable, it is read-only"))
            }
            Ok(true) => busy(what),
            Err(_) => PyValueError::new_err(format!("{what}: {error}")),
        }
    })
}

/// A new array of numbers in rows.
pub(crate) fn table<'py>(
    py: Python<'py>,
    numbers: Vec<f64>,
    columns: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let rows = numbers.len().checked_div(columns).unwrap_or(0);
    numbers.into_pyarray(py).call_method1("reshape", (rows, columns))
}

/// A new array of numbers.
pub(crate) fn row<T: Element>(py: Python<'_>, numbers: Vec<T>) -> Bound<'_, PyAny> {
    numbers.into_pyarray(py).into_any()
}
