// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The port of a gripper: its state in, the force on the fingers out.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Vector;

use crate::error::HapticsError;
use crate::protection::Protection;
use palpate_device::GripperState;
use palpate_safety::{Arrival, Change, Impedance, PortState, SafetyChain};

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
