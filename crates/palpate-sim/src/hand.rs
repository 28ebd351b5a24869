// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The hand that holds a simulated device.

use crate::error::SimulationError;
use crate::hand_path::{HandPath, Interpolation};
use palpate_device::NumberError;
use palpate_field::{Point, Vector};

/// A hand that holds a simulated device: a mass that moves with the device, a spring and a
/// damper that pull it to a target, and a constant push.
///
/// With the position `x` of the device, the target `y` of its path, the stiffness `k` and the
/// damping `b` of the grip and the push `P`, the hand's force on the device and on its own mass
/// is
///
/// ```text
/// k (y − x) + b (y' − x') + P
/// ```
///
/// In free space the device follows the path with a lag due to its own damping. Relaxed to firm
/// arms have 0.1 to 1 kg, 100 to 1000 N/m and up to 10 N·s/m; with a stiffness of zero the hand
/// only pushes.
///
/// For a device with rotation the hand also has a moment of inertia, an angular spring and
/// damper that pull the device to a target orientation, which may [follow a
/// path](Self::with_turns), and a constant torque. The stretch of the angular spring is the
/// rotation vector from the device to the target, less than half a turn.
///
/// # Examples
///
/// ```
/// use palpate_sim::Hand;
/// use palpate_field::Vector;
///
/// # fn main() -> Result<(), palpate_sim::SimulationError> {
/// let hand = Hand::resting(Vector([0.0, 0.1, 0.0]))?.with_mass(0.2)?.with_spring(400.0, 8.0)?;
/// assert_eq!((hand.mass(), hand.stiffness(), hand.damping()), (0.2, 400.0, 8.0));
/// let error = hand.with_mass(-1.0).unwrap_err();
/// assert_eq!(error.to_string(), "mass must be zero or more and finite, got -1 kg");
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Hand {
    path: HandPath,
    mass: f64,
    stiffness: f64,
    damping: f64,
    push: Vector<f64, 3>,
    wrist: Wrist,
}

/// The rotational properties of a hand.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Wrist {
    /// The path of target orientations, as rotation vectors [rad]; `None` to hold still.
    pub(crate) path: Option<HandPath>,
    /// The moment of inertia [kg·m²].
    pub(crate) inertia: f64,
    /// The angular stiffness [N·m/rad].
    pub(crate) stiffness: f64,
    /// The angular damping [N·m·s/rad].
    pub(crate) damping: f64,
    /// The constant torque [N·m].
    pub(crate) push: Vector<f64, 3>,
}

impl Wrist {
    /// Fingers on a stylus: 1e-4 kg·m², 0.5 N·m/rad, 0.01 N·m·s/rad.
    const GRIP: Self =
        Self { path: None, inertia: 1e-4, stiffness: 0.5, damping: 0.01, push: Vector::ZERO };

    /// No hand.
    const NONE: Self =
        Self { path: None, inertia: 0.0, stiffness: 0.0, damping: 0.0, push: Vector::ZERO };
}

impl Hand {
    /// A hand that follows `path`: 0.1 kg, 300 N/m, 5 N·s/m, no push. The hand holds the
    /// orientation still: 1e-4 kg·m², 0.5 N·m/rad, 0.01 N·m·s/rad, no torque.
    #[must_use]
    pub fn new(path: HandPath) -> Self {
        let (push, wrist) = (Vector::ZERO, Wrist::GRIP);
        Self { path, mass: 0.1, stiffness: 300.0, damping: 5.0, push, wrist }
    }

    /// A hand that stays at `place` [m].
    ///
    /// # Errors
    ///
    /// [`SimulationError::SampleNotFinite`] if a coordinate of `place` is not finite or exceeds
    /// 1e15 m.
    pub fn resting(place: impl Into<Point<3>>) -> Result<Self, SimulationError> {
        HandPath::new(vec![0.0, 1.0], vec![place.into(); 2], Interpolation::Linear)
            .map(Self::new)
    }

