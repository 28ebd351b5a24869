// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes that are cut or joined in a loop.
//!
//! `plate -= hole` makes a new shape of all that came before. Of a short chain it is made at once, so that errors are
//! told where they arise; of a long one when it is first asked for, else the time would grow with the square of its
//! length.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::operators::{Combination, combined};
use crate::shape::{AnyShape, PyShape};

/// Chains of so many are made at once.
const SHORT: usize = 64;

/// A shape, or the end of a chain that makes one.
#[derive(Clone)]
pub(crate) struct Chain(Arc<Link>);

struct Link {
    dimension: usize,
    /// How many joints of one kind, or that were made at once, come before it.
    length: usize,
    made: OnceLock<AnyShape>,
    /// What it is made of, until it is made.
    joint: Mutex<Option<Joint>>,
}

/// A chain and what is joined to it.
struct Joint {
    how: Combination,
    to: Chain,
    item: AnyShape,
}

impl Chain {
    /// Of a shape that is there.
    pub(crate) fn of(shape: AnyShape) -> Self {
        let dimension = shape.dimension();
        let made = OnceLock::from(shape);
        Self(Arc::new(Link { dimension, length: 0, made, joint: Mutex::new(None) }))
    }

    pub(crate) fn dimension(&self) -> usize {
        self.0.dimension
    }

    /// Joined with another shape.
    pub(crate) fn joined(
        &self,
        py: Python<'_>,
        item: &AnyShape,
        how: Combination,
    ) -> PyResult<Self> {
        let dimension = self.dimension();
        if item.dimension() != dimension {
            let problem = format!(
                "both shapes must have the same dimension, got {dimension}D and {}D: extrude or revolve the flat one",
                item.dimension()
            );
            return Err(PyValueError::new_err(problem));
        }
        let goes_on = self.waits_for().is_none_or(|own| own == how);
        if !goes_on {
            self.made(py)?;
        }
        let length = if goes_on { self.0.length + 1 } else { 1 };
        let joint = Joint { how, to: self.clone(), item: item.clone() };
        let joined = Self(Arc::new(Link {
            dimension,
            length,
            made: OnceLock::new(),
            joint: Mutex::new(Some(joint)),
        }));
        if length <= SHORT {
            joined.made(py)?;
        }
        Ok(joined)
    }

    /// How it is joined to what came before, if it is not made yet.
    fn waits_for(&self) -> Option<Combination> {
        self.joint(|joint| joint.map(|joint| joint.how))
    }

    fn joint<T>(&self, look: impl FnOnce(Option<&Joint>) -> T) -> T {
        look(self.0.joint.lock().unwrap_or_else(PoisonError::into_inner).as_ref())
    }

    /// The shape, made of the nearest one before it that is there and of all that was joined since.
    pub(crate) fn made(&self, py: Python<'_>) -> PyResult<&AnyShape> {
        if let Some(made) = self.0.made.get() {
            return Ok(made);
        }
        let (mut items, mut at, mut how) = (Vec::new(), self.clone(), None);
        while at.0.made.get().is_none() {
            let next = at.joint(|joint| {
                joint.map(|joint| (joint.how, joint.to.clone(), joint.item.clone()))
            });
            // Made by another thread since.
            let Some((own, to, item)) = next else { continue };
            items.push(PyShape::from(item));
            (how, at) = (Some(own), to);
        }
        let (Some(how), Some(first)) = (how, at.0.made.get()) else {
            return Err(PyValueError::new_err("a shape of nothing"));
        };
        items.push(PyShape::from(first.clone()));
        items.reverse();
        let shape = combined(py, items, how)?.made(py)?.clone();
        let made = self.0.made.get_or_init(|| shape);
        // What it was made of is no longer needed, and is dropped outside of the lock.
        drop(self.0.joint.lock().unwrap_or_else(PoisonError::into_inner).take());
        Ok(made)
    }
}

impl Drop for Link {
    /// One joint after the other: each would else drop the one before within itself.
    fn drop(&mut self) {
        let mut next = self.joint.get_mut().unwrap_or_else(PoisonError::into_inner).take();
        while let Some(Joint { to, .. }) = next {
            next = Arc::try_unwrap(to.0).ok().and_then(|mut link| {
                link.joint.get_mut().unwrap_or_else(PoisonError::into_inner).take()
            });
        }
    }
}
