// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Profiles that fill the crease of a smooth union.

use super::Float;

/// How a smooth union fills the crease between two fields.
///
/// With `x = max(1 − |a − b| / k, 0)`, where `k` is the reach, the smooth
/// minimum is `min(a, b) − k·φ(x)`. Every profile has `φ(0) = φ'(0) = 0` and
/// `φ'(1) = ½`, so the result is continuously differentiable; `φ'` lies in
/// `[0, ½]`, so its gradient is a convex mix of the two gradients.
///
/// Reference: Quilez, "Smooth minimum", <https://iquilezles.org/articles/smin/>.
pub trait Blend: Copy + Send + Sync + 'static {
    /// The name in scene files.
    const NAME: &'static str;

    /// Reach over width: the width is the fill at `a = b`, which is `k·φ(1)`.
    const REACH_OVER_WIDTH: f64;

    /// `φ(x)` for `x` in `[0, 1]`.
    fn fill<T: Float>(x: T) -> T;

    /// `φ'(x)`: the weight of the larger field.
    fn weight<T: Float>(x: T) -> T;

    /// An upper bound of `φ''` on `[0, x]`.
    fn curvature(x: f64) -> f64;
}

/// `φ(x) = x²/4`: the fill of the memoir; reach 4 times the width.
#[derive(Clone, Copy, Debug)]
pub struct Quadratic;

impl Blend for Quadratic {
    const NAME: &'static str = "quadratic";
    const REACH_OVER_WIDTH: f64 = 4.0;

    #[inline(always)]
    fn fill<T: Float>(x: T) -> T {
        x.squared().scale(0.25)
    }

    #[inline(always)]
    fn weight<T: Float>(x: T) -> T {
        x.scale(0.5)
    }

    #[inline(always)]
    fn curvature(_x: f64) -> f64 {
        0.5
    }
}

/// `φ(x) = x³/6`: smoother at the ends of the fill; reach 6 times the width.
#[derive(Clone, Copy, Debug)]
pub struct Cubic;

impl Blend for Cubic {
    const NAME: &'static str = "cubic";
    const REACH_OVER_WIDTH: f64 = 6.0;

    #[inline(always)]
    fn fill<T: Float>(x: T) -> T {
        (x.squared() * x).scale(1.0 / 6.0)
    }

    #[inline(always)]
    fn weight<T: Float>(x: T) -> T {
        x.squared().scale(0.5)
    }

    #[inline(always)]
    fn curvature(x: f64) -> f64 {
        x
    }
}
