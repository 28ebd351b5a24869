// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Half cycles: the motion along the force, parted at its extremes.

use super::{CycleInput, LimitCycleOptions};
use crate::passivity::InnerProduct;

// How far and how long a half cycle is. Shorter ways are noise of encoders and tremor of hands, which
// would make walls soft; longer times are strokes of hands.

/// Smallest peak-to-peak position amplitude that counts as felt [m].
const FELT_WAY: f64 = 5e-5;

/// Smallest peak-to-peak force amplitude that counts as felt [N].
const FELT_FORCE: f64 = 0.15;

/// Readings of a device at rest may go to and fro by so many encoder steps.
const STEPS: f64 = 3.0;

/// Longer half cycles do not count at all [s].
const LONGEST: f64 = 0.2;

// Whether a half cycle is of the hand on the spring. With wider limits bodies that move the hand, and
// relief below a travelling hand, make walls soft; with narrower ones oscillations are missed.

/// How much the change of the force between two extremes may differ from that of the spring, as a
/// part of it: beyond, a body moves, and not the hand alone.
const FORCED: f64 = 0.3;

/// The way of the device over its way along the force, at most, unless the force keeps its
/// direction: a hand that travels along a body meets its relief.
const ALONG: f64 = 1.25;

/// The cosine of the largest angle by which a force turns that keeps its direction.
const FLAT: f64 = 0.995;

/// A motion from one extreme to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HalfCycle {
    /// Its way, the distance between the extremes along the force [m].
    pub(super) way: f64,
    /// Its time [s].
    pub(super) time: f64,
}

impl HalfCycle {
    pub(super) const UNKNOWN: Self = Self { way: 0.0, time: 0.0 };
}

/// A half cycle that ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ended {
    pub(super) half_cycle: HalfCycle,
    /// Whether the device may have made it by itself.
    pub(super) is_counted: bool,
    /// Whether the device touched at both extremes.
    pub(super) is_pressed: bool,
}

/// An extreme of the motion along the force.
#[derive(Clone, Copy, Debug)]
struct Extreme<V> {
    /// The position of the device [m].
    position: V,
    /// The place along the force, into the body [m].
    place: f64,
    /// The size of the force there [N].
    effort: f64,
    /// The time since the extreme before [s].
    time: f64,
}

/// Parts the motion along the force at its extremes into half cycles: ways of at least 50 µm,
/// or of 0.15 N in the force if that is less, and of three encoder steps. A half cycle counts if
///
/// - it takes at most 0.2 s;
/// - the device moves along the force, or the force keeps its direction: otherwise the relief of the
///   body would move it;
/// - and the force changes as the spring explains, so that no body moves the hand, and the wall is
///   not [soft](LimitCycleOptions::is_soft).
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfCycles<V> {
    /// The position of the last tick, unless it was not finite.
    last_position: Option<V>,
    /// The direction of the last force that was not zero.
    direction: V,
    /// 1 on the way into the body, −1 on the way out.
    heading: f64,
    /// The place along the force, into the body [m].
    place: f64,
    /// The extreme from which the present way came.
    last: Extreme<V>,
    /// The farthest place on the present way.
    farthest: Extreme<V>,
    /// The time since the farthest place [s].
    since: f64,
    /// The direction of the force at the start of the present way.
    start: V,
    /// The cosine of the largest angle to `start` since.
    bent: f64,
}

impl<V: InnerProduct> HalfCycles<V> {
    pub(super) const fn new() -> Self {
        let start = Extreme { position: V::ZERO, place: 0.0, effort: 0.0, time: 0.0 };
        Self {
            last_position: None,
            direction: V::ZERO,
            heading: 1.0,
            place: 0.0,
            last: start,
            farthest: start,
            since: 0.0,
            start: V::ZERO,
            bent: 1.0,
        }
    }

    /// Forgets the last position: the way to the next one does not count.
    pub(super) const fn lose(&mut self) {
        self.last_position = None;
    }

    /// Follows the motion for one tick: the half cycle that ends with it, if one does.
    pub(super) fn follow(
        &mut self,
        input: &CycleInput<V>,
        options: &LimitCycleOptions,
    ) -> Option<Ended> {
        let size = input.force.norm();
        if size > 0.0 {
            self.direction = input.force * (1.0 / size);
            self.bent = self.bent.min(self.direction.dot(self.start));
        }
        let way = self.last_position.map_or(V::ZERO, |last| input.position - last);
        self.last_position = Some(input.position);
        self.place -= way.dot(self.direction);
        // Ticks are even on average, readings need not be.
        self.since += options.period;
        let beyond = self.heading * (self.place - self.farthest.place);
        let CycleInput { position, effort, stiffness, .. } = *input;
        let here = Extreme { position, place: self.place, effort, time: self.since };
        let mut ended = None;
        if beyond > 0.0 {
            self.farthest = Extreme { time: self.farthest.time + self.since, ..here };
            self.since = 0.0;
        } else if -beyond >= least_way(stiffness, options) {
            ended = Some(self.turn(input, options));
            (self.start, self.bent) = (self.direction, 1.0);
            self.farthest = here;
            self.since = 0.0;
        }
        ended
    }

