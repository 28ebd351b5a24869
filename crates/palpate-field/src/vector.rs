// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Vectors with one component per dimension.

use std::ops::{Add, AddAssign, Index, IndexMut, Mul, Neg, Sub, SubAssign};

use crate::scalar::{Float, Scalar};

/// A statement for each index below a length of at most four, one after the
/// other.
///
/// Written out and not left to the optimiser: a loop over lanes vectorises only
/// if every loop inside is unrolled, and LLVM gives up on large bodies.
macro_rules! unrolled {
    ($index:ident < $length:expr => $statement:expr) => {
        const { assert!($length <= 4, "longer than what is unrolled") };
        if 0 < $length {
            let $index = 0;
            $statement;
        }
        if 1 < $length {
            let $index = 1;
            $statement;
        }
        if 2 < $length {
            let $index = 2;
            $statement;
        }
        if 3 < $length {
            let $index = 3;
            $statement;
        }
    };
}

/// `[e₀, e₁, …]`, each given by an expression of its index.
///
/// `std::array::from_fn` and `map` go through functions that are not always
/// inlined, and what is not inlined is not compiled for the instruction set of
/// its caller (see `machine`): a loop over a block would call them per lane.
macro_rules! array {
    ($index:ident < $length:expr => $element:expr) => {{
        let mut elements = [$crate::scalar::Scalar::constant(0.0); $length];
        $crate::vector::unrolled!($index < $length => elements[$index] = $element);
        elements
    }};
}

pub(crate) use {array, unrolled};

/// A vector of `D` numbers; also a point, as the vector from the origin [m].
///
/// ```
/// use palpate_field::Vector;
///
/// let v = Vector([3.0, 4.0]);
/// assert_eq!(v.norm(), 5.0);
/// assert_eq!(v * 2.0 - Vector([6.0, 0.0]), Vector([0.0, 8.0]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<S, const D: usize>(pub [S; D]);

/// A point in space, in metres.
pub type Point<const D: usize> = Vector<f64, D>;

impl<S: Scalar, const D: usize> Vector<S, D> {
    /// The vector whose components are all `value`.
    #[inline(always)]
    pub fn constant(value: f64) -> Self {
        Self([S::constant(value); D])
    }

    /// The given numbers as constants of `S`.
    #[inline(always)]
    pub fn of(components: &[f64; D]) -> Self {
        Self(array!(i < D => S::constant(components[i])))
    }

    /// The absolute value of each component.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self(array!(i < D => self.0[i].abs()))
    }

    /// The sum of the products of the components.
    #[inline(always)]
    pub fn dot(self, other: Self) -> S {
        let mut sum = self.0[0] * other.0[0];
        unrolled!(i < D => if i > 0 {
            sum = sum + self.0[i] * other.0[i];
        });
        sum
    }

    /// As [`dot`](Self::dot), with a constant vector: [`Scalar::weighted_sum`].
    #[inline(always)]
    pub fn dot_constant(self, other: &[f64; D]) -> S {
        S::weighted_sum(self.0, other)
    }

    /// Each component times `factor`.
    #[inline(always)]
    pub fn scale(self, factor: f64) -> Self {
        Self(array!(i < D => self.0[i].scale(factor)))
    }

    /// The Euclidean length.
    #[inline(always)]
    pub fn norm(self) -> S {
        S::norm(self.0)
    }
}

impl<T: Float, const D: usize> Vector<T, D> {
    /// The first `D` of three coordinates.
    #[inline(always)]
    pub(crate) fn of_coordinates(x: T, y: T, z: T) -> Self {
        Self(array!(i < D => [x, y, z][i.min(2)]))
    }

    /// Three coordinates, those past `D` zero.
    #[inline(always)]
    pub(crate) fn coordinates(self) -> (T, T, T) {
        let at = |i: usize| if i < D { self.0[i] } else { T::constant(0.0) };
        (at(0), at(1), at(2))
    }
}

impl<const D: usize> Vector<f64, D> {
    /// The origin, or the vector of no length.
    pub const ZERO: Self = Self([0.0; D]);

    /// The unit vector along axis `axis`.
    #[must_use]
    pub fn unit(axis: usize) -> Self {
        Self(array!(i < D => if i == axis { 1.0 } else { 0.0 }))
    }

