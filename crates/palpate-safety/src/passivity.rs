// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The passivity observer and controller: a rendering gives the hand no more energy than it
//! took and the device's damping dissipates, as the encoders show it.
//!
//! B. Hannaford, J.-H. Ryu, "Time-domain passivity control of haptic interfaces" (2002): an
//! observer of energy, and a controller that acts when the energy balance is used up. J.-P.
//! Kim, J. Ryu, "Robustly stable haptic interaction control using an energy-bounding algorithm"
//! (2010): a sampled spring may leak as much energy as the device's own damping dissipates.

use std::ops::{Add, Mul, Sub};

use palpate_field::Vector;

use crate::approach::Lift;
use crate::effect::Effect;

/// The factor by which past leaks and losses decay in each tick of contact, when they are
/// compared: a memory of 100 ticks, which spans several impacts.
pub(crate) const MEMORY: f64 = 0.99;

/// What damping dissipates counts a hundredth more: a wall of exactly `2 b / T`, which many
/// profiles allow, leaks as much but for the rounding of its forces and places.
pub(crate) const SLACK: f64 = 1.01;

/// The controller leaves at least this part of the force whose leaks damping covers. With zero,
/// hands would sink into walls, because position quantisation looks like work done on a resting
/// hand.
const FLOOR: f64 = 0.25;

/// The most by which the controller changes what it takes from a force in a tick [N], unless the
/// force would give out more than [`SPARE`] meanwhile. A hand does not feel it as a kick.
pub(crate) const STEP: f64 = 0.3;

/// Energy that may be given out beyond the balance and the reserve while the controller takes the
/// force away smoothly [J].
pub(crate) const SPARE: f64 = 2.5e-4;

/// A force, displacement or velocity with the inner product that gives energy: a vector, or a
/// [spatial vector](super::SpatialVector) of translation and rotation.
pub trait InnerProduct:
    Copy + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
    const ZERO: Self;

    /// The inner product: work of a force along a displacement, or a squared length.
    fn dot(self, other: Self) -> f64;

    fn norm(self) -> f64;

    /// `true` if no number is NaN or infinite.
    fn is_finite(&self) -> bool;
}

impl InnerProduct for Vector<f64, 3> {
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

/// The parts of a force that may pass.
#[derive(Clone, Copy, Debug)]
struct Parts {
    /// The part that is approached smoothly.
    soft: f64,
    /// The largest part, which spends what is spare.
    hard: f64,
}

/// What happened in the last tick.
#[derive(Clone, Copy, Debug)]
struct Moved<V> {
    /// The force that was held [N].
    held: V,
    /// How far the device moved [m].
    way: V,
}

/// Position and velocity of a device in a tick, relative to the bodies that it touches.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PortMotion<V> {
    pub(crate) position: V,
    pub(crate) velocity: V,
    /// The size of the wanted force before any limit [N].
    pub(crate) effort: f64,
    /// Whether the force rises after it was zeroed: it then moves the hand by energy that the hand
    /// did not put in.
    pub(crate) is_rising: bool,
    /// The time since the tick before [s].
    pub(crate) elapsed: f64,
    /// What bodies that move by physics owe for this tick [J]: their work on the hand, less their
    /// credit.
    pub(crate) owed: f64,
    /// The part of the stiffness that is rendered; less than 1 after a
    /// [limit cycle](crate::limit_cycle::LimitCycle).
    pub(crate) softness: f64,
    /// What of the energy that damping dissipates guides and magnets need [J].
    pub(crate) spent: f64,
    /// The stiffness of the bodies that are touched, at the device [N/m].
    pub(crate) stiffness: f64,
}

impl<V> PortMotion<V> {
    /// The part of a force of size `wanted` [N] that a softer wall gives: less was cut from it by
    /// the force limit.
    fn softened(&self, wanted: f64) -> f64 {
        // Written so that a force of zero passes.
        let is_less = self.softness * self.effort < wanted;
        if is_less { self.softness * self.effort / wanted } else { 1.0 }
    }
}

