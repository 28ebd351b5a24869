// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Motions: bodies that move, their ways as another sees them, how long parts of them are free.

use palpate_field::scalar::SpaceTimeModel;
use palpate_field::{Aabb, Point, Pose, Screw, Shape, ShapeError, Vector};

use crate::error::QueryError;
use crate::sampler::{Placed, check_pose};

/// A rigid motion over the time from 0 to 1: a screw, or rest at a pose. Both convert to it.
///
/// ```
/// use palpate_field::{Pose, Screw};
/// use palpate_query::Motion;
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let there = Pose::<3>::translation([1.0, 0.0, 0.0]);
/// let motion = Motion::from(Screw::new(Pose::identity(), there, 0)?);
/// assert_eq!(motion.pose(0.5).translation[0], 0.5);
/// assert_eq!(Motion::from(there).pose(0.5), there);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Motion<const D: usize> {
    /// `None` at rest.
    screw: Option<Screw<D>>,
    first: Pose<D>,
    /// The velocity of the body's origin, and what each coordinate of a point adds, both in the
    /// body's coordinates: velocities are affine in the point.
    velocity: Vector<f64, D>,
    slopes: [Vector<f64, D>; D],
}

impl<const D: usize> Motion<D> {
    /// The pose at a time, from 0 to 1: the first at 0 and below, the last at 1 and above.
    #[must_use]
    pub fn pose(&self, time: f64) -> Pose<D> {
        self.screw.map_or(self.first, |screw| screw.pose(time))
    }

    /// The velocity of a point of the body, both in the body's coordinates, where the whole motion
    /// takes the unit of time, so that it is in [m]: as [`Screw::velocity`].
    #[must_use]
    #[inline]
    pub fn velocity(&self, p: Point<D>) -> Vector<f64, D> {
        let mut velocity = self.velocity;
        for (slope, x) in self.slopes.iter().zip(p.0) {
            velocity += *slope * x;
        }
        velocity
    }

    /// The motion of what the body carries at a pose in its coordinates; of a body that turns by less than π.
    pub(super) fn of_part(&self, body_from_part: &Pose<D>) -> Result<Self, ShapeError> {
        let carried = |pose: &Pose<D>| *pose * *body_from_part;
        match &self.screw {
            None => Ok(carried(&self.first).into()),
            Some(screw) => {
                let (from, to) = (carried(screw.from()), carried(screw.to()));
                Ok(Screw::new(from, to, 0)?.into())
            }
        }
    }

    /// How far the body turns [rad].
    #[must_use]
    pub fn angle(&self) -> f64 {
        self.screw.map_or(0.0, |screw| screw.angle().abs())
    }

    /// A bound of the distance of the body's origin from the world's during the motion [m].
    pub(super) fn reach(&self) -> f64 {
        self.first.translation.norm() + self.velocity.norm()
    }

    /// Refuses poses that are not finite or too far away, of the body with this index.
    ///
    /// # Errors
    ///
    /// If the first or the last pose is such a pose.
    #[doc(hidden)]
    pub fn check(&self, index: usize) -> Result<(), QueryError> {
        [0.0, 1.0].into_iter().try_for_each(|time| check_pose(index, &self.pose(time)))
    }
}

impl<const D: usize> From<Screw<D>> for Motion<D> {
    fn from(screw: Screw<D>) -> Self {
        let first = *screw.from();
        if first == *screw.to() && screw.angle() == 0.0 {
            return first.into();
        }
        let velocity = screw.velocity(Vector::ZERO);
        let slopes = std::array::from_fn(|k| screw.velocity(Vector::unit(k)) - velocity);
        Self { screw: Some(screw), first, velocity, slopes }
    }
}

impl<const D: usize> From<Pose<D>> for Motion<D> {
    fn from(first: Pose<D>) -> Self {
        Self { screw: None, first, velocity: Vector::ZERO, slopes: [Vector::ZERO; D] }
    }
}

