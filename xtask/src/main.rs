// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The project's own chores: `cargo xtask test`, `python`, `check`, `renew`, `api`, `lines` and `oracle`.

mod api;
mod builds;
mod check;
mod code;
mod command;
mod layers;
mod licences;
#[cfg(feature = "lines")]
mod lines;
mod links;
mod packages;
mod page;
mod python;
mod sources;
mod tree;
mod words;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use command::{Failure, cargo, cargo_with};

/// The variable for which tests write what they generate instead of comparing it.
const RENEW: &str = "PALPATE_RENEW";

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
    Test {
        /// Take every seed of the property tests, ten times as many as usual, and run the slow tests.
        #[arg(long)]
        thorough: bool,
    },
    /// Build the wheel for Python and run its tests, as `test` does at its end.
    Python,
    /// Check formatting, sources, words, links, layers, licences, packages, lints,
    /// documentation, the list of public items, and that the core compiles without a system.
    Check {
        /// The stages to run; all but `code` if none is named.
        #[arg(value_parser = clap::builder::PossibleValuesParser::new(check::stages()))]
        stages: Vec<String>,
        /// Run every stage, also `code`, which makes a release build.
        #[arg(long, conflicts_with = "stages")]
        thorough: bool,
    },
    /// Renew every generated file: schema, tables in docs, generated scenes, snapshots, the constructors
    /// of the Python package, and the lists of public items.
    Renew {
        /// Also those that take minutes: pictures of the live page, and testdata/recall.
        #[arg(long)]
        all: bool,
    },
    /// Renew the lists of public items in docs/public-api.
    Api,
    /// Count lines of code, without tests, comments and documentation.
    Lines {
        /// Another revision to count beside this one.
        revision: Option<String>,
    },
    /// Make testdata/recall: separations that a plain search proves; takes minutes.
    Oracle,
}

fn main() -> ExitCode {
    let result = match Arguments::parse().chore {
        Chore::Test { thorough } => test(thorough),
        Chore::Python => python::test(),
        Chore::Check { stages, thorough } => check::run(&stages, thorough),
        Chore::Renew { all } => renew(all),
        Chore::Api => public_items(),
        Chore::Lines { revision } => lines(revision.as_deref()),
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

/// All tests, those of the live page in a browser and of the Python package among them.
fn test(is_thorough: bool) -> Result<(), Failure> {
    let tools = page::prepare()?;
    let tools = tools.to_string_lossy();
    let mut environment = vec![(page::VARIABLE, &*tools)];
    let mut arguments = vec!["test", "--workspace", "--locked", "--no-fail-fast"];
    if is_thorough {
        environment.push(("PALPATE_SEEDS", "1"));
        arguments.extend(["--", "--include-ignored"]);
    }
    cargo_with(&arguments, &environment)?;
    python::test()
}

/// The lists of public items.
fn public_items() -> Result<(), Failure> {
    check::document().and_then(|()| api::renew())
}

/// Every generated file, in the order in which they need each other.
fn renew(is_all: bool) -> Result<(), Failure> {
    let renewing = [(RENEW, "1"), ("INSTA_UPDATE", "always")];
    let crates = ["-p", "palpate-field", "-p", "palpate-plot", "-p", "palpate-scene"];
    cargo_with(
        &[&["test", "--locked"][..], &crates, &["--lib", "--tests"]].concat(),
        &renewing,
    )?;
    let guide = ["test", "--locked", "-p", "palpate-cli", "--test", "all", "documented"];
    cargo_with(&guide, &renewing)?;
    let answers = ["test", "--locked", "-p", "palpate-cli", "--lib", "answers"];
    cargo_with(&answers, &renewing)?;
    python::renew()?;
    public_items()?;
    if is_all {
        oracle()?;
        let tools = page::prepare()?;
        let tools = tools.to_string_lossy();
        let pictures = [(page::VARIABLE, &*tools), ("PALPATE_UPDATE_PICTURES", "1")];
        cargo_with(&["test", "--locked", "-p", "palpate-cli", "--test", "page"], &pictures)?;
    }
    Ok(())
}

/// The truths that recall tests replay. The program is an example of the testkit, so that
/// other chores need not wait for the fields to be compiled.
fn oracle() -> Result<(), Failure> {
    cargo(&["run", "--release", "--locked", "-p", "palpate-testkit", "--example", "oracle"])
}

/// Lines of code, by this program with the crates that count them.
#[cfg(not(feature = "lines"))]
fn lines(revision: Option<&str>) -> Result<(), Failure> {
    let mut arguments = vec![
        "run",
        "--quiet",
        "--locked",
        "--package",
        "xtask",
        "--features",
        "lines",
        "--",
        "lines",
    ];
    arguments.extend(revision);
    cargo(&arguments)
}

#[cfg(feature = "lines")]
fn lines(revision: Option<&str>) -> Result<(), Failure> {
    lines::print(revision)
}
