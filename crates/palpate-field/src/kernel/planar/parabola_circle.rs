// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Outlines of four equal arcs of parabolas.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use super::bent::{Bent, Disc, Pieces};
use super::parabola_foot::Quadratic;
use super::sides::{model_by_sides, or_constant};
use crate::bounds::{Aabb, BoundingBall, Bounds};
use crate::error::{ShapeError, Unit, not_negative, positive};
use crate::kernel::mark::{Mark, at, diagonal};
use crate::kernel::{Kernel, primitive, tangent_model};
use crate::promise::{Promise, Quality};
use crate::scalar::{AffineModel, Float, Scalar};
use crate::vector::{Vector, array};

/// The largest number of rounded operations of the distance of a quadratic circle.
const CIRCLE_OPERATIONS: f64 = 5.0;

/// The same for a cross.
const CROSS_OPERATIONS: f64 = 5.0;

/// How far points of an arc, and with them a model of a cross, may be off, in roundings of the
/// largest number.
const ARC_OFF: f64 = 32.0;

/// Of a cell on an arc, the piece of the arc has to go past it, by this share of its radius.
const PAST: f64 = 1.25;

/// A point folded by the axes and the diagonals, in the frame of the diagonal: its offset
/// beside the diagonal, and its place along it from the centre.
#[inline(always)]
fn folded<S: Scalar>(p: Vector<S, 2>) -> [S; 2] {
    let [x, y] = p.abs().0;
    let diagonal = Vector([x, y]).dot_constant(&[FRAC_1_SQRT_2, FRAC_1_SQRT_2]);
    [(x - y).abs().scale(FRAC_1_SQRT_2), diagonal]
}

/// A gradient at a folded point as one at `p`.
#[inline(always)]
fn unfolded<T: Float>(p: Vector<T, 2>, [beside, along]: [T; 2]) -> Vector<T, 2> {
    let zero = T::constant(0.0);
    let [x, y] = p.abs().0;
    let larger = (along + beside).scale(FRAC_1_SQRT_2);
    let smaller = (along - beside).scale(FRAC_1_SQRT_2);
    let both = [T::select_less(x, y, smaller, larger), T::select_less(x, y, larger, smaller)];
    Vector(array!(i < 2 => T::select_less(p.0[i], zero, -both[i], both[i])))
}

/// A round shape about the origin whose outline is four arcs of parabolas. Exact.
///
/// # Derivation
///
/// The quarter from (r, 0) to (0, r) is the Bézier curve with its control point at
/// (r, r): tangent to the lines x = r and y = r, where it continues its neighbours. It
/// is the parabola about the diagonal with its vertex at (3r/4, 3r/4), of the points
/// `(r/√2)τ` beside the diagonal and `(r/2√2)τ²` back along it, for |τ| ≤ 1. Folded by
/// the eight mirrors, a point is between the axis and the diagonal; there the
/// nearest point of the parabola is at 0 ≤ τ ≤ 1, since the normal at τ = 1 is the
/// axis.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::QuadraticCircle};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let pebble = Shape::from_kernel(QuadraticCircle::new(4.0)?);
/// assert!((pebble.distance(Vector([0.0, -9.0])) - 5.0).abs() < 1e-14);
/// // Along the diagonal from the vertex at (3, 3).
/// assert!((pebble.distance(Vector([-5.0, 5.0])) - 8.0_f64.sqrt()).abs() < 1e-14);
/// assert!((pebble.distance(Vector([0.0, 0.0])) + 4.0).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct QuadraticCircle {
    radius: f64,
    /// From the vertex back along the diagonal.
    curve: Quadratic,
}

impl QuadraticCircle {
    /// The shape that meets the axes at `radius` from the centre [m].
    ///
    /// # Errors
    ///
    /// If the radius is not positive.
    pub fn new(radius: f64) -> Result<Self, ShapeError> {
        positive("radius", radius, Unit::Metre)?;
        let along = FRAC_1_SQRT_2 * radius;
        Ok(Self { radius, curve: Quadratic::new(along, 0.5 * along) })
    }

    /// How far the vertices are from the centre.
    fn vertex(&self) -> f64 {
        0.75 * SQRT_2 * self.radius
    }

