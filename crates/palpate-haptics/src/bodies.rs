// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is touched: bodies that may move, each with a surface of its own.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{
    BoundingBall, LARGEST_LENGTH, Point, Pose, Quality, Rounding, Shape, Vector,
};

use crate::error::HapticsError;
use crate::event::Reaction;
use crate::nearby::Nearby;
use crate::surface::Surface;

/// Roundings of a point's way into a body's coordinates, for each metre from the origins.
const PLACE_ROUNDINGS: f64 = 8.0;

/// A shape, where it is, and what it feels like.
#[derive(Clone, Debug)]
pub struct Body<const D: usize> {
    shape: Shape<D>,
    surface: Surface<D>,
    world_from_body: Pose<D>,
    body_from_world: Pose<D>,
    /// Where it was in the tick before; where it is, if it did not move.
    world_from_before: Pose<D>,
    has_moved: bool,
    /// Whether its coordinates are not those of the world.
    is_placed: bool,
    /// A ball of the world that holds it; none if it has no bounds.
    pub(crate) ball: Option<BoundingBall<D>>,
    /// Whether its field may be less than the distance to that ball.
    pub(crate) is_below_ball: bool,
    /// Where something is proven of its field, in the world; everywhere if none.
    pub(crate) region: Option<BoundingBall<D>>,
    /// The error of its distances in the world.
    rounding: Rounding,
    /// How far the ball is from the origin [m]; negative if it holds it, or there is none.
    off_origin: f64,
}

impl<const D: usize> Body<D> {
    /// A body at the origin.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Shape`] if the shape cannot carry the texture of the surface; as
    /// [`Surface::new`] for a material.
    pub fn new(
        shape: Shape<D>,
        surface: impl TryInto<Surface<D>, Error: Into<HapticsError>>,
    ) -> Result<Self, HapticsError> {
        let surface = surface.try_into().map_err(Into::into)?;
        let shape = surface.carved(shape)?;
        Ok(Self::of(shape, surface))
    }

    /// A body whose texture is in the shape already.
    fn of(shape: Shape<D>, surface: Surface<D>) -> Self {
        let identity = Pose::identity();
        let is_below_ball = !shape.promise().above_bounds;
        let rounding = shape.promise().rounding;
        let mut body = Self {
            shape,
            surface,
            world_from_body: identity,
            body_from_world: identity,
            world_from_before: identity,
            has_moved: false,
            is_placed: false,
            ball: None,
            is_below_ball,
            region: None,
            rounding,
            off_origin: f64::NEG_INFINITY,
        };
        body.find_balls();
        body
    }

    /// The same at `world_from_body`.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Pose`] if a number of the pose is not finite or beyond 1e15.
    pub fn at(mut self, world_from_body: Pose<D>) -> Result<Self, HapticsError> {
        if !is_usable(&world_from_body) {
            return Err(HapticsError::Pose);
        }
        self.place(world_from_body);
        self.settle();
        Ok(self)
    }

    /// The shape in the body's coordinates.
    #[must_use]
    pub fn shape(&self) -> &Shape<D> {
        &self.shape
    }

    /// What it feels like.
    #[must_use]
    pub fn surface(&self) -> &Surface<D> {
        &self.surface
    }

    /// Where it is.
    #[must_use]
    pub fn world_from_body(&self) -> &Pose<D> {
        &self.world_from_body
    }

    /// Makes stiffness and damping `factor` times as large.
    pub(crate) fn scale_surface(&mut self, factor: f64) {
        self.surface = self.surface.scaled(factor);
    }

    /// A vector of the world in the body's coordinates.
    #[inline]
    pub(crate) fn vector_in_body(&self, v: Vector<f64, D>) -> Vector<f64, D> {
        if self.is_placed { self.body_from_world.transform_vector(v) } else { v }
    }

    /// A vector of the body's coordinates in the world.
    #[inline]
    pub(crate) fn vector_in_world(&self, v: Vector<f64, D>) -> Vector<f64, D> {
        if self.is_placed { self.world_from_body.transform_vector(v) } else { v }
    }

