//! Ellipses and ellipsoids.

use crate::bounds::Bounds;
use crate::error::{ShapeError, Unit, positive};
use crate::kernel::{Kernel, primitive, tangent_model};
use crate::promise::Promise;
use crate::scalar::{Float, Model, Scalar};
use crate::vector::{Vector, array};

/// Newton steps to the nearest point. From the start below, six reach the last
/// bit for aspect ratios up to a million; two more are spare.
const STEPS: usize = 8;

/// Relative rounding of the distance, in operations.
const OPERATIONS: f64 = 64.0;

/// The ellipse or ellipsoid `Σ(pᵢ/rᵢ)² ≤ 1`. Exact.
///
/// # Derivation
///
/// The nearest point `x` to `y ≥ 0` has `y − x` along the normal `xᵢ/rᵢ²`, so
/// `xᵢ = rᵢ²yᵢ/(t + rᵢ²)` for the largest root `t` of
/// `g(t) = Σ(rᵢyᵢ/(t + rᵢ²))² − 1`, which is convex and falling there. Start
/// where the largest of the terms is one: then `0 ≤ g ≤ D − 1`, Newton's method
/// rises to the root without overshooting, and a fixed number of steps is enough
/// (after Eberly, "Distance from a point to an ellipse, an ellipsoid, or a
/// hyperellipsoid", 2013). The unknown is `s = t + min rᵢ²`, so that nothing
/// cancels for thin shapes; a coordinate of zero along the thinnest axis is
/// moved by an ulp of the size, so that points on the medial axis have a nearest
/// point too.
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
        let tiny = S::constant(self.smallest * S::EPSILON);
        let scaled: [S; D] = array!(i < D => {
            let thin = self.excess[i] == 0.0;
            let y = if thin { y.0[i].max(tiny) } else { y.0[i] };
            y.scale(self.radii[i])
        });
        let mut s = scaled[0] - excess(0);
        for i in 1..D {
            s = s.max(scaled[i] - excess(i));
        }
        for _ in 0..STEPS {
            let mut value = S::constant(-1.0);
            let mut slope = S::constant(0.0);
            for i in 0..D {
                let inverse = S::constant(1.0) / (s + excess(i));
                let share = (scaled[i] * inverse).squared();
                value = value + share;
                slope = slope + share * inverse;
            }
            s = s + (value / slope).scale(0.5);
        }
        // The shares xᵢ/rᵢ have length one, which their rounding is made to obey.
        let shares: [S; D] = array!(i < D => scaled[i] / (s + excess(i)));
        let inverse = S::constant(1.0) / S::norm(shares);
        let shares = array!(i < D => shares[i] * inverse);
        let across: [S; D] = array!(i < D => shares[i].scale(1.0 / self.radii[i]));
        let inverse = S::constant(1.0) / S::norm(across);
        let normal = Vector(array!(i < D => across[i] * inverse));
        // Along the normal: an error of the nearest point is of second order.
        let nearest = Vector(array!(i < D => shares[i].scale(self.radii[i])));
        ((y - nearest).dot(normal), normal)
    }
}

impl<const D: usize> Kernel<D> for Ellipsoid<D> {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        self.solve(p.abs()).0
    }

    /// The gradient is the normal at the nearest point, on both sides.
    #[inline(always)]
    fn distance_gradient<T: Float>(&self, p: Vector<T, D>) -> (T, Vector<T, D>) {
        let (distance, normal) = self.solve(p.abs());
        let zero = T::constant(0.0);
        let signed = |i: usize| T::select_less(p.0[i], zero, -normal.0[i], normal.0[i]);
        (distance, Vector(array!(i < D => signed(i))))
    }

    #[inline(always)]
    fn model(&self, cell: Vector<Model, D>) -> Model {
        tangent_model(self, cell, OPERATIONS, self.largest)
    }

    fn promise(&self) -> Promise<D> {
        let bounds = Bounds::centred(Vector(self.radii), self.largest);
        Promise::exact_convex(Some(bounds), OPERATIONS, self.largest).symmetric()
    }
}

primitive! {
    Ellipsoid<2>, "ellipse", 2,
    about: "An ellipse along the axes.",
    model: Tangent,
    parameters: { radii: Vector = "the radii along the axes" },
    example: (Vector([0.9, 0.4])),
}

primitive! {
    Ellipsoid<3>, "ellipsoid", 3,
    about: "An ellipsoid along the axes.",
    model: Tangent,
    parameters: { radii: Vector = "the radii along the axes" },
    example: (Vector([0.9, 0.6, 0.3])),
}
