// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! One tick of a proxy at a surface: the closest point to the device that it can slide to.
//!
//! Every tangent plane is linear; the surface is not. So planes are learnt, the point closest
//! to the device above them is approached and the field is asked there, until the point asked
//! for is the point that was asked: Newton's method on the conditions of the closest point, and
//! on creases an active-set method. Salisbury and Tarr, "Haptic rendering of surfaces defined by
//! implicit functions" (1997), track one tangent plane in the same way. How the surface bends is
//! learnt from the turns of its normal and kept, so that a goal is on the bend, and mostly right.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use crate::bend::Bend;
use crate::half_spaces::HalfSpace;
use crate::planes::Planes;
use crate::sampler::{Sample, Sampler};

/// The proxy rests when its next move would change the stretch, and so the force, by less than
/// this part: 0.002 degrees, far less than a hand can tell.
const AT_REST: f64 = 3e-5;

/// It rests when that move is less than this part of the hand's own, too. What is left of it
/// points against the motion, and slow rounds would gain up to 3e-8 J of it; now it is that
/// part of what holding a force for a tick errs by.
const LEFT_TO_GO: f64 = 1e-3;

/// A move longer than this many times what is certain from the surface is made through the
/// air: up, along and down again.
const WORTH_LIFTING: f64 = 3.0;

/// A goal farther away than this many times the device's own motion is not where the device
/// went: the surface bends away or ends, and is followed step by step instead.
const WORTH_FOLLOWING: f64 = 8.0;

/// How high a move through the air goes, as a multiple of its length. Twice lands within a
/// tenth of the goal; more gains little and meets the ceiling sooner.
const LIFT: f64 = 2.0;

/// The most samples on the way up. In a crease of a right angle eight leave a 20 000th of it.
const LIFT_SAMPLES: u32 = 8;

/// A sample on the way up that covers less than this part of it is beside a wall.
const LEAST_COVERED: f64 = 0.3;

/// Lifts that may fail in a tick: each tells of another wall, and the fourth of a ceiling.
const MOST_FAILED_LIFTS: u8 = 3;

/// The first move of a tick is tried as far as this many times the device's motion: what it
/// takes on a flat wall, and as much again for one that bends.
const FIRST_TRUST: f64 = 2.0;

/// The part of a skin that is tried in any case: the device may rest while its proxy does not.
const LEAST_TRUST: f64 = 1.0 / 64.0;

/// Where a plane that was moved down is forgotten, the next move is this many times as long as
/// it was moved: to where its wall is seen again, but not far beyond.
const NEAR_SUNK: f64 = 4.0;

/// The part of a skin at which a cornered proxy gives up and stays where it is.
const CORNERED_TRUST: f64 = 1e-4;

/// The most a step along a bent surface is lengthened: what is left of it converges by
/// `1 − 1/8` a step at worst, and a bend that was misjudged throws the proxy no further.
const MOST_GAIN: f64 = 8.0;

/// The part of the fall of a bent surface that a step stays above it: below the surface it
/// could not rest.
const ABOVE: f64 = 0.1;

/// The sharpest bend, in turns of the normal over a skin: twice that of an edge, as the probe
/// rounds it.
const MOST_BEND: f64 = 2.0;

/// Likewise of a hollow, which nothing rounds. What is sharper is a crease.
const MOST_HOLLOW: f64 = 16.0;

/// A wall is the same if the bend tells the turn of its normal up to this part.
const SAME_WALL: f64 = 0.2;

/// A way shorter than this part of the hand's motion tells nothing of the bend: its ends are
/// guesses.
const LEAST_WAY: f64 = 1e-3;

/// Nor does one that does not lead along the surface: the square of twice the sine of its angle
/// to it.
const ALONG: f64 = 0.01;

/// What is known of the surface near a proxy.
#[derive(Clone, Debug)]
pub(crate) struct Ground<const D: usize> {
    /// Its tangent planes, for a tick.
    planes: Planes<D>,
    /// How it bends.
    bend: Bend<D>,
}

