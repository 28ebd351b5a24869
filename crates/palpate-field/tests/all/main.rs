// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! All tests of the crate but those that count allocations in one program, which links faster
//! than many.

mod bad_input;
mod bits;
mod catalogue;
mod cells;
mod errata;
mod golden;
mod guide;
mod mass;
mod models;
mod motion;
mod nodes;
mod numbers;
mod oracles;
mod power;
mod promises;
mod recorder;
mod regressions;
mod singular;
mod slices;
mod space_time;
