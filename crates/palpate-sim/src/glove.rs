// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Gloves: many fingers that follow hand paths.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::error::SimulationError;
use crate::hand_path::HandPath;
use palpate_device::{
    Device, DeviceError, DeviceLost, DeviceProfile, NumberError, PointState, Reading, limited,
};
use palpate_field::Vector;
use palpate_vibration::Actuator;

/// A glove, whose fingers follow hand paths whatever they touch; each finger is a contact
/// point.
///
/// A glove has no force feedback, as is usual, or a force limit for each finger, to which
/// written forces are clamped. One hand has five fingers, two hands have ten; with twelve
/// points a hand, the points are finger tips, the joints below them, and the palm. For fingers
/// that yield to forces use a [`SimulatedDevice`](crate::SimulatedDevice) with a
/// [`Hand`](crate::Hand) for each finger.
///
/// # Examples
///
/// ```
/// use palpate_device::{Device, PointState};
/// use palpate_sim::{Glove, HandPath};
/// use palpate_field::Vector;
/// use palpate_sim::Interpolation;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ends = vec![Vector([0.0, 0.1, 0.0]), Vector([0.0, 0.0, 0.0])];
/// let hand = HandPath::new(vec![0.0, 1.0], ends, Interpolation::Linear)?;
/// let tips = [-0.04, -0.02, 0.0, 0.02, 0.04].map(|x| Vector([x, 0.0, 0.0]));
/// let right = Glove::from_hand(&hand, &tips)?;
/// let left = Glove::from_hand(&hand, &tips.map(|tip| tip - Vector([0.3, 0.0, 0.0])))?;
/// let mut both = right.joined(left);
///
/// let mut points = [PointState::at_rest(Vector::ZERO); 10];
/// both.read(0.5, &mut points)?;
/// assert_eq!(points[1].position, Vector([-0.02, 0.05, 0.0]));
/// assert_eq!(points[7].position, Vector([-0.3, 0.05, 0.0]));
/// assert_eq!(both.profile().max_force, 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Glove {
    fingers: Vec<Finger>,
    profile: DeviceProfile,
}

#[derive(Clone, Debug)]
struct Finger {
    path: HandPath,
    /// The offset of the finger from the path [m].
    offset: Vector<f64, 3>,
    /// Largest force [N].
    limit: f64,
    /// The force written last, clamped to the limit [N].
    force: Vector<f64, 3>,
    /// What shakes it.
    actuator: Option<Actuator>,
}

impl Finger {
    /// A finger without force feedback and actuator.
    #[inline(never)]
    fn new(path: HandPath, offset: Vector<f64, 3>) -> Self {
        Self { path, offset, limit: 0.0, force: Vector::ZERO, actuator: None }
    }
}

impl Glove {
    /// A glove with a path for each finger, without force feedback.
    ///
    /// # Errors
    ///
    /// [`DeviceError::NoContactPoint`] if there are no paths.
    pub fn new(paths: Vec<HandPath>) -> Result<Self, SimulationError> {
        Self::of(paths.into_iter().map(|path| Finger::new(path, Vector::ZERO)).collect())
    }

    /// A glove whose fingers keep their `offsets` [m] from the path of one hand, without force
    /// feedback.
    ///
    /// # Errors
    ///
    /// [`DeviceError::NoContactPoint`] if there are no offsets, [`SimulationError::Number`] if one
    /// is not finite.
    #[inline(never)]
    pub fn from_hand(
        hand: &HandPath,
        offsets: &[Vector<f64, 3>],
    ) -> Result<Self, SimulationError> {
        for component in offsets.iter().flat_map(|offset| offset.0) {
            NumberError::check_not_negative("finger offset", component.abs(), "m")?;
        }
        Self::of(offsets.iter().map(|offset| Finger::new(hand.clone(), *offset)).collect())
    }

    fn of(fingers: Vec<Finger>) -> Result<Self, SimulationError> {
        if fingers.is_empty() {
            return Err(DeviceError::NoContactPoint.into());
        }
        let profile = DeviceProfile { max_force: 0.0, ..DeviceProfile::unlimited("glove") };
        Ok(Self { fingers, profile })
    }

    /// This glove with a force limit for each finger [N]; 0 for no force feedback.
    ///
    /// The profile's largest force becomes the largest of the limits.
    ///
    /// # Errors
    ///
    /// [`DeviceError::OneForEach`] if there are not as many limits as fingers,
    /// [`SimulationError::Number`] if one is negative or not finite.
    pub fn with_limits(mut self, limits: &[f64]) -> Result<Self, SimulationError> {
        if limits.len() != self.fingers.len() {
            let (given, points) = (limits.len(), self.fingers.len());
            return Err(DeviceError::OneForEach { items: "limits", given, points }.into());
        }
        for (finger, limit) in self.fingers.iter_mut().zip(limits) {
            finger.limit = NumberError::check_not_negative("max_force", *limit, "N")?;
        }
        self.profile.max_force = limits.iter().copied().fold(0.0, f64::max);
        Ok(self)
    }

