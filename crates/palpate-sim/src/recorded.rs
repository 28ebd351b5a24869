// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A device without hardware, whose hand follows a path whatever the force.

use crate::error::SimulationError;
use palpate_field::{Rotation, Vector};

use crate::hand_path::HandPath;
use palpate_device::{
    Device, DeviceError, DeviceLost, DeviceProfile, PointState, Reading, TurnState,
};

/// A device whose points follow recorded hand paths.
///
/// Deterministic: states depend on the servo's time alone. The forces written last can be read.
///
/// # Examples
///
/// ```
/// use palpate_field::Vector;
/// use palpate_device::{Device, PointState};
/// use palpate_sim::{HandPath, Interpolation, RecordedDevice};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ends = vec![Vector([0.0, 0.5, 0.0]), Vector([0.0, 0.0, 0.0])];
/// let path = HandPath::new(vec![0.0, 2.0], ends, Interpolation::Linear)?;
/// let mut device = RecordedDevice::new(vec![path])?;
/// let mut points = [PointState::at_rest(Vector::ZERO)];
/// device.read(1.0, &mut points)?;
/// assert_eq!(points[0].position, Vector([0.0, 0.25, 0.0]));
/// assert_eq!(points[0].velocity, Vector([0.0, -0.25, 0.0]));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct RecordedDevice {
    paths: Vec<HandPath>,
    forces: Vec<Vector<f64, 3>>,
    profile: DeviceProfile,
    /// The path of orientations; `None` for a device without rotation.
    turns: Option<HandPath>,
    turn: Option<TurnState>,
    torque: Vector<f64, 3>,
}

/// The time over which an angular velocity is measured [s]: short for any hand, and long enough
/// that rounding does not matter.
const INSTANT: f64 = 1e-6;

impl RecordedDevice {
    /// A device with one contact point for each path.
    ///
    /// # Errors
    ///
    /// [`DeviceError::NoContactPoint`] if there are no paths.
    #[inline(never)]
    pub fn new(paths: Vec<HandPath>) -> Result<Self, SimulationError> {
        if paths.is_empty() {
            return Err(DeviceError::NoContactPoint.into());
        }
        let forces = vec![Vector::ZERO; paths.len()];
        let (turns, turn, torque) = (None, None, Vector::ZERO);
        let profile = DeviceProfile::unlimited("recorded");
        Ok(Self { paths, forces, profile, turns, turn, torque })
    }

    /// This device with a path of orientations: rotation vectors [rad] relative to the device's
    /// own axes.
    ///
    /// ```
    /// use palpate_field::{Rotation, Vector};
    /// use palpate_device::{Device, PointState};
    /// use palpate_sim::{HandPath, Interpolation, RecordedDevice};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let rest = HandPath::new(vec![0.0, 2.0], vec![Vector([0.0, 0.0, 0.0]); 2], Interpolation::Linear)?;
    /// let turns = vec![Vector([0.0; 3]), Vector([0.0, 0.0, 1.0])];
    /// let turns = HandPath::new(vec![0.0, 2.0], turns, Interpolation::Linear)?;
    /// let mut device = RecordedDevice::new(vec![rest])?.with_turns(turns);
    /// device.read(1.0, &mut [PointState::at_rest(Vector::ZERO)])?;
    /// let turn = device.read_turn()?.ok_or("it turns")?;
    /// let turned = Rotation::identity().turn_to(&turn.orientation);
    /// assert!((turned - Vector([0.0, 0.0, 0.5])).norm() < 1e-15);
    /// assert!((turn.angular_velocity - Vector([0.0, 0.0, 0.5])).norm() < 1e-9);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn with_turns(self, turns: HandPath) -> Self {
        Self { turns: Some(turns), ..self }
    }

    /// This device with the profile of a real one.
    #[must_use]
    pub fn with_profile(self, profile: DeviceProfile) -> Self {
        Self { profile, ..self }
    }

    /// The forces written last [N].
    #[must_use]
    pub fn forces(&self) -> &[Vector<f64, 3>] {
        &self.forces
    }

    /// The torque written last [N·m].
    #[must_use]
    pub fn torque(&self) -> Vector<f64, 3> {
        self.torque
    }

    /// The time at which the last path ends [s].
    #[must_use]
    pub fn end(&self) -> f64 {
        self.paths.iter().map(|p| p.start() + p.duration()).fold(0.0, f64::max)
    }
}

impl Device for RecordedDevice {
    fn points(&self) -> usize {
        self.paths.len()
    }

    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }

    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        for (point, path) in points.iter_mut().zip(&self.paths) {
            *point = path.state_at(time);
        }
        self.turn = self.turns.as_ref().map(|turns| {
            let at = |time| Rotation::identity().turned(turns.state_at(time).position);
            let (before, after) = (at(time - INSTANT), at(time + INSTANT));
            let angular_velocity = before.turn_to(&after) * (0.5 / INSTANT);
            TurnState { orientation: at(time), angular_velocity }
        });
        Ok(Reading::Fresh { time })
    }

    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        for (kept, force) in self.forces.iter_mut().zip(forces) {
            *kept = *force;
        }
        Ok(())
    }

    fn read_turn(&mut self) -> Result<Option<TurnState>, DeviceLost> {
        Ok(self.turn)
    }

    fn write_torque(&mut self, torque: Vector<f64, 3>) -> Result<(), DeviceLost> {
        self.torque = torque;
        Ok(())
    }
}
