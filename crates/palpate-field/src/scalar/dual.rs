// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Numbers that carry their derivative.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{Blend, Float, Scalar, power};
use crate::vector::{array, unrolled};

/// A value and its gradient with respect to `D` coordinates (forward-mode
/// differentiation).
///
/// At a kink the derivative is the one-sided limit of the branch that
/// [`Scalar`] takes: the first argument of `min` and `max` at a tie, the
/// positive side of `abs`, the first coordinate of `norm` and `orthant` at
/// zero. It is never NaN where the value is finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T, const D: usize> {
    /// The value.
    pub value: T,
    /// The derivative with respect to each coordinate.
    pub gradient: [T; D],
}

impl<T: Float, const D: usize> Dual<T, D> {
    /// The coordinates of a point, each with itself as its derivative.
    ///
    /// ```
    /// use palpate_field::scalar::{Dual, Scalar};
    ///
    /// let [x, y] = Dual::variables([0.0, 4.0]);
    /// let r = Scalar::norm([x, y]);
    /// assert_eq!((r.value, r.gradient), (4.0, [0.0, 1.0]));
    /// ```
    #[inline(always)]
    pub fn variables(point: [T; D]) -> [Self; D] {
        array!(i < D => {
            let mut gradient = [T::constant(0.0); D];
            gradient[i] = T::constant(1.0);
            Self { value: point[i], gradient }
        })
    }

    /// `value` with derivative `slope · self.gradient`.
    #[inline(always)]
    fn chain(self, value: T, slope: T) -> Self {
        Self { value, gradient: array!(k < D => slope * self.gradient[k]) }
    }

    #[inline(always)]
    fn select(a: T, b: T, if_less: Self, otherwise: Self) -> Self {
        Self {
            value: T::select_less(a, b, if_less.value, otherwise.value),
            gradient: array!(k < D => {
                T::select_less(a, b, if_less.gradient[k], otherwise.gradient[k])
            }),
        }
    }
}

impl<T: Float, const D: usize> Add for Dual<T, D> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            gradient: array!(k < D => self.gradient[k] + other.gradient[k]),
        }
    }
}

impl<T: Float, const D: usize> Sub for Dual<T, D> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            gradient: array!(k < D => self.gradient[k] - other.gradient[k]),
        }
    }
}

impl<T: Float, const D: usize> Mul for Dual<T, D> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            gradient: array!(k < D => {
                self.value * other.gradient[k] + other.value * self.gradient[k]
            }),
        }
    }
}

impl<T: Float, const D: usize> Div for Dual<T, D> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let inverse = T::constant(1.0) / other.value;
        Self {
            value,
            gradient: array!(k < D => {
                (self.gradient[k] - value * other.gradient[k]) * inverse
            }),
        }
    }
}

impl<T: Float, const D: usize> Neg for Dual<T, D> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, gradient: array!(k < D => -self.gradient[k]) }
    }
}

