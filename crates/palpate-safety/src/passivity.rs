// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Energy given to the hand is energy taken from it.
//!
//! B. Hannaford, J.-H. Ryu, "Time-domain passivity control of haptic interfaces" (2002): an
//! observer of energy, and a controller that acts when it runs out. J.-P. Kim, J. Ryu,
//! "Robustly stable haptic interaction control using an energy-bounding algorithm" (2010): what
//! a sampled spring gives out in excess may be as much as the device's own damping eats.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::ops::{Add, Mul, Sub};

use palpate_field::Vector;

use crate::effect::Effect;

/// What a tick's leak still weighs a tick later, in the verdict on whether damping covers it: a
/// memory of 100 ticks of contact, several strikes.
const MEMORY: f64 = 0.99;

/// A force is not made smaller than to this part of what damping covers. With one, walls of
/// `2 b / T` are left, which hardly come to rest; with zero, hands sink into walls that are seen
/// in steps, as a hand that rests between two of them seems to be worked on.
const FLOOR: f64 = 0.25;

/// A force, a way or a velocity, as energy knows them: vectors, or [along axes and about
/// them](super::Both).
pub(crate) trait Directed:
    Copy + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
    const ZERO: Self;

    /// Force on way, or the square of either.
    fn dot(self, other: Self) -> f64;

    fn norm(self) -> f64;

    /// `true` if no number is NaN or infinite.
    fn is_finite(&self) -> bool;
}

impl<const D: usize> Directed for Vector<f64, D> {
    const ZERO: Self = Vector::ZERO;

    fn dot(self, other: Self) -> f64 {
        Vector::dot(self, other)
    }

    fn norm(self) -> f64 {
        Vector::norm(self)
    }

    fn is_finite(&self) -> bool {
        Vector::is_finite(self)
    }
}

/// Where a device is in a tick, and how fast it moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen<V> {
    pub(crate) position: V,
    pub(crate) velocity: V,
    /// The force [starts](super::PortState::start) to rise: that of bodies that came to the hand,
    /// and brought what they hold.
    pub(crate) has_start: bool,
}

/// What the passivity observer saw and the controller did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PassivityReport {
    /// Interventions, and the largest change of the force.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub effect: Effect,
    /// Energy that the forces written took from the hand [J].
    pub energy_in: f64,
    /// Energy that they gave to it [J].
    pub energy_out: f64,
    /// The least balance of the two at any time [J]: what was given out in net is its negative.
    pub least_balance: f64,
    /// Energy that the wanted forces would have given out, but those written did not [J].
    pub dissipated: f64,
}

/// The passivity observer and controller of one contact point.
///
/// *Observer.* A force is held over a tick, so the energy it takes from the hand is exactly
/// `−F_k · (x_{k+1} − x_k)`, whatever the motion between. With the device's damping `b`, at
/// least `b |x_{k+1} − x_k|² / T` of it is lost in the device on the way (Cauchy and Schwarz).
///
/// *Credit.* A held spring gives out `K |Δx|² / 2` a tick more than it stored. Where the device
/// is sure to lose as much, up to `K = 2 b / T`, rendering is passive as it is, and each tick is
/// credited with the loss: the balance then is never below the spring's energy, and nothing is
/// ever changed. Whether it does is observed, not believed: the leaks `−½ ΔF·Δx` of the wanted
/// forces over the last [`MEMORY`] of contact are compared with the losses. Where they are
/// larger, there is no credit, and all that is given out must have been taken in before.
///
/// *Controller.* A force is made smaller, as a whole, until the energy that it gives out in the
/// coming tick is no more than the balance and a reserve. The motion is predicted from the
/// velocity and from what this force and the one before do to the device's mass. Where the
/// fastest change of force keeps it from being taken back at once, what it gives out until then
/// counts too. A part of the
/// force remains in any case, [`FLOOR`] of that whose leaks damping covers; a wall so soft comes
/// to rest by itself. The balance is
/// at most what a spring of the material's stiffness holds at this force, `½ |F|² / K`, so that
/// a long rub against friction does not pay for an oscillation; a source of constant force that
/// is to give back more than that must do without this stage.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passivity<V> {
    options: PassivityOptions,
    /// As [`PassivityOptions::yielding`] [m/N].
    yielding: f64,
    /// Taken in, credited and capped [J].
    balance: f64,
    /// Leaks of the wanted forces in contact, and what damping is sure to lose [J].
    leaks: f64,
    losses: f64,
    last: Option<Last<V>>,
    report: PassivityReport,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct PassivityOptions {
    pub(crate) is_on: bool,
    /// At the device [N/m].
    pub(crate) stiffness: f64,
    /// The device's least damping [N·s/m].
    pub(crate) damping: f64,
    /// The device's mass [kg]; 0 if it is not known.
    pub(crate) mass: f64,
    /// How fast the force can be taken back [N/s].
    pub(crate) max_rate: f64,
    /// What may be given out before anything was taken in [J].
    pub(crate) reserve: f64,
    /// Of a tick [s].
    pub(crate) period: f64,
}

