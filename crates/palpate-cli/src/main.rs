// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The palpate program: signed distance functions that can be touched.

mod arguments;
mod check;
mod contact;
mod descend;
mod devices;
mod eval;
mod feel;
mod gallery;
mod hand_csv;
mod input;
mod jitter;
mod mass;
mod mesh;
mod outcome;
mod output;
mod picture;
mod plot;
mod schema;
mod shapes;
mod times;
mod trace;

use std::process::ExitCode;

use clap::Parser;
use mimalloc::MiMalloc;

use arguments::{Arguments, Command};
use outcome::Outcome;

/// Worlds are built of many small nodes: `docs/decisions/allocator.md`.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let result = match arguments.command.unwrap_or_default() {
        Command::Feel(options) => feel::run(&options),
        Command::Eval(options) => eval::run(&options),
        Command::Contact(options) => contact::run(&options),
        Command::Descend(options) => descend::run(&options),
        Command::Plot(options) => plot::run(&options),
        Command::Gallery(options) => gallery::run(&options),
        Command::Check(options) => check::run(&options),
        Command::Mass(options) => mass::run(&options),
        Command::Mesh(options) => mesh::run(&options),
        Command::Schema => schema::run(),
        Command::Shapes(options) => shapes::run(&options),
        Command::Devices(options) => devices::run(&options),
        Command::Jitter(options) => jitter::run(&options),
    };
    match result.and_then(output::ended) {
        Ok(Outcome::Yes) => ExitCode::SUCCESS,
        Ok(Outcome::No) => ExitCode::from(1),
        Err(failure) if failure.is_closed_pipe() => ExitCode::SUCCESS,
        Err(failure) => {
            output::complain(failure);
            ExitCode::from(2)
        }
    }
}