impl<const D: usize> Ground<D> {
    /// Nothing is known yet.
    pub(crate) fn new() -> Self {
        Self { planes: Planes::new(), bend: Bend::FLAT }
    }

    /// Another surface may be there now.
    pub(crate) fn forget(&mut self) {
        self.bend = Bend::FLAT;
    }
}

/// Slides from `here`, on or above the offset surface, to the point closest to `device`, which
/// moved by `motion` [m] in this tick. Then `here` is where the proxy rests, an evaluated point
/// on or above the offset surface, and `normal` the unit normal of the surface last seen; `true`
/// if that surface keeps the proxy from the device.
///
/// Each point of the way is within the reach of an evaluated one, so the way crosses nothing. If
/// the budget ends before the search does, the proxy rests at the closest point found that is on
/// or above the surface: later than it could, never inside.
///
/// It works in the place where the proxy keeps its sample: a copy of a whole would wait until its
/// parts, just found, are written.
///
/// Real-time: allocates nothing, takes no lock, cannot panic; at most the sampler's budget of
/// evaluations.
pub(crate) fn slide<const D: usize>(
    sampler: &mut Sampler<'_, D>,
    (here, normal): (&mut Sample<D>, &mut Vector<f64, D>),
    (device, motion): (Point<D>, f64),
    Ground { planes, bend }: &mut Ground<D>,
) -> bool {
    planes.clear();
    let mut slide = Slide {
        bend,
        best: *here,
        last_foot: here.point,
        last_normal: *normal,
        least: squared(here.point - device),
        here,
        normal,
        device,
        planes,
        failed_lifts: 0,
        trust: f64::max(FIRST_TRUST * motion, LEAST_TRUST * sampler.skin()),
        motion,
        is_first: true,
    };
    if slide.here.tangent.is_none() {
        if slide.go(sampler, slide.here.point) == Turn::Spent {
            return slide.rest_at_best(sampler);
        }
        slide.best = *slide.here;
    }
    loop {
        match slide.turn(sampler) {
            Turn::Moved => slide.trust *= 2.0,
            Turn::Resting => {
                return squared(slide.here.point - device) > sampler.tolerance().powi(2);
            }
            // Between facing walls no plane leaves room: less of a step does not get there.
            Turn::Cornered if slide.trust > CORNERED_TRUST * sampler.skin() => {
                slide.keep_best(sampler);
                let gone = squared(slide.here.point - slide.best.point).sqrt();
                slide.trust =
                    0.125 * if gone > 0.0 { slide.trust.min(gone) } else { slide.trust };
                (*slide.bend, slide.is_first) = (Bend::FLAT, true);
                slide.planes.clear();
                slide.failed_lifts = MOST_FAILED_LIFTS;
                *slide.here = slide.best;
            }
            Turn::Cornered | Turn::Spent => {
                slide.keep_best(sampler);
                return slide.rest_at_best(sampler);
            }
        }
    }
}

fn squared<const D: usize>(way: Vector<f64, D>) -> f64 {
    way.dot(way)
}

struct Slide<'a, const D: usize> {
    bend: &'a mut Bend<D>,
    here: &'a mut Sample<D>,
    /// The point closest to the device that is on or above the surface, of those that were
    /// left again.
    best: Sample<D>,
    /// Its squared distance to the device [m²].
    least: f64,
    normal: &'a mut Vector<f64, D>,
    device: Point<D>,
    planes: &'a mut Planes<D>,
    /// How often the way up was not free: there is a ceiling, or a wall not yet known.
    failed_lifts: u8,
    /// How far the device point moved in this tick [m].
    motion: f64,
    /// The longest move that is tried [m]: a crease of bent walls is known to second order in
    /// it. It starts with the motion of the hand and doubles with each move.
    trust: f64,
    /// Whether there was no tangent plane yet.
    is_first: bool,
    /// Where the last tangent plane touched.
    last_foot: Point<D>,
    last_normal: Vector<f64, D>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Turn {
    Moved,
    Resting,
    /// The planes leave no room.
    Cornered,
    /// The budget is spent, or the field is not finite.
    Spent,
}

