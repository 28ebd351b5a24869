// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A lower bound of the penetration of any two bodies, by branch and bound over translations.
//!
//! # Derivation
//!
//! Let `g` of each body be a lower bound of the distance that is nowhere steeper than one. Where
//! `g_a(p) = −r` and `g_b(p − t) = −s` at a point p, both negative, a ball of radius r about p lies
//! within the first body, and one of radius s within the second body after its translation by t. So
//! the bodies overlap under every translation nearer to t than `r + s`. This sum is large for a thin
//! body within a thick one. Their largest common ball is small.
//!
//! The cells are cubes of translations. A cell within one such ball is ruled out, and the others
//! are halved. The least length in a cell that is left is a lower bound of the penetration.

use std::collections::BinaryHeap;

use palpate_field::{Aabb, Point, Vector};

use super::super::body_pair::{BodyPair, common};
use super::least_first::LeastFirst;
use super::overlap_ball::{OverlapBall, deepest_common};
use super::support::InnerBall;
use crate::certified::Stop;
use crate::engine::Bounded;
use crate::sampler::{larger, unit};

/// Points along each side of the lattice in which balls within a body are looked for.
const LATTICE: [usize; 4] = [1, 32, 16, 6];

/// The most balls of a body that are compared with those of the other one.
const MOST_INNER: usize = 24;

/// A ball within a body is passed over if a larger one holds its centre this deep, as a share of
/// the radius.
const APART: f64 = 0.5;

/// Steps from a point towards the middle of a body.
const STEPS_INWARDS: u32 = 8;

/// Overlap balls that are kept at most: all are compared with each cell. The oldest of those that
/// were found last are replaced.
const MOST_BALLS: usize = 2048;

/// A ball that was found for a cell is kept if it is at least this share of the cell: smaller ones
/// rule out none of its parts.
const WORTH: f64 = 0.25;

/// Half the side of a cell from which on rounding hides what a smaller one would show, in slacks.
const SMALLEST: f64 = 0.25;

/// A cell that resists is a candidate if it is at most this share of the tolerance. Each candidate
/// that leads to no shorter translation halves the share.
const CANDIDATE: f64 = 0.25;

/// A cube of translations.
#[derive(Clone, Copy, Debug)]
struct Cell<const D: usize> {
    centre: Vector<f64, D>,
    half: f64,
    /// The least length of its translations [m].
    least: f64,
}

impl<const D: usize> Cell<D> {
    fn new(centre: Vector<f64, D>, half: f64) -> Self {
        let nearest = Vector(centre.0.map(|x| larger(x.abs() - half, 0.0)));
        Self { centre, half, least: nearest.norm() }
    }

    fn radius(&self) -> f64 {
        self.half * (D as f64).sqrt()
    }

    fn parts(self) -> impl Iterator<Item = Self> {
        let half = 0.5 * self.half;
        (0..1_usize << D).map(move |i| {
            let side = |k: usize| if i >> k & 1 == 1 { half } else { -half };
            Self::new(self.centre + Vector(std::array::from_fn(side)), half)
        })
    }
}

impl<const D: usize> Bounded for Cell<D> {
    fn lower(&self) -> f64 {
        self.least
    }
}

/// An overlap ball, and the two balls that it is made of.
#[derive(Clone, Copy, Debug)]
struct Known<const D: usize> {
    ball: OverlapBall<D>,
    /// The second one where the body is before any translation.
    inner: [InnerBall<D>; 2],
}

impl<const D: usize> Known<D> {
    fn of(inner: [InnerBall<D>; 2]) -> Self {
        Self { ball: OverlapBall::of(inner), inner }
    }

    /// How far around a translation the bodies are known to overlap [m].
    fn around(&self, t: Vector<f64, D>) -> f64 {
        self.ball.radius - (self.ball.centre - t).norm()
    }

    /// The point between both balls after a translation by t at which both fields may be negative.
    fn point(&self, t: Vector<f64, D>) -> Point<D> {
        let [a, b] = self.inner;
        let share = if self.ball.radius > 0.0 { a.radius / self.ball.radius } else { 0.5 };
        a.centre + (b.centre + t - a.centre) * share
    }
}

