// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Separations from their definition, by a search that shares no code with the library's.
//!
//! ```text
//! g = max(f/L, distance to the box),    separation = 2·min over p of max(g_a(p), g_b(p)).
//! ```
//!
//! `f` is a body's field, `L` its Lipschitz constant, at least one, and the box that of its
//! promise. So `g` has a Lipschitz constant of 1, and so has the larger of two: over a cell it
//! is at least the value at the centre minus the cell's radius. The search uses nothing else:
//! no models, no points beside the cells, no blocks. It evaluates points one by one and halves
//! cells best first. That takes many cells, but each step is easy to check.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use palpate_field::{Aabb, Point, Pose, Shape, Vector};

/// The rounding of points, of distances to boxes and of radii, relative to the largest
/// coordinate.
const ROUNDINGS: f64 = 32.0 * f64::EPSILON;

/// A new least value is polished if it is lower by this share.
const NOTABLE: f64 = 0.02;

/// The step at which polishing ends, as a share of the value.
const FINEST: f64 = 1e-3;

/// The most steps of polishing.
const STEPS: usize = 80;

/// Bounds of a separation [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower bound, rounding included.
    pub lower: f64,
    /// The upper bound, rounding included.
    pub upper: f64,
}

impl Interval {
    /// `true` if the bodies are proven to overlap or to be apart.
    #[must_use]
    pub fn has_sign(&self) -> bool {
        self.upper < 0.0 || self.lower > 0.0
    }

    /// `true` if the bounds are no further apart than `share` of the smaller.
    #[must_use]
    pub fn is_within(&self, share: f64) -> bool {
        self.has_sign()
            && self.upper - self.lower <= share * self.upper.abs().min(self.lower.abs())
    }
}

/// Bounds the separation of two shapes, each where its pose `world_from_body` puts it, until
/// `is_enough` accepts the bounds, or `cells` are spent.
///
/// # Panics
///
/// If neither body is bounded, or the promise of a field holds only in a region.
pub fn separation<const D: usize>(
    bodies: [(&Shape<D>, Pose<D>); 2],
    cells: usize,
    is_enough: impl Fn(&Interval) -> bool,
) -> Interval {
    let bodies = bodies.map(|(shape, pose)| Body::new(shape, pose));
    let start = common(&bodies, 0.0).centre();
    let mut search = Search { bodies, best: f64::INFINITY, slack: 0.0 };
    search.polish(start, search.value(start).abs());
    // Points farther from one of the boxes than the best value have a larger g of that body.
    let margin = search.best.max(0.0) * (1.0 + ROUNDINGS);
    let root = common(&search.bodies, margin + ROUNDINGS * search.reach(start.norm() + margin));
    let reach = search.reach(root.centre().norm());
    search.slack = search.bodies.iter().map(|body| body.rounding(reach)).fold(0.0, f64::max);
    search.halve(root, cells, is_enough)
}

/// A field with the numbers that make `g` of it.
struct Body<'a, const D: usize> {
    shape: &'a Shape<D>,
    world_from_body: Pose<D>,
    body_from_world: Pose<D>,
    lipschitz: f64,
    /// The box, in the shape's coordinates.
    aabb: Option<Aabb<D>>,
}

impl<'a, const D: usize> Body<'a, D> {
    fn new(shape: &'a Shape<D>, world_from_body: Pose<D>) -> Self {
        let promise = shape.promise();
        assert!(promise.region.is_none(), "a field that is steeper elsewhere: {shape:?}");
        Self {
            shape,
            world_from_body,
            body_from_world: world_from_body.inverse(),
            lipschitz: promise.lipschitz.max(1.0),
            aabb: promise.bounds.map(|bounds| bounds.aabb),
        }
    }

    /// The vector from the nearest point of the box to a point in the shape's coordinates; zero
    /// inside.
    fn away_from_box(&self, local: Point<D>) -> Vector<f64, D> {
        self.aabb.map_or(Vector::ZERO, |aabb| {
            Vector(std::array::from_fn(|k| local[k] - local[k].clamp(aabb.min[k], aabb.max[k])))
        })
    }

