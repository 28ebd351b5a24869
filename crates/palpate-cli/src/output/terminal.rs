// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is said on standard output and standard error.

use std::fmt;
use std::io::{self, Write};

use serde_json::Value;

use super::escape::{shown, shown_json, shown_lines};
use crate::outcome::{Failure, Outcome};

/// Standard output for an answer in words or JSON. Characters that would steer a terminal are
/// escaped, wherever they come from.
#[derive(Debug)]
pub(crate) struct Answer {
    out: io::StdoutLock<'static>,
}

/// Where the answer of a command goes.
pub(crate) fn answer() -> Answer {
    Answer { out: io::stdout().lock() }
}

impl Answer {
    /// Writes an object, and ends the line.
    pub(crate) fn json(&mut self, value: &Value) -> io::Result<()> {
        writeln!(self.out, "{}", shown_json(&format!("{value:#}")))
    }
}

impl Write for Answer {
    /// Takes the whole of `text`. Formatting hands on whole strings, so that no character is
    /// cut in two.
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        self.out.write_all(shown_lines(&String::from_utf8_lossy(text)).as_bytes())?;
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Ends the answer of a command: what standard output still holds is written, or the command
/// failed.
pub(crate) fn ended(outcome: Outcome) -> Result<Outcome, Failure> {
    io::stdout().flush()?;
    Ok(outcome)
}

/// Prints help on standard output, or what is wrong with a command line on standard error;
/// returns the exit status.
pub(crate) fn usage(refused: &clap::Error) -> u8 {
    // What cannot be shown is not missed.
    let _ = refused.print();
    u8::try_from(refused.exit_code()).unwrap_or(Failure::STATUS)
}

/// Says on standard error why a command ends.
pub(crate) fn complain(problem: impl fmt::Display) {
    remark(format_args!("palpate: {problem}"));
}

/// Says something beside the answer, on standard error.
pub(crate) fn remark(text: impl fmt::Display) {
    // A remark that cannot be shown is not missed.
    let _ = writeln!(io::stderr(), "{}", shown(&text.to_string()));
}

/// Writes over the last live line on standard error.
pub(crate) fn live(line: impl fmt::Display) {
    // A line that cannot be shown is not missed.
    let _ = write!(io::stderr(), "\r{}\x1b[K", shown(&line.to_string()));
}