    /// `true` if no component is NaN or infinite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.0.iter().all(|x| x.is_finite())
    }

    /// The vector of length one along `self`; `None` if `self` is shorter than
    /// the smallest normal number, or not finite.
    #[must_use]
    pub fn normalized(self) -> Option<Self> {
        // Scaling first keeps the squares of tiny and huge vectors in range.
        let largest = self.0.iter().fold(0.0_f64, |m, x| f64::max(m, x.abs()));
        if !self.is_finite() || largest < f64::MIN_POSITIVE {
            return None;
        }
        let scaled = Self(self.0.map(|x| x / largest));
        let length = scaled.norm();
        Some(Self(scaled.0.map(|x| x / length)))
    }
}

impl<const D: usize> Vector<f64, D> {
    /// The same vector in space: a vector of the plane has no depth.
    #[must_use]
    #[inline]
    pub fn in_space(self) -> Vector<f64, 3> {
        Vector(std::array::from_fn(|k| self.0.get(k).copied().unwrap_or(0.0)))
    }

    /// The vector across a face, out of what it bounds: as long as the segment, which has the inside on its left, or
    /// twice as long as the triangle is large, which is counter-clockwise seen from outside.
    ///
    /// Times a corner of the face, and over `D!`, it is the volume of the simplex of the face and the origin.
    ///
    /// ```
    /// use palpate_field::Vector;
    ///
    /// let [right, up] = [[3.0, 0.0], [3.0, 2.0]].map(Vector);
    /// assert_eq!(Vector::across(&[right, up]), Vector([2.0, 0.0]));
    /// let corners = [[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [0.0, 2.0, 1.0]].map(Vector);
    /// assert_eq!(Vector::across(&corners), Vector([0.0, 0.0, 6.0]));
    /// ```
    #[must_use]
    #[inline]
    pub fn across(face: &[Self; D]) -> Self {
        let ab = face[1 % D] - face[0];
        if D == 2 {
            let mut out = Self::ZERO;
            (out[0], out[1]) = (ab[1], -ab[0]);
            return out;
        }
        ab.in_space().cross((face[D - 1] - face[0]).in_space()).truncated()
    }
}

impl Vector<f64, 3> {
    /// The first coordinates: the vector itself in space, its part in the plane z = 0 in the
    /// plane.
    #[must_use]
    #[inline]
    pub fn truncated<const D: usize>(self) -> Vector<f64, D> {
        Vector(std::array::from_fn(|k| self.0.get(k).copied().unwrap_or(0.0)))
    }

    /// The cross product `self × other`.
    ///
    /// ```
    /// use palpate_field::Vector;
    ///
    /// let [x, y, z] = [0, 1, 2].map(Vector::<f64, 3>::unit);
    /// assert_eq!((x.cross(y), z.cross(y)), (z, -x));
    /// assert_eq!(Vector([1.0, 2.0]).in_space().truncated(), Vector([1.0, 2.0]));
    /// ```
    #[must_use]
    #[inline]
    pub fn cross(self, other: Self) -> Self {
        let ([ax, ay, az], [bx, by, bz]) = (self.0, other.0);
        Vector([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
    }
}

impl<S, const D: usize> From<[S; D]> for Vector<S, D> {
    #[inline(always)]
    fn from(components: [S; D]) -> Self {
        Self(components)
    }
}

impl<S, const D: usize> Index<usize> for Vector<S, D> {
    type Output = S;

    #[inline(always)]
    fn index(&self, axis: usize) -> &S {
        &self.0[axis]
    }
}

impl<S, const D: usize> IndexMut<usize> for Vector<S, D> {
    #[inline(always)]
    fn index_mut(&mut self, axis: usize) -> &mut S {
        &mut self.0[axis]
    }
}

impl<S: Scalar, const D: usize> Add for Vector<S, D> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(array!(i < D => self.0[i] + other.0[i]))
    }
}

impl<S: Scalar, const D: usize> Sub for Vector<S, D> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(array!(i < D => self.0[i] - other.0[i]))
    }
}

impl<S: Scalar, const D: usize> Neg for Vector<S, D> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(array!(i < D => -self.0[i]))
    }
}

impl<T: Float, const D: usize> Mul<T> for Vector<T, D> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        Self(array!(i < D => self.0[i] * factor))
    }
}

impl<const D: usize> AddAssign for Vector<f64, D> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const D: usize> SubAssign for Vector<f64, D> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
