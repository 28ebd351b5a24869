// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Handing over boxes between two threads, neither of which waits for the other.
//!
//! All of it stands on one primitive, a [`Place`] whose box is exchanged in one step. A box is
//! owned by one thread at a time, so nobody sees half of what is in it; what remains to be shown
//! is that nothing is lost, late or freed at the wrong end. `model.rs` does, for every
//! interleaving, on places of a model checker.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crossbeam_utils::atomic::AtomicCell;

/// A box or none, which threads exchange for another. What a thread did before it put a box
/// there is seen by the thread that gets it.
pub(crate) trait Place<T>: Send + Sync {
    fn holding(content: Option<Box<T>>) -> Self;

    /// Puts `content` there; what was there before.
    fn exchange(&self, content: Option<Box<T>>) -> Option<Box<T>>;
}

/// Something that is so or not. What a thread did before it set it is seen by the thread that
/// sees it set.
pub(crate) trait Flag: Default + Send + Sync {
    fn set(&self, is_set: bool);
    fn is_set(&self) -> bool;
}

/// What threads share: the machine's atomic operations, or those of a model of them.
pub(crate) trait Medium {
    type Place<T: Send>: Place<T>;
    type Flag: Flag;
}

/// The machine.
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

/// A value and which publication it is, from 1; 0 if none.
#[derive(Clone)]
pub(crate) struct Edition<T> {
    number: u64,
    value: T,
}

/// Publishes values of which the latest counts.
pub(crate) struct Writer<T: Send, M: Medium = Native> {
    place: Arc<M::Place<Edition<T>>>,
    /// Always there but for the moment of an exchange.
    draft: Option<Box<Edition<T>>>,
    number: u64,
}

/// Reads the latest value.
pub(crate) struct Reader<T: Send, M: Medium = Native> {
    place: Arc<M::Place<Edition<T>>>,
    /// Always there but for the moment of an exchange.
    seen: Option<Box<Edition<T>>>,
}

/// The two ends of a value of which the latest counts: three boxes that go round, one with the
/// writer, one with the reader, one between them.
pub(crate) fn latest<T: Clone + Send, M: Medium>(value: T) -> (Writer<T, M>, Reader<T, M>) {
    let edition = Box::new(Edition { number: 0, value });
    let place = Arc::new(M::Place::holding(Some(edition.clone())));
    let writer = Writer { place: place.clone(), draft: Some(edition.clone()), number: 0 };
    (writer, Reader { place, seen: Some(edition) })
}

impl<T: Send, M: Medium> Writer<T, M> {
    /// Publishes what `fill` makes of an older value.
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
    /// What was published last; `None` if nothing was.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub(crate) fn latest(&mut self) -> Option<&T> {
        let number = self.seen.as_ref().map(|edition| edition.number);
        let other = self.place.exchange(self.seen.take());
        self.seen = if other.as_ref().map(|edition| edition.number) > number {
            other
        } else {
            // An older one was there; for that, what was seen comes back, or news of this moment.
            self.place.exchange(other)
        };
        self.seen.as_ref().filter(|edition| edition.number > 0).map(|edition| &edition.value)
    }
}

/// Something sent, and what was returned before it.
#[derive(Default)]
pub(crate) struct Parcel<T> {
    pub(crate) content: T,
    below: Option<Box<Parcel<T>>>,
}

struct Counter<T: Send, M: Medium> {
    /// Sent, and not taken yet.
    inbox: M::Place<Parcel<T>>,
    /// Taken and given back, the last on top.
    returned: M::Place<Parcel<T>>,
}

/// Sends edits. What was not taken yet is edited further, so that the receiver finds all edits
/// at once or none.
pub(crate) struct Sender<T: Send, M: Medium = Native> {
    counter: Arc<Counter<T, M>>,
    /// To be sent again.
    spare: Option<Box<Parcel<T>>>,
}

/// Takes edits, and gives back what it took: it allocates and frees nothing.
pub(crate) struct Receiver<T: Send, M: Medium = Native> {
    counter: Arc<Counter<T, M>>,
}

/// The two ends of a way for edits.
pub(crate) fn counter<T: Send, M: Medium>() -> (Sender<T, M>, Receiver<T, M>) {
    let (inbox, returned) = (M::Place::holding(None), M::Place::holding(None));
    let counter = Arc::new(Counter { inbox, returned });
    (Sender { counter: counter.clone(), spare: None }, Receiver { counter })
}

impl<T: Default + Send, M: Medium> Sender<T, M> {
    /// Adds to what the receiver finds next.
    pub(crate) fn edit(&mut self, edit: impl FnOnce(&mut T)) {
        let unseen = self.counter.inbox.exchange(None);
        let mut parcel = unseen.or_else(|| self.spare.take()).unwrap_or_default();
        edit(&mut parcel.content);
        // Nobody else puts anything there: nothing comes back.
        self.counter.inbox.exchange(Some(parcel));
    }

    /// Looks at everything that was given back, the last first, and keeps a box to be sent
    /// again, with what `look` leaves in it.
    pub(crate) fn collect(&mut self, mut look: impl FnMut(&mut T)) {
        let mut top = self.counter.returned.exchange(None);
        while let Some(mut parcel) = top {
            top = parcel.below.take();
            look(&mut parcel.content);
            self.spare = Some(parcel);
        }
    }
}

impl<T: Send, M: Medium> Receiver<T, M> {
    /// All edits since the last time.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub(crate) fn take(&mut self) -> Option<Box<Parcel<T>>> {
        self.counter.inbox.exchange(None)
    }

    /// Gives back what was taken, with what is to be dropped by the sender.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub(crate) fn give_back(&mut self, mut parcel: Box<Parcel<T>>) {
        parcel.below = self.counter.returned.exchange(None);
        // Nobody else puts anything there: nothing comes back, and nothing is freed here.
        self.counter.returned.exchange(Some(parcel));
    }
}
