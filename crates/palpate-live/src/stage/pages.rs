// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The pages that are open, and what waits to be sent to them.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use axum::body::Bytes;
use axum::extract::ws::Utf8Bytes;
use serde_json::{Value, json};
use tokio::sync::mpsc;

/// Messages that may wait for a page: a page that takes fewer is closed.
pub(crate) const WAITING: usize = 256;

/// Grids and pictures, of up to 16 MiB each, that may wait for a page.
const LARGE_WAITING: usize = 8;

/// A message for a page.
#[derive(Clone, Debug)]
pub(crate) enum Out {
    Text(Utf8Bytes),
    Binary(Bytes),
}

impl From<&Value> for Out {
    fn from(message: &Value) -> Self {
        Self::Text(message.to_string().into())
    }
}

/// An open page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct PageId(u64);

/// The open pages.
#[derive(Debug, Default)]
pub(crate) struct Pages(Mutex<Open>);

#[derive(Debug, Default)]
struct Open {
    pages: HashMap<PageId, mpsc::Sender<Out>>,
    /// The pages that ever were.
    ever: u64,
}

impl Pages {
    // The state is valid even if a thread panicked while it held the lock.
    fn open(&self) -> MutexGuard<'_, Open> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a page; `None` if there are `most` already.
    pub(crate) fn add(&self, most: usize) -> Option<(PageId, mpsc::Receiver<Out>)> {
        let mut open = self.open();
        if open.pages.len() >= most {
            return None;
        }
        let (sender, receiver) = mpsc::channel(WAITING);
        let page = PageId(open.ever);
        open.ever += 1;
        open.pages.insert(page, sender);
        Some((page, receiver))
    }

    pub(crate) fn remove(&self, page: PageId) {
        self.open().pages.remove(&page);
    }

    pub(crate) fn is_open(&self, page: PageId) -> bool {
        self.open().pages.contains_key(&page)
    }

    pub(crate) fn count(&self) -> usize {
        self.open().pages.len()
    }

    /// The number of pages that ever were open.
    pub(crate) fn ever(&self) -> u64 {
        self.open().ever
    }

    /// Sends a message to a page; closes it if too many wait.
    pub(crate) fn send(&self, page: PageId, message: impl Into<Out>) {
        let mut open = self.open();
        let Some(sender) = open.pages.get(&page) else { return };
        let message = message.into();
        let waiting = sender.max_capacity() - sender.capacity();
        let is_too_large = matches!(message, Out::Binary(_)) && waiting >= LARGE_WAITING;
        if is_too_large || sender.try_send(message).is_err() {
            open.pages.remove(&page);
        }
    }

    /// Sends a message to all pages.
    pub(crate) fn broadcast(&self, message: impl Into<Out>) {
        let message = message.into();
        self.open().pages.retain(|_, sender| sender.try_send(message.clone()).is_ok());
    }

    /// Answers a question that has a number.
    pub(crate) fn answer(&self, page: PageId, id: Option<u32>, mut answer: Value) {
        if let Some(id) = id {
            answer["id"] = id.into();
            self.send(page, &answer);
        }
    }

    /// Refuses a message, whether it has a number or not.
    pub(crate) fn refuse(&self, page: PageId, id: Option<u32>, why: &str, problems: &[Value]) {
        let mut refusal = json!({ "do": "refused", "message": why });
        if !problems.is_empty() {
            refusal["problems"] = problems.into();
        }
        if let Some(id) = id {
            refusal["id"] = id.into();
        }
        self.send(page, &refusal);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_that_takes_nothing_is_closed_and_others_stay() {
        let pages = Pages::default();
        let (slow, mut left) = pages.add(2).unwrap();
        let (fast, mut taken) = pages.add(2).unwrap();
        assert!(pages.add(2).is_none());
        for _ in 0..=WAITING {
            pages.broadcast(&json!({ "do": "notice" }));
            assert!(taken.try_recv().is_ok());
        }
        assert_eq!((pages.count(), pages.ever()), (1, 2));
        pages.answer(fast, Some(3), json!({ "do": "done" }));
        let Ok(Out::Text(answer)) = taken.try_recv() else { panic!("an answer") };
        assert_eq!(answer.as_str(), r#"{"do":"done","id":3}"#);
        pages.send(slow, &json!({}));
        assert_eq!((0..).take_while(|_| left.try_recv().is_ok()).count(), WAITING);
        assert!(left.is_closed());
    }
}
