// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Formulas as tapes of instructions: recorded, assembled, run.
//!
//! Formulas as tapes: lists of instructions over registers, each of which works through many lanes.
//!
//! A compiled loop costs each kernel its own machine code. All tapes run in one interpreter. A tape
//! is slower than a compiled loop, and is used where no loop is compiled. Its instructions are the
//! operations of [`Scalar`], so distances have the bits of the compiled loops.

use std::sync::Arc;

use super::block::{Column, Rows, RowsMut, filled};
#[cfg(target_arch = "x86_64")]
use super::instruction_set::InstructionSet;
use super::lanes::{Lane, LaneArray};
use crate::field::Asked;
use crate::kernel::Evaluations;
use crate::scalar::{
    Blend, Circular, Cubic, Exponential, Expression, Graph, Model, Operation, PowerForm,
    Quadratic, Quartic, Recipe, Root, Scalar, SpaceTimeModel,
};
use crate::vector::{Vector, array};

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

/// The steps of a tape, with numbers of steps in place of registers.
#[derive(Debug, Default)]
struct Unassigned {
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
    fn add(&mut self, recipe: Recipe, arguments: &[usize]) {
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
    fn assign(mut self, result: usize) -> Tape {
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

/// The number of a register; before registers are assigned, that of a step.
type Register = u32;

/// What a step does.
#[derive(Clone, Copy, Debug)]
enum Instruction {
    Coordinate(usize),
    Constant(f64),
    Add([Register; 2]),
    Sub([Register; 2]),
    Mul([Register; 2]),
    Div([Register; 2]),
    Minus([Register; 1], f64),
    Scale([Register; 1], f64),
    Neg([Register; 1]),
    Abs([Register; 1]),
    Squared([Register; 1]),
    Sqrt([Register; 1]),
    Min([Register; 2]),
    Max([Register; 2]),
    /// The register first: it counts at a tie.
    MinConstant([Register; 1], f64),
    MaxConstant([Register; 1], f64),
    /// The constant first.
    ConstantMin([Register; 1], f64),
    ConstantMax([Register; 1], f64),
    SelectLess([Register; 4]),
    Sin([Register; 1]),
    Cos([Register; 1]),
    Turn([Register; 2]),
    Norm1([Register; 1]),
    Norm2([Register; 2]),
    Norm3([Register; 3]),
    Orthant1([Register; 1]),
    Orthant2([Register; 2]),
    Orthant3([Register; 3]),
    WeightedSum1([Register; 1], [f64; 1]),
    WeightedSum2([Register; 2], [f64; 2]),
    WeightedSum3([Register; 3], [f64; 3]),
    SmoothMin([Register; 2], Profile, f64),
    NearestMultiple([Register; 1], [f64; 3]),
    PlanarPower([Register; 2], PowerForm, Power),
    SpatialPower([Register; 3], PowerForm, Power),
    GiveOrTake([Register; 2]),
    PlanarOrBySteepness([Register; 3], Evaluations),
    SpatialOrBySteepness([Register; 4], Evaluations),
    /// The answer of one of the tape's fields.
    AskPlanar([Register; 2], usize),
    AskSpatial([Register; 3], usize),
}

/// A [`Blend`].
#[derive(Clone, Copy, Debug)]
enum Profile {
    Quadratic,
    Cubic,
    Quartic,
    Circular,
    Root,
    Exponential,
}

impl Profile {
    fn of_name(name: &str) -> Self {
        match name {
            Cubic::NAME => Self::Cubic,
            Quartic::NAME => Self::Quartic,
            Circular::NAME => Self::Circular,
            Root::NAME => Self::Root,
            Exponential::NAME => Self::Exponential,
            Quadratic::NAME => Self::Quadratic,
            other => unreachable!("the profile {other}"),
        }
    }
}

/// The power of a norm.
#[derive(Clone, Copy, Debug)]
enum Power {
    Four,
    Six,
    Eight,
}

impl Power {
    fn of(power: u32) -> Self {
        match power {
            4 => Self::Four,
            6 => Self::Six,
            _ => Self::Eight,
        }
    }
}

/// Calls a macro with the registers of an instruction, in whatever variant.
macro_rules! registers_of {
    ($instruction:expr, $registers:ident => $then:expr) => {
        match $instruction {
            Instruction::Coordinate(_) | Instruction::Constant(_) => {}
            Instruction::Add($registers)
            | Instruction::Sub($registers)
            | Instruction::Mul($registers)
            | Instruction::Div($registers)
            | Instruction::Min($registers)
            | Instruction::Max($registers)
            | Instruction::Turn($registers)
            | Instruction::Norm2($registers)
            | Instruction::Orthant2($registers)
            | Instruction::WeightedSum2($registers, _)
            | Instruction::SmoothMin($registers, _, _)
            | Instruction::PlanarPower($registers, _, _)
            | Instruction::GiveOrTake($registers)
            | Instruction::AskPlanar($registers, _) => $then,
            Instruction::Minus($registers, _)
            | Instruction::Scale($registers, _)
            | Instruction::Neg($registers)
            | Instruction::Abs($registers)
            | Instruction::Squared($registers)
            | Instruction::Sqrt($registers)
            | Instruction::MinConstant($registers, _)
            | Instruction::MaxConstant($registers, _)
            | Instruction::ConstantMin($registers, _)
            | Instruction::ConstantMax($registers, _)
            | Instruction::Sin($registers)
            | Instruction::Cos($registers)
            | Instruction::Norm1($registers)
            | Instruction::Orthant1($registers)
            | Instruction::WeightedSum1($registers, _)
            | Instruction::NearestMultiple($registers, _) => $then,
            Instruction::Norm3($registers)
            | Instruction::Orthant3($registers)
            | Instruction::WeightedSum3($registers, _)
            | Instruction::SpatialPower($registers, _, _)
            | Instruction::PlanarOrBySteepness($registers, _)
            | Instruction::AskSpatial($registers, _) => $then,
            Instruction::SelectLess($registers)
            | Instruction::SpatialOrBySteepness($registers, _) => $then,
        }
    };
}
pub(super) use registers_of;

/// The registers while a tape runs.
struct Registers<'r, L> {
    all: &'r mut [L],
}

impl<L> Registers<'_, L> {
    /// The register of a result, to be written.
    ///
    /// # Safety
    ///
    /// It must be one of the registers, and no other reference to it may be in use.
    #[inline(always)]
    unsafe fn out<'l>(&mut self, register: Register) -> &'l mut L {
        debug_assert!((register as usize) < self.all.len());
        // SAFETY: the caller promises it.
        unsafe { &mut *self.all.as_mut_ptr().add(register as usize) }
    }

    /// The register of an argument.
    ///
    /// # Safety
    ///
    /// It must be one of the registers, and not that of the result.
    #[inline(always)]
    unsafe fn argument<'l>(&mut self, register: Register) -> &'l L {
        debug_assert!((register as usize) < self.all.len());
        // SAFETY: the caller promises it.
        unsafe { &*self.all.as_mut_ptr().add(register as usize) }
    }
}

/// Works through all lanes of one instruction: `$number` is computed in each lane from the argument
/// registers.
macro_rules! each_lane {
    ($registers:ident, $lanes:ident, $out:ident, [$($x:ident),*], $number:expr) => {{
        // SAFETY: the slice holds all the tape's registers, and the register of a step's result
        // differs from its argument registers.
        let out = unsafe { $registers.out($out) };
        $(
            // SAFETY: as above.
            let $x = unsafe { $registers.argument($x) };
        )*
        for i in 0..$lanes {
            // SAFETY: an earlier step wrote the first `$lanes` lanes of each argument.
            $(let $x = unsafe { $x.read(i) };)*
            out.write(i, $number);
        }
    }};
}

/// All instructions, one after the other, for `W` lanes at a time.
#[inline(always)]
fn interpret<S: OnTape, const W: usize>(
    tape: &Tape,
    coordinates: &[&Column<S>],
    all: usize,
    registers: &mut [S::Lanes<W>],
    out: &mut Column<S>,
) {
    use Instruction as I;
    assert!(tape.registers <= registers.len(), "{} registers", registers.len());
    let mut r = Registers { all: registers };
    for first in (0..all).step_by(W) {
        let n = W.min(all - first);
        for Step { out, instruction } in &tape.steps {
            let o = *out;
            match *instruction {
                I::Coordinate(axis) => {
                    // SAFETY: the register is one of the tape's.
                    let out = unsafe { r.out(o) };
                    for i in 0..n {
                        // SAFETY: `run` checked that these lanes of each coordinate are written.
                        out.write(i, unsafe { coordinates[axis].read(first + i) });
                    }
                }
                I::AskPlanar(of, field) => ask::<S, W>(&*tape.asked[field], &of, &mut r, o, n),
                I::AskSpatial(of, field) => ask::<S, W>(&*tape.asked[field], &of, &mut r, o, n),
                I::Constant(c) => each_lane!(r, n, o, [], S::constant(c)),
                I::Add([a, b]) => each_lane!(r, n, o, [a, b], a + b),
                I::Sub([a, b]) => each_lane!(r, n, o, [a, b], a - b),
                I::Mul([a, b]) => each_lane!(r, n, o, [a, b], a * b),
                I::Div([a, b]) => each_lane!(r, n, o, [a, b], a / b),
                I::Minus([a], c) => each_lane!(r, n, o, [a], a.minus(c)),
                I::Scale([a], c) => each_lane!(r, n, o, [a], a.scale(c)),
                I::Neg([a]) => each_lane!(r, n, o, [a], -a),
                I::Abs([a]) => each_lane!(r, n, o, [a], Scalar::abs(a)),
                I::Squared([a]) => each_lane!(r, n, o, [a], a.squared()),
                I::Sqrt([a]) => each_lane!(r, n, o, [a], Scalar::sqrt(a)),
                I::Min([a, b]) => each_lane!(r, n, o, [a, b], Scalar::min(a, b)),
                I::Max([a, b]) => each_lane!(r, n, o, [a, b], Scalar::max(a, b)),
                I::MinConstant([a], c) => {
                    each_lane!(r, n, o, [a], Scalar::min(a, S::constant(c)));
                }
                I::MaxConstant([a], c) => {
                    each_lane!(r, n, o, [a], Scalar::max(a, S::constant(c)));
                }
                I::ConstantMin([a], c) => {
                    each_lane!(r, n, o, [a], Scalar::min(S::constant(c), a));
                }
                I::ConstantMax([a], c) => {
                    each_lane!(r, n, o, [a], Scalar::max(S::constant(c), a));
                }
                I::SelectLess([a, b, c, d]) => {
                    each_lane!(r, n, o, [a, b, c, d], S::select_less(a, b, c, d));
                }
                I::Sin([a]) => each_lane!(r, n, o, [a], Scalar::sin(a)),
                I::Cos([a]) => each_lane!(r, n, o, [a], Scalar::cos(a)),
                I::Turn([a, b]) => each_lane!(r, n, o, [a, b], S::turn(a, b)),
                I::Norm1([a]) => each_lane!(r, n, o, [a], S::norm([a])),
                I::Norm2([a, b]) => each_lane!(r, n, o, [a, b], S::norm([a, b])),
                I::Norm3([a, b, c]) => each_lane!(r, n, o, [a, b, c], S::norm([a, b, c])),
                I::Orthant1([a]) => each_lane!(r, n, o, [a], S::orthant([a])),
                I::Orthant2([a, b]) => each_lane!(r, n, o, [a, b], S::orthant([a, b])),
                I::Orthant3([a, b, c]) => each_lane!(r, n, o, [a, b, c], S::orthant([a, b, c])),
                I::WeightedSum1([a], w) => each_lane!(r, n, o, [a], S::weighted_sum([a], &w)),
                I::WeightedSum2([a, b], w) => {
                    each_lane!(r, n, o, [a, b], S::weighted_sum([a, b], &w));
                }
                I::WeightedSum3([a, b, c], w) => {
                    each_lane!(r, n, o, [a, b, c], S::weighted_sum([a, b, c], &w));
                }
                I::SmoothMin([a, b], Profile::Quadratic, unit) => {
                    each_lane!(r, n, o, [a, b], a.smooth_min::<Quadratic>(b, unit));
                }
                I::SmoothMin([a, b], Profile::Cubic, unit) => {
                    each_lane!(r, n, o, [a, b], a.smooth_min::<Cubic>(b, unit));
                }
                I::SmoothMin([a, b], Profile::Quartic, unit) => {
                    each_lane!(r, n, o, [a, b], a.smooth_min::<Quartic>(b, unit));
                }
                I::SmoothMin([a, b], Profile::Circular, unit) => {
                    each_lane!(r, n, o, [a, b], a.smooth_min::<Circular>(b, unit));
                }
                I::SmoothMin([a, b], Profile::Root, unit) => {
                    each_lane!(r, n, o, [a, b], a.smooth_min::<Root>(b, unit));
                }
                I::SmoothMin([a, b], Profile::Exponential, unit) => {
                    each_lane!(r, n, o, [a, b], a.smooth_min::<Exponential>(b, unit));
                }
                I::NearestMultiple([a], [spacing, low, high]) => {
                    each_lane!(r, n, o, [a], a.nearest_multiple(spacing, low, high));
                }
                I::PlanarPower(of, form, power) => {
                    powers::<S, W, 2>(&mut r, o, of, (form, power), n);
                }
                I::SpatialPower(of, form, power) => {
                    powers::<S, W, 3>(&mut r, o, of, (form, power), n);
                }
                I::GiveOrTake([a, b]) => each_lane!(r, n, o, [a, b], a.give_or_take(b)),
                I::PlanarOrBySteepness([a, b, c], evaluations) => {
                    each_lane!(r, n, o, [a, b, c], a.or_by_steepness([b, c], evaluations));
                }
                I::SpatialOrBySteepness([a, b, c, d], evaluations) => {
                    each_lane!(
                        r,
                        n,
                        o,
                        [a, b, c, d],
                        a.or_by_steepness([b, c, d], evaluations)
                    );
                }
            }
        }
        // SAFETY: the last step wrote this register of the tape.
        let result = unsafe { r.argument(tape.result) };
        for i in 0..n {
            // SAFETY: that step wrote its first `n` lanes.
            out.write(first + i, unsafe { result.read(i) });
        }
    }
}

/// Norms of powers. Not inlined: they are rare and long.
#[inline(never)]
fn powers<S: OnTape, const W: usize, const N: usize>(
    r: &mut Registers<'_, S::Lanes<W>>,
    out: Register,
    of: [Register; N],
    (form, power): (PowerForm, Power),
    n: usize,
) {
    for i in 0..n {
        // SAFETY: the registers are some of the tape's, and steps before wrote `n` lanes of them.
        let x = array!(k < N => unsafe { r.argument(of[k]).read(i) });
        let number = match (form, power) {
            (PowerForm::Norm, Power::Four) => S::power_norm::<4, N>(x),
            (PowerForm::Norm, Power::Six) => S::power_norm::<6, N>(x),
            (PowerForm::Norm, Power::Eight) => S::power_norm::<8, N>(x),
            (PowerForm::Orthant, Power::Four) => S::power_orthant::<4, N>(x),
            (PowerForm::Orthant, Power::Six) => S::power_orthant::<6, N>(x),
            (PowerForm::Orthant, Power::Eight) => S::power_orthant::<8, N>(x),
        };
        // SAFETY: the register is one of the tape's, and none of the arguments'.
        unsafe { r.out(out) }.write(i, number);
    }
}

/// The answers of a field at the points in some registers.
#[inline(never)]
fn ask<S: OnTape, const W: usize>(
    field: &dyn Asked,
    of: &[Register],
    r: &mut Registers<'_, S::Lanes<W>>,
    out: Register,
    n: usize,
) {
    let mut answers = Column::scratch();
    let coordinate = |axis: usize, lane: usize| {
        assert!(lane < n);
        // SAFETY: the register is one of the tape's, and a step before wrote `n` lanes of it.
        unsafe { (*r.all.as_ptr().add(of[axis] as usize)).read(lane) }
    };
    S::ask(field, n, &coordinate, &mut answers);
    // SAFETY: the register is one of the tape's.
    let out = unsafe { r.out(out) };
    (0..n).for_each(|i| out.write(i, answers.get(i)));
}

/// The interpreter, in functions compiled with the instructions that the attributes enable.
macro_rules! compiled_interpreters {
    ($($(#[$attribute:meta])* $name:ident;)*) => {$(
        $(#[$attribute])*
        fn $name<S: OnTape, const W: usize>(
            tape: &Tape,
            coordinates: &[&Column<S>],
            lanes: usize,
            registers: &mut [S::Lanes<W>],
            out: &mut Column<S>,
        ) {
            interpret::<S, W>(tape, coordinates, lanes, registers, out);
        }
    )*};
}

compiled_interpreters! {
    #[inline(never)]
    everywhere;

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi2")]
    with_avx2;

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi2,avx512f,avx512vl,avx512dq,avx512bw")]
    with_avx512;
}
