// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The shell of a shape: exact for balls and capsules, points on the surface for other shapes.

use palpate_field::kernel::Argument;
use palpate_field::node::Primitive;
use palpate_field::{Node, Point, Pose, Shape, SpaceShape, Vector};

use super::Shell;
use crate::error::HapticsError;

/// The spacing of the balls of a capsule, as a part of its radius: its sides are then at most 3
/// % of the radius away from the balls.
const SPACING: f64 = 0.5;

/// The most balls of a capsule; those of a capsule thinner than a hair are farther apart.
const MOST_BALLS: f64 = 512.0;

impl Shell {
    /// The shell of `shape`, thickened by `radius` [m].
    ///
    /// A ball or a capsule, placed or not, becomes an exact shell; any other shape becomes
    /// `points` points on its surface ([`Shell::from_field`]).
    ///
    /// Not for the servo: it allocates.
    ///
    /// # Errors
    ///
    /// As [`Shell::from_field`], [`Shell::ball`] and [`Shell::capsule`].
    ///
    /// ```
    /// use palpate_field::Shape;
    /// use palpate_haptics::Shell;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let rod = Shape::<3>::capsule(0.004, 0.1)?.translated([0.0, 0.05, 0.0])?;
    /// let shell = Shell::of_shape(&rod, 500, 0.0)?;
    /// assert!(shell.points().iter().all(|point| point.radius == 0.004));
    /// # Ok(())
    /// # }
    /// ```
    #[inline(never)]
    pub fn of_shape(
        shape: impl Into<SpaceShape>,
        points: usize,
        radius: f64,
    ) -> Result<Self, HapticsError> {
        let shape = shape.into();
        match shape.flat() {
            Some(flat) => Ok(of_shape(flat, points, radius)?.in_plane()),
            None => of_shape(shape.shape(), points, radius),
        }
    }
}

fn of_shape<const D: usize>(
    shape: &Shape<D>,
    points: usize,
    radius: f64,
) -> Result<Shell, HapticsError> {
    match segment_of(shape, Pose::identity()) {
        Some((ends, own_radius)) => rod(ends.map(Vector::in_space), own_radius + radius),
        None => Shell::from_field(shape, points, radius),
    }
}

/// All points within a radius [m] of a segment.
fn rod([from, to]: [Point<3>; 2], radius: f64) -> Result<Shell, HapticsError> {
    let length = (to - from).norm();
    if length == 0.0 && from == Vector::ZERO {
        return Shell::ball(radius);
    }
    let steps = (length / (SPACING * radius)).ceil().clamp(1.0, MOST_BALLS - 1.0);
    Shell::capsule([from, to], radius, steps as usize + 1)
}

/// The segment and the radius of a ball or a capsule, placed by a pose; `None` for other
/// shapes.
fn segment_of<const D: usize>(
    shape: &Shape<D>,
    world_from_shape: Pose<D>,
) -> Option<([Point<D>; 2], f64)> {
    match shape.node() {
        Node::Placed { pose, of } => segment_of(of, world_from_shape * *pose),
        Node::Primitive(ball) if ball.name() == "ball" => {
            Some(([world_from_shape.translation; 2], number(ball, "radius")?))
        }
        Node::Primitive(capsule) if capsule.name() == "capsule" => {
            let radius = number(capsule, "radius")?;
            let half = Vector::unit(1) * (0.5 * number(capsule, "height")? - radius);
            Some(([-half, half].map(|end| world_from_shape.transform_point(end)), radius))
        }
        _ => None,
    }
}

fn number<const D: usize>(primitive: &Primitive<D>, parameter: &str) -> Option<f64> {
    match primitive.argument(parameter) {
        Some(Argument::Number(number)) => Some(*number),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use palpate_field::Rotation;

    use super::*;

    #[test]
    fn a_ball_and_a_capsule_are_felt_as_they_are() {
        let ball = Shell::of_shape(Shape::<3>::ball(0.02).unwrap(), 500, 0.001).unwrap();
        let radii: Vec<_> = ball.points().iter().map(|point| point.radius).collect();
        assert_eq!(radii, [0.021]);
        let up =
            Rotation::from_axis_angle(Vector([1.0, 0.0, 0.0]), std::f64::consts::FRAC_PI_2);
        let rod =
            Shape::<3>::capsule(0.01, 0.12).unwrap().translated([0.0, 0.05, 0.0]).unwrap();
        let rod = rod.rotated(up.unwrap()).unwrap();
        let rod = Shell::of_shape(&rod, 500, 0.0).unwrap();
        assert_eq!(rod.points().len(), 21);
        assert!(rod.points().iter().all(|point| point.centre[1].abs() < 1e-16));
        let heights = || rod.points().iter().map(|point| point.centre[2]);
        assert!(heights().fold(f64::INFINITY, f64::min).abs() < 1e-16);
        assert!((heights().fold(0.0, f64::max) - 0.1).abs() < 1e-16);
        // √(r² + (r/4)²) − r
        assert!(rod.resolution(21) < 0.032 * 0.01);
    }

    #[test]
    fn what_is_neither_is_a_field() {
        let ring = Shape::<3>::torus(0.02, 0.005).unwrap();
        assert_eq!(Shell::of_shape(&ring, 500, 0.0).unwrap().points().len(), 500);
        let grown = Shape::<3>::ball(0.01).unwrap().offset(0.001).unwrap();
        let grown = Shell::of_shape(&grown, 500, 0.002).unwrap();
        assert_eq!(grown.points().len(), 500);
        assert!(grown.points().iter().all(|point| point.radius == 0.002));
    }

    /// The box of a segment has no faces: the number of samples was infinite.
    #[test]
    fn a_segment_is_felt_along_its_length() {
        let segment = Shape::<3>::segment([0.0; 3], [0.0, 0.1, 0.0], 0.0).unwrap();
        for radius in [0.0, 0.002] {
            let shell = Shell::of_shape(&segment, 100, radius).unwrap();
            assert!(shell.points().iter().all(|point| point.centre[0].abs() < 1e-9));
            let heights = || shell.points().iter().map(|point| point.centre[1]);
            assert!(heights().fold(f64::INFINITY, f64::min) < 0.002);
            assert!(heights().fold(0.0, f64::max) > 0.098);
        }
    }
}
