// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Formulas as tapes: lists of instructions over registers, each of which works through many lanes.
//!
//! A compiled loop costs each kernel its own machine code. All tapes run in one interpreter. A tape
//! is slower than a compiled loop, and is used where no loop is compiled. Its instructions are the
//! operations of [`Scalar`], so distances have the bits of the compiled loops.

mod assembly;
mod instruction;
mod interpreter;

use std::sync::Arc;

use super::block::{Column, Rows, RowsMut, filled};
#[cfg(target_arch = "x86_64")]
use super::instruction_set::InstructionSet;
use super::lanes::{Lane, LaneArray};
use crate::field::Asked;
use crate::kernel::Evaluations;
use crate::scalar::{Expression, Graph, Model, Recipe, SpaceTimeModel};
use crate::vector::Vector;
use assembly::Unassigned;
use instruction::{Instruction, Register};
use interpreter::everywhere;
#[cfg(target_arch = "x86_64")]
use interpreter::{with_avx2, with_avx512};

/// An instruction and the register of its result, which differs from its argument registers.
#[derive(Clone, Copy, Debug)]
struct Step {
    out: Register,
    instruction: Instruction,
}

/// A formula that is ready to run.
///
/// Every argument register was written by an earlier step: `Unassigned::assign` sees to that, and
/// nothing else makes tapes.
#[derive(Debug)]
pub struct Tape {
    steps: Vec<Step>,
    registers: usize,
    result: Register,
    /// How many coordinates the points must have at least.
    dimension: usize,
    asked: Vec<Arc<dyn Asked>>,
}

impl Tape {
    /// The tape of a recorded formula.
    pub(crate) fn new(graph: Graph, result: usize) -> Self {
        let mut steps = Unassigned::default();
        for step in graph.steps {
            steps.add(step.recipe, &step.arguments);
        }
        steps.assign(result)
    }

    /// The tape of an expression.
    pub(crate) fn of_expression(expression: &Expression) -> Self {
        let mut steps = Unassigned::default();
        for step in expression.steps() {
            steps.add(Recipe::Operation(step.operation), &step.arguments);
        }
        steps.assign(expression.result())
    }

    /// The value at one point.
    ///
    /// # Panics
    ///
    /// If the point has fewer coordinates than the formula uses.
    pub(crate) fn at(&self, point: &[f64]) -> f64 {
        let coordinates: Vec<Column<f64>> = point.iter().map(|x| Column::all(1, *x)).collect();
        let mut out = Column::scratch();
        self.run(&coordinates.iter().collect::<Vec<_>>(), 1, &mut out);
        out.get(0)
    }

    /// Prepares the fields that it asks.
    pub(crate) fn prepare(&self) {
        self.asked.iter().for_each(|field| field.prepare_it());
    }

    /// `true` if the registers for numbers `S` fit on the stack.
    pub(crate) fn is_short<S: OnTape>(&self) -> bool {
        self.registers <= S::TAPE_REGISTERS
    }

    /// The values at the first `count` points; those of `out` past them are unspecified.
    ///
    /// Allocates if the tape is not [`is_short`](Self::is_short).
    ///
    /// # Panics
    ///
    /// If the points have fewer coordinates than the formula uses, or are not written.
    pub(crate) fn run<S: OnTape>(
        &self,
        coordinates: &[&Column<S>],
        count: usize,
        out: &mut Column<S>,
    ) {
        let lanes = filled::<Column<S>>(count);
        let dimension = coordinates.len();
        assert!(self.dimension <= dimension, "{} coordinates of {dimension}", self.dimension);
        for column in coordinates {
            assert!(lanes <= column.written(), "{lanes} lanes are not written");
        }
        S::run_tape(self, coordinates, lanes, out);
        // SAFETY: the last step of the tape wrote them.
        unsafe { out.set_written(lanes) };
    }

    /// Runs the tape, `W` lanes at a time, with memory for `R` registers or more.
    #[inline(always)]
    pub(crate) fn run_in<S: OnTape, const W: usize, const R: usize>(
        &self,
        coordinates: &[&Column<S>],
        lanes: usize,
        out: &mut Column<S>,
    ) {
        let mut registers = [S::Lanes::<W>::unwritten(); R];
        if self.registers <= R {
            self.choose(coordinates, lanes, &mut registers, out);
        } else {
            let mut more = vec![S::Lanes::<W>::unwritten(); self.registers];
            self.choose(coordinates, lanes, &mut more, out);
        }
    }

    /// Runs the tape with the instruction set in use, if the type `S` gains from it.
    #[inline(always)]
    fn choose<S: OnTape, const W: usize>(
        &self,
        coordinates: &[&Column<S>],
        lanes: usize,
        registers: &mut [S::Lanes<W>],
        out: &mut Column<S>,
    ) {
        #[cfg(target_arch = "x86_64")]
        if const { S::HAS_WIDE_TAPE } {
            let set = InstructionSet::in_use();
            if set == InstructionSet::Avx512 {
                // SAFETY: in_use() returns only sets for which is_available() found
                // every feature that the function is compiled with.
                return unsafe { with_avx512(self, coordinates, lanes, registers, out) };
            }
            if set == InstructionSet::Avx2 {
                // SAFETY: as above.
                return unsafe { with_avx2(self, coordinates, lanes, registers, out) };
            }
        }
        everywhere(self, coordinates, lanes, registers, out);
    }
}

/// A number that tapes work with.
pub trait OnTape: Lane {
    /// Whether tapes are compiled for each instruction set.
    const HAS_WIDE_TAPE: bool;

    /// How many registers fit on the stack.
    const TAPE_REGISTERS: usize;

    /// Runs a tape over the first `lanes` points.
    fn run_tape(
        tape: &Tape,
        coordinates: &[&Column<Self>],
        lanes: usize,
        out: &mut Column<Self>,
    );

    /// Asks a field of a tape.
    fn ask(
        field: &dyn Asked,
        count: usize,
        coordinate: &dyn Fn(usize, usize) -> Self,
        out: &mut Column<Self>,
    );

    /// The number, or the bound by the steepness at `p`, whichever says more.
    #[inline(always)]
    fn or_by_steepness<const D: usize>(self, _p: [Self; D], _: Evaluations) -> Self {
        self
    }
}

macro_rules! on_tape {
    ($number:ty, $lanes:literal lanes, $registers:literal registers, $is_wide:literal, $ask:ident $(, $or:ident)?) => {
        impl OnTape for $number {
            const HAS_WIDE_TAPE: bool = $is_wide;
            const TAPE_REGISTERS: usize = $registers;

            fn run_tape(
                tape: &Tape,
                coordinates: &[&Column<Self>],
                lanes: usize,
                out: &mut Column<Self>,
            ) {
                tape.run_in::<Self, $lanes, $registers>(coordinates, lanes, out);
            }

            fn ask(
                field: &dyn Asked,
                count: usize,
                coordinate: &dyn Fn(usize, usize) -> Self,
                out: &mut Column<Self>,
            ) {
                field.$ask(count, coordinate, out);
            }

            $(
                #[inline(always)]
                fn or_by_steepness<const D: usize>(
                    self,
                    p: [Self; D],
                    evaluations: Evaluations,
                ) -> Self {
                    evaluations.$or(self, &Vector(p))
                }
            )?
        }
    };
}

// About 24 kB of registers each.
on_tape!(f64, 64 lanes, 48 registers, false, distances_at);
on_tape!(Model, 16 lanes, 32 registers, false, models_at, or_by_steepness);
on_tape!(SpaceTimeModel, 16 lanes, 28 registers, true, space_time_models_at, or_by_steepness);
