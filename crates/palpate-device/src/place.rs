// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The one primitive of the exchanges between threads.

/// An optional box that threads exchange atomically. Everything a thread did before it put a
/// box there is visible to the thread that takes the box.
///
/// One thread at a time owns a box, so no thread sees a half-written content. In this crate's own
/// tests a model checker explores every interleaving: there the place is a mutex of loom.
#[cfg(not(test))]
pub(crate) struct Place<T>(crossbeam_utils::atomic::AtomicCell<Option<Box<T>>>);

#[cfg(not(test))]
impl<T> Place<T> {
    pub(crate) fn holding(content: Option<Box<T>>) -> Self {
        // A pointer is exchanged by one instruction; a wider value would be under a lock.
        const {
            assert!(crossbeam_utils::atomic::AtomicCell::<Option<Box<T>>>::is_lock_free());
        }
        Self(crossbeam_utils::atomic::AtomicCell::new(content))
    }

    /// Stores `content` and returns the previous content.
    pub(crate) fn exchange(&self, content: Option<Box<T>>) -> Option<Box<T>> {
        self.0.swap(content)
    }
}

#[cfg(test)]
pub(crate) struct Place<T>(loom::sync::Mutex<Option<Box<T>>>);

#[cfg(test)]
impl<T> Place<T> {
    pub(crate) fn holding(content: Option<Box<T>>) -> Self {
        Self(loom::sync::Mutex::new(content))
    }

    /// One atomic step, like the machine's exchange of a pointer.
    #[allow(clippy::unwrap_used, reason = "a poisoned mutex fails the test")]
    pub(crate) fn exchange(&self, content: Option<Box<T>>) -> Option<Box<T>> {
        std::mem::replace(&mut *self.0.lock().unwrap(), content)
    }
}
