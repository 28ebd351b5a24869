// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The quadratic Bézier curve.

use super::bent::{Bent, Disc, Pieces};
use super::parabola_foot::Quadratic;
use super::sides::{model_by_sides, or_constant};
use crate::bounds::{Aabb, Bounds};
use crate::error::{ShapeError, Unit, finite, not_negative};
use crate::kernel::mark::{Mark, across};
use crate::kernel::{Kernel, primitive};
use crate::promise::{Promise, Quality};
use crate::scalar::{AffineModel, Float, Scalar};
use crate::vector::{Point, Vector, array};

/// Newton steps in the curve's own parameter, each of which doubles the digits.
const POLISH: usize = 2;

/// The error of a zero in the parabola's parameter, in roundings of the distance of its vertex
/// from the curve's ends.
const OFF: f64 = 1024.0;

/// The most that polishing moves a zero, as a share of the curve.
const MOST_OFF: f64 = 0.25;

/// A curve bent by less than this many roundings counts as straight.
const STRAIGHT: f64 = 8.0;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 6.0;

/// How far points of the curve, and with them a model by pieces, may be off, in roundings of the
/// largest number.
const PIECE_OFF: f64 = 32.0;

/// All points within `radius` of a quadratic Bézier curve, that from `from` to `to`
/// with one control point between.
///
/// Exact; inside a bound if the radius is more than the curve's least radius of
/// curvature. With a radius of zero it has no inside.
///
/// # Derivation
///
/// With `d = control − from` and `c = from − 2 control + to`, the curve is
/// `B(t) = from + 2td + t²c` for t in [0, 1]: a parabola along c, with its vertex at
/// `t₀ = −d·c/c²` and, from there, `(eτ, |c|τ²)` in the frame of c, where `e` is twice
/// the part of d across c. Of all its points, the nearest on either side of the axis
/// are zeros of one cubic (`Quadratic`); clamped to [0, 1], one of them is the nearest
/// of the curve: the square of the distance has one minimum on either side and falls
/// towards it, so an end of [0, 1] is nearest only if a minimum is beyond it.
///
/// A curve that is nearly straight is a small part of a large parabola, far from its vertex. So
/// the zeros are polished in t itself, where nothing cancels, by no more than their error. A
/// curve with equal steps, `c = 0`, is a line.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::QuadraticBezier};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// // y = x² for |x| ≤ 2.
/// let [a, b, c] = [[-2.0, 4.0], [0.0, -4.0], [2.0, 4.0]].map(Vector);
/// let wire = Shape::from_kernel(QuadraticBezier::new(a, b, c, 0.25)?);
/// assert_eq!(wire.distance(Vector([0.0, -2.0])), 1.75);
/// assert!((wire.distance(Vector([5.0, 8.0])) - 4.75).abs() < 1e-14); // past an end
/// // Out of (1, 1) along its normal (2, −1).
/// let five = 5.0_f64.sqrt();
/// assert!((wire.distance(Vector([3.0, 0.0])) - five + 0.25).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct QuadraticBezier {
    from: [f64; 2],
    control: Point<2>,
    to: Point<2>,
    /// d.
    step: [f64; 2],
    /// c.
    bend: [f64; 2],
    radius: f64,
    /// The longer of the two steps, `control − from` and `to − control`.
    length: f64,
    /// |d × c|.
    turning: f64,
    /// The unit vectors across c and along it.
    axes: [[f64; 2]; 2],
    vertex: [f64; 2],
    /// t₀.
    start: f64,
    curve: Quadratic,
    /// From one end to the other, over the square of the length.
    along: [f64; 2],
    promise: Promise<2>,
}

