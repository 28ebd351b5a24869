// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The motion of a hand, as recorded samples.

use crate::error::SimulationError;
use palpate_field::{LARGEST_LENGTH, Point, Vector};

use palpate_device::PointState;

/// The interpolation between two samples of a hand path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight, at constant speed; the velocity jumps at samples.
    Linear,
    /// Cubic, with continuous velocity: the slope at each sample is that of the parabola
    /// through the sample and its neighbours (Bessel's tangents).
    #[default]
    Smooth,
    /// Cubic, with continuous velocity, and monotone: along each axis the hand stays between the
    /// two samples, however irregular their times are, where [`Smooth`](Self::Smooth) may swing
    /// beyond them. The slope is that of the parabola, but zero at a sample that is higher or
    /// lower than both neighbours, and at most three times the slope to either neighbour
    /// (Fritsch and Carlson, "Monotone Piecewise Cubic Interpolation", SIAM Journal on Numerical
    /// Analysis 17(2), 1980).
    Monotone,
}

/// The position of a hand over time: at least two samples at increasing times.
///
/// Before its first sample and after its last one the hand rests there.
///
/// # Examples
///
/// ```
/// use palpate_field::Vector;
/// use palpate_sim::{HandPath, Interpolation};
///
/// # fn main() -> Result<(), palpate_sim::SimulationError> {
/// let path = HandPath::new(
///     vec![0.0, 1.0, 3.0],
///     vec![Vector([0.0, 0.0, 0.0]), Vector([2.0, 0.0, 0.0]), Vector([2.0, 4.0, 0.0])],
///     Interpolation::Linear,
/// )?;
/// let state = path.state_at(2.0);
/// assert_eq!(state.position, Vector([2.0, 2.0, 0.0]));
/// assert_eq!(state.velocity, Vector([0.0, 2.0, 0.0]));
/// assert_eq!(path.duration(), 3.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HandPath {
    times: Vec<f64>,
    positions: Vec<Point<3>>,
    velocities: Vec<Vector<f64, 3>>,
    interpolation: Interpolation,
}

impl HandPath {
    /// The path through `positions` [m] at `times` [s].
    ///
    /// # Errors
    ///
    /// If there are fewer than two samples, not as many times as positions, a number is not
    /// finite or exceeds 1e15, or the times do not increase.
    #[inline(never)]
    pub fn new(
        times: Vec<f64>,
        positions: Vec<Point<3>>,
        interpolation: Interpolation,
    ) -> Result<Self, SimulationError> {
        let (count, paired) = (times.len(), positions.len());
        if count != paired {
            return Err(SimulationError::UnpairedSamples { times: count, positions: paired });
        }
        if count < 2 {
            return Err(SimulationError::TooFewSamples { count });
        }
        let samples = times.iter().zip(&positions);
        for (index, (&time, position)) in samples.enumerate() {
            let mut numbers = std::iter::once(time).chain(position.0);
            // Written so that NaN fails.
            let is_usable = |x: &f64| x.abs() <= LARGEST_LENGTH;
            if let Some(value) = numbers.find(|x| !is_usable(x)) {
                return Err(SimulationError::SampleNotFinite { index, value });
            }
        }
        for (index, pair) in times.windows(2).enumerate() {
            let (previous, time) = (pair[0], pair[1]);
            if time <= previous {
                let index = index + 1;
                return Err(SimulationError::TimeNotIncreasing { index, previous, time });
            }
        }
        let mut velocities = bessel_tangents(&times, &positions);
        if interpolation == Interpolation::Monotone {
            make_monotone(&mut velocities, &times, &positions);
        }
        Ok(Self { times, positions, velocities, interpolation })
    }

    /// The times of the samples [s].
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The positions of the samples [m].
    #[must_use]
    pub fn positions(&self) -> &[Point<3>] {
        &self.positions
    }

    /// The interpolation between samples.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
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
    #[inline(never)]
    pub fn state_at(&self, time: f64) -> PointState {
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
            Interpolation::Smooth | Interpolation::Monotone => {
                let start = self.velocities[before] * span;
                let end = self.velocities[after] * span;
                Cubic { from, way, start, end }.at(part, span)
            }
        }
    }

    /// The same path seen through an affine `map`, as from the world to a device.
    ///
    /// # Errors
    ///
    /// [`SimulationError::SampleNotFinite`] if the map leads beyond any scene.
    pub fn mapped(&self, map: impl Fn(Point<3>) -> Point<3>) -> Result<Self, SimulationError> {
        let positions: Vec<_> = self.positions.iter().map(|point| map(*point)).collect();
        let mut mapped = Self::new(self.times.clone(), positions, self.interpolation)?;
        // A path is monotone along the axes in which it was made, which the map may turn: its
        // velocities are mapped with it, not found anew.
        if self.interpolation == Interpolation::Monotone {
            let places = self.positions.iter().zip(&self.velocities);
            for ((to, from), (place, velocity)) in
                mapped.velocities.iter_mut().zip(&mapped.positions).zip(places)
            {
                *to = map(*place + *velocity) - *from;
            }
        }
        Ok(mapped)
    }
}

