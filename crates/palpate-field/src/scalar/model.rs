// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Numbers that bound a formula over a whole cell.

mod boxes;
mod norms;

use std::ops::{Add, Div, Mul, Neg, Sub};

pub(crate) use boxes::TurnedBoxes;

use super::{Blend, Scalar};
use crate::vector::{array, unrolled};

/// Half the spacing of numbers just above one: the largest relative error of an operation.
const UNIT: f64 = f64::EPSILON / 2.0;

/// Room for the roundings inside one bound: a sum of up to six positive terms
/// and its product are off by at most eight units.
const INFLATE: f64 = 1.0 + 8.0 * UNIT;

/// What sums begin with: `−0 + x` is `x` whatever its sign, and no addition is left of it.
const NONE: f64 = -0.0;

/// Stands for "no bound": larger than every length, and its products stay finite.
const UNBOUNDED: f64 = 1e60;

/// An affine function with remainders, which encloses a formula over a cell.
///
/// The cell is the image of the cube `|uₖ| ≤ 1` of `N` parameters, at most four: three for
/// boxes in space ([`Model`]; in the plane, `u₂` is not used), four for boxes in space and
/// time. For every `u` in the cube,
///
/// ```text
/// value + gradient·u − lower  ≤  f  ≤  value + gradient·u + upper
/// ```
///
/// Both remainders include the rounding of every operation, so the enclosure
/// holds for the formula in real arithmetic; but for what is made of a
/// [`turn`](Scalar::turn) across its cut, and is not the same a turn on. For convex formulas (balls,
/// cuboids, cylinders, their intersections and rigid motions) `lower` is
/// rounding alone: the tangent plane at the centre is a bound from below.
///
/// The rules of the operations that are neither convex nor concave in one
/// argument are Taylor's with a bound of the second derivative over the cell.
///
/// ```
/// use palpate_field::scalar::{Model, Scalar};
///
/// // The unit circle over the cell [1.9, 2.1] × [−0.1, 0.1].
/// let [x, y] = Model::cell([2.0, 0.0], [0.1, 0.1]);
/// let circle = Scalar::norm([x, y]) - Model::constant(1.0);
/// assert!(circle.lower < 1e-14); // convex
/// assert!(circle.minimum() <= 0.9 && circle.minimum() > 0.899_999);
/// assert!(circle.maximum() >= 2.1_f64.hypot(0.1) - 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AffineModel<const N: usize> {
    /// The value at the centre of the cell.
    pub value: f64,
    /// The change from the centre to the cell's side along each parameter.
    pub gradient: [f64; N],
    /// How far `f` may lie below the affine function; never negative.
    pub lower: f64,
    /// How far `f` may lie above the affine function; never negative.
    pub upper: f64,
}

/// A model over a box in space or in the plane.
pub type Model = AffineModel<3>;

/// A model over a box in space and time.
pub type SpaceTimeModel = AffineModel<4>;

impl<const N: usize> Default for AffineModel<N> {
    #[inline(always)]
    fn default() -> Self {
        Self::constant(0.0)
    }
}

impl<const N: usize> AffineModel<N> {
    /// The coordinates of the box with `centre` and `half` side lengths, one parameter a
    /// coordinate: of a box in space and time, time is the last coordinate.
    ///
    /// ```
    /// use palpate_field::scalar::AffineModel;
    ///
    /// // x in [1, 3] and t in [0, 1]: x − t is in [0, 3].
    /// let [x, t] = AffineModel::<4>::cell([2.0, 0.5], [1.0, 0.5]);
    /// let left = x - t;
    /// assert!((left.minimum() - 0.0).abs() < 1e-14 && (left.maximum() - 3.0).abs() < 1e-14);
    /// ```
    #[inline(always)]
    pub fn cell<const D: usize>(centre: [f64; D], half: [f64; D]) -> [Self; D] {
        const { assert!(D <= N, "a parameter for each coordinate") };
        std::array::from_fn(|i| {
            let mut gradient = [0.0; N];
            gradient[i] = half[i];
            Self { value: centre[i], gradient, lower: 0.0, upper: 0.0 }
        })
    }

