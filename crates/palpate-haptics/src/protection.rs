// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Protection of a servo: the workspace map, and what the device can render.

use crate::bodies::{Bodies, Body};
use crate::error::HapticsError;
use crate::guide::Guide;
use palpate_device::DeviceProfile;
use palpate_safety::{
    Accepted, DeviceLimits, Impedance, Refused, Requester, SafetyError, SafetySettings,
    WorkspaceMap,
};

/// How a servo protects a device and the hand that holds it.
///
/// # Examples
///
/// ```
/// use palpate_field::{Shape, kernel::Ball};
/// use palpate_device::DeviceProfile;
/// use palpate_haptics::{Protection, ServoOptions, Servo};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
/// let device = DeviceProfile { max_force: 2.0, ..DeviceProfile::unlimited("example") };
/// let protection = Protection::new(device).with(|s| s.has_passivity_control = false);
/// let servo = Servo::new(ball, 1, ServoOptions::default())?.protected(&protection)?;
/// assert_eq!(servo.options().max_force, 2.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Protection {
    /// The limits and properties of the device.
    pub profile: DeviceProfile,
    /// The map between device and world coordinates.
    pub map: WorkspaceMap,
    /// How the safety chains protect.
    pub settings: SafetySettings,
}

impl Protection {
    /// Protection with the identity map and the [default settings](SafetySettings::default): every
    /// stage acts.
    #[must_use]
    pub fn new(profile: DeviceProfile) -> Self {
        Self { profile, map: WorkspaceMap::default(), settings: SafetySettings::default() }
    }

    /// This protection with changed settings.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut SafetySettings)) -> Self {
        change(&mut self.settings);
        self
    }

    /// This protection with another map between device and world coordinates.
    #[must_use]
    pub fn with_map(self, map: WorkspaceMap) -> Self {
        Self { map, ..self }
    }

    /// The bodies as the device renders them at `rate` [Hz]: all layers of a body have the share of
    /// stiffness and the share of damping that [`Accepted::of_layers`] gives.
    ///
    /// # Errors
    ///
    /// As [`Accepted::new`]; [`SafetyError::MaterialRefused`](palpate_safety::SafetyError) of strict
    /// protection, with everything that is refused.
    #[inline(never)]
    pub fn accept(
        &self,
        mut bodies: Bodies,
        rate: f64,
    ) -> Result<(Bodies, Vec<Accepted>), HapticsError> {
        let mut all = Vec::with_capacity(bodies.bodies().len());
        let mut refusals = self.refusals();
        self.accept_magnets(&mut bodies, rate, &mut refusals)?;
        self.stiffen(&mut bodies, rate)?;
        for (number, body) in bodies.bodies_mut().iter_mut().enumerate() {
            let layers: Vec<_> = body.surface().impedances().collect::<Result<_, _>>()?;
            let accepted = self.accepted(&layers, rate)?;
            refusals.look(&accepted, Requester::Body(number));
            body.scale_surface(accepted.stiffness_factor, accepted.damping_factor);
            all.push(accepted);
        }
        refusals.end()?;
        Ok((bodies, all))
    }

    /// The guides as the device renders them at `rate` [Hz], each by the rules of a material. A
    /// device that gives no force takes them as they are.
    ///
    /// # Errors
    ///
    /// As [`accept`](Self::accept).
    #[inline(never)]
    pub fn accept_guides(
        &self,
        guides: &[Guide],
        rate: f64,
    ) -> Result<(Vec<Guide>, Vec<Accepted>), HapticsError> {
        if self.profile.max_force == 0.0 {
            return Ok((guides.to_vec(), Vec::new()));
        }
        let mut all = (Vec::with_capacity(guides.len()), Vec::with_capacity(guides.len()));
        let mut refusals = self.refusals();
        for (number, guide) in guides.iter().enumerate() {
            let accepted = self.accepted(&[guide.impedance()?], rate)?;
            refusals.look(&accepted, Requester::Guide(number));
            let (stiffness, damping) = (accepted.stiffness_factor, accepted.damping_factor);
            all.0.push(guide.clone().softened(stiffness, damping));
            all.1.push(accepted);
        }
        refusals.end()?;
        Ok(all)
    }

    /// Softens the magnets of bodies to what the device renders, as if they were materials.
    pub(crate) fn accept_magnets(
        &self,
        bodies: &mut Bodies,
        rate: f64,
        refusals: &mut Refusals,
    ) -> Result<(), HapticsError> {
        for (number, body) in bodies.bodies_mut().iter_mut().enumerate() {
            let Some(magnet) = &body.surface().magnet else { continue };
            let impedance = Impedance::new(magnet.stiffness(), 0.0)?;
            let accepted = self.accepted(&[impedance], rate)?;
            refusals.look(&accepted, Requester::Magnet(number));
            body.scale_magnet(accepted.stiffness_factor);
        }
        Ok(())
    }

    /// Gives surfaces of a relative stiffness that which they have on the device.
    pub(crate) fn stiffen(&self, bodies: &mut Bodies, rate: f64) -> Result<(), HapticsError> {
        // Where nothing is relative, the device need not have a largest stiffness.
        let is_relative = |body: &Body| body.surface().is_relative();
        if bodies.bodies().iter().any(is_relative) {
            let most = Accepted::most_stiffness(
                &DeviceLimits::along(&self.profile),
                self.settings.acceptance,
                rate,
            )? / self.map.scale();
            bodies.bodies_mut().iter_mut().for_each(|body| body.stiffen(most));
        }
        Ok(())
    }

    /// What the device renders of layers.
    pub(crate) fn accepted(
        &self,
        layers: &[Impedance],
        rate: f64,
    ) -> Result<Accepted, HapticsError> {
        let scale = self.map.scale();
        let limits = DeviceLimits::along(&self.profile);
        Ok(Accepted::of_layers(layers, scale, &limits, self.settings.acceptance, rate)?)
    }

    /// Where strict protection collects what it refuses.
    pub(crate) fn refusals(&self) -> Refusals {
        Refusals { is_strict: self.settings.is_strict, all: Vec::new() }
    }
}

/// What strict protection refuses; nothing if it is not strict.
#[derive(Debug)]
pub(crate) struct Refusals {
    is_strict: bool,
    all: Vec<Refused>,
}

impl Refusals {
    /// Refuses what the device renders less of than `requester` asks for.
    pub(crate) fn look(&mut self, accepted: &Accepted, requester: Requester) {
        if self.is_strict {
            self.all.extend(accepted.refusal(requester));
        }
    }

    /// An error with all refusals, if there are any.
    pub(crate) fn end(self) -> Result<(), SafetyError> {
        if self.all.is_empty() { Ok(()) } else { Err(SafetyError::MaterialRefused(self.all)) }
    }
}
