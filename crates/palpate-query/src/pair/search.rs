// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Best-first search over boxes for the least of `max(g_a, g_b)`.

use palpate_field::scalar::Model;
use palpate_field::{Aabb, BLOCK, Point, Vector};

use super::Nearest;
use super::body_pair::{BodyPair, Memory};
use super::cell::{BoxCell, least, least_of_larger, mean};
use super::descent::descend;
use crate::certified::{Certified, Limits, Stop};
use crate::engine::{self, Frontier, Heap, Problem, Queue};
use crate::error::QueryError;
use crate::goal::Goal;
use crate::larger::larger;

/// Models bound boxes below this radius, as a share of the first box's: above, remainders
/// exceed radii.
const SMALL: f64 = 0.25;

/// Boxes are cut at the threshold plus this share of the tolerance: cut at the threshold
/// itself, bounds would end a rounding farther apart than the tolerance.
const SPARE: f64 = 1.0 / 64.0;

/// The model in a lane before the first is written.
const NOTHING: Model = Model { value: 0.0, gradient: [0.0; 3], lower: 0.0, upper: 0.0 };

/// Models are evaluated in lines of this many lanes.
const LINE: usize = 8;

/// The largest number of waiting boxes.
pub(crate) const ROOM: usize = 1 << 16;

/// Radii, values and models of the boxes of a round.
#[derive(Debug)]
struct Known {
    radii: [f64; BLOCK],
    /// `g` of both bodies at the centres.
    values: [[f64; BLOCK]; 2],
    /// Of the first body.
    models: [Model; BLOCK],
}

/// Memory of searches between bodies, kept from one to the next.
#[derive(Debug)]
pub struct PairWorkspace<const D: usize> {
    /// Boxes that may hold less than the best; or all, if they are to be kept.
    pub(crate) frontier: Frontier<Heap<BoxCell<D>>>,
    /// Boxes of a round that are bounded by models.
    pub(crate) open: Vec<usize>,
    pub(crate) memory: Memory<D>,
    known: Known,
}

impl<const D: usize> PairWorkspace<D> {
    /// Room for searches in `D` dimensions.
    #[must_use]
    pub fn new() -> Self {
        Self {
            frontier: Frontier {
                queue: Heap::new(ROOM, ROOM),
                pending: Vec::with_capacity(ROOM),
                round: Vec::with_capacity(BLOCK),
            },
            open: Vec::with_capacity(BLOCK),
            memory: Memory::new(),
            known: Known {
                radii: [0.0; BLOCK],
                values: [[0.0; BLOCK]; 2],
                models: [NOTHING; BLOCK],
            },
        }
    }
}

impl<const D: usize> Default for PairWorkspace<D> {
    fn default() -> Self {
        Self::new()
    }
}

/// A search between two bodies; its bounds are of `max(g_a, g_b)`, half the separation.
pub(crate) struct PairSearch<'a, const D: usize> {
    pub(crate) pair: BodyPair<'a, D>,
    pub(crate) goal: Goal,
    budget: u32,
    /// Whether a descent from a box elsewhere was made; one is enough.
    has_tried: bool,
    pub(crate) upper: f64,
    pub(crate) best: Point<D>,
    /// The least bound of closed boxes.
    pub(crate) dropped: f64,
    /// The rounding of values [m].
    pub(crate) slack: f64,
    /// Whether closed boxes are kept with the others, for a track or a proof.
    pub(crate) keeps_all: bool,
    /// How far above the threshold models still improve bounds [m].
    pub(crate) reserve: f64,
}

impl<'a, const D: usize> PairSearch<'a, D> {
    pub(crate) fn new(
        pair: BodyPair<'a, D>,
        goal: Goal,
        limits: &Limits,
    ) -> Result<Self, QueryError> {
        limits.check()?;
        Ok(Self {
            pair,
            goal,
            budget: limits.budget,
            has_tried: false,
            upper: f64::INFINITY,
            best: Vector::ZERO,
            dropped: f64::INFINITY,
            slack: 0.0,
            keeps_all: false,
            reserve: 0.0,
        })
    }

