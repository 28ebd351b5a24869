// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What another thread may see of a running servo, without making it wait.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// How often a reader tries again while the servo writes. A write takes nanoseconds; a reader
/// that meets it this often has lost nothing by showing the numbers a moment later.
const TRIES: u32 = 1000;

/// A running servo, some ticks ago.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Ticks done.
    pub ticks: u64,
    /// The time of the servo [s].
    pub time: f64,
    /// The largest force on a contact point in the last tick [N].
    pub force: f64,
    /// The largest depth a contact point is pressed to [m].
    pub depth: f64,
    /// How many points are in contact.
    pub contacts: u64,
    /// Evaluations of the shape in the last tick.
    pub evaluations: u64,
    /// What the last tick cost [ns].
    pub cost_ns: u64,
}

/// The latest [`Progress`], written by the servo and read by anybody.
///
/// A sequence lock (Lameter 2005): the writer never waits; a reader that sees the sequence
/// change, or odd, reads again.
#[derive(Debug, Default)]
pub(crate) struct Live {
    sequence: AtomicU64,
    fields: [AtomicU64; 7],
    finished: AtomicBool,
}

impl Live {
    /// Shows `progress` to readers. One writer at a time.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn publish(&self, progress: &Progress) {
        let sequence = self.sequence.load(Ordering::Relaxed);
        self.sequence.store(sequence.wrapping_add(1), Ordering::Relaxed);
        // The odd number is seen before any field changes.
        std::sync::atomic::fence(Ordering::Release);
        for (field, bits) in self.fields.iter().zip(to_bits(progress)) {
            field.store(bits, Ordering::Relaxed);
        }
        self.sequence.store(sequence.wrapping_add(2), Ordering::Release);
    }

    /// What was published last; `None` if the writer kept interfering.
    pub(crate) fn latest(&self) -> Option<Progress> {
        for _ in 0..TRIES {
            let before = self.sequence.load(Ordering::Acquire);
            let bits = std::array::from_fn(|i| self.fields[i].load(Ordering::Relaxed));
            // The fields are read before the number is read again.
            std::sync::atomic::fence(Ordering::Acquire);
            let after = self.sequence.load(Ordering::Relaxed);
            if before == after && before.is_multiple_of(2) {
                return Some(from_bits(bits));
            }
            std::hint::spin_loop();
        }
        None
    }

    /// Tells readers that nothing more will come.
    pub(crate) fn finish(&self) {
        self.finished.store(true, Ordering::Release);
    }

    pub(crate) fn is_finished(&self) -> bool {
        self.finished.load(Ordering::Acquire)
    }
}

fn to_bits(p: &Progress) -> [u64; 7] {
    let (time, force, depth) = (p.time.to_bits(), p.force.to_bits(), p.depth.to_bits());
    [p.ticks, time, force, depth, p.contacts, p.evaluations, p.cost_ns]
}

fn from_bits(
    [ticks, time, force, depth, contacts, evaluations, cost_ns]: [u64; 7],
) -> Progress {
    let (time, force, depth) =
        (f64::from_bits(time), f64::from_bits(force), f64::from_bits(depth));
    Progress { ticks, time, force, depth, contacts, evaluations, cost_ns }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readers_never_see_half_a_tick() {
        let live = Live::default();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                for ticks in 1..=200_000_u64 {
                    let time = ticks as f64;
                    let (evaluations, cost_ns) = (ticks, ticks);
                    let progress =
                        Progress { ticks, time, evaluations, cost_ns, ..Progress::default() };
                    live.publish(&progress);
                }
                live.finish();
            });
            while !live.is_finished() {
                if let Some(p) = live.latest() {
                    assert_eq!(p.time, p.ticks as f64);
                    assert_eq!((p.evaluations, p.cost_ns), (p.ticks, p.ticks));
                }
            }
        });
        assert_eq!(live.latest().unwrap().ticks, 200_000);
    }
}