impl PassivityOptions {
    /// How far a force moves the device's mass in a tick [m/N]; not at all where it is not known.
    fn yielding(&self) -> f64 {
        if self.mass > 0.0 { 0.5 * self.period * self.period / self.mass } else { 0.0 }
    }
}

#[derive(Clone, Copy, Debug)]
struct Last<V> {
    position: V,
    wanted: V,
    written: V,
}

impl<V: Directed> Passivity<V> {
    pub(crate) fn new(options: PassivityOptions) -> Self {
        Self {
            options,
            yielding: options.yielding(),
            balance: 0.0,
            leaks: 0.0,
            losses: 0.0,
            last: None,
            report: PassivityReport::default(),
        }
    }

    pub(crate) fn options(&self) -> &PassivityOptions {
        &self.options
    }

    /// Watches over another rendering from now on; what was taken in before counts.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn renew(&mut self, options: PassivityOptions) {
        self.options = options;
        self.yielding = options.yielding();
    }

    /// The same in other units of ways and of forces.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn in_units(&mut self, way: impl Fn(V) -> V, force: impl Fn(V) -> V) {
        if let Some(Last { position, wanted, written }) = &mut self.last {
            *position = way(*position);
            (*wanted, *written) = (force(*wanted), force(*written));
        }
    }

    /// The force that may be written in place of `wanted`; of what is not sound, as it is.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn observed(&mut self, wanted: V, state: &Seen<V>, is_sound: bool) -> V {
        if is_sound {
            return self.limit(wanted, state);
        }
        self.lose();
        wanted
    }

    /// The force that may be written in place of `wanted`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn limit(&mut self, wanted: V, state: &Seen<V>) -> V {
        let way = self.last.map_or(V::ZERO, |last| state.position - last.position);
        if let Some(last) = self.last {
            self.observe(&last, wanted, way);
        }
        if state.has_start {
            self.balance = self.balance.max(self.stored(wanted));
        }
        let held = self.last.map_or(V::ZERO, |last| last.written);
        let may_give = self.options.is_on && wanted != V::ZERO;
        let part = if may_give { self.part(wanted, held, way, state) } else { 1.0 };
        let changed = (part < 1.0).then(|| wanted * part);
        let allowed = self.report.effect.count(wanted, changed);
        self.last = Some(Last { position: state.position, wanted, written: allowed });
        allowed
    }

    /// Takes the force that was written in the end.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn written(&mut self, force: V) {
        if let Some(last) = &mut self.last {
            last.written = force;
        }
    }

    /// The position is not known: what happens until it is again cannot be observed.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn lose(&mut self) {
        self.last = None;
    }

    pub(crate) fn report(&self) -> PassivityReport {
        self.report
    }

    /// Books the tick that ends now, over which the device moved by `way`.
    fn observe(&mut self, last: &Last<V>, wanted: V, way: V) {
        let PassivityOptions { damping, reserve, period, .. } = self.options;
        if [last.written, last.wanted, wanted] == [V::ZERO; 3] {
            // No force does work, and none holds energy.
            self.balance = self.balance.min(0.0);
            return;
        }
        let given = last.written.dot(way);
        let report = &mut self.report;
        report.energy_in += (-given).max(0.0);
        report.energy_out += given.max(0.0);
        let net = report.energy_in - report.energy_out;
        report.least_balance = report.least_balance.min(net);
        report.dissipated += (last.wanted.dot(way).max(0.0) - given.max(0.0)).max(0.0);
        self.balance -= given;
        if last.wanted != V::ZERO || wanted != V::ZERO {
            let loss = damping * way.dot(way) / period;
            self.leaks = MEMORY * self.leaks - 0.5 * (wanted - last.wanted).dot(way);
            self.losses = MEMORY * self.losses + loss;
            if self.is_covered() {
                self.balance += loss;
            }
        }
        let largest = if wanted.dot(wanted) > last.wanted.dot(last.wanted) {
            wanted
        } else {
            last.wanted
        };
        self.balance = self.balance.min(self.stored(largest));
        if !(self.balance.is_finite() && self.leaks.is_finite() && self.losses.is_finite()) {
            // Numbers overflowed: nothing is known to have been taken in.
            (self.balance, self.leaks, self.losses) = (-reserve, 1.0, 0.0);
        }
    }

    /// What a spring of the material's stiffness holds at `force` [J].
    fn stored(&self, force: V) -> f64 {
        0.5 * force.dot(force) / self.options.stiffness
    }

    /// `true` if the device's own damping eats what the rendering leaks.
    fn is_covered(&self) -> bool {
        self.leaks <= self.losses
    }

    /// The part of `wanted` that gives out no more than there is.
    fn part(&self, wanted: V, held: V, way: V, state: &Seen<V>) -> f64 {
        let PassivityOptions { damping, max_rate, reserve, period, .. } = self.options;
        let available = (self.balance + reserve).max(0.0);
        let yielding = self.yielding;
        // The mean velocity of the last tick is half a tick old, and what was held has changed
        // it since. The estimate may be older, or better: the one that gives more out counts.
        let by_way = way + held * yielding;
        let by_velocity = state.velocity * period + held * yielding;
        let coasting =
            if wanted.dot(by_way) >= wanted.dot(by_velocity) { by_way } else { by_velocity };
        let moved = coasting + wanted * yielding;
        let loss = if self.is_covered() { damping * moved.dot(moved) / period } else { 0.0 };
        // Where the force cannot be taken back at once, what it gives out until it is: the power
        // of now, falling to nothing. Only where it may have to be.
        let trailing = if self.is_covered() {
            0.0
        } else {
            let power = wanted.dot(coasting).max(0.0) / period;
            0.5 * wanted.norm() / max_rate * power
        };
        if wanted.dot(moved) + trailing - loss <= available {
            return 1.0;
        }
        let part = part_within(
            available,
            wanted.dot(coasting),
            wanted.dot(wanted) * yielding + trailing,
        );
        // Where damping covers the leaks, the balance knows that already.
        let floor = if self.is_covered() { 0.0 } else { FLOOR * self.losses / self.leaks };
        part.max(floor)
    }
}