    /// Searches all places that matter.
    pub(crate) fn run(&mut self, workspace: &mut PairWorkspace<D>) -> Certified<Nearest<D>> {
        match self.told_by_boxes() {
            Some(answer) => answer,
            None => self.run_within(0.0, workspace).0,
        }
    }

    /// The answer, if the boxes of both bodies are as far apart as matters.
    pub(crate) fn told_by_boxes(&mut self) -> Option<Certified<Nearest<D>>> {
        let gap = self.pair.gap_of_boxes()?;
        self.best = self.pair.root(0.0).centre();
        // At every point one of both values is at least half of the gap.
        self.slack = self.pair.slack(self.best.norm() + gap);
        let lower = 0.5 * gap - self.slack;
        (lower > self.goal.apart).then(|| self.answer(Stop::SignKnown, lower))
    }

    /// Improves the best point, from `start`, with `first` as in [`descend`].
    pub(crate) fn descend(&mut self, start: Point<D>, first: Option<f64>) {
        let (value, p) = descend(&mut self.pair, start, first, self.goal, self.slack);
        if value < self.upper {
            (self.upper, self.best) = (value, p);
        }
    }

    /// Searches all places that matter and `margin` around them; also returns the box that it
    /// searched.
    pub(crate) fn run_within(
        &mut self,
        margin: f64,
        workspace: &mut PairWorkspace<D>,
    ) -> (Certified<Nearest<D>>, Aabb<D>) {
        let both = self.pair.root(0.0);
        self.slack = self.pair.slack(both.radius_about_origin());
        self.descend(both.centre(), None);
        let root = self.root(margin);
        self.slack = self.pair.slack(root.radius_about_origin());
        workspace.frontier.queue.clear();
        if self.goal.is_hit(self.upper + self.slack) {
            return (self.answer(Stop::SignKnown, f64::NEG_INFINITY), root);
        }
        BoxCell::unknown(&root).grid(&mut workspace.frontier.pending);
        (self.refine(&root, workspace), root)
    }

    /// Continues with the boxes of the workspace, parts of `root`: those whose bounds no
    /// longer suffice become pending.
    pub(crate) fn resume(&mut self, root: &Aabb<D>, workspace: &mut PairWorkspace<D>) {
        let Frontier { queue, pending, .. } = &mut workspace.frontier;
        pending.clear();
        self.slack = self.pair.slack(root.radius_about_origin());
        let threshold = self.threshold();
        while queue.least() < threshold {
            queue.take_least(|cell| pending.push(*cell));
        }
    }

    /// Searches the pending boxes, parts of `root`, until enough is known.
    pub(crate) fn refine(
        &mut self,
        root: &Aabb<D>,
        workspace: &mut PairWorkspace<D>,
    ) -> Certified<Nearest<D>> {
        let PairWorkspace { frontier, open, memory, known } = workspace;
        let largest = SMALL * root.half_extents().norm();
        let end = engine::search(
            &mut PairRounds { search: self, open, memory, known, largest },
            frontier,
        );
        self.answer(end.stop(), frontier.lower(self.dropped))
    }

    pub(crate) fn answer(&mut self, stop: Stop, lower: f64) -> Certified<Nearest<D>> {
        let upper = self.upper + self.slack;
        Certified {
            best: Nearest::at(&mut self.pair, self.best),
            lower: 2.0 * lower.min(upper),
            upper: 2.0 * upper,
            stop,
            evaluations: self.pair.evaluations,
        }
    }

    /// Boxes with a lower bound from this on are closed.
    fn threshold(&self) -> f64 {
        self.goal.threshold(self.upper + self.slack)
    }

