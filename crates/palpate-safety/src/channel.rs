// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The stages that forces and torques share; each has a channel of its own.

use palpate_field::Vector;

use crate::approach::{Approach, Change, Rise, RiseOptions};
use crate::continuous::{ContinuousLimit, CoolingOptions, Watchdog, WatchdogOptions};
use crate::error::SafetyError;
use crate::finite;
use crate::force_limit::ForceLimit;
use crate::limits::{DeviceLimits, SafetySettings};
use crate::report::{ContinuousReport, Effects, WatchdogReport};
use crate::slew::{SlewLimit, SlewOptions};
use palpate_device::NumberError;

/// Properties of a tick that every stage sees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TickInput {
    /// Whether every input is finite.
    pub(crate) is_sound: bool,
    /// As [`PortState::late`](super::PortState::late) [s].
    pub(crate) late: f64,
    /// As [`PortState::start`](super::PortState::start).
    pub(crate) start: f64,
    /// As [`PortState::change`](super::PortState::change).
    pub(crate) change: Change,
    /// As [`PortState::explained`](super::PortState::explained) [N].
    pub(crate) explained: f64,
    /// How much a limit took from the wanted force before the stages.
    pub(crate) cut: f64,
}

/// The slew limit acts if the force differs by more than this share from what the other limits leave.
const HELD: f64 = 1e-9;

/// What is left of a wanted force after it was zeroed, or after an edit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Risen {
    /// The force of the bodies.
    pub(crate) wanted: Vector<f64, 3>,
    /// The part, in [0, 1], that may pass while the force rises after it was zeroed.
    pub(crate) part: f64,
    /// Whether the force rises, or follows an edit.
    pub(crate) is_rising: bool,
    /// Whether it falls slowly to what is wanted, after a handover.
    pub(crate) is_falling: bool,
}

impl Risen {
    /// The size of what is wanted, `effort`, or of what is left to fall.
    pub(crate) fn effort(&self, effort: f64, left: f64) -> f64 {
        if self.is_falling { effort.max(left) } else { effort }
    }
}

/// What a [`Channel`] gives in a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given {
    /// The force to write.
    pub(crate) force: Vector<f64, 3>,
    /// The part of it that the bodies give; guides and magnets give the rest.
    pub(crate) of_bodies: Vector<f64, 3>,
    /// The share that the limits of its size, watchdog and stop left, from 0 to 1.
    pub(crate) share: f64,
}

/// The stages from the observed force or torque to the written one: slew limit, force limit,
/// continuous limit, guard against numbers that are not finite, watchdog and emergency stop. It also
/// holds the rise of a force that was zeroed, which acts before the passivity stage.
#[derive(Clone, Debug)]
pub(crate) struct Channel {
    slew: SlewLimit,
    force_limit: ForceLimit,
    continuous: ContinuousLimit,
    rise: Rise,
    approach: Approach,
    watchdog: Watchdog,
    is_stopped: bool,
    /// Whether the last force is of bodies in part.
    has_bodies: bool,
    /// A second slew limit at the end, because the stages after the first also change the
    /// force.
    closing: SlewLimit,
    pub(crate) effects: Effects,
}

impl Channel {
    /// A channel for forces, or for torques, where a radian counts as the length `unit` [m].
    ///
    /// # Errors
    ///
    /// [`SafetyError::Number`] if a limit is not positive, or a time of the options negative or
    /// not finite.
    pub(crate) fn new(
        limits: &DeviceLimits,
        settings: &SafetySettings,
        unit: f64,
        rate: f64,
    ) -> Result<Self, SafetyError> {
        let max_force_rate = limits.max_force_rate.positive()?;
        let slew = SlewLimit::new(SlewOptions { max_force_rate, rate });
        let continuous_force = limits.continuous_force.positive()?;
        let cooling_time =
            NumberError::check_positive("cooling_time", settings.cooling_time, "s")?;
        let rise_rate =
            NumberError::check_positive_or_infinite("rise_rate", settings.rise_rate, "N/s")?;
        let late_time = NumberError::check_positive("late_time", settings.late_time, "s")?;
        let fall_time = NumberError::check_not_negative("fall_time", settings.fall_time, "s")?;
        let cooling = CoolingOptions { continuous_force, cooling_time, rate };
        let rise =
            RiseOptions { rise_rate: rise_rate * unit, recovery: settings.recovery, rate };
        Ok(Self {
            slew,
            force_limit: ForceLimit::new(limits.max_force.positive()?),
            continuous: ContinuousLimit::new(cooling),
            rise: Rise::new(rise),
            approach: Approach::new(unit),
            watchdog: Watchdog::new(WatchdogOptions { late_time, fall_time, rate }),
            is_stopped: false,
            has_bodies: false,
            closing: slew,
            effects: Effects::default(),
        })
    }