    fn value(&self, p: Point<D>) -> f64 {
        let local = self.body_from_world.transform_point(p);
        let inner = self.shape.distance(local) / self.lipschitz;
        let outside = self.away_from_box(local).norm();
        if outside > 0.0 { inner.max(outside) } else { inner }
    }

    fn slope(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        let local = self.body_from_world.transform_point(p);
        let (f, gradient) = self.shape.distance_gradient(local);
        let inner = f / self.lipschitz;
        let away = self.away_from_box(local);
        let outside = away.norm();
        let (value, slope) = if outside > 0.0 && outside > inner {
            (outside, away * (1.0 / outside))
        } else {
            (inner, gradient * (1.0 / self.lipschitz))
        };
        (value, self.world_from_body.transform_vector(slope))
    }

    /// The largest distance of the shape from the world's or its own origin [m].
    fn reach(&self) -> f64 {
        let radius = self.shape.promise().bounds.map_or(0.0, |b| b.radius_about_origin());
        radius + self.world_from_body.translation.norm()
    }

    /// The error of `g` within `reach` of the world's origin [m].
    fn rounding(&self, reach: f64) -> f64 {
        let reach = reach + self.world_from_body.translation.norm();
        self.shape.promise().rounding.within(reach) + ROUNDINGS * reach
    }
}

/// The intersection of both boxes, grown by `margin`; the room between them if it is empty.
fn common<const D: usize>(bodies: &[Body<'_, D>; 2], margin: f64) -> Aabb<D> {
    let grown = |body: &Body<'_, D>| {
        body.aabb.map(|aabb| aabb.placed(&body.world_from_body).grown(margin))
    };
    let boxes: Vec<Aabb<D>> = bodies.iter().filter_map(grown).collect();
    let [first, others @ ..] = &boxes[..] else { panic!("both bodies are unbounded") };
    let mut whole = *first;
    for other in others {
        for k in 0..D {
            whole.min[k] = whole.min[k].max(other.min[k]);
            whole.max[k] = whole.max[k].min(other.max[k]);
        }
    }
    whole
}

/// A box over which the larger `g` is at least `lower`.
struct Cell<const D: usize> {
    lower: f64,
    centre: Point<D>,
    half: Vector<f64, D>,
}

impl<const D: usize> Ord for Cell<D> {
    fn cmp(&self, other: &Self) -> Ordering {
        other.lower.total_cmp(&self.lower)
    }
}

impl<const D: usize> PartialOrd for Cell<D> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<const D: usize> PartialEq for Cell<D> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<const D: usize> Eq for Cell<D> {}

struct Search<'a, const D: usize> {
    bodies: [Body<'a, D>; 2],
    /// The least value found so far.
    best: f64,
    /// The error of values and points [m].
    slack: f64,
}

