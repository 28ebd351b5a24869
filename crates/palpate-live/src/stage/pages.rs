// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Pages.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use palpate::field::{Aabb, LARGEST_LENGTH, Point, Vector};
use palpate::scene::BuiltScene;
use tokio::sync::mpsc;
use tungstenite::{Bytes, Utf8Bytes};

use crate::wire::{Problem, Question, Told, Unreadable, written};

/// Messages that may wait for a page: a page that takes fewer is closed.
pub(crate) const WAITING: usize = 256;

/// The bytes that may wait for a page, beside one message: grids and pictures have up to 16 MiB.
const MOST_BYTES: usize = 32 << 20;

/// The most messages of a page that cannot be read.
const MOST_UNREADABLE: u32 = 10;

/// Why a page is closed that does not take its messages.
const TOO_SLOW: &str = "the page took its messages too slowly";

/// A message for a page.
#[derive(Clone, Debug)]
pub(crate) enum Out {
    Text(Utf8Bytes),
    Binary(Bytes),
    /// Bytes of the protocol below messages, such as the answer to a ping.
    Raw(Bytes),
}

impl Out {
    fn length(&self) -> usize {
        match self {
            Self::Text(text) => text.len(),
            Self::Binary(bytes) | Self::Raw(bytes) => bytes.len(),
        }
    }
}

impl From<Told<'_>> for Out {
    fn from(told: Told<'_>) -> Self {
        Self::Text(written(&told, None).into())
    }
}

/// An open page. Later pages have larger numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct PageId(u64);

impl PageId {
    /// No page that ever is open.
    pub(crate) const NONE: Self = Self(u64::MAX);
}

/// The open pages.
#[derive(Debug, Default)]
pub(crate) struct Pages(Mutex<Open>);

#[derive(Debug, Default)]
struct Open {
    pages: BTreeMap<PageId, Page>,
    /// The pages that ever were.
    ever: u64,
}

/// What is kept of a page.
#[derive(Debug)]
struct Page {
    sender: mpsc::Sender<Out>,
    /// The bytes that wait.
    bytes: Arc<AtomicUsize>,
    ending: Arc<OnceLock<String>>,
    is_hidden: Arc<AtomicBool>,
    unreadable: u32,
}

impl Page {
    /// Lets a message wait. `false` if there is no room for it.
    fn send(&self, message: Out) -> bool {
        let length = message.length();
        let before = self.bytes.fetch_add(length, Ordering::Relaxed);
        (before == 0 || before + length <= MOST_BYTES) && self.sender.try_send(message).is_ok()
    }
}

/// A page as its connection sees it.
#[derive(Debug)]
pub(crate) struct Opened {
    pub(crate) page: PageId,
    pub(crate) outbox: Outbox,
    /// The bytes of its messages that wait.
    pub(crate) waiting: Waiting,
}

/// What waits for a page.
#[derive(Debug)]
pub(crate) struct Outbox {
    messages: mpsc::Receiver<Out>,
    bytes: Arc<AtomicUsize>,
    ending: Arc<OnceLock<String>>,
    is_hidden: Arc<AtomicBool>,
}

impl Outbox {
    /// The next message; `None` once the page is closed.
    pub(crate) async fn next(&mut self) -> Option<Out> {
        let message = self.messages.recv().await?;
        self.bytes.fetch_sub(message.length(), Ordering::Relaxed);
        Some(message)
    }

    /// Why the page was closed, once no more messages come.
    pub(crate) fn why(&self) -> &str {
        self.ending.get().map_or(TOO_SLOW, String::as_str)
    }

    /// Whether the page is not seen.
    pub(crate) fn is_hidden(&self) -> bool {
        self.is_hidden.load(Ordering::Relaxed)
    }
}

