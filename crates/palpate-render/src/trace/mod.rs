// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rays through bodies, 64 at a time, each with a proof that it misses nothing.
//!
//! A ray advances [by balls](balls) as long as that is fast, then [by models](models). What it
//! passes is proven free for every line in its cone, up to where a surface may be in the cone, and
//! from there for the ray itself. Rays that are still under way after many rounds are cast one by
//! one, with a budget.

mod models;
mod pieces;
#[cfg(test)]
mod tests;

use palpate_field::{BLOCK, Block, Column, Shape};
use palpate_query::{Limits, Ray, Stop, cast_ray};

use crate::beam::Beam;
use crate::subject::Surfaces;
use pieces::{Cells, Pieces, Places, is_steep};

/// Rounds by balls: a ray that needs more grazes a surface, which models pass in longer steps.
const ROUNDS_BY_BALLS: u32 = 24;

/// Rounds by models before rays are cast one by one: a ray through a fine thread needs hundreds.
const ROUNDS_BY_MODELS: u32 = 400;

/// By how much of the gap a piece must be nearer than the whole to be a surface: their fields
/// differ by roundings.
const NEARER: f64 = 1e-6;

/// Samples along a ray that may meet any surface, and where the first is, in gaps.
const SAMPLES: u32 = 16;
const FIRST_SAMPLE: f64 = 16.0;

/// How a ray ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// It is proven to meet no surface.
    Free,
    /// It meets a surface, before which it is proven to meet none.
    Surface,
    /// The budget was spent before.
    Undecided,
}

/// What is to be found out about a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Goal {
    /// The first surface that it meets.
    First,
    /// Whether it meets a surface, first or not.
    Any,
    /// Whether its cone is free; if it is not, the ray may end anywhere.
    Cone,
}

/// What a ray met.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Met {
    pub(crate) end: End,
    /// Where, from the origin of the beam [m].
    pub(crate) distance: f64,
    /// `true` if a surface that the ray does not meet may be in its cone.
    pub(crate) is_beside: bool,
}

/// A ray under way.
#[derive(Clone, Copy, Debug)]
struct Lane {
    /// The number of its beam.
    beam: usize,
    distance: f64,
    /// The length of the next step by models, and the last one that was too long [m].
    step: f64,
    too_long: f64,
    /// `true` from where the cone was not proven free.
    is_near: bool,
    /// `true` where the ray has left a surface that may have been in its cone.
    is_beside: bool,
    /// `true` where a step by a model is for the ray alone, without its cone.
    is_thin: bool,
    /// A step for the ray alone that is so many times as long as the cone is wide ends these.
    slender: f64,
    look: Look,
}

/// Whether the field where a ray is has been looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Look {
    /// It has not, and may be zero.
    Due,
    /// It has not, and is positive.
    Needless,
    /// It has.
    Done,
}

/// How many rays were traced, and what they cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Work {
    /// Rays.
    pub rays: u64,
    /// Evaluations of the field: at points, and over parts of rays.
    pub evaluations: u64,
    /// Rays that were cast one by one.
    pub grazing: u64,
    /// Rays that the budget left undecided.
    pub undecided: u64,
}

impl Work {
    /// Adds what was done for another picture.
    pub fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.evaluations += other.evaluations;
        self.grazing += other.grazing;
        self.undecided += other.undecided;
    }
}

/// Traces beams, a block at a time.
#[derive(Debug)]
pub(crate) struct Tracer<'a> {
    surfaces: &'a Surfaces,
    /// What the rays may meet; `None` if that is nothing.
    shape: Option<Shape<3>>,
    /// Its pieces, once they are needed.
    pieces: Option<Pieces>,
    limits: Limits,
    is_steep: bool,
    lanes: Vec<Lane>,
    block: Block<f64, 3, BLOCK>,
    values: Column<f64, BLOCK>,
    cells: Cells,
    places: Places,
    pub(crate) work: Work,
}

impl<'a> Tracer<'a> {
    /// Through `surfaces`, with a budget of evaluations for each ray.
    pub(crate) fn new(surfaces: &'a Surfaces, budget: u32) -> Self {
        Self {
            surfaces,
            shape: None,
            pieces: None,
            limits: Limits::new(surfaces.gap).with_budget(budget),
            is_steep: false,
            lanes: Vec::with_capacity(BLOCK),
            block: Block::zero(),
            values: Column::zero(),
            cells: Cells::new(),
            places: Places::new(surfaces.gap * (1.0 - NEARER)),
            work: Work::default(),
        }
    }

