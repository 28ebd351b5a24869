// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Polygons with holes.

use std::sync::Arc;

use super::line::Edge;
use super::sides::{self, model_by_sides, or_constant};
use crate::bounds::{Aabb, Bounds};
use crate::error::{ShapeError, Unit, finite};
use crate::kernel::mark::Mark;
use crate::kernel::{Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Dual, Float, Scalar};
use crate::vector::{Point, Vector};

/// The most edges of one polygon: a distance evaluates each.
const MOST_EDGES: usize = 100_000;

/// Closer to an edge than this many roundings of the polygon's size, the even-odd rule and the
/// side of the edge may disagree.
const ON_EDGE: f64 = 64.0;

/// Sides in a group, whose box rules all of them out at once.
const GROUP: usize = 8;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 16.0;

/// The inside of closed rings of straight edges, by the even-odd rule. Exact.
///
/// A point is inside if a ray from it crosses an odd number of edges: rings in
/// rings are holes, whatever their direction. The distance is the least to an
/// edge.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Polygon};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let square = |r: f64| vec![Vector([r, r]), Vector([-r, r]), Vector([-r, -r]), Vector([r, -r])];
/// let frame = Shape::from_kernel(Polygon::new(vec![square(4.0), square(1.0)])?);
/// assert_eq!(frame.distance(Vector([0.0, 0.0])), 1.0); // in the hole
/// assert_eq!(frame.distance(Vector([0.0, 3.0])), -1.0); // in the frame
/// assert_eq!(frame.distance(Vector([7.0, 8.0])), 5.0); // past a corner
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Polygon {
    rings: Arc<[Vec<Point<2>>]>,
    sides: Arc<[Side]>,
    /// The boxes around so many sides each, in their order.
    groups: Arc<[Aabb<2>]>,
    bounds: Bounds<2>,
}

/// An edge, and where rays along x cross it.
#[derive(Clone, Copy, Debug)]
struct Side {
    edge: Edge,
    /// The lower end; the crossing rule takes the edge upwards.
    low: [f64; 2],
    /// From the lower end to the upper.
    rise: [f64; 2],
    /// The y of the upper end.
    top: f64,
}

impl Side {
    fn new(from: Point<2>, to: Point<2>) -> Self {
        let (low, high) = if to[1] < from[1] { (to, from) } else { (from, to) };
        Self { edge: Edge::new(from, to), low: low.0, rise: (high - low).0, top: high[1] }
    }

    /// `-inside` if the ray from `p` towards +x crosses the edge, else `inside`.
    #[inline(always)]
    fn crossed<S: Scalar>(&self, p: Vector<S, 2>, inside: S) -> S {
        let zero = S::constant(0.0);
        let [x, y] = (p - Vector::of(&self.low)).0;
        let right_of = x.scale(self.rise[1]) - y.scale(self.rise[0]);
        let crossed = S::select_less(right_of, zero, -inside, inside);
        let below_top = S::select_less(p.0[1], S::constant(self.top), crossed, inside);
        S::select_less(y, zero, inside, below_top)
    }
}