    #[inline(always)]
    fn solve<S: Scalar>(&self, p: Vector<S, 2>) -> (S, [S; 2]) {
        let [beside, along] = folded(p);
        let nearest = self.curve.nearest(beside, S::constant(self.vertex()) - along);
        (nearest.below, [nearest.normal[0], -nearest.normal[1]])
    }
}

impl Kernel<2> for QuadraticCircle {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.solve(p).0
    }

    /// The gradient is the normal at the nearest point, inside and outside.
    #[inline(always)]
    fn distance_gradient<T: Float>(&self, p: Vector<T, 2>) -> (T, Vector<T, 2>) {
        let (distance, gradient) = self.solve(p);
        (distance, unfolded(p, gradient))
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        tangent_model(self, cell, CIRCLE_OPERATIONS, self.radius)
    }

    fn promise(&self) -> Promise<2> {
        let bounds = Bounds::centred(Vector::constant(self.radius), self.vertex());
        let bounds = bounds.grown(4.0 * f64::EPSILON * self.radius);
        Promise::exact_convex(Some(bounds), CIRCLE_OPERATIONS, self.radius).symmetric()
    }
}

primitive! {
    QuadraticCircle, quadratic_circle, 2,
    about: "A round shape whose outline is four arcs of parabolas.",
    origin: "centred; radii along the axes",
    parameters: { radius: Length = "from the centre to where it meets the axes" },
    marks: |kernel| vec![Mark::from_origin("radius", at(kernel.radius(), 0.0))],
    example: (0.8),
}

/// A cross with four tips on the axes, joined by hollow arcs of parabolas, grown by
/// a rounding.
///
/// Exact; inside a bound where the rounding is more than the arcs' least radius of
/// curvature, so that it fills them.
///
/// # Derivation
///
/// With a the distance of a tip from the centre, before it is grown, the arc between
/// two tips is a parabola about the diagonal, `a/√2` to both sides, whose vertex is
/// the `dip` nearer to the centre than the chord: `(a/√2)τ` beside the diagonal,
/// `dip·τ²` outwards. Folded by the eight mirrors, the nearest point is that of the
/// parabola or, where it is beyond the tip, the tip. What is inside has its nearest
/// point on the arc if the arc stays within its quadrant: if its slope at the tip,
/// `2√2 dip/a`, is at most one.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::BobblyCross};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let cross = Shape::from_kernel(BobblyCross::new(8.0, 1.0, 1.0)?);
/// assert!((cross.distance(Vector([0.0, 9.0])) - 5.0).abs() < 1e-14); // over a tip
/// // Of the chord's 3/√2 from the centre, the dip takes 1 and the rounding gives it.
/// let inside = cross.distance(Vector([0.0, 0.0]));
/// assert!((inside + 4.5_f64.sqrt()).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct BobblyCross {
    width: f64,
    /// From the centre to a tip, without the rounding.
    tip: f64,
    dip: f64,
    rounding: f64,
    /// From the vertex outwards.
    curve: Quadratic,
}

impl BobblyCross {
    /// A cross of full `width` and as high, its sides drawn in by `dip` from the line
    /// between two tips, with a `rounding` [m].
    ///
    /// # Errors
    ///
    /// If the width or the dip is not positive, the rounding negative or not less than
    /// half the width, or the dip so deep that the arcs would cross the axes.
    pub fn new(width: f64, dip: f64, rounding: f64) -> Result<Self, ShapeError> {
        positive("width", width, Unit::Metre)?;
        positive("dip", dip, Unit::Metre)?;
        not_negative("rounding", rounding, Unit::Metre)?;
        let tip = 0.5 * width - rounding;
        if tip < 1e-6 * width {
            let rule = format!("less than half the width, {} m", 0.5 * width);
            return Err(ShapeError::number("rounding", rule, rounding, Unit::Metre));
        }
        let deepest = tip / (2.0 * SQRT_2);
        // A dip that exceeds the limit by rounding only is accepted.
        if dip > deepest * (1.0 + 4.0 * f64::EPSILON) {
            let rule = format!("at most {deepest} m, where the arcs touch the axes");
            return Err(ShapeError::number("dip", rule, dip, Unit::Metre));
        }
        let curve = Quadratic::new(FRAC_1_SQRT_2 * tip, dip);
        Ok(Self { width, tip, dip, rounding, curve })
    }

