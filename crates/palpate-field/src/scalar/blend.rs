// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Profiles that fill the crease of a smooth union.

use super::Float;
use super::power::{log2_of_one_plus, power_of_half};

/// How a smooth union fills the crease between two fields.
///
/// With `t = |a − b| / k`, where `k` is the length unit of the profile, the smooth
/// minimum is `min(a, b) − k·φ(t)`. Every profile falls from `φ(0)` with slope
/// `φ'(0) = −½` to zero and is convex, so the result is continuously
/// differentiable; `−φ'` lies in `[0, ½]`, so its gradient is a convex mix of the
/// two gradients.
///
/// Reference: Quilez, "Smooth minimum", <https://iquilezles.org/articles/smin/>.
///
/// The trait is sealed: tapes and shaders have an operation for each profile.
pub trait Blend: sealed::Sealed + Copy + Send + Sync + 'static {
    /// The name in scene files.
    const NAME: &'static str;

    /// The length unit `k` over the width, which is the fill at `a = b`: `1/φ(0)`.
    const UNIT_OVER_WIDTH: f64;

    /// Beyond this difference of the fields, in units, nothing is filled.
    const REACH: f64 = 1.0;

    /// `φ(t)` for `t ≥ 0`.
    fn fill<T: Float>(t: T) -> T;

    /// `−φ'(t)`: the weight of the larger field.
    fn weight<T: Float>(t: T) -> T;

    /// An upper bound of `φ''` on `[t, ∞)`.
    fn curvature(t: f64) -> f64;
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::Quadratic {}
    impl Sealed for super::Cubic {}
    impl Sealed for super::Quartic {}
    impl Sealed for super::Circular {}
    impl Sealed for super::Root {}
    impl Sealed for super::Exponential {}
}

/// The part of the reach that is left: `max(1 − t, 0)`.
#[inline(always)]
fn rest<T: Float>(t: T) -> T {
    (T::constant(1.0) - t).max(T::constant(0.0))
}

/// `φ(t) = x²/4` with `x = max(1 − t, 0)`: the fill of the memoir.
#[derive(Clone, Copy, Debug)]
pub struct Quadratic;

impl Blend for Quadratic {
    const NAME: &'static str = "quadratic";
    const UNIT_OVER_WIDTH: f64 = 4.0;

    #[inline(always)]
    fn fill<T: Float>(t: T) -> T {
        rest(t).squared().scale(0.25)
    }

    #[inline(always)]
    fn weight<T: Float>(t: T) -> T {
        rest(t).scale(0.5)
    }

    #[inline(always)]
    fn curvature(t: f64) -> f64 {
        if t < 1.0 { 0.5 } else { 0.0 }
    }
}

/// `φ(t) = x³/6` with `x = max(1 − t, 0)`: smoother at the ends of the fill.
#[derive(Clone, Copy, Debug)]
pub struct Cubic;

impl Blend for Cubic {
    const NAME: &'static str = "cubic";
    const UNIT_OVER_WIDTH: f64 = 6.0;

    #[inline(always)]
    fn fill<T: Float>(t: T) -> T {
        let x = rest(t);
        (x.squared() * x).scale(1.0 / 6.0)
    }

    #[inline(always)]
    fn weight<T: Float>(t: T) -> T {
        rest(t).squared().scale(0.5)
    }

    #[inline(always)]
    fn curvature(t: f64) -> f64 {
        rest(t)
    }
}

/// `φ(t) = x³(4 − x)/16` with `x = max(1 − t, 0)`: as smooth as the cubic at the ends
/// of the fill, and its curvature has no kink in the middle.
#[derive(Clone, Copy, Debug)]
pub struct Quartic;

impl Blend for Quartic {
    const NAME: &'static str = "quartic";
    const UNIT_OVER_WIDTH: f64 = 16.0 / 3.0;

