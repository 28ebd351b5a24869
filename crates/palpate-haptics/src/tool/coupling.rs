// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What hangs a tool on the hand.

use super::state::ToolOptions;
use crate::error::HapticsError;
use palpate_safety::Impedance;
use palpate_safety::positive;

/// The spring and damper between hand and tool as they are rendered: those of the
/// [options](ToolOptions), or softer ones, where the device of a [`Servo`](crate::Servo)
/// device needs them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// [N/m].
    pub stiffness: f64,
    /// [N·s/m].
    pub damping: f64,
    /// [N·m/rad].
    pub angular_stiffness: f64,
    /// [N·m·s/rad].
    pub angular_damping: f64,
    /// The part of their arms on which the bodies' dampers turn the hand, in [0, 1]. As they
    /// see less of how it turns, and turn it by less, what is left takes energy from it as
    /// before.
    pub arms: f64,
    /// The longest arm on which a body's damper can act: the tool's reach [m].
    longest_arm: f64,
}

impl Coupling {
    /// As `options` have it, for a tool that reaches as far as `reach` [m].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if a stiffness is not positive.
    pub(super) fn new(options: &ToolOptions, reach: f64) -> Result<Self, HapticsError> {
        let stiffness = positive("stiffness", options.stiffness, "N/m")?;
        let natural = 0.5 * stiffness * reach * reach;
        let angular_stiffness = options.angular_stiffness.unwrap_or(natural);
        let angular_stiffness = positive("angular_stiffness", angular_stiffness, "N·m/rad")?;
        let ToolOptions { damping, angular_damping, .. } = *options;
        Ok(Self {
            stiffness,
            damping,
            angular_stiffness,
            angular_damping,
            arms: 1.0,
            longest_arm: reach,
        })
    }

    /// A radian as a length, so that the coupling is as stiff about axes as along them [m].
    pub(crate) fn unit(&self) -> f64 {
        (self.angular_stiffness / self.stiffness).sqrt()
    }

    /// What the hand feels along axes of a body like that.
    pub(crate) fn on(&self, body: Impedance) -> Result<Impedance, HapticsError> {
        let stiffness = self.stiffness.min(body.stiffness());
        Ok(Impedance::new(stiffness, self.damping + body.damping())?)
    }

    /// What it feels about axes, where bodies bear a `part` of the coupling, and have a
    /// `damping` [N·s/m] on the longest arm on which it acts.
    pub(crate) fn turning_on(
        &self,
        part: f64,
        damping: f64,
    ) -> Result<Impedance, HapticsError> {
        let damping = self.angular_damping + self.damping_on_arms(damping);
        Ok(Impedance::new(self.angular_stiffness * part, damping)?)
    }

    /// What a `damping` [N·s/m] is about axes, on the longest arm [N·m·s/rad].
    pub(crate) fn damping_on_arms(&self, damping: f64) -> f64 {
        let arm = self.arms * self.longest_arm;
        damping * arm * arm
    }

    /// The same, `factor` times as stiff and as damped.
    #[must_use]
    pub(crate) fn softened(self, factor: f64) -> Self {
        let (stiffness, damping) = (self.stiffness * factor, self.damping * factor);
        Self { stiffness, damping, ..self.softened_about_axes(factor) }
    }

    /// The same, `factor` times as stiff and as damped about axes.
    #[must_use]
    pub(crate) fn softened_about_axes(self, factor: f64) -> Self {
        Self {
            angular_stiffness: self.angular_stiffness * factor,
            angular_damping: self.angular_damping * factor,
            ..self
        }
    }
}
