// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that can be touched: each has a surface, and each may move.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{
    BoundingBall, Bounds, LARGEST_LENGTH, Point, Pose, Quality, Rounding, Screw, Shape,
    SpaceShape, Vector,
};

use crate::error::HapticsError;
use crate::event::Reaction;
use crate::surface::{Passing, Surface};

/// Rounding errors of mapping a point into body coordinates, in units of rounding per metre
/// from the origins.
const PLACE_ROUNDINGS: f64 = 8.0;

/// A shape with a pose and a surface.
///
/// A planar shape is felt in space as endless along z ([`Shape::endless`]).
#[derive(Clone, Debug)]
pub struct Body {
    shape: SpaceShape,
    surface: Surface,
    world_from_body: Pose<3>,
    body_from_world: Pose<3>,
    /// The pose in the tick before; the present pose if the body did not move.
    world_from_before: Pose<3>,
    has_moved: bool,
    /// The rest of a motion that takes several ticks.
    travel: Option<Travel>,
    /// Whether the pose differs from the identity.
    is_placed: bool,
    /// The bounding ball in world coordinates; `None` for an unbounded shape. That of a planar shape
    /// is the cross-section of the endless cylinder that bounds it.
    pub(crate) ball: Option<BoundingBall<3>>,
    /// The direction in world coordinates in which a planar shape is endless.
    endless: Option<Vector<f64, 3>>,
    /// Whether the field may be less than the distance to the bounding ball.
    pub(crate) is_below_ball: bool,
    /// The region in which the field's promise holds, in world coordinates; `None` means
    /// everywhere.
    pub(crate) region: Option<BoundingBall<3>>,
    /// The rounding error of the body's distances at points of the world.
    rounding: Rounding,
    /// The distance from the world's origin to the bounding ball [m]; negative if the ball
    /// contains the origin or the shape is unbounded.
    off_origin: f64,
}

/// A motion along a screw that takes several ticks.
#[derive(Clone, Copy, Debug)]
struct Travel {
    screw: Screw<3>,
    /// The share that is done.
    done: f64,
    /// The share of a tick.
    step: f64,
}

impl Body {
    /// A body at the origin.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Shape`] if the shape cannot carry the texture of the surface; as
    /// [`Surface::new`] for a material.
    pub fn new(
        shape: impl Into<SpaceShape>,
        surface: impl TryInto<Surface, Error: Into<HapticsError>>,
    ) -> Result<Self, HapticsError> {
        let (shape, surface) = (shape.into(), surface.try_into().map_err(Into::into)?);
        let surface = surface.on_body(if shape.is_endless() { 2 } else { 3 })?;
        let shape = surface.carved(shape)?;
        Ok(Self::of(shape, surface))
    }

    /// A body whose shape already includes the texture.
    fn of(shape: SpaceShape, surface: Surface) -> Self {
        // A tick must not allocate, so tapes are recorded here.
        shape.prepare();
        let identity = Pose::identity();
        let promise = shape.shape().promise();
        let (is_below_ball, rounding) = (!promise.above_bounds, promise.rounding);
        let mut body = Self {
            shape,
            surface,
            world_from_body: identity,
            body_from_world: identity,
            world_from_before: identity,
            has_moved: false,
            travel: None,
            is_placed: false,
            ball: None,
            endless: None,
            is_below_ball,
            region: None,
            rounding,
            off_origin: f64::NEG_INFINITY,
        };
        body.find_balls();
        body
    }

    /// This body at the pose `world_from_body`.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Pose`] if a number of the pose is not finite or beyond 1e15.
    #[inline(never)]
    pub fn at(mut self, world_from_body: Pose<3>) -> Result<Self, HapticsError> {
        if !is_usable(&world_from_body) {
            return Err(HapticsError::Pose);
        }
        self.place(world_from_body);
        self.settle();
        Ok(self)
    }

    /// The shape in the body's coordinates.
    #[must_use]
    pub fn shape(&self) -> &Shape<3> {
        self.shape.shape()
    }

    /// Bounds of the shape in the body's coordinates, as [`SpaceShape::bounds`].
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds<3>> {
        self.shape.bounds()
    }

