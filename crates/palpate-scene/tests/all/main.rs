// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scene files, from outside. One test program, so that it is linked once.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod common;
mod device_files;
mod errors;
mod errors_in_bodies;
mod from_code;
mod fuzz;
mod generated;
mod grids;
mod hostile;
mod materials;
mod mesh_files;
mod motions;
mod origins;
mod random;
mod refusal;
mod round_trip;
mod schema;
mod several;
