// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A device without hardware: a hand that follows a path, whatever the force.

use palpate_field::Vector;

use crate::device::{Device, DeviceLimits, DeviceLost, PointState};
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
/// use palpate_haptics::{Device, HandPath, Interpolation, PointState, SimulatedDevice};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ends = vec![Vector([0.0, 0.5, 0.0]), Vector([0.0, 0.0, 0.0])];
/// let path = HandPath::new(vec![0.0, 2.0], ends, Interpolation::Linear)?;
/// let mut device = SimulatedDevice::new(vec![path])?;
/// let mut points = [PointState::at_rest(Vector::ZERO)];
/// device.read(1.0, &mut points)?;
/// assert_eq!(points[0].position, Vector([0.0, 0.25, 0.0]));
/// assert_eq!(points[0].velocity, Vector([0.0, -0.25, 0.0]));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct SimulatedDevice<const D: usize> {
    paths: Vec<HandPath<D>>,
    forces: Vec<Vector<f64, D>>,
    limits: DeviceLimits,
}

impl<const D: usize> SimulatedDevice<D> {
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
        Ok(Self { paths, forces, limits: UNLIMITED })
    }

    /// The same with the limits of a real device.
    #[must_use]
    pub fn with_limits(self, limits: DeviceLimits) -> Self {
        Self { limits, ..self }
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

/// A hand that follows its path feels no force, so none needs a limit.
const UNLIMITED: DeviceLimits = DeviceLimits {
    name: "simulated",
    max_force: f64::INFINITY,
    max_stiffness: f64::INFINITY,
    max_damping: f64::INFINITY,
    workspace_radius: f64::INFINITY,
};

impl<const D: usize> Device<D> for SimulatedDevice<D> {
    fn points(&self) -> usize {
        self.paths.len()
    }

    fn limits(&self) -> &DeviceLimits {
        &self.limits
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
