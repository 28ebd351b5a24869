// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies with stiffness and damping that a device can render.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use crate::bodies::Bodies;
use crate::protection::Protection;
use crate::tool::Coupling;
use palpate_safety::Accepted;

/// Bodies, and the virtual coupling of a tool, with stiffness and damping that a device can
/// render.
///
/// [`Servo::accept`](crate::Servo::accept) makes them for
/// [`replace_bodies`](crate::Servo::replace_bodies) of the same servo.
#[derive(Clone, Debug)]
pub struct AcceptedBodies<const D: usize> {
    pub(crate) bodies: Bodies<D>,
    /// The accepted coupling of the tool; `None` if the servo renders contact points.
    pub(crate) coupling: Option<Coupling>,
    /// Contact points: one entry per body. Tool: the translational entry, then the rotational
    /// one if the device gives a torque. Empty without protection.
    pub(crate) accepted: Vec<Accepted>,
    /// The protection of the servo, and of its clones, that they were accepted for; `None`
    /// without protection.
    pub(crate) protection: Option<Arc<Protection<D>>>,
}

impl<const D: usize> AcceptedBodies<D> {
    /// Unchanged bodies, for a servo without protection.
    pub(crate) fn unchanged(bodies: Bodies<D>) -> Self {
        Self { bodies, coupling: None, accepted: Vec::new(), protection: None }
    }

    /// `true` if both were accepted for the same servo.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn is_for_servo_of(&self, other: &Self) -> bool {
        match (&self.protection, &other.protection) {
            (None, None) => true,
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            _ => false,
        }
    }

    /// The bodies.
    #[must_use]
    pub fn bodies(&self) -> &Bodies<D> {
        &self.bodies
    }

    /// The stiffness and damping that the device renders, as in
    /// [`Servo::accepted`](crate::Servo::accepted).
    #[must_use]
    pub fn accepted(&self) -> &[Accepted] {
        &self.accepted
    }

    /// The stiffest translational entry; `None` without protection.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn along(&self) -> Option<&Accepted> {
        if self.coupling.is_some() {
            return self.accepted.first();
        }
        let stiffness = |accepted: &Accepted| accepted.impedance.stiffness();
        self.accepted.iter().max_by(|a, b| stiffness(a).total_cmp(&stiffness(b)))
    }

    /// The translational and the rotational entry of a tool on a device that gives a torque.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn wrench(&self) -> Option<(&Accepted, &Accepted)> {
        match (self.coupling, self.accepted.as_slice()) {
            (Some(_), [along, about]) => Some((along, about)),
            _ => None,
        }
    }
}
