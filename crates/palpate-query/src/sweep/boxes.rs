// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! When two fields that move first come near each other, box by box.
//!
//! In the coordinates of one body, its field stays as it is, and the other's goes by. Best-first
//! branch and bound over boxes of these coordinates, where the bound of a box is the time until which
//! it is free: where one of both fields is above the level at each of its points. A box that the
//! first field alone proves free is so for all times. Else the value of the other at the centre is
//! good until the box leaves the ball that it proves empty; and models of both, over the box and a
//! span of time, are good until their best mean falls to the level. So each box advances through time
//! on its own, and comes apart where smaller boxes gain time.

use palpate_field::scalar::{Model, SpaceTimeModel};
use palpate_field::{Aabb, BLOCK, Block, Column, Point, Vector};

use super::first_touch::{FREE, FreeBox, HALVES, SweepSettings};
use super::motion::{Moving, Path, Places, Stay, WayBounds, later};
use super::pair::Region;
use crate::certified::{Goal, Stop};
use crate::engine::{Bounded, Frontier, Heap, Problem, Queue, Rebound};
use crate::pair::body_pair::BodyPair;
use crate::pair::distance_bound::{DistanceBound, descend};
use crate::pair::search::{BoxCell, least};

/// After a step as long as its model's span, the next span is so many times as long.
const LONGER: f64 = 3.0;

/// After a shorter step, the next span is so many times the step.
const AFTER_SHORT: f64 = 1.5;

/// A touch is looked for if it may be closer than the body moves in so many tolerances of the time.
const NEAR: f64 = 2.0;

/// How far into the tolerance after the time of a box it is looked for.
const SOON: f64 = 0.75;

/// A round takes boxes up to this share of the time that is left after the first: where bodies
/// overlap later, boxes come apart for nothing.
const HORIZON: f64 = 0.2;

/// Boxes below this radius are not divided, as a share of the whole box's.
const SMALLEST: f64 = 1e-12;

/// Models bound boxes below this radius, as a share of the whole box's.
const SMALL: f64 = 0.25;

/// A box, and the time until which it is free.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpaceCell<const D: usize> {
    /// Its lower bound is the time.
    pub(super) cell: BoxCell<D>,
    /// The span of time of the next model.
    span: f64,
    /// Whether it goes on undivided.
    is_whole: bool,
    /// Whether the first field was asked for it.
    is_asked: bool,
}

impl<const D: usize> SpaceCell<D> {
    /// The box, and until when it is free.
    pub(super) fn free(&self) -> FreeBox<D> {
        let BoxCell { centre, half, lower, .. } = self.cell;
        let aabb = Aabb { min: centre - half, max: centre + half };
        FreeBox { aabb, until: lower.min(1.0) }
    }
}

impl<const D: usize> Bounded for SpaceCell<D> {
    #[inline]
    fn lower(&self) -> f64 {
        self.cell.lower
    }
}

impl<const D: usize> Rebound for SpaceCell<D> {
    #[inline]
    fn with_lower(&self, lower: f64) -> Self {
        Self { cell: self.cell.with_lower(lower), ..*self }
    }
}

/// Memory of the search.
#[derive(Debug)]
pub(super) struct BoxMemory<const D: usize> {
    halves: Vec<BoxCell<D>>,
    open: Vec<usize>,
    places: Places<D>,
    points: Block<f64, D, BLOCK>,
    values: Column<f64, BLOCK>,
    boxes: Block<Model, D, BLOCK>,
    models: Column<Model, BLOCK>,
    moving_boxes: Block<SpaceTimeModel, D, BLOCK>,
    moving_models: Column<SpaceTimeModel, BLOCK>,
}

/// Boxes that wait.
pub(super) type BoxFrontier<const D: usize> = Frontier<Heap<SpaceCell<D>>>;

/// The largest number of waiting boxes.
const ROOM: usize = 1 << 16;

/// No boxes, and room for them.
pub(super) fn frontier<const D: usize>() -> BoxFrontier<D> {
    Frontier {
        queue: Heap::new(ROOM, BLOCK),
        pending: Vec::with_capacity(BLOCK),
        round: Vec::with_capacity(BLOCK),
    }
}

impl<const D: usize> BoxMemory<D> {
    pub(super) fn new() -> Self {
        Self {
            halves: Vec::with_capacity(BLOCK),
            open: Vec::with_capacity(BLOCK),
            places: Places::new(),
            points: Block::zero(),
            values: Column::zero(),
            boxes: Block::zero(),
            models: Column::zero(),
            moving_boxes: Block::zero(),
            moving_models: Column::zero(),
        }
    }

