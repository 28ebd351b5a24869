// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! From the steps of a formula to those of a tape: constants become parts of instructions, and numbers
//! share registers.

use std::sync::Arc;

use super::instruction::{Instruction, Power, Profile, Register, registers_of};
use super::{Step, Tape};
use crate::field::Asked;
use crate::scalar::{Operation, Recipe};

/// The steps of a tape, with numbers of steps in place of registers.
#[derive(Debug, Default)]
pub(super) struct Unassigned {
    steps: Vec<Instruction>,
    /// For each step of the formula, the step of the tape; for a constant, its value.
    known: Vec<Known>,
    dimension: usize,
    asked: Vec<Arc<dyn Asked>>,
}

/// What is known of a step of the formula.
#[derive(Clone, Copy, Debug)]
enum Known {
    Constant(f64),
    Step(Register),
}

impl Unassigned {
    fn push(&mut self, instruction: Instruction) -> Register {
        self.steps.push(instruction);
        (self.steps.len() - 1) as Register
    }

    /// The step of an argument. A constant becomes a step here.
    fn step(&mut self, argument: usize) -> Register {
        match self.known[argument] {
            Known::Constant(value) => self.push(Instruction::Constant(value)),
            Known::Step(step) => step,
        }
    }

    /// The steps of the first arguments.
    fn all<const N: usize>(&mut self, arguments: &[usize]) -> [Register; N] {
        std::array::from_fn(|i| self.step(arguments[i]))
    }

    fn constant(&self, argument: usize) -> Option<f64> {
        match self.known[argument] {
            Known::Constant(value) => Some(value),
            Known::Step(_) => None,
        }
    }

    /// Adds a step of the formula.
    pub(super) fn add(&mut self, recipe: Recipe, arguments: &[usize]) {
        let known = match recipe {
            Recipe::Operation(Operation::Constant(value)) => Known::Constant(value),
            recipe => {
                let instruction = self.instruction(recipe, arguments);
                Known::Step(self.push(instruction))
            }
        };
        self.known.push(known);
    }

    fn instruction(&mut self, recipe: Recipe, arguments: &[usize]) -> Instruction {
        let count = arguments.len();
        match recipe {
            Recipe::Operation(operation) => self.operation(operation, arguments),
            Recipe::WeightedSum([a, b, c]) => match count {
                1 => Instruction::WeightedSum1(self.all(arguments), [a]),
                2 => Instruction::WeightedSum2(self.all(arguments), [a, b]),
                _ => Instruction::WeightedSum3(self.all(arguments), [a, b, c]),
            },
            Recipe::Power(form, power) => match count {
                2 => Instruction::PlanarPower(self.all(arguments), form, Power::of(power)),
                _ => Instruction::SpatialPower(self.all(arguments), form, Power::of(power)),
            },
            Recipe::GiveOrTake => Instruction::GiveOrTake(self.all(arguments)),
            Recipe::OrBySteepness(evaluations) => match count {
                3 => Instruction::PlanarOrBySteepness(self.all(arguments), evaluations),
                _ => Instruction::SpatialOrBySteepness(self.all(arguments), evaluations),
            },
            Recipe::Ask(field) => {
                self.asked.push(field);
                let number = self.asked.len() - 1;
                match count {
                    2 => Instruction::AskPlanar(self.all(arguments), number),
                    _ => Instruction::AskSpatial(self.all(arguments), number),
                }
            }
        }
    }