/// A shape on its way from pose to pose, over the time from 0 to 1. A shape at rest converts to one
/// that stays.
///
/// ```
/// use palpate_field::{Pose, Screw, Shape};
/// use palpate_query::Moving;
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let ball = Shape::<3>::ball(0.1)?;
/// let there = Pose::translation([1.0, 0.0, 0.0]);
/// let moving = Moving::new(&ball, Screw::new(Pose::identity(), there, 0)?);
/// assert_eq!(moving.at(0.5).world_from_body.translation[0], 0.5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Moving<'a, const D: usize> {
    /// The shape.
    pub shape: &'a Shape<D>,
    /// From the shape's coordinates to the world's, over the time.
    pub motion: Motion<D>,
}

impl<'a, const D: usize> Moving<'a, D> {
    /// `shape` on its way.
    #[must_use]
    pub fn new(shape: &'a Shape<D>, motion: impl Into<Motion<D>>) -> Self {
        Self { shape, motion: motion.into() }
    }

    /// The shape at a time, from 0 to 1.
    #[must_use]
    pub fn at(&self, time: f64) -> Placed<'a, D> {
        Placed::new(self.shape, self.motion.pose(time))
    }

    /// The velocity of a point of the world that the body carries at a time [m].
    pub(super) fn velocity(&self, time: f64, p: Point<D>) -> Vector<f64, D> {
        let pose = self.motion.pose(time);
        pose.transform_vector(self.motion.velocity(pose.inverse().transform_point(p)))
    }
}

/// The corners of a box.
pub(crate) fn corners<const D: usize>(aabb: &Aabb<D>) -> impl Iterator<Item = Point<D>> {
    let Aabb { min, max } = *aabb;
    (0..1_usize << D).map(move |corner| {
        Vector(std::array::from_fn(|k| if corner >> k & 1 == 0 { min[k] } else { max[k] }))
    })
}

impl<'a, const D: usize> From<Placed<'a, D>> for Moving<'a, D> {
    fn from(rest: Placed<'a, D>) -> Self {
        Self::new(rest.shape, rest.world_from_body)
    }
}

impl<'a, const D: usize> From<&'a Shape<D>> for Moving<'a, D> {
    fn from(shape: &'a Shape<D>) -> Self {
        Placed::from(shape).into()
    }
}

/// Roundings of a velocity and of a pose, relative to the numbers in them.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// The way of a body through the coordinates of a field, both of which may move.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path<const D: usize> {
    pub(super) field: Motion<D>,
    pub(super) body: Motion<D>,
}

/// A body at a time, in the coordinates of a field.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<const D: usize> {
    time: f64,
    field_from_body: Pose<D>,
}

/// Bounds of the way of all points of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct WayBounds {
    /// The largest speed [m].
    pub(super) speed: f64,
    /// The largest acceleration [m].
    pub(super) acceleration: f64,
    /// How far from the origin of the field's coordinates the body may come [m].
    pub(super) far: f64,
    /// The rounding of places [m].
    pub(super) rounding: f64,
}

impl<const D: usize> Path<D> {
    #[inline]
    pub(super) fn at(&self, time: f64) -> Place<D> {
        let world_from_body = self.body.pose(time);
        Place { time, field_from_body: self.field.pose(time).inverse() * world_from_body }
    }

    /// The velocity in the field's coordinates of a point, `p` of the body, `q` in these [m].
    #[inline]
    pub(super) fn velocity(
        &self,
        place: &Place<D>,
        p: Point<D>,
        q: Point<D>,
    ) -> Vector<f64, D> {
        place.field_from_body.transform_vector(self.body.velocity(p)) - self.field.velocity(q)
    }

    /// Bounds for a body that is the convex hull of `points`.
    ///
    /// A point of the body goes at its constant speed v, and turns by ω; so its acceleration is at
    /// most ω v. The field's coordinates carry the point at a velocity of at most u at first, which
    /// turning by ψ changes by at most ψ v as the point moves on. They add the accelerations of a
    /// turning frame: ψ u, and 2 ψ times the velocity in it, which is at most u + v (Coriolis).
    pub(super) fn bounds(&self, points: &[Point<D>]) -> WayBounds {
        let start = self.at(0.0);
        let (mut speed, mut carried, mut reach) = (0.0_f64, 0.0_f64, 0.0_f64);
        for p in points {
            let q = start.point(*p);
            speed = speed.max(self.body.velocity(*p).norm());
            carried = carried.max(self.field.velocity(q).norm());
            reach = reach.max(p.norm()).max(q.norm());
        }
        let [turn, field_turn] = [self.body.angle(), self.field.angle()];
        let carried = carried + field_turn * speed;
        let both = speed + carried;
        let far = reach + both + self.body.reach() + self.field.reach();
        WayBounds {
            speed: both,
            acceleration: turn * speed + field_turn * (carried + 2.0 * both),
            far: reach + both,
            rounding: ROUNDINGS * far,
        }
    }
}

