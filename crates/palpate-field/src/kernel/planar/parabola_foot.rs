// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The point of a parabola that is nearest to a point.

use crate::scalar::Scalar;
use crate::vector::Vector;

/// Steps with fourth roots that approximate a cube root. Each takes away three quarters of the
/// logarithm of the error; four leave a factor of 1.2 of 10³⁴, the most that single precision
/// can hold.
const ROOTS: usize = 4;

/// Newton steps after that: each doubles the digits, and the first is within a factor
/// of two of the root.
const STEPS: usize = 7;

/// Replaces a divisor of zero: smaller than any divisor that matters, but a normal number in
/// single precision.
const TINY: f64 = 1e-37;

/// The parabola of the points `(eτ, cτ²)`, with its vertex at the origin, open
/// upwards.
///
/// # Derivation
///
/// For the point (a, b) with a ≥ 0, half the derivative of the square of the distance
/// is `e(eτ − a) + 2cτ(cτ² − b)`. In units of a size m no less than any of the
/// lengths, and with `z = cτ/m`, its zeros are those of
///
/// ```text
/// g(z) = z³ + kz − d,    k = e²/2 − cb,    d = eac/2 ≥ 0
/// ```
///
/// For z > 0, g is convex and starts with −d ≤ 0, so it has one zero there: the nearest point
/// of the parabola, for mirroring a point with τ < 0 brings it nearer to (a, b). From above the
/// zero, Newton's method falls to it without overshooting. It starts from the lesser of `∛d`
/// and `d/k` if k ≥ 0, else from `√−k + ∛d`, where g is not negative; both are within a factor
/// of two of the zero. The cube root is the limit of `t ← ⁴√(d·t)`, which falls from above too.
///
/// With r this zero, the others are those of `z² + rz + r² + k`. If there are any, the
/// lower of them is the nearest point with τ < 0.
#[derive(Clone, Copy, Debug)]
pub struct Quadratic {
    /// e.
    pub along: f64,
    /// c.
    pub up: f64,
}

/// The zero of the scaled cubic, its k, and the scale from z to τ.
struct Zero<S> {
    z: S,
    k: S,
    scale: S,
}

/// A parabola's nearest point.
#[derive(Clone, Copy, Debug)]
pub struct Nearest<S> {
    /// Its parameter τ, from the vertex.
    pub tau: S,
    /// How far the point is below the parabola; negative above.
    pub below: S,
    /// The unit normal there, pointing out of the region above.
    pub normal: [S; 2],
}

impl Quadratic {
    /// The parabola of the points `(eτ, cτ²)`, for e ≥ 0 and c > 0 [m].
    #[must_use]
    pub fn new(along: f64, up: f64) -> Self {
        Self { along, up }
    }

    #[inline(always)]
    fn zero<S: Scalar>(&self, a: S, b: S) -> Zero<S> {
        let own = S::constant(self.along.max(self.up));
        let size = a.max(b.abs()).max(own);
        let inverse = S::constant(1.0) / size;
        let (a, b) = (a * inverse, b * inverse);
        let (e, c) = (inverse.scale(self.along), inverse.scale(self.up));
        let k = e.squared().scale(0.5) - c * b;
        let d = (e * a).scale(0.5) * c;
        // At least the cube root of any d, which is at most a half.
        let mut third_root = S::constant(0.8);
        for _ in 0..ROOTS {
            third_root = (d * third_root).sqrt().sqrt();
        }
        let (zero, tiny) = (S::constant(0.0), S::constant(TINY));
        let steep = third_root.min(d / k.max(tiny));
        let bent = (-k).max(zero).sqrt() + third_root;
        let mut z = S::select_less(k, zero, bent, steep);
        for _ in 0..STEPS {
            let square = z.squared();
            z = z - ((square + k) * z - d) / (square.scale(3.0) + k).max(tiny);
        }
        Zero { z, k, scale: size.scale(1.0 / self.up) }
    }

    /// The parameters of the nearest point of the parabola, for a ≥ 0, and of the
    /// nearest one on the other side of the axis; or, if there is none, of some point
    /// there.
    #[inline(always)]
    pub fn feet<S: Scalar>(&self, a: S, b: S) -> [S; 2] {
        let Zero { z, k, scale } = self.zero(a, b);
        let rest = -(z.squared().scale(3.0) + k.scale(4.0));
        let other = (z + rest.max(S::constant(0.0)).sqrt()).scale(-0.5);
        [z * scale, other * scale]
    }

    /// The nearest point of the parabola, for a ≥ 0.
    ///
    /// The distance is taken along the normal: an error of τ is of second order.
    #[inline(always)]
    pub fn nearest<S: Scalar>(&self, a: S, b: S) -> Nearest<S> {
        let Zero { z, scale, .. } = self.zero(a, b);
        let tau = z * scale;
        let slope = [tau.scale(2.0 * self.up), S::constant(-self.along)];
        let inverse = S::constant(1.0) / S::norm(slope);
        let normal = [slope[0] * inverse, slope[1] * inverse];
        let from_foot = Vector([a - tau.scale(self.along), b - tau * tau.scale(self.up)]);
        Nearest { tau, below: from_foot.dot(Vector(normal)), normal }
    }
}
