// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Boxes still to be looked at, the one of which least is known first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::cell::Cell;

/// Boxes in a heap. What moves in the heap is a bound and a place alone: boxes themselves
/// are four times as large.
#[derive(Debug)]
pub(crate) struct Frontier<const D: usize> {
    heap: BinaryHeap<Key>,
    cells: Vec<Cell<D>>,
    /// Places in `cells` that are free.
    free: Vec<u32>,
    room: usize,
}

/// A box's lower bound and its place.
#[derive(Clone, Copy, Debug)]
struct Key {
    lower: f64,
    place: u32,
}

impl<const D: usize> Frontier<D> {
    /// Room for so many boxes.
    pub(crate) fn new(room: usize) -> Self {
        Self {
            heap: BinaryHeap::with_capacity(room),
            cells: Vec::with_capacity(room),
            free: Vec::with_capacity(room),
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

    pub(crate) fn is_empty(&self) -> bool {
        self.heap.is_empty()
    }

    /// `true` if there is room for `more` boxes.
    pub(crate) fn has_room(&self, more: usize) -> bool {
        self.len() + more <= self.room
    }

    /// The least of the lower bounds; infinite if there are no boxes.
    pub(crate) fn lowest(&self) -> f64 {
        self.heap.peek().map_or(f64::INFINITY, |key| key.lower)
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
        self.heap.push(Key { lower: cell.lower, place });
    }

    #[inline]
    pub(crate) fn pop(&mut self) -> Option<Cell<D>> {
        let Key { place, .. } = self.heap.pop()?;
        self.free.push(place);
        Some(self.cells[place as usize])
    }

    /// Takes all boxes out, in no order.
    pub(crate) fn drain(&mut self) -> impl Iterator<Item = Cell<D>> {
        let cells = &self.cells;
        self.heap.drain().map(|key| cells[key.place as usize])
    }
}

/// The box of which least is known comes first.
impl Ord for Key {
    #[inline]
    fn cmp(&self, other: &Self) -> Ordering {
        other.lower.total_cmp(&self.lower).then(other.place.cmp(&self.place))
    }
}

impl PartialOrd for Key {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Key {}
