// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts and their friction.
//!
//! One tick of a proxy at a surface: the closest point to the device that it can slide to.
//!
//! Each evaluation gives a tangent plane. The proxy moves towards the point above all known
//! planes that is closest to the device, evaluates the field there, and repeats until the point
//! does not change. This is Newton's method on the conditions of the closest point, and an
//! active-set method at creases. Salisbury and Tarr, "Haptic rendering of surfaces defined by
//! implicit functions" (1997), track one tangent plane in the same way. The curvature is learnt
//! from changes of the normal and kept between ticks, so that most goals are right at the first
//! evaluation.
//!
//! Friction: a proxy that is held back on its way along a surface.
//!
//! Let `N` be the depth of the device below the surface and `t` the tangential part of the
//! stretch from device to proxy. The force lies in Coulomb's friction cone if `‖t‖ ≤ μN`. A
//! proxy within the cone of static friction sticks: it does not move at all, so friction never
//! creeps. Beyond the cone, the proxy slips to where `‖t‖ = μ_d N`, the point where a proxy
//! without friction would rest if the device were `μ_d N` closer to the old place of the proxy.
//! Slipping is therefore a [slide](crate::contact::slide) towards a shifted device point, and
//! crosses no surface. The friction cone is that of Harwin and Melder, "Improved haptic
//! rendering for multi-finger manipulation using friction cone based god-objects" (2002).

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};
use palpate_query::constraints::{CAPACITY, PlaneConstraint, pushes};

use crate::curvature::Curvature;
use crate::planes::Planes;
use crate::sampler::{Sample, Sampler};
use crate::surface::Friction;

/// The proxy rests when its next move would change the stretch between device and proxy, and so
/// the force, by less than this relative amount: 0.002 degrees, far less than a hand can feel.
const AT_REST: f64 = 3e-5;

/// The proxy also rests only when that move is less than this part of the device's motion. The
/// remaining error points against the motion, so a hand that circles slowly would gain energy
/// from it (up to 3e-8 J). This bound makes the gain a thousandth of the energy that holding
/// the force for a tick adds.
const LEFT_TO_GO: f64 = 1e-3;

/// A move longer than this multiple of the safe radius goes through the air: up, along and down
/// again.
const WORTH_LIFTING: f64 = 3.0;

/// A goal farther away than this multiple of the device's motion is not trusted: the surface
/// curves away or ends. The proxy then follows the surface step by step.
const WORTH_FOLLOWING: f64 = 8.0;

/// Height of a move through the air, as a multiple of its length. A height of twice the length
/// lands within a tenth of the goal; more gains little and meets a ceiling sooner.
const LIFT: f64 = 2.0;

/// The most samples on the way up. In a right-angled crease, eight samples leave a 20 000th of
/// the way unproven.
const LIFT_SAMPLES: u32 = 8;

/// A sample that covers less than this part of the way up is beside a wall.
const LEAST_COVERED: f64 = 0.3;

/// The most failed lifts in a tick: the first three each reveal a wall, the fourth a ceiling.
const MOST_FAILED_LIFTS: u8 = 3;

/// Length of the first move of a tick, as a multiple of the device's motion: once for a flat
/// wall, and as much again for a curved one.
const FIRST_TRUST: f64 = 2.0;

/// The least length of a move, as a part of a skin: the proxy may have to move while the device
/// rests.
const LEAST_TRUST: f64 = 1.0 / 64.0;

/// After a lowered plane is dropped, the next move is this multiple of the amount it was
/// lowered by: far enough to see its wall again, but not far beyond.
const NEAR_LOWERED: f64 = 4.0;

/// The length of a move, as a part of a skin, at which a cornered proxy stops.
const CORNERED_TRUST: f64 = 1e-4;

/// The most that curvature lengthens a step. Where more were needed, the error shrinks by `1 −
/// 1/8` a step at worst; where the estimate is wrong, the proxy overshoots by no more than
/// this.
const MOST_GAIN: f64 = 8.0;