    /// A number at least as small as every value over the cell.
    #[inline(always)]
    pub fn minimum(&self) -> f64 {
        self.value - (self.slope() + self.lower) * INFLATE - 2.0 * UNIT * self.value.abs()
    }

    /// A number at least as large as every value over the cell.
    #[inline(always)]
    pub fn maximum(&self) -> f64 {
        self.value + (self.slope() + self.upper) * INFLATE + 2.0 * UNIT * self.value.abs()
    }

    /// The largest distance of a value over the cell from `value`.
    #[inline(always)]
    pub fn deviation(&self) -> f64 {
        (self.slope() + self.lower.max_of(self.upper)) * INFLATE
    }

    /// An upper bound of the distance of the cell's points from its centre,
    /// given the models of its coordinates.
    ///
    /// The half diagonal of the box around the cell: exact for boxes along the
    /// axes.
    #[inline(always)]
    pub fn radius<const D: usize>(cell: &[Self; D]) -> f64 {
        let mut sum = 0.0;
        unrolled!(i < D => {
            let deviation = cell[i].deviation();
            sum += deviation * deviation;
        });
        sum.sqrt() * INFLATE
    }

    /// Bounds a convex field that is exact on both sides.
    ///
    /// `value` and the unit `normal` are the field's at the centre of `cell`,
    /// `distance_at` its value anywhere, `rounding` the absolute error of these over the
    /// cell. Below, the tangent plane is a bound, since the field is convex. Above, the
    /// field less the plane is convex too, so it is largest at a corner.
    #[inline(always)]
    pub fn tangent<const D: usize>(
        value: f64,
        normal: [f64; D],
        distance_at: impl Fn([f64; D]) -> f64,
        cell: &[Self; D],
        rounding: f64,
    ) -> Self {
        let mut gradient = [0.0; N];
        let (mut lower, mut upper, mut remainders) = (0.0, 0.0, 0.0);
        unrolled!(i < D => {
            let positive = normal[i] > 0.0;
            let size = f64::abs(normal[i]);
            lower += size * choose(positive, cell[i].lower, cell[i].upper);
            upper += size * choose(positive, cell[i].upper, cell[i].lower);
            let remainder = cell[i].lower.max_of(cell[i].upper);
            remainders += remainder * remainder;
            unrolled!(k < N => gradient[k] += normal[i] * cell[i].gradient[k]);
        });
        let mut above = 0.0;
        for corner in 0..1_usize << N {
            let side: [f64; N] =
                array!(k < N => if (corner >> k) & 1 == 0 { -1.0 } else { 1.0 });
            let mut plane = value;
            let mut point = array!(i < D => cell[i].value);
            unrolled!(k < N => {
                plane += gradient[k] * side[k];
                unrolled!(i < D => point[i] += cell[i].gradient[k] * side[k]);
            });
            above = (distance_at(point) - plane).max_of(above);
        }
        let radius = Self::radius(cell);
        let error = rounding + 8.0 * UNIT * (f64::abs(value) + radius);
        // Off the corners by the remainders of the coordinates, the field changes by at
        // most their norm.
        let apart = remainders.sqrt();
        Self {
            value,
            gradient,
            lower: lower + error,
            upper: (upper + above + apart) * INFLATE + 2.0 * error,
        }
    }

    /// Bounds any field with Lipschitz constant `lipschitz` by a constant.
    ///
    /// `value` is the field's at the centre of `cell`, `rounding` its error.
    #[inline(always)]
    pub fn lipschitz<const D: usize>(
        value: f64,
        lipschitz: f64,
        cell: &[Self; D],
        rounding: f64,
    ) -> Self {
        let remainder = lipschitz * Self::radius(cell) * INFLATE + rounding;
        Self { value, gradient: [0.0; N], lower: remainder, upper: remainder }
    }

    /// `Σ|gradientₖ|`: how far the affine part moves over the cell.
    #[inline(always)]
    fn slope(&self) -> f64 {
        let mut sum = NONE;
        unrolled!(k < N => sum += f64::abs(self.gradient[k]));
        sum
    }

