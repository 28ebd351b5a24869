// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A number that records its own formula.

use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

use super::expression::Operation;
use super::graph::{Graph, PowerForm, Purpose, Recipe};
use super::{Blend, Expression, Scalar, power};
use crate::field::Asked;
use crate::kernel::Evaluations;
use crate::vector::Vector;

thread_local! {
    /// What is being recorded: a [`Recorded`] must be `Copy`, so it cannot hold its graph.
    static GRAPH: RefCell<Graph> = RefCell::new(Graph::default());
}

/// The most numbers that one step of a tape makes a norm of.
const MOST_IN_A_STEP: usize = 3;

/// A number of which only its formula is known: operations on it are recorded.
///
/// It is valid only during the recording that made it.
#[derive(Clone, Copy, Debug)]
pub struct Recorded {
    step: usize,
}

impl Recorded {
    fn new<const N: usize>(operation: Operation, arguments: [Self; N]) -> Self {
        Self::place(operation, &arguments)
    }

    /// Not inlined, nor are the operations: each kernel has its own code that calls them.
    #[inline(never)]
    fn place(operation: Operation, arguments: &[Self]) -> Self {
        let arguments = arguments.iter().map(|x| x.step).collect();
        Self { step: GRAPH.with_borrow_mut(|graph| graph.place(operation, arguments)) }
    }

    #[inline(never)]
    fn add_recipe(recipe: Recipe, arguments: &[Self]) -> Self {
        let arguments = arguments.iter().map(|x| x.step).collect();
        Self { step: GRAPH.with_borrow_mut(|graph| graph.add(recipe, arguments)) }
    }

    /// What is being recorded.
    pub(crate) fn purpose() -> Purpose {
        GRAPH.with_borrow(|graph| graph.purpose)
    }

    /// The answer of a field whose operations are on no tape.
    pub(crate) fn asked<const D: usize>(field: Arc<dyn Asked>, p: Vector<Self, D>) -> Self {
        Self::add_recipe(Recipe::Ask(field), &p.0)
    }

    /// For a tape of models, records the choice between the formula and its bound by the steepness at `p`.
    pub(crate) fn or_by_steepness<const D: usize>(
        self,
        p: Vector<Self, D>,
        evaluations: Evaluations,
    ) -> Self {
        if Self::purpose() != Purpose::Models {
            return self;
        }
        let recipe = Recipe::OrBySteepness(evaluations);
        Self::add_recipe(recipe, &[&[self], p.0.as_slice()].concat())
    }

    /// The graph of a formula in `D` coordinates, and the number of the step that is the result.
    pub(crate) fn graph<const D: usize>(
        purpose: Purpose,
        formula: impl FnOnce(Vector<Self, D>) -> Option<Self>,
    ) -> Option<(Graph, usize)> {
        // A formula may record another: the graph around it waits.
        let around = GRAPH.replace(Graph::new(purpose));
        let coordinate = |axis| Self::new(Operation::Coordinate(axis), []);
        let result = formula(Vector(std::array::from_fn(coordinate)));
        let graph = GRAPH.replace(around);
        Some((graph, result?.step))
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
        Self::record_for(Purpose::Formula, formula)
    }

    /// As [`record`](Self::record), for some purpose.
    pub(crate) fn record_for<const D: usize>(
        purpose: Purpose,
        formula: impl FnOnce(Vector<Recorded, D>) -> Option<Recorded>,
    ) -> Option<Self> {
        let (graph, result) = Recorded::graph(purpose, formula)?;
        graph.finish(result)
    }
}

macro_rules! arithmetic {
    ($($operator:ident $method:ident),*) => {
        $(impl $operator for Recorded {
            type Output = Self;

            #[inline(never)]
            fn $method(self, other: Self) -> Self {
                Self::new(Operation::$operator, [self, other])
            }
        })*
    };
}

arithmetic!(Add add, Sub sub, Mul mul, Div div);

impl Neg for Recorded {
    type Output = Self;

    #[inline(never)]
    fn neg(self) -> Self {
        Self::new(Operation::Neg, [self])
    }
}

impl Scalar for Recorded {
    /// The epsilon of single precision for a shader, else that of double precision.
    #[inline(never)]
    fn epsilon() -> f64 {
        match Self::purpose() {
            Purpose::Shader => f64::from(f32::EPSILON),
            _ => f64::EPSILON,
        }
    }