impl QuadraticBezier {
    /// The curve from one point to another [m], which it leaves towards `control` and
    /// reaches from there, with a `radius` [m].
    ///
    /// # Errors
    ///
    /// If the radius is negative or a coordinate not finite.
    pub fn new(
        from: Point<2>,
        control: Point<2>,
        to: Point<2>,
        radius: f64,
    ) -> Result<Self, ShapeError> {
        for (name, point) in [("from", from), ("control", control), ("to", to)] {
            for x in point.0 {
                finite(name, x, Unit::Metre)?;
            }
        }
        not_negative("radius", radius, Unit::Metre)?;
        let chord = to - from;
        let (mut step, last) = (control - from, to - control);
        let mut bend = last - step;
        let length = step.norm().max(last.norm());
        let straight = bend.norm() <= STRAIGHT * f64::EPSILON * length;
        if straight {
            (step, bend) = (chord * 0.5, Vector::ZERO);
        }
        // A straight curve does not use its parabola; any values do.
        let up = bend.normalized().unwrap_or(Vector([0.0, 1.0]));
        let height = if straight { 1.0 } else { bend.norm() };
        let start = if straight { 0.0 } else { -step.dot(up) / height };
        let right = Vector([up[1], -up[0]]);
        let half_speed = step.dot(right);
        let right = if half_speed < 0.0 { -right } else { right };
        let vertex = from + step * (2.0 * start) + bend * (start * start);
        let square = chord.dot(chord);
        let along = if square > 0.0 { chord * (1.0 / square) } else { Vector::ZERO };
        let mut this = Self {
            from: from.0,
            control,
            to,
            step: step.0,
            bend: bend.0,
            radius,
            length,
            turning: (step[0] * bend[1] - step[1] * bend[0]).abs(),
            axes: [right.0, up.0],
            vertex: vertex.0,
            start,
            curve: Quadratic::new(2.0 * half_speed.abs(), height),
            along: along.0,
            promise: Promise::exact(None, 0.0, 0.0),
        };
        this.promise = this.promised(from, to);
        Ok(this)
    }

    /// The point at a parameter.
    fn at(&self, t: f64) -> Point<2> {
        Vector(self.from) + Vector(self.step) * (2.0 * t) + Vector(self.bend) * (t * t)
    }

    fn promised(&self, from: Point<2>, to: Point<2>) -> Promise<2> {
        // An extreme along an axis is an end, or a point where the curve runs across the axis.
        let turns = array!(i < 2 => {
            let turn = -self.step[i] / self.bend[i];
            if turn > 0.0 && turn < 1.0 { turn } else { 0.0 }
        });
        let points = [from, to, self.at(turns[0]), self.at(turns[1])];
        let largest = points.iter().fold(self.length, |m, p| m.max(p.norm()));
        let bounds = Aabb::around(points).map(|aabb| {
            Bounds::of_box(aabb.grown(4.0 * f64::EPSILON * largest)).grown(self.radius)
        });
        // 2|B'/2|³ / |d × c|, where |B'| is the least.
        let nearest_vertex = self.start.clamp(0.0, 1.0);
        let speed = Vector(self.step) + Vector(self.bend) * nearest_vertex;
        let cube = speed.dot(speed) * speed.norm();
        let meets_itself = 2.0 * cube < self.radius * self.turning
            || speed.norm() <= STRAIGHT * f64::EPSILON * self.length;
        let fills = self.radius > 0.0 && meets_itself;
        Promise {
            inside: if fills { Quality::Bound } else { Quality::Exact },
            has_interior: self.radius > 0.0,
            ..Promise::exact(bounds, OPERATIONS, largest + self.radius)
        }
    }

    /// `p − B(t)`, where `from` is `p − B(0)`.
    #[inline(always)]
    fn offset<S: Scalar>(&self, from: Vector<S, 2>, t: S) -> Vector<S, 2> {
        let (step, bend) = (&self.step, &self.bend);
        Vector(array!(i < 2 => {
            from.0[i] - t * (t.scale(bend[i]) + S::constant(2.0 * step[i]))
        }))
    }

    /// Half of `B'(t)`.
    #[inline(always)]
    fn speed<S: Scalar>(&self, t: S) -> Vector<S, 2> {
        Vector(array!(i < 2 => t.scale(self.bend[i]) + S::constant(self.step[i])))
    }

    /// Candidates for the parameter of the nearest point, not clamped yet.
    #[inline(always)]
    fn candidates<S: Scalar>(&self, p: Vector<S, 2>, from: Vector<S, 2>) -> [S; 2] {
        let bend = self.bend[0].abs().max(self.bend[1].abs());
        if bend <= STRAIGHT * S::epsilon() * self.length {
            let t = from.dot_constant(&self.along);
            return [t, t];
        }
        let q = p - Vector::of(&self.vertex);
        let [a, b] = array!(i < 2 => q.dot_constant(&self.axes[i]));
        let feet = self.curve.feet(a.abs(), b);
        array!(i < 2 => {
            let tau = S::select_less(a, S::constant(0.0), -feet[i], feet[i]);
            tau + S::constant(self.start)
        })
    }

