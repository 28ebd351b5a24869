// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A value of which the newest counts, from one thread to another.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt;

use super::exchange::{Reader, Writer, latest};

/// The end of a [`latest_value`] that sets it.
pub struct LatestWriter<T: Send>(Writer<T>);

/// The end of a [`latest_value`] that reads it.
pub struct LatestReader<T: Send>(Reader<T>);

/// The two ends of a value of which the newest counts, for two threads that never wait for each
/// other. Three copies of `value` go round between them: setting and reading allocate nothing.
///
/// ```
/// use palpate_haptics::latest_value;
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
    let (writer, reader) = latest(value);
    (LatestWriter(writer), LatestReader(reader))
}

impl<T: Send> LatestWriter<T> {
    /// Publishes what `fill` makes of an older value, which may be any of those before.
    ///
    /// Real-time, if `fill` is: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub fn set(&mut self, fill: impl FnOnce(&mut T)) {
        self.0.publish(fill);
    }
}

impl<T: Send> LatestReader<T> {
    /// The newest value; `None` before the first.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn latest(&mut self) -> Option<&T> {
        self.0.latest()
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