/// The cubic from `from` over `way`, whose derivatives by the part `u` of its time are `start`
/// and `end`:
///
/// ```text
/// p = from + u s + u² (3w − 2s − e) + u³ (s + e − 2w)
/// ```
struct Cubic {
    from: Point<3>,
    way: Vector<f64, 3>,
    start: Vector<f64, 3>,
    end: Vector<f64, 3>,
}

impl Cubic {
    /// Position and velocity at the part `u` of its time `span` [s].
    fn at(&self, u: f64, span: f64) -> PointState {
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
fn bessel_tangents(times: &[f64], positions: &[Point<3>]) -> Vec<Vector<f64, 3>> {
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

/// Limits tangents so that each axis of the cubic is monotone between two samples.
///
/// With the tangents `a d` and `b d` at the ends of a piece of slope `d`, the square
/// `0 ≤ a, b ≤ 3` is enough: it is part of the region of Fritsch and Carlson (1980, section 3).
fn make_monotone(tangents: &mut [Vector<f64, 3>], times: &[f64], positions: &[Point<3>]) {
    const STEEPEST: f64 = 3.0;
    let slope = |from: usize, axis: usize| {
        (positions[from + 1][axis] - positions[from][axis]) / (times[from + 1] - times[from])
    };
    for (i, tangent) in tangents.iter_mut().enumerate().take(times.len() - 1).skip(1) {
        for (axis, tangent) in tangent.0.iter_mut().enumerate() {
            let (left, right) = (slope(i - 1, axis), slope(i, axis));
            let is_extreme = left * right <= 0.0;
            let most = if is_extreme { 0.0 } else { STEEPEST * left.abs().min(right.abs()) };
            *tangent = tangent.clamp(-most, most);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(times: &[f64], xs: &[f64]) -> Result<HandPath, SimulationError> {
        let positions = xs.iter().map(|x| Vector([*x, 0.0, 0.0])).collect();
        HandPath::new(times.to_vec(), positions, Interpolation::Smooth)
    }

    #[test]
    fn wrong_paths_are_refused_with_their_numbers() {
        assert_eq!(path(&[0.0], &[0.0]), Err(SimulationError::TooFewSamples { count: 1 }));
        let unpaired = SimulationError::UnpairedSamples { times: 2, positions: 1 };
        assert_eq!(path(&[0.0, 1.0], &[0.0]), Err(unpaired));
        let backwards =
            SimulationError::TimeNotIncreasing { index: 2, previous: 1.0, time: 1.0 };
        assert_eq!(path(&[0.0, 1.0, 1.0], &[0.0; 3]), Err(backwards));
        let error = path(&[0.0, 1.0], &[0.0, f64::NAN]).unwrap_err();
        assert!(matches!(error, SimulationError::SampleNotFinite { index: 1, .. }));
        assert!(path(&[0.0, f64::INFINITY], &[0.0, 0.0]).is_err());
    }

    #[test]
    fn a_smooth_path_follows_a_parabola() {
        let times = [0.0, 1.0, 2.0, 4.0];
        let path = path(&times, &times.map(|t| t * t)).unwrap();
        let state = path.state_at(1.5);
        assert_eq!(
            (state.position, state.velocity),
            (Vector([2.25, 0.0, 0.0]), Vector([3.0, 0.0, 0.0]))
        );
    }

    fn monotone(times: &[f64], xs: &[f64]) -> HandPath {
        let positions = xs.iter().map(|x| Vector([*x, -2.0 * x, 0.0])).collect();
        HandPath::new(times.to_vec(), positions, Interpolation::Monotone).unwrap()
    }

    /// Irregular samples: each number is drawn from the bits of the one before (Marsaglia's
    /// xorshift), times are from 1 ms to 1 s apart.
    fn irregular(seed: u64) -> (Vec<f64>, Vec<f64>) {
        let mut bits = seed;
        let mut draw = || {
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            (bits >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut time = 0.0;
        let sample = |_| {
            time += 10.0_f64.powf(-3.0 * draw());
            (time, 0.04 * draw() - 0.01)
        };
        (0..20).map(sample).unzip()
    }

    #[test]
    fn a_monotone_path_stays_between_two_samples() {
        let mut has_smooth_left = false;
        for seed in 1..200 {
            let (times, xs) = irregular(seed);
            let path = monotone(&times, &xs);
            let smooth = self::path(&times, &xs).unwrap();
            for (i, pair) in xs.windows(2).enumerate() {
                // Half a dozen roundings of numbers below 0.1.
                let (least, most) =
                    (pair[0].min(pair[1]) - 1e-16, pair[0].max(pair[1]) + 1e-16);
                for step in 0..=50 {
                    let part = f64::from(step) / 50.0;
                    let time = times[i] + (times[i + 1] - times[i]) * part;
                    let Vector([x, y, _]) = path.state_at(time).position;
                    assert!(
                        (least..=most).contains(&x),
                        "seed {seed}, {time} s: {x} of {pair:?}"
                    );
                    assert!((y + 2.0 * x).abs() < 1e-15, "seed {seed}, {time} s: {x}, {y}");
                    let x = smooth.state_at(time).position[0];
                    has_smooth_left |= !(least - 0.01..=most + 0.01).contains(&x);
                }
            }
        }
        assert!(has_smooth_left, "these samples would not show an overshoot");
    }

    #[test]
    fn a_monotone_path_has_a_continuous_velocity() {
        for seed in 1..200 {
            let (times, xs) = irregular(seed);
            let path = monotone(&times, &xs);
            assert_eq!(path.state_at(times[0]).velocity, Vector::ZERO);
            for time in &times[1..] {
                let before = path.state_at(time.next_down()).velocity;
                let after = path.state_at(*time).velocity;
                // The acceleration is at most 24 w / T² = 2.2e6 m/s², with tangents of three times
                // w / T; the times are 1.8e-15 s apart at most.
                assert!((after - before).norm() < 4e-9, "seed {seed}, {time} s: {before:?}");
            }
        }
    }

    #[test]
    fn slopes_of_a_monotone_path_are_limited_by_their_neighbours() {
        let speeds = |xs: &[f64]| -> Vec<f64> {
            let path = monotone(&[0.0, 1.0, 2.0, 3.0], xs);
            (0..4).map(|time| path.state_at(f64::from(time)).velocity[0]).collect()
        };
        // The parabolas have 4.5 and 1; three times the slope of 1 is the most.
        assert_eq!(speeds(&[0.0, 8.0, 9.0, 10.0]), [0.0, 3.0, 1.0, 0.0]);
        assert_eq!(speeds(&[0.0, -8.0, -9.0, -10.0]), [0.0, -3.0, -1.0, 0.0]);
        // At a peak, and where the hand rests, it stops.
        assert_eq!(speeds(&[0.0, 2.0, 1.0, 1.0]), [0.0; 4]);
    }

    #[test]
    fn a_path_that_is_mapped_is_the_same_path() {
        let (times, xs) = irregular(7);
        let turn = palpate_field::Rotation::from_angle(0.7).unwrap().in_space();
        let map = |point: Point<3>| turn.rotate(point) * 0.25 + Vector([1.0, -2.0, 0.0]);
        for interpolation in
            [Interpolation::Linear, Interpolation::Smooth, Interpolation::Monotone]
        {
            let positions = xs.iter().map(|x| Vector([*x, x * x, 0.0])).collect();
            let path = HandPath::new(times.clone(), positions, interpolation).unwrap();
            let mapped = path.mapped(map).unwrap();
            for i in 0..200 {
                let time = times[19] * f64::from(i) / 200.0;
                let (here, there) = (path.state_at(time), mapped.state_at(time));
                assert!((there.position - map(here.position)).norm() < 1e-14, "{time} s");
                let velocity = turn.rotate(here.velocity) * 0.25;
                assert!((there.velocity - velocity).norm() < 1e-11, "{time} s");
            }
        }
    }

    #[test]
    fn a_hand_rests_before_and_after_its_path() {
        let path = path(&[1.0, 2.0], &[3.0, 5.0]).unwrap();
        assert_eq!(path.state_at(0.0), PointState::at_rest(Vector([3.0, 0.0, 0.0])));
        assert_eq!(path.state_at(9.0), PointState::at_rest(Vector([5.0, 0.0, 0.0])));
        assert_eq!(path.state_at(2.0), PointState::at_rest(Vector([5.0, 0.0, 0.0])));
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
