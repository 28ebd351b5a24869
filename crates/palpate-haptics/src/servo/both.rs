// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What can be done with both kinds of servo, written once.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Pose;

use super::{Servo, UnprotectedServo};
use crate::contact_point::Touch;
use crate::guide::Guide;
use palpate_safety::{PointState, TurnState};

macro_rules! methods_of_both {
    ($servo:ident) => {
        impl<const D: usize> $servo<D> {
            /// One tick: reads each point's state, moves its proxy, gives its force.
            ///
            /// A point that is not finite, or for which there is no state, touches nothing: its
            /// force is zero, and its proxy waits where it was.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic unless a custom field
            /// does; evaluates the field at most [`Probe::budget`](crate::Probe::budget) times a
            /// point, once more for each magnet in reach, and once for each dimension of a
            /// textured surface; for a tool,
            /// [`ToolOptions::budget`](crate::ToolOptions::budget) times.
            pub fn step(&mut self, states: &[PointState<D>]) -> &[Touch<D>] {
                self.renderer.step(states)
            }

            /// Sets how a device that turns is turned in the ticks to come: a tool with a shape
            /// turns with it. `None`, as at first, for a device that does not turn: the tool
            /// keeps the device's axes.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn set_turn(&mut self, turn: Option<TurnState<D>>) {
                self.renderer.set_turn(turn);
            }

            /// Guides every contact point.
            pub fn guide(&mut self, guides: &[Guide<D>]) {
                self.renderer.guide(guides);
            }

            /// Says whether the next tick starts too late.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn set_late(&mut self, is_late: bool) {
                self.renderer.set_late(is_late);
            }

            /// Stops all forces and torques: they are zero from the next tick on. Or releases
            /// them: they rise from nothing.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn stop(&mut self, is_stopped: bool) {
                self.renderer.stop(is_stopped);
            }

            /// Moves a body before the next tick; see [`Bodies::set_pose`](crate::Bodies::set_pose).
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn set_pose(&mut self, body: usize, world_from_body: Pose<D>) {
                self.renderer.set_pose(body, world_from_body);
            }

            /// Lowers the largest force on a contact point to `max_force` [N]; never raises it.
            /// With a safety chain, a larger force falls as fast as the device's forces may
            /// change.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn limit_force(&mut self, max_force: f64) {
                self.renderer.limit_force(max_force);
            }

            /// Lowers the largest torque on a tool's device to `max_torque` [N·m]; never raises
            /// it. With a safety chain, a larger torque falls as fast as the device's torques may
            /// change.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn limit_torque(&mut self, max_torque: f64) {
                self.renderer.limit_torque(max_torque);
            }
        }
    };
}

methods_of_both!(Servo);
methods_of_both!(UnprotectedServo);
