// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

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

mod heap;
mod list;

use crate::certified::Stop;

pub(crate) use heap::{Heap, Rebound};

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
