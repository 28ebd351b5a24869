// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Numbers of twice the precision, to measure rounding with.

use std::ops::{Add, Div, Mul, Neg, Sub};

use palpate_field::scalar::{Blend, Float, Scalar};

/// The unevaluated sum of two doubles: about 106 bits.
///
/// Sums, products and quotients are off by a few units of 2⁻¹⁰⁴ at most. The
/// algorithms are those of Dekker (1971) and Knuth; the error of a product comes
/// from a fused multiply-add.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Double {
    high: f64,
    low: f64,
}

impl Double {
    /// The nearest double.
    #[must_use]
    pub fn to_f64(self) -> f64 {
        self.high
    }

    /// `a + b`, exactly, for any two doubles.
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let part = high - a;
        Self { high, low: (a - (high - part)) + (b - part) }
    }

    /// `a + b`, exactly, for `|a| ≥ |b|`.
    fn quick_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        Self { high, low: b - (high - a) }
    }

    /// `a · b`, exactly.
    fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        Self { high, low: a.mul_add(b, -high) }
    }

    fn is_less(self, other: Self) -> bool {
        self.high < other.high || (self.high == other.high && self.low < other.low)
    }

    /// Sine and cosine by Taylor series after removing quarter turns.
    fn sine_cosine(self) -> (Self, Self) {
        // π/2 to 106 bits.
        let quarter =
            Self { high: std::f64::consts::FRAC_PI_2, low: 6.123_233_995_736_766e-17 };
        let turns = (self.high * std::f64::consts::FRAC_2_PI).round();
        let x = self - quarter.scale(turns);
        let square = x * x;
        let (mut sine, mut cosine) = (Self::default(), Self::default());
        for k in (0..16).rev() {
            let odd = f64::from((2 * k + 2) * (2 * k + 3));
            let even = f64::from((2 * k + 1) * (2 * k + 2));
            sine = Self::constant(1.0) - square * sine / Self::constant(odd);
            cosine = Self::constant(1.0) - square * cosine / Self::constant(even);
        }
        let sine = x * sine;
        match turns.rem_euclid(4.0) as u8 {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }
}

impl Add for Double {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let high = Self::sum(self.high, other.high);
        let low = Self::sum(self.low, other.low);
        let first = Self::quick_sum(high.high, high.low + low.high);
        Self::quick_sum(first.high, first.low + low.low)
    }
}

impl Neg for Double {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Double {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + (-other)
    }
}

impl Mul for Double {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let exact = Self::product(self.high, other.high);
        let cross = self.high * other.low + self.low * other.high;
        Self::quick_sum(exact.high, exact.low + cross)
    }
}

impl Div for Double {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other.scale(first);
        let second = rest.high / other.high;
        let rest = rest - other.scale(second);
        let third = rest.high / other.high;
        Self::quick_sum(first, second) + Self::constant(third)
    }
}

impl Scalar for Double {
    fn epsilon() -> f64 {
        f64::EPSILON * f64::EPSILON
    }

    fn constant(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }

    fn scale(self, factor: f64) -> Self {
        let exact = Self::product(self.high, factor);
        Self::quick_sum(exact.high, exact.low + self.low * factor)
    }

    fn abs(self) -> Self {
        if self.is_less(Self::default()) { -self } else { self }
    }

    fn squared(self) -> Self {
        self * self
    }

    fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::constant(self.high.sqrt());
        }
        // One Newton step doubles the bits of the plain root.
        let root = self.high.sqrt();
        let rest = self - Self::product(root, root);
        Self::quick_sum(root, rest.high / (2.0 * root))
    }

    fn min(self, other: Self) -> Self {
        if other.is_less(self) { other } else { self }
    }

    fn max(self, other: Self) -> Self {
        if self.is_less(other) { other } else { self }
    }

    fn select_less(a: Self, b: Self, if_less: Self, otherwise: Self) -> Self {
        if a.is_less(b) { if_less } else { otherwise }
    }

    fn sin(self) -> Self {
        self.sine_cosine().0
    }

    fn cos(self) -> Self {
        self.sine_cosine().1
    }

    /// From the plain angle, whose error is the sine of what is left.
    fn turn(x: Self, y: Self) -> Self {
        let radius = Self::norm([x, y]);
        if radius.high == 0.0 {
            return Self::default();
        }
        let plain = Self::constant(y.high.atan2(x.high));
        let (sine, cosine) = plain.sine_cosine();
        let rest = (y * cosine - x * sine) / radius;
        // 2π to 106 bits.
        let whole = Self { high: std::f64::consts::TAU, low: 2.449_293_598_294_706_4e-16 };
        (plain + rest) / whole
    }

    fn norm<const N: usize>(x: [Self; N]) -> Self {
        x.into_iter().fold(Self::default(), |sum, x| sum + x * x).sqrt()
    }

    fn orthant<const N: usize>(q: [Self; N]) -> Self {
        let zero = Self::default();
        let largest = q.into_iter().reduce(Scalar::max).unwrap_or(zero);
        Self::norm(q.map(|q| Scalar::max(q, zero))) + Scalar::min(largest, zero)
    }

    fn nearest_multiple(self, spacing: f64, low: f64, high: f64) -> Self {
        let count = self.high.nearest_multiple(spacing, low, high) / spacing;
        Self::constant(count.round()) * Self::constant(spacing)
    }

    fn smooth_min<B: Blend>(self, other: Self, unit: f64) -> Self {
        let k = Self::constant(unit);
        Scalar::min(self, other) - B::fill(Scalar::abs(self - other) / k) * k
    }
}

/// Needed to evaluate the fill of blends.
impl Float for Double {
    const LINE: usize = 1;

    fn to_f64(self) -> f64 {
        self.high
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Double, b: Double) -> bool {
        Scalar::abs(a - b).high <= 1e-30 * (1.0 + a.high.abs())
    }

    #[test]
    fn identities_hold_to_thirty_digits() {
        let third = Double::constant(1.0) / Double::constant(3.0);
        assert!(close(third + third + third, Double::constant(1.0)));
        let root = Double::constant(2.0).sqrt();
        assert!(close(root * root, Double::constant(2.0)));
        assert!(third.low != 0.0 && root.low != 0.0);
        for angle in [0.1, 1.0, 2.5, -4.0, 100.0] {
            let (sin, cos) = Double::constant(angle).sine_cosine();
            assert!(close(sin * sin + cos * cos, Double::constant(1.0)));
            let (twice, _) = Double::constant(2.0 * angle).sine_cosine();
            assert!(close(twice, (sin * cos).scale(2.0)));
            assert!((sin.high - angle.sin()).abs() < 1e-15);
        }
    }
}