    /// Whether the shape is a planar one.
    pub(crate) fn is_endless(&self) -> bool {
        self.shape.is_endless()
    }

    /// The surface: what the body feels like.
    #[must_use]
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// The pose.
    #[must_use]
    pub fn world_from_body(&self) -> &Pose<3> {
        &self.world_from_body
    }

    /// How the crests of the body's height texture pass under a hand of this velocity relative to
    /// the body [m/s], along its surface with this unit normal, both in world coordinates, at
    /// `rate` ticks a second [Hz]. `None` without such a texture.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector};
    /// use palpate_haptics::{Body, Material, Surface, Texture, TextureKind};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let texture = Texture {
    ///     description: None,
    ///     kind: TextureKind::Height,
    ///     amplitude: 1e-4,
    ///     wavelength: 1e-3,
    ///     direction: Some(vec![1.0, 0.0, 0.0]),
    /// };
    /// let grooved = Material { texture: Some(texture), ..Material::default() };
    /// let plate = Body::new(Shape::sphere(1.0)?, Surface::new(&grooved)?)?;
    /// let (hand, up) = (Vector([0.375, -0.1, 0.0]), Vector([0.0, 1.0, 0.0]));
    /// let passing = plate.passing(hand, up, 1000.0).ok_or("no texture")?;
    /// assert!((passing.frequency - 375.0).abs() < 1e-9 && (passing.part - 0.5).abs() < 1e-9);
    /// assert!((passing.wanted_rate() - 1500.0).abs() < 1e-9);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    #[inline(never)]
    pub fn passing(
        &self,
        velocity: Vector<f64, 3>,
        normal: Vector<f64, 3>,
        rate: f64,
    ) -> Option<Passing> {
        let [velocity, normal] = [velocity, normal].map(|v| self.vector_in_body(v));
        self.surface.passing(velocity, normal, rate)
    }

    /// Gives the surface the stiffness that it has on a device which renders at most `most` [N/m].
    pub(crate) fn stiffen(&mut self, most: f64) {
        self.surface = self.surface.on_device(most);
    }

    /// Multiplies the pull of the surface's magnet.
    pub(crate) fn scale_magnet(&mut self, part: f64) {
        let magnet = self.surface.magnet.map(|pull| pull.scaled(part));
        self.surface.magnet = magnet;
    }

    /// Multiplies the amplitude of the surface's texture of kind *height*.
    pub(crate) fn lower_waves(&mut self, part: f64) {
        self.surface = self.surface.with_lower_waves(part);
    }

    /// Leaves these shares of the surface's stiffness and of its damping.
    pub(crate) fn scale_surface(&mut self, stiffness: f64, damping: f64) {
        self.surface = self.surface.scaled(stiffness, damping);
    }

    /// A vector of the world in the body's coordinates.
    #[inline]
    pub(crate) fn vector_in_body(&self, v: Vector<f64, 3>) -> Vector<f64, 3> {
        if self.is_placed { self.body_from_world.transform_vector(v) } else { v }
    }

    /// A vector of the body's coordinates in the world.
    #[inline]
    pub(crate) fn vector_in_world(&self, v: Vector<f64, 3>) -> Vector<f64, 3> {
        if self.is_placed { self.world_from_body.transform_vector(v) } else { v }
    }

    /// Whether the body moved in this tick.
    pub(crate) fn has_moved(&self) -> bool {
        self.has_moved
    }

    /// Whether the promise of the field holds at a point.
    pub(crate) fn is_proven(&self, p: Point<3>) -> bool {
        // Written so that NaN fails.
        self.region.is_none_or(|region| (p - region.centre).norm() <= region.radius)
    }

    /// Where the body's motion of this tick takes a point of the world.
    pub(crate) fn carried(&self, point: Point<3>) -> Point<3> {
        let in_body = self.world_from_before.inverse().transform_point(point);
        self.world_from_body.transform_point(in_body)
    }