    /// Gets ready for lines in these beams.
    pub(crate) fn aim(&mut self, beams: &[Beam]) {
        self.shape = self.surfaces.along(beams);
        self.pieces = None;
        self.is_steep = self.shape.as_ref().is_some_and(is_steep);
        self.cells.has_steep = self.is_steep;
    }

    /// Traces at most [`BLOCK`] beams within those that it was [aimed](Self::aim) along, and puts
    /// what each met into `met`, in their order.
    pub(crate) fn trace(&mut self, goal: Goal, beams: &[Beam], met: &mut Vec<Met>) {
        self.begin(beams, met);
        if goal == Goal::Any && self.is_steep {
            self.sample(beams, met);
        }
        self.finish(goal, beams, met);
    }

    /// All beams at their beginning.
    fn begin(&mut self, beams: &[Beam], met: &mut Vec<Met>) {
        met.clear();
        self.lanes.clear();
        self.work.rays += beams.len() as u64;
        for (number, beam) in beams.iter().enumerate() {
            met.push(Met { end: End::Free, distance: beam.far, is_beside: false });
            if beam.near < beam.far && self.shape.is_some() {
                self.lanes.push(Lane::new(number, beam));
            }
        }
    }

    /// Ends rays with a surface where points of them are in one.
    fn sample(&mut self, beams: &[Beam], met: &mut [Met]) {
        let first = FIRST_SAMPLE * self.limits.tolerance;
        for sample in 0..SAMPLES {
            let place = |lane: &Lane| {
                let Beam { near, far, .. } = beams[lane.beam];
                let length = far - near;
                // In even ratios, up to the end.
                let share = libm::pow(first / length, f64::from(sample) / f64::from(SAMPLES));
                near + length * share
            };
            self.look(beams, met, |_| true, place);
        }
    }

    /// Ends rays at surfaces, of those that are `due`, at a place of each.
    fn look(
        &mut self,
        beams: &[Beam],
        met: &mut [Met],
        is_due: impl Fn(&Lane) -> bool,
        place: impl Fn(&Lane) -> f64,
    ) {
        let Self { lanes, shape, pieces, places, block, values, work, .. } = self;
        let Some(shape) = &shape else { return };
        let due: Vec<usize> = (0..lanes.len()).filter(|i| is_due(&lanes[*i])).collect();
        if due.is_empty() {
            return;
        }
        let point = |lane: usize| beams[lanes[lane].beam].at(place(&lanes[lane]));
        let mut shares = [1.0; BLOCK];
        if self.is_steep {
            due.iter().for_each(|lane| places.points[*lane] = point(*lane));
            pieces.get_or_insert_with(|| Pieces::of(shape)).free(places, &due, &mut shares);
            work.evaluations += std::mem::take(&mut places.evaluations);
        } else {
            // A field that is not steep skips members of its unions by itself.
            block.fill(due.len(), |i| point(due[i]));
            shape.block_distances(block, due.len(), values);
            work.evaluations += due.len() as u64;
            let is_free = |i: usize| values.get(i) > self.limits.tolerance;
            due.iter().enumerate().for_each(|(i, lane)| {
                shares[*lane] = f64::from(u8::from(is_free(i)));
            });
        }
        let mut number = 0;
        lanes.retain(|lane| {
            let is_free = shares[number] > 0.0;
            number += 1;
            if !is_free {
                let (end, is_beside) = (End::Surface, lane.is_beside);
                met[lane.beam] = Met { end, distance: place(lane), is_beside };
            }
            is_free
        });
    }

    /// Advances rays to their ends.
    fn finish(&mut self, goal: Goal, beams: &[Beam], met: &mut [Met]) {
        let mut budget = self.limits.budget;
        let mut rounds = |most: u32| {
            let rounds = most.min(budget);
            budget -= rounds;
            rounds
        };
        let by_balls = rounds(if self.is_steep { 0 } else { ROUNDS_BY_BALLS });
        for _ in 0..by_balls {
            self.round_by_balls(beams, met);
            self.give_up(goal, met);
        }
        for _ in 0..rounds(ROUNDS_BY_MODELS) {
            self.round_by_models(beams, met);
            self.give_up(goal, met);
        }
        for lane in std::mem::take(&mut self.lanes) {
            let end = self.cast(&beams[lane.beam], lane, budget);
            self.work.undecided += u64::from(end.end == End::Undecided);
            met[lane.beam] = end;
        }
    }

