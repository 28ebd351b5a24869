// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that move under the hand: the frame that moves with them, and the limit on their power.
//!
//! The energy of a contact is exchanged in the frame of the touched body: the force times the
//! motion of the hand relative to the body's material point. A body that is moved from outside is a
//! drive. It does the rest of the force's work on the hand: the force times the body's own motion.
//! That work is counted apart, and its power is limited.

use crate::effect::Effect;
use crate::passivity::{InnerProduct, STEP};

/// How the bodies that push the hand moved in a tick. Device coordinates.
///
/// The motion of a body is that of its material point at the hand [m]. Where several bodies push, it is
/// the mean of theirs, weighted by the sizes of their forces. A body that stands still moves by zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingBodies<V> {
    /// The share that is moved from outside, as by a scene's motions: its work is that of a drive.
    pub driven: V,
    /// The share that moves by physics. `credit` pays for its work first, the balance of the contact for
    /// the rest.
    pub dynamic: V,
    /// The energy that bodies moving by physics lost in this tick, and may give to the hand [J].
    pub credit: f64,
}

impl<V: InnerProduct> MovingBodies<V> {
    /// Bodies that stand still.
    pub(crate) const NONE: Self = Self { driven: V::ZERO, dynamic: V::ZERO, credit: 0.0 };

    /// The motion of the point that the hand touches [m].
    fn way(&self) -> V {
        self.driven + self.dynamic
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.driven.is_finite() && self.dynamic.is_finite() && self.credit.is_finite()
    }
}

impl<V: InnerProduct> Default for MovingBodies<V> {
    fn default() -> Self {
        Self::NONE
    }
}

/// The work of moving bodies on the hand, and the limit on the power of drives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct DriveReport {
    /// Ticks in which the limit made a force smaller, and the largest change.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub effect: Effect,
    /// The work of driven bodies on the hand [J]: the written forces times the bodies' motion. Negative
    /// where the hand did more work on them.
    pub driven: f64,
    /// The work of bodies that move by physics on the hand [J].
    pub dynamic: f64,
}

/// The motion of a tick, as the stages see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<V> {
    /// The sum of the motions of touched bodies so far [m]. If the hand moves with the body, its position
    /// relative to this stays constant.
    pub(crate) origin: V,
    /// The motion of the touched bodies in this tick [m].
    pub(crate) way: V,
    /// The work in this tick of bodies that move by physics, less their credit [J].
    pub(crate) owed: f64,
}

/// The frame of the touched bodies, and the stage that limits the power of drives.
///
/// The power of a drive is the force times the body's velocity. Where it would exceed the limit,
/// the force becomes smaller. It falls by at most 0.3 N a tick, so that a body that starts at once
/// does not kick, and comes back by 20 N/s, because the hand may then be deep in the body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drive<V> {
    /// The largest power [W].
    max_power: f64,
    /// How fast the force comes back that was taken [N/s]: the hand may be deep in the body then.
    rise_rate: f64,
    origin: V,
    /// The force that was written in the tick before.
    written: V,
    /// What was taken from the last force [N].
    taken: f64,
    /// Whether it comes back.
    is_returning: bool,
    report: DriveReport,
}

impl<V: InnerProduct> Drive<V> {
    pub(crate) fn new(max_power: f64, rise_rate: f64) -> Self {
        Self {
            max_power,
            rise_rate,
            origin: V::ZERO,
            written: V::ZERO,
            taken: 0.0,
            is_returning: false,
            report: DriveReport::default(),
        }
    }

