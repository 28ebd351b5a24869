// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The palpate program as a function: signed distance functions that can be touched.
//!
//! [`run`] runs a command line as `palpate` does, on the standard output and error of the
//! process. The caller chooses the allocator and handles signals.

mod answers;
mod arguments;
mod ask;
mod check;
mod contact;
mod descend;
mod devices;
mod emptiness;
mod error_map;
mod eval;
mod feel;
mod gallery;
mod gradients;
mod grid;
mod identify;
mod input;
mod interrupt;
mod jitter;
mod kind;
mod live;
mod mass;
mod mesh;
mod outcome;
mod output;
mod picture;
mod plane;
mod plot;
mod render;
mod schema;
mod shapes;
mod sweep;
mod table;
mod unfelt;
mod units;
mod views;

use std::ffi::OsString;

use clap::Parser;

use arguments::{Arguments, Command};
use outcome::{Failure, Outcome};

pub use interrupt::Interrupt;

/// Runs a command line, the program's name first, and returns the exit status: 0 if the answer
/// is yes, 1 if it is no, 2 if the input cannot be used, 141 if the reader of the answer left.
///
/// # Examples
///
/// ```
/// assert_eq!(palpate_cli::run(["palpate", "shapes", "--dimension", "2"]), 0);
/// assert_eq!(palpate_cli::run(["palpate", "check", "no/such/scene.json"]), 2);
/// ```
pub fn run(arguments: impl IntoIterator<Item = impl Into<OsString>>) -> u8 {
    run_until(arguments, &Interrupt::new())
}

/// As [`run`], but ends early when `interrupt` asks for it: what is done until then is written
/// and reported, and the status is 130.
///
/// # Examples
///
/// ```
/// use std::sync::atomic::Ordering;
///
/// let interrupt = palpate_cli::Interrupt::new();
/// interrupt.asked().store(true, Ordering::Relaxed);
/// let status = palpate_cli::run_until(["palpate", "feel", "--fast"], &interrupt);
/// assert_eq!(status, 130);
/// ```
pub fn run_until(
    arguments: impl IntoIterator<Item = impl Into<OsString>>,
    interrupt: &Interrupt,
) -> u8 {
    let arguments = Arguments::try_parse_from(arguments.into_iter().map(Into::into));
    let status = match arguments {
        Ok(arguments) => obey(&arguments.command.unwrap_or_default(), interrupt)
            .and_then(output::ended)
            .map(Outcome::status),
        Err(refused) => output::usage(&refused),
    };
    match status {
        Ok(status) => status,
        Err(failure) if failure.is_closed_pipe() => Failure::NO_READER,
        Err(failure) => {
            output::complain(&failure);
            Failure::STATUS
        }
    }
}

fn obey(command: &Command, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    match command {
        Command::Feel(options) => feel::run(options, interrupt),
        Command::Eval(options) => eval::run(options, interrupt),
        Command::Contact(options) => contact::run(options, interrupt),
        Command::Sweep(options) => sweep::run(options, interrupt),
        Command::Descend(options) => descend::run(options),
        Command::Gradients(options) => gradients::run(options),
        Command::Plot(options) => plot::run(options, interrupt),
        Command::Render(options) => render::run(options, interrupt),
        Command::Gallery(options) => gallery::run(options, interrupt),
        Command::Check(options) => check::run(options),
        Command::Mass(options) => mass::run(options, interrupt),
        Command::Grid(options) => grid::run(options, interrupt),
        Command::Mesh(options) => mesh::run(options, interrupt),
        Command::Schema(options) => schema::run(options),
        Command::Shapes(options) => shapes::run(options),
        Command::Devices(options) => devices::run(options),
        Command::Identify(options) => identify::run(options, interrupt),
        Command::Live(options) => live::run(options, interrupt),
        Command::Jitter(options) => jitter::run(options),
    }
}
