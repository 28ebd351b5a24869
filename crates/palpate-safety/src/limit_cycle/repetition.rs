// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Repetition: when half cycles make a limit cycle.

use std::f64::consts::TAU;

use super::LimitCycleOptions;
use super::half_cycles::HalfCycle;

// How many half cycles are compared, and how. Fewer, or more that decay, are the settling of a hand that
// lands; with more, an oscillation is felt for longer before it is found.

/// Half cycles that are kept; so many make a limit cycle if they do not decay.
const KEPT: usize = 8;

/// An oscillation decays if its way shrinks to this part of the longest that is kept.
const DECAYED: f64 = 0.7;

/// So many half cycles make a limit cycle if both of its sides grow by [`GROWN`].
const GROWING: usize = 6;

/// The least growth within two half cycles that counts.
const GROWN: f64 = 1.2;

// Which half cycles are quick. Where slower ones are, hands that tap or scrub make walls soft; where
// quicker ones alone are, heavy devices bounce on.

/// Half cycles up to this duration count as quick on every device [s]: few hands go to and fro six
/// times a second.
const QUICK: f64 = 0.08;

/// Half cycles are quick up to this duration at most [s].
const LONGEST_QUICK: f64 = 0.16;

/// A mass of the hand that moves with the device [kg].
const HAND: f64 = 0.1;

/// A limit cycle that was found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Oscillation {
    /// The mean of its half cycles.
    pub(super) mean: HalfCycle,
    /// The longest way of its half cycles [m].
    pub(super) longest: f64,
    /// Whether the device did not leave the body.
    pub(super) is_pressed: bool,
}

/// The last half cycles that followed each other. There is a limit cycle if
///
/// - six quick half cycles grow, both sides by 1.2 a cycle;
/// - or the last of eight quick half cycles is at least 0.7 of the longest;
/// - or eight half cycles grow, each cycle a little.
///
/// A half cycle is quick within 80 ms, or `2π √(M/K)` up to 160 ms with the mass `M` of device and hand
/// and the stiffness `K`: the natural half cycle of a bouncing mass is longer than that of one in
/// contact, `π √(M/K)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Repetition {
    /// The last half cycles, the newest first.
    last: [HalfCycle; KEPT],
    /// How many of them count.
    counted: usize,
    /// How many of them are quick.
    quick: usize,
    /// How many of the last ones left the body at neither end.
    pressed: usize,
}

impl Repetition {
    pub(super) const fn new() -> Self {
        Self { last: [HalfCycle::UNKNOWN; KEPT], counted: 0, quick: 0, pressed: 0 }
    }

    /// Counts anew.
    pub(super) const fn restart(&mut self) {
        (self.counted, self.quick) = (0, 0);
    }

    /// Notes whether a half cycle left the body at neither end.
    pub(super) const fn press(&mut self, is_pressed: bool) {
        self.pressed = if is_pressed { self.pressed + 1 } else { 0 };
    }

    /// Counts a half cycle in a wall of this stiffness [N/m], and says whether it is quick.
    pub(super) fn count(
        &mut self,
        half_cycle: HalfCycle,
        stiffness: f64,
        options: &LimitCycleOptions,
    ) -> bool {
        self.last.rotate_right(1);
        let [newest, ..] = &mut self.last;
        *newest = half_cycle;
        self.counted = (self.counted + 1).min(KEPT);
        let natural = TAU * ((options.mass + HAND) / stiffness).sqrt();
        let is_quick = half_cycle.time <= natural.clamp(QUICK, LONGEST_QUICK);
        self.quick = if is_quick { (self.quick + 1).min(KEPT) } else { 0 };
        is_quick
    }

    /// The limit cycle that the last half cycles make, if they do. Then the count starts anew: what
    /// follows is the motion in another wall.
    pub(super) fn take(&mut self) -> Option<Oscillation> {
        if !self.is_limit_cycle() {
            return None;
        }
        self.restart();
        let mean =
            |of: fn(&HalfCycle) -> f64| self.last.iter().map(of).sum::<f64>() / KEPT as f64;
        Some(Oscillation {
            mean: HalfCycle { way: mean(|half| half.way), time: mean(|half| half.time) },
            longest: self.longest(),
            is_pressed: self.pressed >= GROWING,
        })
    }

    fn is_limit_cycle(&self) -> bool {
        let [a, b, c, d, e, f, g, h] = self.last.map(|half| half.way);
        let grows = |x: f64, y: f64, z: f64| x >= GROWN * y && y >= GROWN * z;
        let explodes = self.quick >= GROWING && grows(a, c, e) && grows(b, d, f);
        let persists = self.quick >= KEPT && a >= DECAYED * self.longest();
        let [out, back] =
            [[a, c, e, g], [b, d, f, h]].map(|ways| ways.is_sorted_by(|x, y| x > y));
        explodes || persists || self.counted >= KEPT && out && back
    }

    /// The longest way that is kept [m].
    fn longest(&self) -> f64 {
        self.last.iter().map(|half| half.way).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::options;
    use super::*;

    /// After how many half cycles of these ways [m] and this time [s] a limit cycle is found.
    fn found(time: f64, ways: impl IntoIterator<Item = f64>) -> Option<usize> {
        let mut repetition = Repetition::new();
        let is_found = |way| {
            let _ = repetition.count(HalfCycle { way, time }, 1000.0, &options());
            repetition.take().is_some()
        };
        ways.into_iter().position(is_found).map(|before| before + 1)
    }

    #[test]
    fn six_that_grow_or_eight_that_persist_are_a_limit_cycle() {
        let powers = |factor: f64| (0..20).map(move |k| 1e-3 * factor.powi(k));
        assert_eq!(found(0.05, powers(1.1)), Some(6)); // 1.21 a cycle
        assert_eq!(found(0.05, powers(1.0)), Some(8));
        assert_eq!(found(0.05, powers(0.96)), Some(8)); // 0.96⁷ = 0.75
        assert_eq!(found(0.05, powers(0.94)), None); // 0.94⁷ = 0.65
        // Not quick.
        assert_eq!(found(0.17, powers(1.1)), Some(8));
        assert_eq!(found(0.17, powers(1.0)), None);
    }

    #[test]
    fn an_oscillation_is_what_was_counted() {
        let mut repetition = Repetition::new();
        for k in 0..8 {
            assert!(repetition.take().is_none(), "{k}");
            repetition.press(k > 1);
            let half_cycle = HalfCycle { way: 1.0 + f64::from(k % 2), time: 0.0625 };
            assert!(repetition.count(half_cycle, 1000.0, &options()));
        }
        let found = repetition.take().unwrap();
        assert_eq!(found.mean, HalfCycle { way: 1.5, time: 0.0625 });
        assert!(found.longest == 2.0 && found.is_pressed && repetition.take().is_none());
    }
}
