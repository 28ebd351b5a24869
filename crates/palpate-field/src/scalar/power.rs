// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The norms of fourth, sixth and eighth powers.
//!
//! Powers by products and roots by square roots alone, so that blocks vectorise and
//! every number takes part. The largest component is divided out first: powers of it
//! would leave the range of single precision at 10⁵ m.

use super::{Float, Scalar};
use crate::vector::array;

/// Components smaller than this are not divided by [m]: its inverse is a number of
/// single precision, and it is far below the rounding of every length accepted.
pub(super) const TINY: f64 = 1e-36;

/// A norm in two factors, `largest · root`.
pub(super) struct Split<S, const N: usize> {
    /// `max |xᵢ|`.
    pub(super) largest: S,
    /// `(Σ sharesᵢ^P)^(1/P)`, from 1 to `N^(1/P)`.
    pub(super) root: S,
    /// `|xᵢ| / max |xⱼ|`: exactly one for the largest.
    shares: [S; N],
}

/// Splits the norm of the powers `P`, one of 4, 6 and 8.
#[inline(always)]
pub(super) fn split<S: Scalar, const P: u32, const N: usize>(x: [S; N]) -> Split<S, N> {
    const { assert!(P == 4 || P == 6 || P == 8, "the norm of another power") };
    let sizes = array!(i < N => x[i].abs());
    let mut largest = sizes[0];
    for size in &sizes[1..] {
        largest = largest.max(*size);
    }
    let divisor = largest.max(S::constant(TINY));
    let shares: [S; N] = array!(i < N => sizes[i] / divisor);
    let mut sum = even_power::<S, P>(shares[0]);
    for share in &shares[1..] {
        sum = sum + even_power::<S, P>(*share);
    }
    // Less than one only where nothing is larger than what is not divided by.
    let root = root::<S, P>(sum.max(S::constant(1.0)));
    Split { largest, root, shares }
}

/// The norm of the powers `P`: [`Scalar::power_norm`].
#[inline(always)]
pub(super) fn norm<S: Scalar, const P: u32, const N: usize>(x: [S; N]) -> S {
    let split = split::<S, P, N>(x);
    split.largest * split.root
}

/// The orthant with the norm of the powers `P`: [`Scalar::power_orthant`].
#[inline(always)]
pub(super) fn orthant<S: Scalar, const P: u32, const N: usize>(q: [S; N]) -> S {
    // Zero first in one and last in the other, so that on a face just one of the
    // two has a slope.
    let zero = S::constant(0.0);
    let mut largest = q[0];
    for component in &q[1..] {
        largest = largest.max(*component);
    }
    S::power_norm::<P, N>(array!(i < N => zero.max(q[i]))) + largest.min(zero)
}

impl<T: Float, const N: usize> Split<T, N> {
    /// The gradient `sign(xᵢ)·(|xᵢ|/n)^(P−1)`; at zero the first unit vector.
    ///
    /// Its Euclidean length is at most one: `|xᵢ|/n ≤ 1`, so the sum of their powers
    /// `2P − 2` is at most that of their powers `P`.
    #[inline(always)]
    pub(super) fn gradient<const P: u32>(&self, x: [T; N]) -> [T; N] {
        let (zero, tiny) = (T::constant(0.0), T::constant(TINY));
        array!(i < N => {
            let at_zero = T::constant(if i == 0 { 1.0 } else { 0.0 });
            let size = odd_power::<T, P>(self.shares[i] / self.root);
            let signed = T::select_less(x[i], zero, -size, size);
            T::select_less(self.largest, tiny, at_zero, signed)
        })
    }
}

/// `x^P`.
#[inline(always)]
fn even_power<S: Scalar, const P: u32>(x: S) -> S {
    let square = x.squared();
    match P {
        4 => square.squared(),
        6 => square.squared() * square,
        _ => square.squared().squared(),
    }
}

/// `x^(P−1)`.
#[inline(always)]
fn odd_power<S: Scalar, const P: u32>(x: S) -> S {
    let square = x.squared();
    match P {
        4 => square * x,
        6 => square.squared() * x,
        _ => square.squared() * square * x,
    }
}

/// `x^(1/P)` for `1 ≤ x ≤ 4`.
#[inline(always)]
fn root<S: Scalar, const P: u32>(x: S) -> S {
    match P {
        4 => x.sqrt().sqrt(),
        6 => cube_root(x.sqrt()),
        _ => x.sqrt().sqrt().sqrt(),
    }
}

/// `x^(1/3)` for `1 ≤ x ≤ 2`, to one ulp in single and double precision; exactly one
/// for one.
///
/// The line through (1, 1) is off by at most 1.9 % at 2, and 0.7 % up to √3. A step of
/// Halley's method leaves two thirds of the cube of the error: two leave 7·10⁻¹⁷ at 2,
/// and 10⁻²⁰ up to √3, which is as far as three components go.
#[inline(always)]
pub fn cube_root<S: Scalar>(x: S) -> S {
    let mut y = S::constant(1.0) + (x - S::constant(1.0)).scale(0.283);
    for _ in 0..2 {
        let cube = y.squared() * y;
        y = y - y * (cube - x) / (cube + cube + x);
    }
    y
}