    /// A box that holds all points where both `g` are at most the best so far and the largest
    /// value asked for, and `margin` around them.
    pub(crate) fn root(&mut self, margin: f64) -> Aabb<D> {
        let slack = self.pair.slack(self.best.norm() + self.upper.abs());
        let least = self.goal.most(self.upper);
        self.dropped = least + slack;
        let grown = (least + 2.0 * slack) * (1.0 + 1e-12) + margin;
        self.pair.tightened(&self.pair.root(grown), grown)
    }

    /// Whether a descent from a box may prove an overlap although its centre is no better than
    /// the best point: it is elsewhere, and may hold a point in both bodies.
    fn is_worth_a_try(&self, least: &LeastBox<D>) -> bool {
        let is_elsewhere = (least.centre - self.best).norm() > least.radius;
        self.goal.is_sign() && !self.has_tried && least.value < least.radius && is_elsewhere
    }

    /// Closes a box; keeps it in the queue where all boxes are kept.
    fn drop_cell(&mut self, cell: &BoxCell<D>, queue: &mut Heap<BoxCell<D>>) {
        self.dropped = self.dropped.min(cell.lower);
        if self.keeps_all {
            queue.push(cell);
        }
    }
}

/// The rounds of a search between two bodies.
struct PairRounds<'s, 'a, const D: usize> {
    search: &'s mut PairSearch<'a, D>,
    open: &'s mut Vec<usize>,
    memory: &'s mut Memory<D>,
    known: &'s mut Known,
    /// Boxes are bounded by models up to this radius [m].
    largest: f64,
}

impl<const D: usize> Problem for PairRounds<'_, '_, D> {
    type Queue = Heap<BoxCell<D>>;

    #[inline]
    fn round_and_parts(&self) -> (usize, usize) {
        (BLOCK, 1 << D)
    }

    #[inline]
    fn decided(&self, lower: f64) -> Option<Stop> {
        let search = &self.search;
        search.goal.reached(lower.min(search.dropped), search.upper + search.slack)
    }

    #[inline]
    fn has_room(&self, frontier: &Frontier<Self::Queue>) -> bool {
        frontier.queue.has_room(BLOCK)
    }

    #[inline]
    fn is_spent(&self) -> bool {
        self.search.pair.evaluations >= self.search.budget
    }

    #[inline]
    fn can_split(&self, queue: &Self::Queue) -> bool {
        queue.least() < self.search.threshold()
    }

    #[inline]
    fn enter(&mut self, i: usize, cell: &BoxCell<D>) {
        self.known.radii[i] = cell.radius();
    }

    #[inline]
    fn split(&mut self, cell: &BoxCell<D>, round: &mut Vec<BoxCell<D>>) {
        let first = round.len();
        cell.halve(round);
        // Parts of one box are of one size.
        self.known.radii[first..round.len()].fill(round[first].radius());
    }

    /// Bounds boxes by the values of the first body, those left by the second's, and small
    /// ones by models; descends from the best box where that may help.
    fn bound(&mut self, frontier: &mut Frontier<Self::Queue>) {
        self.bound_by_first(frontier);
        let least = self.bound_by_second(&mut frontier.round);
        let Self { search, .. } = self;
        if least.value < search.upper - search.goal.tolerance {
            search.descend(least.centre, None);
        } else if search.is_worth_a_try(&least) {
            search.has_tried = true;
            search.descend(least.centre, None);
        }
        if !search.goal.is_hit(search.upper + search.slack) {
            self.bound_by_models(frontier);
        }
    }

    #[inline]
    fn is_open(&self, cell: &BoxCell<D>) -> bool {
        cell.lower < self.search.threshold()
    }

    #[inline]
    fn close(&mut self, cell: &BoxCell<D>, queue: &mut Self::Queue) {
        self.search.drop_cell(cell, queue);
    }

    #[inline]
    fn closed(&self) -> f64 {
        self.search.dropped
    }
}

/// The box of a round at whose centre the larger of both values is least.
struct LeastBox<const D: usize> {
    value: f64,
    centre: Point<D>,
    radius: f64,
}

