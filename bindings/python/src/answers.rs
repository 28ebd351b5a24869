// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Answers, as the frozen classes of the package.

use numpy::IntoPyArray;
use palpate::field::{Deviation, Promise, Quality, Vector};
use palpate::query::{AtPoint, Certified, Contact, Stop};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::table;

/// The fields of an answer, by name.
pub(crate) struct Fields<'py>(Bound<'py, PyDict>);

impl<'py> Fields<'py> {
    pub(crate) fn new(py: Python<'py>) -> Self {
        Self(PyDict::new(py))
    }

    /// The same with one more.
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

    /// An answer of a class with these fields.
    pub(crate) fn of_class(self, class: &str) -> PyResult<Bound<'py, PyAny>> {
        let class = self.0.py().import("palpate")?.getattr(class)?;
        class.call((), Some(&self.0))
    }
}

/// A vector as an array.
pub(crate) fn vector<const D: usize>(py: Python<'_>, v: Vector<f64, D>) -> Bound<'_, PyAny> {
    v.0.to_vec().into_pyarray(py).into_any()
}

fn quality(quality: Quality) -> &'static str {
    match quality {
        Quality::Exact => "exact",
        Quality::Bound => "bound",
        Quality::Lipschitz => "lipschitz",
    }
}

/// The reasons to end a search, in the order of their numbers in arrays.
pub(crate) const STOPS: [Stop; 5] = [
    Stop::Converged,
    Stop::SignKnown,
    Stop::BudgetSpent,
    Stop::MemoryFull,
    Stop::RoundingReached,
];

/// The number of a reason to end a search among `palpate.STOPS`.
pub(crate) fn stop_number(stop: Stop) -> u8 {
    // There is a place for each reason.
    STOPS.iter().zip(0..).find(|(own, _)| **own == stop).map_or(u8::MAX, |(_, number)| number)
}

/// Why a search ended, in one word.
pub(crate) const fn stop(stop: Stop) -> &'static str {
    match stop {
        Stop::Converged => "converged",
        Stop::SignKnown => "sign_known",
        Stop::BudgetSpent => "budget_spent",
        Stop::MemoryFull => "memory_full",
        Stop::RoundingReached => "rounding_reached",
    }
}

/// The corners of the bounds, the lower first.
pub(crate) fn bounds<'py, const D: usize>(
    py: Python<'py>,
    promise: &Promise<D>,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let Some(bounds) = promise.bounds else { return Ok(None) };
    table(py, [bounds.aabb.min.0, bounds.aabb.max.0].concat(), D).map(Some)
}

pub(crate) fn promise<'py, const D: usize>(
    py: Python<'py>,
    of: &Promise<D>,
) -> PyResult<Bound<'py, PyAny>> {
    let deviation = of.deviation.map(|Deviation { value, within, .. }| (value, within));
    Fields::new(py)
        .with("outside", quality(of.outside))?
        .with("inside", quality(of.inside))?
        .with("lipschitz", of.lipschitz)?
        .with("bounds", bounds(py, of)?)?
        .with("convex", of.convex)?
        .with("has_interior", of.has_interior)?
        .with("deviation", deviation)?
        .with("in_words", of.in_words())?
        .of_class("Promise")
}

pub(crate) fn at_point<'py, const D: usize>(
    py: Python<'py>,
    at: &AtPoint<D>,
) -> PyResult<Bound<'py, PyAny>> {
    Fields::new(py)
        .with("point", vector(py, at.point))?
        .with("distance", at.distance)?
        .with("gradient", vector(py, at.gradient))?
        .with("normal", at.normal.map(|v| vector(py, v)))?
        .with("surface", at.surface.map(|v| vector(py, v)))?
        .with("safe_radius", at.safe_radius)?
        .with("quality", quality(at.quality))?
        .with("rounding", at.rounding)?
        .of_class("AtPoint")
}

/// What all searches say: their bounds and how they ended.
pub(crate) fn certified<'py, T>(py: Python<'py>, of: &Certified<T>) -> PyResult<Fields<'py>> {
    Fields::new(py)
        .with("lower", of.lower)?
        .with("upper", of.upper)?
        .with("stop", stop(of.stop))?
        .with("evaluations", of.evaluations)
}

pub(crate) fn contact<'py, const D: usize>(
    py: Python<'py>,
    of: &Contact<D>,
) -> PyResult<Bound<'py, PyAny>> {
    Fields::new(py)
        .with("point_a", vector(py, of.point_a))?
        .with("point_b", vector(py, of.point_b))?
        .with("normal", vector(py, of.normal))?
        .with("gap", of.gap)?
        .with("normal_from", of.normal_from.to_string())?
        .with("on_surfaces", of.on_surfaces)?
        .with("id", of.id)?
        .of_class("Contact")
}
