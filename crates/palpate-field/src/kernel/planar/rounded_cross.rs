// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The cross with hollow sides.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::{Mark, at};
use crate::kernel::{Evaluations, Kernel, primitive};
use crate::promise::Promise;
use crate::scalar::Scalar;
use crate::vector::Vector;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 5.0;

/// A star with four tips on the axes, joined by concave arcs. Exact.
///
/// # Derivation
///
/// Folded to x, y ≥ 0 there is one arc, from the tip (a, 0) to the tip (0, b), about a centre c
/// on the far side of their chord: beyond its middle, along its normal, by √(r² − (a² + b²)/4).
/// Between the two rays from c through the tips the arc is the nearest, at `r − ‖p − c‖`,
/// positive outside; elsewhere the nearer tip is. All points inside lie between the rays if the
/// arc stays within its quadrant, that is, if c is at least as far right as a and as far up as
/// b. At the least such r, the circle touches the axis of the farther tip, and
/// `a² + b² = 2r min(a, b)`.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::RoundedCross};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// // Arcs about (±2, ±2) that touch the axes.
/// let star = Shape::from_kernel(RoundedCross::new(Vector([4.0, 4.0]), 2.0)?);
/// assert!((star.distance(Vector([0.0, 0.0])) - (2.0 - 8.0_f64.sqrt())).abs() < 1e-15);
/// assert!((star.distance(Vector([5.0, 0.0])) - 3.0).abs() < 1e-15); // from a tip
/// assert!((star.distance(Vector([1.5, -1.5])) - (2.0 - 0.5_f64.sqrt())).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct RoundedCross {
    half: [f64; 2],
    centre: [f64; 2],
    arc_radius: f64,
    /// The outward normals of both sides of the wedge that the arc's normals fill.
    walls: [[f64; 2]; 2],
}

impl RoundedCross {
    /// A cross of the given full `size` along x and y, from tip to tip, between arcs
    /// of `arc_radius` [m].
    ///
    /// # Errors
    ///
    /// If a length is not positive, or the arcs would leave their quadrants.
    pub fn new(size: Vector<f64, 2>, arc_radius: f64) -> Result<Self, ShapeError> {
        for length in size.0 {
            positive("size", length, Unit::Metre)?;
        }
        positive("arc_radius", arc_radius, Unit::Metre)?;
        let [a, b] = size.0.map(|length| 0.5 * length);
        let least = 0.5 * (a * (a / a.min(b)) + b * (b / a.min(b)));
        // A radius that falls short of the limit by rounding only is accepted.
        if arc_radius < least * (1.0 - 4.0 * f64::EPSILON) {
            let rule = format!("at least {least} m, where the arcs touch the axes");
            return Err(ShapeError::number("arc_radius", rule, arc_radius, Unit::Metre));
        }
        let half_chord = 0.5 * Vector([a, b]).norm();
        let beyond = ((arc_radius - half_chord) * (arc_radius + half_chord)).max(0.0).sqrt();
        // Along the chord's normal (b, a).
        let [x, y] = [b, a].map(|n| beyond * (n / (2.0 * half_chord)));
        let centre = [(0.5 * a + x).max(a), (0.5 * b + y).max(b)];
        let wall = |across: f64, up: f64| {
            let unit = Vector([across, up]).normalized().unwrap_or(Vector([0.0, 1.0]));
            unit.0
        };
        let walls = [wall(centre[1], a - centre[0]), wall(b - centre[1], centre[0])];
        Ok(Self { half: [a, b], centre, arc_radius, walls })
    }
}

impl Kernel<2> for RoundedCross {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        let [x, y] = p.abs().0;
        let right = S::norm([x - S::constant(self.half[0]), y]);
        let top = S::norm([x, y - S::constant(self.half[1])]);
        let from_centre = Vector([x, y]) - Vector::of(&self.centre);
        let [below, left] = &self.walls;
        let out = from_centre.dot_constant(below).max(from_centre.dot_constant(left));
        let arc = S::constant(self.arc_radius) - from_centre.norm();
        S::select_less(S::constant(0.0), out, right.min(top), arc)
    }

    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        Some(Evaluations { operations: OPERATIONS, size: self.arc_radius })
    }

    fn promise(&self) -> Promise<2> {
        let radius = self.half[0].max(self.half[1]);
        let bounds = Bounds::centred(Vector(self.half), radius);
        Promise::exact(Some(bounds), OPERATIONS, self.arc_radius).symmetric()
    }
}

primitive! {
    RoundedCross, rounded_cross, 2,
    about: "A cross with four tips on the axes between arcs that are hollow.",
    origin: "centred; a tip up, a tip down",
    parameters: {
        size: Vector = "from tip to tip along x and y" => |kernel| Vector(kernel.half) * 2.0,
        arc_radius: Length = "the radius of the arcs",
    },
    marks: |kernel| {
        let [x, y] = kernel.half;
        let centre = Vector(kernel.centre);
        let chord = Vector([y, x]) * (1.0 / Vector([x, y]).norm());
        vec![
            Mark::width("size", x, 0.0).of(0),
            Mark::length_between("size", at(0.0, -y), at(0.0, y)).of(1).left(),
            Mark::length_between("arc_radius", centre, centre - chord * kernel.arc_radius),
        ]
    },
    example: (Vector([1.9, 1.5]), 1.1),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::PI;

    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row};
    use crate::vector::Point;

    impl Evidence<2> for RoundedCross {
        const SAMPLE: &'static str = r#"{ "size": [0.1, 0.1], "arc_radius": 0.06 }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Circle Cross",
            "`size` (2, 2h), `arc_radius` (h + 1/h)/2; larger radii have flatter sides",
            "exact",
        )];

        fn definition(&self) -> Definition<2> {
            rounded_cross(self.size(), self.arc_radius())
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([1.0, 0.5]), 0.5)]
        }
    }

    /// A rhombus without four discs over its edges.
    fn rounded_cross(size: Point<2>, r: f64) -> Definition<2> {
        let [a, b] = (size * 0.5).0;
        let chord = a.hypot(b);
        let beyond = (r * r - 0.25 * chord * chord).max(0.0).sqrt();
        let centre = [0.5 * a + beyond * b / chord, 0.5 * b + beyond * a / chord];
        let angle = |x: f64, y: f64| (y - centre[1]).atan2(x - centre[0]);
        // From the tip on y, to the left of the centre, to the tip on x, below it.
        let (mut from, to) = (angle(0.0, b), angle(a, 0.0));
        if from > 0.0 {
            from -= 2.0 * PI;
        }
        let mut boundary = Vec::new();
        for signs in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]] {
            boundary.push(Patch::curve(r * (to - from).abs(), move |t| {
                let angle = from + (to - from) * t;
                let x = centre[0] + r * angle.cos();
                let y = centre[1] + r * angle.sin();
                Vector([signs[0] * x, signs[1] * y])
            }));
        }
        Definition::new(boundary, move |p| {
            let [x, y] = [p[0].abs(), p[1].abs()];
            x / a + y / b < 1.0 && (Vector([x, y]) - Vector(centre)).norm() > r
        })
    }
}
