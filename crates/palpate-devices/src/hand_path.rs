// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The motion of a hand, as recorded samples.

use crate::error::DeviceError;
use palpate_field::{LARGEST_LENGTH, Point, Vector};

use palpate_haptics::PointState;

/// The interpolation between two samples of a hand path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight, at constant speed; the velocity jumps at samples.
    Linear,
    /// Cubic, with continuous velocity: the slope at each sample is that of the parabola
    /// through the sample and its neighbours (Bessel's tangents).
    #[default]
    Smooth,
}

/// The position of a hand over time: at least two samples at increasing times.
///
/// Before its first sample and after its last one the hand rests there.
///
/// # Examples
///
/// ```
/// use palpate_field::Vector;
/// use palpate_devices::{HandPath, Interpolation};
///
/// # fn main() -> Result<(), palpate_devices::DeviceError> {
/// let path = HandPath::new(
///     vec![0.0, 1.0, 3.0],
///     vec![Vector([0.0, 0.0]), Vector([2.0, 0.0]), Vector([2.0, 4.0])],
///     Interpolation::Linear,
/// )?;
/// let state = path.state_at(2.0);
/// assert_eq!(state.position, Vector([2.0, 2.0]));
/// assert_eq!(state.velocity, Vector([0.0, 2.0]));
/// assert_eq!(path.duration(), 3.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HandPath<const D: usize> {
    times: Vec<f64>,
    positions: Vec<Point<D>>,
    velocities: Vec<Vector<f64, D>>,
    interpolation: Interpolation,
}

impl<const D: usize> HandPath<D> {
    /// The path through `positions` [m] at `times` [s].
    ///
    /// # Errors
    ///
    /// If there are fewer than two samples, not as many times as positions, a number is not
    /// finite or exceeds 1e15, or the times do not increase.
    pub fn new(
        times: Vec<f64>,
        positions: Vec<Point<D>>,
        interpolation: Interpolation,
    ) -> Result<Self, DeviceError> {
        let (count, paired) = (times.len(), positions.len());
        if count != paired {
            return Err(DeviceError::UnpairedSamples { times: count, positions: paired });
        }
        if count < 2 {
            return Err(DeviceError::TooFewSamples { count });
        }
        let samples = times.iter().zip(&positions);
        for (index, (&time, position)) in samples.enumerate() {
            let mut numbers = std::iter::once(time).chain(position.0);
            // Written so that NaN fails.
            let is_usable = |x: &f64| x.abs() <= LARGEST_LENGTH;
            if let Some(value) = numbers.find(|x| !is_usable(x)) {
                return Err(DeviceError::SampleNotFinite { index, value });
            }
        }
        for (index, pair) in times.windows(2).enumerate() {
            let (previous, time) = (pair[0], pair[1]);
            if time <= previous {
                let index = index + 1;
                return Err(DeviceError::TimeNotIncreasing { index, previous, time });
            }
        }
        let velocities = bessel_tangents(&times, &positions);
        Ok(Self { times, positions, velocities, interpolation })
    }

    /// The times of the samples [s].
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The positions of the samples [m].
    #[must_use]
    pub fn positions(&self) -> &[Point<D>] {
        &self.positions
    }

    /// The time of the first sample [s].
    #[must_use]
    pub fn start(&self) -> f64 {
        self.times[0]
    }

    /// The time from the first sample to the last [s].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }

    /// Position and velocity of the hand at `time` [s].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; a binary search.
    #[must_use]
    pub fn state_at(&self, time: f64) -> PointState<D> {
        let last = self.times.len() - 1;
        let after = self.times.partition_point(|t| *t <= time);
        if after == 0 {
            return PointState::at_rest(self.positions[0]);
        }
        if after > last {
            return PointState::at_rest(self.positions[last]);
        }
        let before = after - 1;
        let span = self.times[after] - self.times[before];
        let part = (time - self.times[before]) / span;
        let from = self.positions[before];
        let way = self.positions[after] - from;
        match self.interpolation {
            Interpolation::Linear => {
                PointState { position: from + way * part, velocity: way * (1.0 / span) }
            }
            Interpolation::Smooth => {
                let start = self.velocities[before] * span;
                let end = self.velocities[after] * span;
                Cubic { from, way, start, end }.at(part, span)
            }
        }
    }

    /// The same path with every position mapped, as from the world to a device; smooth between
    /// its samples.
    ///
    /// # Errors
    ///
    /// [`DeviceError::SampleNotFinite`] if the map leads beyond any scene.
    pub fn mapped(&self, map: impl Fn(Point<D>) -> Point<D>) -> Result<Self, DeviceError> {
        let positions = self.positions().iter().map(|point| map(*point)).collect();
        Self::new(self.times().to_vec(), positions, Interpolation::Smooth)
    }
}

