// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Requests to end a run early.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A request to end a run early.
///
/// A signal handler ends the process if [`at_once`](Self::at_once) is set. Otherwise it sets
/// that flag and [`asked`](Self::asked), and the command ends by itself: it sets forces to zero,
/// then writes and reports what is done. A handler whose signal may come twice for one reason
/// looks at [`unheeded`](Self::unheeded) instead, and sets `asked` alone.
#[derive(Clone, Debug)]
pub struct Interrupt {
    asked: Arc<AtomicBool>,
    at_once: Arc<AtomicBool>,
    unheeded: Arc<AtomicBool>,
}

impl Interrupt {
    /// The exit status of a run that was asked to end.
    pub const STATUS: u8 = 130;

    /// No request yet.
    #[must_use]
    pub fn new() -> Self {
        Self {
            asked: Arc::new(AtomicBool::new(false)),
            at_once: Arc::new(AtomicBool::new(true)),
            unheeded: Arc::new(AtomicBool::new(true)),
        }
    }

    /// Set to `true` to ask the run to end.
    #[must_use]
    pub fn asked(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.asked)
    }

    /// `true` while a signal should end the process at once, because the command has nothing to
    /// finish or was asked to end before.
    #[must_use]
    pub fn at_once(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.at_once)
    }

    /// `true` until the command checks whether it is asked to end.
    #[must_use]
    pub fn unheeded(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.unheeded)
    }

    /// Promises that from now on the command checks whether it is asked to end.
    pub(crate) fn heed(&self) {
        self.unheeded.store(false, Ordering::Relaxed);
        self.at_once.store(self.is_asked(), Ordering::Relaxed);
    }

    pub(crate) fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }

    /// The flag, for loops that read it themselves.
    pub(crate) fn flag(&self) -> &AtomicBool {
        &self.asked
    }
}

impl Default for Interrupt {
    fn default() -> Self {
        Self::new()
    }
}
