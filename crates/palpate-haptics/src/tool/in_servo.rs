// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A tool as what a servo renders instead of contact points: it hangs on one of them, whose way
//! to the device is its own.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Pose, Vector};

use super::twist::Twist;
use super::{Tool, ToolState};
use crate::bodies::Bodies;
use crate::contact_point::{ContactPoint, Setting, Touch};
use crate::device::PointState;
use crate::error::HapticsError;
use crate::impedance::Impedance;
use crate::servo::ServoOptions;

/// A tool after a tick, as rows of a trace and snapshots have it. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldTool<const D: usize> {
    /// Where the tool is: `world_from_tool`.
    pub pose: Pose<D>,
    /// How it is turned against the device: along the axis, as long as the angle [rad]; in the
    /// plane about z alone.
    pub turn: Vector<f64, 3>,
    /// The torque on the hand about the tool's origin [N·m]; in the plane about z alone.
    pub torque: Vector<f64, 3>,
    /// Contacts that push.
    pub contacts: u32,
    /// How far the tool's surface may be from balls that are known to be outside [m].
    pub resolution: f64,
    /// `true` if the budget did not allow all levels of the shell.
    pub is_degraded: bool,
    /// `true` if bodies cover the tool: it touches nothing.
    pub is_covered: bool,
}

impl<const D: usize> Tool<D> {
    /// After the last tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn held(&self) -> HeldTool<D> {
        let touch = self.touch();
        HeldTool {
            pose: touch.pose,
            turn: Twist::between(&touch.device, &touch.pose).angular,
            torque: touch.torque,
            contacts: touch.contacts.len() as u32,
            resolution: touch.resolution,
            is_degraded: touch.is_degraded,
            is_covered: touch.is_covered,
        }
    }

    /// The same at a servo's rate, with its rise time and largest force.
    pub(crate) fn of_servo(mut self, servo: &ServoOptions) -> Self {
        let ServoOptions { rate, max_force, rise_time, .. } = *servo;
        self.options.rate = rate;
        self.options.rise_time = rise_time;
        self.options.max_force = max_force;
        self
    }

    /// Lowers the largest force [N].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn limit_force(&mut self, max_force: f64) {
        self.options.max_force = self.options.max_force.min(max_force);
    }

    /// What the hand feels through the coupling of a body like that.
    pub(crate) fn impedance_on(&self, body: Impedance) -> Result<Impedance, HapticsError> {
        let stiffness = self.options.stiffness.min(body.stiffness());
        Impedance::new(stiffness, self.options.damping + body.damping())
    }

    /// Makes the coupling `factor` times as stiff and as damped.
    pub(crate) fn soften(&mut self, factor: f64) {
        self.angular_stiffness *= factor;
        self.options.stiffness *= factor;
        self.options.angular_stiffness =
            self.options.angular_stiffness.map(|stiffness| stiffness * factor);
        self.options.damping *= factor;
        self.options.angular_damping *= factor;
    }
}

impl<const D: usize> ContactPoint<D> {
    /// One tick of a tool that hangs here, from the state of the device to the force to write to
    /// it [N], in its coordinates. The touch is that of the whole tool.
    ///
    /// Real-time: as [`Tool::step`].
    pub(crate) fn tick_tool(
        &mut self,
        (tool, bodies): (&mut Tool<D>, &mut Bodies<D>),
        setting: &Setting<D>,
        state: PointState<D>,
        touch: &mut Touch<D>,
    ) -> Vector<f64, D> {
        let at_device = self.port.as_mut().map_or(state, |port| port.state(state));
        let PointState { position, velocity } = setting.map.state_to_world(at_device);
        let pose = Pose::new(setting.map.rotation(), position);
        tool.step(bodies, &ToolState { pose, velocity, angular_velocity: Vector::ZERO });
        let felt = tool.touch();
        let mut free = Vector::ZERO;
        if position.is_finite() && velocity.is_finite() {
            for guide in &mut self.guides {
                free += guide.force(position, velocity);
            }
        }
        *touch = Touch {
            device: position,
            velocity: tool.hand_velocity,
            proxy: felt.pose.translation,
            wanted: felt.force,
            force: Vector::ZERO,
            normal: felt.normal,
            contact: felt.contact,
            body: felt.body.unwrap_or(0),
            is_slipping: felt.is_slipping,
            evaluations: felt.evaluations,
        };
        self.give(setting, at_device, touch, (free, false))
    }
}
