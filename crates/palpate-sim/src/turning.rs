// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The rotation of a device in a hand while the servo's torque is held.
//!
//! The moment of inertia `I` is the same about every axis, so the axes are independent: each
//! follows [`motion`](crate::motion), with angles for lengths. The stretch of the hand's spring
//! is the rotation vector from the device to the hand's target. Between two reads the three
//! angles change independently, by `Δθ`, and the device rotates by the vector `Δθ`: so the work
//! of the held torque is `τ·Δθ` exactly, and the readings give `Δθ`.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::error::SimulationError;
use palpate_device::{NumberError, TurnState, TurningProfile, limited};
use palpate_field::{Rotation, Vector};

use crate::hand::{Hand, Wrist};
use crate::motion::{Axis, Body, Energies, Load, Parts};

/// The rotational part of a simulated device.
#[derive(Clone, Debug)]
pub(crate) struct Turning {
    wrist: Wrist,
    body: Body,
    max_torque: f64,
    encoder_step: f64,
    orientation: Rotation<3>,
    /// The angular velocity [rad/s].
    spin: Vector<f64, 3>,
    /// The held torque [N·m].
    torque: Vector<f64, 3>,
    /// The last reading.
    reading: TurnState,
    /// The hand's target orientation at the last read.
    target: Rotation<3>,
    energies: Energies,
}

impl Turning {
    /// # Errors
    ///
    /// [`SimulationError::Number`] if the profile's inertia, least damping, friction or encoder
    /// step is negative or not finite, its largest torque is negative or NaN, the total inertia
    /// is zero, or the motion of device and hand is too fast to be integrated.
    pub(crate) fn new(profile: &TurningProfile, hand: &Hand) -> Result<Self, SimulationError> {
        let wrist = hand.wrist().clone();
        NumberError::check_not_negative("inertia", profile.inertia, "kg·m²")?;
        NumberError::check_positive(
            "inertia of device and hand",
            profile.inertia + wrist.inertia,
            "kg·m²",
        )?;
        NumberError::check_not_negative(
            "turning least_damping",
            profile.least_damping,
            "N·m·s/rad",
        )?;
        NumberError::check_not_negative("turning friction", profile.friction, "N·m")?;
        let encoder_step = NumberError::check_not_negative(
            "turning encoder_step",
            profile.encoder_step,
            "rad",
        )?;
        if profile.max_torque != f64::INFINITY {
            NumberError::check_not_negative("max_torque", profile.max_torque, "N·m")?;
        }
        let body = Body::new(&Parts {
            device_mass: profile.inertia,
            hand_mass: wrist.inertia,
            damping: profile.least_damping,
            friction: profile.friction,
            grip_stiffness: wrist.stiffness,
            grip_damping: wrist.damping,
        })?;
        let identity = Rotation::identity();
        Ok(Self {
            wrist,
            body,
            max_torque: profile.max_torque,
            encoder_step,
            orientation: identity,
            spin: Vector::ZERO,
            torque: Vector::ZERO,
            reading: TurnState::at_rest(identity),
            target: identity,
            energies: Energies::default(),
        })
    }

    /// The last reading.
    pub(crate) fn reading(&self) -> TurnState {
        self.reading
    }

    /// The true orientation and angular velocity, without encoder steps.
    pub(crate) fn state(&self) -> TurnState {
        TurnState { orientation: self.orientation, angular_velocity: self.spin }
    }

    pub(crate) fn torque(&self) -> Vector<f64, 3> {
        self.torque
    }

    pub(crate) fn energies(&self) -> &Energies {
        &self.energies
    }

    /// `½ I ω²` of device and hand [J].
    pub(crate) fn kinetic_energy(&self) -> f64 {
        0.5 * self.body.mass() * self.spin.dot(self.spin)
    }

    /// Holds a torque from now on [N·m].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn write(&mut self, torque: Vector<f64, 3>) {
        self.torque = limited(torque, self.max_torque);
    }

    /// Turns the device to the hand's target.
    pub(crate) fn start(&mut self, time: f64) {
        self.target = self.wanted(time);
        (self.orientation, self.spin) = (self.target, Vector::ZERO);
        self.reading = TurnState::at_rest(self.encoded());
    }

    /// Moves from the time `last` to `time` [s].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn advance(&mut self, last: f64, time: f64) {
        let duration = time - last;
        let target = self.wanted(time);
        let stretch = self.orientation.turn_to(&self.target);
        let next = self.orientation.turn_to(&target);
        let rates = (next - stretch) * (1.0 / duration);
        let loads =
            self.torque.0.into_iter().zip(self.wrist.push.0).zip(stretch.0).zip(rates.0);
        let mut way = Vector::ZERO;
        let axes = self.spin.0.iter_mut().zip(&mut way.0).zip(loads);
        for ((spin, way), (((force, push), target), target_velocity)) in axes {
            let mut axis = Axis { position: 0.0, velocity: *spin };
            let load = Load { force, push, target, target_velocity };
            self.energies.add(&self.body.advance(&mut axis, load, duration));
            (*way, *spin) = (axis.position, axis.velocity);
        }
        self.orientation = self.orientation.turned(way);
        self.target = target;
    }

    /// Reads the device, `duration` after the last reading [s].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn measure(&mut self, duration: f64) {
        let orientation = self.encoded();
        let angular_velocity =
            self.reading.orientation.turn_to(&orientation) * (1.0 / duration);
        self.reading = TurnState { orientation, angular_velocity };
    }

    /// The hand's target orientation.
    fn wanted(&self, time: f64) -> Rotation<3> {
        let path = self.wrist.path.as_ref();
        let turn = path.map_or(Vector::ZERO, |path| path.state_at(time).position);
        Rotation::identity().turned(turn)
    }

    /// The orientation in whole steps of the encoder.
    fn encoded(&self) -> Rotation<3> {
        let step = self.encoder_step;
        if step > 0.0 {
            let identity = Rotation::identity();
            let turn = identity.turn_to(&self.orientation);
            identity.turned(Vector(turn.0.map(|x| (x / step).round() * step)))
        } else {
            self.orientation
        }
    }
}