impl<const D: usize> Place<D> {
    /// A point of the body in the field's coordinates [m].
    #[inline]
    pub(super) fn point(&self, p: Point<D>) -> Point<D> {
        self.field_from_body.transform_point(p)
    }
}

/// Places that are kept: a power of two.
const PLACES: usize = 64;

/// Places of the last times, by time: parts of a search often have the same.
#[derive(Clone, Debug)]
pub(super) struct Places<const D: usize>([Option<Place<D>>; PLACES]);

impl<const D: usize> Places<D> {
    pub(super) fn new() -> Self {
        Self([None; PLACES])
    }

    /// Forgets all, for another path.
    pub(super) fn clear(&mut self) {
        *self = Self::new();
    }

    /// The place at a time.
    #[inline]
    pub(super) fn at(&mut self, path: &Path<D>, time: f64) -> &Place<D> {
        // The upper bits of the product depend on all bits of the time (Knuth 1998, 6.4).
        let hash = time.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15)
            >> (64 - PLACES.trailing_zeros());
        let slot = &mut self.0[hash as usize];
        if slot.is_some_and(|place| place.time != time) {
            *slot = None;
        }
        slot.get_or_insert_with(|| path.at(time))
    }
}

/// A part goes on undivided if its step is at least this share of its centre's alone.
const PAYS: f64 = 0.3;

/// Of the way that is left to a ball's edge, the share that bends of the way may take.
const BEND: f64 = 0.25;

/// Means of two models whose steps follow each other, at most.
const MEANS: usize = 4;

/// How long a part is free, and how long its centre alone is: smaller parts may gain the difference.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stay {
    pub(super) part: f64,
    pub(super) centre: f64,
}

impl Stay {
    /// Whether smaller parts would gain little.
    #[inline]
    pub(super) fn pays(&self) -> bool {
        self.part > 0.0 && self.part >= PAYS * self.centre
    }

    /// The longer of both.
    #[inline]
    pub(super) fn or(&mut self, other: Self) {
        *self = Self { part: self.part.max(other.part), centre: self.centre.max(other.centre) };
    }

    /// Of all points within `radius` of one that moves at a `speed` from the middle of a ball that is
    /// proven `empty` [m].
    #[inline]
    pub(super) fn in_ball(empty: f64, radius: f64, speed: f64, acceleration: f64) -> Self {
        let spare = empty - radius;
        let (bend, most) = bend(spare, acceleration);
        // NaN is no time.
        match () {
            () if spare > 0.0 => Self {
                part: ((spare - bend) / speed).min(most) * (1.0 - 1e-12),
                centre: (empty / speed).min(most),
            },
            () if empty > 0.0 => Self { part: 0.0, centre: empty / speed },
            () => Self::default(),
        }
    }

    /// Of a box and a span of time, over which two fields have these models: until the best of
    /// their means falls to `level` [m].
    pub(super) fn of_models(
        a: &SpaceTimeModel,
        b: &SpaceTimeModel,
        level: f64,
        span: f64,
    ) -> Self {
        let mut candidates = [1.0, 0.0, -1.0, -1.0, -1.0];
        for k in 0..3 {
            // A component of the mean's slope changes its sign there.
            let (of_a, of_b) = (a.gradient[k], b.gradient[k]);
            if of_a * of_b < 0.0 {
                candidates[2 + k] = of_b / (of_b - of_a);
            }
        }
        let lines = candidates.map(|share| (share >= 0.0).then(|| Line::of(a, b, share)));
        let mut stay = Self::default();
        // From −1 on; where one mean ends, another may go on.
        let mut until = -1.0_f64;
        for _ in 0..MEANS {
            let mut end = until;
            for line in lines.iter().flatten() {
                if line.at(until) > level {
                    end = end.max(line.falls_to(level));
                }
            }
            if end <= until {
                break;
            }
            until = end;
        }
        let share = |until: f64| (0.5 * (until + 1.0)).clamp(0.0, 1.0);
        let rounding = if until < 1.0 { 1e-12 } else { 0.0 };
        stay.part = share(until) * span * (1.0 - rounding);
        for line in lines.iter().flatten() {
            let middle = Line { value: line.middle, ..*line };
            if middle.at(-1.0) > level {
                stay.centre = stay.centre.max(share(middle.falls_to(level)) * span);
            }
        }
        stay
    }
}

