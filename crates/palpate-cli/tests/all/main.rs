// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The program as its users run it. One test program, so that it is linked once.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod asked;
mod balls;
mod bounds;
mod common;
mod contact;
mod descents;
mod documented;
mod error_maps;
mod feel;
mod gradients;
mod grids;
mod identify;
mod interrupted;
mod live;
mod memoir;
mod messages;
mod motions;
mod outputs;
mod pictures;
mod program;
mod render;
mod rules;
mod shapes;
mod sweep;
mod tables;
mod touch;
mod unsaved;
