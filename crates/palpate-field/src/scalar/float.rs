// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Plain floating-point numbers.

use super::{Blend, Scalar, power};
use crate::vector::unrolled;

/// A floating-point number: [`f32`] or [`f64`].
pub trait Float:
    Scalar + PartialOrd + Default + Send + Sync + std::fmt::Debug + 'static
{
    /// Lanes in a 64-byte cache line: blocks are worked through in such lines.
    const LINE: usize;

    /// The same number in double precision.
    fn to_f64(self) -> f64;
}

macro_rules! float {
    ($t:ident, $line:literal) => {
        impl Float for $t {
            const LINE: usize = $line;

            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
        }

        impl Scalar for $t {
            #[inline(always)]
            fn epsilon() -> f64 {
                f64::from($t::EPSILON)
            }

            #[inline(always)]
            fn constant(value: f64) -> Self {
                value as $t
            }

            #[inline(always)]
            fn scale(self, factor: f64) -> Self {
                self * factor as $t
            }

            #[inline(always)]
            fn abs(self) -> Self {
                $t::abs(self)
            }

            #[inline(always)]
            fn squared(self) -> Self {
                self * self
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                $t::sqrt(self)
            }

            // Not `$t::min`: its treatment of NaN costs three instructions
            // where the comparison below is one.
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if other < self { other } else { self }
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if other > self { other } else { self }
            }

            #[inline(always)]
            fn select_less(a: Self, b: Self, if_less: Self, otherwise: Self) -> Self {
                if a < b { if_less } else { otherwise }
            }

            #[inline(always)]
            fn sin(self) -> Self {
                power::sin(self)
            }

            #[inline(always)]
            fn cos(self) -> Self {
                power::cos(self)
            }

            #[inline(always)]
            fn turn(x: Self, y: Self) -> Self {
                power::turn(x, y)
            }

            #[inline(always)]
            fn norm<const N: usize>(x: [Self; N]) -> Self {
                let mut sum = x[0] * x[0];
                unrolled!(i < N => if i > 0 {
                    sum += x[i] * x[i];
                });
                sum.sqrt()
            }

            #[inline(always)]
            fn orthant<const N: usize>(q: [Self; N]) -> Self {
                let mut largest = q[0];
                let mut sum = 0.0;
                unrolled!(i < N => {
                    largest = Scalar::max(largest, q[i]);
                    let positive = Scalar::max(q[i], 0.0);
                    sum += positive * positive;
                });
                sum.sqrt() + Scalar::min(largest, 0.0)
            }

            #[inline(always)]
            fn smooth_min<B: Blend>(self, other: Self, unit: f64) -> Self {
                let t = (self - other).abs() * (1.0 / unit) as $t;
                Scalar::min(self, other) - B::fill(t) * unit as $t
            }

            #[inline(always)]
            fn nearest_multiple(self, spacing: f64, low: f64, high: f64) -> Self {
                // Adding this rounds to the nearest integer without a call into a
                // library, which would stop vectorisation.
                let round: $t = 1.5 / $t::EPSILON;
                let count = self * (1.0 / spacing) as $t;
                let limited = Scalar::clamp(count, low, high);
                ((limited + round) - round) * spacing as $t
            }
        }
    };
}

float!(f32, 16);
float!(f64, 8);
