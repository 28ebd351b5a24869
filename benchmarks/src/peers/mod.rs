// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The peers, asked the same questions.

mod expression;
mod formula;
mod parry;
mod tape;

pub(crate) use formula::{Dimensions, Space, formula};
pub(crate) use parry::Body;
pub(crate) use tape::Tape;
