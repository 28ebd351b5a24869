// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Best-first search over boxes for the least of `max(g_a, g_b)`.

use palpate_field::scalar::Model;
use palpate_field::{Aabb, BLOCK, Point, Vector};

use super::Nearest;
use super::cell::{Cell, least, least_of_larger, mean, reach};
use super::couple::{Couple, Memory};
use super::descent::descend;
use super::frontier::Frontier;
use crate::certified::{Certified, Limits, Stop};
use crate::error::QueryError;
use crate::goal::Goal;
use crate::larger::larger;

/// Boxes are bounded by models below this radius, as a share of the first box's: above,
/// remainders are larger than radii.
const SMALL: f64 = 0.25;

/// Boxes are cut by this share of the tolerance above what matters: just there, bounds would
/// be as far apart as the tolerance, and by a rounding more.
const SPARE: f64 = 1.0 / 64.0;

/// A model that says nothing.
const NOTHING: Model = Model { value: 0.0, gradient: [0.0; 3], lower: 0.0, upper: 0.0 };

/// Models are worked through in lines of so many lanes.
const LINE: usize = 8;

/// Boxes that a workspace holds.
pub(crate) const ROOM: usize = 1 << 16;

/// A block of boxes that is looked at.
#[derive(Debug)]
struct Round<const D: usize> {
    parts: [Cell<D>; BLOCK],
    count: usize,
    radii: [f64; BLOCK],
    /// `g` of both bodies at the centres.
    values: [[f64; BLOCK]; 2],
    /// Of the first body.
    models: [Model; BLOCK],
}

/// Memory of searches between bodies, to be kept between them.
#[derive(Debug)]
pub struct PairWorkspace<const D: usize> {
    /// Boxes that may hold less than the best; or all, if they are to be kept.
    pub(super) cells: Frontier<D>,
    /// Boxes to be looked at as they are.
    pub(crate) pending: Vec<Cell<D>>,
    pub(crate) open: Vec<usize>,
    pub(crate) memory: Memory<D>,
    round: Round<D>,
}

