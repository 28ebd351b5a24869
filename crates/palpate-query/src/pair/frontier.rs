// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Boxes still to be looked at, the one of which least is known first.

use std::collections::BinaryHeap;

use super::cell::Cell;

/// Boxes in a heap. What moves in the heap is a bound and a place alone: boxes themselves
/// are four times as large.
#[derive(Clone, Debug)]
pub(crate) struct Frontier<const D: usize> {
    heap: BinaryHeap<Key>,
    cells: Vec<Cell<D>>,
    /// Places in `cells` that are free.
    free: Vec<u32>,
    room: usize,
    /// By how much all bounds in the heap are too large.
    drift: f64,
}

/// A box's lower bound, in the upper half, and its place: all bits turned over, so that the
/// least bound, and of equal ones the first place, is the largest key. One number, since a heap
/// that compares numbers needs no branches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key(u128);

/// The sign of a double.
const SIGN: u64 = 1 << 63;

impl Key {
    #[inline]
    fn new(lower: f64, place: u32) -> Self {
        // As [`f64::total_cmp`] orders: negative numbers backwards, before the others.
        let bits = lower.to_bits();
        let ordered = bits ^ if bits & SIGN == 0 { SIGN } else { u64::MAX };
        Self(!(u128::from(ordered) << 64 | u128::from(place)))
    }

    #[inline]
    fn lower(self) -> f64 {
        let ordered = (!self.0 >> 64) as u64;
        f64::from_bits(ordered ^ if ordered & SIGN == 0 { u64::MAX } else { SIGN })
    }

    #[inline]
    fn place(self) -> u32 {
        !self.0 as u32
    }
}

impl<const D: usize> Frontier<D> {
    /// Room for so many boxes, of which `now` are allocated.
    pub(crate) fn new(room: usize, now: usize) -> Self {
        Self {
            heap: BinaryHeap::with_capacity(now),
            cells: Vec::with_capacity(now),
            free: Vec::with_capacity(now),
            room,
            drift: 0.0,
        }
    }

    /// Lowers the bounds of all boxes.
    pub(crate) fn lower_all(&mut self, by: f64) {
        self.drift += by;
    }

    pub(crate) fn clear(&mut self) {
        self.heap.clear();
        self.cells.clear();
        self.free.clear();
        self.drift = 0.0;
    }

    pub(crate) fn len(&self) -> usize {
        self.heap.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.heap.is_empty()
    }

    /// `true` if there is room for `more` boxes.
    pub(crate) fn has_room(&self, more: usize) -> bool {
        self.len() + more <= self.room
    }

    /// The least of the lower bounds; infinite if there are no boxes.
    pub(crate) fn lowest(&self) -> f64 {
        self.heap.peek().map_or(f64::INFINITY, |key| key.lower() - self.drift)
    }

    #[inline]
    pub(crate) fn push(&mut self, cell: Cell<D>) {
        let place = match self.free.pop() {
            Some(place) => {
                self.cells[place as usize] = cell;
                place
            }
            None => {
                self.cells.push(cell);
                self.cells.len() as u32 - 1
            }
        };
        self.heap.push(Key::new(cell.lower + self.drift, place));
    }

    #[inline]
    pub(crate) fn pop(&mut self) -> Option<Cell<D>> {
        let key = self.heap.pop()?;
        self.free.push(key.place());
        Some(Cell { lower: key.lower() - self.drift, ..self.cells[key.place() as usize] })
    }

    /// Takes all boxes out, in no order.
    pub(crate) fn drain(&mut self) -> impl Iterator<Item = Cell<D>> {
        let (cells, drift) = (&self.cells, self.drift);
        self.heap
            .drain()
            .map(move |key| Cell { lower: key.lower() - drift, ..cells[key.place() as usize] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_bound_comes_first_and_of_equal_ones_the_first_place() {
        let bounds = [2.0, -1.5, f64::INFINITY, 0.0, -0.0, f64::NEG_INFINITY, -1.5, 1e-300];
        let mut keys: Vec<Key> = (0..8).map(|i| Key::new(bounds[i], i as u32)).collect();
        keys.sort_by(|a, b| b.cmp(a));
        let mut expected: Vec<usize> = (0..8).collect();
        expected.sort_by(|&a, &b| bounds[a].total_cmp(&bounds[b]).then(a.cmp(&b)));
        for (key, place) in keys.into_iter().zip(expected) {
            assert_eq!(key.place() as usize, place);
            assert_eq!(key.lower().to_bits(), bounds[place].to_bits());
        }
    }
}
