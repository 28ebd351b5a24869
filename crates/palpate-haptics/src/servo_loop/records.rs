// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rows of a running servo, for another thread: a queue between one writer and one reader that
//! makes neither wait.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::recorder::TraceRow;

/// The rows that a running servo records, to be taken by another thread.
///
/// The servo writes a row for each tick and contact point, and never waits. A row that finds the
/// queue full is lost, and [counted](Self::lost): take rows before so many are recorded as the
/// queue has room for. [`ServoThread::take_records`](super::ServoThread::take_records) shows how.
pub struct Records {
    rows: rtrb::Consumer<TraceRow>,
    lost: Arc<AtomicU64>,
}

impl Records {
    /// Takes the rows recorded until now, in order of time, then of contact point. Rows that are
    /// recorded meanwhile wait for the next call; those that the caller leaves in the iterator
    /// too.
    pub fn take(&mut self) -> impl Iterator<Item = TraceRow> {
        (0..self.rows.slots()).map_while(|_| self.rows.pop().ok())
    }

    /// The number of rows lost so far because the queue was full. The rows around a gap tell
    /// where it is: their times differ by more than a tick.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }

    /// `true` if no row will be recorded any more; rows may be left.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.rows.is_abandoned()
    }
}

impl fmt::Debug for Records {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Records")
            .field("rows", &self.rows.slots())
            .field("lost", &self.lost())
            .finish()
    }
}

/// The servo's end of a queue of rows.
pub(crate) struct RowQueue {
    rows: rtrb::Producer<TraceRow>,
    lost: Arc<AtomicU64>,
}

/// A queue with room for so many rows.
pub(crate) fn queue(capacity: usize) -> (RowQueue, Records) {
    let (producer, consumer) = rtrb::RingBuffer::new(capacity);
    let lost = Arc::new(AtomicU64::new(0));
    let records = Records { rows: consumer, lost: Arc::clone(&lost) };
    (RowQueue { rows: producer, lost }, records)
}

impl RowQueue {
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn push(&mut self, row: TraceRow) {
        if self.rows.push(row).is_err() {
            self.lost.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// The number of rows that found the queue full.
    pub(crate) fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use palpate_field::Vector;

    use super::*;

    fn row(number: u32) -> TraceRow {
        TraceRow::free(f64::from(number), 0, Vector([0.5, 0.25, 0.0]))
    }

    #[test]
    fn what_finds_no_room_is_counted_and_the_rest_is_in_order() {
        let (mut writer, mut reader) = queue(3);
        (0..5).for_each(|number| writer.push(row(number)));
        assert_eq!((reader.lost(), writer.lost()), (2, 2));
        let times: Vec<_> = reader.take().take(2).map(|row| row.time_s).collect();
        assert_eq!(times, [0.0, 1.0]);
        writer.push(row(5));
        assert!(!reader.has_ended());
        drop(writer);
        assert!(reader.has_ended());
        assert_eq!(reader.take().map(|row| row.time_s).collect::<Vec<_>>(), [2.0, 5.0]);
        assert_eq!((reader.take().count(), reader.lost()), (0, 2));
    }

    #[test]
    fn two_threads_lose_no_row_unnoticed() {
        const ROWS: u32 = 20_000;
        let (mut writer, mut reader) = queue(64);
        let writing = std::thread::spawn(move || (0..ROWS).for_each(|i| writer.push(row(i))));
        let mut times = Vec::new();
        loop {
            // Read before the rows, so that the last rows are not missed.
            let is_last = reader.has_ended();
            times.extend(reader.take().map(|row| row.time_s));
            if is_last {
                break;
            }
        }
        writing.join().unwrap();
        assert!(times.is_sorted_by(|before, after| before < after));
        assert_eq!(times.len() as u64 + reader.lost(), u64::from(ROWS));
    }
}
