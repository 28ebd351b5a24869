// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Hyperbolas.

use crate::error::{ShapeError, Unit, positive};
use crate::kernel::mark::Mark;
use crate::kernel::{Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Float, Scalar};
use crate::vector::Vector;

/// Halvings of the range of the unknown's exponent. The range spans a factor of 2¹⁵⁰, from an
/// ulp of the thinnest shape to the largest number with a finite square; six halvings leave
/// less than 6.
const HALVINGS: usize = 6;

/// Newton steps after that: each doubles the digits, and the first is within a factor
/// of 6 of the root.
const STEPS: usize = 7;

/// The largest number of rounded operations of the distance.
const OPERATIONS: f64 = 6.0;

/// The region beyond one branch of a hyperbola, `(y/b)² − (x/a)² ≥ 1` and `y > 0`. Exact,
/// without bounds.
///
/// Its vertex is at (0, b), its asymptotes are the lines `y = |x| b/a`.
///
/// # Derivation
///
/// The branch is `(as, b√(1 + s²))`. For the point (x, y), folded to x ≥ 0, half the
/// derivative of the square of the distance, divided by `(a² + b²)/a`, is
///
/// ```text
/// h(s) = s − κ s/√(1 + s²) − ξ,    κ = yb/(a² + b²),    ξ = xa/(a² + b²)
/// ```
///
/// The nearest point is the zero s ≥ 0 of h. There is one, because h starts at −ξ and is convex
/// or concave, by the sign of κ. As `s/√(1 + s²)` is less than s and than 1, the zero is
/// between ξ and `ξ + κ`, on the side towards 1 of `ξ/(1 − κ)` where κ < 1, and more than
/// `√(κ² − 1)` where κ > 1. The range is halved in its exponent; then Newton's method goes,
/// without overshooting, from above if h is convex and from below if it is concave. An x of
/// zero is moved by an ulp of a, so that points on the medial axis have a nearest point too.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Hyperbola};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let cape = Shape::from_kernel(Hyperbola::new(Vector([4.0, 3.0]))?);
/// assert!((cape.distance(Vector([0.0, 1.0])) - 2.0).abs() < 1e-15); // below the vertex
/// assert!((cape.distance(Vector([0.0, 5.0])) + 2.0).abs() < 1e-14); // the focus
/// // Out of (3, 15/4) along its normal (3/16, −5/12).
/// let out = cape.distance(Vector([-4.8, -0.25]));
/// assert!((out - 1.8_f64.hypot(4.0)).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Hyperbola {
    /// a and b.
    radii: [f64; 2],
    /// `1/(a² + b²)` times a and b.
    shares: [f64; 2],
}

impl Hyperbola {
    /// The upper branch of the hyperbola with the given semi-axes along x and y [m].
    ///
    /// # Errors
    ///
    /// If a semi-axis is not positive, or one more than a million times the other.
    pub fn new(radii: Vector<f64, 2>) -> Result<Self, ShapeError> {
        for radius in radii.0 {
            positive("radii", radius, Unit::Metre)?;
        }
        let [a, b] = radii.0;
        let (smallest, largest) = (a.min(b), a.max(b));
        if largest > 1e6 * smallest {
            let rule = format!("at most a million times the smaller, {smallest} m");
            return Err(ShapeError::number("radii", rule, largest, Unit::Metre));
        }
        let square = a * a + b * b;
        Ok(Self { radii: radii.0, shares: [a / square, b / square] })
    }

    fn size(&self) -> f64 {
        self.radii[0].max(self.radii[1])
    }