/// A lower bound over a box that is affine in time, from −1 to 1.
#[derive(Clone, Copy)]
struct Line {
    /// At the time 0.
    value: f64,
    slope: f64,
    /// The value in the middle of the box, without remainders.
    middle: f64,
}

impl Line {
    /// Of `share` of a and the rest of b.
    #[inline]
    fn of(a: &SpaceTimeModel, b: &SpaceTimeModel, share: f64) -> Self {
        let rest = 1.0 - share;
        let mean = |a: f64, b: f64| share * a + rest * b;
        let (mut least, mut size) = (0.0, share * a.value.abs() + rest * b.value.abs());
        for k in 0..3 {
            least += mean(a.gradient[k], b.gradient[k]).abs();
            size += share * a.gradient[k].abs() + rest * b.gradient[k].abs();
        }
        let (middle, slope) = (mean(a.value, b.value), mean(a.gradient[3], b.gradient[3]));
        size += slope.abs();
        let lower = mean(a.lower, b.lower) * (1.0 + ROUNDINGS) + 2.0 * ROUNDINGS * size;
        Self { value: middle - least - lower, slope, middle }
    }

    #[inline]
    fn at(&self, time: f64) -> f64 {
        self.value + self.slope * time
    }

    /// When it falls to a level, at most 1, from a time on at which it is higher.
    #[inline]
    fn falls_to(&self, level: f64) -> f64 {
        if self.at(1.0) > level { 1.0 } else { ((level - self.value) / self.slope).min(1.0) }
    }
}

/// What a bend takes of the way that is `spare`, and for how long a way of this acceleration bends
/// no farther.
#[inline]
pub(super) fn bend(spare: f64, acceleration: f64) -> (f64, f64) {
    if acceleration > 0.0 {
        let bend = BEND * spare;
        (bend, (2.0 * bend / acceleration).sqrt())
    } else {
        (0.0, f64::INFINITY)
    }
}

/// When a point leaves a ball of a `radius`, `apart` from its centre at first; zero if it is not in
/// it.
#[inline]
pub(super) fn exit<const D: usize>(
    apart: Vector<f64, D>,
    velocity: Vector<f64, D>,
    radius: f64,
) -> f64 {
    // |o + s v| < radius from s = 0 on.
    let (half, squared) = (apart.dot(velocity), velocity.dot(velocity));
    let rest = radius * radius - apart.dot(apart);
    let is_in_it = radius > 0.0 && rest > 0.0;
    let root = (half * half + squared * rest).sqrt();
    // Of both forms of the root the one that does not cancel. A point at rest never leaves. NaN is no
    // time.
    match () {
        () if is_in_it && squared == 0.0 => f64::INFINITY,
        () if is_in_it && half > 0.0 => rest / (root + half),
        () if is_in_it => (root - half) / squared,
        () => 0.0,
    }
}

/// A time after a step, rounded down to one that other parts are likely to have: their places are
/// computed once.
#[inline]
pub(super) fn later(time: f64, step: f64) -> f64 {
    /// Of the step, so much is given up at most.
    const COARSE: f64 = 8.0;
    let coarse = step / COARSE;
    // The power of two below.
    let grid = f64::from_bits(coarse.to_bits() & (0x7ff << 52));
    let rounded = ((time + step) / grid).floor() * grid;
    // What is free to the end needs no place any more.
    if rounded > time && time + step < 1.0 { rounded } else { time + step }
}