impl<const D: usize> Search<'_, D> {
    fn value(&self, p: Point<D>) -> f64 {
        let [a, b] = &self.bodies;
        a.value(p).max(b.value(p))
    }

    /// The largest distance from the origin that matters near a point at `distance` [m].
    fn reach(&self, distance: f64) -> f64 {
        let [a, b] = &self.bodies;
        distance + self.best.abs() + a.reach() + b.reach()
    }

    fn interval(&self, lower: f64) -> Interval {
        Interval {
            lower: 2.0 * (lower.min(self.best) - self.slack),
            upper: 2.0 * (self.best + self.slack),
        }
    }

    /// Halves cells along the longest side, best first.
    fn halve(
        &mut self,
        root: Aabb<D>,
        cells: usize,
        is_enough: impl Fn(&Interval) -> bool,
    ) -> Interval {
        let lower = f64::NEG_INFINITY;
        let mut open = BinaryHeap::new();
        open.push(Cell { lower, centre: root.centre(), half: root.half_extents() });
        let mut count = 0;
        while let Some(cell) = open.pop() {
            let interval = self.interval(cell.lower);
            if cell.lower >= self.best || count >= cells || is_enough(&interval) {
                return interval;
            }
            let longest =
                (1..D).fold(0, |long, k| if cell.half[k] > cell.half[long] { k } else { long });
            let mut half = cell.half;
            half[longest] *= 0.5;
            for side in [-1.0, 1.0] {
                let mut centre = cell.centre;
                centre[longest] += side * half[longest];
                let value = self.value(centre);
                if value < self.best - NOTABLE * self.best.abs() {
                    self.polish(centre, half.norm());
                }
                let lower = cell.lower.max(value - half.norm());
                if lower < self.best {
                    open.push(Cell { lower, centre, half });
                }
                count += 1;
            }
        }
        self.interval(self.best)
    }

    /// Descends from `start` in steps of at most `radius`: along either gradient, or to the
    /// surface where both fields are equal and on along it.
    fn polish(&mut self, start: Point<D>, mut radius: f64) {
        let slopes = |search: &Self, p| [search.bodies[0].slope(p), search.bodies[1].slope(p)];
        let (mut p, mut here) = (start, slopes(self, start));
        let mut value = here[0].0.max(here[1].0);
        for _ in 0..STEPS {
            let mut better = None;
            for step in steps(&here, radius) {
                let next = p + step;
                let there = slopes(self, next);
                let next_value = there[0].0.max(there[1].0);
                if next_value < better.map_or(value, |(_, _, least)| least) {
                    better = Some((next, there, next_value));
                }
            }
            if let Some(better) = better {
                (p, here, value) = better;
                radius *= 1.6;
            } else {
                radius *= 0.35;
            }
            if radius <= FINEST * value.abs() {
                break;
            }
        }
        self.best = self.best.min(value);
    }
}

/// Three steps of at most `radius` that lower the maximum of two tangent planes.
fn steps<const D: usize>(
    [(a, slope_a), (b, slope_b)]: &[(f64, Vector<f64, D>); 2],
    radius: f64,
) -> [Vector<f64, D>; 3] {
    let downhill = |slope: Vector<f64, D>, length: f64| {
        slope.normalized().map_or(Vector::ZERO, |direction| direction * -length)
    };
    let between = *slope_a - *slope_b;
    let squared = between.dot(between);
    let mut valley = Vector::ZERO;
    if squared > 0.0 {
        let across = between * ((b - a) / squared);
        let length = across.norm();
        let across = if length > radius { across * (radius / length) } else { across };
        let left = (radius * radius - across.dot(across)).max(0.0).sqrt();
        let along = *slope_a - between * (between.dot(*slope_a) / squared);
        valley = across + downhill(along, left);
    }
    [downhill(*slope_a, radius), downhill(*slope_b, radius), valley]
}

#[cfg(test)]
mod tests {
    use palpate_field::kernel::{Ball, Cuboid};
    use palpate_field::{Pose, Rotation, Shape, ShapeError, Vector};

    use super::separation;

    #[test]
    fn balls_and_a_box_are_as_far_apart_as_they_are() -> Result<(), ShapeError> {
        let ball = Shape::<3>::from_kernel(Ball::new(0.5)?);
        let small = Shape::from_kernel(Ball::new(0.3)?);
        let block = Shape::from_kernel(Cuboid::new(Vector([0.6, 0.4, 0.8]))?);
        let turn = Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), 2.0)?;
        for gap in [0.01, -0.02] {
            let centre = Pose::new(turn, Vector([3.0, 0.5, -1.0]));
            let way = Pose::translation(Vector([0.48, 0.6, 0.64]) * (0.8 + gap));
            let beside = Pose::translation(Vector([0.1, 0.7 + gap, -0.1]));
            for (other, way) in [(&small, way), (&block, beside)] {
                let answer =
                    separation([(&ball, centre), (other, centre * way)], 200_000, |s| {
                        s.is_within(0.05)
                    });
                assert!(answer.lower <= gap && gap <= answer.upper, "{answer:?}");
                assert!(answer.is_within(0.05), "{answer:?}");
            }
        }
        Ok(())
    }
}
