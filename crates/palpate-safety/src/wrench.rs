// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What stands between a wanted force and torque and a hand.
//!
//! Whether energy was taken before it is given is a question to force and torque together: a
//! lever that was turned into a wall may give by a force what it took by a torque. So one
//! observer sees `F·v + τ·ω`, and what it allows passes the other stages as force and as torque.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::ops::{Add, Mul, Sub};

use palpate_field::Vector;

use crate::channel::{Channel, Moment};
use crate::error::{SafetyError, not_negative};
use crate::limits::Limits;
use crate::passivity::{Directed, Passivity, PassivityOptions, Seen};
use crate::{Accepted, PassivityReport, SafetyOptions, SafetyReport, TurningReport};

/// What goes along axes, and what turns about them: a force [N] and a torque [N·m], a place [m]
/// and an angle [rad], or their velocities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Both<const D: usize> {
    /// Along axes.
    pub along: Vector<f64, D>,
    /// About axes; in the plane about z alone.
    pub about: Vector<f64, 3>,
}

impl<const D: usize> Both<D> {
    /// With `factor` times as much about axes.
    fn turning(self, factor: f64) -> Self {
        Self { about: self.about * factor, ..self }
    }
}

impl<const D: usize> Add for Both<D> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { along: self.along + other.along, about: self.about + other.about }
    }
}

impl<const D: usize> Sub for Both<D> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { along: self.along - other.along, about: self.about - other.about }
    }
}

impl<const D: usize> Mul<f64> for Both<D> {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { along: self.along * factor, about: self.about * factor }
    }
}

impl<const D: usize> Directed for Both<D> {
    const ZERO: Self = Self { along: Vector::ZERO, about: Vector::ZERO };

    fn dot(self, other: Self) -> f64 {
        self.along.dot(other.along) + self.about.dot(other.about)
    }

    fn norm(self) -> f64 {
        self.dot(self).sqrt()
    }

    fn is_finite(&self) -> bool {
        self.along.is_finite() && self.about.is_finite()
    }
}

/// A device that turns in a tick, as its chain sees it. Device coordinates.
#[derive(Clone, Copy, Debug)]
pub struct WrenchState<const D: usize> {
    /// Where it is [m], and the sum of all its turns so far [rad].
    pub position: Both<D>,
    /// How fast it moves [m/s] and turns [rad/s].
    pub velocity: Both<D>,
    /// As [`PortState::free_force`](crate::PortState::free_force).
    pub free_force: Vector<f64, D>,
    /// The tick began too late.
    pub is_late: bool,
}

/// The safety chain of a device that turns: [`SafetyChain`](crate::SafetyChain) for a force and a
/// torque.
///
/// With a radian as long as `u = √(κ/K)`, a stretch of the coupling in any direction, turning or
/// not, is as stiff as in any other, and holds `½ (|F|² + |τ/u|²) / K`. So the passivity stage
/// sees one spring in all directions, on the least damping `min(b, b_θ / u²)`, the least mass and
/// the slowest change of both: where `K ≤ 2b/T` and `κ ≤ 2b_θ/T`, nothing is ever changed.
#[derive(Clone, Debug)]
pub struct WrenchChain<const D: usize> {
    /// Along axes, and about them.
    accepted: (Accepted, Accepted),
    /// What the device is sure of, along axes and about them.
    sides: (Side, Side),
    /// A radian as a length [m].
    unit: f64,
    passivity: Passivity<Both<D>>,
    force: Channel<D>,
    torque: Channel<3>,
    /// Written so far [N·m].
    largest_torque: f64,
}

/// What a device is sure of, along its axes or about them, as a spring in any direction sees it.
#[derive(Clone, Copy, Debug)]
struct Side {
    /// The least damping.
    damping: f64,
    /// Zero if it is not known.
    mass: f64,
    /// The fastest change of a force.
    max_rate: f64,
}

impl Side {
    fn new(limits: &Limits) -> Result<Self, SafetyError> {
        Ok(Self {
            damping: limits.least_damping.positive()?,
            mass: limits.mass.not_negative()?,
            max_rate: limits.max_force_rate.positive()?,
        })
    }

    /// The worse of this along axes and that about them, with a radian as long as `unit` [m].
    fn with(&self, about: &Self, unit: f64) -> Self {
        let square = unit * unit;
        Self {
            damping: self.damping.min(about.damping / square),
            mass: self.mass.min(about.mass / square),
            max_rate: self.max_rate.min(about.max_rate / unit),
        }
    }
}