/// What ended a search, and what it proved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Proven<const D: usize> {
    /// No shorter translation separates the bodies [m].
    pub(super) lower: f64,
    pub(super) stop: Stop,
    /// In the frame, the direction of the shortest translation that is not ruled out, if one
    /// along it may separate the bodies.
    pub(super) candidate: Option<Vector<f64, D>>,
}

/// What a search may use.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// How far below the upper bound the lower one may end [m].
    pub(super) tolerance: f64,
    /// Evaluations from now on.
    pub(super) budget: u32,
    /// Waiting cells.
    pub(super) cells: usize,
}

/// A search under way.
pub(super) struct TranslationTree<'a, const D: usize> {
    pair: BodyPair<'a, D>,
    known: Vec<Known<D>>,
    /// How many balls come from the bodies alone, and are never replaced.
    first: usize,
    /// The place of the ball that is replaced next.
    next: usize,
    heap: BinaryHeap<LeastFirst<Cell<D>>>,
    /// The least length in what is not searched any more.
    closed: f64,
    slack: f64,
    is_full: bool,
    /// The centre of the cell that was left when rounding reached it.
    left: Option<Vector<f64, D>>,
    /// The share of the tolerance from which on cells are candidates.
    share: f64,
}

impl<'a, const D: usize> TranslationTree<'a, D> {
    /// For translations of lengths up to `longest`. The bodies overlap most at `deepest`.
    pub(super) fn new(pair: BodyPair<'a, D>, longest: f64, deepest: Point<D>) -> Self {
        let boxes = pair.boxes();
        let places = [0, 1].map(|i| {
            let near = boxes[1 - i].map(|aabb| aabb.grown(longest));
            let own = boxes[i].or(near)?;
            Some(near.map_or(own, |near| common(&own, &near)))
        });
        let reach = places.iter().flatten().map(Aabb::radius_about_origin).fold(0.0, f64::max);
        let slack = 2.0 * pair.slack(reach + 2.0 * longest);
        let mut tree = Self {
            pair,
            known: Vec::new(),
            first: 0,
            next: 0,
            heap: BinaryHeap::new(),
            closed: f64::INFINITY,
            slack,
            is_full: false,
            left: None,
            share: CANDIDATE,
        };
        let inner = [0, 1].map(|i| tree.inner_balls(i, places[i], deepest));
        for a in &inner[0] {
            tree.known.extend(inner[1].iter().map(|b| Known::of([*a, *b])));
        }
        tree.first = tree.known.len();
        tree.next = tree.first;
        tree.heap.push(LeastFirst(Cell::new(Vector::ZERO, longest)));
        tree
    }

    pub(super) fn evaluations(&self) -> u32 {
        self.pair.evaluations
    }

    /// Nothing beyond the cube is searched: no longer translation counts than its half side.
    pub(super) fn leave_out_beyond(&mut self, longest: f64) {
        self.closed = self.closed.min(longest);
    }

    /// Balls within a body, the largest first.
    fn inner_balls(
        &mut self,
        body: usize,
        place: Option<Aabb<D>>,
        deepest: Point<D>,
    ) -> Vec<InnerBall<D>> {
        let mut found = vec![self.inwards(body, deepest)];
        let Some(place) = place else { return found };
        let sides = LATTICE[D.min(3)];
        let mut points = Vec::with_capacity(sides.pow(D as u32));
        let extents = place.max - place.min;
        for i in 0..sides.pow(D as u32) {
            let mut rest = i;
            let mut p = place.min;
            for k in 0..D {
                p[k] += extents[k] * ((rest % sides) as f64 + 0.5) / sides as f64;
                rest /= sides;
            }
            let ball = self.ball_at(body, p);
            if ball.radius > 0.0 {
                points.push(ball);
            }
        }
        points.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        for ball in points {
            let is_new = |known: &InnerBall<D>| {
                (known.centre - ball.centre).norm() > APART * known.radius
            };
            if found.iter().all(is_new) {
                let ball = self.inwards(body, ball.centre);
                found.push(ball);
            }
            if found.len() == MOST_INNER {
                break;
            }
        }
        found.retain(|ball| ball.radius > 0.0);
        found
    }

