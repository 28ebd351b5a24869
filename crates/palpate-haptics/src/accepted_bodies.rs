// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies with stiffness and damping that a device can render.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use crate::bodies::Bodies;
use crate::error::HapticsError;
use crate::protection::{Protection, Refusals};
use crate::tool::Coupling;
use palpate_device::TurningProfile;
use palpate_safety::{Acceptance, Accepted, DeviceLimits, Impedance, Requester};

/// Bodies, and the virtual coupling of a tool, with stiffness and damping that a device can
/// render.
///
/// [`Servo::accept`](crate::Servo::accept) makes them for
/// [`replace_bodies`](crate::Servo::replace_bodies) of the same servo.
#[derive(Clone, Debug)]
pub struct AcceptedBodies {
    pub(crate) bodies: Bodies,
    /// The accepted coupling of the tool; `None` if the servo renders contact points.
    pub(crate) coupling: Option<Coupling>,
    /// Contact points: one entry per body. Tool: the translational entry, then the rotational
    /// one if the device gives a torque. Empty without protection.
    pub(crate) accepted: Vec<Accepted>,
    /// The protection of the servo, and of its clones, that they were accepted for; `None`
    /// without protection.
    pub(crate) protection: Option<Arc<Protection>>,
}

impl AcceptedBodies {
    /// Unchanged bodies, for a servo without protection.
    pub(crate) fn unchanged(bodies: Bodies) -> Self {
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
    pub fn bodies(&self) -> &Bodies {
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

impl Protection {
    /// Accepts everything that a servo renders: its bodies, and with a tool the requested
    /// virtual coupling. A device that gives no force takes bodies as they are.
    #[inline(never)]
    pub(crate) fn accepted_bodies(
        self: &Arc<Self>,
        bodies: Bodies,
        requested: Option<Coupling>,
        rate: f64,
    ) -> Result<AcceptedBodies, HapticsError> {
        let protection = Some(self.clone());
        if self.profile.max_force == 0.0 {
            return Ok(AcceptedBodies { protection, ..AcceptedBodies::unchanged(bodies) });
        }
        if let Some(coupling) = requested {
            let (bodies, coupling, accepted) = self.accept_tool(bodies, coupling, rate)?;
            return Ok(AcceptedBodies {
                bodies,
                coupling: Some(coupling),
                accepted,
                protection,
            });
        }
        let (bodies, accepted) = self.accept(bodies, rate)?;
        Ok(AcceptedBodies { bodies, coupling: None, accepted, protection })
    }

    /// Accepts bodies and the coupling of a tool together: as layers in series with the coupling.
    /// If the device gives a torque, a second entry holds the accepted angular stiffness and
    /// damping.
    fn accept_tool(
        &self,
        mut bodies: Bodies,
        mut coupling: Coupling,
        rate: f64,
    ) -> Result<(Bodies, Coupling, Vec<Accepted>), HapticsError> {
        let mut refusals = self.refusals();
        self.accept_magnets(&mut bodies, rate, &mut refusals)?;
        self.stiffen(&mut bodies, rate)?;
        if self.settings.is_strict {
            self.refuse_tool(&bodies, &coupling, rate, &mut refusals)?;
            refusals.end()?;
        }
        let along = self.accepted(&in_series(&coupling, &layers(&bodies)?)?, rate)?;
        let (stiffness, damping) = (along.stiffness_factor, along.damping_factor);
        bodies.bodies_mut().iter_mut().for_each(|body| body.scale_surface(stiffness, damping));
        coupling = coupling.softened(stiffness, damping);
        let mut accepted = vec![along];
        if let Some(turning) = self.torques() {
            let turning = self.accept_turning(&layers(&bodies)?, &mut coupling, turning, rate);
            accepted.push(turning?);
        }
        Ok((bodies, coupling, accepted))
    }

    /// Refuses the coupling on each body, and about axes, of which the device renders less than all.
    fn refuse_tool(
        &self,
        bodies: &Bodies,
        coupling: &Coupling,
        rate: f64,
        refusals: &mut Refusals,
    ) -> Result<(), HapticsError> {
        for (number, body) in bodies.bodies().iter().enumerate() {
            let own: Vec<_> = body.surface().impedances().collect::<Result<_, _>>()?;
            let stiffest = own.iter().map(Impedance::stiffness).fold(0.0, f64::max);
            let is_softer = coupling.stiffness < stiffest;
            let requester =
                if is_softer { Requester::Coupling(number) } else { Requester::Body(number) };
            refusals.look(&self.accepted(&in_series(coupling, &own)?, rate)?, requester);
        }
        if let Some(turning) = self.torques() {
            let (part, damping) = coupling.borne(&layers(bodies)?);
            let asked = coupling.turning_on(part, damping)?;
            refusals.look(&self.turned(asked, turning, rate)?, Requester::AngularCoupling);
        }
        Ok(())
    }

    /// The rotational properties of a device that gives a torque.
    fn torques(&self) -> Option<&TurningProfile> {
        // Written so that NaN gives `None`.
        self.profile.turning.as_ref().filter(|turning| turning.max_torque > 0.0)
    }

    /// Scales the angular coupling to what the device can render on the stiffest layer. The
    /// device damping that remains limits the lever arms on which the bodies' dampers act.
    fn accept_turning(
        &self,
        layers: &[Impedance],
        coupling: &mut Coupling,
        turning: &TurningProfile,
        rate: f64,
    ) -> Result<Accepted, HapticsError> {
        let (part, damping) = coupling.borne(layers);
        if self.settings.is_strict {
            // Strict protection has refused a coupling of which less than all is rendered.
            return self.turned(coupling.turning_on(part, damping)?, turning, rate);
        }
        let accepted = self.turned(coupling.turning_on(part, 0.0)?, turning, rate)?;
        let (stiffness, own_damping) = (accepted.stiffness_factor, accepted.damping_factor);
        *coupling = coupling.softened_about_axes(stiffness, own_damping);
        if self.settings.acceptance != Acceptance::AsIs {
            let taken = 0.5 * accepted.device_stiffness / rate + accepted.device_damping;
            let left = (turning.least_damping - taken)
                .min(turning.max_damping - accepted.device_damping)
                .max(0.0);
            let needed = accepted.scale * coupling.damping_on_arms(damping);
            coupling.arms = if needed > left { (left / needed).sqrt() } else { 1.0 };
        }
        Ok(accepted)
    }

    /// What the device renders of a stiffness and a damping about axes.
    fn turned(
        &self,
        asked: Impedance,
        turning: &TurningProfile,
        rate: f64,
    ) -> Result<Accepted, HapticsError> {
        let limits = DeviceLimits::about(turning);
        // A torque at the device is this multiple of the torque in the world.
        let scale = 1.0 / self.map.scale();
        Ok(Accepted::of(asked, scale, &limits, self.settings.acceptance, rate)?)
    }
}

/// Stiffness and damping of every layer of every body.
fn layers(bodies: &Bodies) -> Result<Vec<Impedance>, HapticsError> {
    bodies.bodies().iter().flat_map(|body| body.surface().impedances()).collect()
}

/// The layers as the hand feels them through the coupling.
fn in_series(
    coupling: &Coupling,
    layers: &[Impedance],
) -> Result<Vec<Impedance>, HapticsError> {
    layers.iter().map(|layer| coupling.on(*layer)).collect()
}
