// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A value of which the newest counts, from one thread to another.

use std::fmt;
use std::sync::Arc;

use crate::place::Place;

/// A value with the number of its publication, counted from 1; 0 before the first.
#[derive(Clone)]
struct Edition<T> {
    number: u64,
    value: T,
}

/// The end of a [`latest_value`] that sets it.
pub struct LatestWriter<T: Send> {
    place: Arc<Place<Edition<T>>>,
    /// `Some` except during an exchange.
    draft: Option<Box<Edition<T>>>,
    number: u64,
}

/// The end of a [`latest_value`] that reads it.
pub struct LatestReader<T: Send> {
    place: Arc<Place<Edition<T>>>,
    /// `Some` except during an exchange.
    seen: Option<Box<Edition<T>>>,
}

/// The two ends of a value of which the newest counts, for two threads that never wait for each
/// other. It is a triple buffer: one copy of `value` belongs to the writer, one to the reader, one is
/// in transit. Setting and reading allocate nothing.
///
/// ```
/// use palpate_device::latest_value;
///
/// let (mut writer, mut reader) = latest_value(0);
/// assert_eq!(reader.latest(), None);
/// writer.set(|value| *value = 3);
/// writer.set(|value| *value = 7);
/// assert_eq!(reader.latest(), Some(&7));
/// assert_eq!(reader.latest(), Some(&7)); // until there is a newer one
/// ```
#[must_use]
pub fn latest_value<T: Clone + Send>(value: T) -> (LatestWriter<T>, LatestReader<T>) {
    let edition = Box::new(Edition { number: 0, value });
    let place = Arc::new(Place::holding(Some(edition.clone())));
    let writer = LatestWriter { place: place.clone(), draft: Some(edition.clone()), number: 0 };
    (writer, LatestReader { place, seen: Some(edition) })
}

impl<T: Send> LatestWriter<T> {
    /// Publishes what `fill` makes of an older value, which may be any earlier one.
    ///
    /// Real-time, if `fill` is: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub fn set(&mut self, fill: impl FnOnce(&mut T)) {
        let Some(mut draft) = self.draft.take() else { return };
        fill(&mut draft.value);
        self.number += 1;
        draft.number = self.number;
        self.draft = self.place.exchange(Some(draft));
    }
}

impl<T: Send> LatestReader<T> {
    /// The newest value; `None` before the first.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn latest(&mut self) -> Option<&T> {
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

impl<T: Send> fmt::Debug for LatestWriter<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LatestWriter").finish_non_exhaustive()
    }
}

impl<T: Send> fmt::Debug for LatestReader<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LatestReader").finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use loom::thread;

    use super::*;

    #[test]
    fn readers_see_the_latest_whole_and_in_order() {
        loom::model(|| {
            let (mut writer, mut reader) = latest_value([0_u32; 2]);
            let writing = thread::spawn(move || {
                for number in 1..=4 {
                    writer.set(|value| value.fill(number));
                }
            });
            let mut before = 0;
            for _ in 0..3 {
                let [a, b] = reader.latest().copied().unwrap_or_default();
                assert!(a == b && a >= before, "{a} {b} after {before}");
                before = a;
            }
            writing.join().unwrap();
            assert_eq!(reader.latest(), Some(&[4, 4]));
            assert_eq!(reader.latest(), Some(&[4, 4]));
        });
    }
}
