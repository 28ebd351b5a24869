// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Limit cycles: a wall that oscillates by itself is made softer.
//!
//! What a device renders stably is computed from its profile. A device with less damping or
//! friction, with coarser encoders, or with a delay between reading and force oscillates against
//! walls that its profile allows. The observer of energy cannot see all of that: a delayed force
//! does other work than it counts.

mod governor;
mod half_cycles;
mod hand;
mod repetition;

use governor::Governor;
use half_cycles::{Ended, HalfCycles};
use hand::{HandMotion, SoftenedWall};
use repetition::Repetition;

use crate::approach::Change;
use crate::channel::TickInput;
use crate::effect::Effect;
use crate::passivity::{InnerProduct, PassivityOptions};

/// A wall that is stable with this part of the device's damping, and with a delay of so many ticks,
/// makes no limit cycle. Where more is demanded of a wall, oscillations are found that cannot be; where
/// less, those of devices that are worse than their profiles are missed.
const WEAK: f64 = 0.1;
const DELAY: f64 = 2.0;

/// Options of the stage.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LimitCycleOptions {
    pub(crate) is_on: bool,
    /// The stiffness at the device [N/m].
    pub(crate) stiffness: f64,
    /// The mass of the device [kg].
    pub(crate) mass: f64,
    /// Its least damping [N·s/m].
    pub(crate) damping: f64,
    /// The encoder step [m].
    pub(crate) encoder_step: f64,
    /// The duration of a tick [s].
    pub(crate) period: f64,
}

impl LimitCycleOptions {
    /// For the device and the wall of the passivity stage, with an encoder step [m].
    pub(crate) fn of(passivity: &PassivityOptions, encoder_step: f64) -> Self {
        let PassivityOptions { is_on, stiffness, mass, damping, period, .. } = *passivity;
        Self { is_on, stiffness, mass, damping, encoder_step, period }
    }

    /// Whether a wall is so soft that it cannot oscillate in a hand of this damping [N·s/m]: `b > K
    /// (T/2 + the delay)`, with the delay and the part of the device's damping for which the stage is
    /// made.
    fn is_soft(&self, stiffness: f64, of_hand: f64) -> bool {
        WEAK * self.damping + of_hand > stiffness * self.period * (0.5 + DELAY)
    }
}

/// The wanted force in parts, by its cause [N].
#[derive(Clone, Copy, Debug)]
pub(crate) struct ForcesOf<V> {
    /// The force of bodies.
    pub(crate) bodies: V,
    /// The force of guides and magnets.
    pub(crate) guides: V,
}

/// What the stage sees in a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CycleInput<V> {
    pub(crate) position: V,
    /// The force of bodies and guides, as far as the force limit lets it pass [N].
    pub(crate) force: V,
    /// The size of that force before the force limit [N].
    pub(crate) effort: f64,
    /// Whether guides give a part of the force: their stiffness is not known here.
    pub(crate) is_guided: bool,
    /// Whether they give all of it.
    pub(crate) is_free_of_bodies: bool,
    /// The stiffness of the bodies that are touched, at the device [N/m].
    pub(crate) stiffness: f64,
    /// Whether the force was zeroed, by late ticks, or rises after it was: an oscillation then has
    /// causes that pass.
    pub(crate) is_disturbed: bool,
    /// Whether other bodies push from this tick on.
    pub(crate) is_handed_over: bool,
    /// By how much motion changes the force, at most [N].
    pub(crate) explained: f64,
}

impl<V: InnerProduct> CycleInput<V> {
    /// The input of forces by bodies of this `stiffness` [N/m], which were of size `effort` before the
    /// force limit [N], and by guides.
    pub(crate) fn of(
        ForcesOf { bodies, guides }: ForcesOf<V>,
        effort: f64,
        position: V,
        stiffness: f64,
    ) -> Self {
        let is_guided = guides != V::ZERO;
        let force = if is_guided { bodies + guides } else { bodies };
        let effort = if is_guided { force.norm() } else { effort };
        let is_free_of_bodies = bodies == V::ZERO;
        Self {
            position,
            force,
            effort,
            is_guided,
            is_free_of_bodies,
            stiffness,
            is_disturbed: false,
            is_handed_over: false,
            explained: 0.0,
        }
    }

    /// This input in a tick that is disturbed or not.
    pub(crate) fn disturbed(self, is_disturbed: bool) -> Self {
        Self { is_disturbed, ..self }
    }