    /// The signed distance at (x, y) for x ≥ 0, and the unit normal at the nearest
    /// point.
    #[inline(always)]
    fn solve<S: Scalar>(&self, x: S, y: S) -> (S, [S; 2]) {
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        let [a, b] = self.radii;
        let kappa = y.scale(self.shares[1]);
        let tiny = S::epsilon() * a * self.shares[0];
        let xi = x.scale(self.shares[0]).max(S::constant(tiny));
        let norm = |s: S| S::norm([one, s]);
        let sum = xi + kappa;
        let convex =
            |if_convex: S, otherwise: S| S::select_less(zero, kappa, if_convex, otherwise);
        // ξ/(1 − κ), if that is defined.
        let room = one - kappa;
        let steep =
            S::select_less(zero, room, xi / S::select_less(zero, room, room, one), sum.max(xi));
        let beyond = (kappa - one).max(zero).sqrt() * (kappa + one).max(zero).sqrt();
        let mut low = convex(xi.max(beyond), steep.max(sum));
        let mut high = convex(sum.min(steep), xi).max(low);
        for _ in 0..HALVINGS {
            // The product of the square roots: that of the numbers may overflow or underflow.
            let middle = low.sqrt() * high.sqrt();
            let value = middle - kappa * (middle / norm(middle)) - xi;
            low = S::select_less(value, zero, middle, low);
            high = S::select_less(value, zero, high, middle);
        }
        let mut s = convex(high, low);
        for _ in 0..STEPS {
            let w = norm(s);
            let share = kappa / w;
            let slope = one - share / w / w;
            let value = s - share * s - xi;
            s = s - value / S::select_less(zero, slope, slope, one);
        }
        let w = norm(s);
        let across = [s.scale(b), -w.scale(a)];
        let inverse = one / S::norm(across);
        let normal = [across[0] * inverse, across[1] * inverse];
        let from_foot = Vector([x - s.scale(a), y - w.scale(b)]);
        (from_foot.dot(Vector(normal)), normal)
    }
}

impl Kernel<2> for Hyperbola {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 2>) -> S {
        self.solve(p.0[0].abs(), p.0[1]).0
    }

    /// The gradient is the normal at the nearest point, inside and outside.
    #[inline(always)]
    fn distance_gradient<T: Float>(&self, p: Vector<T, 2>) -> (T, Vector<T, 2>) {
        let (distance, [across, up]) = self.solve(p.0[0].abs(), p.0[1]);
        let across = T::select_less(p.0[0], T::constant(0.0), -across, across);
        (distance, Vector([across, up]))
    }

    const HAS_OWN_MODEL: bool = true;

    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, 2>) -> AffineModel<N> {
        tangent_model(self, cell, OPERATIONS, self.size())
    }

    fn promise(&self) -> Promise<2> {
        Promise {
            symmetric: [true, false],
            ..Promise::exact_convex(None, OPERATIONS, self.size())
        }
    }
}

primitive! {
    Hyperbola, hyperbola, 2,
    about: "What is beyond the upper branch of a hyperbola.",
    origin: "endless; at the middle of both vertices, the branch above",
    parameters: {
        radii: Vector = "the semi-axes along x and y" => |kernel| Vector(kernel.radii),
    },
    marks: |kernel| Mark::radii(kernel.radii()),
    example: (Vector([0.45, 0.31])),
}

#[cfg(feature = "oracle")]
mod evidence {
    use super::*;
    use crate::oracle::{Definition, Evidence, FAR, Row, over};

    impl Evidence<2> for Hyperbola {
        const SAMPLE: &'static str = r#"{ "radii": [0.02, 0.01] }"#;
        const GUIDE: &'static [Row] = &[Row::new(
            "Hyperbola",
            "`radii` both √(2k) for xy = k turned by 45°; one branch, and `mirrored` for both",
            "exact, convex, unbounded",
        )];

        fn definition(&self) -> Definition<2> {
            let [a, b] = self.radii().0;
            // The vertex may be some way up.
            let reach = (FAR + b).min(a * (FAR + b) / b);
            over(move |x| b * (x / a).hypot(1.0), reach, b / a)
        }

        fn refused() -> Vec<Result<Self, ShapeError>> {
            vec![Self::new(Vector([1.0, 1e-7]))]
        }
    }
}