    /// The motion of this tick, in the world; `None` if the body does not move.
    pub(crate) fn motion(&self) -> Option<Pose<3>> {
        self.has_moved.then(|| self.world_from_body * self.world_from_before.inverse())
    }

    /// Where the body's motion of this tick turns a vector of the world.
    pub(crate) fn carried_vector(&self, v: Vector<f64, 3>) -> Vector<f64, 3> {
        let in_body = self.world_from_before.inverse().transform_vector(v);
        self.world_from_body.transform_vector(in_body)
    }

    /// Where the body's motion of this tick takes a pose of the world; `None` if the body does
    /// not move.
    pub(crate) fn carried_pose(&self, pose: &Pose<3>) -> Option<Pose<3>> {
        let in_body = self.world_from_before.inverse() * *pose;
        self.has_moved.then(|| self.world_from_body * in_body)
    }

    /// A point's motion in this tick in body coordinates, from one place of the world to
    /// another; `None` if the point stays more than `margin` [m] away from the body.
    pub(crate) fn way_in_body(
        &self,
        [from, to]: [Point<3>; 2],
        margin: f64,
    ) -> Option<[Point<3>; 2]> {
        let from = self.world_from_before.inverse().transform_point(from);
        let to = self.body_from_world.transform_point(to);
        let Some(bounds) = self.bounds() else { return Some([from, to]) };
        let across = |v: Vector<f64, 3>| {
            if self.is_endless() { v - Vector::unit(2) * v[2] } else { v }
        };
        let (way, to_centre) = (across(to - from), across(bounds.ball.centre - from));
        let part = (way.dot(to_centre) / way.dot(way)).clamp(0.0, 1.0);
        let nearest = if part > 0.0 { way * part } else { Vector::ZERO };
        // Written so that NaN counts as near.
        let is_far = (to_centre - nearest).norm() > bounds.ball.radius + margin;
        (!is_far).then_some([from, to])
    }

    /// A point of the world in the body's coordinates.
    pub(crate) fn in_body(&self, point: Point<3>) -> Point<3> {
        if self.is_placed { self.body_from_world.transform_point(point) } else { point }
    }

    /// The distance from a point of the world to the bounding ball [m]; negative inside the
    /// ball.
    #[inline]
    pub(crate) fn above_ball(&self, point: Point<3>) -> f64 {
        self.ball.map_or(f64::NEG_INFINITY, |ball| {
            self.across(point - ball.centre).norm() - ball.radius
        })
    }

    /// The shortest way from the centre of the bounding ball to a point of the world, for a planar
    /// shape from the axis through it; `None` if the shape is unbounded.
    #[inline]
    pub(crate) fn off_centre(&self, point: Point<3>) -> Option<Vector<f64, 3>> {
        self.ball.map(|ball| self.across(point - ball.centre))
    }

    /// The part of a vector of the world across the direction in which the shape is endless.
    #[inline]
    fn across(&self, v: Vector<f64, 3>) -> Vector<f64, 3> {
        self.endless.map_or(v, |along| v - along * v.dot(along))
    }

    /// The distance from a point of the world to the bounding balls before and after the motion
    /// of this tick [m].
    #[inline]
    pub(crate) fn above_way(&self, point: Point<3>) -> f64 {
        if self.has_moved { self.above_moved(point) } else { self.above_ball(point) }
    }

    #[inline(never)]
    fn above_moved(&self, point: Point<3>) -> f64 {
        let Some(now) = self.ball else { return f64::NEG_INFINITY };
        let before = self.world_from_before.transform_point(self.in_body(now.centre));
        let all = now.union(&BoundingBall { centre: before, ..now });
        self.across(point - all.centre).norm() - all.radius
    }

    /// The field at a point of the world [m].
    #[inline]
    pub(crate) fn distance(&self, p: Point<3>) -> f64 {
        self.shape().distance(self.in_body(p))
    }

    /// The field at a point of the world [m], and the gradient.
    #[inline]
    pub(crate) fn distance_gradient(&self, p: Point<3>) -> (f64, Vector<f64, 3>) {
        let (distance, gradient) = self.shape().distance_gradient(self.in_body(p));
        (distance, self.vector_in_world(gradient))
    }

