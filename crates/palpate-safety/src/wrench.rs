// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The safety chain of a force and a torque together.
//!
//! Passivity concerns force and torque together: a lever that a torque turned into a wall may
//! return the energy by a force. So one observer measures `F·v + τ·ω`; the force and the torque
//! that it allows then pass the other stages separately.

use std::ops::{Add, Mul, Sub};

use palpate_field::Vector;

use crate::chain::BeforeLimits;
use crate::channel::{Channel, Given, Risen, TickInput};
use crate::drive::{Drive, DriveReport, MovingBodies};
use crate::error::SafetyError;
use crate::free_energy::{FreeEnergy, FreeEnergyOptions, FreeInput, Passed};
use crate::limit::{Cut, Wanted, cut};
use crate::limit_cycle::{CycleInput, ForcesOf, LimitCycle, LimitCycleOptions};
use crate::limits::DeviceLimits;
use crate::passivity::{InnerProduct, Passivity, PassivityOptions, PortMotion};
use crate::{
    Accepted, Change, PassivityReport, SafetyReport, SafetySettings, StageEffects,
    TurningReport, finite,
};
use palpate_device::NumberError;

/// A translational and a rotational vector: force [N] and torque [N·m], position [m] and angle
/// [rad], or their velocities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialVector {
    /// The translational part.
    pub along: Vector<f64, 3>,
    /// The rotational part; in the plane only z is used.
    pub about: Vector<f64, 3>,
}

impl SpatialVector {
    /// The vector with its rotational part multiplied by `factor`.
    fn turning(self, factor: f64) -> Self {
        Self { about: self.about * factor, ..self }
    }
}

impl MovingBodies<SpatialVector> {
    /// The motion with its rotational part multiplied by `factor`.
    fn turning(self, factor: f64) -> Self {
        let (driven, dynamic) = (self.driven.turning(factor), self.dynamic.turning(factor));
        Self { driven, dynamic, ..self }
    }
}

impl Add for SpatialVector {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { along: self.along + other.along, about: self.about + other.about }
    }
}

impl Sub for SpatialVector {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { along: self.along - other.along, about: self.about - other.about }
    }
}

impl Mul<f64> for SpatialVector {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { along: self.along * factor, about: self.about * factor }
    }
}

impl InnerProduct for SpatialVector {
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

/// The input of the chain in a tick, beside force and torque. Device coordinates.
#[derive(Clone, Copy, Debug)]
pub struct WrenchState {
    /// The position [m] and the sum of all rotation vectors so far [rad].
    pub position: SpatialVector,
    /// The velocity [m/s] and the angular velocity [rad/s].
    pub velocity: SpatialVector,
    /// As [`PortState::free_force`](crate::PortState::free_force).
    pub free_force: Vector<f64, 3>,
    /// As [`PortState::late`](crate::PortState::late).
    pub late: f64,
    /// As [`PortState::elapsed`](crate::PortState::elapsed).
    pub elapsed: Option<f64>,
    /// As [`PortState::start`](crate::PortState::start).
    pub start: f64,
    /// As [`PortState::change`](crate::PortState::change), for force and torque.
    pub change: Change,
    /// By how much the motion of the hand relative to the bodies that push it changes the force in this
    /// tick, at most [N]. After a handover the force follows that much beyond its step.
    pub explained: f64,
    /// As [`PortState::stiffness`](crate::PortState::stiffness), with an angle as a length.
    pub stiffness: f64,
    /// As [`PortState::bodies`](crate::PortState::bodies), with the bodies' rotation [rad].
    pub bodies: MovingBodies<SpatialVector>,
}

/// The safety chain of a device with rotation: [`SafetyChain`](crate::SafetyChain) for a force
/// and a torque.
///
/// If a radian counts as the length `u = √(κ/K)`, the coupling is equally stiff in translation
/// and rotation, and stores `½ (|F|² + |τ/u|²) / K`. The passivity stage then sees one
/// isotropic spring with the smaller damping `min(b, b_θ / u²)`, the smaller mass and the
/// slower slew limit: where `K ≤ 2b/T` and `κ ≤ 2b_θ/T`, the controller never changes the force.
#[derive(Clone, Debug)]
pub struct WrenchChain {
    /// What the device renders.
    accepted: PerMotion<Accepted>,
    /// Properties of the device.
    sides: PerMotion<AxisLimits>,
    /// A radian as a length [m].
    unit: f64,
    cycle: LimitCycle<SpatialVector>,
    free: FreeEnergy<Vector<f64, 3>>,
    passivity: Passivity<SpatialVector>,
    drive: Drive<SpatialVector>,
    force: Channel,
    torque: Channel,
    /// The largest torque written so far [N·m].
    largest_torque: f64,
}

/// One value for translation and one for rotation.
#[derive(Clone, Copy, Debug)]
pub struct PerMotion<T> {
    /// The value for translation, along the axes.
    pub along: T,
    /// The value for rotation, about the axes.
    pub about: T,
}

/// Guaranteed properties of a device, in translation or rotation.
#[derive(Clone, Copy, Debug)]
struct AxisLimits {
    /// The least damping.
    damping: f64,
    /// The mass; zero if it is not known.
    mass: f64,
    /// The slew limit.
    max_rate: f64,
    encoder_step: f64,
}

impl AxisLimits {
    fn new(limits: &DeviceLimits) -> Result<Self, SafetyError> {
        Ok(Self {
            damping: limits.least_damping.zero_or_more()?,
            mass: limits.mass.not_negative()?,
            max_rate: limits.max_force_rate.positive()?,
            encoder_step: limits.encoder_step.not_negative()?,
        })
    }