    /// The four arcs, each between two tips.
    fn arcs(&self) -> [Bent; 4] {
        // The ends' tangents meet as far inwards of the vertex as the chord is outwards.
        let inner = 0.5 * self.tip - SQRT_2 * self.dip;
        let (tip, zero) = (self.tip, 0.0);
        let tips = [[tip, zero], [zero, tip], [-tip, zero], [zero, -tip]].map(Vector);
        std::array::from_fn(|i| {
            let (from, to) = (tips[i], tips[(i + 1) % 4]);
            Bent::new(from, (from + to) * (inner / tip), to)
        })
    }

    #[inline(always)]
    fn solve<S: Scalar>(&self, p: Vector<S, 2>) -> (S, [S; 2]) {
        let one = S::constant(1.0);
        let [beside, along] = folded(p);
        let chord = FRAC_1_SQRT_2 * self.tip;
        let nearest = self.curve.nearest(beside, along - S::constant(chord - self.dip));
        let end = S::constant(chord);
        let from_tip = [beside - end, along - end];
        let to_tip = S::norm(from_tip);
        let inverse = one / S::select_less(S::constant(0.0), to_tip, to_tip, one);
        let past = |tip: S, arc: S| S::select_less(one, nearest.tau, tip, arc);
        let gradient = array!(i < 2 => past(from_tip[i] * inverse, -nearest.normal[i]));
        (past(to_tip, -nearest.below) - S::constant(self.rounding), gradient)
    }
}

impl Kernel<2> for BobblyCross {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.solve(p).0
    }

    /// The gradient is along the line from the nearest point of the shape before it is grown.
    #[inline(always)]
    fn distance_gradient<T: Float>(&self, p: Vector<T, 2>) -> (T, Vector<T, 2>) {
        let (distance, gradient) = self.solve(p);
        (distance, unfolded(p, gradient))
    }

    const HAS_OWN_MODEL: bool = true;

    /// By the pieces of the arcs that are nearest in the cell, each as a straight edge: the
    /// zero of a cubic is no better known than the coefficients, which in a cell move.
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        let centre = Vector(cell.0.map(|x| x.value));
        let radius = AffineModel::radius(&cell.0);
        let far = f64::EPSILON * (self.tip + self.rounding + centre.norm() + radius);
        let value = self.distance(centre);
        let constant = AffineModel::lipschitz(value, 1.0, &cell.0, CROSS_OPERATIONS * far);
        let error = ARC_OFF * far;
        let (radius, to_arcs) = (radius + error, value + self.rounding);
        // On an arc, the value does not say which side of it is inside.
        if to_arcs.abs() <= error {
            return constant;
        }
        let arcs = self.arcs();
        let disc = Disc { centre, radius: PAST * radius, distance: to_arcs.abs() };
        let mut pieces = Pieces::default();
        let mut each = arcs.iter().enumerate();
        let found = each.try_for_each(|(i, arc)| arc.add_near(&disc, i, &mut pieces));
        let model = found.and_then(|()| {
            let to_arcs = model_by_sides(cell, to_arcs, radius, pieces.sides(&arcs))?;
            Some(to_arcs - AffineModel::constant(self.rounding))
        });
        or_constant(model, constant, error)
    }

    fn promise(&self) -> Promise<2> {
        // The least radius of curvature of ((a/√2)τ, dip·τ²): (a/√2)² over twice the dip.
        let curvature_radius = 0.25 * self.tip * (self.tip / self.dip);
        let radius = self.tip + self.rounding;
        let aabb = Aabb::centred(Vector::constant(radius));
        let ball = BoundingBall { centre: Vector::ZERO, radius };
        let bounds = Bounds { aabb, ball }.grown(4.0 * f64::EPSILON * radius);
        let fills = self.rounding > curvature_radius;
        Promise {
            inside: if fills { Quality::Bound } else { Quality::Exact },
            ..Promise::exact(Some(bounds), CROSS_OPERATIONS, radius).symmetric()
        }
    }
}