    fn place(&mut self, world_from_body: Pose<3>) {
        self.has_moved = world_from_body != self.world_from_before;
        self.is_placed = world_from_body != Pose::identity();
        self.world_from_body = world_from_body;
        self.body_from_world = world_from_body.inverse();
        self.find_balls();
    }

    /// Moves on along a motion that takes several ticks; `true` if it goes on after this tick.
    fn advance(&mut self) -> bool {
        let Some(mut travel) = self.travel.take() else { return false };
        travel.done += travel.step;
        self.place(travel.screw.pose(travel.done));
        self.travel = (travel.done < 1.0).then_some(travel);
        self.travel.is_some()
    }

    /// Ends the motion: the pose before becomes the present pose.
    fn settle(&mut self) {
        self.world_from_before = self.world_from_body;
        self.has_moved = false;
    }

    fn find_balls(&mut self) {
        let promise = *self.shape().promise();
        let along = world_axis(&self.world_from_body);
        self.endless = self.is_endless().then_some(along);
        let placed = |ball: BoundingBall<3>| BoundingBall {
            centre: self.world_from_body.transform_point(ball.centre),
            radius: ball.radius,
        };
        self.ball = self.bounds().map(|bounds| placed(bounds.ball));
        let off_origin = |ball: BoundingBall<3>| self.across(ball.centre).norm() - ball.radius;
        self.off_origin = self.ball.map_or(f64::NEG_INFINITY, off_origin);
        // Distances that are exact or bounds need no constant.
        let region = promise.region.filter(|_| promise.outside == Quality::Lipschitz);
        self.region = region.map(placed);
        let far = self.world_from_body.translation.norm();
        let way = if self.is_placed { PLACE_ROUNDINGS } else { 0.0 };
        self.rounding = promise.rounding.at(1.0, far).plus(&Rounding::of_operations(way, far));
    }

    /// The rounding error of the body's distances at points at most `extent` from the origin
    /// [m]. Zero if the body is farther away than these points: no contact depends on the error
    /// there.
    #[inline]
    pub(crate) fn rounding_within(&self, extent: f64) -> f64 {
        if self.off_origin > 2.0 * extent { 0.0 } else { self.rounding.within(extent) }
    }
}

/// The z axis of a body at this pose, in the world.
fn world_axis(world_from_body: &Pose<3>) -> Vector<f64, 3> {
    world_from_body.transform_vector(Vector::unit(2))
}

/// Scratch memory of a tick for this number of bodies.
fn scratch(bodies: usize) -> (Vec<Reaction>, Box<[u32]>) {
    (vec![Reaction::NONE; bodies], vec![0; bodies].into_boxed_slice())
}

pub(crate) fn is_usable(pose: &Pose<3>) -> bool {
    // Written so that NaN fails.
    pose.is_finite() && pose.translation.0.iter().all(|x| x.abs() <= LARGEST_LENGTH)
}

/// All bodies that a servo renders.
///
/// The field of the union is the least of the bodies' fields. Every tick builds the union anew
/// from the bodies that are near, so that bodies may move.
///
/// # Examples
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
/// use palpate_haptics::{Bodies, Body, Surface};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
/// let soft = Body::new(ball.clone(), Surface::smooth(200.0, 0.5)?)?;
/// let hard = Body::new(ball, Surface::smooth(900.0, 2.0)?)?;
/// let bodies = Bodies::new(vec![soft, hard.at(Pose::translation(Vector([0.2, 0.0, 0.0])))?])?;
/// assert_eq!(bodies.bodies().len(), 2);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Bodies {
    bodies: Vec<Body>,
    /// The radius of the ball around all bodies at their first poses [m]; `None` if a body is
    /// unbounded.
    pub(crate) size: Option<f64>,
    pub(crate) lipschitz: f64,
    pub(crate) has_regions: bool,
    /// Whether all shapes are planar.
    pub(crate) is_flat: bool,
    pub(crate) has_moved: bool,
    /// Whether a body is on a motion that takes several ticks.
    is_travelling: bool,
    /// Force and torque on each body in the last tick.
    reactions: Vec<Reaction>,
    /// Force and torque on each body in a rehearsed tick.
    rehearsed: Vec<Reaction>,
    /// Memory for the indices of near bodies. A box, because cloning a vector drops its spare
    /// capacity.
    list: Box<[u32]>,
}