    /// The worse of this (translational) and `about` (rotational), where a radian counts as the
    /// length `unit` [m].
    fn with(&self, about: &Self, unit: f64) -> Self {
        let square = unit * unit;
        Self {
            damping: self.damping.min(about.damping / square),
            mass: self.mass.min(about.mass / square),
            max_rate: self.max_rate.min(about.max_rate / unit),
            encoder_step: self.encoder_step.max(about.encoder_step * unit),
        }
    }
}

/// The length of a radian that makes the coupling equally stiff in translation and rotation
/// [m].
fn unit(along: &Accepted, about: &Accepted) -> f64 {
    (about.device_stiffness / along.device_stiffness).sqrt()
}

impl WrenchChain {
    /// A chain for a device with these translational and rotational limits, which renders the
    /// accepted impedances at `rate` [Hz].
    ///
    /// # Errors
    ///
    /// As [`SafetyChain::new`](crate::SafetyChain::new).
    pub fn new(
        limits: PerMotion<&DeviceLimits>,
        accepted: PerMotion<Accepted>,
        settings: &SafetySettings,
        rate: f64,
    ) -> Result<Self, SafetyError> {
        let rate = NumberError::check_rate(rate)?;
        let PerMotion { along, about } = limits;
        let sides =
            PerMotion { along: AxisLimits::new(along)?, about: AxisLimits::new(about)? };
        let unit = unit(&accepted.along, &accepted.about);
        let stiffness = accepted.along.device_stiffness;
        let AxisLimits { damping, mass, max_rate, encoder_step } =
            sides.along.with(&sides.about, unit);
        let passivity = PassivityOptions {
            is_on: settings.has_passivity_control && damping < f64::INFINITY,
            stiffness,
            // Force and torque have limits of their own, which a tool applies before.
            max_force: f64::INFINITY,
            damping,
            mass,
            max_rate,
            reserve: NumberError::check_not_negative("reserve", settings.reserve, "J")?,
            rise_rate: settings.rise_rate,
            period: 1.0 / rate,
        };
        let cycle = LimitCycleOptions::of(&passivity, encoder_step);
        Ok(Self {
            accepted,
            sides,
            unit,
            cycle: LimitCycle::new(cycle),
            free: FreeEnergy::new(FreeEnergyOptions {
                reserve: passivity.reserve,
                max_force: along.max_force.positive()?,
            }),
            passivity: Passivity::new(passivity),
            drive: Drive::new(settings.max_drive_power()?, settings.rise_rate),
            force: Channel::new(along, settings, 1.0, rate)?,
            torque: Channel::new(about, settings, unit, rate)?,
            largest_torque: 0.0,
        })
    }

    /// Replaces the accepted impedances by others for the same device.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn renew(&mut self, along: &Accepted, about: &Accepted) {
        self.accepted.along.renew(along);
        self.accepted.about.renew(about);
        let unit = unit(along, about);
        let longer = unit / self.unit;
        self.passivity.in_units(|way| way.turning(longer), |force| force.turning(1.0 / longer));
        self.drive.in_units(|way| way.turning(longer), |force| force.turning(1.0 / longer));
        self.unit = unit;
        let stiffness = along.device_stiffness;
        let AxisLimits { damping, mass, max_rate, encoder_step } =
            self.sides.along.with(&self.sides.about, unit);
        let options = *self.passivity.options();
        let options = PassivityOptions { stiffness, damping, mass, max_rate, ..options };
        self.cycle.renew(LimitCycleOptions::of(&options, encoder_step));
        self.torque.in_units(longer);
        self.passivity.renew(options);
    }

