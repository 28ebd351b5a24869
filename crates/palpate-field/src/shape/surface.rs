// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes with their surface moved: offset, displacement, morphing.

use super::Shape;
use crate::error::ShapeError;
use crate::node::Node;

impl<const D: usize> Shape<D> {
    /// The shape grown by `distance` [m], or shrunk by it if negative: `f − r`.
    ///
    /// Growing keeps an exact outside, and an exact inside of convex shapes;
    /// shrinking keeps an exact inside. All else is a bound.
    ///
    /// # Errors
    ///
    /// If the distance is not finite, or shrinking leaves nothing of the shape's
    /// box.
    pub fn offset(self, distance: f64) -> Result<Self, ShapeError> {
        Self::from_node(Node::Offset { distance, of: self })
    }
}

impl<const D: usize> Shape<D> {
    /// The shape with its surface moved by another field, outwards where that is
    /// positive, by at most `height` [m]: `f − clamp(g, −h, h)`.
    ///
    /// Distances are no bounds, but at most as steep as both fields together.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::{Ball, HalfSpace}};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
    /// let hollow = Shape::from_kernel(Ball::new(0.1)?);
    /// let dented = floor.displaced(hollow, 0.02)?;
    /// assert_eq!(dented.distance(Vector([0.0, 0.0])), 0.02);
    /// assert_eq!(dented.distance(Vector([0.5, 0.0])), -0.02);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the height is not positive, or shapes are nested too deeply.
    pub fn displaced(self, by: Self, height: f64) -> Result<Self, ShapeError> {
        Self::from_node(Node::Displaced { of: self, by, height })
    }

    /// A shape on the way from this one (`progress` 0) to another (1): the weighted
    /// mean of both fields.
    ///
    /// A bound on both sides.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::Ball};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let small = Shape::from_kernel(Ball::new(0.1)?);
    /// let large = Shape::from_kernel(Ball::new(0.3)?);
    /// let between = small.morphed(large, 0.5)?;
    /// assert!((between.distance(Vector([0.5, 0.0])) - 0.3).abs() < 1e-15);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the progress is not from 0 to 1, or shapes are nested too deeply.
    pub fn morphed(self, into: Self, progress: f64) -> Result<Self, ShapeError> {
        Self::from_node(Node::Morphed { from: self, into, progress })
    }
}