impl Bodies {
    /// All bodies of `bodies`, in this order.
    ///
    /// # Errors
    ///
    /// [`HapticsError::NoBody`] if there is none.
    #[inline(never)]
    pub fn new(bodies: Vec<Body>) -> Result<Self, HapticsError> {
        let first = bodies.first().ok_or(HapticsError::NoBody)?;
        let mut bounds = first.ball;
        for body in bodies.iter().skip(1) {
            bounds = bounds.zip(body.ball).map(|(all, ball)| all.union(&ball));
        }
        let lipschitz = bodies.iter().map(|body| body.shape().promise().lipschitz);
        // Beyond the near bodies, the distance to the horizon bounds the field; its slope is
        // one.
        let lipschitz = lipschitz.fold(if bodies.len() > 1 { 1.0 } else { 0.0 }, f64::max);
        let size = bounds.map(|ball| ball.radius);
        let has_regions = bodies.iter().any(|body| body.region.is_some());
        let (reactions, list) = scratch(bodies.len());
        Ok(Self {
            size,
            lipschitz,
            has_regions,
            is_flat: bodies.iter().all(Body::is_endless),
            has_moved: false,
            is_travelling: false,
            rehearsed: reactions.clone(),
            reactions,
            list,
            bodies,
        })
    }

    /// The bodies.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    pub(crate) fn bodies_mut(&mut self) -> &mut [Body] {
        &mut self.bodies
    }

    /// Moves a body; in the next tick the body carries the proxies that touch it. A pose that
    /// is not finite is ignored, and so is a body index that is out of range.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_pose(&mut self, body: usize, world_from_body: Pose<3>) {
        let Some(body) = self.bodies.get_mut(body) else { return };
        if !is_usable(&world_from_body) || world_from_body == body.world_from_body {
            return;
        }
        body.travel = None;
        body.place(world_from_body);
        self.has_moved = true;
    }

    /// Moves a body along a screw to a pose, over `ticks` ticks, from the next one on; at once with
    /// one tick or less. Ignores the same poses as [`set_pose`](Self::set_pose).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn move_to(&mut self, body: usize, world_from_body: Pose<3>, ticks: f64) {
        let moving = self.bodies.get_mut(body).filter(|_| is_usable(&world_from_body));
        let screw = |from| Screw::new(from, world_from_body, 0).ok();
        match moving.and_then(|body| Some((screw(body.world_from_body)?, body))) {
            Some((screw, body)) if ticks > 1.0 => {
                body.travel = Some(Travel { screw, done: 0.0, step: 1.0 / ticks });
                self.is_travelling = true;
            }
            _ => self.set_pose(body, world_from_body),
        }
    }

    /// Sets the pose of a body that jumps there: it neither carries nor pushes a proxy.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn jump_to(&mut self, body: usize, world_from_body: Pose<3>) {
        let Some(body) = self.bodies.get_mut(body) else { return };
        body.travel = None;
        body.place(world_from_body);
        body.settle();
    }

    /// How far a body would carry a hand, at most, if it went to this pose [m]; zero if its bounding
    /// ball stays out of the hand's reach on the way there.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn way_to(&self, body: usize, pose: &Pose<3>, hand: Reach) -> f64 {
        let Some(body) = self.bodies.get(body) else { return 0.0 };
        let Reach { place, spread, reach } = hand;
        let reach = reach + body.surface.magnet.map_or(0.0, |magnet| magnet.reach);
        let carried = pose.transform_point(body.in_body(place));
        let turn = body.world_from_body.rotation.turn_to(&pose.rotation).norm();
        if let Some(ball) = body.ball {
            let end = pose.transform_point(body.in_body(ball.centre));
            let chord = body.across(end - ball.centre);
            let from = body.across(place - ball.centre);
            let part = (from.dot(chord) / chord.dot(chord)).clamp(0.0, 1.0);
            // NaN, from a body that turns in place, is its start.
            let part = if part >= 0.0 { part } else { 0.0 };
            // The rise of an arc over its chord.
            let rise = 0.5 * chord.norm() * (0.25 * turn).tan();
            // Written so that NaN is near.
            if (from - chord * part).norm() - ball.radius - rise > reach + spread {
                return 0.0;
            }
        }
        (carried - place).norm() + turn * spread
    }

    /// Moves bodies on along motions that take several ticks.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn advance(&mut self) {
        if !self.is_travelling {
            return;
        }
        let mut goes_on = false;
        for body in &mut self.bodies {
            self.has_moved |= body.travel.is_some();
            goes_on |= body.advance();
        }
        self.is_travelling = goes_on;
    }

    /// The force and torque of all contact points on each body in the last tick.
    #[must_use]
    pub fn reactions(&self) -> &[Reaction] {
        &self.reactions
    }

    /// Takes the scratch memory of a tick: indices of near bodies, and the reaction of each
    /// body.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn take_scratch(&mut self) -> (Box<[u32]>, Vec<Reaction>) {
        (std::mem::take(&mut self.list), std::mem::take(&mut self.reactions))
    }

    /// Returns the [scratch memory](Self::take_scratch).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn put_back(&mut self, list: Box<[u32]>, reactions: Vec<Reaction>) {
        (self.list, self.reactions) = (list, reactions);
    }

    /// Swaps the reactions of the last tick with those of the rehearsed tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn swap_reactions(&mut self) {
        std::mem::swap(&mut self.reactions, &mut self.rehearsed);
    }

    /// Ends the motion of this tick for every body.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn settle(&mut self) {
        if std::mem::take(&mut self.has_moved) {
            self.bodies.iter_mut().for_each(Body::settle);
        }
    }
}

