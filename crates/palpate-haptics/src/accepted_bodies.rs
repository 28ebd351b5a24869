// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies as a device can render them.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::bodies::Bodies;
use crate::tool::Coupling;
use palpate_safety::Accepted;

/// Bodies as a device can render them, and the coupling of a tool that touches them likewise.
///
/// Made by [`Servo::accept`](crate::Servo::accept), for the same servo's
/// [`replace_bodies`](crate::Servo::replace_bodies).
#[derive(Clone, Debug)]
pub struct AcceptedBodies<const D: usize> {
    pub(crate) bodies: Bodies<D>,
    /// `None` for contact points.
    pub(crate) coupling: Option<Coupling>,
    /// Contact points: one entry per body. Tool: along axes and, where the device gives a torque,
    /// about them. Empty without protection.
    pub(crate) accepted: Vec<Accepted>,
}

impl<const D: usize> AcceptedBodies<D> {
    /// Bodies as they are, for a servo without protection.
    pub(crate) fn unchanged(bodies: Bodies<D>) -> Self {
        Self { bodies, coupling: None, accepted: Vec::new() }
    }

    /// The bodies.
    #[must_use]
    pub fn bodies(&self) -> &Bodies<D> {
        &self.bodies
    }

    /// What became of the stiffness and damping; as [`Servo::accepted`](crate::Servo::accepted).
    #[must_use]
    pub fn accepted(&self) -> &[Accepted] {
        &self.accepted
    }

    /// The stiffest that is felt along axes; `None` without protection.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn along(&self) -> Option<&Accepted> {
        if self.coupling.is_some() {
            return self.accepted.first();
        }
        let stiffness = |accepted: &Accepted| accepted.impedance.stiffness();
        self.accepted.iter().max_by(|a, b| stiffness(a).total_cmp(&stiffness(b)))
    }

    /// For a tool on a device that gives a torque: along axes and about them.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn wrench(&self) -> Option<(&Accepted, &Accepted)> {
        match (self.coupling, self.accepted.as_slice()) {
            (Some(_), [along, about]) => Some((along, about)),
            _ => None,
        }
    }
}
