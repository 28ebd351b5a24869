// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A field as searches between bodies see it, and descents on two of them.

use palpate_field::scalar::Model;
use palpate_field::{Aabb, BoundingBall, Point, Pose, Quality, Rotation, Shape, Vector};

use super::body_pair::BodyPair;
use crate::certified::Goal;
use crate::constraints::{CAPACITY, PlaneConstraint, closest_point};
use crate::error::QueryError;
use crate::sampler::{Placed, check_pose, larger};

/// Roundings of places and of distances to boxes, relative to the largest coordinate.
const GEOMETRY_ROUNDINGS: f64 = 16.0;

/// A smaller entry of a rotation bounds no coordinate: a division by it would magnify rounding.
const LEAST_TURN: f64 = 1e-2;

/// Steps to a point that is in a shape, and the depth that they aim at, in roundings of its field.
const STEPS_WITHIN: usize = 16;
const DEPTH_WITHIN: f64 = 4.0;

/// `g = max(f/L, distance to the shape's box)`, with `L` the steepness of the field, at least
/// one: a lower bound of the distance to a shape, nowhere steeper than one, of which
/// [`separation`](crate::separation) is made.
///
/// Where `g ≤ u`, the shape's box is at most `u` away, so a search need not look farther. Outside
/// of the region in which a field keeps its steepness, `g` has the right sign and bounds nothing
/// around it.
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
/// use palpate_query::{DistanceBound, Placed};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::from_kernel(Ball::new(1.0)?);
/// let there = Placed::new(&ball, Pose::translation(Vector([4.0, 0.0])));
/// let [here, there] = DistanceBound::of_both(&ball, there)?;
/// assert_eq!(here.distance_gradient(Vector([3.0, 0.0])), (2.0, Vector([1.0, 0.0])));
/// assert_eq!(there.distance_gradient(Vector([2.0, 0.0])), (1.0, Vector([-1.0, 0.0])));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct DistanceBound<'a, const D: usize> {
    pub(crate) shape: &'a Shape<D>,
    /// `1/L`.
    scale: f64,
    /// Of the shape, in its own coordinates.
    aabb: Option<Aabb<D>>,
    region: Option<BoundingBall<D>>,
    /// From the frame of the search to the shape's; `None` where they are the same.
    body_from_frame: Option<Pose<D>>,
}

impl<'a, const D: usize> DistanceBound<'a, D> {
    /// The bound of a shape at a pose.
    pub(crate) fn new(shape: &'a Shape<D>, body_from_frame: Pose<D>) -> Self {
        let promise = shape.promise();
        let is_moved = body_from_frame != Pose::identity();
        Self {
            shape,
            scale: 1.0 / promise.lipschitz.max(1.0),
            aabb: promise.bounds.map(|bounds| bounds.aabb),
            region: promise.region,
            body_from_frame: is_moved.then_some(body_from_frame),
        }
    }

    /// `1/L`.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// From the frame of the search to the shape's.
    pub(crate) fn body_from_frame(&self) -> Pose<D> {
        self.body_from_frame.unwrap_or(Pose::identity())
    }

    /// The shape's box, in its own coordinates.
    pub(crate) fn own_box(&self) -> Option<Aabb<D>> {
        self.aabb
    }

    /// Those of two bodies, in world coordinates.
    ///
    /// # Errors
    ///
    /// If a pose is not finite or beyond 1e15 m.
    pub fn of_both(
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
    ) -> Result<[Self; 2], QueryError> {
        let (a, b) = (a.into(), b.into());
        check_pose(0, &a.world_from_body)?;
        check_pose(1, &b.world_from_body)?;
        Ok([a, b].map(|body| Self::new(body.shape, body.world_from_body.inverse())))
    }

    /// `true` if the field is the distance outside of the shape.
    pub(crate) fn is_exact_outside(&self) -> bool {
        self.shape.promise().outside == Quality::Exact
    }

    /// A point of the shape near another one, both of the frame: proven to be in it, or within two roundings
    /// of its surface where the field is exact outside.
    pub(crate) fn point_within(&self, p: Point<D>) -> Option<Point<D>> {
        let start = self.local(p);
        let along_gradients = self.shape.surface_point(start);
        let within = if self.is_exact_outside() {
            along_gradients?
        } else {
            let from_surface = along_gradients.and_then(|surface| self.behind_faces(surface));
            let found = [self.behind_faces(start), from_surface].into_iter().flatten();
            found.min_by(|a, b| (*a - start).norm().total_cmp(&(*b - start).norm()))?
        };
        Some(self.in_frame(within))
    }