    /// One tick: force and torque to write for `wanted`, both in device coordinates.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn step(&mut self, wanted: SpatialVector, state: &WrenchState) -> SpatialVector {
        self.tick(Wanted { force: wanted, effort: self.effort(wanted), cut: 0.0 }, state)
    }

    /// As [`step`](Self::step), for a wanted force that is first shortened to `max_force` [N],
    /// which counts as the force limit's doing.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn step_within(
        &mut self,
        wanted: SpatialVector,
        max_force: f64,
        state: &WrenchState,
    ) -> SpatialVector {
        let effort = self.effort(wanted);
        // Leave NaN unclamped: the guard stage detects it and zeroes the force.
        let is_number = wanted.along.is_finite();
        let uncut = Cut { force: wanted.along, taken: 0.0 };
        let Cut { force: along, taken } =
            if is_number { cut(wanted.along, max_force) } else { uncut };
        let force = SpatialVector { along, ..wanted };
        self.tick(Wanted { force, effort, cut: taken }, state)
    }

    /// The size of a wrench, where an angle counts as a length [N].
    fn effort(&self, wanted: SpatialVector) -> f64 {
        wanted.turning(1.0 / self.unit).norm()
    }

    fn tick(&mut self, wanted: Wanted<SpatialVector>, state: &WrenchState) -> SpatialVector {
        let Wanted { force: wanted, effort, cut } = wanted;
        let WrenchState { position, velocity, free_force, late, elapsed, stiffness, .. } =
            *state;
        let WrenchState { start, change, explained, bodies, .. } = *state;
        // Stages with a state never see numbers that are not finite; the guards then write
        // zero.
        let is_sound = [wanted, position, velocity].iter().all(SpatialVector::is_finite)
            && free_force.is_finite()
            && bodies.is_finite();
        let unit = self.unit;
        let (position, velocity) = (position.turning(unit), velocity.turning(unit));
        let input = TickInput { is_sound, late, start, change, explained, cut };
        let along = self.force.risen(wanted.along, free_force, &input);
        let about = self.torque.risen(wanted.about, Vector::ZERO, &input);
        let has_risen = !along.is_rising && !about.is_rising;
        let Risen { part: rise, .. } = along;
        let wanted = SpatialVector { along: along.wanted, about: about.wanted };
        let left = self.effort(wanted);
        let effort = along.effort(effort, left).max(about.effort(effort, left));
        let options = *self.passivity.options();
        let elapsed = finite::elapsed(elapsed, options.period + late.max(0.0));
        let as_lengths = wanted.turning(1.0 / unit);
        let free = SpatialVector { along: free_force * rise, about: Vector::ZERO };
        let stiffness = options.stiffness_of(stiffness);
        let bodies = if is_sound { bodies.turning(unit) } else { MovingBodies::NONE };
        let frame = self.drive.enter(&bodies);
        let in_frame = position - frame.origin;
        let forces = ForcesOf { bodies: as_lengths, guides: free };
        let seen = CycleInput::of(forces, effort, in_frame, stiffness).changed(&input);
        let is_disturbed = self.force.is_late() || !has_risen;
        let softness = self.cycle.observed(&seen.disturbed(is_disturbed), is_sound);
        let is_returning = self.cycle.is_returning() || self.drive.is_returning();
        let is_rising = !has_risen || is_returning;
        let of_guides = PassivityOptions { damping: self.sides.along.damping, ..options };
        let scale = rise * self.cycle.part();
        let of_free =
            FreeInput { force: free_force, position: position.along, scale, elapsed, is_sound };
        let Passed { force: free_force, spent } = self.free.step(of_free, &of_guides);
        // The walls' damping may be less: the same part of it is spent.
        let spent = if spent > 0.0 { spent * options.damping / of_guides.damping } else { 0.0 };
        let seen = PortMotion {
            position: in_frame,
            velocity: velocity - frame.way * (1.0 / elapsed),
            owed: frame.owed,
            effort,
            is_rising,
            elapsed,
            softness,
            spent,
            stiffness,
        };
        let allowed = self.passivity.observed(as_lengths, &seen, is_sound);
        let allowed = self.drive.limit(allowed, &bodies, elapsed);
        // An unchanged wrench keeps its bits.
        let allowed = if allowed == as_lengths { wanted } else { allowed.turning(unit) };
        let Given { force: along, of_bodies: force_left, share } =
            self.force.step(allowed.along, free_force, &input);
        let input = TickInput { cut: 0.0, ..input };
        let Given { force: about, of_bodies: torque_left, .. } =
            self.torque.step(allowed.about, Vector::ZERO, &input);
        self.free.written(along - force_left, share);
        let left = SpatialVector { along: force_left, about: torque_left };
        let left = left.turning(1.0 / unit);
        self.passivity.written(left);
        self.drive.written(left);
        self.largest_torque = self.largest_torque.max(about.norm());
        SpatialVector { along, about }
    }

    /// Lowers the force limit [N].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn limit_force(&mut self, max_force: f64) {
        self.force.lower_limit(max_force);
        self.free.lower_limit(max_force);
    }

    /// Lowers the torque limit [N·m].
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

    /// The work of moving bodies so far.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn drives(&self) -> DriveReport {
        self.drive.report()
    }

    /// What each stage has done, as in [`report`](Self::report).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn stage_effects(&self) -> StageEffects {
        let first = BeforeLimits {
            cycles: self.cycle.report().effect,
            guides: self.free.report().effect,
            passivity: self.passivity.report().effect,
            drives: self.drive.report().effect,
        };
        let torque = Some(&self.torque.effects);
        StageEffects::of(first, &self.force.effects, torque)
    }

    /// What every stage did so far, in translation and rotation.
    #[must_use]
    pub fn report(&self) -> SafetyReport {
        let PerMotion { along, about } = &self.accepted;
        let turning = TurningReport::of(about, self.largest_torque, &self.torque);
        SafetyReport {
            turning: Some(turning),
            ..SafetyReport::of(along, self.passivity.report(), &self.force)
                .with_limit_cycles(self.cycle.report())
                .with_free_forces(self.free.report())
                .with_drives(self.drive.report())
        }
    }
}