    /// A candidate on the curve, polished.
    #[inline(always)]
    fn polished<S: Scalar>(&self, from: Vector<S, 2>, candidate: S) -> S {
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        let off = OFF * S::epsilon().max(f64::EPSILON) * (1.0 + self.start.abs());
        let most = off.min(MOST_OFF);
        let mut t = candidate.clamp(0.0, 1.0);
        for _ in 0..POLISH {
            let (offset, speed) = (self.offset(from, t), self.speed(t));
            // A quarter of the derivative of the square of the distance, and its own.
            let slope = -offset.dot(speed);
            let rise = speed.dot(speed).scale(2.0) - offset.dot_constant(&self.bend);
            let step = slope / S::select_less(zero, rise, rise, one);
            let step = S::select_less(zero, rise, step, zero);
            t = (t - step.clamp(-most, most)).clamp(0.0, 1.0);
        }
        t
    }

    /// The nearest point's parameter, the offset from it, and its length.
    #[inline(always)]
    fn solve<S: Scalar>(&self, p: Vector<S, 2>) -> (S, Vector<S, 2>, S) {
        let from = p - Vector::of(&self.from);
        let candidates = self.candidates(p, from);
        let [first, second] = array!(i < 2 => self.polished(from, candidates[i]));
        let (near, far) = (self.offset(from, first), self.offset(from, second));
        let (length, other) = (near.norm(), far.norm());
        let choose = |far: S, near: S| S::select_less(other, length, far, near);
        let nearest = Vector(array!(i < 2 => choose(far.0[i], near.0[i])));
        (choose(second, first), nearest, length.min(other))
    }
}

impl Kernel<2> for QuadraticBezier {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.solve(p).2 - S::constant(self.radius)
    }

    /// The gradient is along the line from the nearest point. Nearer to the curve than the
    /// centre of curvature, it is the curve's normal, which is more precise.
    #[inline(always)]
    fn distance_gradient<T: Float>(&self, p: Vector<T, 2>) -> (T, Vector<T, 2>) {
        let (zero, one) = (T::constant(0.0), T::constant(1.0));
        let unit = |v: Vector<T, 2>| {
            let length = v.norm();
            let inverse = one / T::select_less(zero, length, length, one);
            let across = T::select_less(zero, length, v.0[0] * inverse, one);
            Vector([across, v.0[1] * inverse])
        };
        let (t, offset, length) = self.solve(p);
        let speed = self.speed(t);
        let normal = unit(Vector([speed.0[1], -speed.0[0]]));
        let side = T::select_less(offset.dot(normal), zero, -one, one);
        let away = unit(offset);
        // Compares the length with the radius of curvature, both times the turning, which is
        // known to a few roundings: the radius of curvature times the turning is 2|B'/2|³.
        let bend = self.bend[0].abs().max(self.bend[1].abs());
        let rounding = STRAIGHT * T::epsilon() * self.length * bend;
        let turning = self.turning.max(rounding);
        let curved = length.scale(turning) - (speed.dot(speed) * speed.norm()).scale(2.0);
        let gradient = array!(i < 2 => {
            let near = T::select_less(curved, zero, side * normal.0[i], away.0[i]);
            let from_start = T::select_less(zero, t, near, away.0[i]);
            T::select_less(t, one, from_start, away.0[i])
        });
        (length - T::constant(self.radius), Vector(gradient))
    }

    const HAS_OWN_MODEL: bool = true;

    /// By the pieces of the curve that are nearest in the cell, each as a straight edge: the
    /// zeros of a cubic are no better known than the coefficients, which in a cell move. Next
    /// to the curve, where the distance has a crease, by the Lipschitz constant.
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        let size = self.promise.rounding.constant / self.promise.rounding.per_metre;
        let centre = Vector(cell.0.map(|x| x.value));
        let radius = AffineModel::radius(&cell.0);
        let far = f64::EPSILON * (size + centre.norm() + radius);
        let value = self.distance(centre);
        let constant = AffineModel::lipschitz(value, 1.0, &cell.0, OPERATIONS * far);
        let error = PIECE_OFF * far;
        let (radius, distance) = (radius + error, value + self.radius);
        if distance <= radius {
            return constant;
        }
        let curve =
            Bent { from: Vector(self.from), step: Vector(self.step), bend: Vector(self.bend) };
        let mut pieces = Pieces::default();
        let found = curve.add_near(&Disc { centre, radius, distance }, 0, &mut pieces);
        let model = found.and_then(|()| {
            let near = pieces.sides(std::slice::from_ref(&curve));
            let to_curve = model_by_sides(cell, distance, radius, near)?;
            Some(to_curve - AffineModel::constant(self.radius))
        });
        or_constant(model, constant, error)
    }

    fn promise(&self) -> Promise<2> {
        self.promise
    }
}

