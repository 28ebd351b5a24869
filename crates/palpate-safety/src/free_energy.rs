// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The passivity of forces that have a potential: guides, wells and magnets.
//!
//! They may pull a hand in, which gives out energy that the hand did not put in, so their energy
//! is not balanced as that of walls is. What sampling adds to it is.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::effect::Effect;
use crate::passivity::{InnerProduct, MEMORY, PassivityOptions, SLACK, SPARE, STEP};

/// The part of what damping covers that passes, so that oscillations decay.
const COVERED: f64 = 0.8;

/// The time in which the force comes back by a factor of e [s]: a force that comes back faster
/// gives out as much as it was kept from.
const RECOVERY: f64 = 20.0;

/// What sampling generates with forces that have a potential, and what was done about it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct FreeForceReport {
    /// Ticks in which the force was made less, and the largest change.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub effect: Effect,
    /// The least value of what damping dissipates minus what sampling generates [J]; if negative,
    /// its size is the energy that the forces gave out beyond their potential.
    pub least_balance: f64,
}

/// The passivity observer and controller of the forces of guides and magnets.
///
/// **Observer.** A force that is held over a tick gives out `F_k · Δx`. Meanwhile its potential
/// falls by `½ (F_k + F_{k+1}) · Δx`, exactly for springs (trapezoidal rule). The difference, `−½
/// ΔF · Δx`, is what sampling generates. The device's damping `b` dissipates at least `b |Δx|² / T`.
/// The balance of both starts at the reserve, which is its most.
///
/// **Controller.** When the balance is used up, [less](COVERED) of the force passes than damping
/// covers, which is the losses over the leaks of the last [`MEMORY`]. The part falls by [`STEP`] a
/// tick, and at once when [`SPARE`] more was given out. It comes back [slowly](RECOVERY) while the balance is positive, and at once where there is
/// no force.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreeEnergy<V> {
    /// Position and force of the last tick; `None` after one that was not finite.
    last: Option<(V, V)>,
    /// The part of the force that passes.
    part: f64,
    /// What damping dissipates minus what sampling generates, at most the reserve [J].
    balance: f64,
    /// What sampling would generate with the whole force, and what damping dissipates; both decay
    /// by [`MEMORY`] [J].
    leaks: f64,
    losses: f64,
    report: FreeForceReport,
}

/// A tick of a [`FreeEnergy`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passed<V> {
    /// The force that passes.
    pub(crate) force: V,
    /// The part of what damping dissipates that it needs: walls have what is left [J].
    pub(crate) spent: f64,
}

impl<V: InnerProduct> FreeEnergy<V> {
    pub(crate) fn new(reserve: f64) -> Self {
        Self {
            last: None,
            part: 1.0,
            balance: reserve,
            leaks: 0.0,
            losses: 0.0,
            report: FreeForceReport::default(),
        }
    }