    /// A point in the shape, in its own coordinates. Each step adds the half-space behind the tangent plane
    /// at the last point, and goes to the point nearest to the start in the last few half-spaces. Steps
    /// behind one face at a time converge slowly at a sharp edge.
    fn behind_faces(&self, start: Point<D>) -> Option<Point<D>> {
        let none = PlaneConstraint { point: start, normal: Vector::ZERO };
        let mut faces = [none; CAPACITY];
        let mut p = start;
        for step in 0..STEPS_WITHIN {
            let (value, slope) = self.shape.distance_gradient(p);
            let rounding = self.shape.promise().rounding.within(p.norm());
            if value <= -rounding {
                return Some(p);
            }
            let normal = (-slope).normalized()?;
            let point = p + normal * ((value + DEPTH_WITHIN * rounding) / slope.norm());
            faces.rotate_right(1);
            faces[0] = PlaneConstraint { point, normal };
            let met = CAPACITY.min(step + 1);
            // Without a common point the shape is not convex there, and the faces met last count.
            p = (1..=met).rev().find_map(|count| closest_point(start, &faces[..count]))?;
        }
        None
    }

    /// A box of the frame that holds the shape.
    pub(crate) fn aabb(&self) -> Option<Aabb<D>> {
        let aabb = self.aabb?;
        Some(match &self.body_from_frame {
            None => aabb,
            Some(pose) => {
                let placed = aabb.placed(&pose.inverse());
                placed.grown(self.geometry(placed.radius_about_origin()))
            }
        })
    }

    /// A box that holds all points of `aabb` within `grown` of the shape's own box, which may
    /// be turned; `None` if nothing is known, or there is none.
    ///
    /// Along a side of the own box, the other coordinates of a point of `aabb` leave each only
    /// so far to go.
    pub(crate) fn tightened(&self, aabb: &Aabb<D>, grown: f64) -> Option<Aabb<D>> {
        let (pose, own) = (self.body_from_frame.as_ref()?, self.aabb?);
        let rounding = self.geometry(aabb.radius_about_origin());
        let own = own.grown(grown + rounding);
        let mut tight = *aabb;
        for (i, row) in pose.rotation.matrix().iter().enumerate() {
            let [low, high] = [own.min[i], own.max[i]].map(|end| end - pose.translation[i]);
            for k in (0..D).filter(|&k| row[k].abs() > LEAST_TURN) {
                let (mut least, mut most) = (low, high);
                for j in (0..D).filter(|&j| j != k) {
                    let (one, other) = (row[j] * tight.min[j], row[j] * tight.max[j]);
                    least -= larger(one, other);
                    most += larger(-one, -other);
                }
                let (one, other) = (least / row[k], most / row[k]);
                let (from, to) = if row[k] < 0.0 { (other, one) } else { (one, other) };
                tight.min[k] = larger(tight.min[k], from - rounding);
                tight.max[k] = -larger(-tight.max[k], -to - rounding);
            }
        }
        (0..D).all(|k| tight.min[k] <= tight.max[k]).then_some(tight)
    }

    /// What `g` may be off by within `reach` of the frame's origin [m].
    pub(crate) fn slack(&self, reach: f64) -> f64 {
        let away = self.body_from_frame.map_or(0.0, |pose| pose.translation.norm());
        let rounding = self.shape.promise().rounding.within(reach + away);
        rounding * self.scale + self.geometry(reach)
    }

    /// Roundings of places within `reach` of the frame's origin [m].
    fn geometry(&self, reach: f64) -> f64 {
        let away = self.body_from_frame.map_or(0.0, |pose| pose.translation.norm());
        GEOMETRY_ROUNDINGS * f64::EPSILON * (reach + 2.0 * away)
    }

    /// A point in the shape's coordinates.
    #[inline]
    pub(crate) fn local(&self, p: Point<D>) -> Point<D> {
        match &self.body_from_frame {
            None => p,
            Some(pose) => pose.transform_point(p),
        }
    }

    /// A point of the frame, from one in the shape's coordinates.
    pub(crate) fn in_frame(&self, local: Point<D>) -> Point<D> {
        match &self.body_from_frame {
            None => local,
            Some(pose) => pose.inverse().transform_point(local),
        }
    }

    /// How boxes of the frame are turned in the shape's coordinates.
    pub(crate) fn turn(&self) -> Option<&Rotation<D>> {
        self.body_from_frame.as_ref().map(|pose| &pose.rotation)
    }

    /// `true` if the field is as steep as promised everywhere.
    pub(crate) fn is_known_everywhere(&self) -> bool {
        self.region.is_none()
    }

    /// `true` if the field is as steep as promised in a ball, in the shape's coordinates.
    #[inline]
    pub(crate) fn is_known(&self, local: Point<D>, radius: f64) -> bool {
        let inside =
            |region: BoundingBall<D>| (local - region.centre).norm() + radius <= region.radius;
        self.region.is_none_or(inside)
    }

