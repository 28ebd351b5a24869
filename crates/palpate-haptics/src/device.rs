// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a haptic device is to the servo.

use palpate_field::{Point, Vector};

/// One contact point of a device, as read in a tick. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointState<const D: usize> {
    /// Where the hand holds the device [m].
    pub position: Point<D>,
    /// How fast it moves [m/s].
    pub velocity: Vector<f64, D>,
}

impl<const D: usize> PointState<D> {
    /// A point at rest at `position` [m].
    #[must_use]
    pub fn at_rest(position: Point<D>) -> Self {
        Self { position, velocity: Vector::ZERO }
    }

    /// `true` if no number is NaN or infinite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.position.is_finite() && self.velocity.is_finite()
    }
}

/// What a device can do: data, from its maker.
///
/// # Examples
///
/// ```
/// use palpate_haptics::DeviceLimits;
///
/// let touch = DeviceLimits::KNOWN.iter().find(|d| d.name == "Phantom Touch");
/// assert_eq!(touch.map(|d| d.max_force), Some(3.3));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct DeviceLimits {
    /// The device's name.
    pub name: &'static str,
    /// Largest force [N].
    pub max_force: f64,
    /// Largest stiffness it renders at 1 kHz [N/m].
    pub max_stiffness: f64,
    /// Largest damping it renders at 1 kHz [N·s/m].
    pub max_damping: f64,
    /// Radius of the ball it reaches [m].
    pub workspace_radius: f64,
}

impl DeviceLimits {
    /// The limits of common devices, as CHAI3D 3.3 lists them.
    pub const KNOWN: &[Self] = &[
        Self::of("Phantom Touch", 3.3, 400.0, 4.0, 0.075),
        Self::of("Phantom Omni", 3.3, 700.0, 5.0, 0.1),
        Self::of("Phantom Desktop", 7.9, 1000.0, 5.0, 0.1),
        Self::of("Phantom Premium 1.5 6DOF", 8.5, 800.0, 5.0, 0.12),
        Self::of("Phantom Premium 3.0 6DOF", 22.0, 1000.0, 5.0, 0.25),
        Self::of("Novint Falcon", 8.0, 3000.0, 20.0, 0.04),
        Self::of("omega.x", 12.0, 5000.0, 30.0, 0.075),
        Self::of("sigma.x", 12.0, 4000.0, 30.0, 0.075),
        Self::of("lambda.x", 12.0, 8000.0, 30.0, 0.1125),
        Self::of("delta.3", 20.0, 5000.0, 30.0, 0.15),
    ];

    const fn of(
        name: &'static str,
        max_force: f64,
        max_stiffness: f64,
        max_damping: f64,
        workspace_radius: f64,
    ) -> Self {
        Self { name, max_force, max_stiffness, max_damping, workspace_radius }
    }
}

/// Why a device no longer answers.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the device was lost: {reason}")]
pub struct DeviceLost {
    /// What its transport said.
    pub reason: String,
}

/// A haptic device with one contact point or more.
///
/// A stylus has one point, a glove one for each finger. World coordinates both ways: mapping a
/// workspace is the implementation's.
pub trait Device<const D: usize> {
    /// How many contact points it has; the same for life.
    fn points(&self) -> usize;

    /// What it can do.
    fn limits(&self) -> &DeviceLimits;

    /// Reads every contact point into `points`, which has one place for each, at `time` [s]
    /// since the servo started.
    ///
    /// Real-time: called in every tick.
    ///
    /// # Errors
    ///
    /// [`DeviceLost`] if there is nothing more to read, ever; the servo then stops. A reading
    /// that fails once should repeat the last one.
    fn read(&mut self, time: f64, points: &mut [PointState<D>]) -> Result<(), DeviceLost>;

    /// Writes one force on the hand for every contact point [N].
    ///
    /// Real-time: called in every tick, and once with zero forces when the servo stops.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    fn write(&mut self, forces: &[Vector<f64, D>]) -> Result<(), DeviceLost>;
}
