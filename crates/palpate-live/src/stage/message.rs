// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A message of a page as its text, until somebody reads it.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use tungstenite::Utf8Bytes;

use super::pages::PageId;
use crate::wire::{Question, Unreadable};

/// The bytes of a page's messages that may wait: a page that sends more is closed.
pub(crate) const MOST_WAITING: usize = 4 << 20;

/// The bytes of a page's messages that wait.
#[derive(Clone, Debug, Default)]
pub(crate) struct Waiting(Arc<AtomicUsize>);

impl Waiting {
    /// A message of the page that waits from now on; `None` if there is no room for it.
    pub(crate) fn message(&self, page: PageId, text: Utf8Bytes) -> Option<Received> {
        let before = self.0.fetch_add(text.len(), Ordering::Relaxed);
        let message = Received { page, text, waiting: self.clone() };
        (before + message.text.len() <= MOST_WAITING).then_some(message)
    }
}

/// A message of a page.
///
/// It waits as its text, which takes less memory than the message that is read.
#[derive(Debug)]
pub(crate) struct Received {
    pub(super) page: PageId,
    pub(super) text: Utf8Bytes,
    waiting: Waiting,
}

impl Received {
    /// Reads it.
    ///
    /// # Errors
    ///
    /// As [`Question::read`].
    pub(super) fn read(&self) -> Result<Question, Unreadable> {
        Question::read(&self.text)
    }
}

impl Drop for Received {
    fn drop(&mut self) {
        self.waiting.0.fetch_sub(self.text.len(), Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stage::pages::Pages;

    #[test]
    fn so_many_bytes_wait_and_no_more() {
        let opened = Pages::default().add(1).unwrap();
        let (page, waiting) = (opened.page, opened.waiting);
        let message = |length: usize| waiting.message(page, "x".repeat(length).into());
        let half = message(MOST_WAITING / 2).unwrap();
        assert!(message(MOST_WAITING / 2 + 1).is_none(), "there is no room");
        let other = message(MOST_WAITING / 2).unwrap();
        assert!(message(1).is_none());
        drop((half, other));
        assert_eq!(waiting.0.load(Ordering::Relaxed), 0);
    }
}