impl Polygon {
    /// The inside of `rings` [m], each closed from its last point to its first.
    ///
    /// # Errors
    ///
    /// If there is no ring, a ring has fewer than 3 points, there are more than
    /// 100 000 points, or a coordinate is not finite.
    pub fn new(rings: Vec<Vec<Point<2>>>) -> Result<Self, ShapeError> {
        let count = |rule: &'static str, count| {
            Err(ShapeError::Count { parameter: "rings".into(), rule: rule.into(), count })
        };
        if rings.is_empty() {
            return count("at least 1 ring", 0);
        }
        let edges: usize = rings.iter().map(Vec::len).sum();
        if edges > MOST_EDGES {
            return count("at most 100000 points", edges);
        }
        let mut sides = Vec::with_capacity(edges);
        for ring in &rings {
            if ring.len() < 3 {
                return count("at least 3 points in each ring", ring.len());
            }
            for (i, from) in ring.iter().enumerate() {
                for x in from.0 {
                    finite("rings", x, Unit::Metre)?;
                }
                let to = ring[(i + 1) % ring.len()];
                if *from != to {
                    sides.push(Side::new(*from, to));
                }
            }
        }
        let aabb = Aabb::around(rings.iter().flatten().copied());
        let (Some(aabb), false) = (aabb, sides.is_empty()) else {
            return count("two different points", 0);
        };
        let ends = |side: &Side| [side.low, [side.low[0] + side.rise[0], side.top]].map(Vector);
        let around = |group: &[Side]| Aabb::around(group.iter().flat_map(ends)).unwrap_or(aabb);
        let groups = sides.chunks(GROUP).map(around).collect();
        let bounds = Bounds::of_box(aabb);
        Ok(Self { rings: rings.into(), sides: sides.into(), groups, bounds })
    }

    /// The edges nearer to a point than `reach` [m], and perhaps some more.
    fn near(&self, p: Point<2>, reach: f64) -> impl Iterator<Item = sides::Side> {
        let is_near = move |side: &&Side| {
            let [across, past] = side.edge.offsets(p);
            across.abs() <= reach && past <= reach
        };
        let is_near_group =
            move |(group, _): &(&Aabb<2>, _)| distance_to_box(group, p) <= reach;
        let groups = self.groups.iter().zip(self.sides.chunks(GROUP)).filter(is_near_group);
        let near = groups.flat_map(|(_, group)| group).filter(is_near);
        near.map(|side| sides::Side { edge: side.edge, off: 0.0 })
    }

    /// The distance, without groups of sides that are farther than others by more than an
    /// `error`, or that a ray along x does not cross.
    fn signed_distance(&self, p: Point<2>, error: f64) -> f64 {
        let groups = || self.groups.iter().zip(self.sides.chunks(GROUP));
        let least = |nearest: f64, group: &[Side]| {
            group.iter().fold(nearest, |nearest, side| nearest.min(side.edge.distance(p)))
        };
        // The group whose box is nearest rules out most of the others.
        let apart = |group: &(&Aabb<2>, &[Side])| distance_to_box(group.0, p);
        let first = groups().min_by(|a, b| apart(a).total_cmp(&apart(b)));
        let nearest = first.map_or(f64::INFINITY, |(_, group)| least(f64::INFINITY, group));
        let nearest = groups().fold(nearest, |nearest, group| {
            // Written so that NaN is looked at.
            if apart(&group) > nearest + error { nearest } else { least(nearest, group.1) }
        });
        let inside = groups().fold(1.0, |inside, (around, group)| {
            let is_beside =
                p[1] < around.min[1] || p[1] > around.max[1] || p[0] > around.max[0];
            if is_beside {
                return inside;
            }
            group.iter().fold(inside, |inside, side| side.crossed(p, inside))
        });
        if inside < 0.0 { -nearest } else { nearest }
    }

    /// `-1` inside, `1` outside.
    #[inline(always)]
    fn side_of<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.sides.iter().fold(S::constant(1.0), |inside, side| side.crossed(p, inside))
    }
}

/// The distance of a point from a box [m].
fn distance_to_box(around: &Aabb<2>, p: Point<2>) -> f64 {
    let past = [0, 1].map(|k| (around.min[k] - p[k]).max(p[k] - around.max[k]).max(0.0));
    Vector(past).norm()
}

