// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The order of cells in a heap.

use std::cmp::Ordering;

use crate::engine::Bounded;

/// A cell of a [`BinaryHeap`](std::collections::BinaryHeap) that gives the cell with the least bound first.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeastFirst<C>(pub(super) C);

impl<C: Bounded> PartialEq for LeastFirst<C> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<C: Bounded> Eq for LeastFirst<C> {}

impl<C: Bounded> PartialOrd for LeastFirst<C> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<C: Bounded> Ord for LeastFirst<C> {
    fn cmp(&self, other: &Self) -> Ordering {
        other.0.lower().total_cmp(&self.0.lower())
    }
}