/// A step along a curved surface ends this part of the surface's fall above it, because a proxy
/// cannot rest below the surface.
const ABOVE: f64 = 0.1;

/// The largest convex curvature kept, as the change of the normal over a skin: twice that of an
/// edge rounded by the probe.
const MOST_CONVEX: f64 = 2.0;

/// The largest concave curvature kept, as the change of the normal over a skin. The probe does
/// not round a hollow; a sharper one is a crease.
const MOST_CONCAVE: f64 = 16.0;

/// Two tangent planes belong to one wall if the known curvature predicts the change of the
/// normal to this relative error.
const SAME_WALL: f64 = 0.2;

/// A displacement shorter than this part of the device's motion does not update the curvature:
/// its end points are too uncertain.
const LEAST_WAY: f64 = 1e-3;

/// A displacement steeper than this does not update the curvature: the square of twice the sine
/// of its angle to the surface.
const ALONG: f64 = 0.01;

/// The local model of the surface near a proxy: tangent planes and curvature.
#[derive(Clone, Debug)]
pub(crate) struct LocalSurface {
    /// The tangent planes seen in this tick.
    planes: Planes,
    /// The curvature.
    curvature: Curvature,
}

impl LocalSurface {
    /// A model without planes, of a flat surface.
    pub(crate) fn new() -> Self {
        Self { planes: Planes::new(), curvature: Curvature::FLAT }
    }

    /// The unit vector away from all planes of the last slide; `None` if they face each other.
    pub(crate) fn up(&self) -> Option<Vector<f64, 3>> {
        self.planes.up()
    }

    /// Forgets the curvature, because the surface may have changed; each slide starts without
    /// planes.
    pub(crate) fn forget(&mut self) {
        self.curvature = Curvature::FLAT;
    }
}

/// Where a proxy is; a slide updates both parts.
pub(crate) struct Place<'a> {
    /// The evaluated point.
    pub(crate) here: &'a mut Sample,
    /// The unit normal of the surface that the proxy last reached.
    pub(crate) normal: &'a mut Vector<f64, 3>,
}

/// Where a proxy is to go.
#[derive(Clone, Copy)]
pub(crate) struct Goal {
    /// The device point, or the point to which friction shifts it [m].
    pub(crate) device: Point<3>,
    /// How far the device point moved in this tick [m].
    pub(crate) motion: f64,
}

/// Slides from `here`, on or above the offset surface, to the point closest to `device`, which
/// moved by `motion` [m] in this tick. Afterwards `here` is the place where the proxy rests, an
/// evaluated point on or above the offset surface, and `normal` is the unit normal of the
/// surface that it last reached. Returns `true` if that surface keeps the proxy from the device.
///
/// Every point of the path lies within the proven reach of an evaluated point, so the path
/// crosses no surface. If the budget ends before the search does, the proxy rests at the
/// closest point found on or above the surface: it lags behind, but is never inside.
///
/// The search writes into the proxy's own sample, because copying a struct whose fields were
/// just stored one by one stalls on store forwarding.
///
/// Real-time: allocates nothing, takes no lock, cannot panic; at most the sampler's budget of
/// evaluations.
pub(crate) fn slide(
    sampler: &mut Sampler<'_>,
    place: Place<'_>,
    goal: Goal,
    LocalSurface { planes, curvature }: &mut LocalSurface,
) -> bool {
    let Place { here, normal } = place;
    let Goal { device, motion } = goal;
    planes.clear();
    let mut slide = Slide {
        curvature,
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
        if slide.go(sampler, slide.here.point) == Outcome::Spent {
            return slide.rest_at_best(sampler);
        }
        slide.best = *slide.here;
    }
    loop {
        match slide.advance(sampler) {
            Outcome::Moved => slide.trust *= 2.0,
            Outcome::Resting => {
                return squared(slide.here.point - device) > sampler.tolerance().powi(2);
            }
            // Facing walls leave no room at full step length; a shorter step does not reach the
            // other wall.
            Outcome::Cornered if slide.trust > CORNERED_TRUST * sampler.skin() => {
                slide.keep_best(sampler);
                let gone = squared(slide.here.point - slide.best.point).sqrt();
                slide.trust =
                    0.125 * if gone > 0.0 { slide.trust.min(gone) } else { slide.trust };
                (*slide.curvature, slide.is_first) = (Curvature::FLAT, true);
                slide.planes.clear();
                slide.failed_lifts = MOST_FAILED_LIFTS;
                *slide.here = slide.best;
            }
            Outcome::Cornered | Outcome::Spent => {
                slide.keep_best(sampler);
                return slide.rest_at_best(sampler);
            }
        }
    }
}

