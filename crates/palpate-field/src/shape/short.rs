// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Short ways to shapes: other names of primitives, and operators of Rust.

use std::ops::{BitAnd, BitOr, BitXor, Sub};

use super::Shape;
use crate::error::ShapeError;
use crate::vector::Vector;

impl Shape<3> {
    /// All points within `radius` of the origin [m]: another name of [`ball`](Self::ball).
    ///
    /// # Errors
    ///
    /// If the radius is not positive.
    pub fn sphere(radius: f64) -> Result<Self, ShapeError> {
        Self::ball(radius)
    }

    /// A cube along the axes with edges of length `size` [m]: a [`cuboid`](Self::cuboid).
    ///
    /// # Errors
    ///
    /// If the size is not positive.
    ///
    /// ```
    /// use palpate_field::Shape;
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// assert_eq!(Shape::cube(0.5)?, Shape::cuboid([0.5, 0.5, 0.5])?);
    /// # Ok(())
    /// # }
    /// ```
    pub fn cube(size: f64) -> Result<Self, ShapeError> {
        Self::cuboid([size; 3])
    }
}

impl Shape<2> {
    /// All points within `radius` of the origin [m]: another name of [`ball`](Self::ball).
    ///
    /// # Errors
    ///
    /// If the radius is not positive.
    pub fn circle(radius: f64) -> Result<Self, ShapeError> {
        Self::ball(radius)
    }

    /// A rectangle along the axes with the given edge lengths [m]: another name of
    /// [`cuboid`](Self::cuboid).
    ///
    /// # Errors
    ///
    /// If a length is not positive.
    pub fn rectangle(size: impl Into<Vector<f64, 2>>) -> Result<Self, ShapeError> {
        Self::cuboid(size)
    }

    /// A square along the axes with edges of length `size` [m]: a [`cuboid`](Self::cuboid).
    ///
    /// # Errors
    ///
    /// If the size is not positive.
    pub fn square(size: f64) -> Result<Self, ShapeError> {
        Self::cuboid([size; 2])
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $result:literal, $of:literal, |$a:ident, $b:ident| $do:expr) => {
        impl<const D: usize> $trait for Shape<D> {
            type Output = Shape<D>;

            #[doc = concat!($result, ", as [`", $of, "`](Shape::", $of, ").")]
            ///
            /// # Panics
            ///
            /// If shapes are nested more than [`MAX_DEPTH`](crate::MAX_DEPTH) deep. Chains
            /// of one operator are flattened and nest no deeper; where data decide how
            /// operators alternate, call the method, which returns the error.
            fn $method(self, other: Self) -> Shape<D> {
                let ($a, $b) = (self, other);
                $do.unwrap_or_else(|error| panic!("{error}"))
            }
        }

        impl<const D: usize> $trait<&Self> for Shape<D> {
            type Output = Shape<D>;

            fn $method(self, other: &Self) -> Shape<D> {
                $trait::$method(self, other.clone())
            }
        }

        impl<const D: usize> $trait<Shape<D>> for &Shape<D> {
            type Output = Shape<D>;

            fn $method(self, other: Shape<D>) -> Shape<D> {
                $trait::$method(self.clone(), other)
            }
        }

        impl<const D: usize> $trait for &Shape<D> {
            type Output = Shape<D>;

            fn $method(self, other: Self) -> Shape<D> {
                $trait::$method(self.clone(), other.clone())
            }
        }
    };
}

operator!(BitOr, bitor, "The union of both", "union", |a, b| Self::union([a, b]));
operator!(BitAnd, bitand, "What is in both", "intersection", |a, b| {
    Self::intersection([a, b])
});
operator!(BitXor, bitxor, "What is in one alone", "symmetric_difference", |a, b| {
    Self::symmetric_difference([a, b])
});
operator!(Sub, sub, "The first without the other", "difference", |a, b| a.difference([b]));