    /// `g` at a point in the shape's coordinates where the field is `f`.
    #[inline]
    pub(crate) fn value(&self, local: Point<D>, f: f64) -> f64 {
        let (outside, _) = self.outside_box(local);
        larger(f * self.scale, outside)
    }

    /// What `g` is at least within `radius` of a point in the shape's coordinates where
    /// it is `value`: minus infinity where only the field itself would know.
    #[inline]
    pub(crate) fn floor(&self, local: Point<D>, value: f64, radius: f64) -> f64 {
        let known =
            if self.is_known(local, radius) { value } else { self.outside_box(local).0 };
        known - radius
    }

    /// The radius of a ball about a point in the shape's coordinates, where `g` is `value`, in which
    /// `g` is more than `level`; negative if there is none.
    #[inline]
    pub(crate) fn empty(&self, local: Point<D>, value: f64, level: f64) -> f64 {
        let empty = value - level;
        if empty.is_nan() {
            return empty;
        }
        match &self.region {
            None => empty,
            Some(region) => {
                let known = empty.min(region.radius - (local - region.centre).norm());
                known.max(self.outside_box(local).0 - level)
            }
        }
    }

    /// The radius of a ball about a point in the shape's coordinates, where `g` is `value`, that lies
    /// within the shape; negative if there is none.
    #[inline]
    pub(crate) fn filled(&self, local: Point<D>, value: f64) -> f64 {
        match &self.region {
            None => -value,
            Some(region) => (-value).min(region.radius - (local - region.centre).norm()),
        }
    }

    /// A model of `f/L` from one of `f`.
    #[inline]
    pub(crate) fn scaled(&self, model: Model) -> Model {
        let scale = self.scale;
        Model {
            value: model.value * scale,
            gradient: model.gradient.map(|side| side * scale),
            lower: model.lower * scale,
            upper: model.upper * scale,
        }
    }

    /// `g` [m] and its gradient at a point [m].
    #[must_use]
    #[inline]
    pub fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        let local = self.local(p);
        let (f, gradient) = self.shape.distance_gradient(local);
        self.slope_of(local, f, gradient)
    }

    /// `g` and its gradient in the frame, at a point in the shape's coordinates where the
    /// field is `f` and has a gradient.
    #[inline]
    pub(crate) fn slope_of(
        &self,
        local: Point<D>,
        f: f64,
        gradient: Vector<f64, D>,
    ) -> (f64, Vector<f64, D>) {
        let (outside, away) = self.outside_box(local);
        let inner = f * self.scale;
        // As `larger`: a value that is no number stays one.
        let (value, slope) =
            if outside > inner { (outside, away) } else { (inner, gradient * self.scale) };
        match &self.body_from_frame {
            None => (value, slope),
            Some(pose) => (value, pose.rotation.inverse().rotate(slope)),
        }
    }

    /// The distance to the box and its gradient; minus infinity inside, or without one.
    #[inline]
    fn outside_box(&self, local: Point<D>) -> (f64, Vector<f64, D>) {
        let Some(aabb) = &self.aabb else { return (f64::NEG_INFINITY, Vector::ZERO) };
        let mut away = Vector::ZERO;
        for k in 0..D {
            away[k] = larger(local[k] - aabb.max[k], 0.0) - larger(aabb.min[k] - local[k], 0.0);
        }
        let squared = away.dot(away);
        // Most points are inside, and need no root.
        if squared > 0.0 {
            let distance = squared.sqrt();
            (distance, away * (1.0 / distance))
        } else {
            (f64::NEG_INFINITY, away)
        }
    }
}

/// Steps of a descent at most.
const STEPS: u32 = 40;

/// A descent ends with a step that gains less than this share of the value.
const SLOW: f64 = 0.1;

/// Factors of the step length: after a step that lowers the value, and after one that does
/// not.
const GROW: f64 = 1.5;
const SHRINK: f64 = 0.25;

/// The negative of a minimax proximal step: `p − minimax_step([a, b], [slope_a, slope_b], step)`
/// is where the larger of two tangent planes at `p`, `a + slope_a·e` and `b + slope_b·e`, plus
/// `|e|²/(2·step)` is least. It is `step` times a mean of both slopes.
///
/// ```
/// use palpate_field::Vector;
/// use palpate_query::minimax_step;
///
/// // Two planes that rise towards each other meet in the middle.
/// let slopes = [Vector([1.0, 0.0]), Vector([-1.0, 0.0])];
/// assert_eq!(minimax_step([1.0, 1.0], slopes, 0.5), Vector([0.0, 0.0]));
/// ```
#[must_use]
#[inline]
pub fn minimax_step<const D: usize>(
    [a, b]: [f64; 2],
    [slope_a, slope_b]: [Vector<f64, D>; 2],
    step: f64,
) -> Vector<f64, D> {
    let between = slope_a - slope_b;
    let squared = between.dot(between);
    let share = if squared > 0.0 {
        (((a - b) / step - slope_b.dot(between)) / squared).clamp(0.0, 1.0)
    } else {
        0.5
    };
    (slope_a * share + slope_b * (1.0 - share)) * step
}

