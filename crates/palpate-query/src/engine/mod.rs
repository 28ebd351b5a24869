// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Branch and bound: the loop of every search, and its frontiers.
//!
//! Best-first branch and bound: the one loop that elements, balls, pairs and manifolds
//! share.
//!
//! A search divides what it searches into cells and proves a lower bound of each. The
//! least of the bounds is a bound of everything. A round takes the cells of least bound,
//! splits them, bounds the parts in blocks, and keeps those that may still matter; closed
//! cells leave only their bound behind. [`search`] reads top to bottom as exactly that. A
//! [`Problem`] says what a cell is, how a cell is split, how a round is bounded, which
//! cells are open, and when enough is known.
//!
//! The order of work is the problem's: its [`Queue`] is a heap where there are thousands
//! of cells ([`Heap`]), and a list where a scan of a few is cheaper (`Vec`); a cell in
//! [`Frontier::pending`] is bounded as it is, before others are split.

use std::collections::BinaryHeap;

use crate::certified::Stop;

/// A part of what is searched.
pub(crate) trait Bounded {
    /// Proven lower bound of everything in the cell [m].
    fn lower(&self) -> f64;
}

/// Cells that wait with a bound, the least first.
pub(crate) trait Queue {
    /// A waiting cell.
    type Cell: Bounded;

    /// The least bound; infinite if no cell waits.
    fn least(&self) -> f64;

    /// Takes a cell of least bound out, and hands it to `then`; `false` if no cell waits. By
    /// reference, since large cells are slow to return.
    fn take_least(&mut self, then: impl FnOnce(&Self::Cell)) -> bool;

    fn push(&mut self, cell: &Self::Cell);
}

/// The cells of a search.
#[derive(Debug)]
pub(crate) struct Frontier<Q: Queue> {
    /// Cells with a bound, to be split.
    pub(crate) queue: Q,
    /// Cells to be bounded as they are, the last first.
    pub(crate) pending: Vec<Q::Cell>,
    /// The cells of this round.
    pub(crate) round: Vec<Q::Cell>,
}

impl<Q: Queue> Frontier<Q> {
    /// Proven lower bound of all cells, and of closed ones, of which `closed` is the least.
    #[inline]
    pub(crate) fn lower(&self, closed: f64) -> f64 {
        let waiting = smaller(closed, self.queue.least());
        self.pending.iter().fold(waiting, |least, cell| smaller(least, cell.lower()))
    }
}

/// The smaller of two bounds: a, unless b is smaller.
#[inline]
fn smaller(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// What is searched, and for what.
pub(crate) trait Problem {
    /// The order in which cells are split.
    type Queue: Queue;

    /// The cells of a round at most, and the parts of a cell at most.
    fn round_and_parts(&self) -> (usize, usize);

    /// Why to stop, if nothing in any cell is below `lower`.
    fn decided(&self, lower: f64) -> Option<Stop>;

    /// `true` if the frontier holds the cells of one more round.
    fn has_room(&self, frontier: &Frontier<Self::Queue>) -> bool;

    /// `true` if the budget of evaluations is spent.
    fn is_spent(&self) -> bool;

    /// `true` if a cell waits that is worth splitting.
    fn can_split(&self, queue: &Self::Queue) -> bool;

    /// Notes a pending cell that becomes the `i`-th of the round.
    fn enter(&mut self, _i: usize, _cell: &Cell<Self>) {}

    /// Appends the parts of a cell to the round.
    fn split(&mut self, cell: &Cell<Self>, round: &mut Vec<Cell<Self>>);

    /// Bounds the cells of the round; may take some out, and put some back to be pending.
    fn bound(&mut self, frontier: &mut Frontier<Self::Queue>);

    /// `true` if the cell may still matter.
    fn is_open(&self, cell: &Cell<Self>) -> bool;

    /// Leaves a cell alone from now on; its bound counts in [`Problem::closed`].
    fn close(&mut self, cell: &Cell<Self>, queue: &mut Self::Queue);

    /// The least bound of the cells that were closed.
    fn closed(&self) -> f64;
}

/// The cell of a problem.
pub(crate) type Cell<P> = <<P as Problem>::Queue as Queue>::Cell;

/// How a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// The bounds answer the question.
    Decided(Stop),
    /// No cell is left that is worth splitting.
    Exhausted,
    /// The frontier is full.
    Full,
    /// The budget of evaluations is spent.
    Spent,
}