    /// One tick of `elapsed` [s], with the options of the stage for walls. If an input is not
    /// finite, the force is returned unchanged and the motion so far is forgotten.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn step(
        &mut self,
        [force, position]: [V; 2],
        elapsed: f64,
        options: &PassivityOptions,
        is_sound: bool,
    ) -> Passed<V> {
        // A device of infinite damping is passive whatever it renders.
        if !is_sound || options.damping == f64::INFINITY {
            self.last = None;
            return Passed { force, spent: 0.0 };
        }
        let before = self.last.replace((position, force));
        if force == V::ZERO && before.is_none_or(|(_, force)| force == V::ZERO) {
            // What comes next is another motion; the balance is paid first.
            (self.part, self.leaks, self.losses) = (1.0, 0.0, 0.0);
            return Passed { force, spent: 0.0 };
        }
        let spent = before.map_or(0.0, |(place, held)| {
            let way = position - place;
            let loss = SLACK * options.damping * way.dot(way) / elapsed;
            self.observe(-0.5 * (force - held).dot(way), loss, options.reserve)
        });
        if options.is_on {
            self.control(force.norm(), elapsed);
        }
        let passes = (self.part < 1.0).then(|| force * self.part);
        Passed { force: self.report.effect.count(force, passes), spent }
    }

    /// Updates the balance, and returns what of `loss` the forces need [J].
    fn observe(&mut self, leak: f64, loss: f64, reserve: f64) -> f64 {
        self.leaks = MEMORY * self.leaks + leak;
        self.losses = MEMORY * self.losses + loss;
        let leak = self.part * leak;
        self.balance = (self.balance + loss - leak).min(reserve);
        if !(self.balance.is_finite() && self.leaks.is_finite() && self.losses.is_finite()) {
            // Numbers overflowed: assume that damping covers nothing.
            (self.balance, self.leaks, self.losses) = (0.0, 1.0, 0.0);
        }
        let beyond = self.balance - reserve;
        self.report.least_balance = self.report.least_balance.min(beyond);
        leak.min(loss).max(0.0)
    }

    /// Lets less of a force of size `force` [N] pass if the balance is used up, or more again.
    fn control(&mut self, force: f64, elapsed: f64) {
        let is_used_up = self.balance <= 0.0 && self.leaks > self.losses;
        if is_used_up && force > 0.0 {
            let covered = (COVERED * self.losses / self.leaks).clamp(0.0, self.part);
            let smooth = self.part - STEP / force;
            self.part = if self.balance > -SPARE { smooth.max(covered) } else { covered };
        } else if self.part < 1.0 && self.balance > 0.0 {
            self.part = (self.part * (1.0 + elapsed / RECOVERY)).min(1.0);
        }
    }

    pub(crate) fn report(&self) -> FreeForceReport {
        self.report
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_field::Vector;

    fn options(damping: f64) -> PassivityOptions {
        PassivityOptions {
            is_on: true,
            stiffness: 0.0,
            max_force: f64::INFINITY,
            damping,
            mass: 0.1,
            max_rate: f64::INFINITY,
            reserve: 1e-4,
            rise_rate: 20.0,
            period: 1e-3,
        }
    }

    /// A mass with damping in a spring that is held over ticks of 1 ms, for 20 s: the largest sum
    /// of kinetic and potential energy in the last second [J], and the report.
    fn swings(stiffness: f64, damping: f64) -> (f64, FreeForceReport) {
        let (mass, period) = (0.1, 1e-3);
        let options = options(damping);
        let mut free = FreeEnergy::new(options.reserve);
        let (mut x, mut v, mut most) = (1e-3, 0.0, 0.0_f64);
        for tick in 0..20_000 {
            let at = Vector([x, 0.0]);
            let Passed { force, .. } = free.step([at * -stiffness, at], period, &options, true);
            let force = force[0];
            // m v' = F − b v, exactly.
            let (rate, steady) = (damping / mass, force / damping);
            let decay = (-rate * period).exp();
            x += steady * period + (v - steady) * (1.0 - decay) / rate;
            v = steady + (v - steady) * decay;
            if tick >= 19_000 {
                most = most.max(0.5 * (mass * v * v + free.part * stiffness * x * x));
            }
        }
        (most, free.report())
    }

    /// `K = 2 b / T`, Colgate and Schenkel (1997).
    #[test]
    fn springs_up_to_twice_the_damping_over_the_period_pass() {
        for damping in [0.2, 1.0, 3.0] {
            let (energy, report) = swings(2.0 * damping / 1e-3, damping);
            assert_eq!((report.effect.ticks, report.least_balance), (0, 0.0), "{damping}");
            assert!(energy <= 0.5 * 2.0 * damping / 1e-3 * 1e-6, "{damping}: {energy} J");
        }
    }

    /// Without the stage such a spring grows without bound.
    #[test]
    fn a_stiffer_spring_gives_out_little_beyond_its_potential() {
        for (stiffness, damping) in [(2000.0, 0.2), (4000.0, 0.5), (1000.0, 0.02)] {
            let (energy, report) = swings(stiffness, damping);
            assert!(report.effect.ticks > 0 && report.least_balance > -1e-3, "{report:?}");
            // At first it has ½ K (1 mm)².
            let first = 0.5 * stiffness * 1e-6;
            assert!(energy < first + 1e-3, "{stiffness} N/m: {energy} J of {first} J");
        }
    }

    /// Once the losses were no number, and guides faded away.
    #[test]
    fn a_device_of_infinite_damping_is_passive() {
        let options = options(f64::INFINITY);
        let mut free = FreeEnergy::new(options.reserve);
        for x in [0.0, 0.0, 0.01, -0.02] {
            let force = Vector([-1e4 * x - 1.0, 0.0]);
            let passed = free.step([force, Vector([x, 0.0])], 1e-3, &options, true);
            assert_eq!((passed.force, passed.spent), (force, 0.0));
        }
        assert_eq!(free.report(), FreeForceReport::default());
    }

    #[test]
    fn a_pull_that_begins_is_no_leak_and_a_force_that_is_gone_comes_back_whole() {
        let options = options(0.0);
        let mut free = FreeEnergy::new(options.reserve);
        let mut at = |x: f64, force: f64| {
            let input = [Vector([force, 0.0]), Vector([x, 0.0])];
            free.step(input, 1e-3, &options, true).force[0]
        };
        // Pulled in by a steady 2 N: the potential falls by what is given out.
        assert!((0..100).all(|k| at(1e-4 * f64::from(k), 2.0) == 2.0));
        // A force that turns against every motion of a device without damping.
        let jolts: Vec<_> =
            (0..200).map(|k| at(1e-3 * f64::from(k % 2), f64::from(k % 2) * -2.0)).collect();
        let steps = jolts.iter().step_by(2).zip(jolts.iter().step_by(2).skip(1));
        assert!(steps.clone().all(|(a, b)| (a - b).abs() <= 2.0 * 0.3 + 1e-12), "{jolts:?}");
        assert!(jolts.last().is_some_and(|force| *force == 0.0), "{jolts:?}");
        assert_eq!((at(0.0, 0.0), at(0.0, 0.0), at(0.0, 2.0)), (0.0, 0.0, 2.0));
    }
}