    /// Whether it moved in this tick.
    pub(crate) fn has_moved(&self) -> bool {
        self.has_moved
    }

    /// Where it takes a point of the world that moves with it in this tick.
    pub(crate) fn carried(&self, point: Point<D>) -> Point<D> {
        let in_body = self.world_from_before.inverse().transform_point(point);
        self.world_from_body.transform_point(in_body)
    }

    /// Where it takes a pose of the world that moves with it in this tick; none if it does not
    /// move.
    pub(crate) fn carried_pose(&self, pose: &Pose<D>) -> Option<Pose<D>> {
        let in_body = self.world_from_before.inverse() * *pose;
        self.has_moved.then(|| self.world_from_body * in_body)
    }

    /// The way of a point of the world in this tick, from one place to another, as the body
    /// sees it; none if it stays out of reach of the body by more than `margin` [m].
    pub(crate) fn way_in_body(
        &self,
        [from, to]: [Point<D>; 2],
        margin: f64,
    ) -> Option<[Point<D>; 2]> {
        let from = self.world_from_before.inverse().transform_point(from);
        let to = self.body_from_world.transform_point(to);
        let Some(bounds) = self.shape.promise().bounds else { return Some([from, to]) };
        let (way, to_centre) = (to - from, bounds.ball.centre - from);
        let part = (way.dot(to_centre) / way.dot(way)).clamp(0.0, 1.0);
        let nearest = if part > 0.0 { way * part } else { Vector::ZERO };
        // Written so that NaN is swept.
        let is_far = (to_centre - nearest).norm() > bounds.ball.radius + margin;
        (!is_far).then_some([from, to])
    }

    /// A point of the world in the body's coordinates.
    pub(crate) fn in_body(&self, point: Point<D>) -> Point<D> {
        if self.is_placed { self.body_from_world.transform_point(point) } else { point }
    }

    /// How far a point of the world is from the body's ball [m]; negative in it.
    #[inline]
    pub(crate) fn above_ball(&self, point: Point<D>) -> f64 {
        self.ball.map_or(f64::NEG_INFINITY, |ball| (point - ball.centre).norm() - ball.radius)
    }

    /// Likewise from all that the ball met on its way in this tick [m].
    #[inline]
    fn above_way(&self, point: Point<D>) -> f64 {
        if self.has_moved { self.above_moved(point) } else { self.above_ball(point) }
    }

    #[inline(never)]
    fn above_moved(&self, point: Point<D>) -> f64 {
        let Some(now) = self.ball else { return f64::NEG_INFINITY };
        let before = self.world_from_before.transform_point(self.in_body(now.centre));
        let all = now.union(&BoundingBall { centre: before, ..now });
        (point - all.centre).norm() - all.radius
    }

    /// Its field at a point of the world [m].
    #[inline]
    pub(crate) fn distance(&self, p: Point<D>) -> f64 {
        self.shape.distance(self.in_body(p))
    }

