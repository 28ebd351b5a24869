// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A queue in a heap, for thousands of cells.

use std::collections::BinaryHeap;

use super::{Bounded, Queue};

/// A cell whose bound can be replaced.
pub(crate) trait Rebound: Bounded + Copy {
    /// The same cell with another lower bound [m].
    fn with_lower(&self, lower: f64) -> Self;
}

/// Cells in a heap. The heap moves bounds and places alone: cells are four times as large.
#[derive(Clone, Debug)]
pub(crate) struct Heap<C> {
    heap: BinaryHeap<Key>,
    cells: Vec<C>,
    /// Places in `cells` that are free.
    free: Vec<u32>,
    room: usize,
}

/// A cell's lower bound, in the upper half, and its place. All bits are inverted, so that the
/// least bound, and of equal bounds the first place, is the largest key. One number, since a
/// heap that compares numbers needs no branches.
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

impl<C: Rebound> Heap<C> {
    /// Room for `room` cells, of which `now` are allocated.
    pub(crate) fn new(room: usize, now: usize) -> Self {
        Self {
            heap: BinaryHeap::with_capacity(now),
            cells: Vec::with_capacity(now),
            free: Vec::with_capacity(now),
            room,
        }
    }

    pub(crate) fn clear(&mut self) {
        self.heap.clear();
        self.cells.clear();
        self.free.clear();
    }

    pub(crate) fn len(&self) -> usize {
        self.heap.len()
    }

    /// `true` if there is room for `more` cells.
    pub(crate) fn has_room(&self, more: usize) -> bool {
        self.len() + more <= self.room
    }

    /// All cells, in no order.
    pub(crate) fn cells(&self) -> impl Iterator<Item = C> {
        let cell = |key: &Key| self.cells[key.place() as usize].with_lower(key.lower());
        self.heap.iter().map(cell)
    }
}

impl<C: Rebound> Queue for Heap<C> {
    type Cell = C;

    #[inline]
    fn least(&self) -> f64 {
        self.heap.peek().map_or(f64::INFINITY, |key| key.lower())
    }

    #[inline]
    fn take_least(&mut self, then: impl FnOnce(&C)) -> bool {
        let Some(key) = self.heap.pop() else { return false };
        self.free.push(key.place());
        then(&self.cells[key.place() as usize].with_lower(key.lower()));
        true
    }

    #[inline]
    fn push(&mut self, cell: &C) {
        let place = match self.free.pop() {
            Some(place) => {
                self.cells[place as usize] = *cell;
                place
            }
            None => {
                self.cells.push(*cell);
                self.cells.len() as u32 - 1
            }
        };
        self.heap.push(Key::new(cell.lower(), place));
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