fn squared(way: Vector<f64, 3>) -> f64 {
    way.dot(way)
}

struct Slide<'a> {
    curvature: &'a mut Curvature,
    here: &'a mut Sample,
    /// Of the points visited and left again, the closest to the device that is on or above the
    /// surface.
    best: Sample,
    /// The squared distance from the best point to the device [m²].
    least: f64,
    normal: &'a mut Vector<f64, 3>,
    device: Point<3>,
    planes: &'a mut Planes,
    /// How many lifts met a ceiling or an unknown wall.
    failed_lifts: u8,
    /// How far the device point moved in this tick [m].
    motion: f64,
    /// The trust radius: the longest move that is tried [m]. The error at a crease of curved
    /// walls is of second order in this length. It starts with the device's motion and doubles
    /// with each move.
    trust: f64,
    /// Whether no tangent plane is known yet.
    is_first: bool,
    /// The foot of the last tangent plane.
    last_foot: Point<3>,
    last_normal: Vector<f64, 3>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Outcome {
    Moved,
    Resting,
    /// The planes have no common point.
    Cornered,
    /// The budget is spent, or the field is not finite.
    Spent,
}

impl Slide<'_> {
    /// Learns the tangent plane at the present point, then moves towards the goal.
    #[inline(always)]
    fn advance(&mut self, sampler: &mut Sampler<'_>) -> Outcome {
        let (here, device) = (self.here.point, self.device);
        let (normal, gap) = sampler.tangent(self.here, *self.normal);
        let is_new = self.is_first;
        *self.normal = normal;
        let foot = here - normal * gap;
        self.learn_curvature(sampler, foot, normal);
        let wall = PlaneConstraint { point: foot, normal };
        // The first plane is stored even if the search ends here.
        let is_only = self.planes.is_empty();
        if !is_only {
            self.planes.learn(here, wall, gap);
        }
        // With a single plane, use the values in registers: loading what was just stored would
        // stall.
        let is_one = is_only || self.planes.is_one();
        let goal =
            if is_one { Some(wall.closest(device)) } else { self.planes.closest(device) };
        let Some(mut goal) = goal else { return Outcome::Cornered };

        let is_outside = self.here.gap >= -sampler.tolerance();
        // At the first evaluation of a tick the proxy must be exactly at rest: on a flat wall,
        // which needs only one evaluation a tick, a remaining error would never be corrected.
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
            || is_to_go(MOST_GAIN) && !self.curvature.at_most_doubles(stretch)
        {
            goal = self.along_the_curvature(sampler, [foot, goal], normal);
        }
        let is_at_rest = is_outside && squared(goal - here) <= at_rest;
        if is_only {
            if is_at_rest {
                return Outcome::Resting;
            }
            self.planes.add(wall);
        } else if is_at_rest {
            let Some(lowered) = self.planes.forget_lowered(at_rest.sqrt()) else {
                return Outcome::Resting;
            };
            // The walls of the dropped planes are near, or gone.
            self.trust = self.trust.min(NEAR_LOWERED * lowered);
            goal = self.planes.closest(device).unwrap_or(here);
        }
        let way = goal - here;
        let reach = sampler.reach(self.here).min(self.trust);
        if squared(way) <= reach * reach {
            return self.go(sampler, goal);
        }
        if !is_outside {
            // A straight path to a far goal would stay below the surface.
            let Some(outside) = self.planes.closest(here) else { return Outcome::Cornered };
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
                return Outcome::Moved;
            }
            self.failed_lifts += 1;
        }
        self.go(sampler, here + way * (reach / length))
    }

    /// Moves to a point and evaluates the field there.
    #[inline(always)]
    fn go(&mut self, sampler: &mut Sampler<'_>, point: Point<3>) -> Outcome {
        let Some(sample) = sampler.gradient(point) else { return Outcome::Spent };
        self.keep_best(sampler);
        *self.here = sample;
        Outcome::Moved
    }

    /// Remembers the present point, before it is left, if it is the best so far.
    #[inline(always)]
    fn keep_best(&mut self, sampler: &Sampler<'_>) {
        let distance = squared(self.here.point - self.device);
        if distance < self.least && self.here.gap >= -sampler.tolerance() {
            (self.best, self.least) = (*self.here, distance);
        }
    }

    /// Updates the curvature from the last two tangent points; `foot` is the later one. If the
    /// known curvature explains the change of the normal, the new plane replaces those of the
    /// same wall.
    fn learn_curvature(
        &mut self,
        sampler: &Sampler<'_>,
        foot: Point<3>,
        normal: Vector<f64, 3>,
    ) {
        let (way, turn) = (foot - self.last_foot, normal - self.last_normal);
        let last_normal = self.last_normal;
        // Stored one by one: copying both as a struct would stall on store forwarding.
        self.last_foot = foot;
        self.last_normal = normal;
        if std::mem::replace(&mut self.is_first, false) {
            return;
        }
        let (length, turned) = (squared(way), squared(turn));
        let residual = self.curvature.residual(way, turn);
        let is_explained =
            |residual, turned| squared(residual) <= SAME_WALL * SAME_WALL * turned;
        if is_explained(residual, turned) && self.planes.is_one() {
            self.planes.clear();
        } else {
            let is_turn =
                |way, turn| is_explained(self.curvature.residual(way, turn), squared(turn));
            self.planes.forget_wall(foot, normal, is_turn);
        }
        let most = if turn.dot(way) > 0.0 { MOST_CONVEX } else { MOST_CONCAVE };
        if turned * sampler.skin().powi(2) > most * most * length {
            *self.curvature = Curvature::FLAT;
        } else if length > (LEAST_WAY * self.motion).powi(2)
            && (normal + last_normal).dot(way).powi(2) < length * ALONG
        {
            self.curvature.learn(way, residual, length);
        }
    }

    /// The goal on a tangent plane, corrected along and below the plane for the curvature.
    fn along_the_curvature(
        &self,
        sampler: &Sampler<'_>,
        [foot, goal]: [Point<3>; 2],
        normal: Vector<f64, 3>,
    ) -> Point<3> {
        let depth = normal.dot(foot - self.device);
        let side = goal - foot;
        let length = squared(side);
        let is_on_plane = normal.dot(side).powi(2) <= AT_REST * AT_REST * length;
        if !is_on_plane || depth <= sampler.tolerance() || depth.is_nan() {
            return goal;
        }
        let dimensions = if sampler.nearby().is_flat() { 1 } else { 2 };
        match self.curvature.way(side, depth, dimensions) {
            Some(way) if squared(way) <= MOST_GAIN * MOST_GAIN * length => {
                // wᵀ S w / 2, because the displacement solves (1 − d S) w = side.
                let fall = 0.5 * way.dot(way - side) / depth;
                // Project on the tangent plane: the curvature was learnt at another normal.
                let way = way - normal * normal.dot(way);
                foot + way - normal * (fall - ABOVE * fall.abs())
            }
            _ => goal,
        }
    }

    /// Returns to the best point found; `true` if the device is below the surface.
    fn rest_at_best(&mut self, sampler: &mut Sampler<'_>) -> bool {
        *self.here = self.best;
        *self.normal = sampler.tangent(self.here, *self.normal).0;
        sampler.is_below(self.device).unwrap_or(false)
    }
}