impl<const D: usize> PairRounds<'_, '_, D> {
    /// Closes the boxes that the first body alone rules out: the second body is not evaluated
    /// there.
    fn bound_by_first(&mut self, frontier: &mut Frontier<Heap<BoxCell<D>>>) {
        let Self { search, memory, known: Known { radii, values, .. }, .. } = self;
        let Frontier { queue, round, .. } = frontier;
        search.pair.values(0, round, memory, &mut values[0]);
        let threshold = search.threshold();
        let mut kept = 0;
        for i in 0..round.len() {
            let (mut part, radius, value) = (round[i], radii[i], values[0][i]);
            let floor = search.pair.floor(0, memory.local(0, i), value, radius);
            part.lower = larger(part.lower, floor - search.slack);
            if part.lower < threshold {
                (round[kept], radii[kept]) = (part, radius);
                values[0][kept] = value;
                memory.keep(0, i, kept);
                kept += 1;
            } else {
                search.drop_cell(&part, queue);
            }
        }
        round.truncate(kept);
    }

    /// Bounds the boxes by the values of the second body.
    fn bound_by_second(&mut self, round: &mut [BoxCell<D>]) -> LeastBox<D> {
        let Self { search, memory, known: Known { radii, values, .. }, .. } = self;
        search.pair.values(1, round, memory, &mut values[1]);
        let mut least =
            LeastBox { value: f64::INFINITY, centre: Vector::ZERO, radius: radii[0] };
        for (i, part) in round.iter_mut().enumerate() {
            let local = memory.local(1, i);
            let floor = search.pair.floor(1, local, values[1][i], radii[i]);
            part.lower = larger(part.lower, floor - search.slack);
            let value = larger(values[0][i], values[1][i]);
            if value < least.value {
                least = LeastBox { value, centre: part.centre, radius: radii[i] };
            }
        }
        least
    }

    /// Bounds by models those boxes that are small and not yet closed, again by the first
    /// body alone before the second is evaluated.
    fn bound_by_models(&mut self, frontier: &mut Frontier<Heap<BoxCell<D>>>) {
        let Self { search, open, memory, known: Known { radii, models, .. }, largest } = self;
        let Frontier { queue, pending, round } = frontier;
        let threshold = search.threshold();
        let wanted = threshold + search.reserve;
        open.clear();
        let is_open = |&i: &usize| round[i].lower < wanted && radii[i] <= *largest;
        open.extend((0..round.len()).filter(is_open));
        search.pair.keep_known(round, open, memory);
        if !search.keeps_all && queue.least() < threshold {
            // The rest of a line waits for the next round, to fill a line with others.
            for i in open.drain(open.len() / LINE * LINE..).rev() {
                pending.push(round.swap_remove(i));
            }
        }
        search.pair.models(0, round, open, memory);
        let (mut lane, mut kept) = (0, 0);
        open.retain(|&i| {
            let model = search.pair.model(0, memory, lane);
            lane += 1;
            // Boxes are off by a rounding where they meet.
            round[i].lower = larger(round[i].lower, least::<D>(&model) - search.slack);
            let is_open = round[i].lower < wanted;
            if is_open {
                models[kept] = model;
                kept += 1;
            }
            is_open
        });
        search.pair.models(1, round, open, memory);
        for (lane, &i) in open.iter().enumerate() {
            let (a, b) = (models[lane], search.pair.model(1, memory, lane));
            let (lower, share) = least_of_larger::<D>(&a, &b, wanted + search.slack);
            let part = &mut round[i];
            part.lower = larger(part.lower, lower - search.slack);
            if part.lower < threshold {
                part.learn(&[a, b]);
                if !search.keeps_all {
                    let models = [a, b, mean(&a, &b, share)];
                    let cut = threshold + SPARE * search.goal.tolerance;
                    part.contract(&models, cut + search.slack);
                    search.dropped = search.dropped.min(cut);
                }
            }
        }
    }
}