    /// What may pass of `wanted` and `free` in this tick, after the force was zeroed or the bodies
    /// were edited.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn risen(
        &mut self,
        wanted: Vector<f64, 3>,
        free: Vector<f64, 3>,
        input: &TickInput,
    ) -> Risen {
        self.approach.begin(input.change);
        let near =
            if input.is_sound { self.approach.step(wanted, input.explained) } else { None };
        let (aim, follows) = (wanted, near.is_some());
        let wanted = near.unwrap_or(aim);
        let part = self.risen_part(wanted, aim, free, input);
        let is_rising = part.is_some() || follows;
        let part = part.unwrap_or(1.0);
        let wanted = if part < 1.0 { wanted * part } else { wanted };
        if part < 1.0 {
            // A hand that is let go leaves what it felt, and not what it would have felt.
            self.approach.passed(wanted);
        }
        if wanted != aim || part < 1.0 {
            self.effects.ramp.count_size((aim - wanted + free * (1.0 - part)).norm());
        }
        let is_falling = follows && self.approach.falls_slowly();
        Risen { wanted, part, is_rising, is_falling }
    }

    /// The part of `wanted`, which approaches `aim`, and of `free`, in [0, 1], that may pass in this
    /// tick while the force rises after it was zeroed; `None` if it has risen before.
    fn risen_part(
        &mut self,
        wanted: Vector<f64, 3>,
        aim: Vector<f64, 3>,
        free: Vector<f64, 3>,
        input: &TickInput,
    ) -> Option<f64> {
        if self.watchdog.step(input.late) {
            // The hand may have sunk in while no tick came.
            self.rise.restart(self.closing.last().norm());
        }
        if input.change == Change::Begins {
            self.rise.begin();
        }
        if input.start < 1.0 || input.start.is_nan() {
            self.rise.restart((wanted + free).norm() * input.start.max(0.0));
        }
        if !input.is_sound {
            return None;
        }
        self.rise.step(wanted, aim, free)
    }

    /// The force to write for `observed`, which passed the passivity stage, plus `free`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn step(
        &mut self,
        observed: Vector<f64, 3>,
        free: Vector<f64, 3>,
        input: &TickInput,
    ) -> Given {
        self.effects.ticks += 1;
        let is_sound = input.is_sound;
        let all = with_free(observed, free);
        let slewed = if is_sound { self.slewed(all) } else { all };
        let force = if is_sound { self.limited(slewed, input.cut) } else { slewed };
        let force = self.effects.guard.count(force, finite::guarded(force, is_sound));
        let force = self.faded(force);
        // The share that limits, watchdog and stop leave of both parts.
        let share = if force == slewed { 1.0 } else { force.norm() / slewed.norm() };
        if !is_sound || self.is_stopped {
            // Both exceptions to the slew limit fall to zero at once.
            self.slew.restart();
            self.closing.restart();
        }
        let force = self.effects.slew.count(force, self.closing.limit(force));
        self.continuous.written(force);
        if self.is_stopped {
            self.rise.begin();
        } else if !is_sound || self.watchdog.factor() < 1.0 {
            self.rise.restart(force.norm());
        }
        // What the slew limit holds beyond that share comes from the bodies, as long as they gave
        // some of it: it counts as observed. Written so that NaN is no share.
        let share = if share > 0.0 { share } else { 0.0 };
        let held = force - all * share;
        let is_held = held.norm() > HELD * force.norm();
        self.has_bodies = observed != Vector::ZERO || self.has_bodies && is_held;
        let of_bodies = if force == all {
            observed
        } else if self.has_bodies {
            force - free * share
        } else {
            Vector::ZERO
        };
        Given { force, of_bodies, share }
    }

    /// Keeps its rates when the length of a radian is multiplied by `longer`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn in_units(&mut self, longer: f64) {
        self.rise.in_units(longer);
        self.approach.in_units(longer);
    }

    /// Lowers the force limit; never raises it.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn lower_limit(&mut self, max_force: f64) {
        self.force_limit.lower(max_force);
    }

    /// Begins an emergency stop.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn stop(&mut self) {
        self.effects.stops += u64::from(!self.is_stopped);
        self.is_stopped = true;
    }

    /// Ends an emergency stop; the force begins at zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn release(&mut self) {
        if self.is_stopped {
            self.rise.begin();
        }
        self.is_stopped = false;
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    /// Whether late ticks lower the force.
    pub(crate) fn is_late(&self) -> bool {
        self.watchdog.factor() < 1.0
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

    /// A force after the limit on its change.
    fn slewed(&mut self, force: Vector<f64, 3>) -> Vector<f64, 3> {
        self.effects.slew.count(force, self.slew.limit(force))
    }

    /// A force after the limits on its size, of which `cut` was taken before.
    fn limited(&mut self, force: Vector<f64, 3>, cut: f64) -> Vector<f64, 3> {
        let effects = &mut self.effects;
        let limit = self.force_limit.limit(force);
        if cut > 0.0 && limit.is_none_or(|limited| limited == force) {
            effects.force_limit.count_size(cut);
        }
        let force = effects.force_limit.count(force, limit);
        effects.continuous.count(force, self.continuous.limit(force))
    }

    /// A force after watchdog and emergency stop.
    fn faded(&mut self, force: Vector<f64, 3>) -> Vector<f64, 3> {
        let effects = &mut self.effects;
        let force = effects.watchdog.count(force, part(force, self.watchdog.factor()));
        effects.emergency_stop.count(force, self.is_stopped.then_some(Vector::ZERO))
    }
}

/// `factor` times a force; `None` if the factor is one.
fn part(force: Vector<f64, 3>, factor: f64) -> Option<Vector<f64, 3>> {
    (factor != 1.0).then(|| force * factor)
}

/// The sum of both forces; if one is zero, the other bit for bit.
fn with_free(observed: Vector<f64, 3>, free: Vector<f64, 3>) -> Vector<f64, 3> {
    if free == Vector::ZERO { observed } else { observed + free }
}
