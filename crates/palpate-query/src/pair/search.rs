// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The search for the separation of two bodies, and its cells.

use std::cell::Cell;

use palpate_field::scalar::Model;
use palpate_field::{Aabb, BLOCK, Point, Vector};

use super::Nearest;
use super::body_pair::{BodyPair, CommonSurface, Memory};
use super::distance_bound::descend;
use crate::certified::{Certified, Goal, Limits, Stop};
use crate::engine::{self, Bounded, Frontier, Heap, Problem, Queue, Rebound};
use crate::error::QueryError;
use crate::sampler::larger;

/// Models bound boxes below this radius, as a share of the first box's: above, remainders
/// exceed radii.
const SMALL: f64 = 0.25;

/// Boxes are cut at the threshold plus this share of the tolerance: cut at the threshold
/// itself, bounds would end a rounding farther apart than the tolerance.
const SPARE: f64 = 1.0 / 64.0;

/// A search that takes so many evaluations looks for a surface that both bodies have in common:
/// most end before, and looking takes as long as some tens of evaluations.
const LONG: u32 = 4096;

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
    /// The most boxes that may wait.
    room: usize,
    /// Boxes that may hold less than the best; or all, if they are to be kept.
    pub(crate) frontier: Frontier<Heap<BoxCell<D>>>,
    /// Boxes of a round that are bounded by models.
    pub(crate) open: Vec<usize>,
    pub(crate) memory: Memory<D>,
    known: Known,
}

impl<const D: usize> PairWorkspace<D> {
    /// Room for searches in `D` dimensions, of 65 536 waiting boxes.
    #[must_use]
    #[inline(never)]
    pub fn new() -> Self {
        Self::with_room(ROOM)
    }

    /// Room for so many waiting boxes: a search that ends with
    /// [`Stop::MemoryFull`](crate::Stop::MemoryFull) may need more. It is allocated at once, about 150
    /// bytes for each.
    ///
    /// ```
    /// use palpate_field::{Pose, Shape};
    /// use palpate_query::{Limits, PairWorkspace, Placed, Stop, separation};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// // Two tori that lie on each other, along a whole circle.
    /// let torus = Shape::<3>::torus(0.35, 0.15)?;
    /// let above = Placed::new(&torus, Pose::translation([0.0, 0.3, 0.0]));
    /// let limits = Limits::new(1e-5);
    /// let ask = |room| separation(&torus, above, &limits, &mut PairWorkspace::with_room(room));
    /// assert_eq!(ask(256)?.stop, Stop::MemoryFull);
    /// assert_eq!(ask(65_536)?.stop, Stop::Converged);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn with_room(room: usize) -> Self {
        Self {
            room,
            frontier: Frontier {
                queue: Heap::new(room, room),
                pending: Vec::with_capacity(room),
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

    /// The most boxes that may wait.
    pub(crate) fn room(&self) -> usize {
        self.room
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
    /// Whether closed boxes are kept with the others, for a proof.
    pub(crate) keeps_all: bool,
    /// What is enough, if the goal is finer.
    enough: Option<Enough>,
}

/// A goal that is enough, and how many evaluations more a finer one is worth.
#[derive(Clone, Debug)]
struct Enough {
    goal: Goal,
    /// Of the evaluations up to it, the share that may follow.
    share: f64,
    /// The evaluations up to it, once it is reached.
    reached_at: Cell<Option<u32>>,
}

impl<'a, const D: usize> PairSearch<'a, D> {
    #[inline(never)]
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
            enough: None,
        })
    }

