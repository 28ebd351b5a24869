// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Translations that are proven not to separate two bodies.

use palpate_field::Vector;

use super::support::InnerBall;

/// Translations of the second body that are nearer than `radius` to `centre`. Under each of them a
/// ball within the first body and one within the second overlap, so the bodies do.
#[derive(Clone, Copy, Debug)]
pub(super) struct OverlapBall<const D: usize> {
    pub(super) centre: Vector<f64, D>,
    /// The sum of both radii [m].
    pub(super) radius: f64,
}

impl<const D: usize> OverlapBall<D> {
    /// That of a ball within each body.
    pub(super) fn of([a, b]: [InnerBall<D>; 2]) -> Self {
        Self { centre: a.centre - b.centre, radius: a.radius + b.radius }
    }

    /// The ball between this one and another, at a share of the way. Of convex bodies it holds
    /// translations under which they overlap too: such translations make a convex set.
    pub(super) fn between(&self, other: &Self, share: f64) -> Self {
        let mean = 1.0 - share;
        Self {
            centre: self.centre * mean + other.centre * share,
            radius: self.radius * mean + other.radius * share,
        }
    }
}