/// The largest `s` in [0, 1] with `s linear + s² square ≤ available`, where nothing but
/// `linear` may be negative; zero if it is not a number.
fn part_within(available: f64, linear: f64, square: f64) -> f64 {
    let root = (linear * linear + 4.0 * square * available).sqrt();
    let part = if linear > 0.0 {
        2.0 * available / (linear + root)
    } else {
        (root - linear) / (2.0 * square)
    };
    if part.is_nan() { 0.0 } else { part.clamp(0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_is_the_root_of_its_equation() {
        assert_eq!(part_within(1.0, 2.0, 0.0), 0.5);
        assert_eq!(part_within(3.0, -2.0, 16.0), 0.5);
        assert_eq!(part_within(0.0, 1.0, 1.0), 0.0);
        assert_eq!(part_within(0.0, 0.0, 0.0), 0.0);
        assert_eq!(part_within(0.0, f64::INFINITY, 1.0), 0.0);
        for (available, linear, square) in [(0.3, 0.4, 0.5), (0.3, -0.4, 0.9)] {
            let s = part_within(available, linear, square);
            assert!((s * linear + s * s * square - available).abs() < 1e-15);
        }
    }

    #[test]
    fn the_observer_is_exact_for_a_held_force() {
        let mut passivity = Passivity::new(PassivityOptions {
            is_on: false,
            stiffness: 100.0,
            damping: 1.0,
            mass: 0.1,
            max_rate: f64::INFINITY,
            reserve: 1e-4,
            period: 1e-3,
        });
        let held = [(0.0, 2.0), (0.5, 4.0), (-0.25, 0.0), (1.0, 0.0)];
        for (position, force) in held {
            let position = Vector([position, 0.0]);
            let state = Seen { position, velocity: Vector::ZERO, has_start: false };
            let _ = passivity.limit(Vector([force, 0.0]), &state);
            passivity.written(Vector([force, 0.0]));
        }
        // 2 N over 0.5 m given, 4 N over 0.75 m taken.
        let report = passivity.report();
        assert_eq!((report.energy_out, report.energy_in), (1.0, 3.0));
        assert_eq!((report.least_balance, report.dissipated), (-1.0, 0.0));
    }
}
