// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The motion of a device in a hand along one axis while the servo's force is held.
//!
//! ```text
//! (m + m_h) x'' + b x' + b_h (x' − y') + k_h (x − y) = F + P − f_c sign(x')
//! ```
//!
//! with constant force `F` and push `P`, and a target `y` of constant velocity. Between two
//! changes of the sign of `x'` the equation is linear and integrated exactly. At rest the
//! device sticks while the other forces stay within `±f_c`; the instant of breakaway is the
//! root of a linear function.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_device::NumberError;

use crate::error::SimulationError;
use crate::oscillator::{Drive, Nodes, Oscillator, Response};

/// The most pieces of motion in one call: at [`FASTEST`], a tenth of a second. A device that is
/// not read for longer stands still for the rest, which bounds the time of a call.
const MOST_PIECES: u32 = 1024;

/// The largest `σ + ω` [1/s] of device and hand, so that [`MOST_PIECES`] cover every tick.
const FASTEST: f64 = 1e4;

/// Bisections for the time of a change of sign: to the last bit.
const HALVINGS: u32 = 60;

/// The energy balance of a simulated contact point since its start [J].
///
/// ```text
/// kinetic = servo + hand − viscous − friction
/// ```
///
/// up to rounding: each term is integrated separately. Rotation adds its own terms, with
/// torques for forces and angles for lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// The work of the servo's forces on device and hand, `∫ F·dx`. Positive: the virtual world
    /// gave energy.
    pub servo: f64,
    /// The work of the hand's spring, damper and push on device and hand.
    pub hand: f64,
    /// Energy dissipated by the device's damping.
    pub viscous: f64,
    /// Energy dissipated by the device's Coulomb friction.
    pub friction: f64,
}

impl Energies {
    /// The kinetic energy by the balance: `servo + hand − viscous − friction` [J].
    #[must_use]
    pub fn balance(&self) -> f64 {
        self.servo + self.hand - self.viscous - self.friction
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.servo += other.servo;
        self.hand += other.hand;
        self.viscous += other.viscous;
        self.friction += other.friction;
    }
}

/// The moving body: device and hand, the same for all axes of a contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Body {
    /// The mass of device and hand together [kg].
    mass: f64,
    /// The device's damping [N·s/m].
    damping: f64,
    /// The device's Coulomb friction [N].
    friction: f64,
    /// The hand's stiffness [N/m].
    grip_stiffness: f64,
    /// The hand's damping [N·s/m].
    grip_damping: f64,
    oscillator: Oscillator,
    /// The responses over the last duration, cached because most ticks have the same duration.
    nodes: Nodes,
}

/// The inputs while the force is held: constant, or linear in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Load {
    /// The servo's force [N].
    pub(crate) force: f64,
    /// The hand's push [N].
    pub(crate) push: f64,
    /// The hand's target at the start [m].
    pub(crate) target: f64,
    /// The velocity of the target [m/s].
    pub(crate) target_velocity: f64,
}

/// Position [m] and velocity [m/s] along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Axis {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
}

/// Properties of device and hand, from which a [`Body`] is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parts {
    /// The mass of the device [kg].
    pub(crate) device_mass: f64,
    /// The mass of the hand [kg].
    pub(crate) hand_mass: f64,
    /// The device's damping [N·s/m].
    pub(crate) damping: f64,
    /// The device's Coulomb friction [N].
    pub(crate) friction: f64,
    /// The hand's stiffness [N/m].
    pub(crate) grip_stiffness: f64,
    /// The hand's damping [N·s/m].
    pub(crate) grip_damping: f64,
}

impl Body {
    /// # Errors
    ///
    /// [`SimulationError::Number`] if the total mass is zero, damping or friction are negative or
    /// not finite, or the motion is faster than [`FASTEST`].
    pub(crate) fn new(parts: &Parts) -> Result<Self, SimulationError> {
        let (device, hand) = (parts.device_mass, parts.hand_mass);
        NumberError::check_not_negative("mass", device, "kg")?;
        let mass = NumberError::check_positive("mass of device and hand", device + hand, "kg")?;
        let damping = NumberError::check_not_negative("least_damping", parts.damping, "N·s/m")?;
        let friction = NumberError::check_not_negative("friction", parts.friction, "N")?;
        let oscillator = Oscillator {
            decay: (damping + parts.grip_damping) / mass,
            spring: parts.grip_stiffness / mass,
        };
        let fastest = oscillator.fastest();
        if fastest.is_nan() || fastest > FASTEST {
            return Err(SimulationError::Number(NumberError::new(
                "the rate of damping and spring per mass",
                "at most 1e4",
                fastest,
                "1/s",
            )));
        }
        Ok(Self {
            mass,
            damping,
            friction,
            grip_stiffness: parts.grip_stiffness,
            grip_damping: parts.grip_damping,
            oscillator,
            nodes: Nodes::new(&oscillator, 0.0),
        })
    }

    /// The mass of device and hand together [kg].
    pub(crate) fn mass(&self) -> f64 {
        self.mass
    }

    /// Moves `axis` for `duration` [s] under `load`. Returns the energies of this time.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; at most [`MOST_PIECES`] pieces.
    pub(crate) fn advance(&mut self, axis: &mut Axis, load: Load, duration: f64) -> Energies {
        let mut energies = Energies::default();
        self.advance_by_pieces(axis, load, duration, |body, axis, load, piece| {
            energies.add(&body.energies(axis, load, piece));
        });
        energies
    }

    /// As [`advance`](Self::advance), without the energies.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; at most [`MOST_PIECES`] pieces.
    pub(crate) fn displace(&mut self, axis: &mut Axis, load: Load, duration: f64) {
        self.advance_by_pieces(axis, load, duration, |_, _, _, _| {});
    }