impl End {
    /// The reason that the answer gives.
    #[inline]
    pub(crate) fn stop(self) -> Stop {
        match self {
            Self::Decided(stop) => stop,
            Self::Exhausted => Stop::RoundingReached,
            Self::Full => Stop::MemoryFull,
            Self::Spent => Stop::BudgetSpent,
        }
    }
}

/// Searches the cells of the frontier until the problem is decided or nothing more can be
/// done. The proven bound is [`Frontier::lower`].
#[inline]
pub(crate) fn search<P: Problem>(problem: &mut P, frontier: &mut Frontier<P::Queue>) -> End {
    loop {
        // Of pending cells nothing is known yet.
        let has_pending = !frontier.pending.is_empty();
        let lower =
            if has_pending { f64::NEG_INFINITY } else { frontier.lower(problem.closed()) };
        if let Some(stop) = problem.decided(lower) {
            return End::Decided(stop);
        }
        if !has_pending && !problem.can_split(&frontier.queue) {
            return End::Exhausted;
        }
        if !problem.has_room(frontier) {
            return End::Full;
        }
        if problem.is_spent() {
            return End::Spent;
        }
        gather(problem, frontier);
        problem.bound(frontier);
        let Frontier { queue, round, .. } = frontier;
        keep(problem, round, queue);
    }
}

/// Fills the round: with pending cells, then with the parts of cells of least bound.
#[inline]
fn gather<P: Problem>(problem: &mut P, frontier: &mut Frontier<P::Queue>) {
    let Frontier { queue, pending, round } = frontier;
    let (most, parts) = problem.round_and_parts();
    round.clear();
    round.extend(pending.drain(pending.len().saturating_sub(most)..));
    round.iter().enumerate().for_each(|(i, cell)| problem.enter(i, cell));
    while round.len() + parts <= most && problem.can_split(queue) {
        queue.take_least(|cell| problem.split(cell, round));
    }
}

/// Puts the open cells of a round into the queue, and closes the others.
#[inline]
pub(crate) fn keep<P: Problem>(
    problem: &mut P,
    round: &mut Vec<Cell<P>>,
    queue: &mut P::Queue,
) {
    for cell in &*round {
        if problem.is_open(cell) {
            queue.push(cell);
        } else {
            problem.close(cell, queue);
        }
    }
    round.clear();
}

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

impl<C: Bounded + Copy> Queue for Vec<C> {
    type Cell = C;

    #[inline]
    fn least(&self) -> f64 {
        self.iter().fold(f64::INFINITY, |least, cell| smaller(least, cell.lower()))
    }

    #[inline]
    fn take_least(&mut self, then: impl FnOnce(&C)) -> bool {
        let Some(last) = self.len().checked_sub(1) else { return false };
        let least = (0..last)
            .fold(last, |low, i| if self[i].lower() < self[low].lower() { i } else { low });
        self.swap(least, last);
        then(&self[last]);
        self.truncate(last);
        true
    }

    #[inline]
    fn push(&mut self, cell: &C) {
        self.push(*cell);
    }
}

#[cfg(test)]
mod heap_tests {
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

#[cfg(test)]
mod list_tests {
    use super::*;

    impl Bounded for f64 {
        fn lower(&self) -> f64 {
            *self
        }
    }

    #[test]
    fn the_least_cell_is_taken_and_the_last_of_equal_ones() {
        let mut list = vec![3.0, -0.0, 2.0, 0.0];
        let mut taken = Vec::new();
        assert_eq!(list.least(), 0.0);
        while list.take_least(|cell: &f64| taken.push(cell.to_bits())) {}
        assert_eq!(taken, [0.0_f64, -0.0, 2.0, 3.0].map(f64::to_bits));
        assert_eq!(list.least(), f64::INFINITY);
    }
}