    /// The ball about a point that the field proves to lie within a body.
    fn ball_at(&mut self, body: usize, centre: Point<D>) -> InnerBall<D> {
        self.pair.evaluations += 1;
        let body = &self.pair.bodies[body];
        let local = body.local(centre);
        let value = body.value(local, body.shape.distance(local));
        InnerBall { centre, radius: body.filled(local, value) }
    }

    /// A ball within a body, deeper than that about `p`.
    fn inwards(&mut self, body: usize, p: Point<D>) -> InnerBall<D> {
        let slope = |tree: &mut Self, p: Point<D>| {
            tree.pair.evaluations += 2;
            tree.pair.bodies[body].distance_gradient(p)
        };
        let mut p = p;
        let (mut value, mut out) = slope(self, p);
        let mut step = value.abs();
        for _ in 0..STEPS_INWARDS {
            let next = p - unit(out) * step;
            let (next_value, next_out) = slope(self, next);
            if next_value < value {
                (p, value, out) = (next, next_value, next_out);
                step *= 1.5;
            } else {
                step *= 0.5;
            }
        }
        let known = &self.pair.bodies[body];
        InnerBall { centre: p, radius: known.filled(known.local(p), value) }
    }

    /// Goes on with the search, until the lower bound is within the tolerance of `upper`, there is a
    /// candidate, or the room ends.
    pub(super) fn search(&mut self, upper: f64, room: Room) -> Proven<D> {
        let enough = upper - room.tolerance + 4.0 * f64::EPSILON * upper.min(f64::MAX);
        let end = self.evaluations().saturating_add(room.budget);
        loop {
            let first = self.heap.peek().map(|first| first.0);
            let least = first.map_or(f64::INFINITY, |cell| cell.least);
            let lower = least.min(self.closed).min(upper).max(0.0);
            let is_small = |cell: Cell<D>| cell.radius() < self.share * room.tolerance;
            let direction = first.map(|cell| cell.centre).or(self.left);
            let candidate = direction.and_then(Vector::normalized);
            if lower >= enough {
                return Proven { lower, stop: Stop::Converged, candidate: None };
            } else if self.closed <= least {
                let stop = if self.is_full { Stop::MemoryFull } else { Stop::RoundingReached };
                let candidate = self.left.and_then(Vector::normalized).or(candidate);
                return Proven { lower, stop, candidate };
            } else if self.evaluations() >= end {
                return Proven { lower, stop: Stop::BudgetSpent, candidate };
            } else if first.is_some_and(is_small) {
                self.share *= 0.5;
                return Proven { lower, stop: Stop::Unresolved, candidate };
            }
            let Some(LeastFirst(cell)) = self.heap.pop() else { continue };
            if cell.half < SMALLEST * self.slack {
                self.closed = self.closed.min(cell.least);
                self.left = Some(cell.centre);
                continue;
            }
            for part in cell.parts().filter(|part| part.least < enough) {
                if self.is_ruled_out(&part) {
                    continue;
                }
                if self.heap.len() < room.cells {
                    self.heap.push(LeastFirst(part));
                } else {
                    self.closed = self.closed.min(part.least);
                    self.is_full = true;
                }
            }
            // What is longer is not searched.
            self.closed = self.closed.min(enough.max(0.0));
        }
    }

    /// Whether the bodies are proven to overlap under all translations in a cell.
    fn is_ruled_out(&mut self, cell: &Cell<D>) -> bool {
        let (t, needed) = (cell.centre, cell.radius() + self.slack);
        let mut best: Option<(f64, usize)> = None;
        for (i, known) in self.known.iter().enumerate() {
            let around = known.around(t);
            if around > needed {
                return true;
            }
            if best.is_none_or(|(most, _)| around > most) {
                best = Some((around, i));
            }
        }
        let Some((_, i)) = best else { return false };
        let start = self.known[i].point(t);
        let Some(inner) = deepest_common(&mut self.pair, start, t, needed) else {
            return false;
        };
        let found = Known::of(inner);
        if found.ball.radius > WORTH * needed {
            self.keep(found);
        }
        found.ball.radius > needed
    }

    fn keep(&mut self, found: Known<D>) {
        if self.known.len() < MOST_BALLS.max(2 * self.first) {
            self.known.push(found);
            return;
        }
        self.known[self.next] = found;
        self.next += 1;
        if self.next == self.known.len() {
            self.next = self.first;
        }
    }
}