impl Pages {
    // The state is valid even if a thread panicked while it held the lock.
    fn open(&self) -> MutexGuard<'_, Open> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a page; `None` if there are `most` already.
    pub(crate) fn add(&self, most: usize) -> Option<Opened> {
        let mut open = self.open();
        if open.pages.len() >= most {
            return None;
        }
        let (sender, messages) = mpsc::channel(WAITING);
        let page = PageId(open.ever);
        open.ever += 1;
        let (bytes, ending, is_hidden) = (Arc::default(), Arc::default(), Arc::default());
        let outbox = Outbox {
            messages,
            bytes: Arc::clone(&bytes),
            ending: Arc::clone(&ending),
            is_hidden: Arc::clone(&is_hidden),
        };
        open.pages.insert(page, Page { sender, bytes, ending, is_hidden, unreadable: 0 });
        Some(Opened { page, outbox, waiting: Waiting::default() })
    }

    pub(crate) fn remove(&self, page: PageId) {
        self.open().pages.remove(&page);
    }

    /// Closes a page, and tells it why.
    pub(crate) fn close(&self, page: PageId, why: String) {
        if let Some(page) = self.open().pages.remove(&page) {
            // The first reason counts.
            let _ = page.ending.set(why);
        }
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

    /// The open pages that came after the first `ever`.
    pub(crate) fn since(&self, ever: u64) -> Vec<PageId> {
        self.open().pages.range(PageId(ever)..).map(|(page, _)| *page).collect()
    }

    /// Sets whether a page is not seen.
    pub(crate) fn hide(&self, page: PageId, is_hidden: bool) {
        if let Some(page) = self.open().pages.get(&page) {
            page.is_hidden.store(is_hidden, Ordering::Relaxed);
        }
    }

    /// Sends a message to a page; closes it if too many wait.
    pub(crate) fn send(&self, page: PageId, message: impl Into<Out>) {
        let mut open = self.open();
        let Some(kept) = open.pages.get(&page) else { return };
        if !kept.send(message.into()) {
            open.pages.remove(&page);
        }
    }

    /// Sends a message to all pages.
    pub(crate) fn broadcast(&self, message: impl Into<Out>) {
        let message = message.into();
        self.open().pages.retain(|_, page| page.send(message.clone()));
    }

    /// Says that what a message with a number asks for is done.
    pub(crate) fn done(&self, page: PageId, id: Option<u32>) {
        if id.is_some() {
            self.send(page, Out::Text(written(&Told::Done, id).into()));
        }
    }

    /// Refuses a message, whether it has a number or not.
    pub(crate) fn refuse(
        &self,
        page: PageId,
        id: Option<u32>,
        why: &str,
        problems: &[Problem],
    ) {
        let refused = Told::Refused { message: why, problems };
        self.send(page, Out::Text(written(&refused, id).into()));
    }

    /// Refuses a message that cannot be read; closes a page that sends too many of them.
    pub(crate) fn not_read(&self, page: PageId, id: Option<u32>, why: &str) {
        let mut open = self.open();
        let Some(kept) = open.pages.get_mut(&page) else { return };
        kept.unreadable += 1;
        let is_last = kept.unreadable >= MOST_UNREADABLE;
        drop(open);
        if is_last {
            self.close(page, format!("{MOST_UNREADABLE} messages could not be read"));
        } else {
            self.refuse(page, id, why, &[]);
        }
    }
}

#[cfg(test)]
impl Opened {
    /// The page, and what it is sent.
    pub(crate) fn parts(self) -> (PageId, mpsc::Receiver<Out>) {
        (self.page, self.outbox.messages)
    }
}

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

/// A point of the page.
pub(super) fn point_of<const D: usize>(numbers: &[f64]) -> Result<Point<D>, String> {
    point_in_space(numbers, D).map(Vector::truncated)
}

/// A point of the page, of a scene of so many dimensions. One of the plane has z = 0.
pub(super) fn point_in_space(numbers: &[f64], dimension: usize) -> Result<Point<3>, String> {
    if numbers.len() != dimension {
        let given = numbers.len();
        return Err(format!("a point of this scene is {dimension} numbers, got {given}"));
    }
    let is_usable = |x: &f64| x.abs() <= LARGEST_LENGTH;
    match numbers.iter().find(|x| !is_usable(x)) {
        None => Ok(Vector(std::array::from_fn(|k| numbers.get(k).copied().unwrap_or(0.0)))),
        Some(x) => Err(format!("a coordinate is at most {LARGEST_LENGTH:e} m, got {x} m")),
    }
}

/// The longest edge of a scene's bounds [m]; 1 m for a scene without.
pub(super) fn size<const D: usize>(scene: &BuiltScene<D>) -> f64 {
    scene.bounds().as_ref().map_or(1.0, longest_edge).max(f64::MIN_POSITIVE)
}

/// The longest edge of a box [m].
pub(super) fn longest_edge<const D: usize>(bounds: &Aabb<D>) -> f64 {
    2.0 * bounds.half_extents().0.into_iter().fold(0.0, f64::max)
}

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
pub struct Watch(Option<Arc<dyn Fn(Work) + Send + Sync>>);

impl Watch {
    /// Calls this function.
    #[must_use]
    pub fn new(watch: impl Fn(Work) + Send + Sync + 'static) -> Self {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_that_takes_nothing_is_closed_and_others_stay() {
        let pages = Pages::default();
        let (slow, mut left) = pages.add(2).unwrap().parts();
        let (fast, mut taken) = pages.add(2).unwrap().parts();
        assert!(pages.add(2).is_none());
        for _ in 0..=WAITING {
            pages.broadcast(Told::Clients { count: 2 });
            assert!(taken.try_recv().is_ok());
        }
        assert_eq!((pages.count(), pages.ever()), (1, 2));
        assert_eq!((pages.since(0), pages.since(2)), (vec![fast], vec![]));
        pages.done(fast, Some(3));
        let Ok(Out::Text(answer)) = taken.try_recv() else { panic!("an answer") };
        assert_eq!(answer.as_str(), r#"{"do":"done","id":3}"#);
        pages.send(slow, Told::Done);
        assert_eq!((0..).take_while(|_| left.try_recv().is_ok()).count(), WAITING);
        assert!(left.is_closed());
    }

    #[test]
    fn a_page_is_told_why_it_is_closed() {
        let pages = Pages::default();
        let Opened { page, outbox, .. } = pages.add(1).unwrap();
        (1..MOST_UNREADABLE).for_each(|_| pages.not_read(page, None, "noise"));
        assert!(pages.is_open(page));
        pages.not_read(page, None, "noise");
        assert!(!pages.is_open(page));
        assert_eq!(outbox.why(), "10 messages could not be read");
        let Opened { page, outbox, .. } = pages.add(1).unwrap();
        pages.remove(page);
        assert_eq!(outbox.why(), TOO_SLOW);
    }

    /// Pages that read nothing once held a gigabyte of scenes.
    #[test]
    fn so_many_bytes_wait_for_a_page_and_no_more() {
        let pages = Pages::default();
        let Opened { page, outbox: _outbox, .. } = pages.add(1).unwrap();
        let bytes = |length: usize| Out::Binary(vec![0; length].into());
        // One message is always taken, however long it is.
        pages.send(page, bytes(MOST_BYTES + 1));
        assert!(pages.is_open(page));
        pages.send(page, bytes(1));
        assert!(!pages.is_open(page));
        let Opened { page, mut outbox, .. } = pages.add(1).unwrap();
        for _ in 0..3 {
            pages.send(page, bytes(MOST_BYTES));
            let taken = outbox.messages.try_recv().map(|message| message.length());
            outbox.bytes.fetch_sub(taken.unwrap(), Ordering::Relaxed);
        }
        assert!(pages.is_open(page));
    }
}

#[cfg(test)]
mod message_tests {
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
