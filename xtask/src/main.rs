// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The project's own chores: `cargo xtask test`, `cargo xtask check`, `cargo xtask oracle`.

mod check;
mod command;
mod layers;
mod licences;
mod sources;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use command::{Failure, cargo};

/// The project's own chores.
#[derive(Debug, Parser)]
#[command(bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Debug, Subcommand)]
enum Chore {
    /// Run every test of every language in the repository.
    Test,
    /// Check formatting, lints, documentation, licences, layers and file lengths.
    Check,
    /// Make testdata/recall: separations that a plain search proves; takes minutes.
    Oracle,
}

fn main() -> ExitCode {
    let result = match Arguments::parse().chore {
        Chore::Test => test(),
        Chore::Check => check::all(),
        Chore::Oracle => oracle(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            ExitCode::FAILURE
        }
    }
}

/// All tests. Rust is the only language so far, and nothing but cargo is needed.
fn test() -> Result<(), Failure> {
    cargo(&["test", "--workspace", "--locked"])
}

/// The truths that recall tests replay. The program is an example of the testkit, so that
/// other chores need not wait for the fields to be compiled.
fn oracle() -> Result<(), Failure> {
    cargo(&["run", "--release", "--locked", "-p", "palpate-testkit", "--example", "oracle"])
}
