// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The steps of a formula while it is recorded.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::mem::{Discriminant, discriminant};
use std::sync::Arc;

use super::expression::{Expression, Operation, Step};
use crate::field::Asked;
use crate::kernel::Evaluations;

/// What a formula is recorded for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// For reading: only operations of [`Operation`].
    #[default]
    Formula,
    /// For a shader in single precision: each constant is a step of its own.
    Shader,
    /// For a tape of distances.
    Values,
    /// For a tape of models: with the operations that only bounds need.
    Models,
}

impl Purpose {
    pub(crate) fn is_tape(self) -> bool {
        matches!(self, Self::Values | Self::Models)
    }
}

/// What a step does: an operation, or one that only tapes have.
#[derive(Clone, Debug)]
pub(crate) enum Recipe {
    Operation(Operation),
    /// [`Scalar::weighted_sum`](super::Scalar::weighted_sum) of up to three numbers.
    WeightedSum([f64; 3]),
    /// A norm of this power, of two or three numbers.
    Power(PowerForm, u32),
    /// [`Scalar::give_or_take`](super::Scalar::give_or_take).
    GiveOrTake,
    /// The first argument, or its bound by the steepness at the point that the other arguments
    /// give, whichever says more.
    OrBySteepness(Evaluations),
    /// The answer of a field at the point.
    Ask(Arc<dyn Asked>),
}

/// What is made of a norm of powers.
#[derive(Clone, Copy, Debug)]
pub(crate) enum PowerForm {
    /// [`Scalar::power_norm`](super::Scalar::power_norm).
    Norm,
    /// [`Scalar::power_orthant`](super::Scalar::power_orthant).
    Orthant,
}

/// A step of a tape that is being recorded.
#[derive(Clone, Debug)]
pub(crate) struct Recorded {
    pub(crate) recipe: Recipe,
    pub(crate) arguments: Vec<usize>,
}

/// What makes two steps the same.
type Key = (Discriminant<Operation>, (&'static str, [u64; 3]), Vec<usize>);

/// The steps recorded so far.
#[derive(Debug, Default)]
pub(crate) struct Graph {
    pub(crate) steps: Vec<Recorded>,
    known: HashMap<Key, usize>,
    pub(crate) purpose: Purpose,
}

impl Graph {
    pub(crate) fn new(purpose: Purpose) -> Self {
        Self { purpose, ..Self::default() }
    }

    /// The number of the step that does this operation, a new one if there is none.
    pub(crate) fn place(&mut self, operation: Operation, arguments: Vec<usize>) -> usize {
        if self.purpose == Purpose::Shader && operation.has_numbers() {
            return self.add(Recipe::Operation(operation), arguments);
        }
        let key = (discriminant(&operation), operation.parameters(), arguments.clone());
        match self.known.entry(key) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(place) => {
                self.steps.push(Recorded { recipe: Recipe::Operation(operation), arguments });
                *place.insert(self.steps.len() - 1)
            }
        }
    }

    /// The number of a new step.
    pub(crate) fn add(&mut self, recipe: Recipe, arguments: Vec<usize>) -> usize {
        self.steps.push(Recorded { recipe, arguments });
        self.steps.len() - 1
    }

    /// The expression whose value is that of step `result`; `None` if a step exists only on tapes.
    pub(super) fn finish(self, result: usize) -> Option<Expression> {
        let step = |Recorded { recipe, arguments }| match recipe {
            Recipe::Operation(operation) => Some(Step { operation, arguments }),
            _ => None,
        };
        let steps = self.steps.into_iter().map(step).collect::<Option<Vec<Step>>>()?;
        Some(Expression { steps, result })
    }
}
