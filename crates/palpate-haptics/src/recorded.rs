// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A device without hardware, held by a hand that follows a path whatever the force.

use palpate_field::Vector;

use crate::device::{Device, DeviceLost, DeviceProfile, PointState};
use crate::error::HapticsError;
use crate::hand_path::HandPath;

/// A device whose points follow recorded hand paths.
///
/// Deterministic: it knows no clock but the servo's. The forces written last can be asked for.
///
/// # Examples
///
/// ```
/// use palpate_field::Vector;
/// use palpate_haptics::{Device, HandPath, Interpolation, PointState, RecordedDevice};
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
pub struct RecordedDevice<const D: usize> {
    paths: Vec<HandPath<D>>,
    forces: Vec<Vector<f64, D>>,
    profile: DeviceProfile,
}

impl<const D: usize> RecordedDevice<D> {
    /// A device with one contact point for each path.
    ///
    /// # Errors
    ///
    /// [`HapticsError::NoContactPoint`] if there are no paths.
    pub fn new(paths: Vec<HandPath<D>>) -> Result<Self, HapticsError> {
        if paths.is_empty() {
            return Err(HapticsError::NoContactPoint);
        }
        let forces = vec![Vector::ZERO; paths.len()];
        Ok(Self { paths, forces, profile: DeviceProfile::unlimited("recorded") })
    }

    /// The same with what a real device can do.
    #[must_use]
    pub fn with_profile(self, profile: DeviceProfile) -> Self {
        Self { profile, ..self }
    }

    /// The forces written last [N].
    #[must_use]
    pub fn forces(&self) -> &[Vector<f64, D>] {
        &self.forces
    }

    /// The time at which the last path ends [s].
    #[must_use]
    pub fn end(&self) -> f64 {
        self.paths.iter().map(|p| p.start() + p.duration()).fold(0.0, f64::max)
    }
}

impl<const D: usize> Device<D> for RecordedDevice<D> {
    fn points(&self) -> usize {
        self.paths.len()
    }

    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }

    fn read(&mut self, time: f64, points: &mut [PointState<D>]) -> Result<(), DeviceLost> {
        for (point, path) in points.iter_mut().zip(&self.paths) {
            *point = path.state_at(time);
        }
        Ok(())
    }

    fn write(&mut self, forces: &[Vector<f64, D>]) -> Result<(), DeviceLost> {
        for (kept, force) in self.forces.iter_mut().zip(forces) {
            *kept = *force;
        }
        Ok(())
    }
}