/// What a body that jumps may meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// The device point, or the origin of a tool.
    pub(crate) place: Point<3>,
    /// How far the points of a tool are from its origin [m]; zero for a point.
    pub(crate) spread: f64,
    /// How near to these a body is felt [m].
    pub(crate) reach: f64,
}

/// Where a body goes in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NextPose {
    /// From body to world.
    pub pose: Pose<3>,
    /// Whether it jumps there: a proxy is then placed anew where the body covers it, and the force
    /// rises from what it was. Else the body moves there, and carries and pushes what it meets.
    pub jumps: bool,
}

impl From<Pose<3>> for NextPose {
    /// A body that moves to a pose.
    fn from(pose: Pose<3>) -> Self {
        Self { pose, jumps: false }
    }
}

impl TryFrom<Vec<Body>> for Bodies {
    type Error = HapticsError;

    fn try_from(bodies: Vec<Body>) -> Result<Self, HapticsError> {
        Self::new(bodies)
    }
}

impl<const N: usize> TryFrom<[Body; N]> for Bodies {
    type Error = HapticsError;

    fn try_from(bodies: [Body; N]) -> Result<Self, HapticsError> {
        Self::new(bodies.into())
    }
}

impl From<Shape<2>> for Bodies {
    /// As of a [`SpaceShape`].
    fn from(shape: Shape<2>) -> Self {
        SpaceShape::from(shape).into()
    }
}

impl From<Shape<3>> for Bodies {
    /// As of a [`SpaceShape`].
    fn from(shape: Shape<3>) -> Self {
        SpaceShape::from(shape).into()
    }
}

impl From<SpaceShape> for Bodies {
    /// One body at the origin with the default surface, which is smooth.
    fn from(shape: SpaceShape) -> Self {
        let body = Body::of(shape, Surface::default());
        let (reactions, list) = scratch(1);
        Self {
            size: body.ball.map(|ball| ball.radius),
            lipschitz: body.shape().promise().lipschitz,
            has_regions: body.region.is_some(),
            is_flat: body.is_endless(),
            has_moved: false,
            is_travelling: false,
            rehearsed: reactions.clone(),
            reactions,
            list,
            bodies: vec![body],
        }
    }
}