    /// No hand at all, at a device whose handle is at `place` [m] at first.
    ///
    /// # Errors
    ///
    /// As [`resting`](Self::resting).
    ///
    /// ```
    /// use palpate_sim::Hand;
    ///
    /// let free = Hand::free([0.0, 0.1, 0.0]).unwrap();
    /// assert_eq!((free.mass(), free.stiffness(), free.damping()), (0.0, 0.0, 0.0));
    /// ```
    pub fn free(place: impl Into<Point<3>>) -> Result<Self, SimulationError> {
        let hand = Self::resting(place)?;
        Ok(Self { mass: 0.0, stiffness: 0.0, damping: 0.0, wrist: Wrist::NONE, ..hand })
    }

    /// This hand with another mass [kg].
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if the number is negative or not finite.
    pub fn with_mass(self, mass: f64) -> Result<Self, SimulationError> {
        Ok(Self { mass: NumberError::check_not_negative("mass", mass, "kg")?, ..self })
    }

    /// This hand with another stiffness [N/m] and damping [N·s/m].
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if either is negative or not finite.
    pub fn with_spring(self, stiffness: f64, damping: f64) -> Result<Self, SimulationError> {
        let stiffness = NumberError::check_not_negative("hand stiffness", stiffness, "N/m")?;
        let damping = NumberError::check_not_negative("hand damping", damping, "N·s/m")?;
        Ok(Self { stiffness, damping, ..self })
    }

    /// This hand with a constant push [N].
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if a coordinate is not finite.
    pub fn with_push(self, push: impl Into<Vector<f64, 3>>) -> Result<Self, SimulationError> {
        let push = push.into();
        for component in push.0 {
            NumberError::check_not_negative("hand push", component.abs(), "N")?;
        }
        Ok(Self { push, ..self })
    }

    /// This hand with a path of target orientations: rotation vectors [rad] relative to the
    /// device's own axes; in the plane along z.
    ///
    /// ```
    /// use palpate_device::{Device, PointState, profile_named};
    /// use palpate_sim::{Hand, HandPath, SimulatedDevice};
    /// use palpate_field::Vector;
    /// use palpate_sim::Interpolation;
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
    pub fn with_turns(self, turns: HandPath) -> Self {
        Self { wrist: Wrist { path: Some(turns), ..self.wrist }, ..self }
    }

    /// This hand with another moment of inertia [kg·m²].
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if the number is negative or not finite.
    pub fn with_inertia(self, inertia: f64) -> Result<Self, SimulationError> {
        let inertia = NumberError::check_not_negative("hand inertia", inertia, "kg·m²")?;
        Ok(Self { wrist: Wrist { inertia, ..self.wrist }, ..self })
    }

    /// This hand with another angular stiffness [N·m/rad] and damping [N·m·s/rad].
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if either is negative or not finite.
    pub fn with_angular_spring(
        self,
        stiffness: f64,
        damping: f64,
    ) -> Result<Self, SimulationError> {
        let stiffness =
            NumberError::check_not_negative("hand angular stiffness", stiffness, "N·m/rad")?;
        let damping =
            NumberError::check_not_negative("hand angular damping", damping, "N·m·s/rad")?;
        Ok(Self { wrist: Wrist { stiffness, damping, ..self.wrist }, ..self })
    }

    /// This hand with a constant torque [N·m].
    ///
    /// # Errors
    ///
    /// [`SimulationError::Number`] if a coordinate is not finite.
    pub fn with_torque(
        self,
        torque: impl Into<Vector<f64, 3>>,
    ) -> Result<Self, SimulationError> {
        let torque = torque.into();
        for component in torque.0 {
            NumberError::check_not_negative("hand torque", component.abs(), "N·m")?;
        }
        Ok(Self { wrist: Wrist { push: torque, ..self.wrist }, ..self })
    }

    /// The rotational properties.
    pub(crate) fn wrist(&self) -> &Wrist {
        &self.wrist
    }

    /// The path of the target.
    #[must_use]
    pub fn path(&self) -> &HandPath {
        &self.path
    }

    /// The mass that moves with the device [kg].
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// The stiffness of the spring [N/m].
    #[must_use]
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// The damping of the damper [N·s/m].
    #[must_use]
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// The constant push [N].
    #[must_use]
    pub fn push(&self) -> Vector<f64, 3> {
        self.push
    }
}