    /// Likewise with its gradient.
    #[inline]
    pub(crate) fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        let (distance, gradient) = self.shape.distance_gradient(self.in_body(p));
        (distance, self.vector_in_world(gradient))
    }

    fn place(&mut self, world_from_body: Pose<D>) {
        self.has_moved = world_from_body != self.world_from_before;
        self.is_placed = world_from_body != Pose::identity();
        self.world_from_body = world_from_body;
        self.body_from_world = world_from_body.inverse();
        self.find_balls();
    }

    /// From now on it has not moved.
    fn settle(&mut self) {
        self.world_from_before = self.world_from_body;
        self.has_moved = false;
    }

    fn find_balls(&mut self) {
        let promise = self.shape.promise();
        let placed = |ball: BoundingBall<D>| BoundingBall {
            centre: self.world_from_body.transform_point(ball.centre),
            radius: ball.radius,
        };
        self.ball = promise.bounds.map(|bounds| placed(bounds.ball));
        let off_origin = |ball: BoundingBall<D>| ball.centre.norm() - ball.radius;
        self.off_origin = self.ball.map_or(f64::NEG_INFINITY, off_origin);
        // Distances that are exact or bounds need no constant.
        let region = promise.region.filter(|_| promise.outside == Quality::Lipschitz);
        self.region = region.map(placed);
        let far = self.world_from_body.translation.norm();
        let way = if self.is_placed { PLACE_ROUNDINGS } else { 0.0 };
        self.rounding = promise.rounding.at(1.0, far).plus(&Rounding::of_operations(way, far));
    }

    /// The error of its distances at points at most `extent` from the origin [m]; nothing if
    /// it is farther away than they are: what is far from it need not know how far exactly.
    #[inline]
    pub(crate) fn rounding_within(&self, extent: f64) -> f64 {
        if self.off_origin > 2.0 * extent { 0.0 } else { self.rounding.within(extent) }
    }
}

/// Room for a tick with so many bodies.
fn scratch<const D: usize>(bodies: usize) -> (Vec<Reaction<D>>, Box<[u32]>) {
    (vec![Reaction::NONE; bodies], vec![0; bodies].into_boxed_slice())
}

pub(crate) fn is_usable<const D: usize>(pose: &Pose<D>) -> bool {
    // Written so that NaN fails.
    pose.is_finite() && pose.translation.0.iter().all(|x| x.abs() <= LARGEST_LENGTH)
}

/// All bodies that can be touched.
///
/// Their union is one field, the least of theirs. It is made anew of the bodies that are near
/// for every tick, so that bodies may move.
///
/// # Examples
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
/// use palpate_haptics::{Bodies, Body, Surface};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::from_kernel(Ball::new(0.05)?);
/// let soft = Body::new(ball.clone(), Surface::smooth(200.0, 0.5)?)?;
/// let hard = Body::new(ball, Surface::smooth(900.0, 2.0)?)?;
/// let bodies = Bodies::new(vec![soft, hard.at(Pose::translation(Vector([0.2, 0.0, 0.0])))?])?;
/// assert_eq!(bodies.bodies().len(), 2);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Bodies<const D: usize> {
    bodies: Vec<Body<D>>,
    /// The radius of the ball that held all bodies at first [m]; none if one has no bounds.
    pub(crate) size: Option<f64>,
    pub(crate) lipschitz: f64,
    pub(crate) has_regions: bool,
    pub(crate) has_moved: bool,
    /// What was done to each in the last tick.
    reactions: Vec<Reaction<D>>,
    /// The same of a tick that is only rehearsed.
    rehearsed: Vec<Reaction<D>>,
    /// Room for the numbers of those that are near: a box, as a clone of a vector has less
    /// room than the vector.
    list: Box<[u32]>,
}

impl<const D: usize> Bodies<D> {
    /// These bodies.
    ///
    /// # Errors
    ///
    /// [`HapticsError::NoBody`] if there is none.
    pub fn new(bodies: Vec<Body<D>>) -> Result<Self, HapticsError> {
        let first = bodies.first().ok_or(HapticsError::NoBody)?;
        let mut bounds = first.ball;
        for body in bodies.iter().skip(1) {
            bounds = bounds.zip(body.ball).map(|(all, ball)| all.union(&ball));
        }
        let lipschitz = bodies.iter().map(|body| body.shape.promise().lipschitz);
        // Beyond what is near, the way there bounds the field: it has slope one.
        let lipschitz = lipschitz.fold(if bodies.len() > 1 { 1.0 } else { 0.0 }, f64::max);
        let size = bounds.map(|ball| ball.radius);
        let has_regions = bodies.iter().any(|body| body.region.is_some());
        let (reactions, list) = scratch(bodies.len());
        let has_moved = false;
        let rehearsed = reactions.clone();
        Ok(Self { bodies, size, lipschitz, has_regions, has_moved, reactions, rehearsed, list })
    }

