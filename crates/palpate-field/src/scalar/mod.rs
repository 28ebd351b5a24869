// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Numbers a formula can be evaluated with.
//!
//! A kernel is written once, over [`Scalar`]. Evaluating it with
//!
//! - [`f64`] or [`f32`] gives distances,
//! - [`Dual`] gives distances and gradients,
//! - [`Model`] gives bounds over a whole cell,
//! - [`Recorded`] gives the formula itself, as an [`Expression`].
//!
//! Choices are operations ([`Scalar::select_less`]) and not branches, so that a
//! block of points vectorises and a recorder can see both sides.

mod blend;
mod dual;
mod expression;
mod float;
mod graph;
mod model;
pub(crate) mod power;
mod recorded;

use std::ops::{Add, Div, Mul, Neg, Sub};

pub use blend::{Blend, Circular, Cubic, Exponential, Quadratic, Quartic, Root};
pub use dual::Dual;
pub use expression::{Expression, Operation, Step};
pub use float::Float;
pub(crate) use graph::{Graph, PowerForm, Purpose, Recipe};
pub(crate) use model::TurnedBoxes;
pub use model::{AffineModel, Model, SpaceTimeModel};
pub use recorded::Recorded;

use crate::vector::unrolled;

/// A number that the formulas of this crate can be evaluated with.
///
/// The operations beyond arithmetic exist because their parts, taken one by
/// one, would lose what makes a [`Model`] tight: the norm is convex, but a sum
/// of squares under a root is not seen to be.
///
/// No operation rejects NaN: inputs are checked where they enter a shape.
pub trait Scalar:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Spacing of the numbers just above one.
    fn epsilon() -> f64;

    /// The number `value`, rounded to what `Self` can hold.
    fn constant(value: f64) -> Self;

    /// `self · factor`.
    fn scale(self, factor: f64) -> Self;

    /// `|self|`.
    fn abs(self) -> Self;

    /// `Σ weightsᵢ·xᵢ`: a row of a rotation.
    #[inline(always)]
    fn weighted_sum<const N: usize>(x: [Self; N], weights: &[f64; N]) -> Self {
        let mut sum = x[0].scale(weights[0]);
        unrolled!(i < N => if i > 0 {
            sum = sum + x[i].scale(weights[i]);
        });
        sum
    }

    /// `self` less a constant: in a [`Model`] only the value is rounded.
    #[inline(always)]
    fn minus(self, constant: f64) -> Self {
        self - Self::constant(constant)
    }

    /// `self²`.
    fn squared(self) -> Self;

    /// The square root. Negative numbers are a caller's error and give NaN.
    fn sqrt(self) -> Self;

    /// The smaller of the two; `self` at a tie.
    fn min(self, other: Self) -> Self;

    /// The larger of the two; `self` at a tie.
    fn max(self, other: Self) -> Self;

    /// `if_less` where `a < b`, else `otherwise`.
    fn select_less(a: Self, b: Self, if_less: Self, otherwise: Self) -> Self;

    /// The sine of an angle in radians, by a polynomial of our own.
    ///
    /// Absolute error at most 4 ulp of one for `|self| ≤ 2¹⁶`.
    fn sin(self) -> Self;

    /// The cosine of an angle in radians; as [`sin`](Self::sin).
    fn cos(self) -> Self;

    /// `atan2(y, x)/2π`: the angle from +x to the point `(x, y)`, as a part of a turn in [−½, ½]; zero at the
    /// origin. Multiples of an eighth of a turn come out exact.
    ///
    /// Absolute error at most half an ulp of one.
    ///
    /// A [`Model`] does not jump where its cell crosses the cut at ±½: there it may be off by
    /// a whole turn. So what is made of a turn must be the same a turn on.
    ///
    /// ```
    /// use palpate_field::scalar::Scalar;
    ///
    /// assert_eq!(f64::turn(0.0, 2.0), 0.25);
    /// assert_eq!(f64::turn(-3.0, -3.0), -0.375);
    /// ```
    fn turn(x: Self, y: Self) -> Self;

    /// The Euclidean norm `√Σxᵢ²`.
    fn norm<const N: usize>(x: [Self; N]) -> Self;

    /// The norm `(Σ|xᵢ|^P)^(1/P)` of the powers `P`, one of 4, 6 and 8.
    ///
    /// From the largest `|xᵢ|` to the Euclidean norm, and no steeper than one. With a
    /// relative error of at most 2 ulp (measured: 1.5); exact where all but one
    /// component are zero. No power leaves the range, in single precision either.
    ///
    /// ```
    /// use palpate_field::scalar::Scalar;
    ///
    /// // The smallest three fourth powers whose sum is a fourth power (Frye, 1988).
    /// let n = f64::power_norm::<4, 3>([95_800.0, -217_519.0, 414_560.0]);
    /// assert_eq!(n, 422_481.0);
    /// ```
    #[inline(always)]
    fn power_norm<const P: u32, const N: usize>(x: [Self; N]) -> Self {
        power::norm::<Self, P, N>(x)
    }

    /// The signed distance from `q` to the orthant `qᵢ ≤ 0`:
    /// `‖max(q, 0)‖ + min(max qᵢ, 0)`.
    ///
    /// Every box, cylinder and extrusion ends in this form.
    fn orthant<const N: usize>(q: [Self; N]) -> Self;

    /// As [`orthant`](Self::orthant), with the norm of the powers `P` past edges and
    /// corners: `‖max(q, 0)‖_P + min(max qᵢ, 0)`, no more than the distance.
    #[inline(always)]
    fn power_orthant<const P: u32, const N: usize>(q: [Self; N]) -> Self {
        power::orthant::<Self, P, N>(q)
    }

    /// The smaller of the two, the crease between them filled by `B`, whose length
    /// unit is `unit` [m].
    fn smooth_min<B: Blend>(self, other: Self, unit: f64) -> Self;

    /// The larger of the two, the crease between them cut off by `B`:
    /// `−smooth_min(−self, −other)`.
    #[inline(always)]
    fn smooth_max<B: Blend>(self, other: Self, unit: f64) -> Self {
        -(-self).smooth_min::<B>(-other, unit)
    }

    /// The multiple of `spacing` that is nearest, of those from `low · spacing` to
    /// `high · spacing`: constant between its steps.
    fn nearest_multiple(self, spacing: f64, low: f64, high: f64) -> Self;

    /// `self`, which may be wrong by `by` elsewhere in the cell: what a [`Model`] adds
    /// to its remainders; nothing for a point.
    #[inline(always)]
    fn give_or_take(self, _by: Self) -> Self {
        self
    }

    /// `self` limited to `[low, high]`, for `low ≤ high`.
    #[inline(always)]
    fn clamp(self, low: f64, high: f64) -> Self {
        self.max(Self::constant(low)).min(Self::constant(high))
    }
}