primitive! {
    BobblyCross, bobbly_cross, 2,
    about: "A cross with four tips on the axes between hollow arcs of parabolas, rounded.",
    origin: "centred; a tip up, a tip down",
    parameters: {
        width: Length = "the full width and height",
        dip: Length = "how far the sides are drawn in from the line between two tips",
        rounding: LengthOrZero = "the radius of the tips, zero for sharp ones",
    },
    marks: |kernel| {
        let chord: Vector<f64, 2> =
            diagonal() * (FRAC_1_SQRT_2 * kernel.tip + kernel.rounding);
        vec![
            Mark::width("width", 0.5 * kernel.width, 0.0),
            Mark::length_between("dip", chord, chord - diagonal() * kernel.dip),
            Mark::length_between("rounding", at(0.0, kernel.tip), at(0.0, 0.5 * kernel.width)),
        ]
    },
    example: (1.9, 0.2, 0.15),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::{FRAC_PI_4, PI};

    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row, arc, bezier, from_curve};
    use crate::vector::Point;

    impl Evidence<2> for QuadraticCircle {
        const SAMPLE: &'static str = r#"{ "radius": 0.05 }"#;
        const GUIDE: &'static [Row] =
            &[Row::new("Quadratic Circle", "`radius`", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            quadratic_circle(self.radius())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(-0.5)]
        }
    }

    impl Evidence<2> for BobblyCross {
        const SAMPLE: &'static str = r#"{ "width": 0.09, "dip": 0.012, "rounding": 0.005 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Bobbly Cross",
            "`width` 2, `dip`, `rounding` 0 or more",
            "exact; inside a bound where the rounding exceeds the radius of curvature",
        )];

        fn definition(&self) -> Definition<2> {
            bobbly_cross(self.width(), self.dip(), self.rounding())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(1.0, 0.2, 0.0), Self::new(1.0, 0.1, 0.5)]
        }
    }

    /// Four concave arcs of parabolas between the tips, grown.
    fn bobbly_cross(width: f64, dip: f64, r: f64) -> Definition<2> {
        let tip = 0.5 * width - r;
        let half_chord = tip * FRAC_1_SQRT_2;
        // In the frame of the diagonal (1, 1): the offset beside it, the place along it.
        let turned = |s: f64, t: f64| Vector([t + s, t - s]) * FRAC_1_SQRT_2;
        let on_arc = move |u: f64| turned(half_chord * u, half_chord - dip + dip * u * u);
        let grown = move |u: f64| {
            let slope = 2.0 * dip * u / half_chord;
            on_arc(u) + turned(-slope, 1.0) * (r / slope.hypot(1.0))
        };
        let steepest = 2.0 * dip / half_chord;
        let speed = 2.0 * half_chord * steepest.hypot(1.0) + 2.0 * r * steepest;
        let reach = FRAC_PI_4 + steepest.atan();
        let mut boundary = Vec::new();
        for quarter in 0..4 {
            let angle = 0.5 * PI * f64::from(quarter);
            let (sin, cos) = angle.sin_cos();
            let turn =
                move |p: Point<2>| Vector([cos * p[0] - sin * p[1], sin * p[0] + cos * p[1]]);
            boundary.push(Patch::curve(speed, move |t| turn(grown(2.0 * t - 1.0))));
            let end = turn(Vector([tip, 0.0]));
            boundary.push(arc(end.0, r, [angle - reach, angle + reach]));
        }
        let curvature_radius = half_chord * half_chord / (2.0 * dip);
        let cross = Definition::new(boundary, move |p| {
            let q = Vector([p[0].abs(), p[1].abs()]);
            let [s, t] = [q[0] - q[1], q[0] + q[1]].map(|x| x * FRAC_1_SQRT_2 / half_chord);
            let within = s.abs() < 1.0 && t * half_chord < half_chord + dip * (s * s - 1.0);
            within || from_curve(q, |u| on_arc(2.0 * u - 1.0)) < r
        });
        Definition { overlaps_itself: r > curvature_radius, ..cross }
    }

    fn quadratic_circle(r: f64) -> Definition<2> {
        let mut boundary = Vec::new();
        for [x, y] in [[r, r], [-r, r], [-r, -r], [r, -r]] {
            let points = [Vector([x, 0.0]), Vector([x, y]), Vector([0.0, y])];
            boundary.push(Patch::curve(2.0 * r, move |t| bezier(points, t)[0]));
        }
        Definition::new(boundary, move |p| {
            let (sum, difference) = (p[0].abs() + p[1].abs(), p[0].abs() - p[1].abs());
            sum < 1.5 * r - difference * difference / (2.0 * r)
        })
    }
}
