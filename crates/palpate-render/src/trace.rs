// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rays through bodies, 64 at a time, each with a proof that it misses nothing.
//!
//! A value of the field proves a ball free of surfaces, and a ray advances through it (Hart 1996,
//! as [`cast_ray`] does). As long as the ball is wider than the ray's cone, the step is so short
//! that the ball holds the cone too: what is passed is proven free for every line in the cone.
//! Rays that are still under way after some rounds graze a surface, and [`cast_ray`] ends them.

use palpate_field::{BLOCK, Block, Column, Shape};
use palpate_query::{Limits, Ray, Stop, cast_ray, free_radius};

use crate::beam::Beam;
use crate::surfaces::Surfaces;

/// Rounds of a block before its last rays are cast one by one: few rays take more, and each round
/// evaluates them alone.
const ROUNDS: u32 = 96;

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
    /// `true` from where the cone is not proven free.
    is_near: bool,
    is_beside: bool,
}

/// How many rays were traced, and what they cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Work {
    /// Rays.
    pub rays: u64,
    /// Evaluations of the field at a point.
    pub evaluations: u64,
    /// Rays that graze a surface, and were cast one by one.
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
    lanes: Vec<Lane>,
    block: Block<f64, 3, BLOCK>,
    values: Column<f64, BLOCK>,
    pub(crate) work: Work,
}

impl<'a> Tracer<'a> {
    /// Through `surfaces`, with a budget of evaluations for each ray.
    pub(crate) fn new(surfaces: &'a Surfaces, budget: u32) -> Self {
        Self {
            shape: &surfaces.whole,
            limits: Limits::new(surfaces.gap).with_budget(budget),
            lanes: Vec::with_capacity(BLOCK),
            block: Block::zero(),
            values: Column::zero(),
            work: Work::default(),
        }
    }

    /// Traces at most [`BLOCK`] beams, and puts what each met into `met`, in their order.
    pub(crate) fn trace(&mut self, beams: &[Beam], met: &mut Vec<Met>) {
        met.clear();
        self.lanes.clear();
        self.work.rays += beams.len() as u64;
        for (beam, Beam { near, far, .. }) in beams.iter().enumerate() {
            met.push(Met { end: End::Free, distance: *far, is_beside: false });
            if near < far {
                let (is_near, is_beside) = (false, false);
                self.lanes.push(Lane { beam, distance: *near, is_near, is_beside });
            }
        }
        for _ in 0..ROUNDS.min(self.limits.budget) {
            if self.lanes.is_empty() {
                return;
            }
            self.round(beams, met);
        }
        for lane in std::mem::take(&mut self.lanes) {
            let end = self.cast(&beams[lane.beam], lane);
            self.work.undecided += u64::from(end.end == End::Undecided);
            met[lane.beam] = end;
        }
    }

    /// Evaluates the field where the rays are, and advances them.
    fn round(&mut self, beams: &[Beam], met: &mut [Met]) {
        let Self { shape, lanes, block, values, work, limits, .. } = self;
        let count = lanes.len();
        block.fill(count, |i| beams[lanes[i].beam].at(lanes[i].distance));
        shape.block_distances(block, count, values);
        work.evaluations += count as u64;
        let mut kept = 0;
        for i in 0..count {
            let mut lane = lanes[i];
            let beam = &beams[lane.beam];
            match lane.advance(shape, beam, values.get(i), limits.tolerance) {
                Some(end) => met[lane.beam] = end,
                None => {
                    lanes[kept] = lane;
                    kept += 1;
                }
            }
        }
        lanes.truncate(kept);
    }

    /// Casts what is left of a ray.
    fn cast(&mut self, beam: &Beam, lane: Lane) -> Met {
        self.work.grazing += 1;
        let Lane { distance, is_near, is_beside, .. } = lane;
        let undecided = Met { end: End::Undecided, distance, is_beside: true };
        let ray = Ray::new(beam.at(distance), beam.direction, beam.far - distance);
        let Ok(found) = ray.and_then(|ray| cast_ray(self.shape, &ray, &self.limits)) else {
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
    /// Advances by what the value of the field proves; the end, if there is one.
    fn advance(&mut self, shape: &Shape<3>, beam: &Beam, value: f64, gap: f64) -> Option<Met> {
        let Self { distance, is_beside, .. } = *self;
        if value <= gap {
            return Some(Met { end: End::Surface, distance, is_beside });
        }
        let ball = free_radius(shape, beam.at(distance), value);
        let cone = beam.radius(distance);
        // Written so that NaN counts as near.
        let step = if ball > cone {
            // The ray leaves a surface that was in its cone.
            self.is_beside |= self.is_near && ball > 2.0 * cone;
            beam.step_through(cone, ball)
        } else {
            self.is_near = true;
            ball
        };
        // A ray that rounding or a promise's region holds is left to the cast.
        if step > 0.0 {
            self.distance += step;
        }
        let is_beside = self.is_near;
        (self.distance >= beam.far).then_some(Met {
            end: End::Free,
            distance: beam.far,
            is_beside,
        })
    }
}
