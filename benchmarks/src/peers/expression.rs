// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A scalar that records fidget's expression trees.
//!
//! Evaluating a kernel with it hands fidget the very formula that ours
//! evaluates.

use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use fidget::context::Tree;
use palpate::field::scalar::{Blend, Scalar};

thread_local! {
    /// All trees recorded so far; a scalar must be `Copy`, so it is an index.
    static TREES: RefCell<Vec<Tree>> = const { RefCell::new(Vec::new()) };
}

/// An expression of x, y and z.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Expression(usize);

impl Expression {
    /// The coordinates themselves.
    pub(crate) fn axes() -> [Self; 3] {
        let (x, y, z) = Tree::axes();
        [x, y, z].map(Self::of)
    }

    /// The recorded tree.
    pub(crate) fn tree(self) -> Tree {
        TREES.with_borrow(|trees| trees[self.0].clone())
    }

    fn of(tree: Tree) -> Self {
        TREES.with_borrow_mut(|trees| {
            trees.push(tree);
            Self(trees.len() - 1)
        })
    }

    fn map(self, f: impl FnOnce(Tree) -> Tree) -> Self {
        Self::of(f(self.tree()))
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl $trait for Expression {
            type Output = Self;

            fn $method(self, other: Self) -> Self {
                Self::of(self.tree().$method(other.tree()))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for Expression {
    type Output = Self;

    fn neg(self) -> Self {
        self.map(|tree| tree.neg())
    }
}

impl Scalar for Expression {
    fn epsilon() -> f64 {
        f64::from(f32::EPSILON)
    }

    fn constant(value: f64) -> Self {
        Self::of(Tree::constant(value as f32))
    }

    fn scale(self, factor: f64) -> Self {
        self * Self::constant(factor)
    }

    fn abs(self) -> Self {
        self.map(|tree| tree.abs())
    }

    fn squared(self) -> Self {
        self.map(|tree| tree.square())
    }

    fn sqrt(self) -> Self {
        self.map(|tree| tree.sqrt())
    }

    fn min(self, other: Self) -> Self {
        self.map(|tree| tree.min(other.tree()))
    }

    fn max(self, other: Self) -> Self {
        self.map(|tree| tree.max(other.tree()))
    }

    /// `compare` is −1, 0 or 1; `and` passes its second argument where the first
    /// is not zero.
    fn select_less(a: Self, b: Self, if_less: Self, otherwise: Self) -> Self {
        let less = a.tree().compare(b.tree()).min(0.0);
        let not_less = less.not();
        Self::of(less.and(if_less.tree()) + not_less.and(otherwise.tree()))
    }

    fn sin(self) -> Self {
        self.map(|tree| tree.sin())
    }

    fn cos(self) -> Self {
        self.map(|tree| tree.cos())
    }

    fn turn(x: Self, y: Self) -> Self {
        Self::of(y.tree().atan2(x.tree())).scale(1.0 / std::f64::consts::TAU)
    }

    fn norm<const N: usize>(x: [Self; N]) -> Self {
        let squares = x.map(Scalar::squared);
        squares[1..].iter().fold(squares[0], |sum, square| sum + *square).sqrt()
    }

    fn orthant<const N: usize>(q: [Self; N]) -> Self {
        let zero = Self::constant(0.0);
        let largest = q[1..].iter().fold(q[0], |largest, q| largest.max(*q));
        Self::norm(q.map(|q| q.max(zero))) + largest.min(zero)
    }

    fn nearest_multiple(self, spacing: f64, low: f64, high: f64) -> Self {
        let count = self.scale(1.0 / spacing).clamp(low, high);
        count.map(|tree| tree.round()).scale(spacing)
    }

    /// The fill in fidget's operations: both profiles are powers of `x`.
    fn smooth_min<B: Blend>(self, other: Self, unit: f64) -> Self {
        let zero = Self::constant(0.0);
        let x = (Self::constant(1.0) - (self - other).abs().scale(1.0 / unit)).max(zero);
        let square = x.squared();
        let fill = if B::NAME == "cubic" { square * x } else { square };
        self.min(other) - fill.scale(B::fill(0.0_f64) * unit)
    }
}