    /// `Σ|self.gradientₖ − other.gradientₖ|`.
    #[inline(always)]
    fn slope_between(&self, other: &Self) -> f64 {
        let mut sum = NONE;
        unrolled!(k < N => sum += f64::abs(self.gradient[k] - other.gradient[k]));
        sum
    }

    /// The largest of the numbers over the cell, remainders included.
    #[inline(always)]
    fn size(&self) -> f64 {
        f64::abs(self.value) + self.slope() + (self.lower + self.upper)
    }

    /// Widens both remainders by `units` roundings of the largest value over the cell.
    #[inline(always)]
    fn rounded(self, units: f64) -> Self {
        self.widened(units * UNIT * self.size())
    }

    /// As [`rounded`](Self::rounded), of the largest value and `more` on top of it.
    #[inline(always)]
    fn rounded_with(self, units: f64, more: f64) -> Self {
        self.widened(units * UNIT * (self.size() + more))
    }

    /// Widens both remainders by `error`.
    #[inline(always)]
    fn widened(self, error: f64) -> Self {
        Self { lower: self.lower + error, upper: self.upper + error, ..self }
    }

    /// `φ(self)` from `φ` and `φ'` at the centre and the remainders that its
    /// curvature adds; a negative slope exchanges the remainders of `self`.
    #[inline(always)]
    fn chain(self, value: f64, slope: f64, below: f64, above: f64) -> Self {
        let size = f64::abs(slope);
        let up = slope > 0.0;
        Self {
            value,
            gradient: array!(k < N => slope * self.gradient[k]),
            lower: size * choose(up, self.lower, self.upper) + below,
            upper: size * choose(up, self.upper, self.lower) + above,
        }
        .rounded(8.0)
    }

    #[inline(always)]
    fn choose(condition: bool, a: Self, b: Self) -> Self {
        Self {
            value: choose(condition, a.value, b.value),
            gradient: array!(k < N => choose(condition, a.gradient[k], b.gradient[k])),
            lower: choose(condition, a.lower, b.lower),
            upper: choose(condition, a.upper, b.upper),
        }
    }

    /// `1 / self`; without bounds where the cell may hold a zero.
    #[inline(always)]
    fn reciprocal(self) -> Self {
        let nearest = (f64::abs(self.value) - self.deviation()) * (1.0 - 8.0 * UNIT);
        let bounded = nearest > 0.0;
        let value = 1.0 / choose(self.value == 0.0, 1.0, self.value);
        let deviation = self.deviation();
        // |1/x − tangent| = (x − v)² / |x| v² ≤ deviation² / nearest v².
        let room = choose(bounded, nearest, 1.0);
        let curved = deviation * deviation * value * value / room * INFLATE;
        let positive = self.value > 0.0;
        let exact = self.chain(
            value,
            -(value * value),
            choose(positive, 0.0, curved),
            choose(positive, curved, 0.0),
        );
        let unbounded = Self { value, gradient: [0.0; N], lower: UNBOUNDED, upper: UNBOUNDED };
        Self::choose(bounded, exact, unbounded)
    }
}

#[inline(always)]
fn choose(condition: bool, a: f64, b: f64) -> f64 {
    if condition { a } else { b }
}

/// One-instruction maximum, without the treatment of NaN.
trait MaxOf {
    fn max_of(self, other: Self) -> Self;
}

impl MaxOf for f64 {
    #[inline(always)]
    fn max_of(self, other: Self) -> Self {
        Scalar::max(self, other)
    }
}

impl<const N: usize> Add for AffineModel<N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let sum = Self {
            value: self.value + other.value,
            gradient: array!(k < N => self.gradient[k] + other.gradient[k]),
            lower: self.lower + other.lower,
            upper: self.upper + other.upper,
        };
        // What is added to nothing is not rounded: so little is left of adding a constant.
        let rounded = |k: usize| {
            let is_sum = self.gradient[k] != 0.0 && other.gradient[k] != 0.0;
            choose(is_sum, f64::abs(sum.gradient[k]), 0.0)
        };
        let mut slopes = NONE;
        unrolled!(k < N => slopes += rounded(k));
        let size = f64::abs(sum.value) + slopes;
        sum.widened(2.0 * UNIT * (size + (sum.lower + sum.upper)))
    }
}

