// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The hand that holds a simulated device.

use palpate_field::{Point, Vector};
use palpate_haptics::{HandPath, HapticsError, Interpolation, not_negative};

/// A hand: a mass that moves with the device, drawn by a spring and a damper to where the arm
/// wants to be, and a constant push.
///
/// With the position `x` of the device, the target `y` of its path, the stiffness `k` and the
/// damping `b` of the grip and the push `P`, the hand's force on the device and on its own mass
/// is
///
/// ```text
/// k (y − x) + b (y' − x') + P
/// ```
///
/// So in free space the device follows the path, late by what the device's own damping takes.
/// Relaxed to firm, arms have 0.1 to 1 kg, 100 to 1000 N/m and up to 10 N·s/m; a stiffness of
/// zero is a hand that only pushes.
///
/// # Examples
///
/// ```
/// use palpate_devices::Hand;
/// use palpate_field::Vector;
///
/// # fn main() -> Result<(), palpate_haptics::HapticsError> {
/// let hand = Hand::resting(Vector([0.0, 0.1]))?.with_mass(0.2)?.with_spring(400.0, 8.0)?;
/// assert_eq!((hand.mass(), hand.stiffness(), hand.damping()), (0.2, 400.0, 8.0));
/// let error = hand.with_mass(-1.0).unwrap_err();
/// assert_eq!(error.to_string(), "hand mass must be zero or more and finite, got -1 kg");
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Hand<const D: usize> {
    path: HandPath<D>,
    mass: f64,
    stiffness: f64,
    damping: f64,
    push: Vector<f64, D>,
}

impl<const D: usize> Hand<D> {
    /// A hand that wants to follow `path`: 0.1 kg, 300 N/m, 5 N·s/m, no push.
    #[must_use]
    pub fn new(path: HandPath<D>) -> Self {
        Self { path, mass: 0.1, stiffness: 300.0, damping: 5.0, push: Vector::ZERO }
    }

    /// A hand that wants to stay at `place` [m].
    ///
    /// # Errors
    ///
    /// [`HapticsError::SampleNotFinite`] if `place` is not finite or beyond 1e15 m.
    pub fn resting(place: Point<D>) -> Result<Self, HapticsError> {
        HandPath::new(vec![0.0, 1.0], vec![place; 2], Interpolation::Linear).map(Self::new)
    }

    /// The same, with a mass of its own [kg].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if it is negative or not finite.
    pub fn with_mass(self, mass: f64) -> Result<Self, HapticsError> {
        Ok(Self { mass: not_negative("hand mass", mass, "kg")?, ..self })
    }

    /// The same, with another stiffness [N/m] and damping [N·s/m].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if either is negative or not finite.
    pub fn with_spring(self, stiffness: f64, damping: f64) -> Result<Self, HapticsError> {
        let stiffness = not_negative("hand stiffness", stiffness, "N/m")?;
        let damping = not_negative("hand damping", damping, "N·s/m")?;
        Ok(Self { stiffness, damping, ..self })
    }

    /// The same, pushing with a constant force [N].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if it is not finite.
    pub fn with_push(self, push: Vector<f64, D>) -> Result<Self, HapticsError> {
        for component in push.0 {
            not_negative("hand push", component.abs(), "N")?;
        }
        Ok(Self { push, ..self })
    }

    /// Where it wants to be.
    #[must_use]
    pub fn path(&self) -> &HandPath<D> {
        &self.path
    }

    /// What moves with the device [kg].
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Of its spring [N/m].
    #[must_use]
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Of its damper [N·s/m].
    #[must_use]
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// Its constant push [N].
    #[must_use]
    pub fn push(&self) -> Vector<f64, D> {
        self.push
    }
}
