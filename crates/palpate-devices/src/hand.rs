// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The hand that holds a simulated device.

use crate::hand_path::{HandPath, Interpolation};
use palpate_field::{Point, Vector};
use palpate_haptics::{HapticsError, not_negative};

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
/// A device that turns is turned likewise, by a spring and a damper about its axes: with the
/// moment of inertia, angular stiffness and damping of the grip, to an orientation that may
/// [follow a path](Self::with_turns) of its own, and by a constant torque. Of the stretch, the
/// turn that leads from the device to where the hand wants it counts, less than half a turn.
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
    wrist: Wrist,
}

/// How a hand turns a device.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Wrist {
    /// The turns it wants to make, as vectors along the axis [rad]; none to hold still.
    pub(crate) path: Option<HandPath<3>>,
    /// [kg·m²].
    pub(crate) inertia: f64,
    /// [N·m/rad].
    pub(crate) stiffness: f64,
    /// [N·m·s/rad].
    pub(crate) damping: f64,
    /// [N·m].
    pub(crate) push: Vector<f64, 3>,
}

impl Wrist {
    /// What fingers hold a stylus with: 1e-4 kg·m², 0.5 N·m/rad, 0.01 N·m·s/rad.
    const GRIP: Self =
        Self { path: None, inertia: 1e-4, stiffness: 0.5, damping: 0.01, push: Vector::ZERO };
}

impl<const D: usize> Hand<D> {
    /// A hand that wants to follow `path`: 0.1 kg, 300 N/m, 5 N·s/m, no push. About axes it wants
    /// to hold still: 1e-4 kg·m², 0.5 N·m/rad, 0.01 N·m·s/rad, no torque.
    #[must_use]
    pub fn new(path: HandPath<D>) -> Self {
        let (push, wrist) = (Vector::ZERO, Wrist::GRIP);
        Self { path, mass: 0.1, stiffness: 300.0, damping: 5.0, push, wrist }
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

    /// The same, turning the device by `turns` over time: vectors along the axis, as long as the
    /// angle [rad], from where it holds the device's own axes; in the plane along z.
    ///
    /// ```
    /// use palpate_devices::{Device, Hand, HandPath, PointState, SimulatedDevice, profile_named};
    /// use palpate_field::Vector;
    /// use palpate_devices::Interpolation;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let turns = vec![Vector([0.0; 3]), Vector([0.0, 0.5, 0.0])];
    /// let turns = HandPath::new(vec![0.0, 1.0], turns, Interpolation::Smooth)?;
    /// let hand = Hand::resting(Vector([0.0; 3]))?.with_turns(turns);
    /// let mut device = SimulatedDevice::new(profile_named("sigma7")?, vec![hand])?;
    /// for tick in 0..3000 {
    ///     device.read(1e-3 * f64::from(tick), &mut [PointState::at_rest(Vector::ZERO)])?;
    /// }
    /// let turn = device.read_turn()?.ok_or("it turns")?;
    /// // Friction leaves it a little short of 0.5 rad about y.
    /// assert!((turn.orientation.matrix()[0][2] - 0.5_f64.sin()).abs() < 0.01);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn with_turns(self, turns: HandPath<3>) -> Self {
        Self { wrist: Wrist { path: Some(turns), ..self.wrist }, ..self }
    }

    /// The same, with a moment of inertia of its own [kg·m²].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if it is negative or not finite.
    pub fn with_inertia(self, inertia: f64) -> Result<Self, HapticsError> {
        let inertia = not_negative("hand inertia", inertia, "kg·m²")?;
        Ok(Self { wrist: Wrist { inertia, ..self.wrist }, ..self })
    }

    /// The same, with another angular stiffness [N·m/rad] and damping [N·m·s/rad].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if either is negative or not finite.
    pub fn with_angular_spring(
        self,
        stiffness: f64,
        damping: f64,
    ) -> Result<Self, HapticsError> {
        let stiffness = not_negative("hand angular stiffness", stiffness, "N·m/rad")?;
        let damping = not_negative("hand angular damping", damping, "N·m·s/rad")?;
        Ok(Self { wrist: Wrist { stiffness, damping, ..self.wrist }, ..self })
    }

    /// The same, turning with a constant torque [N·m].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if it is not finite.
    pub fn with_torque(self, torque: Vector<f64, 3>) -> Result<Self, HapticsError> {
        for component in torque.0 {
            not_negative("hand torque", component.abs(), "N·m")?;
        }
        Ok(Self { wrist: Wrist { push: torque, ..self.wrist }, ..self })
    }

    /// How it turns the device.
    pub(crate) fn wrist(&self) -> &Wrist {
        &self.wrist
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
