// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A solid as a field.

use palpate_field::{CustomField, Point, Promise, Shape, Vector};

use super::Solid;

impl<const N: usize, const D: usize> CustomField<D> for Solid<N, D> {
    fn distance(&self, p: Point<D>) -> f64 {
        self.at(p).0
    }

    fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        self.at(p)
    }

    fn promise(&self) -> &Promise<D> {
        self.promise()
    }
}

impl<const N: usize, const D: usize> From<Solid<N, D>> for Shape<D> {
    fn from(solid: Solid<N, D>) -> Self {
        Self::custom(solid)
    }
}
