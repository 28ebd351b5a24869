// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate schema`: the JSON schema of scene files.

use std::io::Write;

use crate::outcome::{Failure, Outcome};

pub(crate) fn run() -> Result<Outcome, Failure> {
    write!(std::io::stdout().lock(), "{}", palpate::scene::schema_text())?;
    Ok(Outcome::Yes)
}
