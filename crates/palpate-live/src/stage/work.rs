// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where threads that may take long begin to work: tests hold them there.

use std::fmt;
use std::sync::Arc;

/// What a thread of the program begins to do, beside the servo and the threads that read and write
/// sockets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Work {
    /// To answer a request: a file of the page, the scene, or a trace.
    Request,
    /// To read a message of a page.
    Message,
    /// To edit or build the scene.
    Edit,
    /// To answer a question about the scene.
    Question,
}

/// Is called by each thread that begins to work, if anybody watches.
#[derive(Clone, Default)]
pub(crate) struct Watch(Option<Arc<dyn Fn(Work) + Send + Sync>>);

impl Watch {
    pub(crate) fn new(watch: impl Fn(Work) + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(watch)))
    }

    pub(crate) fn begins(&self, work: Work) {
        if let Some(watch) = &self.0 {
            watch(work);
        }
    }
}

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Watch").field(&self.0.is_some()).finish()
    }
}