    /// Begins with the parts of a box.
    pub(super) fn begin(&mut self, root: &Aabb<D>, frontier: &mut BoxFrontier<D>) {
        self.places.clear();
        frontier.queue.clear();
        BoxCell::unknown(root).grid(&mut self.halves);
        let cells = self.halves.iter().map(|cell| SpaceCell {
            cell: cell.with_lower(0.0),
            span: 0.0,
            is_whole: true,
            is_asked: false,
        });
        frontier.pending.clear();
        frontier.pending.extend(cells);
    }
}

/// The search, as a problem of the engine.
pub(super) struct BoxSweep<'s, 'a, const D: usize> {
    /// The body that stays, and the one that goes by, in the coordinates of the first.
    pub(super) bodies: [Moving<'a, D>; 2],
    pub(super) bounds: [DistanceBound<'a, D>; 2],
    /// The way of the first body as the second sees it.
    pub(super) path: Path<D>,
    pub(super) way: WayBounds,
    /// A place is free where one of both values exceeds this, rounding included [m].
    pub(super) level: f64,
    /// A place where both are at most this is one of a touch [m].
    pub(super) touch: f64,
    /// The rounding of values and places [m].
    pub(super) slack: f64,
    /// The radius of the first box [m].
    pub(super) size: f64,
    pub(super) settings: &'s SweepSettings,
    /// How often fields are evaluated until the search is interrupted.
    pub(super) budget: u32,
    pub(super) memory: &'s mut BoxMemory<D>,
    pub(super) evaluations: u32,
    /// Boxes from this time on wait for another round.
    pub(super) horizon: Option<f64>,
    /// The first time known of a touch, and where it is.
    pub(super) upper: f64,
    pub(super) place: Point<D>,
    /// The least bound of closed boxes.
    pub(super) dropped: f64,
    /// The boxes that nothing more is asked about, if they are to be kept.
    pub(super) ruled_out: Option<&'s mut Vec<FreeBox<D>>>,
}

/// What the second field says of a box at its time.
#[derive(Clone, Copy)]
struct Seen<const D: usize> {
    /// The centre in the second body's coordinates, and its velocity there.
    centre: Point<D>,
    velocity: Vector<f64, D>,
    radius: f64,
    stay: Stay,
    /// The larger of both values at the centre is at most this if a touch may be near [m].
    value: f64,
}

impl<'a, const D: usize> BoxSweep<'_, 'a, D> {
    /// Goes on from the start in other coordinates.
    pub(super) fn go_on_in(&mut self, region: Region<'a, D>) {
        let Region { bodies, bounds, path, way, slack, root } = region;
        (self.bodies, self.bounds, self.path, self.way) = (bodies, bounds, path, way);
        (self.level, self.slack) = (FREE * self.touch + slack, slack);
        self.size = root.half_extents().norm();
        self.dropped = f64::INFINITY;
    }

    fn latest(&self) -> f64 {
        self.upper.min(1.0)
    }

    /// Takes out the boxes that the first field alone proves free, for all times.
    fn ask_first(&mut self, round: &mut Vec<SpaceCell<D>>) {
        let BoxMemory { open, points, values, .. } = &mut *self.memory;
        open.clear();
        open.extend((0..round.len()).filter(|&i| !round[i].is_asked));
        if open.is_empty() {
            return;
        }
        let first = &self.bounds[0];
        points.fill(open.len(), |lane| round[open[lane]].cell.centre);
        first.shape.block_distances(points, open.len(), values);
        self.evaluations += open.len() as u32;
        for (&i, f) in open.iter().zip(values.as_slice()) {
            let SpaceCell { cell, is_asked, .. } = &mut round[i];
            let value = first.value(cell.centre, *f);
            *is_asked = true;
            if first.floor(cell.centre, value, cell.radius()) > self.level {
                cell.lower = f64::INFINITY;
            }
        }
        if let Some(boxes) = &mut self.ruled_out {
            let free = round.iter().filter(|space| space.cell.lower == f64::INFINITY);
            boxes.extend(free.map(SpaceCell::free));
        }
        round.retain(|space| space.cell.lower < f64::INFINITY);
    }

    /// The second field at the centres of the boxes, each at its time.
    fn ask_second(&mut self, round: &[SpaceCell<D>], seen: &mut [Seen<D>; BLOCK]) {
        let BoxMemory { places, points, values, .. } = &mut *self.memory;
        let second = &self.bounds[1];
        for (SpaceCell { cell, .. }, seen) in round.iter().zip(&mut *seen) {
            let place = places.at(&self.path, cell.lower);
            seen.centre = place.point(cell.centre);
            seen.velocity = self.path.velocity(place, cell.centre, seen.centre);
            seen.radius = cell.radius();
        }
        points.fill(round.len(), |lane| seen[lane].centre);
        second.shape.block_distances(points, round.len(), values);
        self.evaluations += round.len() as u32;
        for (f, seen) in values.as_slice().iter().zip(seen) {
            let value = second.value(seen.centre, *f);
            seen.value = value;
            seen.stay = Stay::in_ball(
                second.empty(seen.centre, value, self.level),
                seen.radius,
                seen.velocity.norm(),
                self.way.acceleration,
            );
        }
    }

    /// Models of both fields over boxes, and spans of time, where the step is short for the size.
    fn ask_models(&mut self, round: &mut [SpaceCell<D>], seen: &mut [Seen<D>; BLOCK]) {
        let latest = self.latest();
        let (path, acceleration) = (self.path, self.way.acceleration);
        let [first, second] = &self.bounds;
        let BoxMemory { open, places, boxes, models, moving_boxes, moving_models, .. } =
            &mut *self.memory;
        open.clear();
        for (i, space) in round.iter_mut().enumerate() {
            let (SpaceCell { cell, span, .. }, seen) = (space, &seen[i]);
            // A model over a way much longer than the box is as poor as one over a larger box.
            let of_size = seen.radius / seen.velocity.norm();
            let shortest = of_size.max(2.0 * seen.stay.part);
            *span = span.max(shortest).min(latest - cell.lower);
            let far = seen.radius + self.way.speed * *span;
            let is_short = !seen.stay.pays() && seen.stay.part < latest - cell.lower;
            let is_known =
                first.is_known(cell.centre, seen.radius) && second.is_known(seen.centre, far);
            if is_short && is_known && seen.radius <= SMALL * self.size {
                open.push(i);
            }
        }
        if open.is_empty() {
            return;
        }
        boxes.fill_boxes(open.len(), None, |lane| {
            let cell = &round[open[lane]].cell;
            (cell.centre, cell.half)
        });
        first.shape.block_distances(boxes, open.len(), models);
        moving_boxes.fill(open.len(), |lane| {
            let SpaceCell { cell, span, .. } = &round[open[lane]];
            let Seen { centre, velocity, .. } = seen[open[lane]];
            let place = places.at(&path, cell.lower);
            let half = 0.5 * span;
            let bend = 0.5 * acceleration * span * span;
            let middle = centre + velocity * half;
            let mut sides = [Vector::ZERO; D];
            let mut cross = Vector([bend; D]);
            for (k, side) in sides.iter_mut().enumerate() {
                let mut p = cell.centre;
                p[k] += cell.half[k];
                let q = place.point(p);
                *side = q - centre;
                if acceleration > 0.0 {
                    let change = (path.velocity(place, p, q) - velocity) * half;
                    *side += change;
                    for (cross, change) in cross.0.iter_mut().zip(change.0) {
                        *cross += change.abs();
                    }
                }
            }
            Vector(std::array::from_fn(|i| {
                let mut gradient = [0.0; 4];
                for (k, side) in sides.iter().enumerate() {
                    gradient[k] = side[i];
                }
                gradient[3] = velocity[i] * half;
                let (value, lower, upper) = (middle[i], cross[i], cross[i]);
                SpaceTimeModel { value, gradient, lower, upper }
            }))
        });
        second.shape.block_distances(moving_boxes, open.len(), moving_models);
        self.evaluations += 2 * open.len() as u32;
        for (lane, &i) in open.iter().enumerate() {
            let a = first.scaled(models.get(lane));
            let b = scaled(moving_models.get(lane), second);
            let SpaceCell { cell, span, .. } = &mut round[i];
            let stay = Stay::of_models(&in_time(&a), &b, self.level, *span);
            let seen = &mut seen[i];
            seen.stay.or(stay);
            let is_through = stay.part >= *span;
            *span = if is_through { LONGER * *span } else { AFTER_SHORT * stay.part };
            let SpaceTimeModel { value, gradient: [x, y, z, _], lower, upper } = b;
            cell.learn(&[a, Model { value, gradient: [x, y, z], lower, upper }]);
            // Where the first field alone is high enough, the box is free for all times.
            if least::<D>(&a) > self.level {
                seen.stay.part = f64::INFINITY;
            } else {
                cell.contract(&[a, a, a], self.level);
            }
        }
    }

    /// Looks for a touch soon after the time of the first box, if one may be near.
    fn look(&mut self, round: &[SpaceCell<D>], seen: &[Seen<D>; BLOCK]) {
        let is_near = |&i: &usize| {
            let near = NEAR * self.settings.time_tolerance * seen[i].velocity.norm();
            seen[i].value - seen[i].radius <= self.touch + near
        };
        let first = (0..round.len())
            .filter(is_near)
            .min_by(|&i, &k| round[i].cell.lower.total_cmp(&round[k].cell.lower));
        let Some(i) = first else { return };
        let cell = &round[i].cell;
        let (speed, tolerance) = (seen[i].velocity.norm(), self.settings.time_tolerance);
        let latest = (cell.lower + SOON * tolerance).min(1.0);
        if latest < self.upper {
            self.touches(latest, cell.centre);
        }
        // A body that passes within a tolerance has left at `latest`: its boxes become smaller than its way in
        // a tolerance. At `met` its nearest point is there.
        let met = cell.lower + seen[i].value.max(0.0) / speed;
        if seen[i].radius < tolerance * speed && met < latest && met < self.upper {
            self.touches(met, cell.centre);
        }
    }

    /// Looks for a touch at a time, from a point on; `true` if there is one.
    fn touches(&mut self, time: f64, start: Point<D>) -> bool {
        let [first, second] = self.bodies.map(|body| body.at(time));
        // Poses were checked.
        let Ok(mut pair) = BodyPair::new(first, second) else { return false };
        let goal = Goal::least(0.1 * self.touch);
        let (value, p) = descend(&mut pair, start, None, goal, self.slack);
        self.evaluations += pair.evaluations;
        let is_touch = value + self.slack <= self.touch;
        if is_touch {
            (self.upper, self.place) = (time, p);
        }
        is_touch
    }

    /// Looks for an earlier touch after `lower`, by halves: within the tolerance, bodies may be deep
    /// in each other already.
    pub(super) fn refine(&mut self, mut lower: f64) {
        for _ in 0..HALVES {
            if lower >= self.upper {
                return;
            }
            let middle = 0.5 * (lower + self.upper);
            if !self.touches(middle, self.place) {
                lower = middle;
            }
        }
    }
}

/// A model of `f/L` from one of `f`.
fn scaled<const D: usize>(
    model: SpaceTimeModel,
    bound: &DistanceBound<'_, D>,
) -> SpaceTimeModel {
    let scale = bound.scale();
    SpaceTimeModel {
        value: model.value * scale,
        gradient: model.gradient.map(|side| side * scale),
        lower: model.lower * scale,
        upper: model.upper * scale,
    }
}

/// A model of what stays as it is.
fn in_time(model: &Model) -> SpaceTimeModel {
    let Model { value, gradient: [x, y, z], lower, upper } = *model;
    SpaceTimeModel { value, gradient: [x, y, z, 0.0], lower, upper }
}

impl<const D: usize> Problem for BoxSweep<'_, '_, D> {
    type Queue = Heap<SpaceCell<D>>;

