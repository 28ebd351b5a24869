// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate schema`: prints the JSON schema of scene files, or of answers.

use std::io::Write;

use clap::{Args, ValueEnum};

use crate::outcome::{Failure, Outcome};
use crate::output;

/// The schema of answers; a test keeps it.
const ANSWERS: &str = include_str!("../schema/answers.schema.json");

pub(crate) fn run(options: &SchemaOptions) -> Result<Outcome, Failure> {
    let text = match options.of {
        SchemaOf::Scenes => palpate::scene::schema_text(),
        SchemaOf::Answers => ANSWERS,
    };
    write!(output::answer(), "{text}")?;
    Ok(Outcome::Yes)
}

/// The options of `palpate schema`.
#[derive(Args, Debug)]
pub(crate) struct SchemaOptions {
    /// What the schema is of.
    #[arg(value_enum, default_value = "scenes")]
    pub(crate) of: SchemaOf,
}

/// What a schema is of.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum SchemaOf {
    /// Scene files.
    Scenes,
    /// What `--json` prints, and the questions of other programs.
    Answers,
}
