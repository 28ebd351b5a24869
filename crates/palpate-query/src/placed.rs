// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes with a pose in the world.

use palpate_field::{LARGEST_LENGTH, Pose, Shape};

use crate::error::QueryError;

/// A shape and its pose. A plain `&Shape` converts to one at the identity.
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
/// use palpate_query::{Limits, PairWorkspace, Placed, separation};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::from_kernel(Ball::new(1.0)?);
/// let there = Placed::new(&ball, Pose::translation(Vector([0.0, 5.0, 0.0])));
/// let apart = separation(&ball, there, &Limits::new(1e-4), &mut PairWorkspace::new())?;
/// assert!(apart.lower <= 3.0 && 3.0 <= apart.upper);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a, const D: usize> {
    /// The shape.
    pub shape: &'a Shape<D>,
    /// From the shape's coordinates to the world's.
    pub world_from_body: Pose<D>,
}

impl<'a, const D: usize> Placed<'a, D> {
    /// `shape` moved by `world_from_body`.
    #[must_use]
    pub fn new(shape: &'a Shape<D>, world_from_body: Pose<D>) -> Self {
        Self { shape, world_from_body }
    }
}

impl<'a, const D: usize> From<&'a Shape<D>> for Placed<'a, D> {
    fn from(shape: &'a Shape<D>) -> Self {
        Self::new(shape, Pose::identity())
    }
}

/// Refuses the pose at this index if it is not finite, or so far away that squares overflow.
pub(crate) fn check_pose<const D: usize>(
    index: usize,
    pose: &Pose<D>,
) -> Result<(), QueryError> {
    if !pose.is_finite() {
        return Err(QueryError::Pose { index });
    }
    let far = pose.translation.0.into_iter().find(|x| x.abs() > LARGEST_LENGTH);
    far.map_or(Ok(()), |value| Err(QueryError::Coordinate { what: "translation", value }))
}