    fn round_and_parts(&self) -> (usize, usize) {
        (BLOCK, 1 << D)
    }

    fn decided(&self, lower: f64) -> Option<Stop> {
        self.settings.decided(lower, self.upper)
    }

    fn has_room(&self, frontier: &Frontier<Self::Queue>) -> bool {
        frontier.queue.has_room(BLOCK)
    }

    fn is_spent(&self) -> bool {
        self.evaluations >= self.budget
    }

    fn can_split(&self, queue: &Self::Queue) -> bool {
        queue.least() < self.horizon.unwrap_or(self.latest())
    }

    fn split(&mut self, space: &SpaceCell<D>, round: &mut Vec<SpaceCell<D>>) {
        let (first, latest) = (space.cell.lower, self.latest());
        self.horizon.get_or_insert(first + HORIZON * (latest - first));
        if space.is_whole {
            round.push(*space);
            return;
        }
        let halves = &mut self.memory.halves;
        halves.clear();
        space.cell.halve(halves);
        let part = |cell: &BoxCell<D>| SpaceCell { cell: *cell, is_asked: false, ..*space };
        round.extend(halves.iter().map(part));
    }

    fn bound(&mut self, frontier: &mut Frontier<Self::Queue>) {
        let round = &mut frontier.round;
        self.horizon = None;
        self.ask_first(round);
        let nothing = Seen {
            centre: Vector::ZERO,
            velocity: Vector::ZERO,
            radius: 0.0,
            stay: Stay::default(),
            value: f64::INFINITY,
        };
        let mut seen = [nothing; BLOCK];
        self.ask_second(round, &mut seen);
        self.ask_models(round, &mut seen);
        for (space, seen) in round.iter_mut().zip(&seen) {
            space.cell.lower = later(space.cell.lower, seen.stay.part);
            space.is_whole = seen.stay.pays();
        }
        self.look(round, &seen);
    }

    fn is_open(&self, space: &SpaceCell<D>) -> bool {
        space.cell.lower < self.latest() && space.cell.radius() > SMALLEST * self.size
    }

    fn close(&mut self, space: &SpaceCell<D>, _queue: &mut Self::Queue) {
        self.dropped = self.dropped.min(space.cell.lower);
        if let Some(boxes) = &mut self.ruled_out {
            boxes.push(space.free());
        }
    }

    fn closed(&self) -> f64 {
        self.dropped
    }
}
