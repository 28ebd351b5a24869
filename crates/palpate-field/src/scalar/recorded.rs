// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A number that records its own formula.

use std::cell::RefCell;
use std::marker::PhantomData;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::expression::{Graph, Operation};
use super::{Blend, Expression, Float, Scalar};
use crate::vector::Vector;

thread_local! {
    /// What is being recorded: a [`Recorded`] must be `Copy`, so it cannot hold its graph.
    static GRAPH: RefCell<Graph> = RefCell::new(Graph::default());
}

/// A number of which only its formula is known: operations on it are recorded.
///
/// It has a meaning within the call of [`Expression::record`] that made it alone. Thresholds
/// of rounding in the formula are those of `T`, in which it will be evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Recorded<T = f64> {
    step: usize,
    precision: PhantomData<T>,
}

impl<T> Recorded<T> {
    fn new<const N: usize>(operation: Operation, arguments: [Self; N]) -> Self {
        let arguments = arguments.iter().map(|x| x.step).collect();
        let step = GRAPH.with_borrow_mut(|graph| graph.place(operation, arguments));
        Self { step, precision: PhantomData }
    }
}

impl Expression {
    /// The expression of `formula` in the `D` coordinates of a point, if it gives one.
    ///
    /// ```
    /// use palpate_field::scalar::{Expression, Scalar};
    ///
    /// let line = Expression::record::<2>(|p| Some(p[0].scale(2.0) - p[1])).unwrap();
    /// assert_eq!(line.to_string(), "(x * 2.0) - y");
    /// assert_eq!(line.evaluate(&[3.0, 1.0]), 5.0);
    /// ```
    pub fn record<const D: usize>(
        formula: impl FnOnce(Vector<Recorded, D>) -> Option<Recorded>,
    ) -> Option<Self> {
        Self::record_with(Graph::default(), formula)
    }

    /// As [`record`](Self::record), for single precision, and with each constant as a step of its
    /// own.
    pub(crate) fn record_with_slots<const D: usize>(
        formula: impl FnOnce(Vector<Recorded<f32>, D>) -> Option<Recorded<f32>>,
    ) -> Option<Self> {
        Self::record_with(Graph::with_slots(), formula)
    }

    fn record_with<T: Float, const D: usize>(
        graph: Graph,
        formula: impl FnOnce(Vector<Recorded<T>, D>) -> Option<Recorded<T>>,
    ) -> Option<Self> {
        // A formula may record another: the graph around it waits.
        let around = GRAPH.replace(graph);
        let coordinate = |axis| Recorded::new(Operation::Coordinate(axis), []);
        let result = formula(Vector(std::array::from_fn(coordinate)));
        let graph = GRAPH.replace(around);
        Some(graph.finish(result?.step))
    }
}

macro_rules! arithmetic {
    ($($operator:ident $method:ident),*) => {
        $(impl<T> $operator for Recorded<T> {
            type Output = Self;

            fn $method(self, other: Self) -> Self {
                Self::new(Operation::$operator, [self, other])
            }
        })*
    };
}

arithmetic!(Add add, Sub sub, Mul mul, Div div);

impl<T> Neg for Recorded<T> {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(Operation::Neg, [self])
    }
}

impl<T: Float> Scalar for Recorded<T> {
    const EPSILON: f64 = T::EPSILON;

    fn constant(value: f64) -> Self {
        Self::new(Operation::Constant(value), [])
    }

    fn scale(self, factor: f64) -> Self {
        self * Self::constant(factor)
    }

    fn abs(self) -> Self {
        Self::new(Operation::Abs, [self])
    }

    fn squared(self) -> Self {
        Self::new(Operation::Squared, [self])
    }

    fn sqrt(self) -> Self {
        Self::new(Operation::Sqrt, [self])
    }

    fn min(self, other: Self) -> Self {
        Self::new(Operation::Min, [self, other])
    }

    fn max(self, other: Self) -> Self {
        Self::new(Operation::Max, [self, other])
    }

    fn select_less(a: Self, b: Self, if_less: Self, otherwise: Self) -> Self {
        Self::new(Operation::SelectLess, [a, b, if_less, otherwise])
    }

    fn sin(self) -> Self {
        Self::new(Operation::Sin, [self])
    }

    fn cos(self) -> Self {
        Self::new(Operation::Cos, [self])
    }

    fn turn(x: Self, y: Self) -> Self {
        Self::new(Operation::Turn, [x, y])
    }

    fn norm<const N: usize>(x: [Self; N]) -> Self {
        Self::new(Operation::Norm, x)
    }

    fn orthant<const N: usize>(q: [Self; N]) -> Self {
        Self::new(Operation::Orthant, q)
    }

    fn nearest_multiple(self, spacing: f64, low: f64, high: f64) -> Self {
        Self::new(Operation::NearestMultiple { spacing, low, high }, [self])
    }

    fn smooth_min<B: Blend>(self, other: Self, unit: f64) -> Self {
        Self::new(Operation::SmoothMin { profile: B::NAME, unit }, [self, other])
    }
}
