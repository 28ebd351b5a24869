// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sharp and smooth booleans of shapes.

use super::Shape;
use crate::error::ShapeError;
use crate::node::{Boolean, Node};
use crate::operator::Profile;

impl<const D: usize> Shape<D> {
    /// The union of all `shapes`: `min(a, b, …)`.
    ///
    /// Exact outside if all are, a bound inside. Unions among the shapes are
    /// flattened. Members out of reach of the points asked for are skipped.
    ///
    /// # Errors
    ///
    /// If there are no shapes, or they are nested too deeply.
    pub fn union(shapes: impl IntoIterator<Item = Self>) -> Result<Self, ShapeError> {
        Self::from_node(Node::Union(shapes.into_iter().collect()))
    }

    /// The intersection of all `shapes`: `max(a, b, …)`.
    ///
    /// A bound outside, exact inside if all are. Intersections among the shapes are
    /// flattened.
    ///
    /// # Errors
    ///
    /// If there are no shapes, or they are nested too deeply.
    pub fn intersection(shapes: impl IntoIterator<Item = Self>) -> Result<Self, ShapeError> {
        Self::from_node(Node::Intersection(shapes.into_iter().collect()))
    }

    /// This shape without `others`: `max(a, −b, …)`.
    ///
    /// A bound outside; exact inside if this shape is exact inside and all
    /// others outside. A difference of a difference is flattened.
    ///
    /// # Errors
    ///
    /// If shapes are nested too deeply.
    pub fn difference(
        self,
        others: impl IntoIterator<Item = Self>,
    ) -> Result<Self, ShapeError> {
        Self::from_node(Node::Difference(std::iter::once(self).chain(others).collect()))
    }

    /// What is in an odd number of `shapes`: `max(min(a, b), −max(a, b))`.
    ///
    /// A bound on both sides.
    ///
    /// # Errors
    ///
    /// If there are no shapes, or they are nested too deeply.
    pub fn symmetric_difference(
        shapes: impl IntoIterator<Item = Self>,
    ) -> Result<Self, ShapeError> {
        Self::from_node(Node::SymmetricDifference(shapes.into_iter().collect()))
    }
}

impl<const D: usize> Shape<D> {
    /// The union of `shapes` with the creases between them filled.
    ///
    /// `width` is the fill where two distances are equal [m]: the surface moves
    /// outwards by at most that for every shape but the first. The fill begins where two
    /// distances differ by less than the reach of the profile, a multiple of the width. More than
    /// two shapes are folded in their order.
    ///
    /// A bound on both sides, with Lipschitz constant 1 for exact shapes and bounds;
    /// [`Profile::CircularGeometrical`] has √2 instead, and is no bound. Shapes whose
    /// values may fall below the distance to their box are guarded by it first, so
    /// that the bounds hold.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::HalfSpace, operator::Profile};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let floor = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), 0.0)?);
    /// let wall = Shape::from_kernel(HalfSpace::new(Vector([1.0, 0.0]), 0.0)?);
    /// let corner = Shape::smooth_union([floor, wall], Profile::Cubic, 0.01)?;
    /// assert!((corner.distance(Vector([0.0, 0.0])) + 0.01).abs() < 1e-17);
    /// assert_eq!(corner.distance(Vector([0.06, 0.0])), 0.0); // past the reach of 0.06 m
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the width is not positive, there are no shapes, or they are nested too
    /// deeply.
    pub fn smooth_union(
        shapes: impl IntoIterator<Item = Self>,
        profile: Profile,
        width: f64,
    ) -> Result<Self, ShapeError> {
        let boolean = Boolean::Union;
        let of = shapes.into_iter().collect();
        Self::from_node(Node::Smooth { boolean, profile, width, of })
    }

    /// The intersection of `shapes` with the edges between them cut off: the surface
    /// moves inwards by at most `width` [m] for every shape but the first.
    ///
    /// Promises as of [`smooth_union`](Self::smooth_union).
    ///
    /// # Errors
    ///
    /// As [`smooth_union`](Self::smooth_union).
    pub fn smooth_intersection(
        shapes: impl IntoIterator<Item = Self>,
        profile: Profile,
        width: f64,
    ) -> Result<Self, ShapeError> {
        let boolean = Boolean::Intersection;
        let of = shapes.into_iter().collect();
        Self::from_node(Node::Smooth { boolean, profile, width, of })
    }

    /// This shape without `others`, the edges of the cuts rounded off: the surface
    /// moves inwards by at most `width` [m] for each of the others.
    ///
    /// Promises as of [`smooth_union`](Self::smooth_union).
    ///
    /// # Errors
    ///
    /// If the width is not positive, or shapes are nested too deeply.
    pub fn smooth_difference(
        self,
        others: impl IntoIterator<Item = Self>,
        profile: Profile,
        width: f64,
    ) -> Result<Self, ShapeError> {
        let boolean = Boolean::Difference;
        let of = std::iter::once(self).chain(others).collect();
        Self::from_node(Node::Smooth { boolean, profile, width, of })
    }
}
