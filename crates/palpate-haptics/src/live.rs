// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Live poses and grippers.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_device::{Buttons, GripperState};
use palpate_field::Vector;
use palpate_safety::{Arrival, Change, Impedance, PortState, SafetyChain, StageEffects};

use crate::accepted_bodies::Protection;
use crate::contact_point::Touch;
use crate::error::HapticsError;
use crate::event::Reaction;
use crate::tool::HeldTool;

/// The progress of a running servo, as of a recent tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Ticks done.
    pub ticks: u64,
    /// The time of the servo [s].
    pub time: f64,
    /// The largest force on a contact point in the last tick [N].
    pub force: f64,
    /// The largest depth a contact point is pressed to [m].
    pub depth: f64,
    /// The number of contact points in contact.
    pub contacts: u64,
    /// Evaluations of the shape in the last tick.
    pub evaluations: u64,
    /// The duration of the last tick [ns].
    pub cost_ns: u64,
}

/// The state of a servo after one tick: all parts are of the same tick.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Snapshot {
    /// Counts and largest values.
    pub progress: Progress,
    /// Every contact point.
    pub touches: Vec<Touch>,
    /// The tool; `None` if the servo renders contact points.
    pub tool: Option<HeldTool>,
    /// `true` while all written forces are held at zero: by an emergency stop, or because the bodies
    /// that were sent last were accepted for another servo.
    pub is_stopped: bool,
    /// Whether the hand is [lifted](crate::Servo::lift) off the bodies.
    pub is_lifted: bool,
    /// In how many ticks each stage of the safety chains has acted since the start.
    pub safety: StageEffects,
    /// The buttons of the device that are held down.
    pub buttons: Buttons,
    /// The gripper of the device; `None` for a device without one.
    pub gripper: Option<GripperState>,
    /// The force on the fingers in the gripper [N].
    pub gripper_force: f64,
    /// Force and torque on each body.
    pub reactions: Vec<Reaction>,
    /// Events so far for which the queue had no room.
    pub events_lost: u64,
}

/// A gripper with the force that is wanted of it. Without a device that has one the force is zero.
#[derive(Clone, Debug, Default)]
pub(crate) struct GripperPort {
    /// The gripper as read; `None` for a device without one.
    pub(crate) state: Option<GripperState>,
    /// The force wanted [N].
    pub(crate) wanted: f64,
    /// The force to write [N].
    pub(crate) force: f64,
    /// Of the opening, which is along x. `None` for a gripper without a motor, and without
    /// protection.
    chain: Option<SafetyChain>,
}

impl GripperPort {
    /// One tick, in which the states came so.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn tick(&mut self, arrival: Arrival) {
        let Some(chain) = &mut self.chain else { return };
        let state = self.state.filter(|_| arrival.is_ready);
        // What is not known is no number, for which the chain gives no force.
        let GripperState { opening, velocity } =
            state.unwrap_or(GripperState::at_rest(f64::NAN));
        let late = arrival.late + if arrival.elapsed.is_some() { 0.0 } else { chain.period() };
        let state = PortState {
            position: Vector([opening, 0.0, 0.0]),
            velocity: Vector([velocity, 0.0, 0.0]),
            late,
            elapsed: arrival.elapsed,
            change: if arrival.is_ready { Change::None } else { Change::Begins },
            ..PortState::at_rest()
        };
        let Vector([force, ..]) = chain.step(Vector([self.wanted, 0.0, 0.0]), &state);
        self.force = force;
    }

    /// Stops or releases the force.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn stop(&mut self, is_stopped: bool) {
        if let Some(chain) = &mut self.chain {
            if is_stopped { chain.stop() } else { chain.release() }
        }
    }
}

impl Protection {
    /// Makes the port of the device's gripper.
    pub(crate) fn gripper(&self, rate: f64) -> Result<GripperPort, HapticsError> {
        let gripper = self.profile.gripper.as_ref().filter(|gripper| gripper.max_force > 0.0);
        let chain = gripper.map(|gripper| {
            // What pushes is the caller's, and no spring that could be observed.
            let options = self
                .safety_options(Impedance::default())
                .with(|settings| settings.has_passivity_control = false);
            SafetyChain::new(&gripper.force_profile(), rate, options)
        });
        Ok(GripperPort { chain: chain.transpose()?, ..GripperPort::default() })
    }
}
