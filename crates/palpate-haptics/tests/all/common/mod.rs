// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes and hands that several tests use.

pub(crate) mod nearest;
pub(crate) mod tools;
pub(crate) mod wild;

use std::ops::Deref;

use arbitrary::Unstructured;
use palpate_device::{DeviceProfile, PointState, TurnState};
use palpate_field::kernel::{Ball, Cuboid, HalfSpace, Torus};
use palpate_field::{CustomField, Point, Pose, Promise, Rotation, Shape, SpaceShape, Vector};
use palpate_haptics::{
    Bodies, Body, Following, Probe, Protection, Proxy, Renderer, Servo, Surface, Unprotected,
};
pub(crate) use palpate_testkit::cases::each as cases;

/// A ball of `radius`.
pub(crate) fn ball<const D: usize>(radius: f64) -> Shape<D> {
    Shape::from_kernel(Ball::new(radius).unwrap())
}

/// A box of full edge lengths.
pub(crate) fn cuboid<const D: usize>(edges: [f64; D]) -> Shape<D> {
    Shape::from_kernel(Cuboid::new(Vector(edges)).unwrap())
}

/// All points with `normal·p ≤ height`.
pub(crate) fn half_space<const D: usize>(normal: [f64; D], height: f64) -> Shape<D> {
    Shape::from_kernel(HalfSpace::new(Vector(normal), height).unwrap())
}

/// A ring about the y axis.
pub(crate) fn torus(major: f64, minor: f64) -> Shape<3> {
    Shape::from_kernel(Torus::new(major, minor).unwrap())
}

/// `factor` times the distances of another shape.
#[derive(Debug)]
pub(crate) struct Scaled<const D: usize> {
    pub(crate) shape: Shape<D>,
    pub(crate) factor: f64,
    pub(crate) promise: Promise<D>,
}

impl<const D: usize> CustomField<D> for Scaled<D> {
    fn distance(&self, p: Point<D>) -> f64 {
        self.factor * self.shape.distance(p)
    }
    fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        let (distance, gradient) = self.shape.distance_gradient(p);
        (self.factor * distance, gradient * self.factor)
    }
    fn promise(&self) -> &Promise<D> {
        &self.promise
    }
}

/// A shape whose values are `factor` times as large, and that promises no more than a Lipschitz
/// constant of `lipschitz`.
pub(crate) fn scaled<const D: usize>(
    shape: &Shape<D>,
    factor: f64,
    lipschitz: f64,
) -> Shape<D> {
    let promise = Promise::lipschitz(shape.promise().bounds, lipschitz);
    Shape::custom(Scaled { shape: shape.clone(), factor, promise })
}

/// The same servo behind a device that sees steps, with a safety chain.
pub(crate) fn protected(servo: Servo<Unprotected>) -> Servo {
    let profile = DeviceProfile {
        max_force: 4.0,
        continuous_force: 1.5,
        max_force_rate: 2000.0,
        mass: 0.05,
        least_damping: 0.3,
        friction: 0.1,
        encoder_step: 1e-5,
        ..DeviceProfile::unlimited("protected")
    };
    servo.protected(&Protection::new(profile)).unwrap()
}

/// What several tests do with either kind of servo.
pub(crate) trait AnyServo: Deref<Target = Renderer> {
    fn step(&mut self, states: &[PointState]);
    fn set_turn(&mut self, turn: Option<TurnState>);
    fn set_pose(&mut self, body: usize, world_from_body: Pose<3>);
    fn swap_bodies(&mut self, bodies: Bodies);
}

impl AnyServo for Servo {
    fn step(&mut self, states: &[PointState]) {
        self.step(states);
    }
    fn set_turn(&mut self, turn: Option<TurnState>) {
        self.set_turn(turn);
    }
    fn set_pose(&mut self, body: usize, world_from_body: Pose<3>) {
        self.set_pose(body, world_from_body);
    }
    fn swap_bodies(&mut self, bodies: Bodies) {
        let mut bodies = self.accept(bodies).unwrap();
        self.replace_bodies(&mut bodies).unwrap();
    }
}

impl AnyServo for Servo<Unprotected> {
    fn step(&mut self, states: &[PointState]) {
        self.step(states);
    }
    fn set_turn(&mut self, turn: Option<TurnState>) {
        self.set_turn(turn);
    }
    fn set_pose(&mut self, body: usize, world_from_body: Pose<3>) {
        self.set_pose(body, world_from_body);
    }
    fn swap_bodies(&mut self, bodies: Bodies) {
        drop(self.replace_bodies(bodies));
    }
}

/// The same servo for a device without limits: what it wants is given, from the first tick on.
pub(crate) fn without_limits(servo: Servo<Unprotected>) -> Servo {
    let protection = Protection::new(DeviceProfile::unlimited("without limits"));
    servo.protected(&protection.with(|s| s.rise_rate = f64::INFINITY)).unwrap()
}

pub(crate) fn proxy(radius: f64) -> Proxy {
    Proxy::new(Probe::new(radius).unwrap())
}

/// A proxy that knows one shape.
pub(crate) trait FollowShape {
    fn follow_shape(&mut self, shape: impl Into<SpaceShape>, device: Point<3>) -> Following;
}

impl FollowShape for Proxy {
    fn follow_shape(&mut self, shape: impl Into<SpaceShape>, device: Point<3>) -> Following {
        self.follow(&Bodies::from(shape.into()).everything(), device)
    }
}

/// One body with a surface.
pub(crate) fn body(shape: impl Into<SpaceShape>, surface: Surface) -> Bodies {
    let shape: SpaceShape = shape.into();
    Bodies::new(vec![Body::new(shape, surface).unwrap()]).unwrap()
}

/// Follows a straight line in `ticks` ticks; the last tick.
pub(crate) fn stroke(
    proxy: &mut Proxy,
    shape: impl Into<SpaceShape>,
    (from, to): (Point<3>, Point<3>),
    ticks: u32,
) -> Following {
    let shape: SpaceShape = shape.into();
    let mut last = proxy.follow_shape(shape.clone(), from);
    for tick in 1..=ticks {
        let part = f64::from(tick) / f64::from(ticks);
        last = proxy.follow_shape(shape.clone(), from + (to - from) * part);
    }
    last
}

/// A number in [−1, 1].
pub(crate) fn unit(u: &mut Unstructured<'_>) -> arbitrary::Result<f64> {
    Ok(f64::from(u.int_in_range(-1_000_000..=1_000_000)?) * 1e-6)
}

/// A vector in the cube [−1, 1]^D of the first D axes.
pub(crate) fn vector<const D: usize>(
    u: &mut Unstructured<'_>,
) -> arbitrary::Result<Vector<f64, D>> {
    let mut v = [0.0; D];
    for component in &mut v {
        *component = unit(u)?;
    }
    Ok(Vector(v))
}

/// A unit vector.
pub(crate) fn direction<const D: usize>(
    u: &mut Unstructured<'_>,
) -> arbitrary::Result<Vector<f64, D>> {
    vector(u)?.normalized().ok_or(arbitrary::Error::IncorrectFormat)
}

/// A rotation of space.
pub(crate) fn rotation(u: &mut Unstructured<'_>) -> arbitrary::Result<Rotation<3>> {
    let quaternion = [unit(u)?, unit(u)?, unit(u)?, unit(u)?];
    Rotation::from_quaternion(quaternion).map_err(|_| arbitrary::Error::IncorrectFormat)
}