impl Kernel<2> for Polygon {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let zero = S::constant(0.0);
        let mut nearest = self.sides[0].edge.distance(p);
        for side in &self.sides[1..] {
            nearest = nearest.min(side.edge.distance(p));
        }
        S::select_less(self.side_of(p), zero, -nearest, nearest)
    }

    /// On an edge, the edge's normal, towards the side where a point near by is
    /// outside.
    #[inline(always)]
    fn distance_gradient<T: Float>(&self, p: Vector<T, 2>) -> (T, Vector<T, 2>) {
        let zero = T::constant(0.0);
        let mut nearest = &self.sides[0];
        let mut distance = nearest.edge.distance(p);
        for side in &self.sides[1..] {
            let here = side.edge.distance(p);
            if here < distance {
                (distance, nearest) = (here, side);
            }
        }
        let one = T::constant(1.0);
        let inside = self.side_of(p) < zero;
        let signed = if inside { -distance } else { distance };
        let on_edge = ON_EDGE * T::epsilon() * self.bounds.radius_about_origin();
        let normal = Vector::of(&nearest.edge.across());
        let [_, past] = nearest.edge.offsets(p);
        let gradient = if distance.to_f64() <= on_edge && past == zero {
            let right_is_inside = self.side_of(p + normal.scale(2.0 * on_edge)) < zero;
            normal * if right_is_inside { -one } else { one }
        } else {
            let away = nearest.edge.distance(Vector(Dual::variables(p.0))).gradient;
            Vector(away) * if inside { -one } else { one }
        };
        (signed, gradient)
    }

    const HAS_OWN_MODEL: bool = true;

    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        let centre = Vector(cell.0.map(|x| x.value));
        let radius = AffineModel::radius(&cell.0);
        let far = self.bounds.radius_about_origin() + centre.norm() + radius;
        let value = self.signed_distance(centre, ON_EDGE * f64::EPSILON * far);
        let rounding = OPERATIONS * f64::EPSILON * far;
        let constant = AffineModel::lipschitz(value, 1.0, &cell.0, rounding);
        let error = ON_EDGE * f64::EPSILON * far;
        // On an edge, the value does not say which side of it is inside.
        if value.abs() <= error {
            return constant;
        }
        let radius = radius + error;
        let near = self.near(centre, value.abs() + 2.0 * radius);
        or_constant(model_by_sides(cell, value, radius, near), constant, error)
    }

    fn promise(&self) -> Promise<2> {
        let size = self.bounds.radius_about_origin();
        Promise::exact(Some(self.bounds), OPERATIONS, size)
    }
}

primitive! {
    Polygon, polygon, 2,
    about: "The inside of closed rings by the even-odd rule: rings in rings are holes.",
    origin: "given by its points",
    parameters: { rings: Rings = "lists of at least 3 points, each closed by itself" },
    marks: |kernel| {
        let ring = |(i, ring): (usize, &Vec<Vector<f64, 2>>)| {
            Mark::positions("rings", ring).into_iter().map(move |mark| mark.of(i))
        };
        kernel.rings().iter().enumerate().flat_map(ring).collect()
    },
    example: (vec![
        vec![
            Vector([-0.8, -0.5]),
            Vector([0.7, -0.6]),
            Vector([0.9, 0.2]),
            Vector([0.2, 0.1]),
            Vector([-0.3, 0.8]),
        ],
        vec![Vector([-0.4, -0.3]), Vector([0.1, -0.4]), Vector([-0.2, 0.2])],
    ]),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, Row, polygon};

    impl Evidence<2> for Polygon {
        const SAMPLE: &'static str = r#"{ "rings": [
             [[-0.05, -0.05], [0.05, -0.05], [0.05, 0.01], [0, 0.05], [-0.05, 0.01]],
             [[-0.015, -0.03], [0.015, -0.03], [0.015, 0], [-0.015, 0]]] }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Polygon", "`rings`: one, or several with holes", "exact")];

        fn definition(&self) -> Definition<2> {
            polygon(self.rings().to_vec())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            let square = |half: f64| {
                [[half, half], [-half, half], [-half, -half], [half, -half]]
                    .map(Vector)
                    .to_vec()
            };
            vec![
                Self::new(vec![]),
                Self::new(vec![vec![]]),
                Self::new(vec![square(1.0), square(f64::NAN)]),
                Self::new(vec![vec![Vector([1.0, 2.0]); 3]]),
                Self::new(vec![square(1.0); 30_000]),
            ]
        }
    }
}