/// The cubic from `from` over `way`, whose derivatives by the part `u` of its time are `start`
/// and `end`:
///
/// ```text
/// p = from + u s + u² (3w − 2s − e) + u³ (s + e − 2w)
/// ```
struct Cubic<const D: usize> {
    from: Point<D>,
    way: Vector<f64, D>,
    start: Vector<f64, D>,
    end: Vector<f64, D>,
}

impl<const D: usize> Cubic<D> {
    /// Position and velocity at the part `u` of its time `span` [s].
    fn at(&self, u: f64, span: f64) -> PointState<D> {
        let Self { from, way, start, end } = *self;
        let square = way * 3.0 - start * 2.0 - end;
        let cube = start + end - way * 2.0;
        let position = from + (start + (square + cube * u) * u) * u;
        let velocity = (start + (square * 2.0 + cube * (3.0 * u)) * u) * (1.0 / span);
        PointState { position, velocity }
    }
}

/// At each sample the slope of the parabola through it and its neighbours; zero at both ends,
/// where the hand rests.
fn bessel_tangents<const D: usize>(
    times: &[f64],
    positions: &[Point<D>],
) -> Vec<Vector<f64, D>> {
    let mut tangents = vec![Vector::ZERO; times.len()];
    for i in 1..times.len() - 1 {
        let (left, right) = (times[i] - times[i - 1], times[i + 1] - times[i]);
        let slope_left = (positions[i] - positions[i - 1]) * (1.0 / left);
        let slope_right = (positions[i + 1] - positions[i]) * (1.0 / right);
        let part = left / (left + right);
        tangents[i] = slope_left * (1.0 - part) + slope_right * part;
    }
    tangents
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(times: &[f64], xs: &[f64]) -> Result<HandPath<2>, DeviceError> {
        let positions = xs.iter().map(|x| Vector([*x, 0.0])).collect();
        HandPath::new(times.to_vec(), positions, Interpolation::Smooth)
    }

    #[test]
    fn wrong_paths_are_refused_with_their_numbers() {
        assert_eq!(path(&[0.0], &[0.0]), Err(DeviceError::TooFewSamples { count: 1 }));
        let unpaired = DeviceError::UnpairedSamples { times: 2, positions: 1 };
        assert_eq!(path(&[0.0, 1.0], &[0.0]), Err(unpaired));
        let backwards = DeviceError::TimeNotIncreasing { index: 2, previous: 1.0, time: 1.0 };
        assert_eq!(path(&[0.0, 1.0, 1.0], &[0.0; 3]), Err(backwards));
        let error = path(&[0.0, 1.0], &[0.0, f64::NAN]).unwrap_err();
        assert!(matches!(error, DeviceError::SampleNotFinite { index: 1, .. }));
        assert!(path(&[0.0, f64::INFINITY], &[0.0, 0.0]).is_err());
    }

    #[test]
    fn a_smooth_path_follows_a_parabola() {
        let times = [0.0, 1.0, 2.0, 4.0];
        let path = path(&times, &times.map(|t| t * t)).unwrap();
        let state = path.state_at(1.5);
        assert_eq!((state.position, state.velocity), (Vector([2.25, 0.0]), Vector([3.0, 0.0])));
    }

    #[test]
    fn a_hand_rests_before_and_after_its_path() {
        let path = path(&[1.0, 2.0], &[3.0, 5.0]).unwrap();
        assert_eq!(path.state_at(0.0), PointState::at_rest(Vector([3.0, 0.0])));
        assert_eq!(path.state_at(9.0), PointState::at_rest(Vector([5.0, 0.0])));
        assert_eq!(path.state_at(2.0), PointState::at_rest(Vector([5.0, 0.0])));
    }

    #[test]
    fn the_velocity_is_the_derivative_of_the_position() {
        let path = path(&[0.0, 0.3, 0.5, 1.1, 1.2], &[0.0, 1.0, -1.0, 2.0, 0.5]).unwrap();
        let step = 1e-6;
        for i in 1..120 {
            let time = 0.01 * f64::from(i) - 0.0031;
            let (before, after) = (path.state_at(time - step), path.state_at(time + step));
            let slope = (after.position - before.position) * (0.5 / step);
            assert!((slope - path.state_at(time).velocity).norm() < 1e-4, "{time}");
        }
    }
}
