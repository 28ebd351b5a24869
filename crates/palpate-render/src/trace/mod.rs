// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rays through bodies, 64 at a time, each with a proof that it misses nothing.
//!
//! A ray advances [by balls](balls) as long as that is fast, then [by models](models). What it
//! passes is proven free for every line in its cone, up to where a surface may be in the cone, and
//! from there for the ray itself. Rays that are still under way after many rounds are cast one by
//! one, with a budget.

mod balls;
mod models;
#[cfg(test)]
mod tests;

use palpate_field::{BLOCK, Block, Column, Quality, Shape};
use palpate_query::{Limits, Ray, Stop, cast_ray};

use crate::beam::Beam;
use crate::surfaces::Surfaces;
use models::Models;

/// Rounds by balls: a ray that needs more grazes a surface, which models pass in longer steps.
const ROUNDS_BY_BALLS: u32 = 24;

/// Rounds by models before rays are cast one by one: a ray through a fine thread needs hundreds.
const ROUNDS_BY_MODELS: u32 = 400;

/// Fields steeper than this are passed by models alone: a ball about a value `f` has the radius
/// `f / L`, where models follow the slope that the field has there.
const STEEP: f64 = 1.5;

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
    /// The length of the next step by a model [m].
    step: f64,
    /// `true` from where the cone was not proven free.
    is_near: bool,
    /// `true` where the ray has left a surface that may have been in its cone.
    is_beside: bool,
    /// `true` where a step by a model is for the ray alone, without its cone.
    is_thin: bool,
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
    shape: &'a Shape<3>,
    limits: Limits,
    is_steep: bool,
    lanes: Vec<Lane>,
    block: Block<f64, 3, BLOCK>,
    values: Column<f64, BLOCK>,
    models: Models,
    pub(crate) work: Work,
}

impl<'a> Tracer<'a> {
    /// Through `surfaces`, with a budget of evaluations for each ray.
    pub(crate) fn new(surfaces: &'a Surfaces, budget: u32) -> Self {
        let promise = surfaces.whole.promise();
        Self {
            shape: &surfaces.whole,
            limits: Limits::new(surfaces.gap).with_budget(budget),
            is_steep: promise.outside == Quality::Lipschitz && promise.lipschitz > STEEP,
            lanes: Vec::with_capacity(BLOCK),
            block: Block::zero(),
            values: Column::zero(),
            models: Models::new(),
            work: Work::default(),
        }
    }

    /// Traces at most [`BLOCK`] beams, and puts what each met into `met`, in their order.
    pub(crate) fn trace(&mut self, beams: &[Beam], met: &mut Vec<Met>) {
        met.clear();
        self.lanes.clear();
        self.work.rays += beams.len() as u64;
        for (number, beam) in beams.iter().enumerate() {
            met.push(Met { end: End::Free, distance: beam.far, is_beside: false });
            if beam.near < beam.far {
                self.lanes.push(Lane::new(number, beam));
            }
        }
        let mut budget = self.limits.budget;
        let mut rounds = |most: u32| {
            let rounds = most.min(budget);
            budget -= rounds;
            rounds
        };
        let by_balls = rounds(if self.is_steep { 0 } else { ROUNDS_BY_BALLS });
        for _ in 0..by_balls {
            self.round(beams, met, false);
        }
        for _ in 0..rounds(ROUNDS_BY_MODELS) {
            self.round(beams, met, true);
        }
        for lane in std::mem::take(&mut self.lanes) {
            let end = self.cast(&beams[lane.beam], lane, budget);
            self.work.undecided += u64::from(end.end == End::Undecided);
            met[lane.beam] = end;
        }
    }

    /// Ends rays that are at a surface, and advances the others.
    fn round(&mut self, beams: &[Beam], met: &mut [Met], by_models: bool) {
        if self.lanes.is_empty() {
            return;
        }
        let Self { shape, lanes, block, values, models, work, limits, .. } = self;
        block.fill(lanes.len(), |i| beams[lanes[i].beam].at(lanes[i].distance));
        shape.block_distances(block, lanes.len(), values);
        work.evaluations += lanes.len() as u64;
        let mut kept = 0;
        for i in 0..lanes.len() {
            let (mut lane, value) = (lanes[i], values.get(i));
            let beam = &beams[lane.beam];
            if value <= limits.tolerance {
                let Lane { distance, is_beside, .. } = lane;
                met[lane.beam] = Met { end: End::Surface, distance, is_beside };
                continue;
            }
            if !by_models {
                lane.advance_by_ball(shape, beam, value);
            }
            (lanes[kept], kept) = (lane, kept + 1);
        }
        lanes.truncate(kept);
        if by_models {
            models.advance(shape, beams, lanes);
            work.evaluations += lanes.len() as u64;
        }
        lanes.retain(|lane| {
            let beam = &beams[lane.beam];
            let is_under_way = lane.distance < beam.far;
            if !is_under_way {
                let (end, is_beside) = (End::Free, lane.is_near);
                met[lane.beam] = Met { end, distance: beam.far, is_beside };
            }
            is_under_way
        });
    }

    /// Casts what is left of a ray.
    fn cast(&mut self, beam: &Beam, lane: Lane, budget: u32) -> Met {
        self.work.grazing += 1;
        let Lane { distance, is_near, is_beside, .. } = lane;
        let undecided = Met { end: End::Undecided, distance, is_beside: true };
        let ray = Ray::new(beam.at(distance), beam.direction, beam.far - distance);
        let limits = self.limits.with_budget(budget);
        let Ok(found) = ray.and_then(|ray| cast_ray(self.shape, &ray, &limits)) else {
            return undecided;
        };
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
            is_near: false,
            is_beside: false,
            is_thin: false,
        }
    }
}