    /// Ends rays that are at a surface, and advances the others by balls.
    fn round_by_balls(&mut self, beams: &[Beam], met: &mut [Met]) {
        let Some(shape) = self.shape.as_ref().filter(|_| !self.lanes.is_empty()) else {
            return;
        };
        let Self { lanes, block, values, work, limits, .. } = self;
        block.fill(lanes.len(), |i| beams[lanes[i].beam].at(lanes[i].distance));
        shape.block_distances(block, lanes.len(), values);
        work.evaluations += lanes.len() as u64;
        let mut number = 0;
        lanes.retain_mut(|lane| {
            let value = values.get(number);
            number += 1;
            let is_free = value > limits.tolerance;
            if is_free {
                lane.advance_by_ball(shape, &beams[lane.beam], value);
            } else {
                let Lane { distance, is_beside, .. } = *lane;
                met[lane.beam] = Met { end: End::Surface, distance, is_beside };
            }
            is_free
        });
        self.end(beams, met);
    }

    /// Ends rays that are at a surface, and advances the others by models.
    fn round_by_models(&mut self, beams: &[Beam], met: &mut [Met]) {
        if self.lanes.is_empty() {
            return;
        }
        self.look(beams, met, |lane| lane.look == Look::Due, |lane| lane.distance);
        let Self { lanes, shape, pieces, cells, work, .. } = self;
        let Some(shape) = shape.as_ref().filter(|_| !lanes.is_empty()) else { return };
        lanes.iter_mut().filter(|lane| lane.look == Look::Due).for_each(|lane| {
            lane.look = Look::Done;
        });
        let pieces = pieces.get_or_insert_with(|| Pieces::of(shape));
        models::advance(pieces, beams, lanes, cells);
        work.evaluations += std::mem::take(&mut cells.evaluations);
        self.end(beams, met);
    }

    /// Ends rays that have come to their end.
    fn end(&mut self, beams: &[Beam], met: &mut [Met]) {
        self.lanes.retain(|lane| {
            let beam = &beams[lane.beam];
            let is_under_way = lane.distance < beam.far;
            if !is_under_way {
                let (end, is_beside) = (End::Free, lane.is_near);
                met[lane.beam] = Met { end, distance: beam.far, is_beside };
            }
            is_under_way
        });
    }

    /// Ends rays of which all is known that is to be found out.
    fn give_up(&mut self, goal: Goal, met: &mut [Met]) {
        if goal == Goal::Cone {
            self.lanes.retain(|lane| {
                if lane.is_near {
                    let (end, distance) = (End::Surface, lane.distance);
                    met[lane.beam] = Met { end, distance, is_beside: true };
                }
                !lane.is_near
            });
        }
    }

    /// Casts what is left of a ray.
    fn cast(&mut self, beam: &Beam, lane: Lane, budget: u32) -> Met {
        self.work.grazing += 1;
        let Lane { distance, is_near, is_beside, .. } = lane;
        let undecided = Met { end: End::Undecided, distance, is_beside: true };
        let ray = Ray::new(beam.at(distance), beam.direction, beam.far - distance);
        let limits = self.limits.with_budget(budget);
        let Some((shape, ray)) = self.shape.as_ref().zip(ray.ok()) else { return undecided };
        let Ok(found) = cast_ray(shape, &ray, &limits) else { return undecided };
        self.work.evaluations += u64::from(found.evaluations);
        match (found.stop, found.best) {
            (Stop::SignKnown, _) => {
                Met { end: End::Free, distance: beam.far, is_beside: is_near }
            }
            (Stop::Converged, Some(_)) => {
                Met { end: End::Surface, distance: distance + found.upper, is_beside }
            }
            _ => Met { distance: distance + found.lower, ..undecided },
        }
    }
}

impl Lane {
    fn new(number: usize, beam: &Beam) -> Self {
        Self {
            beam: number,
            distance: beam.near,
            step: models::first_step(beam),
            too_long: f64::INFINITY,
            is_near: false,
            is_beside: false,
            is_thin: false,
            slender: models::SLENDER,
            look: Look::Due,
        }
    }
}
