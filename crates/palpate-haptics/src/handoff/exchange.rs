// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Wait-free exchange of boxes between two threads.
//!
//! The one primitive is a [`Place`], whose box is exchanged atomically. One thread at a time
//! owns a box, so no thread sees a half-written content. `model.rs` checks every interleaving
//! with a model checker: no content is lost, late, or freed on the servo's thread.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crossbeam_utils::atomic::AtomicCell;

/// An optional box that threads exchange atomically. Everything a thread did before it put a
/// box there is visible to the thread that takes the box.
pub(crate) trait Place<T>: Send + Sync {
    fn holding(content: Option<Box<T>>) -> Self;

    /// Stores `content` and returns the previous content.
    fn exchange(&self, content: Option<Box<T>>) -> Option<Box<T>>;
}

/// An atomic boolean. Everything a thread did before it set the flag is visible to a thread
/// that reads the flag as set.
pub(crate) trait Flag: Default + Send + Sync {
    fn set(&self, is_set: bool);
    fn is_set(&self) -> bool;
}

/// The atomic operations in use: the machine's, or those of the model checker.
pub(crate) trait Medium {
    type Place<T: Send>: Place<T>;
    type Flag: Flag;
}

/// The machine's atomic operations.
pub(crate) struct Native;

impl Medium for Native {
    type Place<T: Send> = AtomicCell<Option<Box<T>>>;
    type Flag = AtomicBool;
}

impl<T: Send> Place<T> for AtomicCell<Option<Box<T>>> {
    fn holding(content: Option<Box<T>>) -> Self {
        // A pointer is exchanged by one instruction; a wider value would be under a lock.
        const { assert!(AtomicCell::<Option<Box<T>>>::is_lock_free()) }
        Self::new(content)
    }

    fn exchange(&self, content: Option<Box<T>>) -> Option<Box<T>> {
        self.swap(content)
    }
}

impl Flag for AtomicBool {
    fn set(&self, is_set: bool) {
        self.store(is_set, Ordering::Release);
    }

    fn is_set(&self) -> bool {
        self.load(Ordering::Acquire)
    }
}

/// A value with the number of its publication, counted from 1; 0 before the first.
#[derive(Clone)]
pub(crate) struct Edition<T> {
    number: u64,
    value: T,
}

/// The writing end of a triple buffer.
pub(crate) struct Writer<T: Send, M: Medium = Native> {
    place: Arc<M::Place<Edition<T>>>,
    /// `Some` except during an exchange.
    draft: Option<Box<Edition<T>>>,
    number: u64,
}

/// The reading end of a triple buffer.
pub(crate) struct Reader<T: Send, M: Medium = Native> {
    place: Arc<M::Place<Edition<T>>>,
    /// `Some` except during an exchange.
    seen: Option<Box<Edition<T>>>,
}

/// The two ends of a triple buffer: one box belongs to the writer, one to the reader, one is in
/// transit. The reader gets the latest value only.
pub(crate) fn latest<T: Clone + Send, M: Medium>(value: T) -> (Writer<T, M>, Reader<T, M>) {
    let edition = Box::new(Edition { number: 0, value });
    let place = Arc::new(M::Place::holding(Some(edition.clone())));
    let writer = Writer { place: place.clone(), draft: Some(edition.clone()), number: 0 };
    (writer, Reader { place, seen: Some(edition) })
}

impl<T: Send, M: Medium> Writer<T, M> {
    /// Publishes a value; `fill` overwrites an older one.
    ///
    /// Real-time, if `fill` is: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub(crate) fn publish(&mut self, fill: impl FnOnce(&mut T)) {
        let Some(mut draft) = self.draft.take() else { return };
        fill(&mut draft.value);
        self.number += 1;
        draft.number = self.number;
        self.draft = self.place.exchange(Some(draft));
    }
}

impl<T: Send, M: Medium> Reader<T, M> {
    /// The value published last; `None` before the first publication.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub(crate) fn latest(&mut self) -> Option<&T> {
        let number = self.seen.as_ref().map(|edition| edition.number);
        let other = self.place.exchange(self.seen.take());
        self.seen = if other.as_ref().map(|edition| edition.number) > number {
            other
        } else {
            // The place held an older edition. Exchange again: this returns the edition just
            // seen, or a newer one.
            self.place.exchange(other)
        };
        self.seen.as_ref().filter(|edition| edition.number > 0).map(|edition| &edition.value)
    }
}

/// A box that was sent, linked to the box returned before it.
#[derive(Default)]
pub(crate) struct Parcel<T> {
    pub(crate) content: T,
    below: Option<Box<Parcel<T>>>,
}

struct EditChannel<T: Send, M: Medium> {
    /// Sent, but not yet taken.
    inbox: M::Place<Parcel<T>>,
    /// Taken and returned: a stack with the last one on top.
    returned: M::Place<Parcel<T>>,
}

/// The sending end for edits. An edit that was not taken yet is edited further, so that the
/// receiver gets all edits at once or none.
pub(crate) struct Sender<T: Send, M: Medium = Native> {
    channel: Arc<EditChannel<T, M>>,
    /// A returned box to reuse.
    spare: Option<Box<Parcel<T>>>,
}

/// The receiving end for edits. It returns every box to the sender, so it allocates and frees
/// nothing.
pub(crate) struct Receiver<T: Send, M: Medium = Native> {
    channel: Arc<EditChannel<T, M>>,
}

/// The two ends of a channel for edits.
pub(crate) fn edit_channel<T: Send, M: Medium>() -> (Sender<T, M>, Receiver<T, M>) {
    let (inbox, returned) = (M::Place::holding(None), M::Place::holding(None));
    let channel = Arc::new(EditChannel { inbox, returned });
    (Sender { channel: channel.clone(), spare: None }, Receiver { channel })
}

impl<T: Default + Send, M: Medium> Sender<T, M> {
    /// Edits what the receiver takes next.
    pub(crate) fn edit(&mut self, edit: impl FnOnce(&mut T)) {
        let unseen = self.channel.inbox.exchange(None);
        let mut parcel = unseen.or_else(|| self.spare.take()).unwrap_or_default();
        edit(&mut parcel.content);
        // Only the sender fills the inbox, so the exchange returns `None`.
        self.channel.inbox.exchange(Some(parcel));
    }

    /// Calls `look` for every returned box, the last first, and keeps one box for reuse, with
    /// the content that `look` leaves in it.
    pub(crate) fn collect(&mut self, mut look: impl FnMut(&mut T)) {
        let mut top = self.channel.returned.exchange(None);
        while let Some(mut parcel) = top {
            top = parcel.below.take();
            look(&mut parcel.content);
            self.spare = Some(parcel);
        }
    }
}

impl<T: Send, M: Medium> Receiver<T, M> {
    /// Takes all edits since the last call.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub(crate) fn take(&mut self) -> Option<Box<Parcel<T>>> {
        self.channel.inbox.exchange(None)
    }

    /// Returns a box to the sender, with content that the sender must drop.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub(crate) fn give_back(&mut self, mut parcel: Box<Parcel<T>>) {
        parcel.below = self.channel.returned.exchange(None);
        // Only the receiver fills this place and it is empty now, so the exchange returns
        // `None` and frees nothing.
        self.channel.returned.exchange(Some(parcel));
    }
}