    fn operation(&mut self, operation: Operation, arguments: &[usize]) -> Instruction {
        let constant = |i: usize| self.constant(arguments[i]);
        match operation {
            Operation::Coordinate(axis) => {
                self.dimension = self.dimension.max(axis + 1);
                Instruction::Coordinate(axis)
            }
            Operation::Constant(value) => Instruction::Constant(value),
            // `x + c` is `x − (−c)`, to the bit.
            Operation::Add => match (constant(0), constant(1)) {
                (_, Some(c)) => Instruction::Minus(self.all(arguments), -c),
                (Some(c), _) => Instruction::Minus(self.all(&arguments[1..]), -c),
                _ => Instruction::Add(self.all(arguments)),
            },
            Operation::Sub => match constant(1) {
                Some(c) => Instruction::Minus(self.all(arguments), c),
                None => Instruction::Sub(self.all(arguments)),
            },
            Operation::Mul => match (constant(0), constant(1)) {
                (_, Some(c)) => Instruction::Scale(self.all(arguments), c),
                (Some(c), _) => Instruction::Scale(self.all(&arguments[1..]), c),
                _ => Instruction::Mul(self.all(arguments)),
            },
            Operation::Div => Instruction::Div(self.all(arguments)),
            Operation::Neg => Instruction::Neg(self.all(arguments)),
            Operation::Abs => Instruction::Abs(self.all(arguments)),
            Operation::Squared => Instruction::Squared(self.all(arguments)),
            Operation::Sqrt => Instruction::Sqrt(self.all(arguments)),
            Operation::Min => match (constant(0), constant(1)) {
                (_, Some(c)) => Instruction::MinConstant(self.all(arguments), c),
                (Some(c), _) => Instruction::ConstantMin(self.all(&arguments[1..]), c),
                _ => Instruction::Min(self.all(arguments)),
            },
            Operation::Max => match (constant(0), constant(1)) {
                (_, Some(c)) => Instruction::MaxConstant(self.all(arguments), c),
                (Some(c), _) => Instruction::ConstantMax(self.all(&arguments[1..]), c),
                _ => Instruction::Max(self.all(arguments)),
            },
            Operation::SelectLess => Instruction::SelectLess(self.all(arguments)),
            Operation::Sin => Instruction::Sin(self.all(arguments)),
            Operation::Cos => Instruction::Cos(self.all(arguments)),
            Operation::Turn => Instruction::Turn(self.all(arguments)),
            Operation::Norm => match arguments.len() {
                1 => Instruction::Norm1(self.all(arguments)),
                2 => Instruction::Norm2(self.all(arguments)),
                3 => Instruction::Norm3(self.all(arguments)),
                count => unreachable!("the norm of {count} numbers is several steps"),
            },
            Operation::Orthant => match arguments.len() {
                1 => Instruction::Orthant1(self.all(arguments)),
                2 => Instruction::Orthant2(self.all(arguments)),
                3 => Instruction::Orthant3(self.all(arguments)),
                count => unreachable!("an orthant of {count} numbers is several steps"),
            },
            Operation::SmoothMin { profile, unit } => {
                Instruction::SmoothMin(self.all(arguments), Profile::of_name(profile), unit)
            }
            Operation::NearestMultiple { spacing, low, high } => {
                Instruction::NearestMultiple(self.all(arguments), [spacing, low, high])
            }
        }
    }

    /// Assigns a register to each step that is needed. The register is free again after the step's
    /// last use.
    pub(super) fn assign(mut self, result: usize) -> Tape {
        let result = self.step(result);
        // For each step, the last step that uses it; zero if none does.
        let mut last_use = vec![0; self.steps.len()];
        last_use[result as usize] = usize::MAX;
        for (i, step) in self.steps.iter().enumerate().rev() {
            if last_use[i] > 0 {
                registers_of!(step, arguments => for argument in arguments {
                    let last = &mut last_use[*argument as usize];
                    *last = (*last).max(i);
                });
            }
        }
        let mut register_of = vec![0; self.steps.len()];
        let (mut free, mut registers) = (Vec::new(), 0);
        let mut steps = Vec::new();
        for (i, mut instruction) in self.steps.into_iter().enumerate() {
            if last_use[i] == 0 {
                continue;
            }
            // The result's register is taken before the arguments' registers are freed, so that
            // they differ: a select that writes where it reads becomes a masked store, which is
            // microcoded on some machines.
            let out = free.pop().unwrap_or_else(|| {
                registers += 1;
                registers - 1
            });
            register_of[i] = out;
            registers_of!(&mut instruction, arguments => for argument in arguments {
                let step = *argument as usize;
                *argument = register_of[step];
                if last_use[step] == i {
                    free.push(register_of[step]);
                    // A register that is an argument twice is freed once.
                    last_use[step] = usize::MAX;
                }
            });
            steps.push(Step { out, instruction });
        }
        Tape {
            steps,
            registers: registers as usize,
            result: register_of[result as usize],
            dimension: self.dimension,
            asked: self.asked,
        }
    }
}