    #[inline(always)]
    fn fill<T: Float>(t: T) -> T {
        let x = rest(t);
        (x.squared() * x * (T::constant(4.0) - x)).scale(1.0 / 16.0)
    }

    #[inline(always)]
    fn weight<T: Float>(t: T) -> T {
        let x = rest(t);
        (x.squared() * (T::constant(3.0) - x)).scale(0.25)
    }

    #[inline(always)]
    fn curvature(t: f64) -> f64 {
        let x = rest(t);
        0.75 * x * (2.0 - x)
    }
}

/// `φ(t) = ½(1 + x − √(1 + 2x − x²))` with `x = max(1 − t, 0)`: a quarter circle
/// between two fields that are affine and at right angles.
///
/// Written as `x² / (1 + x + √(1 + 2x − x²))`, which does not cancel.
#[derive(Clone, Copy, Debug)]
pub struct Circular;

/// `√(1 + 2x − x²)`.
#[inline(always)]
fn circle<T: Float>(x: T) -> T {
    (T::constant(1.0) + x * (T::constant(2.0) - x)).sqrt()
}

impl Blend for Circular {
    const NAME: &'static str = "circular";
    /// `1 / (1 − √½)`.
    const UNIT_OVER_WIDTH: f64 = 2.0 + std::f64::consts::SQRT_2;

    #[inline(always)]
    fn fill<T: Float>(t: T) -> T {
        let x = rest(t);
        x.squared() / (T::constant(1.0) + x + circle(x))
    }

    #[inline(always)]
    fn weight<T: Float>(t: T) -> T {
        let x = rest(t);
        // ½(1 − (1 − x)/√…), where the two ones cancel for small x.
        let root = circle(x);
        let one = T::constant(1.0);
        x.scale(2.0) / (root * (root + one - x)) - x.squared() / (root * (root + one - x))
    }

    #[inline(always)]
    fn curvature(t: f64) -> f64 {
        // 1/√(1 + 2x − x²)³ falls with x.
        if t < 1.0 { 1.0 } else { 0.0 }
    }
}

/// `φ(t) = ½(√(t² + 1) − t)`: a hyperbola, which fills everywhere a little.
#[derive(Clone, Copy, Debug)]
pub struct Root;

impl Blend for Root {
    const NAME: &'static str = "root";
    const UNIT_OVER_WIDTH: f64 = 2.0;
    const REACH: f64 = f64::INFINITY;

    #[inline(always)]
    fn fill<T: Float>(t: T) -> T {
        // Written so that it does not cancel.
        T::constant(0.5) / (T::norm([t, T::constant(1.0)]) + t)
    }

    #[inline(always)]
    fn weight<T: Float>(t: T) -> T {
        let root = T::norm([t, T::constant(1.0)]);
        T::constant(0.5) / (root * (root + t))
    }

    #[inline(always)]
    fn curvature(t: f64) -> f64 {
        let square = t * t + 1.0;
        0.5 / (square * square.sqrt())
    }
}

/// `φ(t) = log₂(1 + 2⁻ᵗ)`: the logarithm of a sum of powers, the one profile for which
/// the order of more than two shapes makes no difference.
#[derive(Clone, Copy, Debug)]
pub struct Exponential;

impl Blend for Exponential {
    const NAME: &'static str = "exponential";
    const UNIT_OVER_WIDTH: f64 = 1.0;
    const REACH: f64 = f64::INFINITY;

    #[inline(always)]
    fn fill<T: Float>(t: T) -> T {
        log2_of_one_plus(power_of_half(t))
    }

    #[inline(always)]
    fn weight<T: Float>(t: T) -> T {
        let power = power_of_half(t);
        power / (T::constant(1.0) + power)
    }

    #[inline(always)]
    fn curvature(t: f64) -> f64 {
        // ln 2 · y/(1 + y)² with y = 2⁻ᵗ falls with t.
        let power = power_of_half(t);
        std::f64::consts::LN_2 * power / ((1.0 + power) * (1.0 + power))
    }
}
