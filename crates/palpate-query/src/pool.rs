// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Workspaces that threads share in turn.

use std::sync::{Mutex, PoisonError};

use crate::pair::PairWorkspace;

/// Idle workspaces, in boxes: moving one takes a fifth of the time of a question. The contents
/// of a workspace change no answer.
#[derive(Debug)]
pub(crate) struct Pool<const D: usize>(Mutex<Vec<Box<PairWorkspace<D>>>>);

impl<const D: usize> Pool<D> {
    pub(crate) fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    /// Runs `ask` with a workspace, a new one if all are in use.
    pub(crate) fn with(&self, ask: impl FnOnce(&mut PairWorkspace<D>)) {
        let idle = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let lent = idle().pop();
        let mut workspace = lent.unwrap_or_default();
        ask(&mut workspace);
        idle().push(workspace);
    }
}
