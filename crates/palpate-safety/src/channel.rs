// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The stages that forces and torques pass alike, each in a chain of its own.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Vector;

use crate::SafetyOptions;
use crate::continuous::ContinuousLimit;
use crate::error::{SafetyError, not_negative, positive};
use crate::finite;
use crate::force_limit::ForceLimit;
use crate::limits::Limits;
use crate::ramp::Ramp;
use crate::report::{ContinuousReport, Effects, WatchdogReport};
use crate::slew::SlewLimit;
use crate::watchdog::Watchdog;

/// What a tick is like for every stage.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    /// All that came in are numbers.
    pub(crate) is_sound: bool,
    pub(crate) is_late: bool,
    /// As [`PortState::start`](super::PortState::start).
    pub(crate) start: f64,
}

/// From an observed force, or torque, to the one that is written: the fastest change, the
/// largest, the continuous one, the guard against what is not a number, ramp, watchdog and
/// emergency stop.
#[derive(Clone, Debug)]
pub(crate) struct Channel<const D: usize> {
    slew: SlewLimit<D>,
    force_limit: ForceLimit,
    continuous: ContinuousLimit,
    ramp: Ramp,
    watchdog: Watchdog,
    is_stopped: bool,
    /// The fastest change once more, as what comes after the first may change the force too.
    closing: SlewLimit<D>,
    pub(crate) effects: Effects,
}

impl<const D: usize> Channel<D> {
    /// # Errors
    ///
    /// [`SafetyError::Number`] if a limit is not positive, or a time of the options negative or
    /// not finite.
    pub(crate) fn new(
        limits: &Limits,
        options: &SafetyOptions,
        rate: f64,
    ) -> Result<Self, SafetyError> {
        let slew = SlewLimit::new(limits.max_force_rate.positive()?, rate);
        let continuous_force = limits.continuous_force.positive()?;
        let cooling_time = positive("cooling_time", options.cooling_time, "s")?;
        let rise_time = not_negative("rise_time", options.rise_time, "s")?;
        let fall_time = not_negative("fall_time", options.fall_time, "s")?;
        let times = (rise_time, fall_time);
        Ok(Self {
            slew,
            force_limit: ForceLimit::new(limits.max_force.positive()?),
            continuous: ContinuousLimit::new(continuous_force, cooling_time, rate),
            ramp: Ramp::new(0.0, times, rate),
            watchdog: Watchdog::new(options.late_ticks, Ramp::new(1.0, times, rate)),
            is_stopped: false,
            closing: slew,
            effects: Effects::default(),
        })
    }

    /// The force to write where `observed` passed the passivity stage and `free` is added to it;
    /// and what the stages left of the observed one.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn step(
        &mut self,
        (observed, free): (Vector<f64, D>, Vector<f64, D>),
        moment: &Moment,
    ) -> (Vector<f64, D>, Vector<f64, D>) {
        self.effects.ticks += 1;
        let is_sound = moment.is_sound;
        let all = with_free(observed, free);
        let force = if is_sound { self.limited(all) } else { all };
        let force = self.effects.guard.count(force, finite::guarded(force, is_sound));
        let force = self.faded(force, moment);
        if !is_sound || self.is_stopped {
            // To zero at once: the exceptions of the fastest change.
            self.slew.restart();
            self.closing.restart();
        }
        let force = self.effects.slew.count(force, self.closing.limit(force));
        self.continuous.written(force);
        // What the stages left of all of it, they left of the part that is observed.
        let left = if force == all { 1.0 } else { force.dot(all) / all.dot(all) };
        (force, if left == 1.0 { observed } else { observed * left })
    }

    /// Lowers the largest force; never raises it.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn lower_limit(&mut self, max_force: f64) {
        self.force_limit.lower(max_force);
    }

    /// Stops.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn stop(&mut self) {
        self.effects.stops += u64::from(!self.is_stopped);
        self.is_stopped = true;
    }

    /// Ends an emergency stop; the force rises from nothing.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn release(&mut self) {
        if self.is_stopped {
            self.ramp.lower(0.0);
        }
        self.is_stopped = false;
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    pub(crate) fn continuous_report(&self) -> ContinuousReport {
        ContinuousReport {
            effect: self.effects.continuous,
            root_mean_square: self.continuous.root_mean_square(),
        }
    }

    pub(crate) fn watchdog_report(&self) -> WatchdogReport {
        WatchdogReport { effect: self.effects.watchdog, trips: self.watchdog.trips() }
    }

    /// What the device's limits leave of a force.
    fn limited(&mut self, force: Vector<f64, D>) -> Vector<f64, D> {
        let effects = &mut self.effects;
        let force = effects.slew.count(force, self.slew.limit(force));
        let force = effects.force_limit.count(force, self.force_limit.limit(force));
        effects.continuous.count(force, self.continuous.limit(force))
    }

    /// What ramp, watchdog and emergency stop leave of a force.
    fn faded(&mut self, force: Vector<f64, D>, moment: &Moment) -> Vector<f64, D> {
        self.ramp.lower(moment.start);
        let effects = &mut self.effects;
        let force = effects.ramp.count(force, part(force, self.ramp.step(true)));
        let left = self.watchdog.step(moment.is_late);
        let force = effects.watchdog.count(force, part(force, left));
        effects.emergency_stop.count(force, self.is_stopped.then_some(Vector::ZERO))
    }
}

/// A part of a force; none if it is all of it.
fn part<const D: usize>(force: Vector<f64, D>, factor: f64) -> Option<Vector<f64, D>> {
    (factor != 1.0).then(|| force * factor)
}

/// Both forces together; of one alone the same bits.
fn with_free<const D: usize>(observed: Vector<f64, D>, free: Vector<f64, D>) -> Vector<f64, D> {
    if free == Vector::ZERO { observed } else { observed + free }
}