impl<const N: usize> Neg for AffineModel<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            gradient: array!(k < N => -self.gradient[k]),
            lower: self.upper,
            upper: self.lower,
        }
    }
}

impl<const N: usize> Sub for AffineModel<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + (-other)
    }
}

impl<const N: usize> Mul for AffineModel<N> {
    type Output = Self;

    /// `ab = vₐv_b + vₐB + v_bA + AB`, where `A` and `B` are the deviations.
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self, other);
        let mixed = a.deviation() * b.deviation();
        let (size_a, size_b) = (f64::abs(a.value), f64::abs(b.value));
        let (up_a, up_b) = (a.value > 0.0, b.value > 0.0);
        Self {
            value: a.value * b.value,
            gradient: array!(k < N => {
                a.value * b.gradient[k] + b.value * a.gradient[k]
            }),
            lower: size_a * choose(up_a, b.lower, b.upper)
                + size_b * choose(up_b, a.lower, a.upper)
                + mixed,
            upper: size_a * choose(up_a, b.upper, b.lower)
                + size_b * choose(up_b, a.upper, a.lower)
                + mixed,
        }
        .rounded_with(8.0, size_a * b.slope() + size_b * a.slope())
    }
}

impl<const N: usize> Div for AffineModel<N> {
    type Output = Self;

    #[inline(always)]
    #[expect(clippy::suspicious_arithmetic_impl, reason = "one bound for both operations")]
    fn div(self, other: Self) -> Self {
        self * other.reciprocal()
    }
}

impl<const N: usize> Scalar for AffineModel<N> {
    #[inline(always)]
    fn epsilon() -> f64 {
        f64::EPSILON
    }

    #[inline(always)]
    fn constant(value: f64) -> Self {
        const { assert!(N <= 4, "loops over parameters are unrolled up to four") };
        Self { value, gradient: [0.0; N], lower: 0.0, upper: 0.0 }
    }

    #[inline(always)]
    fn scale(self, factor: f64) -> Self {
        let size = f64::abs(factor);
        let up = factor > 0.0;
        Self {
            value: self.value * factor,
            gradient: array!(k < N => self.gradient[k] * factor),
            lower: size * choose(up, self.lower, self.upper),
            upper: size * choose(up, self.upper, self.lower),
        }
        .rounded(2.0)
    }

    /// Only the value is rounded.
    #[inline(always)]
    fn minus(self, constant: f64) -> Self {
        let value = self.value - constant;
        Self { value, ..self }.widened(2.0 * UNIT * f64::abs(value))
    }

    /// One remainder for the roundings of the whole sum: what is rounded is at most the
    /// sum of the absolute terms.
    #[inline(always)]
    fn weighted_sum<const M: usize>(x: [Self; M], weights: &[f64; M]) -> Self {
        let term = |i: usize| {
            let weight = f64::abs(weights[i]);
            let up = weights[i] > 0.0;
            let term = Self {
                value: weights[i] * x[i].value,
                gradient: array!(k < N => weights[i] * x[i].gradient[k]),
                lower: weight * choose(up, x[i].lower, x[i].upper),
                upper: weight * choose(up, x[i].upper, x[i].lower),
            };
            (term, weight * (f64::abs(x[i].value) + x[i].slope()))
        };
        let (mut sum, mut size) = term(0);
        unrolled!(i < M => if i > 0 {
            let (term, its_size) = term(i);
            sum.value += term.value;
            unrolled!(k < N => sum.gradient[k] += term.gradient[k]);
            sum.lower += term.lower;
            sum.upper += term.upper;
            size += its_size;
        });
        sum.widened((M as f64 + 2.0) * UNIT * (size + (sum.lower + sum.upper)))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let folded = Self::choose(self.value < 0.0, -self, self);
        let beyond = ((self.slope() + folded.lower) * INFLATE - folded.value).max_of(0.0);
        Self { upper: folded.upper + (beyond + beyond), ..folded }
    }