    /// This glove with an actuator in each finger, which shakes it.
    ///
    /// The glove says what shakes; a `Synthesiser` for that actuator makes what it plays:
    ///
    /// ```
    /// use palpate_sim::{Glove, HandPath, Interpolation};
    /// use palpate_field::Vector;
    /// use palpate_vibration::{Mapping, MappingOptions, Synthesiser, actuator_named};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ends = vec![Vector([0.0, 0.1, 0.0]), Vector([0.0, 0.0, 0.0])];
    /// let hand = HandPath::new(vec![0.0, 1.0], ends, Interpolation::Linear)?;
    /// let glove = Glove::new(vec![hand])?.with_actuator(actuator_named("lra")?);
    ///
    /// let Some(Some(actuator)) = glove.actuators().next() else { unreachable!() };
    /// let mapping = Mapping::new(actuator.options(MappingOptions::default()))?;
    /// let synthesiser = Synthesiser::for_actuator(&mapping, actuator, 8000.0, 1)?;
    /// assert_eq!(synthesiser.sample_rate(), 8000.0);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn with_actuator(mut self, actuator: Actuator) -> Self {
        for finger in &mut self.fingers {
            finger.actuator = Some(actuator.clone());
        }
        self
    }

    /// The actuator in each finger; `None` in a finger without one.
    pub fn actuators(&self) -> impl Iterator<Item = Option<&Actuator>> {
        self.fingers.iter().map(|finger| finger.actuator.as_ref())
    }

    /// Both gloves as one device: the fingers of this one, then those of `other`.
    #[must_use]
    pub fn joined(mut self, other: Self) -> Self {
        self.fingers.extend(other.fingers);
        self.profile.max_force = self.profile.max_force.max(other.profile.max_force);
        self
    }

    /// The forces written last, each clamped to its finger's limit [N].
    pub fn forces(&self) -> impl Iterator<Item = Vector<f64, 3>> {
        self.fingers.iter().map(|finger| finger.force)
    }
}

impl Device for Glove {
    fn points(&self) -> usize {
        self.fingers.len()
    }

    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        for (point, finger) in points.iter_mut().zip(&self.fingers) {
            let PointState { position, velocity } = finger.path.state_at(time);
            *point = PointState { position: position + finger.offset, velocity };
        }
        Ok(Reading::Fresh { time })
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        for (finger, force) in self.fingers.iter_mut().zip(forces) {
            finger.force = limited(*force, finger.limit);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand_path::Interpolation;

    fn path(height: f64) -> HandPath {
        let ends = vec![Vector([0.0, height, 0.0]), Vector([1.0, height, 0.0])];
        HandPath::new(vec![0.0, 2.0], ends, Interpolation::Linear).unwrap()
    }

    #[test]
    fn every_finger_has_its_path_and_its_limit() {
        let glove = Glove::new(vec![path(0.1), path(0.2), path(0.3)]).unwrap();
        let mut glove = glove.with_limits(&[1.0, 0.0, 2.5]).unwrap();
        assert_eq!(glove.profile().max_force, 2.5);
        let mut points = [PointState::at_rest(Vector::ZERO); 3];
        glove.read(1.0, &mut points).unwrap();
        assert_eq!(points.map(|p| p.position), [0.1, 0.2, 0.3].map(|y| Vector([0.5, y, 0.0])));
        assert!(points.iter().all(|p| p.velocity == Vector([0.5, 0.0, 0.0])));
        glove.write(&[Vector([3.0, -4.0, 0.0]); 3]).unwrap();
        let forces: Vec<_> = glove.forces().collect();
        assert_eq!(
            forces,
            [Vector([0.6, -0.8, 0.0]), Vector([0.0, 0.0, 0.0]), Vector([1.5, -2.0, 0.0])]
        );
    }

    #[test]
    fn joined_gloves_keep_their_actuators() {
        let [lra, erm] =
            ["lra", "erm"].map(|name| palpate_vibration::actuator_named(name).unwrap());
        let glove = || Glove::new(vec![path(0.1)]).unwrap();
        let both =
            glove().with_actuator(lra.clone()).joined(glove().with_actuator(erm.clone()));
        let both = both.joined(glove());
        let actuators: Vec<_> = both.actuators().collect();
        assert_eq!(actuators, [Some(&lra), Some(&erm), None]);
    }

    #[test]
    fn wrong_gloves_are_refused() {
        assert_eq!(Glove::new(Vec::new()).unwrap_err(), DeviceError::NoContactPoint.into());
        let far = Glove::from_hand(&path(0.0), &[Vector([f64::NAN, 0.0, 0.0])]).unwrap_err();
        assert!(far.to_string().starts_with("finger offset must be"), "{far}");
        let glove = Glove::new(vec![path(0.0)]).unwrap();
        assert!(glove.clone().with_limits(&[]).is_err());
        assert!(glove.with_limits(&[-1.0]).is_err());
    }
}