    /// Moves `axis`, and calls `before` with each piece of the motion before it.
    fn advance_by_pieces(
        &mut self,
        axis: &mut Axis,
        mut load: Load,
        duration: f64,
        mut before: impl FnMut(&Self, &Axis, &Load, &Piece),
    ) {
        let mut left = duration;
        for _ in 0..MOST_PIECES {
            let starts = axis.velocity == 0.0 && self.friction > 0.0;
            let sign = if starts {
                let (wait, sign) = self.rest(axis.position, &load);
                let wait = wait.min(left);
                load.target += load.target_velocity * wait;
                left -= wait;
                sign
            } else {
                axis.velocity.signum()
            };
            if left.is_nan() || left <= 0.0 {
                break;
            }
            let piece = self.piece(axis, &load, sign);
            let longest = left.min(self.oscillator.longest());
            self.respond_for(longest);
            let stop = piece.stop(&self.oscillator, &self.nodes);
            let length = stop.unwrap_or(longest);
            self.respond_for(length);
            before(self, axis, &load, &piece);
            axis.position += self.nodes.end.way(&piece.drive);
            axis.velocity =
                if stop.is_some() { 0.0 } else { self.nodes.end.velocity(&piece.drive) };
            load.target += load.target_velocity * length;
            left -= length;
        }
    }

    /// Makes [`nodes`](Self::nodes) those of a time [s].
    fn respond_for(&mut self, length: f64) {
        if self.nodes.length != length {
            self.nodes = Nodes::new(&self.oscillator, length);
        }
    }

    /// How long the device sticks at `position` [s], and the direction in which it breaks away.
    fn rest(&self, position: f64, load: &Load) -> (f64, f64) {
        let pull = self.pull(position, load);
        let growth = self.grip_stiffness * load.target_velocity;
        if pull.abs() > self.friction {
            (0.0, pull.signum())
        } else if growth == 0.0 {
            (f64::INFINITY, 0.0)
        } else {
            let sign = growth.signum();
            ((sign * self.friction - pull) / growth, sign)
        }
    }

    /// The force without friction on a device that rests at `position` [N].
    fn pull(&self, position: f64, load: &Load) -> f64 {
        load.force
            + load.push
            + self.grip_stiffness * (load.target - position)
            + self.grip_damping * load.target_velocity
    }

    fn piece(&self, axis: &Axis, load: &Load, sign: f64) -> Piece {
        // Without friction the direction does not matter.
        let sign = if self.friction > 0.0 { sign } else { 0.0 };
        let push = (self.pull(axis.position, load) - sign * self.friction) / self.mass;
        let growth = self.grip_stiffness * load.target_velocity / self.mass;
        Piece { drive: Drive { velocity: axis.velocity, push, growth }, sign }
    }

    /// The energies of a piece without a change of direction, over the time of
    /// [`nodes`](Self::nodes).
    fn energies(&self, axis: &Axis, load: &Load, piece: &Piece) -> Energies {
        let drive = &piece.drive;
        let way = self.nodes.end.way(drive);
        let stretch = load.target - axis.position;
        let [squares, hand] = self.nodes.integral(|time, response| {
            let velocity = response.velocity(drive);
            let stretch = stretch + load.target_velocity * time - response.way(drive);
            let grip = self.grip_stiffness * stretch
                + self.grip_damping * (load.target_velocity - velocity);
            [velocity * velocity, grip * velocity]
        });
        Energies {
            servo: load.force * way,
            hand: hand + load.push * way,
            viscous: self.damping * squares,
            friction: piece.sign * self.friction * way,
        }
    }
}

/// A piece of motion in one direction; without friction in any direction.
struct Piece {
    drive: Drive,
    /// The sign of the velocity; 0 without friction.
    sign: f64,
}

impl Piece {
    /// When the velocity first changes its sign within the time of `nodes`, if it does [s].
    ///
    /// The acceleration has at most one zero in that time, so the velocity has at most one
    /// extremum: it changes its sign once, seen at the end, or dips and comes back, seen at the
    /// extremum. From rest it cannot dip.
    fn stop(&self, oscillator: &Oscillator, nodes: &Nodes) -> Option<f64> {
        if self.sign == 0.0 {
            return None;
        }
        let length = nodes.length;
        let velocity = |time| self.sign * oscillator.response(time).velocity(&self.drive);
        if self.sign * nodes.end.velocity(&self.drive) < 0.0 {
            return Some(first(length, |time| velocity(time) < 0.0));
        }
        let accelerated = |time: f64, response: &Response| {
            let (way, velocity) = (response.way(&self.drive), response.velocity(&self.drive));
            let push = self.drive.push + self.drive.growth * time;
            self.sign * (push - oscillator.decay * velocity - oscillator.spring * way)
        };
        let acceleration = |time: f64| accelerated(time, &oscillator.response(time));
        let at_first = self.sign * (self.drive.push - oscillator.decay * self.drive.velocity);
        let may_dip = self.drive.velocity != 0.0
            && at_first < 0.0
            && accelerated(length, &nodes.end) > 0.0;
        if !may_dip {
            return None;
        }
        let lowest = first(length, |time| acceleration(time) > 0.0);
        (velocity(lowest) < 0.0).then(|| first(lowest, |time| velocity(time) < 0.0))
    }
}

/// The first time at which `has_changed`, which is false at 0 and true at `end`.
fn first(end: f64, has_changed: impl Fn(f64) -> bool) -> f64 {
    let (mut before, mut after) = (0.0, end);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (before + after);
        if has_changed(middle) {
            after = middle;
        } else {
            before = middle;
        }
    }
    after
}