    /// Counts the work of the force that was held over this tick, and moves the frame along.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn enter(&mut self, motion: &MovingBodies<V>) -> Frame<V> {
        let dynamic = self.written.dot(motion.dynamic);
        self.report.driven += self.written.dot(motion.driven);
        self.report.dynamic += dynamic;
        let way = motion.way();
        self.origin = self.origin + way;
        Frame { origin: self.origin, way, owed: dynamic - motion.credit }
    }

    /// The force that may be written in place of `wanted`, whose bodies moved so in a time `elapsed`
    /// [s].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn limit(&mut self, wanted: V, motion: &MovingBodies<V>, elapsed: f64) -> V {
        let power = wanted.dot(motion.driven) / elapsed;
        // Written so that NaN is not above the limit: the guard zeroes the force.
        let is_above = power > self.max_power;
        if !is_above && self.taken == 0.0 {
            return wanted;
        }
        let force = wanted.norm();
        let allowed = if is_above {
            // It falls in steps, and does not rise where the body is pressed on faster than that.
            (force * (self.max_power / power)).max(self.written.norm() - STEP)
        } else {
            f64::INFINITY
        };
        // A body that brakes may give more in each tick: what was taken comes back no faster for it.
        let back = force - self.taken + self.rise_rate * elapsed;
        self.is_returning = back < allowed;
        self.taken = force - back.min(allowed).clamp(0.0, force);
        let changed = (self.taken > 0.0).then(|| wanted * (1.0 - self.taken / force));
        self.report.effect.count(wanted, changed)
    }

    /// Whether a force comes back that was taken: the hand that it lifts gets energy for that.
    pub(crate) fn is_returning(&self) -> bool {
        self.is_returning && self.taken > 0.0
    }

    /// Records the force that was written.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn written(&mut self, force: V) {
        self.written = force;
    }

    /// Converts the state to other units of displacement and force.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn in_units(&mut self, way: impl Fn(V) -> V, force: impl Fn(V) -> V) {
        self.origin = way(self.origin);
        self.written = force(self.written);
    }

    pub(crate) fn report(&self) -> DriveReport {
        self.report
    }
}

#[cfg(test)]
mod tests {
    use palpate_field::Vector;

    use super::*;

    const PERIOD: f64 = 1.0 / 1024.0;

    fn driven(way: f64) -> MovingBodies<Vector<f64, 3>> {
        MovingBodies { driven: Vector([0.0, way, 0.0]), ..MovingBodies::NONE }
    }

    fn up(force: f64) -> Vector<f64, 3> {
        Vector([0.0, force, 0.0])
    }

    #[test]
    fn the_power_of_a_drive_is_limited_without_a_kick() {
        let mut drive = Drive::new(1.0, 20.0);
        // 4 N at 0.5 m/s are 2 W.
        let motion = driven(0.5 * PERIOD);
        let mut last = up(4.0);
        drive.written(last);
        for tick in 1..20 {
            let force = drive.limit(up(4.0), &motion, PERIOD);
            drive.written(force);
            assert!((last - force).norm() <= 0.3 + 1e-15, "{tick}");
            assert!((force[1] - (4.0 - 0.3 * f64::from(tick)).max(2.0)).abs() < 1e-12);
            last = force;
        }
        for tick in 1..200 {
            let force = drive.limit(up(4.0), &driven(0.0), PERIOD);
            let risen = 2.0 + 20.0 * PERIOD * f64::from(tick);
            assert!((force[1] - risen.min(4.0)).abs() < 1e-12);
        }
        assert_eq!(drive.limit(up(4.0), &driven(0.0), PERIOD), up(4.0));
        let effect = drive.report().effect;
        assert_eq!((effect.ticks, effect.largest), (19 + 102, 2.0));
    }

    #[test]
    fn work_is_counted_by_who_moves_the_body() {
        let mut drive = Drive::new(1.0, 20.0);
        drive.written(up(2.0));
        let (way, credit) = (up(0.25), 0.125);
        let frame = drive.enter(&MovingBodies { driven: up(0.5), dynamic: way, credit });
        assert_eq!((frame.origin, frame.way, frame.owed), (up(0.75), up(0.75), 0.375));
        let report = drive.report();
        assert_eq!((report.driven, report.dynamic), (1.0, 0.5));
        let frame = drive.enter(&MovingBodies::NONE);
        assert_eq!((frame.origin, frame.way, frame.owed), (up(0.75), up(0.0), 0.0));
    }

    #[test]
    fn a_drive_that_pulls_away_or_is_not_a_number_is_not_limited() {
        let mut drive = Drive::new(1.0, 20.0);
        assert_eq!(drive.limit(up(4.0), &driven(-1.0), PERIOD), up(4.0));
        assert!(drive.limit(up(f64::NAN), &driven(1.0), PERIOD).0[1].is_nan());
    }
}
