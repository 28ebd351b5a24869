// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! B-splines over the samples of a grid, and their control values over a cell.

use std::ops::{Add, Mul, Sub};

use palpate_field::Vector;

/// How a grid's samples are interpolated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum GridKernel {
    /// Quadratic B-splines, with samples as coefficients: the gradient is continuous, so a force does not
    /// step where a hand crosses a cell's side. To be felt.
    #[default]
    Quadratic,
    /// Products of linear functions: half the time, but the gradient steps at the sides of cells.
    Trilinear,
}

impl GridKernel {
    /// Every kernel.
    pub const ALL: [Self; 2] = [Self::Quadratic, Self::Trilinear];

    /// The name, which stays the same: "quadratic" or "trilinear".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Quadratic => "quadratic",
            Self::Trilinear => "trilinear",
        }
    }

    /// The samples of a cell along an axis.
    pub(crate) const fn taps(self) -> usize {
        match self {
            Self::Quadratic => QUADRATIC,
            Self::Trilinear => TRILINEAR,
        }
    }
}

pub(crate) const QUADRATIC: usize = 3;
pub(crate) const TRILINEAR: usize = 2;

/// Numbers that are interpolated: one, or several side by side.
pub(crate) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    fn constant(number: f64) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn constant(number: f64) -> Self {
        number
    }
}

/// A cell's splines along one axis, with the `K` samples that they take.
///
/// The weights are a partition of one with mean `x + K/2 − 1`, so affine samples give the affine function.
pub(crate) trait Spline<const K: usize> {
    /// The weights of the samples at `x`, from 0 to 1 within the cell.
    fn weights<N: Number>(x: N) -> [N; K];
    /// The derivatives of the weights.
    fn slopes<N: Number>(x: N) -> [N; K];
    /// The samples' share in the control values of the value, in the basis of Bernstein of degree `K − 1`.
    const VALUES: [[f64; K]; K];
    /// The samples' share in the control values of the derivative, in the same basis.
    const SLOPES: [[f64; K]; K];
    /// The control values' share in those of the lower and of the upper half of the cell (de Casteljau).
    const HALVES: [[[f64; K]; K]; 2];
}

/// The splines that the number of samples along an axis names.
#[derive(Debug)]
pub(crate) struct OfTaps<const K: usize>;

impl Spline<QUADRATIC> for OfTaps<QUADRATIC> {
    #[inline(always)]
    fn weights<N: Number>(x: N) -> [N; QUADRATIC] {
        let [half, one] = [0.5, 1.0].map(N::constant);
        let y = one - x;
        [half * y * y, half + x * y, half * x * x]
    }

    #[inline(always)]
    fn slopes<N: Number>(x: N) -> [N; QUADRATIC] {
        let [one, two] = [1.0, 2.0].map(N::constant);
        [x - one, one - two * x, x]
    }

    const VALUES: [[f64; QUADRATIC]; QUADRATIC] =
        [[0.5, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 0.5]];
    const SLOPES: [[f64; QUADRATIC]; QUADRATIC] =
        [[-1.0, 1.0, 0.0], [-0.5, 0.0, 0.5], [0.0, -1.0, 1.0]];
    const HALVES: [[[f64; QUADRATIC]; QUADRATIC]; 2] = [
        [[1.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.25, 0.5, 0.25]],
        [[0.25, 0.5, 0.25], [0.0, 0.5, 0.5], [0.0, 0.0, 1.0]],
    ];
}

impl Spline<TRILINEAR> for OfTaps<TRILINEAR> {
    #[inline(always)]
    fn weights<N: Number>(x: N) -> [N; TRILINEAR] {
        [N::constant(1.0) - x, x]
    }

    #[inline(always)]
    fn slopes<N: Number>(_x: N) -> [N; TRILINEAR] {
        [-1.0, 1.0].map(N::constant)
    }

    const VALUES: [[f64; TRILINEAR]; TRILINEAR] = [[1.0, 0.0], [0.0, 1.0]];
    const SLOPES: [[f64; TRILINEAR]; TRILINEAR] = [[-1.0, 1.0], [-1.0, 1.0]];
    const HALVES: [[[f64; TRILINEAR]; TRILINEAR]; 2] =
        [[[1.0, 0.0], [0.5, 0.5]], [[0.5, 0.5], [0.0, 1.0]]];
}

/// The most rows of samples along the first axis of a cell.
pub(crate) const MOST_ROWS: usize = QUADRATIC.pow(2);

/// `Σ wᵢ cᵢ` over a cell's samples, with the product of the axes' weights for each: summed along one axis after
/// the other.
#[inline(always)]
pub(crate) fn value<N: Number, const K: usize, const D: usize>(
    row: impl Fn(usize) -> [N; K],
    local: [N; D],
) -> N
where
    OfTaps<K>: Spline<K>,
{
    let mut sums = [N::constant(0.0); MOST_ROWS];
    let mut rows = K.pow(D as u32 - 1);
    let weights = OfTaps::<K>::weights(local[0]);
    for (i, sum) in sums[..rows].iter_mut().enumerate() {
        *sum = dot(weights, row(i));
    }
    for x in local.into_iter().skip(1) {
        let weights = OfTaps::<K>::weights(x);
        rows /= K;
        for i in 0..rows {
            sums[i] = dot(weights, taps(&sums, i));
        }
    }
    sums[0]
}

/// The same, with the derivatives along the axes.
#[inline(always)]
pub(crate) fn value_slope<N: Number, const K: usize, const D: usize>(
    row: impl Fn(usize) -> [N; K],
    local: [N; D],
) -> (N, Vector<N, D>)
where
    OfTaps<K>: Spline<K>,
{
    let mut sums = [N::constant(0.0); MOST_ROWS];
    let mut slopes = [[N::constant(0.0); MOST_ROWS]; D];
    let mut rows = K.pow(D as u32 - 1);
    let (weights, rises) = (OfTaps::<K>::weights(local[0]), OfTaps::<K>::slopes(local[0]));
    for i in 0..rows {
        let row = row(i);
        sums[i] = dot(weights, row);
        slopes[0][i] = dot(rises, row);
    }
    for axis in 1..D {
        let x = local[axis];
        let (weights, rises) = (OfTaps::<K>::weights(x), OfTaps::<K>::slopes(x));
        rows /= K;
        for i in 0..rows {
            for slope in &mut slopes[..axis] {
                slope[i] = dot(weights, taps(slope, i));
            }
            let row = taps(&sums, i);
            slopes[axis][i] = dot(rises, row);
            sums[i] = dot(weights, row);
        }
    }
    (sums[0], Vector(slopes.map(|slope| slope[0])))
}

#[inline(always)]
fn dot<N: Number, const K: usize>(weights: [N; K], row: [N; K]) -> N {
    let mut sum = weights[0] * row[0];
    for tap in 1..K {
        sum = sum + weights[tap] * row[tap];
    }
    sum
}

/// The `i`th `K` numbers.
#[inline(always)]
fn taps<N: Number, const K: usize>(numbers: &[N; MOST_ROWS], i: usize) -> [N; K] {
    std::array::from_fn(|tap| numbers[i * K + tap])
}