/// A radian as a length, so that the coupling is as stiff about axes as along them [m].
fn unit(along: &Accepted, about: &Accepted) -> f64 {
    (about.device_stiffness / along.device_stiffness).sqrt()
}

impl<const D: usize> WrenchChain<D> {
    /// A chain for a device of these limits, along axes and about them, that renders what was
    /// accepted, at `rate` [Hz].
    ///
    /// # Errors
    ///
    /// As [`SafetyChain::new`](crate::SafetyChain::new).
    pub fn new(
        limits: [&Limits; 2],
        accepted: [Accepted; 2],
        options: &SafetyOptions,
        rate: f64,
    ) -> Result<Self, SafetyError> {
        let [along, about] = limits;
        let accepted: (Accepted, Accepted) = accepted.into();
        let sides = (Side::new(along)?, Side::new(about)?);
        let unit = unit(&accepted.0, &accepted.1);
        let stiffness = accepted.0.device_stiffness;
        let Side { damping, mass, max_rate } = sides.0.with(&sides.1, unit);
        let passivity = PassivityOptions {
            is_on: options.has_passivity_control && damping < f64::INFINITY,
            stiffness,
            damping,
            mass,
            max_rate,
            reserve: not_negative("reserve", options.reserve, "J")?,
            period: 1.0 / rate,
        };
        Ok(Self {
            accepted,
            sides,
            unit,
            passivity: Passivity::new(passivity),
            force: Channel::new(along, options, rate)?,
            torque: Channel::new(about, options, rate)?,
            largest_torque: 0.0,
        })
    }

    /// Renders what was accepted anew, along axes and about them, for the same device.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn renew(&mut self, (along, about): (&Accepted, &Accepted)) {
        self.accepted.0.renew(along);
        self.accepted.1.renew(about);
        let unit = unit(along, about);
        let longer = unit / self.unit;
        self.passivity.in_units(|way| way.turning(longer), |force| force.turning(1.0 / longer));
        self.unit = unit;
        let stiffness = along.device_stiffness;
        let Side { damping, mass, max_rate } = self.sides.0.with(&self.sides.1, unit);
        let options = *self.passivity.options();
        let options = PassivityOptions { stiffness, damping, mass, max_rate, ..options };
        self.passivity.renew(options);
    }

    /// What to write where `wanted` is wanted, at the device, in one tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn step(&mut self, wanted: Both<D>, state: &WrenchState<D>) -> Both<D> {
        let WrenchState { position, velocity, free_force, is_late } = *state;
        // What is not a number reaches no stage that remembers; the guards answer for it.
        let is_sound =
            [wanted, position, velocity].iter().all(Both::is_finite) && free_force.is_finite();
        let unit = self.unit;
        let (position, velocity) = (position.turning(unit), velocity.turning(unit));
        let seen = Seen { position, velocity, has_start: false };
        let as_lengths = wanted.turning(1.0 / unit);
        let allowed = self.passivity.observed(as_lengths, &seen, is_sound);
        // What is not changed keeps its bits.
        let allowed = if allowed == as_lengths { wanted } else { allowed.turning(unit) };
        let moment = Moment { is_sound, is_late, start: 1.0 };
        let (along, force_left) = self.force.step((allowed.along, free_force), &moment);
        let (about, torque_left) = self.torque.step((allowed.about, Vector::ZERO), &moment);
        let left = Both { along: force_left, about: torque_left };
        self.passivity.written(left.turning(1.0 / unit));
        self.largest_torque = self.largest_torque.max(about.norm());
        Both { along, about }
    }

    /// Lowers the largest force [N].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn limit_force(&mut self, max_force: f64) {
        self.force.lower_limit(max_force);
    }

    /// Lowers the largest torque [N·m].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn limit_torque(&mut self, max_torque: f64) {
        self.torque.lower_limit(max_torque);
    }

    /// Stops force and torque.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn stop(&mut self) {
        self.force.stop();
        self.torque.stop();
    }

    /// Lets force and torque rise again.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn release(&mut self) {
        self.force.release();
        self.torque.release();
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn passivity(&self) -> PassivityReport {
        self.passivity.report()
    }

    /// What every stage did so far, along axes and about them.
    #[must_use]
    pub fn report(&self) -> SafetyReport {
        let (along, about) = &self.accepted;
        let turning = TurningReport::of(about, self.largest_torque, &self.torque);
        SafetyReport {
            turning: Some(turning),
            ..SafetyReport::of(along, self.passivity.report(), &self.force)
        }
    }
}
