// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How soft a wall becomes, and when its stiffness comes back.

use super::{CycleInput, LimitCycleReport};
use crate::passivity::InnerProduct;

// How soft a wall becomes. A smaller part ends an oscillation sooner and leaves less of the wall.

/// The part of the stiffness that remains after a limit cycle.
const HALVED: f64 = 0.5;

/// How often the stiffness is halved at most, and the least part of it that remains.
pub(super) const HALVINGS: usize = 5;
const LEAST: f64 = 1.0 / 32.0;

// How fast the force changes. Faster is felt as a kick.

/// The most by which a force changes in a tick because its wall becomes softer [N].
pub(super) const STEP: f64 = 0.3;

/// How fast the force of a wall comes back to a hand that trembles [N/s].
const RETURN: f64 = 20.0;

// When the stiffness comes back. Sooner, the oscillation returns as soon.

/// The time in which the stiffness comes back by a factor of e [s].
const RECOVERY: f64 = 20.0;

/// A hand is calm in a guide if no quick half cycle ended for so long [s].
const CALM: f64 = 1.0;

/// The stiffness of walls after limit cycles.
///
/// A limit cycle halves it, at the rate of 0.3 N a tick. It comes back by a factor of e in 20 s in which
/// nothing pushes, or in which a hand in a guide makes no quick half cycles; not in contact with a body,
/// where the oscillation would return.
#[derive(Clone, Copy, Debug)]
pub(super) struct Governor {
    /// The time since a quick half cycle [s].
    calm: f64,
    /// The part of the stiffness to come.
    target: f64,
    /// The part of the stiffness in this tick.
    part: f64,
    /// What it left of the last force [N].
    left: f64,
    /// Whether what is left follows a handover.
    follows: bool,
    report: LimitCycleReport,
}

impl Governor {
    pub(super) fn new() -> Self {
        let report = LimitCycleReport::default();
        Self { calm: 0.0, target: 1.0, part: 1.0, left: 0.0, follows: false, report }
    }

    /// Lets a tick of this duration pass [s].
    pub(super) const fn pass(&mut self, period: f64) {
        self.calm += period;
    }

    /// Notes that a quick half cycle ended.
    pub(super) const fn disturb(&mut self) {
        self.calm = 0.0;
    }

    /// Halves the stiffness after a limit cycle.
    pub(super) fn halve(&mut self) {
        self.target = (self.target * HALVED).max(LEAST);
        self.report.found += 1;
    }

    /// Gives the stiffness back.
    pub(super) const fn restore(&mut self) {
        self.target = 1.0;
    }

    /// The part of the stiffness to come.
    pub(super) const fn target(&self) -> f64 {
        self.target
    }

    /// The part of the stiffness in this tick.
    pub(super) const fn part(&self) -> f64 {
        self.part
    }

    /// How often the stiffness to come was halved.
    pub(super) fn halvings(&self) -> usize {
        (-self.target.log2()).round() as usize
    }

    /// Whether the stiffness comes back in this tick, by what a hand was told from the wall.
    pub(super) fn is_returning(&self) -> bool {
        self.target == 1.0 && self.part < 1.0
    }

    /// The part of the force that may pass in a tick of this duration [s].
    pub(super) fn step<V: InnerProduct>(&mut self, input: &CycleInput<V>, period: f64) -> f64 {
        if self.target == 1.0 && self.part == 1.0 && !self.follows {
            self.left = input.effort;
            return 1.0;
        }
        self.soften(input, period)
    }

    #[cold]
    fn soften<V: InnerProduct>(&mut self, input: &CycleInput<V>, period: f64) -> f64 {
        let (force, effort) = (input.force.norm(), input.effort);
        // A guide need not end anywhere, so that its stiffness comes back while a hand is in it.
        let is_calm = input.is_free_of_bodies && self.calm >= CALM;
        if force == 0.0 && effort == 0.0 || is_calm {
            self.target = (self.target * (1.0 + period / RECOVERY)).min(1.0);
        }
        if self.part <= self.target {
            let rise = if effort > 0.0 { RETURN * period / effort } else { 1.0 };
            self.part = (self.part + rise).min(self.target);
        } else {
            // As long as the wall gives more than the force limit, less of it changes nothing.
            let free = if force < effort { force / effort } else { 1.0 };
            self.part = (self.part.min(free) - STEP / effort).max(self.target);
            self.report.least_part = self.report.least_part.min(self.part);
        }
        let left = self.followed(self.part * effort, input);
        if left < force {
            self.report.effect.count_size(force - left);
        }
        self.left = left.min(force);
        if self.follows && effort > 0.0 { (left / effort).min(1.0) } else { self.part }
    }

    /// What may be left of a force of which the softer wall leaves `left` [N]. A handover changes the
    /// force at once, so what is left of it follows step by step.
    fn followed<V: InnerProduct>(&mut self, left: f64, input: &CycleInput<V>) -> f64 {
        self.follows |= input.is_handed_over;
        if !self.follows {
            return left;
        }
        let most = STEP + self.part * input.explained;
        // `max` and `min` ignore NaN.
        let near = left.max(self.left - most).min(self.left + most);
        self.follows = near != left;
        near
    }

    pub(super) const fn report(&self) -> LimitCycleReport {
        self.report
    }
}

#[cfg(test)]
mod tests {
    use palpate_field::Vector;

    use super::super::ForcesOf;
    use super::super::tests::PERIOD;
    use super::*;

    fn pushed(force: f64) -> CycleInput<Vector<f64, 3>> {
        let bodies = Vector([0.0, force, 0.0]);
        let forces = ForcesOf { bodies, guides: Vector::ZERO };
        CycleInput::of(forces, force, Vector::ZERO, 1000.0)
    }

    #[test]
    fn a_wall_is_halved_five_times_at_most() {
        let mut governor = Governor::new();
        for halvings in [0, 1, 2, 3, 4, 5, 5, 5] {
            assert_eq!(governor.halvings(), halvings);
            governor.halve();
        }
        assert_eq!((governor.target(), governor.report().found), (LEAST, 8));
    }

    #[test]
    fn a_force_falls_by_a_step_a_tick_and_returns_more_slowly() {
        let mut governor = Governor::new();
        assert_eq!(governor.step(&pushed(2.0), PERIOD), 1.0);
        governor.halve();
        // Of 2 N, 0.3 N a tick are 0.15.
        for part in [0.85, 0.7, 0.55, 0.5, 0.5] {
            let left = governor.step(&pushed(2.0), PERIOD);
            assert!((left - part).abs() < 1e-12, "{left}");
        }
        governor.restore();
        assert!(governor.is_returning());
        // 20 N/s are 0.02 N a tick, 0.01 of 2 N.
        let left = governor.step(&pushed(2.0), PERIOD);
        assert!((left - 0.51).abs() < 1e-12, "{left}");
    }

    #[test]
    fn a_calm_hand_in_a_guide_gets_it_back_and_one_in_a_body_does_not() {
        let body = pushed(2.0);
        let guide = CycleInput { is_free_of_bodies: true, ..body };
        for (input, is_back) in [(&body, false), (&guide, true)] {
            let mut governor = Governor::new();
            governor.halve();
            // log 2 of 20 s are 13.9 s.
            for _ in 0..16_000 {
                governor.pass(PERIOD);
                governor.step(input, PERIOD);
            }
            assert_eq!(governor.target() == 1.0, is_back);
        }
    }
}
