// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A tool as a servo holds it: with the servo's options, and as traces show it.

use palpate_field::{Pose, Vector};

use super::Tool;
use super::twist::Twist;
use crate::options::ServoOptions;

/// A tool after a tick, for traces and snapshots. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct HeldTool {
    /// The pose of the tool: `world_from_tool`.
    pub pose: Pose<3>,
    /// The rotation vector of the device relative to the tool [rad]; in the plane only z is
    /// used.
    pub turn: Vector<f64, 3>,
    /// The wanted torque on the hand about the tool's origin [N·m]; in the plane only z is
    /// used.
    pub torque: Vector<f64, 3>,
    /// The torque that the device gives to the hand [N·m]; `None` for a device without
    /// rotation.
    pub given: Option<Vector<f64, 3>>,
    /// The number of contacts that push.
    pub contacts: u32,
    /// How far the tool's surface may be from shell balls that are proven outside [m].
    pub resolution: f64,
    /// `true` if the budget did not allow all levels of the shell.
    pub is_degraded: bool,
    /// `true` if bodies cover the tool; it then gives no force.
    pub is_covered: bool,
}

impl Tool {
    /// The tool after the last tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn held(&self) -> HeldTool {
        let touch = self.touch();
        HeldTool {
            pose: touch.pose,
            turn: Twist::between(&touch.device, &touch.pose).angular,
            torque: touch.torque,
            given: None,
            contacts: touch.contacts.len() as u32,
            resolution: touch.resolution,
            is_degraded: touch.is_degraded,
            is_covered: touch.is_covered,
        }
    }

    /// This tool with a servo's rate, the smaller of both force limits and the longer of both
    /// rise times.
    pub(crate) fn of_servo(mut self, servo: &ServoOptions) -> Self {
        self.options.rate = servo.rate;
        self.options.rise_time = self.options.rise_time.max(servo.rise_time);
        let own = self.options.max_force.unwrap_or(f64::INFINITY);
        self.options.max_force = Some(own.min(servo.max_force));
        self
    }

    /// Lowers the force limit [N].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn limit_force(&mut self, max_force: f64) {
        self.options.max_force = Some(self.options.force_limit().min(max_force));
    }
}
