// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Methods that both kinds of servo have, written once.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Pose;

use super::{Servo, UnprotectedServo};
use crate::contact_point::Touch;
use palpate_safety::{Buttons, GripperState, PointState, Reading, TurnState};

macro_rules! methods_of_both {
    ($servo:ident) => {
        impl<const D: usize> $servo<D> {
            /// One tick: for each contact point, takes its state, moves its proxy and computes
            /// its force.
            ///
            /// A point whose state is missing or not finite touches nothing: its force is zero,
            /// and its proxy stays in place.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic unless a custom field
            /// does; evaluates the field at most [`Probe::budget`](crate::Probe::budget) times a
            /// point, once more for each magnet in reach, and once for each dimension of a
            /// textured surface; for a tool,
            /// [`ToolOptions::budget`](crate::ToolOptions::budget) times.
            pub fn step(&mut self, states: &[PointState<D>]) -> &[Touch<D>] {
                self.renderer.step(states)
            }

            /// Sets orientation and angular velocity of the device for the next ticks; a tool
            /// turns with them. `None`, the initial value, is for a device without rotation:
            /// the tool keeps the device's axes.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn set_turn(&mut self, turn: Option<TurnState<D>>) {
                self.renderer.set_turn(turn);
            }

            /// Sets by how much the next tick starts too late [s]; zero in time. A servo loop calls
            /// this before each tick that starts more than a period after its time.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn set_late(&mut self, late: f64) {
                self.renderer.set_late(late);
            }

            /// Sets what the device gave for the next tick alone. Without it the states of a tick
            /// were measured a period, and what the tick is [late](Self::set_late), after those
            /// before.
            ///
            /// The time between two fresh readings gives velocities, and the energies of the
            /// passivity observer. In a tick with a stale reading the states of
            /// [`step`](Self::step) are not looked at: the last ones hold on, and the force with
            /// them, until the watchdog of the safety chain has had enough. A device that is not
            /// ready has no state, as if each point were NaN.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn set_reading(&mut self, reading: Reading) {
                self.renderer.set_reading(reading);
            }

            /// Sets the buttons that are held down from the next tick on; each change is an
            /// [event](crate::EventKind::ButtonDown).
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn set_buttons(&mut self, buttons: Buttons) {
                self.renderer.set_buttons(buttons);
            }

            /// Sets the gripper from the next tick on; `None`, the initial value, is for a device
            /// without one.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn set_gripper(&mut self, state: Option<GripperState>) {
                self.renderer.set_gripper(state);
            }

            /// Sets the force wanted on the fingers in the gripper [N] from the next tick on;
            /// positive opens the jaws. [`gripper_force`](crate::Renderer::gripper_force) is what to write
            /// of it, after the limits of the [gripper's
            /// profile](palpate_safety::GripperProfile): zero for a device without one, and for an
            /// [`UnprotectedServo`](crate::UnprotectedServo).
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn set_gripper_force(&mut self, wanted: f64) {
                self.renderer.set_gripper_force(wanted);
            }

            /// Stops all forces and torques from the next tick on, or releases them: they then
            /// rise from zero.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn stop(&mut self, is_stopped: bool) {
                self.renderer.stop(is_stopped);
            }

            /// Lifts the hand off the bodies from the next tick on, as a clutch does, or sets it down.
            /// A hand that is lifted feels neither bodies nor guides: proxy and tool are where the
            /// device is, through bodies too. Where it is set down they are placed anew, as in the
            /// first tick; in a body, the force rises from zero.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn lift(&mut self, is_lifted: bool) {
                self.renderer.lift(is_lifted);
            }

            /// Moves a body before the next tick; see [`Bodies::set_pose`](crate::Bodies::set_pose).
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn set_pose(&mut self, body: usize, world_from_body: Pose<D>) {
                self.renderer.set_pose(body, world_from_body);
            }

            /// Lowers the force limit of every contact point to `max_force` [N]; never raises
            /// it. With a safety chain, a larger force falls to the limit at the device's
            /// largest rate.
            ///
            /// Real-time: allocates nothing, takes no lock, cannot panic.
            pub fn limit_force(&mut self, max_force: f64) {
                self.renderer.limit_force(max_force);
            }

            /// Lowers the torque limit of a tool to `max_torque` [N·m]; never raises it. With a
            /// safety chain, a larger torque falls to the limit at the device's largest rate.
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
