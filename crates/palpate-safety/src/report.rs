// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What every stage of a safety chain did.

use crate::Accepted;
use crate::channel::Channel;
use crate::effect::Effect;
use crate::passivity::PassivityReport;

/// What every stage of a safety chain did, since it was made.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
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
    /// What the stages of the torque did; none of a device that gives no torque.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub turning: Option<TurningReport>,
}

/// What every stage that the torque passes did, at a device that turns: changes are in N·m.
/// Passivity is that of force and torque together, [`SafetyReport::passivity`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TurningReport {
    /// What became of the coupling's angular stiffness and damping.
    pub impedance: Accepted,
    /// The largest torque that was written [N·m].
    pub largest_torque: f64,
    /// The fastest change of torque.
    pub slew: Effect,
    /// The largest torque.
    pub torque_limit: Effect,
    /// The continuous torque; its root mean square is in N·m.
    pub continuous: ContinuousReport,
    /// Inputs that were not numbers.
    pub guard: Effect,
    /// Rises after the start, placements and emergencies.
    pub ramp: Effect,
    /// The deadline watchdog.
    pub watchdog: WatchdogReport,
    /// The emergency stop.
    pub emergency_stop: Effect,
}

/// What the limit of the continuous force did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ContinuousReport {
    /// How often it acted, and how much.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub effect: Effect,
    /// The steady force that would be as warm now [N]; of torques [N·m].
    pub root_mean_square: f64,
}

/// What the deadline watchdog did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct WatchdogReport {
    /// How often it acted, and how much.
    #[cfg_attr(feature = "serde", serde(flatten))]
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

impl SafetyReport {
    /// What the stages of a chain of forces did.
    pub(crate) fn of<const D: usize>(
        accepted: &Accepted,
        passivity: PassivityReport,
        channel: &Channel<D>,
    ) -> Self {
        let effects = channel.effects;
        Self {
            ticks: effects.ticks,
            impedance: accepted.clone(),
            passivity,
            slew: effects.slew,
            force_limit: effects.force_limit,
            continuous: channel.continuous_report(),
            guard: effects.guard,
            ramp: effects.ramp,
            watchdog: channel.watchdog_report(),
            emergency_stop: effects.emergency_stop,
            stops: effects.stops,
            turning: None,
        }
    }
}

impl TurningReport {
    /// What the stages of a chain of torques did.
    pub(crate) fn of(accepted: &Accepted, largest_torque: f64, channel: &Channel<3>) -> Self {
        let effects = channel.effects;
        Self {
            impedance: accepted.clone(),
            largest_torque,
            slew: effects.slew,
            torque_limit: effects.force_limit,
            continuous: channel.continuous_report(),
            guard: effects.guard,
            ramp: effects.ramp,
            watchdog: channel.watchdog_report(),
            emergency_stop: effects.emergency_stop,
        }
    }
}
