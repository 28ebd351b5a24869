// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How the boxes about a ball are bounded, a round at a time.

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Point, Vector};

use super::{BallSearch, Memory};
use crate::certified::Stop;
use crate::engine::{Frontier, Heap, Problem, Queue};
use crate::pair::cell::BoxCell;

/// The rounds of a search about a ball.
pub(super) struct BallRounds<'s, 'a, const D: usize> {
    pub(super) search: &'s mut BallSearch<'a, D>,
    pub(super) memory: &'s mut Memory<D>,
}

impl<const D: usize> Problem for BallRounds<'_, '_, D> {
    type Queue = Heap<BoxCell<D>>;

    fn round_and_parts(&self) -> (usize, usize) {
        (BLOCK, 1 << D)
    }

    fn decided(&self, lower: f64) -> Option<Stop> {
        self.search.reached(lower.max(self.search.safe))
    }

    fn has_room(&self, frontier: &Frontier<Self::Queue>) -> bool {
        frontier.queue.has_room(BLOCK)
    }

    fn is_spent(&self) -> bool {
        self.search.evaluations >= self.search.budget
    }

    fn can_split(&self, queue: &Self::Queue) -> bool {
        queue.least() < self.search.threshold()
    }

    fn split(&mut self, cell: &BoxCell<D>, round: &mut Vec<BoxCell<D>>) {
        cell.halve(round);
    }

    /// Bounds boxes by the values at their centres, and those that stay by models; looks for
    /// a nearer point of the surface from the nearest box.
    fn bound(&mut self, frontier: &mut Frontier<Self::Queue>) {
        let mut is_steep = [false; BLOCK];
        let nearest = self.bound_by_values(&mut frontier.round, &mut is_steep);
        let search = &mut *self.search;
        if let Some((far, start)) = nearest
            && far < search.reach - 0.25 * search.goal.tolerance
            && let Some(found) = search.through(start, search.sign)
        {
            search.slide(found);
        }
        self.bound_by_models(&mut frontier.round, &is_steep);
    }

    fn is_open(&self, cell: &BoxCell<D>) -> bool {
        cell.lower < self.search.threshold()
    }

    fn close(&mut self, cell: &BoxCell<D>, _queue: &mut Self::Queue) {
        self.search.dropped = self.search.dropped.min(cell.lower);
    }

    fn closed(&self) -> f64 {
        self.search.dropped
    }
}

impl<const D: usize> BallRounds<'_, '_, D> {
    /// Takes out the boxes that hold no point beyond the surface, as their values tell, and
    /// notes of the others whether the field is as steep as promised there. Returns the
    /// nearest centre from which the surface may be found, and its distance.
    fn bound_by_values(
        &mut self,
        round: &mut Vec<BoxCell<D>>,
        is_steep: &mut [bool; BLOCK],
    ) -> Option<(f64, Point<D>)> {
        let Self { search, memory } = self;
        for (i, part) in round.iter().enumerate() {
            memory.points.set(i, part.centre);
        }
        search.body.shape.block_distances(&memory.points, round.len(), &mut memory.values);
        search.evaluations += round.len() as u32;
        let mut open = 0;
        let mut nearest: Option<(f64, Point<D>)> = None;
        for i in 0..round.len() {
            let mut part = round[i];
            let value = search.sign * memory.values.get(i);
            let radius = part.radius();
            let is_known = search.body.is_known(part.centre, radius);
            let slack = search.slack(part.centre) + search.geometry;
            if is_known && value - search.lipschitz * radius > slack {
                continue;
            }
            part.lower = part.lower.max(search.distance_to_box(&part));
            let far = (part.centre - search.centre).norm();
            let may_help = search.best.is_none() || search.is_through(1.0, value, slack);
            if may_help && nearest.is_none_or(|(least, _)| far < least) {
                nearest = Some((far, part.centre));
            }
            (round[open], is_steep[open]) = (part, is_known);
            open += 1;
        }
        round.truncate(open);
        nearest
    }

    /// Bounds boxes by models, where the field is as steep as promised.
    fn bound_by_models(&mut self, round: &mut [BoxCell<D>], is_steep: &[bool; BLOCK]) {
        if round.is_empty() {
            return;
        }
        let Self { search, memory } = self;
        for (lane, part) in round.iter().enumerate() {
            memory.boxes.set(lane, Vector(Model::cell(part.centre.0, part.half.0)));
        }
        let models = &mut memory.models;
        search.body.shape.block_distances(&memory.boxes, round.len(), models);
        search.evaluations += round.len() as u32;
        for (lane, part) in round.iter_mut().enumerate() {
            if is_steep[lane] {
                let room = search.distance_to_room(part, &models.get(lane));
                part.lower = part.lower.max(room);
            }
        }
    }
}