/// Energies that the passivity observer measured, and the controller's interventions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct PassivityReport {
    /// Interventions, and the largest change of the force.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub effect: Effect,
    /// Energy that the written forces took from the hand, as it moves relative to the touched bodies
    /// [J].
    pub energy_in: f64,
    /// Energy that the written forces gave to the hand, as it moves relative to the touched bodies
    /// [J]. The work of bodies that move is [counted apart](crate::DriveReport::driven).
    pub energy_out: f64,
    /// The least value of `energy_in − energy_out` in the run [J]. A negative value is net
    /// energy given to the hand; the damping of the device may dissipate that much, as the
    /// encoders measure it.
    pub least_balance: f64,
    /// Energy that the wanted forces would have given out, but the written forces did not [J].
    pub dissipated: f64,
    /// The largest change between two ticks of the force that the passivity controller removes
    /// [N].
    pub largest_step: f64,
    /// Energy that the forces may give the hand beyond what they took [J]: while a force rises after it
    /// was zeroed or edited, while a hand at rest is lifted, while a wall gets its stiffness back, and what
    /// the controller's least part of a force gave out.
    pub credited: f64,
    /// Energy that the device's least damping dissipates in contact, as the hand moves relative to the
    /// touched bodies [J]. Zero where no controller acts.
    pub damped: f64,
    /// How often the controller began to take a force away. It does so smoothly, and each time may let
    /// out 0.25 mJ meanwhile.
    pub cuts: u64,
    /// The largest energy that a force gave to the hand in a tick [J].
    pub largest_tick: f64,
}

impl PassivityReport {
    /// The most energy [J] that the forces may have given beyond what they took: what damping
    /// dissipates, a `reserve`, 0.25 mJ for each smooth cut, one tick, and what was credited.
    ///
    /// `energy_out − energy_in` is never more, where bodies that move by physics have no more credit than
    /// their work takes, and where the controller acts.
    #[must_use]
    pub fn most_given(&self, reserve: f64) -> f64 {
        let cuts = SPARE * self.cuts as f64;
        SLACK * self.damped + reserve + cuts + self.largest_tick + self.credited
    }
}

/// The passivity observer and controller of one contact point.
///
/// **Observer.** A force is held over a tick, so the energy that it takes from the hand is
/// exactly `−F_k · (x_{k+1} − x_k)`, whatever the motion between. The device's damping `b`
/// dissipates at least `b |x_{k+1} − x_k|² / T` of it (Cauchy and Schwarz). The positions are those
/// that the encoders show: coarse steps overestimate the dissipation.
///
/// **Credit.** A sampled spring gives out `K |Δx|² / 2` a tick more than it stored. Up to `K = 2
/// b / T` the device is sure to dissipate as much, so the rendering is passive. Each tick then
/// credits the loss to the balance, which never falls below the spring's energy, and the force
/// is never changed. The controller measures whether this holds: it compares the leaks `−½
/// ΔF·Δx` of the wanted forces over the last [`MEMORY`] of contact with the losses. If the
/// leaks are larger, there is no credit, and all energy given out must have been taken in
/// before.
///
/// **Controller.** The whole force is scaled down until the energy that it gives out in the
/// coming tick is no more than the balance plus a reserve. What the controller takes changes by
/// [`STEP`] a tick at most, so that walls do not kick when it acts or lets go, unless [`SPARE`]
/// more would be given out; then it acts at once. The motion is predicted from the velocity, and
/// from the acceleration of the device's mass by this force and the one before. If the slew limit
/// would prevent a fast removal of the force, the energy given out during the removal counts too.
/// The controller always leaves [`FLOOR`] of the force whose leaks damping covers. The balance is
/// capped at the energy `U` that a spring of the touched bodies' stiffness has stored at this depth
/// under the force limit `M`, so that a long rub against friction does not pay for an oscillation:
/// with the force `F` before the limit, `U = F² / 2K` up to `M` and `(F − M/2) M / K` beyond. A
/// source of constant force that must give back more than that cannot use this stage.
///
/// **Lift.** While a force that the controller took comes back to a hand at rest ([`Lift`]), the
/// balance is at least `U`, and the force grows by the rate of a [rise](crate::approach::Rise).
///
/// **Softer walls.** Forces, leaks and `U` are those of the wall that is rendered, which may have
/// become softer after a limit cycle.
///
/// **Rise.** While a force rises after it was zeroed, the balance is at least `U`: in the time
/// without force the hand sank in for nothing, and the wall lifts it out again. The energy of rises
/// and lifts is [counted](PassivityReport::credited).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passivity<V> {
    options: PassivityOptions,
    /// As [`PassivityOptions::compliance`] [m/N].
    compliance: f64,
    /// The energy balance: taken in, plus credit, capped [J].
    balance: f64,
    /// Leaks of the wanted forces in contact, and losses that damping guarantees; both decay by
    /// [`MEMORY`] [J].
    leaks: f64,
    losses: f64,
    last: Option<Last<V>>,
    /// What the controller took from the last force [N].
    taken: f64,
    lift: Lift<V>,
    /// The largest energy so far that the controller's [`FLOOR`] gave out beyond the balance [J].
    floored: f64,
    report: PassivityReport,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct PassivityOptions {
    pub(crate) is_on: bool,
    /// The largest stiffness of a body, at the device [N/m].
    pub(crate) stiffness: f64,
    /// The largest force [N].
    pub(crate) max_force: f64,
    /// The device's least damping [N·s/m].
    pub(crate) damping: f64,
    /// The device's mass [kg]; 0 if it is not known.
    pub(crate) mass: f64,
    /// The slew limit: how fast the force can be removed [N/s].
    pub(crate) max_rate: f64,
    /// Energy that may be given out before any was taken in [J].
    pub(crate) reserve: f64,
    /// How fast a force that the controller took comes back to a hand at rest [N/s].
    pub(crate) rise_rate: f64,
    /// The duration of a tick [s].
    pub(crate) period: f64,
}

