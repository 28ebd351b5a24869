// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate schema`: prints the JSON schema of scene files.

use std::io::Write;

use crate::outcome::{Failure, Outcome};
use crate::output;

pub(crate) fn run() -> Result<Outcome, Failure> {
    write!(output::answer(), "{}", palpate::scene::schema_text())?;
    Ok(Outcome::Yes)
}
