// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Errors of palpate as exceptions of Python, with what they know as attributes.

use std::io;

use palpate::{Error, ErrorKind};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The class of `palpate._errors` for an error.
fn class(error: &Error) -> &'static str {
    match error.kind() {
        ErrorKind::Shape => "ShapeError",
        ErrorKind::Query => "QueryError",
        ErrorKind::Haptics => "HapticsError",
        ErrorKind::Device => "DeviceError",
        ErrorKind::Mesh => "MeshError",
        ErrorKind::Grid => "GridError",
        ErrorKind::Scene => "SceneError",
        ErrorKind::Plot => "PlotError",
        ErrorKind::UnknownName => "UnknownNameError",
        ErrorKind::DeviceLost => "DeviceLostError",
        ErrorKind::File if error.io_kind() == Some(io::ErrorKind::NotFound) => {
            "MissingFileError"
        }
        ErrorKind::File => "FileError",
        _ => "Error",
    }
}

/// The exception for an error.
pub(crate) fn raised(py: Python<'_>, error: impl Into<Error>) -> PyErr {
    let error = error.into();
    let made = || -> PyResult<PyErr> {
        let class = py.import("palpate._errors")?.getattr(class(&error))?;
        let known = PyDict::new(py);
        known.set_item("parameter", error.parameter())?;
        known.set_item("rule", error.rule())?;
        known.set_item("value", error.value())?;
        known.set_item("unit", error.unit())?;
        known.set_item("path", error.path())?;
        known.set_item("line", error.line())?;
        known.set_item("column", error.column())?;
        Ok(PyErr::from_value(class.call((error.to_string(),), Some(&known))?))
    };
    made().unwrap_or_else(|error| error)
}

/// Turns the error of a result into an exception.
pub(crate) trait OrRaise<T> {
    fn or_raise(self, py: Python<'_>) -> PyResult<T>;
}

impl<T, E: Into<Error>> OrRaise<T> for Result<T, E> {
    fn or_raise(self, py: Python<'_>) -> PyResult<T> {
        self.map_err(|error| raised(py, error))
    }
}
