// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Ellipses and ellipsoids.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::Mark;
use crate::kernel::{Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Float, Scalar};
use crate::vector::{Vector, array, unrolled};

/// Halvings of the range of the unknown's exponent. Doubles and aspect ratios up to a million
/// span a factor of 2²⁰⁰, of which seven halvings leave less than 4.
const HALVINGS: usize = 7;

/// Newton steps after that: each doubles the digits, and the first is within a
/// factor of 4 of the root.
const STEPS: usize = 6;

/// Relative rounding of the distance, in operations.
const OPERATIONS: f64 = 16.0;

/// The ellipse or ellipsoid `Σ(pᵢ/rᵢ)² ≤ 1`. Exact.
///
/// # Derivation
///
/// The nearest point `x` to `y ≥ 0` has `y − x` along the normal `xᵢ/rᵢ²`, so
/// `xᵢ = rᵢ²yᵢ/(t + rᵢ²)` for the largest `t` with `G(t) = Σ(rᵢyᵢ/(t + rᵢ²))² = 1`
/// (Eberly, "Distance from a point to an ellipse, an ellipsoid, or a
/// hyperellipsoid", 2013). The unknown is `s = t + min rᵢ²`, so that nothing
/// cancels for thin shapes; a coordinate of zero along the thinnest axis is moved
/// by an ulp of the size, so that points on the medial axis have a nearest point
/// too.
///
/// The root lies between the largest `s` at which one term alone is one, and
/// `‖(rᵢyᵢ)‖`. Next to the plane of the widest section these are many powers of
/// two apart, and Newton's method would creep along the pole of the thin axis. So
/// the range is halved in its exponent first. Then Newton's method on `1/√G − 1`,
/// which is concave and nearly linear (Moré and Sorensen, 1983), rises to the root
/// from below without overshooting.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ellipsoid};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let egg = Shape::from_kernel(Ellipsoid::new(Vector([1.0, 2.0, 4.0]))?);
/// assert_eq!(egg.distance(Vector([3.0, 0.0, 0.0])), 2.0);
/// assert!((egg.distance(Vector([0.0, 0.0, 0.0])) + 1.0).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Ellipsoid<const D: usize> {
    radii: [f64; D],
    /// `rᵢ² − min r²`.
    excess: [f64; D],
    smallest: f64,
    largest: f64,
}

impl<const D: usize> Ellipsoid<D> {
    /// The ellipsoid with the given radii along the axes [m].
    ///
    /// # Errors
    ///
    /// If a radius is not positive, or the largest is more than a million times
    /// the smallest.
    pub fn new(radii: Vector<f64, D>) -> Result<Self, ShapeError> {
        for radius in radii.0 {
            positive("radii", radius, Unit::Metre)?;
        }
        let smallest = radii.0.iter().fold(f64::INFINITY, |m, r| m.min(*r));
        let largest = radii.0.iter().fold(0.0_f64, |m, r| m.max(*r));
        if largest > 1e6 * smallest {
            let rule = format!("at most a million times the smallest, {smallest} m");
            return Err(ShapeError::number("radii", rule, largest, Unit::Metre));
        }
        let excess = radii.0.map(|r| (r - smallest) * (r + smallest));
        Ok(Self { radii: radii.0, excess, smallest, largest })
    }