impl<const D: usize> PairWorkspace<D> {
    /// Room for searches in `D` dimensions.
    #[must_use]
    pub fn new() -> Self {
        Self {
            cells: Frontier::new(ROOM, ROOM),
            pending: Vec::with_capacity(ROOM),
            open: Vec::with_capacity(BLOCK),
            memory: Memory::new(),
            round: Round {
                parts: [Cell::NOTHING; BLOCK],
                count: 0,
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

/// A search under way; its bounds are of `max(g_a, g_b)`, half the separation.
pub(crate) struct Search<'a, const D: usize> {
    pub(super) couple: Couple<'a, D>,
    pub(super) goal: Goal,
    budget: u32,
    /// Whether a descent was made from a box that is no better than the best.
    has_tried: bool,
    pub(super) upper: f64,
    pub(crate) best: Point<D>,
    /// Nothing in the boxes that were dropped is less.
    pub(super) dropped: f64,
    /// What values may be off by [m].
    pub(super) slack: f64,
    /// Whether boxes that need no more looking at are kept with the others.
    pub(super) keeps_all: bool,
    /// How far above what matters bounds are still made better by models [m].
    pub(super) reserve: f64,
}

impl<'a, const D: usize> Search<'a, D> {
    pub(crate) fn new(
        couple: Couple<'a, D>,
        goal: Goal,
        limits: &Limits,
    ) -> Result<Self, QueryError> {
        limits.check()?;
        Ok(Self {
            couple,
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

    /// Searches everywhere, from the middle of what the boxes of both have in common.
    pub(crate) fn run(&mut self, workspace: &mut PairWorkspace<D>) -> Certified<Nearest<D>> {
        match self.told_by_boxes() {
            Some(answer) => answer,
            None => self.run_within(0.0, workspace).0,
        }
    }

    /// The answer, if the boxes of both bodies are as far apart as matters.
    pub(super) fn told_by_boxes(&mut self) -> Option<Certified<Nearest<D>>> {
        let gap = self.couple.gap_of_boxes()?;
        self.best = self.couple.root(0.0).centre();
        // One of both values is at least half of it, everywhere.
        self.slack = self.couple.slack(self.best.norm() + gap);
        let lower = 0.5 * gap - self.slack;
        (lower > self.goal.apart).then(|| self.answer(Stop::SignKnown, lower))
    }

    /// Improves the best point, from `start`, with `first` as in [`descend`].
    pub(super) fn descend(&mut self, start: Point<D>, first: Option<f64>) {
        let (value, p) = descend(&mut self.couple, (start, first), self.goal, self.slack);
        if value < self.upper {
            (self.upper, self.best) = (value, p);
        }
    }

    /// Searches everywhere, and `margin` around it; also returns the box that it searched.
    pub(super) fn run_within(
        &mut self,
        margin: f64,
        workspace: &mut PairWorkspace<D>,
    ) -> (Certified<Nearest<D>>, Aabb<D>) {
        let both = self.couple.root(0.0);
        self.slack = self.couple.slack(reach(&both));
        self.descend(both.centre(), None);
        let root = self.root(margin);
        self.slack = self.couple.slack(reach(&root));
        workspace.cells.clear();
        if self.goal.is_hit(self.upper + self.slack) {
            return (self.answer(Stop::SignKnown, f64::NEG_INFINITY), root);
        }
        Cell::unknown(&root).grid(&mut workspace.pending);
        (self.refine(&root, workspace), root)
    }

    /// Takes over the boxes of the workspace, parts of `root`, of which something is known:
    /// those of which too little is are pending.
    pub(super) fn resume(&mut self, root: &Aabb<D>, workspace: &mut PairWorkspace<D>) {
        workspace.pending.clear();
        self.slack = self.couple.slack(reach(root));
        let threshold = self.threshold();
        while workspace.cells.lowest() < threshold {
            workspace.pending.extend(workspace.cells.pop());
        }
    }

    /// Searches the pending boxes, parts of `root`, and all that is found in them.
    pub(super) fn refine(
        &mut self,
        root: &Aabb<D>,
        workspace: &mut PairWorkspace<D>,
    ) -> Certified<Nearest<D>> {
        let largest = SMALL * root.half_extents().norm();
        loop {
            let has_pending = !workspace.pending.is_empty();
            let decided =
                if has_pending { f64::NEG_INFINITY } else { workspace.cells.lowest() };
            let stop = self.goal.reached(decided.min(self.dropped), self.upper + self.slack);
            let is_full = !workspace.cells.has_room(BLOCK);
            let is_empty = !has_pending && workspace.cells.is_empty();
            if stop.is_some() || is_empty || is_full || self.couple.evaluations >= self.budget {
                let pending = workspace.pending.iter().map(|cell| cell.lower);
                let lowest = workspace.cells.lowest().min(self.dropped);
                let stop = stop.unwrap_or(Stop::BudgetSpent);
                return self.answer(stop, pending.fold(lowest, f64::min));
            }
            self.round(workspace, largest);
        }
    }

    pub(super) fn answer(&mut self, stop: Stop, lower: f64) -> Certified<Nearest<D>> {
        let upper = self.upper + self.slack;
        Certified {
            best: Nearest::at(&mut self.couple, self.best),
            lower: 2.0 * lower.min(upper),
            upper: 2.0 * upper,
            stop,
            evaluations: self.couple.evaluations,
        }
    }

    /// Boxes with nothing below this need no more looking at.
    fn threshold(&self) -> f64 {
        self.goal.threshold(self.upper + self.slack)
    }

    /// A box that holds all points that matter, and `margin` more: where neither `g` is
    /// more than the best so far, or than what is asked for. Elsewhere one is.
    pub(super) fn root(&mut self, margin: f64) -> Aabb<D> {
        let slack = self.couple.slack(self.best.norm() + self.upper.abs());
        let least = self.goal.most(self.upper);
        self.dropped = least + slack;
        let grown = (least + 2.0 * slack) * (1.0 + 1e-12) + margin;
        self.couple.tightened(&self.couple.root(grown), grown)
    }

    /// Looks at a block of boxes: pending ones, or the parts of those of which least is
    /// known.
    fn round(&mut self, workspace: &mut PairWorkspace<D>, largest: f64) {
        self.gather(workspace);
        let PairWorkspace { cells, round, memory, .. } = workspace;
        // What the first body alone rules out, the second is not asked.
        self.couple.values(0, &round.parts[..round.count], memory, &mut round.values[0]);
        let threshold = self.threshold();
        let mut kept = 0;
        for i in 0..round.count {
            let (mut part, radius, value) =
                (round.parts[i], round.radii[i], round.values[0][i]);
            let floor = self.couple.floor(0, (i, value), radius, memory);
            part.lower = larger(part.lower, floor - self.slack);
            if part.lower < threshold {
                (round.parts[kept], round.radii[kept]) = (part, radius);
                round.values[0][kept] = value;
                memory.keep(0, i, kept);
                kept += 1;
            } else {
                self.drop_cell(&part, cells);
            }
        }
        round.count = kept;
        self.couple.values(1, &round.parts[..kept], memory, &mut round.values[1]);
        let mut least = (f64::INFINITY, 0);
        for (i, part) in round.parts[..kept].iter_mut().enumerate() {
            let at = (i, round.values[1][i]);
            let floor = self.couple.floor(1, at, round.radii[i], memory);
            part.lower = larger(part.lower, floor - self.slack);
            let value = larger(round.values[0][i], round.values[1][i]);
            if value < least.0 {
                least = (value, i);
            }
        }
        let (value, centre, radius) =
            (least.0, round.parts[least.1].centre, round.radii[least.1]);
        if value < self.upper - self.goal.tolerance {
            self.descend(centre, None);
        } else if self.is_worth_a_try((value, centre), radius) {
            self.has_tried = true;
            self.descend(centre, None);
        }
        if !self.goal.is_hit(self.upper + self.slack) {
            self.model(workspace, largest);
        }
        let threshold = self.threshold();
        let PairWorkspace { cells, round, .. } = workspace;
        for part in &round.parts[..round.count] {
            if part.lower < threshold {
                cells.push(*part);
            } else {
                self.drop_cell(part, cells);
            }
        }
    }

    /// Whether a descent from a box may find bodies to overlap, although its centre is no
    /// better than the best: it is elsewhere, and may hold such a point.
    fn is_worth_a_try(&self, (value, centre): (f64, Point<D>), radius: f64) -> bool {
        let is_elsewhere = (centre - self.best).norm() > radius;
        self.goal.is_sign() && !self.has_tried && value < radius && is_elsewhere
    }

    /// Takes a block of boxes, with their radii: pending ones, then parts of others.
    fn gather(&mut self, workspace: &mut PairWorkspace<D>) {
        let PairWorkspace { cells, pending, round, .. } = workspace;
        let (parts, radii) = (&mut round.parts, &mut round.radii);
        let first = pending.len().saturating_sub(BLOCK);
        let mut count = 0;
        for cell in pending.drain(first..) {
            (parts[count], radii[count]) = (cell, cell.radius());
            count += 1;
        }
        let threshold = self.threshold();
        while count + (1 << D) <= BLOCK && cells.lowest() < threshold {
            let Some(parent) = cells.pop() else { break };
            let end = parent.halve(parts, count);
            // Parts of one box are of one size.
            radii[count..end].fill(parts[count].radius());
            count = end;
        }
        round.count = count;
    }

    /// Bounds by models those boxes that are small and not yet done with, again by the
    /// first body alone before the second is asked.
    fn model(&mut self, workspace: &mut PairWorkspace<D>, largest: f64) {
        let threshold = self.threshold();
        let wanted = threshold + self.reserve;
        let PairWorkspace { cells, pending, open, memory, round, .. } = workspace;
        let Round { parts, radii, models, count, .. } = round;
        let parts = &mut parts[..*count];
        open.clear();
        let is_open = |&i: &usize| parts[i].lower < wanted && radii[i] <= largest;
        open.extend((0..parts.len()).filter(is_open));
        self.couple.keep_known(parts, open, memory);
        if !self.keeps_all && cells.lowest() < threshold {
            // The rest of a line waits for the boxes of the next round.
            for i in open.drain(open.len() / LINE * LINE..).rev() {
                *count -= 1;
                pending.push(parts[i]);
                parts[i] = parts[*count];
            }
        }
        self.couple.models(0, parts, open, memory);
        let (mut lane, mut kept) = (0, 0);
        open.retain(|&i| {
            let model = self.couple.model(0, memory, lane);
            lane += 1;
            // Boxes are off by a rounding where they meet.
            parts[i].lower = larger(parts[i].lower, least::<D>(&model) - self.slack);
            let is_open = parts[i].lower < wanted;
            if is_open {
                models[kept] = model;
                kept += 1;
            }
            is_open
        });
        self.couple.models(1, parts, open, memory);
        for (lane, &i) in open.iter().enumerate() {
            let (a, b) = (models[lane], self.couple.model(1, memory, lane));
            let (lower, share) = least_of_larger::<D>(&a, &b, wanted + self.slack);
            let part = &mut parts[i];
            part.lower = larger(part.lower, lower - self.slack);
            if part.lower < threshold {
                part.learn(&[a, b]);
                if !self.keeps_all {
                    let models = [a, b, mean(&a, &b, share)];
                    let cut = threshold + SPARE * self.goal.tolerance;
                    part.contract(&models, cut + self.slack);
                    self.dropped = self.dropped.min(cut);
                }
            }
        }
    }

    fn drop_cell(&mut self, cell: &Cell<D>, cells: &mut Frontier<D>) {
        self.dropped = self.dropped.min(cell.lower);
        if self.keeps_all {
            cells.push(*cell);
        }
    }
}
