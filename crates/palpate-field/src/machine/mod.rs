// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Blocks of lanes in memory, and the loops over them for each instruction set.
//!
//! The loops over lanes are here and nowhere else. The rest of the crate gives
//! [`Job`]s: the work in one lane. This is the one module of the crate where
//! `unsafe` is allowed: to call functions compiled for an instruction set that
//! was found at run time, and to leave scratch memory unwritten, which would cost
//! more to clear than a leaf takes to evaluate.
#![expect(
    unsafe_code,
    reason = "calls code for a checked instruction set; scratch memory starts unwritten"
)]

mod block;
mod instruction_set;
mod lanes;
mod tape;

pub(crate) use block::Boxes;
pub use block::{BLOCK, Block, Column, Gradients};
pub use instruction_set::{InstructionSet, Wide, wide};
pub(crate) use instruction_set::{Job, PointJob, run, run_point, run_wide};
pub use lanes::{Lane, LaneArray, Lanes, ModelLanes};
pub(crate) use tape::{OnTape, Tape};
