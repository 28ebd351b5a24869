// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The virtual coupling between hand and tool.

use super::state::ToolOptions;
use crate::error::HapticsError;
use palpate_device::NumberError;
use palpate_safety::Impedance;

/// The rendered spring and damper between hand and tool: as requested in the
/// [options](ToolOptions), or softer if the device of a [`Servo`](crate::Servo) requires it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// The stiffness [N/m].
    pub stiffness: f64,
    /// The damping [N·s/m].
    pub damping: f64,
    /// The angular stiffness [N·m/rad].
    pub angular_stiffness: f64,
    /// The angular damping [N·m·s/rad].
    pub angular_damping: f64,
    /// The factor on the lever arms of the bodies' dampers, in [0, 1]. The factor applies both
    /// to the sensed velocity and to the applied torque, which keeps the dampers dissipative.
    pub arms: f64,
    /// The longest lever arm of a body's damper: the tool's reach [m].
    longest_arm: f64,
}

impl Coupling {
    /// The coupling that `options` request, for a tool with this `reach` [m].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if a stiffness is not positive.
    pub(super) fn new(options: &ToolOptions, reach: f64) -> Result<Self, HapticsError> {
        let stiffness = NumberError::check_positive("stiffness", options.stiffness, "N/m")?;
        let angular_stiffness = NumberError::check_positive(
            "angular_stiffness",
            options.angular_stiffness_with(reach),
            "N·m/rad",
        )?;
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

    /// The length of a radian that makes the coupling equally stiff in translation and rotation
    /// [m].
    pub(crate) fn unit(&self) -> f64 {
        (self.angular_stiffness / self.stiffness).sqrt()
    }

    /// The translational stiffness and damping that the hand feels of a body with the impedance
    /// `body`.
    pub(crate) fn on(&self, body: Impedance) -> Result<Impedance, HapticsError> {
        let stiffness = self.stiffness.min(body.stiffness());
        Ok(Impedance::new(stiffness, self.damping + body.damping())?)
    }

    /// The largest part of the coupling that a layer bears, and the largest damping of a layer
    /// [N·s/m].
    pub(crate) fn borne(&self, layers: &[Impedance]) -> (f64, f64) {
        layers.iter().fold((0.0, 0.0), |(part, damping): (f64, f64), layer| {
            let borne = (layer.stiffness() / self.stiffness).min(1.0);
            (part.max(borne), damping.max(layer.damping()))
        })
    }

    /// The angular stiffness and damping that the hand feels, if bodies bear `part` of the
    /// coupling and have a `damping` [N·s/m] on the longest lever arm.
    pub(crate) fn turning_on(
        &self,
        part: f64,
        damping: f64,
    ) -> Result<Impedance, HapticsError> {
        let damping = self.angular_damping + self.damping_on_arms(damping);
        Ok(Impedance::new(self.angular_stiffness * part, damping)?)
    }

    /// The angular damping of a `damping` [N·s/m] on the longest lever arm [N·m·s/rad].
    pub(crate) fn damping_on_arms(&self, damping: f64) -> f64 {
        let arm = self.arms * self.longest_arm;
        damping * arm * arm
    }

    /// This coupling with these shares of its stiffness and of its damping, along and about axes.
    #[must_use]
    pub(crate) fn softened(self, stiffness: f64, damping: f64) -> Self {
        Self {
            stiffness: self.stiffness * stiffness,
            damping: self.damping * damping,
            ..self.softened_about_axes(stiffness, damping)
        }
    }

    /// This coupling with these shares of its angular stiffness and of its angular damping.
    #[must_use]
    pub(crate) fn softened_about_axes(self, stiffness: f64, damping: f64) -> Self {
        Self {
            angular_stiffness: self.angular_stiffness * stiffness,
            angular_damping: self.angular_damping * damping,
            ..self
        }
    }
}
