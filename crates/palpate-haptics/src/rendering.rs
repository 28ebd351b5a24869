// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a servo renders, as its device can.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::bodies::Bodies;
use crate::safety::Accepted;
use crate::tool::Coupling;

/// Bodies, what a tool with a shape touches them through, and what became of both on the way to
/// the device; of a servo that is not [protected](crate::Servo::protect), the bodies alone.
#[derive(Clone, Debug)]
pub(crate) struct Rendering<const D: usize> {
    pub(crate) bodies: Bodies<D>,
    /// None of contact points.
    pub(crate) coupling: Option<Coupling>,
    /// Of contact points, for each body; of a tool, along axes and, where the device gives a
    /// torque, about them.
    pub(crate) accepted: Vec<Accepted>,
}

impl<const D: usize> Rendering<D> {
    /// Bodies as they are.
    pub(crate) fn plain(bodies: Bodies<D>) -> Self {
        Self { bodies, coupling: None, accepted: Vec::new() }
    }

    /// The stiffest that is felt along axes, where anything was accepted.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn along(&self) -> Option<&Accepted> {
        if self.coupling.is_some() {
            return self.accepted.first();
        }
        let stiffness = |accepted: &Accepted| accepted.impedance.stiffness();
        self.accepted.iter().max_by(|a, b| stiffness(a).total_cmp(&stiffness(b)))
    }

    /// Of a tool on a device that gives a torque: along axes and about them.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn wrench(&self) -> Option<(&Accepted, &Accepted)> {
        match (self.coupling, self.accepted.as_slice()) {
            (Some(_), [along, about]) => Some((along, about)),
            _ => None,
        }
    }
}
