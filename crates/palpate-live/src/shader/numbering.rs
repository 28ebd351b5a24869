// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Merges what is computed twice.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};
use std::mem::{Discriminant, discriminant};

use palpate::field::scalar::{Expression, Operation};

use super::{Slot, numbers};

/// A number in the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Number {
    /// The bits of a literal.
    Literal(u32),
    /// The place in the array of uniforms.
    Uniform(usize),
}

/// A value in the text.
#[derive(Clone, Debug)]
pub(super) struct Value {
    pub(super) operation: Operation,
    /// The numbers of the operation.
    pub(super) numbers: Vec<Number>,
    /// The values that are its arguments, all before this one.
    pub(super) arguments: Vec<usize>,
}

/// What makes two values the same.
type Key = (Discriminant<Operation>, usize, &'static str, Vec<Number>, Vec<usize>);

/// All values of some formulas, each once.
#[derive(Debug)]
pub(super) struct Numbering<'a> {
    moving: &'a BTreeSet<Slot>,
    next_slot: Slot,
    values: Vec<Value>,
    known: HashMap<Key, usize>,
}

impl<'a> Numbering<'a> {
    pub(super) fn new(moving: &'a BTreeSet<Slot>) -> Self {
        Self { moving, next_slot: 0, values: Vec::new(), known: HashMap::new() }
    }

    /// Adds a formula; gives the value of its result.
    pub(super) fn add(&mut self, formula: &Expression) -> usize {
        let mut places: Vec<usize> = Vec::with_capacity(formula.steps().len());
        for step in formula.steps() {
            let numbers = numbers(step.operation).map(|number| self.number(number)).collect();
            let arguments = step.arguments.iter().map(|step| places[*step]).collect();
            places.push(self.place(Value { operation: step.operation, numbers, arguments }));
        }
        places[formula.result()]
    }

    fn number(&mut self, number: f64) -> Number {
        let slot = self.next_slot;
        self.next_slot += 1;
        match self.moving.iter().position(|moving| *moving == slot) {
            Some(uniform) => Number::Uniform(uniform),
            None => Number::Literal((number as f32).to_bits()),
        }
    }

    fn place(&mut self, value: Value) -> usize {
        let (axis, profile) = match value.operation {
            Operation::Coordinate(axis) => (axis, ""),
            Operation::SmoothMin { profile, .. } => (0, profile),
            _ => (0, ""),
        };
        let kind = discriminant(&value.operation);
        let key = (kind, axis, profile, value.numbers.clone(), value.arguments.clone());
        match self.known.entry(key) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(place) => {
                self.values.push(value);
                *place.insert(self.values.len() - 1)
            }
        }
    }

    /// The values, each after its arguments.
    pub(super) fn values(&self) -> &[Value] {
        &self.values
    }

    /// The values that are neither coordinates nor numbers.
    pub(super) fn operations(&self) -> usize {
        self.values.iter().filter(|value| !value.is_short()).count()
    }

    /// The number of uniforms.
    pub(super) fn uniforms(&self) -> usize {
        self.moving.len()
    }
}

impl Value {
    /// Whether it is short enough to be written again wherever it is used.
    pub(super) fn is_short(&self) -> bool {
        matches!(self.operation, Operation::Coordinate(_) | Operation::Constant(_))
    }
}
