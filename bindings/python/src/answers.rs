// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Answers, as the frozen classes of the package.
//!
//! An answer that other doors give too has the fields that serde writes. Fields are set by hand in classes without such
//! a twin: arrays of many answers, which would be slow as objects first; and answers with names or shapes of Python.

use palpate::field::Promise;
use palpate::query::{Contact, Stop};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

use crate::arrays::table;

/// The module of the base of all answers.
const BASE: &str = "palpate._answer";

/// The fields of an answer, by name.
pub(crate) struct Fields<'py>(Bound<'py, PyDict>);

impl<'py> Fields<'py> {
    pub(crate) fn new(py: Python<'py>) -> Self {
        Self(PyDict::new(py))
    }

    /// The fields that serde writes of an answer.
    pub(crate) fn of(py: Python<'py>, answer: &impl Serialize) -> PyResult<Self> {
        Ok(Self(read(py, answer)?.cast_into()?))
    }

    /// The same with one more, or with another value of one.
    pub(crate) fn with(self, name: &str, value: impl IntoPyObject<'py>) -> PyResult<Self> {
        self.0.set_item(name, value)?;
        Ok(self)
    }

    /// The first of each, where each is an array.
    pub(crate) fn first(self) -> PyResult<Self> {
        for (name, values) in self.0.copy()? {
            self.0.set_item(name, values.get_item(0)?)?;
        }
        Ok(self)
    }

    /// An answer of a class with these fields, of the types that the class names.
    pub(crate) fn of_class(self, class: &str) -> PyResult<Bound<'py, PyAny>> {
        let py = self.0.py();
        let class = py.import("palpate")?.getattr(class)?;
        py.import(BASE)?.call_method1("built", (class, self.0))
    }
}

/// Data as the dicts, lists and numbers that serde writes. Infinite numbers stay.
pub(crate) fn read<'py>(py: Python<'py>, data: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    Ok(pythonize::pythonize(py, data)?)
}

/// Contacts as arrays with a row for each.
pub(crate) fn contacts<'py, const D: usize>(
    py: Python<'py>,
    all: &[Contact<D>],
) -> PyResult<Bound<'py, PyAny>> {
    let palpate = py.import("palpate")?;
    let (many, one) = (palpate.getattr("Contacts")?, palpate.getattr("Contact")?);
    py.import(BASE)?.call_method1("columns", (many, one, read(py, &all)?, D))
}

/// The reasons to end a search, in the order of their numbers in arrays.
pub(crate) const STOPS: [Stop; 6] = [
    Stop::Converged,
    Stop::SignKnown,
    Stop::BudgetSpent,
    Stop::MemoryFull,
    Stop::RoundingReached,
    Stop::Unresolved,
];

/// The number of a reason to end a search among `palpate.STOPS`.
pub(crate) fn stop_number(stop: Stop) -> u8 {
    // There is a place for each reason.
    STOPS.iter().zip(0..).find(|(own, _)| **own == stop).map_or(u8::MAX, |(_, number)| number)
}

/// The corners of the bounds, the lower first.
pub(crate) fn bounds<'py, const D: usize>(
    py: Python<'py>,
    promise: &Promise<D>,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let Some(bounds) = promise.bounds else { return Ok(None) };
    table(py, [bounds.aabb.min.0, bounds.aabb.max.0].concat(), D).map(Some)
}