    /// This input with what happened to the bodies in a tick.
    pub(crate) fn changed(self, tick: &TickInput) -> Self {
        let is_other = matches!(tick.change, Change::Carried | Change::HandedOver);
        let is_handed_over = is_other || tick.start < 1.0;
        // `max` ignores NaN.
        Self { is_handed_over, explained: tick.explained.max(0.0), ..self }
    }
}

/// Limit cycles that were found, and what was done about them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct LimitCycleReport {
    /// Ticks in which a force was made softer, and the largest change.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub effect: Effect,
    /// Limit cycles that were detected; each one halves the stiffness.
    pub found: u64,
    /// The least rendered stiffness over the accepted stiffness.
    pub least_part: f64,
}

impl Default for LimitCycleReport {
    fn default() -> Self {
        Self { effect: Effect::default(), found: 0, least_part: 1.0 }
    }
}

/// Finds oscillations of the device against the force, and makes the force softer until they end.
///
/// [`HalfCycles`] parts the motion, [`Repetition`] says when half cycles make a limit cycle,
/// [`HandMotion`] whether the hand drives it, and [`Governor`] how soft the wall is. Late ticks that
/// zero the force, and its rise, start the count anew.
///
/// It is blind to oscillations that turn the force and not its size, such as circles about a point,
/// and to those across the force, such as from wall to wall of a groove.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LimitCycle<V> {
    options: LimitCycleOptions,
    half_cycles: HalfCycles<V>,
    repetition: Repetition,
    hand: HandMotion,
    governor: Governor,
}

impl<V: InnerProduct> LimitCycle<V> {
    pub(crate) fn new(options: LimitCycleOptions) -> Self {
        Self {
            options,
            half_cycles: HalfCycles::new(),
            repetition: Repetition::new(),
            hand: HandMotion::new(),
            governor: Governor::new(),
        }
    }

    /// Replaces the options, where an angle may count as another length than before.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn renew(&mut self, options: LimitCycleOptions) {
        self.options = options;
        self.lose();
    }

    /// The options.
    pub(crate) fn options(&self) -> &LimitCycleOptions {
        &self.options
    }

    /// Forgets the motion so far.
    fn lose(&mut self) {
        self.half_cycles.lose();
        self.repetition.restart();
    }

    /// As [`step`](Self::step); if an input is not finite, the motion so far is forgotten.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn observed(&mut self, input: &CycleInput<V>, is_sound: bool) -> f64 {
        if is_sound {
            return self.step(input);
        }
        self.lose();
        1.0
    }

    /// The part of the stiffness to render in this tick. While a force is handed over, another part of
    /// the force may pass.
    pub(crate) fn part(&self) -> f64 {
        self.governor.part()
    }

    /// One tick: the part of the force that may pass.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn step(&mut self, input: &CycleInput<V>) -> f64 {
        if !self.options.is_on {
            return 1.0;
        }
        let period = self.options.period;
        self.hand.pass(period);
        self.governor.pass(period);
        if let Some(ended) = self.half_cycles.follow(input, &self.options) {
            self.count(&ended, input);
        }
        if input.is_disturbed {
            self.repetition.restart();
        }
        self.governor.step(input, period)
    }

    /// Counts a half cycle, and halves the stiffness after a limit cycle, or gives it back to a hand that
    /// drives the oscillation.
    fn count(&mut self, ended: &Ended, input: &CycleInput<V>) {
        let Ended { half_cycle, is_counted, is_pressed } = *ended;
        if is_counted {
            self.repetition.press(is_pressed);
        }
        if !is_counted || self.hand.is_known(half_cycle.way) {
            self.repetition.restart();
            return;
        }
        let stiffness = if input.is_guided { self.options.stiffness } else { input.stiffness };
        if self.repetition.count(half_cycle, stiffness, &self.options) {
            self.governor.disturb();
        }
        let Some(found) = self.repetition.take() else { return };
        let stiffness = stiffness * self.governor.target();
        let wall = SoftenedWall { halvings: self.governor.halvings(), stiffness };
        if self.hand.drives(&found, wall, &self.options) {
            self.governor.restore();
        } else {
            self.governor.halve();
        }
    }

    /// Whether the stiffness comes back in this tick, by what a hand was told from the wall.
    pub(crate) fn is_returning(&self) -> bool {
        self.governor.is_returning()
    }

    pub(crate) fn report(&self) -> LimitCycleReport {
        self.governor.report()
    }
}

#[cfg(test)]
mod tests;
