// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The report of a safety chain.

use crate::Accepted;
use crate::channel::Channel;
use crate::drive::DriveReport;
use crate::effect::Effect;
use crate::free_energy::FreeForceReport;
use crate::limit_cycle::LimitCycleReport;
use crate::passivity::PassivityReport;
use crate::readings::ReadingsReport;

/// Actions of every stage of a safety chain since it was made.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct SafetyReport {
    /// Ticks done.
    pub ticks: u64,
    /// The accepted stiffness and damping.
    pub impedance: Accepted,
    /// Readings of the device that no hand can have made.
    pub readings: ReadingsReport,
    /// Limit cycles, after which the stiffness is less.
    pub limit_cycles: LimitCycleReport,
    /// Passivity of guides and magnets.
    pub free_forces: FreeForceReport,
    /// Passivity observer and controller.
    pub passivity: PassivityReport,
    /// The work of moving bodies, and the limit on its power.
    pub drives: DriveReport,
    /// The slew limit. A tick counts twice if the force had to be limited again after the later
    /// stages.
    pub slew: Effect,
    /// The force limit.
    pub force_limit: Effect,
    /// The limit on the continuous force.
    pub continuous: ContinuousReport,
    /// The guard against inputs that are not finite.
    pub guard: Effect,
    /// The ramp after the start, placements and emergency stops.
    pub ramp: Effect,
    /// The deadline watchdog.
    pub watchdog: WatchdogReport,
    /// The emergency stop.
    pub emergency_stop: Effect,
    /// The number of emergency stops.
    pub stops: u64,
    /// The stages of the torque; `None` for a device that gives no torque.
    pub turning: Option<TurningReport>,
}

/// Actions of the stages of the torque, for a device with rotation; changes are in N·m. Torques are
/// those at the device: in the world they are as many times as large as the workspace is.
/// Passivity covers force and torque together: see [`SafetyReport::passivity`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct TurningReport {
    /// The accepted angular stiffness and damping of the coupling.
    pub impedance: Accepted,
    /// The largest torque that was written [N·m], at the device.
    pub largest_torque: f64,
    /// The slew limit.
    pub slew: Effect,
    /// The torque limit.
    pub torque_limit: Effect,
    /// The limit on the continuous torque; its root mean square is in N·m.
    pub continuous: ContinuousReport,
    /// The guard against inputs that are not finite.
    pub guard: Effect,
    /// The ramp after the start, placements and emergency stops.
    pub ramp: Effect,
    /// The deadline watchdog.
    pub watchdog: WatchdogReport,
    /// The emergency stop.
    pub emergency_stop: Effect,
}

/// Actions of the limit on the continuous force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct ContinuousReport {
    /// Actions of the stage.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub effect: Effect,
    /// The constant force that would give the present heat [N]; for torques [N·m].
    pub root_mean_square: f64,
}

/// Actions of the deadline watchdog.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct WatchdogReport {
    /// Actions of the stage.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub effect: Effect,
    /// The number of times the watchdog tripped.
    pub trips: u64,
}

/// Counts of the stages that keep none of their own.
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
    /// This report with the readings that were held back before the chain.
    #[must_use]
    pub fn with_readings(self, readings: ReadingsReport) -> Self {
        Self { readings, ..self }
    }

    /// This report with the limit cycles that were found.
    pub(crate) fn with_limit_cycles(self, limit_cycles: LimitCycleReport) -> Self {
        Self { limit_cycles, ..self }
    }

    /// This report with the passivity of guides and magnets.
    pub(crate) fn with_free_forces(self, free_forces: FreeForceReport) -> Self {
        Self { free_forces, ..self }
    }

    /// This report with the work of moving bodies.
    pub(crate) fn with_drives(self, drives: DriveReport) -> Self {
        Self { drives, ..self }
    }

    /// The report of a chain of forces.
    pub(crate) fn of(
        accepted: &Accepted,
        passivity: PassivityReport,
        channel: &Channel,
    ) -> Self {
        let effects = channel.effects;
        Self {
            ticks: effects.ticks,
            impedance: accepted.clone(),
            readings: ReadingsReport::default(),
            limit_cycles: LimitCycleReport::default(),
            free_forces: FreeForceReport::default(),
            passivity,
            drives: DriveReport::default(),
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
    /// The report of a chain of torques.
    pub(crate) fn of(accepted: &Accepted, largest_torque: f64, channel: &Channel) -> Self {
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