    /// Searches all places that matter.
    #[inline(never)]
    pub(crate) fn run(&mut self, workspace: &mut PairWorkspace<D>) -> Certified<Nearest<D>> {
        match self.told_by_boxes() {
            Some(answer) => answer,
            None => self.run_from(None, workspace).0,
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

    /// Begins with a point.
    pub(crate) fn start_at(&mut self, p: Point<D>) {
        let [(a, _), (b, _)] = self.pair.slopes(p);
        (self.upper, self.best) = (larger(a, b), p);
    }

    /// Goes on beyond the goal, to the share `finer` of its tolerance, for as long as the share `more` of
    /// the evaluations that it takes.
    pub(crate) fn go_on(&mut self, finer: f64, more: f64) {
        let goal = self.goal;
        self.enough = Some(Enough { goal, share: more, reached_at: Cell::new(None) });
        self.goal = goal.finer(finer);
    }

    /// Improves the best point, from `start`, with `first` as in [`descend`].
    pub(crate) fn descend(&mut self, start: Point<D>, first: Option<f64>) {
        let (value, p) = descend(&mut self.pair, start, first, self.goal, self.slack);
        if value < self.upper {
            (self.upper, self.best) = (value, p);
        }
    }

    /// Searches all places that matter; `start` may be a value and the point that has it. Also returns
    /// the box that it searched.
    #[inline(never)]
    pub(crate) fn run_from(
        &mut self,
        start: Option<(f64, Point<D>)>,
        workspace: &mut PairWorkspace<D>,
    ) -> (Certified<Nearest<D>>, Aabb<D>) {
        let both = self.pair.root(0.0);
        self.slack = self.pair.slack(both.radius_about_origin());
        self.upper = f64::INFINITY;
        self.descend(both.centre(), None);
        if let Some((value, p)) = start
            && value < self.upper
        {
            (self.upper, self.best) = (value, p);
        }
        let root = self.root();
        self.slack = self.pair.slack(root.radius_about_origin());
        workspace.frontier.queue.clear();
        if self.goal.is_hit(self.upper + self.slack) {
            return (self.answer(Stop::SignKnown, f64::NEG_INFINITY), root);
        }
        BoxCell::unknown(&root).grid(&mut workspace.frontier.pending);
        (self.refine(&root, workspace), root)
    }

    /// Searches the pending boxes, parts of `root`, until enough is known.
    fn refine(
        &mut self,
        root: &Aabb<D>,
        workspace: &mut PairWorkspace<D>,
    ) -> Certified<Nearest<D>> {
        let PairWorkspace { frontier, open, memory, known, .. } = workspace;
        let largest = SMALL * root.half_extents().norm();
        let end = engine::search(
            &mut PairRounds {
                search: self,
                open,
                memory,
                known,
                largest,
                root: *root,
                common: None,
            },
            frontier,
        );
        let (stop, lower) = (end.stop(), frontier.lower(self.dropped));
        let enough = self.enough.as_ref().map(|enough| enough.goal);
        let enough = enough.and_then(|goal| goal.reached(lower, self.upper + self.slack));
        self.answer(enough.unwrap_or(stop), lower)
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
    /// value asked for.
    pub(crate) fn root(&mut self) -> Aabb<D> {
        let slack = self.pair.slack(self.best.norm() + self.upper.abs());
        let least = self.goal.most(self.upper);
        self.dropped = least + slack;
        let grown = (least + 2.0 * slack) * (1.0 + 1e-12);
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
    /// The box that is searched.
    root: Aabb<D>,
    /// What the bodies have in common, once that was looked for.
    common: Option<Option<CommonSurface<'a, D>>>,
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
        let (lower, upper) = (lower.min(search.dropped), search.upper + search.slack);
        search.goal.reached(lower, upper).or_else(|| {
            let enough = search.enough.as_ref()?;
            let stop = enough.goal.reached(lower, upper)?;
            let reached_at = enough.reached_at.get().unwrap_or(search.pair.evaluations);
            enough.reached_at.set(Some(reached_at));
            let more = enough.share * f64::from(reached_at);
            (f64::from(search.pair.evaluations - reached_at) >= more).then_some(stop)
        })
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
        if self.search.pair.evaluations > LONG {
            self.bound_by_common_surface(frontier);
        }
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
    /// Closes the boxes in which only a surface that both bodies have in common is near.
    fn bound_by_common_surface(&mut self, frontier: &mut Frontier<Heap<BoxCell<D>>>) {
        let Self { search, known: Known { radii, .. }, root, common, .. } = self;
        let common = common.get_or_insert_with(|| CommonSurface::of(&search.pair, root));
        let threshold = search.threshold();
        let Some(common) = common.as_ref().filter(|c| c.level - search.slack >= threshold)
        else {
            return;
        };
        let Frontier { queue, round, .. } = frontier;
        search.pair.evaluations += (common.evaluations() * round.len()) as u32;
        let mut kept = 0;
        for i in 0..round.len() {
            let (mut part, radius) = (round[i], radii[i]);
            let floor = common.floor(part.centre, radius) - search.slack;
            part.lower = larger(part.lower, floor);
            if part.lower < threshold {
                (round[kept], radii[kept]) = (part, radius);
                kept += 1;
            } else {
                search.drop_cell(&part, queue);
            }
        }
        round.truncate(kept);
    }

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
        let Self { search, open, memory, known: Known { radii, models, .. }, largest, .. } =
            self;
        let Frontier { queue, pending, round } = frontier;
        let threshold = search.threshold();
        open.clear();
        let is_open = |&i: &usize| round[i].lower < threshold && radii[i] <= *largest;
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
            let is_open = round[i].lower < threshold;
            if is_open {
                models[kept] = model;
                kept += 1;
            }
            is_open
        });
        search.pair.models(1, round, open, memory);
        for (lane, &i) in open.iter().enumerate() {
            let (a, b) = (models[lane], search.pair.model(1, memory, lane));
            let (lower, share) = least_of_larger::<D>(&a, &b, threshold + search.slack);
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

/// A side is halved if it is longer than this share of the longest.
const LONG_SIDE: f64 = 0.63;

/// A side is level if fields change along it by less than this share of the largest change.
const LEVEL: f64 = 0.01;

/// A level side is at most this many times as long as the others.
const THIN: f64 = 8.0;

/// The rounding of a sum of models, relative to the sum of sizes.
pub(crate) const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// A box, and what is known of it, in a cache line of its own.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct BoxCell<const D: usize> {
    /// Proven lower bound in the box [m].
    pub(crate) lower: f64,
    pub(crate) centre: Point<D>,
    /// Half of its sides.
    pub(crate) half: Vector<f64, D>,
    /// Bit k: side k is level.
    pub(crate) level: u8,
}

impl<const D: usize> Bounded for BoxCell<D> {
    #[inline]
    fn lower(&self) -> f64 {
        self.lower
    }
}

impl<const D: usize> Rebound for BoxCell<D> {
    #[inline]
    fn with_lower(&self, lower: f64) -> Self {
        Self { lower, ..*self }
    }
}

impl<const D: usize> BoxCell<D> {
    pub(crate) const NOTHING: Self =
        Self { lower: f64::NEG_INFINITY, centre: Vector::ZERO, half: Vector::ZERO, level: 0 };

    /// A box without a bound.
    pub(crate) fn unknown(aabb: &Aabb<D>) -> Self {
        let mut half = aabb.half_extents();
        for k in 0..D {
            half[k] = half[k].max(0.0);
        }
        Self { centre: aabb.centre(), half, ..Self::NOTHING }
    }

    /// No point of the box is farther from its centre [m].
    #[inline]
    pub(crate) fn radius(&self) -> f64 {
        self.half.norm() * (1.0 + ROUNDINGS)
    }

    /// Marks the level sides, from models.
    #[inline]
    pub(crate) fn learn(&mut self, [a, b]: &[Model; 2]) {
        let change = |k: usize| a.gradient[k].abs() + b.gradient[k].abs();
        let most = (0..D).fold(0.0_f64, |most, k| most.max(change(k)));
        self.level = 0;
        for k in 0..D {
            self.level |= u8::from(change(k) < LEVEL * most) << k;
        }
    }

    /// Cuts off the ends of the box where one of the models is everywhere at least `enough`.
    #[inline]
    pub(crate) fn contract(&mut self, models: &[Model; 3], enough: f64) {
        let (mut low, mut high) = ([-1.0_f64; D], [1.0_f64; D]);
        for model in models {
            let gradient = &model.gradient[..D];
            let slope = gradient.iter().fold(0.0, |sum, side| sum + side.abs());
            let size = model.value.abs() + slope;
            let room = enough - model.value
                + model.lower * (1.0 + ROUNDINGS)
                + 2.0 * ROUNDINGS * (size + enough.abs());
            for k in 0..D {
                let side = gradient[k].abs();
                let end = (room + (slope - side)) / side;
                // Written so that NaN leaves all.
                let end = if end < 1.0 { end.max(-1.0) } else { 1.0 };
                if gradient[k] > 0.0 {
                    high[k] = high[k].min(end);
                } else {
                    low[k] = low[k].max(-end);
                }
            }
        }
        for k in 0..D {
            let half = self.half[k];
            self.centre[k] += half * (0.5 * (low[k] + high[k]));
            self.half[k] = half * larger(0.5 * (high[k] - low[k]), 0.0) * (1.0 + ROUNDINGS)
                + 2.0 * f64::EPSILON * self.centre[k].abs();
        }
    }

    /// Whether each side is to be halved: the long ones of those along which the fields
    /// vary, or of all where the box is thin already.
    #[inline]
    fn splits(&self) -> [bool; D] {
        let longest = |level: u8| {
            let sides = (0..D).filter(|k| level & (1 << k) == 0);
            sides.fold(0.0_f64, |longest, k| longest.max(self.half[k]))
        };
        let all = longest(0);
        let varying = longest(self.level);
        let is_thin = THIN * varying < all;
        let (level, longest) = if is_thin { (0, all) } else { (self.level, varying) };
        std::array::from_fn(|k| {
            level & (1 << k) == 0 && (self.half[k] > LONG_SIDE * longest || longest == 0.0)
        })
    }

    /// Appends the parts of the box, halved along its long sides.
    #[inline]
    pub(crate) fn halve(&self, parts: &mut Vec<Self>) {
        let first = parts.len();
        parts.push(*self);
        for (k, is_split) in self.splits().into_iter().enumerate() {
            if is_split {
                for i in first..parts.len() {
                    let mut other = parts[i];
                    let half = 0.5 * other.half[k];
                    other.half[k] = half;
                    parts[i].half[k] = half;
                    parts[i].centre[k] -= half;
                    other.centre[k] += half;
                    parts.push(other);
                }
            }
        }
    }

    pub(crate) fn contains(&self, p: Point<D>) -> bool {
        (0..D).all(|k| (p[k] - self.centre[k]).abs() <= self.half[k])
    }

    /// Fills `cells` with the parts of the box, of similar sides, as many as fit into a
    /// block.
    pub(crate) fn grid(&self, cells: &mut Vec<Self>) {
        cells.clear();
        cells.push(*self);
        let mut first = 0;
        while (cells.len() - first) << D <= BLOCK {
            let end = cells.len();
            for i in first..end {
                let cell = cells[i];
                cell.halve(cells);
            }
            if cells.len() - end == end - first {
                // A point has no parts.
                cells.truncate(end);
                break;
            }
            first = end;
        }
        cells.drain(..first);
    }
}

/// A lower bound of one field over a box, from its model.
#[inline]
pub(crate) fn least<const D: usize>(model: &Model) -> f64 {
    let slope = model.gradient[..D].iter().fold(0.0, |sum, side| sum + side.abs());
    let size = model.value.abs() + slope;
    model.value - slope - model.lower * (1.0 + ROUNDINGS) - ROUNDINGS * size
}

/// A lower bound of the larger of two fields over a box, from their models: the largest
/// least value of their means, which is at the end of a range or where a component of
/// the mean's slope changes its sign. No more than `enough` is looked for. Also returns the
/// share that the first has in that mean.
#[inline]
pub(crate) fn least_of_larger<const D: usize>(a: &Model, b: &Model, enough: f64) -> (f64, f64) {
    let mut best = (least::<D>(a), 1.0);
    let of_b = least::<D>(b);
    if of_b > best.0 {
        best = (of_b, 0.0);
    }
    for k in 0..D {
        if best.0 >= enough {
            break;
        }
        let (of_a, of_b) = (a.gradient[k], b.gradient[k]);
        // Of like signs the mean's has the same.
        if of_a * of_b < 0.0 {
            let share = of_b / (of_b - of_a);
            let lower = least::<D>(&mean(a, b, share));
            if lower > best.0 {
                best = (lower, share);
            }
        }
    }
    best
}

/// `share` of a and the rest of b, with the roundings of their sum among its remainders.
#[inline]
pub(crate) fn mean(a: &Model, b: &Model, share: f64) -> Model {
    let (rest, mut size) = (1.0 - share, 0.0);
    let mut sum = |a: f64, b: f64| {
        let (a, b) = (share * a, rest * b);
        size += a.abs() + b.abs();
        a + b
    };
    let value = sum(a.value, b.value);
    let gradient = std::array::from_fn(|k| sum(a.gradient[k], b.gradient[k]));
    let rounding = ROUNDINGS * size;
    Model {
        value,
        gradient,
        lower: share * a.lower + rest * b.lower + rounding,
        upper: share * a.upper + rest * b.upper + rounding,
    }
}

#[cfg(test)]
mod cell_tests {
    use super::*;

    /// Numbers of a fixed sequence in [−1, 1], evenly spread.
    fn spread(i: u32) -> f64 {
        2.0 * (f64::from(i) * 0.618_033_988_749_894_9).fract() - 1.0
    }

    #[test]
    fn a_contracted_box_leaves_out_only_what_a_model_rules_out() {
        for case in 0..400 {
            let number = |i: u32| spread(31 * case + i);
            let model = |first: u32| Model {
                value: 0.4 * number(first),
                gradient: [number(first + 1), number(first + 2), number(first + 3)],
                lower: 0.1 * number(first + 4).abs(),
                upper: 0.0,
            };
            let (a, b) = (model(0), model(5));
            let models = [a, b, mean(&a, &b, number(10).abs())];
            let enough = 0.3 * number(11);
            let whole = BoxCell::<3> {
                centre: Vector([number(12), number(13), number(14)]),
                half: Vector([0.5, 0.2, 0.1]),
                ..BoxCell::NOTHING
            };
            let mut part = whole;
            part.contract(&models, enough);
            for sample in 0..100 {
                let u: [f64; 3] = std::array::from_fn(|k| spread(97 * sample + k as u32));
                let least_at = |m: &Model| {
                    m.value - m.lower + (0..3).map(|k| m.gradient[k] * u[k]).sum::<f64>()
                };
                let is_left = (0..3).all(|k| {
                    let p = whole.centre[k] + whole.half[k] * u[k];
                    (p - part.centre[k]).abs() <= part.half[k]
                });
                assert!(is_left || models.iter().any(|m| least_at(m) >= enough));
            }
        }
    }

    #[test]
    fn a_contracted_box_ends_where_a_model_alone_is_enough() {
        // Less than 0.5 where 0.2 + u₀ − 0.1 < 0.5, and where −2u₁ < 0.5.
        let rising = Model { value: 0.2, gradient: [1.0, 0.0, 0.0], lower: 0.1, upper: 0.0 };
        let falling = Model { value: 0.0, gradient: [0.0, -2.0, 0.0], lower: 0.0, upper: 0.0 };
        let half = Vector([4.0, 4.0]);
        let mut part = BoxCell::<2> { half, ..BoxCell::NOTHING };
        part.contract(&[rising, falling, rising], 0.5);
        let ends = [part.centre - part.half, part.centre + part.half];
        let expected = [Vector([-4.0, -1.0]), Vector([1.6, 4.0])];
        for (end, expected) in ends.into_iter().zip(expected) {
            assert!((end - expected).norm() < 1e-13, "{end:?}, not {expected:?}");
        }
    }
}
