// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A sector of a disc.

use crate::scalar::Scalar;

/// The sector of a disc about the origin between the +y axis and an angle from it.
///
/// # Derivation
///
/// The boundary is the arc and the straight edge from the origin to its end. Past
/// the edge's line the edge is nearer than the arc. Before it, a point is inside up
/// to the radius: there the nearer of arc and edge counts, and beyond it the arc,
/// since its nearest point is on the way to the origin.
#[derive(Clone, Debug)]
pub(in crate::kernel) struct Sector {
    radius: f64,
    /// The direction of the edge: sine and cosine of the angle.
    edge: [f64; 2],
}

impl Sector {
    /// The sector of a disc of `radius` [m] up to `angle` [rad], less than π.
    pub(in crate::kernel) fn new(radius: f64, angle: f64) -> Self {
        Self { radius, edge: [libm::sin(angle), libm::cos(angle)] }
    }

    /// From the origin to the arc [m].
    pub(in crate::kernel) fn radius(&self) -> f64 {
        self.radius
    }

    /// The direction of the edge: sine and cosine of the angle.
    pub(in crate::kernel) fn edge(&self) -> [f64; 2] {
        self.edge
    }

    /// The signed distance.
    #[inline(always)]
    pub(in crate::kernel) fn distance<S: Scalar>(&self, p: [S; 2]) -> S {
        let [sin, cos] = self.edge;
        let past = S::weighted_sum(p, &[cos, -sin]);
        let along = S::weighted_sum(p, &[sin, cos]);
        let beyond = along - along.clamp(0.0, self.radius);
        let edge = S::norm([past, beyond]);
        let arc = S::norm(p) - S::constant(self.radius);
        S::select_less(past, S::constant(0.0), arc.max(-edge), edge)
    }
}
