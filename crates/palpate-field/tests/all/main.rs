// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! All tests of the crate in one program, which links faster than many.

mod allocation;
mod bad_input;
mod bits;
mod bounds;
mod catalogue;
mod cells;
mod conversions;
mod errata;
mod functions;
mod golden;
mod guide;
mod marks;
mod mass;
mod models;
mod motion;
mod nodes;
mod numbers;
mod oracles;
mod origins;
mod parabolas;
mod poses;
mod power;
mod promises;
mod recorder;
mod regressions;
mod screws;
mod shapes;
mod singular;
mod slices;
mod space_time;
mod special_cases;
mod tapes;
mod threads;
mod unions;