primitive! {
    QuadraticBezier, quadratic_bezier, 2,
    about: "All points within a radius of a quadratic Bézier curve.",
    origin: "given by its points",
    parameters: {
        from: Vector = "one end" => |kernel| Vector(kernel.from),
        control: Vector = "where the tangents of both ends meet",
        to: Vector = "the other end",
        radius: LengthOrZero = "the radius, zero for a curve without inside",
    },
    marks: |kernel| {
        let (control, to) = (kernel.control(), kernel.to());
        vec![
            Mark::position("from", kernel.from()),
            Mark::position("control", control),
            Mark::position("to", to),
            Mark::length_between("radius", to, to + across(to - control) * kernel.radius()),
        ]
    },
    example: (Vector([-0.8, -0.6]), Vector([0.5, 1.1]), Vector([0.9, -0.4]), 0.12),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::PI;

    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row, arc, bezier, from_curve};

    impl Evidence<2> for QuadraticBezier {
        const SAMPLE: &'static str = r#"{ "from": [-0.04, -0.04], "control": [0, 0.08], "to": [0.04, -0.02], "radius": 0.008 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Quadratic Bezier",
            "`from`, `control`, `to`, `radius` 0",
            "exact; inside a bound where the radius exceeds that of curvature",
        )];

        fn definition(&self) -> Definition<2> {
            bezier_tube([self.from(), self.control(), self.to()], self.radius())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![
                Self::new(
                    Vector([0.25, 0.5]),
                    Vector([f64::NAN, 0.0]),
                    Vector([0.25, 0.5]),
                    0.1,
                ),
                Self::new(Vector([0.25, 0.5]), Vector([0.25, 0.5]), Vector([0.25, 0.5]), -0.1),
            ]
        }
    }

    /// A tube around a curve: parallels on either side, and round ends.
    fn bezier_tube(points: [Point<2>; 3], r: f64) -> Definition<2> {
        let [a, b, c] = points;
        let across =
            |v: Point<2>| v.normalized().map_or(Vector([0.0, 1.0]), |v| Vector([-v[1], v[0]]));
        let second = (a - b * 2.0 + c) * 2.0;
        let fastest = (b - a).norm().max((c - b).norm()) * 2.0;
        let slowest = from_curve(Vector::ZERO, |t| bezier(points, t)[1]);
        let turning = (second[0] * (b - a)[1] - second[1] * (b - a)[0]).abs() * 2.0;
        // A curve that turns back on itself is a hairpin with a round end.
        let hairpin = turning * r > 1e3 * fastest * slowest * slowest;
        let turned =
            if hairpin || turning == 0.0 { 0.0 } else { turning / (slowest * slowest) };
        // The parameter of the least speed, at which a hairpin turns.
        let square = second.dot(second);
        let place = if square > 0.0 { -2.0 * (b - a).dot(second) / square } else { 0.5 };
        let place = place.clamp(0.0, 1.0);
        let mut boundary = Vec::new();
        for side in [r, -r] {
            for [from, to] in [[0.0, place], [place, 1.0]] {
                boundary.push(Patch::curve(fastest + r * turned, move |t| {
                    let [p, v] = bezier(points, from + (to - from) * t);
                    p + across(v) * side
                }));
            }
        }
        if hairpin || slowest <= 1e-9 * fastest {
            boundary.push(arc(bezier(points, place)[0].0, r, [0.0, 2.0 * PI]));
        }
        // Half circles, away from the curve.
        // The control point may be an end too.
        let tangent =
            |near: Point<2>, far: Point<2>| if near.norm() > 0.0 { near } else { far };
        for (end, away) in [(a, tangent(a - b, a - c)), (c, tangent(c - b, c - a))] {
            let [x, y] = away.0;
            let away = y.atan2(x);
            // The whole circle if all three points are equal.
            let reach = if x == 0.0 && y == 0.0 { PI } else { 0.5 * PI };
            boundary.push(arc(end.0, r, [away - reach, away + reach]));
        }
        let tube =
            Definition::new(boundary, move |p| from_curve(p, |t| bezier(points, t)[0]) < r);
        // With a smaller radius the parallels have no cusps.
        let curvature_radius = slowest.powi(3) / turning;
        Definition {
            overlaps_itself: turning == 0.0 || hairpin || r > 0.999 * curvature_radius,
            ..tube
        }
    }
}