    /// The signed distance at `y`, which has no negative coordinate, and the unit
    /// normal at the nearest point.
    #[inline(always)]
    fn solve<S: Scalar>(&self, y: Vector<S, D>) -> (S, Vector<S, D>) {
        let excess = |i: usize| S::constant(self.excess[i]);
        let tiny = S::constant(self.smallest * S::epsilon());
        let scaled: [S; D] = array!(i < D => {
            let thin = self.excess[i] == 0.0;
            let y = if thin { y.0[i].max(tiny) } else { y.0[i] };
            y.scale(self.radii[i])
        });
        let mut s = scaled[0] - excess(0);
        unrolled!(i < D => s = s.max(scaled[i] - excess(i)));
        // G, and minus half its slope.
        let sums = |s: S| {
            let mut value = S::constant(0.0);
            let mut slope = S::constant(0.0);
            unrolled!(i < D => {
                let inverse = S::constant(1.0) / (s + excess(i));
                let share = (scaled[i] * inverse).squared();
                value = value + share;
                slope = slope + share * inverse
            });
            (value, slope)
        };
        let one = S::constant(1.0);
        let mut high = S::norm(scaled).max(s);
        for _ in 0..HALVINGS {
            // The product of the square roots: that of the numbers may overflow or underflow.
            let middle = s.sqrt() * high.sqrt();
            let (value, _) = sums(middle);
            s = S::select_less(value, one, s, middle);
            high = S::select_less(value, one, middle, high);
        }
        for _ in 0..STEPS {
            let (value, slope) = sums(s);
            s = s + (value.sqrt() - one) * value / slope;
        }
        // The vector of the xᵢ/rᵢ has length one; normalising it removes its rounding.
        let shares: [S; D] = array!(i < D => scaled[i] / (s + excess(i)));
        let inverse = S::constant(1.0) / S::norm(shares);
        let shares = array!(i < D => shares[i] * inverse);
        let across: [S; D] = array!(i < D => shares[i].scale(1.0 / self.radii[i]));
        let inverse = S::constant(1.0) / S::norm(across);
        let normal = Vector(array!(i < D => across[i] * inverse));
        // Measured along the normal, where an error of the nearest point is of second order.
        let nearest = Vector(array!(i < D => shares[i].scale(self.radii[i])));
        ((y - nearest).dot(normal), normal)
    }
}

impl<const D: usize> Kernel<D> for Ellipsoid<D> {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        self.solve(p.abs()).0
    }

    /// The gradient is the normal at the nearest point, inside and outside.
    #[inline(always)]
    fn distance_gradient<T: Float>(&self, p: Vector<T, D>) -> (T, Vector<T, D>) {
        let (distance, normal) = self.solve(p.abs());
        let zero = T::constant(0.0);
        let signed = |i: usize| T::select_less(p.0[i], zero, -normal.0[i], normal.0[i]);
        (distance, Vector(array!(i < D => signed(i))))
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, D>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.largest)
    }

    fn promise(&self) -> Promise<D> {
        let bounds = Bounds::centred(Vector(self.radii), self.largest);
        Promise::exact_convex(Some(bounds), OPERATIONS, self.largest).symmetric()
    }
}

primitive! {
    Ellipsoid<2>, ellipse, 2,
    about: "An ellipse along the axes.",
    origin: "centred; radii along the axes",
    parameters: {
        radii: Vector = "the radii along the axes" => |kernel| Vector(kernel.radii),
    },
    marks: |kernel| Mark::radii(kernel.radii()),
    example: (Vector([0.9, 0.4])),
}

primitive! {
    Ellipsoid<3>, ellipsoid, 3,
    about: "An ellipsoid along the axes.",
    origin: "centred; radii along the axes",
    parameters: {
        radii: Vector = "the radii along the axes" => |kernel| Vector(kernel.radii),
    },
    marks: |kernel| Mark::radii(kernel.radii()),
    example: (Vector([0.9, 0.6, 0.3])),
}

#[cfg(feature = "oracle")]
mod evidence {
    use std::f64::consts::TAU;

    use super::*;
    use crate::oracle::{Definition, Evidence, Patch, Row, ellipsoid};

    impl Evidence<2> for Ellipsoid<2> {
        const SAMPLE: &'static str = r#"{ "radii": [0.05, 0.03] }"#;
        const GUIDE: &'static [Row] = &[Row::new("Ellipse", "`radii`", "exact, convex")];

        fn definition(&self) -> Definition<2> {
            let r = self.radii();
            let curve = Patch::curve(TAU * r[0].max(r[1]), move |t| {
                Vector([r[0] * (TAU * t).cos(), r[1] * (TAU * t).sin()])
            });
            Definition::new(vec![curve], move |p| (p[0] / r[0]).hypot(p[1] / r[1]) < 1.0)
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([1.0, 1e-7]))]
        }
    }

    impl Evidence<3> for Ellipsoid<3> {
        const SAMPLE: &'static str = r#"{ "radii": [0.05, 0.03, 0.04] }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Ellipsoid",
            "`radii`; the nearest point is solved for",
            "exact, convex",
        )];

        fn definition(&self) -> Definition<3> {
            ellipsoid(self.radii())
        }
    }
}
