// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Boxes still to be looked at, the one of which least is known first.

use std::cmp::Ordering;
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

/// A box's lower bound and its place.
#[derive(Clone, Copy, Debug)]
struct Key {
    lower: f64,
    place: u32,
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
        self.heap.peek().map_or(f64::INFINITY, |key| key.lower - self.drift)
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
        self.heap.push(Key { lower: cell.lower + self.drift, place });
    }

    #[inline]
    pub(crate) fn pop(&mut self) -> Option<Cell<D>> {
        let Key { lower, place } = self.heap.pop()?;
        self.free.push(place);
        Some(Cell { lower: lower - self.drift, ..self.cells[place as usize] })
    }

    /// Takes all boxes out, in no order.
    pub(crate) fn drain(&mut self) -> impl Iterator<Item = Cell<D>> {
        let (cells, drift) = (&self.cells, self.drift);
        self.heap.drain().map(move |Key { lower, place }| Cell {
            lower: lower - drift,
            ..cells[place as usize]
        })
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
