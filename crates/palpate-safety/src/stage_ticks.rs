// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How often each stage of a safety chain acted, as numbers that are cheap to read in every tick.

use std::iter::Sum;

use crate::effect::Effect;
use crate::readings::ReadingsReport;
use crate::report::{Effects, SafetyReport};

/// The stages in their order, in words.
const STAGES: [&str; 14] = [
    "held readings",
    "limit cycles",
    "passivity of guides",
    "passivity",
    "force rate",
    "largest force",
    "lasting force",
    "not a number",
    "rise from zero",
    "watchdog",
    "emergency stop",
    "torque rate",
    "largest torque",
    "lasting torque",
];

/// In how many ticks each stage of a safety chain, or of several together, has acted.
///
/// ```
/// use palpate_safety::StageTicks;
///
/// let quiet = StageTicks::default();
/// assert_eq!(quiet.named().count(), 14);
/// assert!(quiet.named().all(|(_, ticks)| ticks == 0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StageTicks([u64; STAGES.len()]);

/// What the stages before the limits have done.
pub(crate) struct BeforeLimits {
    pub(crate) cycles: Effect,
    pub(crate) guides: Effect,
    pub(crate) passivity: Effect,
}

impl StageTicks {
    /// Each stage in words with its ticks, in the order in which the stages act.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, u64)> + '_ {
        STAGES.into_iter().zip(self.0)
    }

    /// The ticks of a chain: of the stages before its limits, of its force, and of its torque.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn of(
        BeforeLimits { cycles, guides, passivity }: BeforeLimits,
        force: &Effects,
        torque: Option<&Effects>,
    ) -> Self {
        let turning = |of: fn(&Effects) -> u64| torque.map_or(0, of);
        Self([
            0,
            cycles.ticks,
            guides.ticks,
            passivity.ticks,
            force.slew.ticks,
            force.force_limit.ticks,
            force.continuous.ticks,
            force.guard.ticks,
            force.ramp.ticks,
            force.watchdog.ticks,
            force.emergency_stop.ticks,
            turning(|torque| torque.slew.ticks),
            turning(|torque| torque.force_limit.ticks),
            turning(|torque| torque.continuous.ticks),
        ])
    }

    /// These with readings that were held back before the chain.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn with_readings(mut self, readings: &ReadingsReport) -> Self {
        let [held, ..] = &mut self.0;
        *held = readings.held + readings.turns_held;
        self
    }
}

impl From<&SafetyReport> for StageTicks {
    fn from(report: &SafetyReport) -> Self {
        let force = Effects {
            slew: report.slew,
            force_limit: report.force_limit,
            continuous: report.continuous.effect,
            guard: report.guard,
            ramp: report.ramp,
            watchdog: report.watchdog.effect,
            emergency_stop: report.emergency_stop,
            ..Effects::default()
        };
        let torque = report.turning.as_ref().map(|turning| Effects {
            slew: turning.slew,
            force_limit: turning.torque_limit,
            continuous: turning.continuous.effect,
            ..Effects::default()
        });
        let first = BeforeLimits {
            cycles: report.limit_cycles.effect,
            guides: report.free_forces.effect,
            passivity: report.passivity.effect,
        };
        Self::of(first, &force, torque.as_ref()).with_readings(&report.readings)
    }
}

impl Sum for StageTicks {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |mut sum, one| {
            sum.0.iter_mut().zip(one.0).for_each(|(sum, ticks)| *sum += ticks);
            sum
        })
    }
}