    /// Ends a half cycle at the farthest place.
    fn turn(&mut self, input: &CycleInput<V>, options: &LimitCycleOptions) -> Ended {
        let (from, to) = (self.last, self.farthest);
        let way = (to.place - from.place).abs();
        let of_spring = input.stiffness * way;
        // A spring presses more where it is deeper.
        let change = (to.effort - from.effort) * self.heading;
        let is_touching = to.effort > 0.0 || from.effort > 0.0;
        // Outside of the body, the hand moves without a force.
        let is_pressed = to.effort > 0.0 && from.effort > 0.0;
        let least = if is_pressed { 1.0 - FORCED } else { 0.0 };
        let is_of_spring = (least * of_spring..=(1.0 + FORCED) * of_spring).contains(&change);
        let is_free = input.is_guided || is_of_spring && !options.is_soft(input.stiffness, 0.0);
        let is_straight = (to.position - from.position).norm() <= ALONG * way;
        let is_along = is_straight || self.bent >= FLAT;
        let is_counted = is_free && is_touching && is_along && to.time <= LONGEST;
        self.last = to;
        self.heading = -self.heading;
        Ended { half_cycle: HalfCycle { way, time: to.time }, is_counted, is_pressed }
    }
}

/// The least way that counts as an oscillation at a wall of this stiffness [N/m].
fn least_way(stiffness: f64, options: &LimitCycleOptions) -> f64 {
    FELT_WAY.min(FELT_FORCE / stiffness).max(STEPS * options.encoder_step)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use palpate_field::Vector;

    use super::super::ForcesOf;
    use super::super::tests::{PERIOD, options};
    use super::*;

    /// The half cycles of a second in which a device moves to `depth(t)` [m] in a wall of 1000 N/m that
    /// gives the force of `stiff` [N/m], and along the wall by `aside(t)` [m].
    fn ended(stiff: f64, depth: impl Fn(f64) -> f64, aside: impl Fn(f64) -> f64) -> Vec<Ended> {
        let mut half_cycles = HalfCycles::new();
        let of_tick = |tick| {
            let t = f64::from(tick) * PERIOD;
            let bodies = Vector([0.0, stiff * depth(t).max(0.0), 0.0]);
            let forces = ForcesOf { bodies, guides: Vector::ZERO };
            let position = Vector([aside(t), -depth(t), 0.0]);
            let input = CycleInput::of(forces, bodies.norm(), position, 1000.0);
            half_cycles.follow(&input, &options())
        };
        // The first way begins anywhere.
        (0..1000).filter_map(of_tick).skip(1).collect()
    }

    #[test]
    fn a_wave_is_parted_at_its_extremes() {
        let wave = |t: f64| 3e-3 + 1e-3 * (TAU * 10.0 * t).sin();
        let found = ended(1000.0, wave, |_| 0.0);
        assert_eq!(found.len(), 19);
        for Ended { half_cycle: HalfCycle { way, time }, is_counted, is_pressed } in found {
            assert!((way - 2e-3).abs() < 1e-12 && (time - 0.05).abs() < 1e-12);
            assert!(is_counted && is_pressed);
        }
        let bounce = ended(1000.0, |t| wave(t) - 3e-3, |_| 0.0);
        assert!(bounce.iter().all(|ended| ended.is_counted && !ended.is_pressed));
    }

    #[test]
    fn what_bodies_and_strokes_move_does_not_count() {
        let wave = |frequency: f64| move |t: f64| 3e-3 + 1e-3 * (TAU * frequency * t).sin();
        let counted = |ended: Vec<Ended>| ended.iter().filter(|ended| ended.is_counted).count();
        // A body that moves with the hand changes the force by half of what the spring would.
        assert_eq!(counted(ended(500.0, wave(10.0), |_| 0.0)), 0);
        // A half cycle takes 0.25 s.
        assert_eq!(counted(ended(1000.0, wave(2.0), |_| 0.0)), 0);
        // A hand that travels along a flat wall.
        assert!(counted(ended(1000.0, wave(10.0), |t| 0.2 * t)) > 0);
        // The first ways are too short to be felt.
        assert!(ended(1000.0, |t| 3e-3 + 2e-5 * (TAU * 10.0 * t).sin(), |_| 0.0).is_empty());
    }
}
