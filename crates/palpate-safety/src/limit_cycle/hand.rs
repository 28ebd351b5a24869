// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whether the hand or the device drives an oscillation.

use super::LimitCycleOptions;
use super::governor::HALVINGS;
use super::half_cycles::HalfCycle;
use super::repetition::Oscillation;

// When an oscillation is the hand's. If that is believed too early, a device goes on oscillating; if too
// late, a hand that trembles loses its wall.

/// A hand drives an oscillation that keeps its frequency while the stiffness is halved so many times.
const UNMOVED_HALVINGS: usize = 2;

/// The least number of halvings after which an oscillation may count as the hand's.
const TOLD_HALVINGS: usize = 3;

/// A damping of half of the weakest hand that the stage is made for [N·s/m].
const HAND_DAMPING: f64 = 0.5;

/// A frequency is kept if the shorter of two times is at least this part of the longer, and the way of
/// the softer wall is at least [`KEPT_WAY`] of the other.
const KEPT_TIME: f64 = 0.75;
const KEPT_WAY: f64 = 0.5;

// How long that is believed, and of which motions.

/// Half cycles up to so many times the hand's way are then ignored, for [`HAND_TIME`] at first and twice as
/// long each time, up to [`LONGEST_HAND_TIME`] [s]: a hand may stop, and the device begin.
const HAND_MARGIN: f64 = 1.5;
const HAND_TIME: f64 = 10.0;
const LONGEST_HAND_TIME: f64 = 160.0;

/// The wall in which an oscillation was found.
#[derive(Clone, Copy, Debug)]
pub(super) struct SoftenedWall {
    /// How often its stiffness was halved.
    pub(super) halvings: usize,
    /// What is left of its stiffness [N/m].
    pub(super) stiffness: f64,
}

/// Tells oscillations of the hand from those of the device.
///
/// The tremor of a hand, 6 to 12 times a second, looks like a limit cycle. But an oscillation of the
/// device gets slower in a softer wall, or ends. One that keeps its frequency in a quarter of the
/// stiffness without a bounce, or goes on in a wall too soft to oscillate, is the hand's. Half cycles of
/// that size are then ignored for a while.
#[derive(Clone, Copy, Debug)]
pub(super) struct HandMotion {
    /// The mean half cycle for which the stiffness was halved, by the number of halvings before; unknown
    /// also where the cycles left the body.
    seen: [HalfCycle; HALVINGS + 1],
    /// Oscillations up to this amplitude are attributed to the hand [m].
    way: f64,
    /// The time left in which they are ignored [s].
    time: f64,
    /// The length of the next such period [s].
    next_time: f64,
}

impl HandMotion {
    pub(super) const fn new() -> Self {
        let seen = [HalfCycle::UNKNOWN; HALVINGS + 1];
        Self { seen, way: 0.0, time: 0.0, next_time: HAND_TIME }
    }

    /// Lets a tick of this duration pass [s].
    pub(super) const fn pass(&mut self, period: f64) {
        self.time -= period;
    }

    /// Whether a half cycle of this way is known to be the hand's [m].
    pub(super) fn is_known(&self, way: f64) -> bool {
        self.time > 0.0 && way <= self.way
    }

    /// Whether the hand drives an oscillation that was found in this wall; its half cycles are then known
    /// for a while.
    pub(super) fn drives(
        &mut self,
        found: &Oscillation,
        wall: SoftenedWall,
        options: &LimitCycleOptions,
    ) -> bool {
        let is_driven = self.is_driven(found, wall, options);
        if is_driven {
            (self.way, self.time) = (HAND_MARGIN * found.longest, self.next_time);
            self.next_time = (2.0 * self.next_time).min(LONGEST_HAND_TIME);
        }
        is_driven
    }

    fn is_driven(
        &mut self,
        &Oscillation { mean: now, is_pressed, .. }: &Oscillation,
        wall: SoftenedWall,
        options: &LimitCycleOptions,
    ) -> bool {
        let (stiffer, softer) = self.seen.split_at_mut(wall.halvings.min(HALVINGS));
        softer.fill(HalfCycle::UNKNOWN);
        // How often a mass bounces on a wall is hardly a matter of its stiffness.
        if let [here, ..] = softer
            && is_pressed
        {
            *here = now;
        }
        let is_kept = |HalfCycle { way, time }: &HalfCycle| {
            let is_way_kept = *way > 0.0 && now.way >= KEPT_WAY * way;
            is_way_kept && time.min(now.time) >= KEPT_TIME * time.max(now.time)
        };
        let is_unmoved = stiffer.iter().rev().skip(UNMOVED_HALVINGS - 1).any(is_kept);
        let is_soft = options.is_soft(wall.stiffness, HAND_DAMPING);
        wall.halvings >= TOLD_HALVINGS && (is_soft || is_pressed && is_unmoved)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::options;
    use super::*;

    /// After how many halvings of a wall [N/m] an oscillation is the hand's, whose half cycle takes
    /// `time` [s] before and is longer by `factor` after each.
    fn told(stiffness: f64, time: f64, factor: f64) -> (HandMotion, Option<usize>) {
        let mut hand = HandMotion::new();
        let is_told = |&halvings: &usize| {
            let powers = halvings as i32;
            let mean = HalfCycle { way: 1e-3, time: time * factor.powi(powers) };
            let found = Oscillation { mean, longest: 1.25e-3, is_pressed: true };
            let wall = SoftenedWall { halvings, stiffness: stiffness * 0.5_f64.powi(powers) };
            hand.drives(&found, wall, &options())
        };
        let told = (0..=HALVINGS).find(is_told);
        (hand, told)
    }

    #[test]
    fn a_hand_keeps_its_frequency_and_a_device_does_not() {
        // Soft is a wall whose stiffness times 2.5 ms is less than half of the hand's damping.
        assert_eq!(told(1e4, 0.05, 1.0).1, Some(3));
        assert_eq!(told(1e5, 0.05, 2.0_f64.sqrt()).1, None);
        // 0.55 N·s/m are more than 1000/8 N/m · 2.5 ms.
        assert_eq!(told(1000.0, 0.05, 2.0_f64.sqrt()).1, Some(3));
    }

    #[test]
    fn half_cycles_of_the_hand_are_known_for_a_while() {
        let (mut hand, _) = told(1e4, 0.05, 1.0);
        assert!(hand.is_known(1.8e-3) && !hand.is_known(1.9e-3));
        hand.pass(HAND_TIME);
        assert!(!hand.is_known(1e-3) && hand.next_time == 2.0 * HAND_TIME);
    }
}
