// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes moved and scaled.

use super::Shape;
use crate::error::ShapeError;
use crate::node::Node;
use crate::pose::{Pose, Rotation};
use crate::vector::Vector;

impl<const D: usize> Shape<D> {
    /// The shape moved by `world_from_body`. Every promise but symmetry is kept.
    ///
    /// Motions of a leaf, and motions of motions, become one; those of an operator
    /// go into its children where that costs no more.
    ///
    /// # Errors
    ///
    /// If a number is not finite, or shapes are nested too deeply.
    pub fn placed(self, world_from_body: &Pose<D>) -> Result<Self, ShapeError> {
        Self::from_node(Node::Placed { pose: *world_from_body, of: self })
    }

    /// The shape moved by `offset` [m].
    ///
    /// # Errors
    ///
    /// As [`placed`](Self::placed).
    pub fn translated(self, offset: impl Into<Vector<f64, D>>) -> Result<Self, ShapeError> {
        self.placed(&Pose::translation(offset))
    }

    /// The shape turned about the origin.
    ///
    /// # Errors
    ///
    /// As [`placed`](Self::placed).
    pub fn rotated(self, rotation: Rotation<D>) -> Result<Self, ShapeError> {
        self.placed(&Pose::rotation(rotation))
    }

    /// The shape scaled by `factor` about the origin: `s·f(p/s)`. Every promise
    /// is kept.
    ///
    /// # Errors
    ///
    /// If the factor is not positive, or shapes are nested too deeply.
    pub fn scaled(self, factor: f64) -> Result<Self, ShapeError> {
        Self::from_node(Node::Scaled { factor, of: self })
    }

    /// The shape scaled by `factors[i]` along axis `i`: `min sᵢ · f(pᵢ/sᵢ)`.
    ///
    /// A bound on both sides: no formula keeps distances under a stretch.
    ///
    /// # Errors
    ///
    /// If a factor is not positive, or shapes are nested too deeply.
    pub fn stretched(self, factors: impl Into<Vector<f64, D>>) -> Result<Self, ShapeError> {
        Self::from_node(Node::Stretched { factors: factors.into().0, of: self })
    }
}