    /// The bodies.
    #[must_use]
    pub fn bodies(&self) -> &[Body<D>] {
        &self.bodies
    }

    pub(crate) fn bodies_mut(&mut self) -> &mut [Body<D>] {
        &mut self.bodies
    }

    /// Moves a body; what it touches goes with it in the next tick. A pose that is not finite,
    /// or of a body that is not there, moves nothing.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn set_pose(&mut self, body: usize, world_from_body: Pose<D>) {
        let Some(body) = self.bodies.get_mut(body) else { return };
        if !is_usable(&world_from_body) || world_from_body == body.world_from_body {
            return;
        }
        body.place(world_from_body);
        self.has_moved = true;
    }

    /// What was done to each body in the last tick.
    #[must_use]
    pub fn reactions(&self) -> &[Reaction<D>] {
        &self.reactions
    }

    /// Room for a tick: the numbers of what is near, and what was done to each body.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn take_scratch(&mut self) -> (Box<[u32]>, Vec<Reaction<D>>) {
        (std::mem::take(&mut self.list), std::mem::take(&mut self.reactions))
    }

    /// Takes back what was [taken](Self::take_scratch).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn put_back(&mut self, (list, reactions): (Box<[u32]>, Vec<Reaction<D>>)) {
        (self.list, self.reactions) = (list, reactions);
    }

    /// Puts what was done to each, and what was rehearsed, in the place of each other.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn swap_reactions(&mut self) {
        std::mem::swap(&mut self.reactions, &mut self.rehearsed);
    }

    /// The motion of this tick is over.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn settle(&mut self) {
        if std::mem::take(&mut self.has_moved) {
            self.bodies.iter_mut().for_each(Body::settle);
        }
    }

    /// All of them, however far away.
    #[must_use]
    pub fn everything(&self) -> Nearby<'_, D> {
        Nearby { bodies: self, list: None, centre: Vector::ZERO, horizon: f64::INFINITY }
    }

    /// Those within `radius` of `centre` [m], written down in `list`; bodies that find no room
    /// there are beyond a nearer horizon.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn nearby<'a>(
        &'a self,
        (centre, radius): (Point<D>, f64),
        list: &'a mut [u32],
    ) -> Nearby<'a, D> {
        let (mut horizon, mut count) = (f64::INFINITY, 0);
        for (index, body) in (0..).zip(&self.bodies) {
            let away = body.above_way(centre);
            // Written so that NaN is near.
            let is_far = away > radius;
            match list.get_mut(count) {
                Some(place) if !is_far => {
                    *place = index;
                    count += 1;
                }
                _ => horizon = horizon.min(away),
            }
        }
        Nearby { bodies: self, list: list.get(..count), centre, horizon }
    }
}

impl<const D: usize> TryFrom<Vec<Body<D>>> for Bodies<D> {
    type Error = HapticsError;

    fn try_from(bodies: Vec<Body<D>>) -> Result<Self, HapticsError> {
        Self::new(bodies)
    }
}

impl<const D: usize, const N: usize> TryFrom<[Body<D>; N]> for Bodies<D> {
    type Error = HapticsError;

    fn try_from(bodies: [Body<D>; N]) -> Result<Self, HapticsError> {
        Self::new(bodies.into())
    }
}

impl<const D: usize> From<Shape<D>> for Bodies<D> {
    /// One body of the default surface, which is smooth, at the origin.
    fn from(shape: Shape<D>) -> Self {
        let body = Body::of(shape, Surface::default());
        let promise = *body.shape.promise();
        let (reactions, list) = scratch(1);
        Self {
            size: body.ball.map(|ball| ball.radius),
            lipschitz: promise.lipschitz,
            has_regions: body.region.is_some(),
            has_moved: false,
            rehearsed: reactions.clone(),
            reactions,
            list,
            bodies: vec![body],
        }
    }
}