impl<T: Float, const D: usize> Scalar for Dual<T, D> {
    #[inline(always)]
    fn epsilon() -> f64 {
        T::epsilon()
    }

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { value: T::constant(value), gradient: [T::constant(0.0); D] }
    }

    #[inline(always)]
    fn scale(self, factor: f64) -> Self {
        self.chain(self.value.scale(factor), T::constant(factor))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let zero = T::constant(0.0);
        let sign = T::select_less(self.value, zero, T::constant(-1.0), T::constant(1.0));
        self.chain(self.value.abs(), sign)
    }

    #[inline(always)]
    fn squared(self) -> Self {
        self.chain(self.value.squared(), self.value + self.value)
    }

    /// At zero, where the root has no derivative, the gradient is zero.
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, inverse_or_zero(root).scale(0.5))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(other.value, self.value, other, self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.value, other.value, other, self)
    }

    #[inline(always)]
    fn select_less(a: Self, b: Self, if_less: Self, otherwise: Self) -> Self {
        Self::select(a.value, b.value, if_less, otherwise)
    }

    #[inline(always)]
    fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }

    #[inline(always)]
    fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }

    /// At the origin, where the angle has no derivative, the gradient is zero.
    #[inline(always)]
    fn turn(x: Self, y: Self) -> Self {
        let inverse = inverse_or_zero(T::norm([x.value, y.value]));
        let per_turn = inverse.scale(1.0 / std::f64::consts::TAU);
        let by_x = -(y.value * inverse) * per_turn;
        let by_y = x.value * inverse * per_turn;
        Self {
            value: T::turn(x.value, y.value),
            gradient: array!(k < D => by_x * x.gradient[k] + by_y * y.gradient[k]),
        }
    }

    #[inline(always)]
    fn norm<const N: usize>(x: [Self; N]) -> Self {
        let zero = T::constant(0.0);
        let value = T::norm(array!(i < N => x[i].value));
        let inverse = inverse_or_zero(value);
        let mut gradient = [zero; D];
        unrolled!(i < N => {
            let at_zero = T::constant(if i == 0 { 1.0 } else { 0.0 });
            let weight = T::select_less(zero, value, x[i].value * inverse, at_zero);
            unrolled!(k < D => gradient[k] = gradient[k] + weight * x[i].gradient[k]);
        });
        Self { value, gradient }
    }

    #[inline(always)]
    fn power_norm<const P: u32, const N: usize>(x: [Self; N]) -> Self {
        let values = array!(i < N => x[i].value);
        let split = power::split::<T, P, N>(values);
        let weights = split.gradient::<P>(values);
        let mut gradient = [T::constant(0.0); D];
        unrolled!(i < N => {
            unrolled!(k < D => gradient[k] = gradient[k] + weights[i] * x[i].gradient[k]);
        });
        Self { value: split.largest * split.root, gradient }
    }

    #[inline(always)]
    fn orthant<const N: usize>(q: [Self; N]) -> Self {
        let zero = T::constant(0.0);
        let one = T::constant(1.0);
        let mut largest = q[0].value;
        let mut sum = zero;
        unrolled!(i < N => {
            largest = largest.max(q[i].value);
            sum = sum + q[i].value.max(zero).squared();
        });
        let outside = sum.sqrt();
        let inverse = one / T::select_less(zero, outside, outside, one);
        // Outside, each face counts by its share; inside, the first face among
        // those with the largest value decides.
        let mut shares = [zero; D];
        let mut nearest = q[0];
        unrolled!(i < N => {
            let share = q[i].value.max(zero) * inverse;
            unrolled!(k < D => shares[k] = shares[k] + share * q[i].gradient[k]);
            nearest = nearest.max(q[i]);
        });
        Self {
            value: outside + largest.min(zero),
            gradient: array!(k < D => {
                T::select_less(zero, outside, shares[k], nearest.gradient[k])
            }),
        }
    }

    #[inline(always)]
    fn nearest_multiple(self, spacing: f64, low: f64, high: f64) -> Self {
        let value = self.value.nearest_multiple(spacing, low, high);
        Self { value, gradient: [T::constant(0.0); D] }
    }

    #[inline(always)]
    fn smooth_min<B: Blend>(self, other: Self, unit: f64) -> Self {
        let one = T::constant(1.0);
        let larger = B::weight((self.value - other.value).abs().scale(1.0 / unit));
        let weight = T::select_less(other.value, self.value, larger, one - larger);
        let rest = one - weight;
        Self {
            value: self.value.smooth_min::<B>(other.value, unit),
            gradient: array!(k < D => {
                weight * self.gradient[k] + rest * other.gradient[k]
            }),
        }
    }
}

#[inline(always)]
fn inverse_or_zero<T: Float>(value: T) -> T {
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    T::select_less(zero, value, one / T::select_less(zero, value, value, one), zero)
}
