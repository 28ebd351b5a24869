// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Writes to standard output and standard error.

use std::fmt;
use std::io::{self, Write};

use serde::Serialize;

use palpate::scene::Versioned;
use palpate::scene::text::{shown, shown_json, shown_lines};

use crate::outcome::{Failure, Outcome};

/// Standard output for an answer in words or JSON. It escapes characters that a terminal would
/// obey.
#[derive(Debug)]
pub(crate) struct Answer {
    out: io::StdoutLock<'static>,
}

/// The standard output, for the answer of a command.
pub(crate) fn answer() -> Answer {
    Answer { out: io::stdout().lock() }
}

impl Answer {
    /// Writes an answer as an object that begins with its version, and ends the line.
    pub(crate) fn json(&mut self, answer: &impl Serialize) -> io::Result<()> {
        let json = serde_json::to_string_pretty(&Versioned::new(answer))?;
        writeln!(self.out, "{}", shown_json(&json))
    }

    /// Writes an answer, as JSON or in words.
    pub(crate) fn print(
        &mut self,
        answer: &(impl Serialize + fmt::Display),
        as_json: bool,
    ) -> io::Result<()> {
        if as_json { self.json(answer) } else { write!(self, "{answer}") }
    }
}

impl Write for Answer {
    /// Writes the whole of `text`. Formatting passes whole strings, so no character is cut in
    /// two.
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        self.out.write_all(shown_lines(&String::from_utf8_lossy(text)).as_bytes())?;
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Flushes standard output at the end of a command; the command fails if that fails.
pub(crate) fn ended(outcome: Outcome) -> Result<Outcome, Failure> {
    io::stdout().flush()?;
    Ok(outcome)
}

/// Prints help on standard output, or an error of the command line on standard error; returns
/// the exit status.
pub(crate) fn usage(refused: &clap::Error) -> Result<u8, Failure> {
    let printed = refused.print().and_then(|()| io::stdout().flush());
    // Without standard error there is nowhere to report that an error could not be printed.
    if !refused.use_stderr() {
        printed?;
    }
    Ok(u8::try_from(refused.exit_code()).unwrap_or(Failure::STATUS))
}

/// Prints on standard error why a command fails, in one line or several.
pub(crate) fn complain(problem: impl fmt::Display) {
    // Ignored: there is nowhere else to say it.
    let _ = writeln!(io::stderr(), "palpate: {}", shown_lines(&problem.to_string()));
}

/// Prints a remark beside the answer, on standard error.
pub(crate) fn remark(text: impl fmt::Display) {
    // Ignored: a remark does not change the answer.
    let _ = writeln!(io::stderr(), "{}", shown(&text.to_string()));
}

/// Writes over the last live line on standard error.
pub(crate) fn live(line: impl fmt::Display) {
    // Ignored: the line does not change the answer.
    let _ = write!(io::stderr(), "\r{}\x1b[K", shown(&line.to_string()));
}
