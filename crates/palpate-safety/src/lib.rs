// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The safety chain between a wanted force and a hand.
//!
//! The wanted force is that of materials, guides or a tool, before any limit. A
//! [`DeviceProfile`](palpate_device::DeviceProfile) says what a device can do, and a
//! [`WorkspaceMap`] places it in the world. [`Accepted`] says how stiff a material may be on it,
//! a [`VelocityEstimator`] how fast the hand moves, and a [`SafetyChain`] gives the force to
//! write in each tick: no larger, changing no faster and lasting no longer than the device bears;
//! and, but for a reserve and the potential of guides, the chain gives out no more energy than it took
//! in and the device's damping dissipates, as the encoders show it. A [`WrenchChain`] does the same for
//! force and torque together.
//!
//! This crate knows nothing of shapes, so that it can be reviewed alone.
// Every tick runs through this crate: it must not panic.
#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod acceptance;
mod approach;
mod chain;
mod channel;
mod continuous;
mod display;
mod drive;
mod effect;
mod error;
mod finite;
mod force_limit;
mod free_energy;
mod limit;
mod limit_cycle;
mod limits;
mod passivity;
mod readings;
mod refused;
mod report;
mod slew;
mod turn_readings;
mod velocity;
mod workspace;
mod wrench;

pub use acceptance::{AS_IS_MOST, Acceptance, Accepted, Rule};
pub use approach::{Approach, Change, Recovery, check_bears};
pub use chain::{PortState, SafetyChain, SafetyOptions, StageEffects};
pub use drive::{DriveReport, MovingBodies};
pub use effect::Effect;
pub use error::SafetyError;
pub use free_energy::FreeForceReport;
pub use limit_cycle::LimitCycleReport;
pub use limits::{DeviceLimits, Impedance, SafetySettings};
pub use passivity::PassivityReport;
pub use readings::{Readings, ReadingsReport};
pub use refused::{Refused, Requester};
pub use report::{ContinuousReport, SafetyReport, TurningReport, WatchdogReport};
pub use turn_readings::TurnReadings;
pub use velocity::{Arrival, Arrivals, VelocityEstimator};
pub use workspace::WorkspaceMap;
pub use wrench::{PerMotion, SpatialVector, WrenchChain, WrenchState};
