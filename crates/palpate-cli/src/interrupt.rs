// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How a run is asked to end early.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Asks a run to end early.
///
/// A signal handler that finds [`at_once`](Self::at_once) set ends the process; else it sets both
/// flags, and the command ends by itself: forces are set to zero first, then what was done is
/// written and reported.
#[derive(Clone, Debug)]
pub struct Interrupt {
    asked: Arc<AtomicBool>,
    at_once: Arc<AtomicBool>,
}

impl Interrupt {
    /// The exit status of a run that was asked to end.
    pub const STATUS: u8 = 130;

    /// Nothing is asked yet.
    #[must_use]
    pub fn new() -> Self {
        Self {
            asked: Arc::new(AtomicBool::new(false)),
            at_once: Arc::new(AtomicBool::new(true)),
        }
    }

    /// Set to `true` to ask the run to end.
    #[must_use]
    pub fn asked(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.asked)
    }

    /// `true` while a signal should end the process at once: the command has nothing to finish,
    /// or was asked before.
    #[must_use]
    pub fn at_once(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.at_once)
    }

    /// From now on the command looks whether it is asked to end.
    pub(crate) fn heed(&self) {
        self.at_once.store(self.is_asked(), Ordering::Relaxed);
    }

    pub(crate) fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }

    /// The flag, for loops that look at it themselves.
    pub(crate) fn flag(&self) -> &AtomicBool {
        &self.asked
    }
}

impl Default for Interrupt {
    fn default() -> Self {
        Self::new()
    }
}
