// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the steps of a tape do.

use crate::kernel::Evaluations;
use crate::scalar::{Blend, Circular, Cubic, Exponential, PowerForm, Quadratic, Quartic, Root};

/// The number of a register; before registers are assigned, that of a step.
pub(super) type Register = u32;

/// What a step does.
#[derive(Clone, Copy, Debug)]
pub(super) enum Instruction {
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
pub(super) enum Profile {
    Quadratic,
    Cubic,
    Quartic,
    Circular,
    Root,
    Exponential,
}

impl Profile {
    pub(super) fn of_name(name: &str) -> Self {
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
pub(super) enum Power {
    Four,
    Six,
    Eight,
}

impl Power {
    pub(super) fn of(power: u32) -> Self {
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