impl PassivityOptions {
    /// The stiffness of the bodies that are touched, of which `told` is known [N/m]: at most the
    /// largest.
    pub(crate) fn stiffness_of(&self, told: f64) -> f64 {
        // `min` ignores NaN.
        self.stiffness.min(told).max(0.0)
    }

    /// The displacement of the device's mass in a tick per force [m/N]; zero if the mass is not
    /// known.
    fn compliance(&self) -> f64 {
        if self.mass > 0.0 { 0.5 * self.period * self.period / self.mass } else { 0.0 }
    }
}

#[derive(Clone, Copy, Debug)]
struct Last<V> {
    position: V,
    effort: f64,
    wanted: V,
    written: V,
}

impl<V: InnerProduct> Passivity<V> {
    pub(crate) fn new(options: PassivityOptions) -> Self {
        Self {
            options,
            compliance: options.compliance(),
            balance: 0.0,
            leaks: 0.0,
            losses: 0.0,
            last: None,
            taken: 0.0,
            lift: Lift::new(),
            floored: 0.0,
            report: PassivityReport::default(),
        }
    }

    pub(crate) fn options(&self) -> &PassivityOptions {
        &self.options
    }

    /// Replaces the options; the energy balance stays.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn renew(&mut self, options: PassivityOptions) {
        self.options = options;
        self.compliance = options.compliance();
    }

    /// Converts the state to other units of displacement and force.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn in_units(&mut self, way: impl Fn(V) -> V, force: impl Fn(V) -> V) {
        if let Some(Last { position, wanted, written, .. }) = &mut self.last {
            *position = way(*position);
            (*wanted, *written) = (force(*wanted), force(*written));
        }
        self.lift = Lift::new();
    }

    /// The force that may be written in place of `wanted`. If an input is not finite, `wanted`
    /// is returned unchanged.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn observed(&mut self, wanted: V, state: &PortMotion<V>, is_sound: bool) -> V {
        if is_sound {
            return self.limit(wanted, state);
        }
        self.lose();
        wanted
    }

    /// The force that may be written in place of `wanted`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn limit(&mut self, wanted: V, state: &PortMotion<V>) -> V {
        let way = self.last.map_or(V::ZERO, |last| state.position - last.position);
        if let Some(last) = self.last {
            self.observe(&last, wanted, way, state);
        }
        let is_taken = (wanted != V::ZERO).then_some(self.taken > 0.0);
        let is_lifted = self.lift.step(state.position, state.elapsed, is_taken);
        if state.is_rising || is_lifted {
            self.credit(if wanted == V::ZERO { 0.0 } else { self.stored(state.effort, state) });
        }
        let held = self.last.map_or(V::ZERO, |last| last.written);
        let softened = state.softened(wanted.norm());
        let force = if softened < 1.0 { wanted * softened } else { wanted };
        let may_act = self.options.is_on && force != V::ZERO;
        let moved = Moved { held, way };
        let part = |spare| self.part(force, moved, state, spare);
        let soft = if may_act { part(0.0) } else { 1.0 };
        let hard = if soft < 1.0 { part(SPARE) } else { 1.0 };
        let back = if is_lifted { self.options.rise_rate * state.elapsed } else { STEP };
        let part = self.smoothed(Parts { soft, hard }, force.norm(), back);
        let changed = (part < 1.0).then(|| force * part);
        let allowed = self.report.effect.count(force, changed);
        let PortMotion { position, effort, .. } = *state;
        self.last = Some(Last { position, effort, wanted, written: allowed });
        allowed
    }

    /// The part of a force of size `force` [N] that passes: the soft one, approached by [`STEP`] a
    /// tick, or by `back` [N] if more is to pass than before; and at most the hard one.
    fn smoothed(&mut self, Parts { soft, hard }: Parts, force: f64, back: f64) -> f64 {
        if soft >= 1.0 && self.taken == 0.0 || force == 0.0 {
            self.taken = 0.0;
            return 1.0;
        }
        let before = self.taken;
        let taken = (force * (1.0 - soft)).clamp(before - back, before + STEP);
        self.taken = taken.max(force * (1.0 - hard)).min(force);
        if self.taken > before {
            self.lift.end();
            self.report.cuts += u64::from(before == 0.0);
        }
        self.report.largest_step = self.report.largest_step.max((self.taken - before).abs());
        // Written so that NaN takes all.
        if self.taken <= force { 1.0 - self.taken / force } else { 0.0 }
    }

    /// Records the force that was written.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn written(&mut self, force: V) {
        if let Some(last) = &mut self.last {
            last.written = force;
        }
    }

    /// Forgets the last position, because the present one is not finite: energy cannot be
    /// observed until the next one.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn lose(&mut self) {
        self.last = None;
    }

    pub(crate) fn report(&self) -> PassivityReport {
        let credited = self.report.credited + self.floored;
        PassivityReport { credited, ..self.report }
    }

    /// Updates the balance for the tick that ends now, in which the device moved by `way`.
    fn observe(&mut self, last: &Last<V>, wanted: V, way: V, state: &PortMotion<V>) {
        let PassivityOptions { damping, reserve, .. } = self.options;
        if [last.written, last.wanted, wanted] == [V::ZERO; 3] {
            // A zero force does no work and stores no energy.
            self.balance = self.balance.min(0.0);
            return;
        }
        let given = last.written.dot(way);
        let report = &mut self.report;
        report.energy_in += (-given).max(0.0);
        report.energy_out += given.max(0.0);
        report.largest_tick = report.largest_tick.max(given);
        let damped = damping * way.dot(way) / state.elapsed;
        if self.options.is_on && damped.is_finite() {
            report.damped += damped;
        }
        let net = report.energy_in - report.energy_out;
        report.least_balance = report.least_balance.min(net);
        report.dissipated += (last.wanted.dot(way).max(0.0) - given.max(0.0)).max(0.0);
        self.balance -= given + state.owed;
        if last.wanted != V::ZERO || wanted != V::ZERO {
            let loss = SLACK * damping * way.dot(way) / state.elapsed - state.spent;
            let leak = -0.5 * (wanted - last.wanted).dot(way);
            self.leaks = MEMORY * self.leaks + state.softness * leak;
            self.losses = MEMORY * self.losses + loss;
            if self.is_covered() {
                self.balance += loss;
            }
        }
        self.balance = self.balance.min(self.stored(state.effort.max(last.effort), state));
        if !(self.balance.is_finite() && self.leaks.is_finite() && self.losses.is_finite()) {
            // Numbers overflowed: assume that no energy was taken in.
            (self.balance, self.leaks, self.losses) = (-reserve, 1.0, 0.0);
        }
        let allowed = reserve + SPARE + given.max(0.0);
        self.floored = self.floored.max(-self.balance - allowed);
    }

    /// Raises the balance to `energy` [J], and forgets the leaks before: a force that was held in a
    /// gap leaks whatever the material is.
    fn credit(&mut self, energy: f64) {
        (self.leaks, self.losses) = (0.0, 0.0);
        let missing = energy - self.balance;
        if missing > 0.0 {
            self.report.credited += missing;
            self.balance = energy;
        }
    }

    /// The energy that the wall stores where a spring of the stiffness of the touched bodies gives a
    /// force, if it presses with no more than the largest [J].
    fn stored(&self, force: f64, state: &PortMotion<V>) -> f64 {
        let (stiffness, max_force) = (state.stiffness, self.options.max_force);
        if stiffness == 0.0 {
            return 0.0;
        }
        let pressed = (force * state.softness).min(max_force);
        (force - 0.5 * pressed / state.softness) * pressed / stiffness
    }

    /// `true` if the device's own damping dissipates what the rendering leaks.
    fn is_covered(&self) -> bool {
        self.leaks <= self.losses
    }

    /// The part of `wanted` that gives out no more than the balance, the reserve and `spare` [J].
    fn part(&self, wanted: V, moved: Moved<V>, state: &PortMotion<V>, spare: f64) -> f64 {
        let Moved { held, way } = moved;
        let PassivityOptions { damping, max_rate, reserve, period, .. } = self.options;
        let available = (self.balance + reserve + spare).max(0.0);
        let compliance = self.compliance;
        // The mean velocity of the last tick is half a tick old, and the held force has changed
        // it since. The given estimate may be older or better. Use the one that gives out more.
        let by_way = way + held * compliance;
        let by_velocity = state.velocity * period + held * compliance;
        let coasting =
            if wanted.dot(by_way) >= wanted.dot(by_velocity) { by_way } else { by_velocity };
        let moved = coasting + wanted * compliance;
        let loss = if self.is_covered() { damping * moved.dot(moved) / period } else { 0.0 };
        // If the slew limit prevents removing the force at once, the energy given out during
        // the removal: the present power, falling to zero. Needed only if damping does not
        // cover the leaks.
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
            wanted.dot(wanted) * compliance + trailing,
        );
        let floor = FLOOR * if self.is_covered() { 1.0 } else { self.losses / self.leaks };
        part.max(floor)
    }
}

/// The largest `s` in [0, 1] with `s linear + s² square ≤ available`, where only `linear` may
/// be negative; zero if it is NaN.
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
            max_force: f64::INFINITY,
            reserve: 1e-4,
            rise_rate: 20.0,
            period: 1e-3,
        });
        let held = [(0.0, 2.0), (0.5, 4.0), (-0.25, 0.0), (1.0, 0.0)];
        for (position, force) in held {
            let position = Vector([position, 0.0, 0.0]);
            let state = PortMotion {
                position,
                velocity: Vector::ZERO,
                effort: force,
                is_rising: false,
                elapsed: 1e-3,
                owed: 0.0,
                softness: 1.0,
                spent: 0.0,
                stiffness: 100.0,
            };
            let _ = passivity.limit(Vector([force, 0.0, 0.0]), &state);
            passivity.written(Vector([force, 0.0, 0.0]));
        }
        // 2 N over 0.5 m given, 4 N over 0.75 m taken.
        let report = passivity.report();
        assert_eq!((report.energy_out, report.energy_in), (1.0, 3.0));
        assert_eq!((report.least_balance, report.dissipated), (-1.0, 0.0));
    }
}