/// The sample `height` above `here` in the direction `up`, if the way there is free.
///
/// The safe ball around the upper sample proves the upper part of the way free; a sample at the
/// end of that part proves the next part, until the rest is within a skin of the surface. Over
/// a plane one sample suffices; in the middle of a crease each sample proves the same fraction
/// of the rest.
fn lift(
    sampler: &mut Sampler<'_>,
    here: &Sample,
    up: Vector<f64, 3>,
    height: f64,
) -> Option<Sample> {
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

/// The most of the stretch that lies along the surface when a single wall holds the proxy. A
/// larger part means a crease, where the depth below one wall is not the normal force.
const ONE_WALL: f64 = 1e-3;

/// A proxy that moves towards a wall by more than this part of its displacement was not at the
/// wall before. Along a curved crease the part is smaller.
const BESIDE: f64 = 0.05;

/// How a surface holds a proxy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(crate) enum Hold {
    /// No contact, or no friction.
    #[default]
    None,
    /// The proxy does not move along the surface.
    Stick,
    /// The proxy moves along the surface against friction.
    Slip,
}

/// The friction of the surface that holds a proxy, and its effect in the tick before.
#[derive(Clone, Copy)]
pub(crate) struct Held {
    pub(crate) friction: Friction,
    pub(crate) hold: Hold,
}

