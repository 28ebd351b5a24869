// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How far long work is, on standard error.

use std::fmt::Display;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::output;

/// How often a line says how far the work is where no terminal shows a bar.
const EACH: Duration = Duration::from_secs(10);

/// A progress bar, which is hidden unless standard error is a terminal.
pub(crate) fn bar() -> ProgressBar {
    ProgressBar::new(0).with_style(
        ProgressStyle::with_template("{msg}{bar:40} {percent} %, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    )
}

/// How far work that may take minutes is: a bar on a terminal, else a line now and then.
pub(crate) struct Progress {
    what: &'static str,
    bar: ProgressBar,
    told: Mutex<Instant>,
}

impl Progress {
    pub(crate) fn of(what: &'static str) -> Self {
        Self { what, bar: bar(), told: Mutex::new(Instant::now()) }
    }

    /// Shows that `done` of `of` pieces are done, of a part of the work if it has a name.
    pub(crate) fn show(&self, done: usize, of: usize, part: impl Display) {
        self.bar.set_length(of as u64);
        self.bar.set_position(done as u64);
        let part = part.to_string();
        if !self.bar.is_hidden() {
            let separator = if part.is_empty() { "" } else { ": " };
            self.bar.set_message(format!("{part}{separator}"));
            return;
        }
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        if told.elapsed() >= EACH {
            *told = Instant::now();
            let separator = if part.is_empty() { "" } else { ", " };
            let percent = 100 * done / of.max(1);
            output::remark(format_args!("{}{separator}{part}: {percent} %", self.what));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