    #[inline(never)]
    fn constant(value: f64) -> Self {
        Self::new(Operation::Constant(value), [])
    }

    #[inline(never)]
    fn scale(self, factor: f64) -> Self {
        self * Self::constant(factor)
    }

    #[inline(never)]
    fn abs(self) -> Self {
        Self::new(Operation::Abs, [self])
    }

    fn weighted_sum<const N: usize>(x: [Self; N], weights: &[f64; N]) -> Self {
        if Self::purpose().is_tape() && N <= 3 {
            let mut all = [0.0; 3];
            all[..N].copy_from_slice(weights);
            return Self::add_recipe(Recipe::WeightedSum(all), &x);
        }
        let terms = x.into_iter().zip(weights).map(|(x, weight)| x.scale(*weight));
        terms.reduce(Add::add).unwrap_or_else(|| Self::constant(0.0))
    }

    #[inline(never)]
    fn squared(self) -> Self {
        Self::new(Operation::Squared, [self])
    }

    #[inline(never)]
    fn sqrt(self) -> Self {
        Self::new(Operation::Sqrt, [self])
    }

    #[inline(never)]
    fn min(self, other: Self) -> Self {
        Self::new(Operation::Min, [self, other])
    }

    #[inline(never)]
    fn max(self, other: Self) -> Self {
        Self::new(Operation::Max, [self, other])
    }

    #[inline(never)]
    fn select_less(a: Self, b: Self, if_less: Self, otherwise: Self) -> Self {
        Self::new(Operation::SelectLess, [a, b, if_less, otherwise])
    }

    #[inline(never)]
    fn sin(self) -> Self {
        Self::new(Operation::Sin, [self])
    }

    #[inline(never)]
    fn cos(self) -> Self {
        Self::new(Operation::Cos, [self])
    }

    #[inline(never)]
    fn turn(x: Self, y: Self) -> Self {
        Self::new(Operation::Turn, [x, y])
    }

    fn norm<const N: usize>(x: [Self; N]) -> Self {
        if Self::purpose().is_tape() && N > MOST_IN_A_STEP {
            // As for a float, to the bit.
            let squares = x.map(Scalar::squared);
            let sum = squares.into_iter().reduce(|sum, square| sum + square);
            return sum.map_or(Self::constant(0.0), Scalar::sqrt);
        }
        Self::new(Operation::Norm, x)
    }

    fn power_norm<const P: u32, const N: usize>(x: [Self; N]) -> Self {
        if Self::purpose() == Purpose::Models && (2..=MOST_IN_A_STEP).contains(&N) {
            return Self::add_recipe(Recipe::Power(PowerForm::Norm, P), &x);
        }
        power::norm::<Self, P, N>(x)
    }

    fn orthant<const N: usize>(q: [Self; N]) -> Self {
        if Self::purpose().is_tape() && N > MOST_IN_A_STEP {
            // As for a float, to the bit.
            let zero = Self::constant(0.0);
            let largest = q.into_iter().reduce(Scalar::max).unwrap_or(zero);
            let outside = Self::norm(q.map(|component| component.max(zero)));
            return outside + largest.min(zero);
        }
        Self::new(Operation::Orthant, q)
    }

    fn power_orthant<const P: u32, const N: usize>(q: [Self; N]) -> Self {
        if Self::purpose() == Purpose::Models && (2..=MOST_IN_A_STEP).contains(&N) {
            return Self::add_recipe(Recipe::Power(PowerForm::Orthant, P), &q);
        }
        power::orthant::<Self, P, N>(q)
    }

    fn nearest_multiple(self, spacing: f64, low: f64, high: f64) -> Self {
        Self::new(Operation::NearestMultiple { spacing, low, high }, [self])
    }

    fn give_or_take(self, by: Self) -> Self {
        match Self::purpose() {
            Purpose::Models => Self::add_recipe(Recipe::GiveOrTake, &[self, by]),
            _ => self,
        }
    }

    fn smooth_min<B: Blend>(self, other: Self, unit: f64) -> Self {
        Self::new(Operation::SmoothMin { profile: B::NAME, unit }, [self, other])
    }
}