/// What became of a dragged proxy.
#[derive(Clone, Copy)]
pub(crate) struct Dragged {
    /// Whether the surface keeps the proxy from the device.
    pub(crate) contact: bool,
    pub(crate) hold: Hold,
    /// The part of the stretch from device to proxy that friction holds [m]; `None` if static
    /// friction leaves it open, because the proxy sticks or several walls hold it.
    pub(crate) held: Option<Vector<f64, 3>>,
}

/// [Slides](slide) the proxy from `here` towards the point closest to `device`, as far as
/// `friction` permits; `device` moved by `motion` [m] in this tick.
///
/// Real-time: allocates nothing, takes no lock, cannot panic; at most the sampler's budget of
/// evaluations.
pub(crate) fn drag(
    sampler: &mut Sampler<'_>,
    place: Place<'_>,
    goal: Goal,
    held: Held,
    local: &mut LocalSurface,
) -> Dragged {
    let Place { here, normal } = place;
    let Goal { device, motion } = goal;
    let Held { friction, hold } = held;
    if here.tangent.is_none() || friction.fixed <= 0.0 {
        let contact = slide(sampler, Place { here, normal }, goal, local);
        return Dragged { contact, hold: Hold::None, held: Some(Vector::ZERO) };
    }
    let start = *here;
    let (first_normal, gap) = sampler.tangent(&start, *normal);
    let stretch = start.point - device;
    let height = stretch.dot(first_normal);
    let depth = height - gap;
    *normal = first_normal;
    if depth <= 0.0 || gap > sampler.near() {
        let contact = slide(sampler, Place { here, normal }, goal, local);
        return Dragged { contact, hold: Hold::None, held: Some(Vector::ZERO) };
    }
    let stuck = Dragged { contact: true, hold: Hold::Stick, held: None };
    let most = if hold == Hold::Slip { friction.slipping } else { friction.fixed };
    let Some(goal) =
        held_back(device, stretch - first_normal * height, depth, most, friction.slipping)
    else {
        return stuck;
    };
    let slipped = |contact| Dragged { contact, hold: Hold::Slip, held: Some(goal - device) };
    let contact = slide(sampler, Place { here, normal }, Goal { device: goal, motion }, local);
    let pull = here.point - goal;
    let along = pull - *normal * pull.dot(*normal);
    if !contact || along.dot(along) <= ONE_WALL * ONE_WALL * pull.dot(pull) {
        return slipped(contact);
    }
    // A crease. A proxy that was in the crease may stick; one that was beside it, on one wall,
    // slid in.
    let Some(across) = along.normalized() else { return slipped(contact) };
    let way = start.point - here.point;
    let beside = way.dot(*normal).max(way.dot(across));
    if beside > sampler.tolerance().max(BESIDE * way.norm()) {
        return slipped(contact);
    }
    // The walls together press with the part of the stretch across the crease.
    let pressed = *normal * stretch.dot(*normal) + across * stretch.dot(across);
    match held_back(device, stretch - pressed, pressed.norm(), most, friction.slipping) {
        None => {
            (*here, *normal) = (start, first_normal);
            stuck
        }
        Some(goal) => {
            let way = Goal { device: goal, motion };
            let contact = slide(sampler, Place { here, normal }, way, local);
            Dragged { contact, hold: Hold::Slip, held: None }
        }
    }
}

