// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate schema`: prints the JSON schema of scene files, or of answers.

use std::io::Write;

use crate::arguments::{SchemaOf, SchemaOptions};
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
