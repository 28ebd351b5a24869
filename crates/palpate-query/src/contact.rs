// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A place where two things touch.

use palpate_field::{Point, Vector};

/// One place where two things touch, or nearly do, in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<const D: usize> {
    /// The nearest point of the first thing's surface [m].
    pub point_a: Point<D>,
    /// The nearest point of the second thing's surface [m].
    pub point_b: Point<D>,
    /// The unit vector from the first thing to the second.
    pub normal: Vector<f64, D>,
    /// How far both surfaces are apart along the normal [m]; negative where they overlap.
    pub gap: f64,
    /// What tells this contact from the others, and stays while it lasts.
    pub id: u64,
}
