// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What every stage of a safety chain did.

use super::effect::Effect;
use super::passivity::PassivityReport;
use super::{Accepted, SafetyChain};

/// What every stage of a safety chain did, since it was made.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct SafetyReport {
    /// Ticks done.
    pub ticks: u64,
    /// What became of the impedance.
    pub impedance: Accepted,
    /// Passivity observer and controller.
    pub passivity: PassivityReport,
    /// The fastest change of force; counted where it is limited first, and once more where it
    /// had to be limited after the stages behind.
    pub slew: Effect,
    /// The largest force.
    pub force_limit: Effect,
    /// The continuous force.
    pub continuous: ContinuousReport,
    /// Inputs that were not numbers.
    pub guard: Effect,
    /// Rises after the start, placements and emergencies.
    pub ramp: Effect,
    /// The deadline watchdog.
    pub watchdog: WatchdogReport,
    /// The emergency stop.
    pub emergency_stop: Effect,
    /// How often it was pulled.
    pub stops: u64,
}

/// What the limit of the continuous force did.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct ContinuousReport {
    /// How often it acted, and how much.
    #[serde(flatten)]
    pub effect: Effect,
    /// The steady force that would be as warm now [N].
    pub root_mean_square: f64,
}

/// What the deadline watchdog did.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct WatchdogReport {
    /// How often it acted, and how much.
    #[serde(flatten)]
    pub effect: Effect,
    /// How often it tripped.
    pub trips: u64,
}

/// Counts of the stages that do not keep their own.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Effects {
    pub(crate) ticks: u64,
    pub(crate) slew: Effect,
    pub(crate) force_limit: Effect,
    pub(crate) continuous: Effect,
    pub(crate) guard: Effect,
    pub(crate) ramp: Effect,
    pub(crate) watchdog: Effect,
    pub(crate) emergency_stop: Effect,
    pub(crate) stops: u64,
}

impl Effects {
    pub(crate) fn report<const D: usize>(&self, chain: &SafetyChain<D>) -> SafetyReport {
        SafetyReport {
            ticks: self.ticks,
            impedance: chain.accepted.clone(),
            passivity: chain.passivity.report(),
            slew: self.slew,
            force_limit: self.force_limit,
            continuous: ContinuousReport {
                effect: self.continuous,
                root_mean_square: chain.continuous.root_mean_square(),
            },
            guard: self.guard,
            ramp: self.ramp,
            watchdog: WatchdogReport { effect: self.watchdog, trips: chain.watchdog.trips() },
            emergency_stop: self.emergency_stop,
            stops: self.stops,
        }
    }
}