    #[inline(always)]
    fn squared(self) -> Self {
        let deviation = self.deviation();
        self.chain(self.value * self.value, 2.0 * self.value, 0.0, deviation * deviation)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let deviation = self.deviation();
        let root = self.value.max_of(0.0).sqrt();
        let far = self.value > 1.25 * deviation && root > 0.0;
        let safe = choose(far, root, 1.0);
        // √x lies below its tangent by (x − v)² / 2√v(√x + √v)².
        let below = 0.5 * deviation * deviation / (safe * safe * safe) * INFLATE;
        let tangent = self.chain(root, 0.5 / safe, below, 0.0);
        let top = (self.value.max_of(0.0) + deviation).sqrt() * INFLATE;
        let near = Self {
            value: root,
            gradient: [0.0; N],
            lower: root,
            upper: (top - root) * INFLATE + UNIT * top,
        };
        Self::choose(far, tangent, near)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let swap = other.value < self.value;
        let near = Self::choose(swap, other, self);
        let far = Self::choose(swap, self, other);
        let crossing =
            near.value - far.value + (near.slope_between(&far) + far.lower) * INFLATE;
        Self { lower: near.lower.max_of(crossing), ..near }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let swap = other.value > self.value;
        let near = Self::choose(swap, other, self);
        let far = Self::choose(swap, self, other);
        let crossing =
            far.value - near.value + (near.slope_between(&far) + far.upper) * INFLATE;
        Self { upper: near.upper.max_of(crossing), ..near }
    }

    #[inline(always)]
    fn select_less(a: Self, b: Self, if_less: Self, otherwise: Self) -> Self {
        let difference = a - b;
        let always = difference.maximum() < 0.0;
        let never = difference.minimum() >= 0.0;
        let less = a.value < b.value;
        let near = Self::choose(less, if_less, otherwise);
        let far = Self::choose(less, otherwise, if_less);
        let between = near.slope_between(&far);
        let apart = far.value - near.value;
        let either = Self {
            lower: near.lower.max_of((between + far.lower) * INFLATE - apart),
            upper: near.upper.max_of((between + far.upper) * INFLATE + apart),
            ..near
        }
        .rounded_with(2.0, f64::abs(far.value));
        Self::choose(always, if_less, Self::choose(never, otherwise, either))
    }

    #[inline(always)]
    fn sin(self) -> Self {
        let deviation = self.deviation();
        let curved = 0.5 * deviation * deviation;
        self.chain(self.value.sin(), Scalar::cos(self.value), curved, curved)
            .rounded_with(1.0, 8.0)
    }

    #[inline(always)]
    fn cos(self) -> Self {
        let deviation = self.deviation();
        let curved = 0.5 * deviation * deviation;
        self.chain(Scalar::cos(self.value), -Scalar::sin(self.value), curved, curved)
            .rounded_with(1.0, 8.0)
    }

    #[inline(always)]
    fn turn(x: Self, y: Self) -> Self {
        norms::turn(x, y)
    }

    #[inline(always)]
    fn norm<const M: usize>(x: [Self; M]) -> Self {
        norms::norm(x)
    }

    #[inline(always)]
    fn power_norm<const P: u32, const M: usize>(x: [Self; M]) -> Self {
        norms::power_norm::<P, M, N>(x)
    }

    #[inline(always)]
    fn orthant<const M: usize>(q: [Self; M]) -> Self {
        norms::orthant(q)
    }

    #[inline(always)]
    fn power_orthant<const P: u32, const M: usize>(q: [Self; M]) -> Self {
        norms::power_orthant::<P, M, N>(q)
    }

    /// That of the value, for the whole cell: who crosses a step says by how much that
    /// may be wrong, with [`give_or_take`](Scalar::give_or_take).
    #[inline(always)]
    fn nearest_multiple(self, spacing: f64, low: f64, high: f64) -> Self {
        Self::constant(Scalar::nearest_multiple(self.value, spacing, low, high))
    }

    #[inline(always)]
    fn give_or_take(self, by: Self) -> Self {
        let by = by.maximum().max_of(0.0) * INFLATE;
        Self { lower: self.lower + by, upper: self.upper + by, ..self }
    }

    #[inline(always)]
    fn smooth_min<B: Blend>(self, other: Self, unit: f64) -> Self {
        norms::minimum::<B, N>(self, other, unit)
    }
}
