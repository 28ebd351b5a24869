// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What answers of several commands have in common.

use palpate::field::Aabb;
use serde::Serialize;

/// The corners of a box [m].
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Bounds {
    /// The corner with the least coordinates [m].
    pub(crate) min: Vec<f64>,
    /// The corner with the largest coordinates [m].
    pub(crate) max: Vec<f64>,
}

impl Bounds {
    /// The lengths of the edges [m].
    pub(crate) fn size(&self) -> Vec<f64> {
        self.max.iter().zip(&self.min).map(|(max, min)| max - min).collect()
    }
}

impl<const D: usize> From<Aabb<D>> for Bounds {
    fn from(aabb: Aabb<D>) -> Self {
        Self { min: aabb.min.0.to_vec(), max: aabb.max.0.to_vec() }
    }
}