impl<const D: usize> Slide<'_, D> {
    /// Looks around, and goes on from there.
    #[inline(always)]
    fn turn(&mut self, sampler: &mut Sampler<'_, D>) -> Turn {
        let (here, device) = (self.here.point, self.device);
        let (normal, gap) = sampler.tangent(self.here, *self.normal);
        let is_new = self.is_first;
        *self.normal = normal;
        let foot = here - normal * gap;
        self.learn_bend(sampler, (foot, normal));
        let wall = HalfSpace { point: foot, normal };
        // The only one is written down where it is not the last, too.
        let is_only = self.planes.is_empty();
        if !is_only {
            self.planes.learn(here, wall, gap);
        }
        // Of one alone not from memory, which waits for what was just written.
        let is_one = is_only || self.planes.is_one();
        let goal =
            if is_one { Some(wall.closest(device)) } else { self.planes.closest(device) };
        let Some(mut goal) = goal else { return Turn::Cornered };

        let is_outside = self.here.gap >= -sampler.tolerance();
        // The point of the last tick has to be at rest exactly: what is left would never be made
        // up for on a flat wall, which needs one evaluation and no more.
        let stretch = squared(device - here);
        let left = if is_new {
            0.0
        } else {
            (AT_REST * AT_REST * stretch).min((LEFT_TO_GO * self.motion).powi(2))
        };
        let at_rest = sampler.tolerance().powi(2) + left;
        let on_plane = squared(goal - here);
        let is_to_go = |gain: f64| gain * gain * on_plane > at_rest;
        if !is_outside
            || is_to_go(2.0)
            || is_to_go(MOST_GAIN) && !self.bend.at_most_doubles(stretch)
        {
            goal = self.over_the_bend((foot, normal), goal, sampler.tolerance());
        }
        let is_at_rest = is_outside && squared(goal - here) <= at_rest;
        if is_only {
            if is_at_rest {
                return Turn::Resting;
            }
            self.planes.add(wall);
        } else if is_at_rest {
            let Some(sunk) = self.planes.forget_sunk(at_rest.sqrt()) else {
                return Turn::Resting;
            };
            // The walls that they were of are not far, or gone.
            self.trust = self.trust.min(NEAR_SUNK * sunk);
            goal = self.planes.closest(device).unwrap_or(here);
        }
        let way = goal - here;
        let reach = sampler.reach(self.here).min(self.trust);
        if squared(way) <= reach * reach {
            return self.go(sampler, goal);
        }
        if !is_outside {
            // Straight on, the way to a far goal would stay below the surface.
            let Some(outside) = self.planes.closest(here) else { return Turn::Cornered };
            let way = outside - here;
            let part = (reach / way.norm()).min(1.0);
            return self.go(sampler, here + way * part);
        }
        let length = way.norm();
        let is_far = length > WORTH_LIFTING * sampler.reach(self.here)
            && length < WORTH_FOLLOWING * self.motion;
        if is_far && self.failed_lifts < MOST_FAILED_LIFTS {
            let up = self.planes.up().unwrap_or(normal);
            if let Some(above) = lift(sampler, self.here, up, LIFT * length) {
                self.keep_best(sampler);
                *self.here = above;
                return Turn::Moved;
            }
            self.failed_lifts += 1;
        }
        self.go(sampler, here + way * (reach / length))
    }

    /// Goes to a point and asks what is there.
    #[inline(always)]
    fn go(&mut self, sampler: &mut Sampler<'_, D>, point: Point<D>) -> Turn {
        let Some(sample) = sampler.gradient(point) else { return Turn::Spent };
        self.keep_best(sampler);
        *self.here = sample;
        Turn::Moved
    }

    /// Keeps this point, which is left, if it is the best.
    #[inline(always)]
    fn keep_best(&mut self, sampler: &Sampler<'_, D>) {
        let distance = squared(self.here.point - self.device);
        if distance < self.least && self.here.gap >= -sampler.tolerance() {
            (self.best, self.least) = (*self.here, distance);
        }
    }

    /// Learns how the surface bends between the last two tangent points, of which this is the
    /// later. Where it bends as was known, it is one wall, of which this plane is the latest.
    fn learn_bend(
        &mut self,
        sampler: &Sampler<'_, D>,
        (foot, normal): (Point<D>, Vector<f64, D>),
    ) {
        let (way, turn) = (foot - self.last_foot, normal - self.last_normal);
        let last_normal = self.last_normal;
        // Each on its own: a copy of both waits for its parts to be written.
        self.last_foot = foot;
        self.last_normal = normal;
        if std::mem::replace(&mut self.is_first, false) {
            return;
        }
        let (length, turned) = (squared(way), squared(turn));
        let untold = self.bend.untold(way, turn);
        let is_told = |untold, turned| squared(untold) <= SAME_WALL * SAME_WALL * turned;
        if is_told(untold, turned) && self.planes.is_one() {
            self.planes.clear();
        } else {
            let is_turn = |way, turn| is_told(self.bend.untold(way, turn), squared(turn));
            self.planes.forget_wall((foot, normal), is_turn);
        }
        let most = if turn.dot(way) > 0.0 { MOST_BEND } else { MOST_HOLLOW };
        if turned * sampler.skin().powi(2) > most * most * length {
            *self.bend = Bend::FLAT;
        } else if length > (LEAST_WAY * self.motion).powi(2)
            && (normal + last_normal).dot(way).powi(2) < length * ALONG
        {
            self.bend.learn(way, untold, length);
        }
    }

    /// The goal on a tangent plane, moved on and down for the bend of the surface.
    fn over_the_bend(
        &self,
        (foot, normal): (Point<D>, Vector<f64, D>),
        goal: Point<D>,
        tolerance: f64,
    ) -> Point<D> {
        let depth = normal.dot(foot - self.device);
        let side = goal - foot;
        let length = squared(side);
        let is_on_plane = normal.dot(side).powi(2) <= AT_REST * AT_REST * length;
        if !is_on_plane || depth <= tolerance || depth.is_nan() {
            return goal;
        }
        match self.bend.way(side, depth) {
            Some(way) if squared(way) <= MOST_GAIN * MOST_GAIN * length => {
                // wᵀ S w / 2, as the way solves (1 − d S) w = side.
                let fall = 0.5 * way.dot(way - side) / depth;
                // The bend was learnt where the surface faced another way.
                let way = way - normal * normal.dot(way);
                foot + way - normal * (fall - ABOVE * fall.abs())
            }
            _ => goal,
        }
    }

    /// Goes back to the best point found; whether the device is below the surface.
    fn rest_at_best(&mut self, sampler: &mut Sampler<'_, D>) -> bool {
        *self.here = self.best;
        *self.normal = sampler.tangent(self.here, *self.normal).0;
        sampler.is_below(self.device).unwrap_or(false)
    }
}

/// The sample `height` above `here` in the direction `up`, if the way there is free.
///
/// The ball about the sample above covers the upper part of the way; a sample where it ends
/// covers more, until the rest is within a skin of the surface. Over a plane one sample does;
/// up the middle of a crease each covers the same part of what is left.
fn lift<const D: usize>(
    sampler: &mut Sampler<'_, D>,
    here: &Sample<D>,
    up: Vector<f64, D>,
    height: f64,
) -> Option<Sample<D>> {
    let above = sampler.gradient(here.point + up * height)?;
    let covered = sampler.clear_radius(&above);
    if covered < LEAST_COVERED * height {
        return None;
    }
    let mut left = height - covered;
    for _ in 0..LIFT_SAMPLES {
        if left <= sampler.clear_radius(here) {
            return Some(above);
        }
        let between = sampler.distance(here.point + up * left)?;
        let covered = sampler.clear_radius(&between);
        if covered < LEAST_COVERED * left {
            return None;
        }
        left -= covered;
    }
    None
}