/// A point from `start` on at which the larger of both is less, and its value there;
/// values may be off by `slack`. The first step is `first` [m], or else as long as
/// the value there.
pub(crate) fn descend<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    start: Point<D>,
    first: Option<f64>,
    goal: Goal,
    slack: f64,
) -> (f64, Point<D>) {
    let mut p = start;
    let mut here = pair.slopes(p);
    let mut value = here[0].0.max(here[1].0);
    let mut step = first.unwrap_or(value.abs().max(goal.tolerance));
    let mut small_gains = 0;
    for _ in 0..STEPS {
        let [(a, slope_a), (b, slope_b)] = here;
        let next = p - minimax_step([a, b], [slope_a, slope_b], step);
        let there = pair.slopes(next);
        let next_value = there[0].0.max(there[1].0);
        if next_value < value {
            let gain = value - next_value;
            // Whether bodies that are far apart are so, boxes tell sooner.
            let is_slow = gain < SLOW * (next_value - goal.apart);
            (p, here, value) = (next, there, next_value);
            if is_slow {
                break;
            }
            step *= GROW;
            small_gains = if gain < 0.05 * goal.tolerance { small_gains + 1 } else { 0 };
        } else {
            step *= SHRINK;
        }
        let is_enough = goal.is_hit(value + slack);
        if is_enough || small_gains == 2 || step < 0.05 * goal.tolerance {
            break;
        }
    }
    (value, p)
}

#[cfg(test)]
mod tests {
    use palpate_field::kernel::Cuboid;

    use super::*;

    #[test]
    fn a_tightened_box_leaves_out_only_what_is_outside_of_a_turned_one() {
        let bar = Shape::from_kernel(Cuboid::new(Vector([2.0, 0.2, 0.3])).unwrap());
        let aabb = Aabb { min: Vector([-0.5; 3]), max: Vector([0.5, 0.4, 0.6]) };
        let places = |n: u32| (0..=n).map(move |i| f64::from(i) / f64::from(n));
        let mut smallest = f64::INFINITY;
        for turn in places(40) {
            let axis = Vector([1.0, turn - 0.3, 0.5 - turn]);
            let rotation = Rotation::from_axis_angle(axis, 7.0 * turn).unwrap();
            let pose = Pose::new(rotation, Vector([0.3 - turn, 0.2, turn * turn]));
            let body = DistanceBound::new(&bar, pose);
            let grown = 0.02 * turn;
            let tight = body.tightened(&aabb, grown);
            let own = bar.promise().bounds.unwrap().aabb.grown(grown);
            for x in places(12) {
                for (y, z) in places(12).flat_map(|y| places(12).map(move |z| (y, z))) {
                    let share = Vector([x, y, z]);
                    let sides = aabb.max - aabb.min;
                    let p = aabb.min + Vector(std::array::from_fn(|k| share[k] * sides[k]));
                    let is_in_both = own.contains(body.local(p));
                    assert!(!is_in_both || tight.is_some_and(|tight| tight.contains(p)));
                }
            }
            let volume = |aabb: Aabb<3>| (aabb.max - aabb.min).0.iter().product::<f64>();
            smallest = smallest.min(tight.map_or(1.0, |tight| volume(tight) / volume(aabb)));
        }
        assert!(smallest < 0.25, "{smallest}");
    }
}

#[cfg(test)]
mod descent_tests {
    use super::*;

    #[test]
    fn the_way_is_along_the_larger_plane_or_to_where_both_are_equal() {
        let (left, up) = (Vector([-1.0, 0.0]), Vector([0.0, 1.0]));
        assert_eq!(minimax_step([5.0, 1.0], [left, up], 0.5), Vector([-0.5, 0.0]));
        assert_eq!(minimax_step([1.0, 1.0], [left, up], 0.5), Vector([-0.25, 0.25]));
        // Planes that face each other: to the middle, whatever the size.
        for size in [2.0, 50.0] {
            let way = minimax_step([1.0, 2.0], [left, -left], size);
            assert!((way - Vector([0.5, 0.0])).norm() < 1e-13, "{way:?}");
        }
    }
}