/// The walls that hold a proxy together, and their friction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Walls {
    pub(crate) friction: Friction,
    /// The unit normals of the first `count` walls.
    pub(crate) normals: [Vector<f64, 3>; CAPACITY],
    pub(crate) count: usize,
}

impl Walls {
    /// A single wall.
    pub(crate) fn of_one(friction: Friction, normal: Vector<f64, 3>) -> Self {
        let mut normals = [Vector::ZERO; CAPACITY];
        if let Some(first) = normals.first_mut() {
            *first = normal;
        }
        Self { friction, normals, count: 1 }
    }
}

/// [Drags](drag) a proxy that several walls hold, or that a body pushes along one of them.
///
/// The walls press with `N = Σ λᵢ` where the stretch is `Σ λᵢ nᵢ + t`, and friction holds `t`. So a
/// proxy that sticks to one wall goes on sticking when another body touches it.
///
/// Real-time: allocates nothing, takes no lock, cannot panic; at most the sampler's budget of
/// evaluations.
pub(crate) fn drag_along(
    sampler: &mut Sampler<'_>,
    place: Place<'_>,
    goal: Goal,
    (walls, hold): (&Walls, Hold),
    local: &mut LocalSurface,
) -> Dragged {
    let Goal { device, motion } = goal;
    let stretch = place.here.point - device;
    let pushes = pushes(stretch, walls.normals, walls.count);
    let whole: f64 = pushes.iter().sum();
    let rest =
        pushes.iter().zip(&walls.normals).fold(stretch, |rest, (push, n)| rest - *n * *push);
    let Friction { fixed, slipping, .. } = walls.friction;
    let (normal, gap) = sampler.tangent(place.here, *place.normal);
    *place.normal = normal;
    let is_near = gap <= sampler.near() && place.here.tangent.is_some();
    if fixed <= 0.0 || whole <= 0.0 || !is_near {
        let contact = slide(sampler, place, goal, local);
        return Dragged { contact, hold: Hold::None, held: Some(Vector::ZERO) };
    }
    let most = if hold == Hold::Slip { slipping } else { fixed };
    match held_back(device, rest, whole, most, slipping) {
        None => Dragged { contact: true, hold: Hold::Stick, held: None },
        Some(goal) => {
            let held = Some(goal - device);
            let way = Goal { device: goal, motion };
            let contact = slide(sampler, place, way, local);
            Dragged { contact, hold: Hold::Slip, held }
        }
    }
}

/// The device point shifted by friction towards the proxy's old place; `along` is the
/// displacement along the surface without friction. `None` if `most` times the depth is enough
/// to hold the proxy.
fn held_back(
    device: Point<3>,
    along: Vector<f64, 3>,
    depth: f64,
    most: f64,
    slipping: f64,
) -> Option<Point<3>> {
    let squared = along.dot(along);
    // Written so that NaN sticks.
    let is_loose = squared > most * most * depth * depth;
    is_loose.then(|| device + along * (slipping * depth / squared.sqrt()))
}
