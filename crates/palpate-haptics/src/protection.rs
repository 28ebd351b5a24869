// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Protection of a servo: the workspace map, and what the device can render.

use crate::bodies::Bodies;
use crate::error::HapticsError;
use palpate_safety::{
    Acceptance, Accepted, DeviceLimits, DeviceProfile, Impedance, WorkspaceMap,
};

/// How a servo protects a device and the hand that holds it.
///
/// # Examples
///
/// ```
/// use palpate_field::{Shape, kernel::Ball};
/// use palpate_haptics::{DeviceProfile, Protection, ServoOptions, UnprotectedServo};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
/// let device = DeviceProfile::unlimited("example").with_max_force(2.0);
/// let protection = Protection::new(device).with_passivity_control(false);
/// let servo = UnprotectedServo::new(ball, 1, ServoOptions::default())?.protected(&protection)?;
/// assert_eq!(servo.options().max_force, 2.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Protection<const D: usize> {
    /// The limits and properties of the device.
    pub profile: DeviceProfile,
    /// The map between device and world coordinates.
    pub map: WorkspaceMap<D>,
    /// How bodies that the device cannot render are treated.
    pub acceptance: Acceptance,
    /// Whether the passivity controller acts; the passivity observer always runs.
    pub has_passivity_control: bool,
    /// The time over which the force rises after the start and after a proxy is placed anew
    /// [s].
    pub rise_time: f64,
}

impl<const D: usize> Protection<D> {
    /// Protection with every stage on and the identity map. Bodies that the device cannot
    /// render are made softer; forces rise within 0.1 s.
    #[must_use]
    pub fn new(profile: DeviceProfile) -> Self {
        Self {
            profile,
            map: WorkspaceMap::default(),
            acceptance: Acceptance::Scaled,
            has_passivity_control: true,
            rise_time: 0.1,
        }
    }

    /// The same protection with another map between device and world coordinates.
    #[must_use]
    pub fn with_map(self, map: WorkspaceMap<D>) -> Self {
        Self { map, ..self }
    }

    /// The same protection with another way to treat bodies that the device cannot render.
    #[must_use]
    pub fn with_acceptance(self, acceptance: Acceptance) -> Self {
        Self { acceptance, ..self }
    }

    /// The same protection with the passivity controller on or off.
    #[must_use]
    pub fn with_passivity_control(self, is_on: bool) -> Self {
        Self { has_passivity_control: is_on, ..self }
    }

    /// The same protection with another time over which the force rises [s].
    #[must_use]
    pub fn with_rise_time(self, rise_time: f64) -> Self {
        Self { rise_time, ..self }
    }

    /// The bodies as the device renders them at `rate` [Hz]: the stiffness and damping of each
    /// body are scaled by the factor that its worst layer needs.
    ///
    /// # Errors
    ///
    /// As [`Accepted::new`], or [`Accepted::strict`] with [`Acceptance::Strict`].
    pub fn accept(
        &self,
        mut bodies: Bodies<D>,
        rate: f64,
    ) -> Result<(Bodies<D>, Vec<Accepted>), HapticsError> {
        let mut all = Vec::with_capacity(bodies.bodies().len());
        for body in bodies.bodies_mut() {
            let mut worst: Option<Accepted> = None;
            for impedance in body.surface().impedances() {
                let accepted = self.accepted(impedance?, rate)?;
                if worst.as_ref().is_none_or(|worst| accepted.factor < worst.factor) {
                    worst = Some(accepted);
                }
            }
            let Some(worst) = worst else { continue };
            if worst.factor < 1.0 {
                body.scale_surface(worst.factor);
            }
            all.push(worst);
        }
        Ok((bodies, all))
    }

    pub(crate) fn accepted(
        &self,
        impedance: Impedance,
        rate: f64,
    ) -> Result<Accepted, HapticsError> {
        let scale = self.map.scale();
        let limits = DeviceLimits::along(&self.profile);
        Ok(Accepted::of(impedance, scale, &limits, self.acceptance, rate)?)
    }
}
