// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The first touch of a segment or a triangle that moves, and a field.
//!
//! Best-first branch and bound over parts of the element, where the bound of a part is the time
//! until which it is free. A value f at any point p, on the part or off it, proves a ball of radius
//! f/L about p empty; the part is free until its first vertex leaves the ball, as the distance from
//! p is convex. So each part advances through time on its own: those near the surface in small steps
//! or in smaller parts, those that are passed by in one. From points lifted off the part along the
//! gradient, the ball is nearly a half-space, and the step is nearly that of the tangent plane.

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Block, Column, Point, SHORT, Shape, Vector};

use super::first_touch::{FirstTouch, Start};
use super::motion::Motion;
use super::moving::Moving;
use super::path::{Path, Place, WayBounds};
use super::settings::{FREE, SweepSettings};
use crate::certified::Stop;
use crate::contact::Contact;
use crate::element::{Element, parts_of_one};
use crate::engine::{self, Bounded, Frontier, Problem};
use crate::error::QueryError;
use crate::sampler::{Sampler, Samples, normal};

/// Heights over the centre where a part has so many samples, as shares of its height.
const SHARES: [f64; SHORT] = [1.0, 0.35, 3.0, 0.1, 8.0, 0.03, 20.0, 0.01];

/// Of the way that is left to a ball's edge, the share that bends of the way may take.
const BEND: f64 = 0.25;

/// A part goes on undivided if its step is at least this share of its centre's alone.
const PAYS: f64 = 0.3;

/// The shortest span of a model.
const SHORTEST: f64 = 1e-6;

/// The largest number of halvings: such parts are as small as roundings of the whole.
const MOST_LEVELS: u32 = 48;

/// The largest number of waiting parts.
const ROOM: usize = 8192;

/// A part of the element and the time until which it is free.
#[derive(Clone, Copy, Debug)]
struct Part<const N: usize, const D: usize> {
    /// In the element's coordinates.
    element: Element<N, D>,
    /// Before this time it is free.
    free: f64,
    /// How far samples are lifted [m].
    height: f64,
    /// How often the element was halved.
    level: u32,
    /// Whether it goes on undivided.
    is_whole: bool,
}

impl<const N: usize, const D: usize> Bounded for Part<N, D> {
    #[inline]
    fn lower(&self) -> f64 {
        self.free
    }
}

/// Memory of sweeps of elements, kept from one to the next: it is allocated once.
#[derive(Debug)]
pub struct ElementSweep<const N: usize, const D: usize> {
    frontier: Frontier<Vec<Part<N, D>>>,
    samples: Samples<D>,
    cells: Block<Model, D, BLOCK>,
    models: Column<Model, BLOCK>,
}

impl<const N: usize, const D: usize> ElementSweep<N, D> {
    /// Room for sweeps of elements of `N` points in `D` dimensions.
    #[must_use]
    pub fn new() -> Self {
        Self {
            frontier: Frontier {
                queue: Vec::with_capacity(ROOM),
                pending: Vec::new(),
                round: Vec::with_capacity(SHORT),
            },
            samples: Samples::new(),
            cells: Block::zero(),
            models: Column::zero(),
        }
    }
}

impl<const N: usize, const D: usize> Default for ElementSweep<N, D> {
    fn default() -> Self {
        Self::new()
    }
}

/// When an element that moves touches a field first, which may move too: the first time at which the
/// field is at most `settings.gap` anywhere on the element.
///
/// # Errors
///
/// If a pose is NaN or out of range, or a setting is not positive.
pub fn sweep_element<'a, const N: usize, const D: usize>(
    field: impl Into<Moving<'a, D>>,
    element: &Element<N, D>,
    motion: impl Into<Motion<D>>,
    settings: &SweepSettings,
    workspace: &mut ElementSweep<N, D>,
) -> Result<FirstTouch<D>, QueryError> {
    settings.check()?;
    let (field, body) = (field.into(), motion.into());
    field.motion.check(0)?;
    body.check(1)?;
    let ElementSweep { frontier, samples, cells, models } = workspace;
    let path = Path { field: field.motion, body };
    let way = path.bounds(&element.vertices);
    let weights = element.centre_weights();
    let radius = element.farthest(element.at(&weights));
    let highest = way.speed + HIGHEST * radius;
    let reach = way.far + highest;
    let sampler = Sampler::new(field.shape, samples, reach, FREE * settings.gap);
    let flat = element.flattened(&weights);
    let whole = flat.unwrap_or(*element);
    let mut search = ElementSearch {
        weights: whole.centre_weights(),
        parts: if flat.is_some() { 2 } else { parts_of_one::<N>() },
        apex: apex(&whole),
        sampler,
        field: field.shape,
        cells,
        models,
        path,
        way,
        settings,
        radius,
        highest,
        upper: f64::INFINITY,
        best: None,
        dropped: f64::INFINITY,
    };
    frontier.queue.clear();
    frontier.queue.push(Part {
        element: whole,
        free: 0.0,
        height: radius,
        level: 0,
        is_whole: true,
    });
    let end = engine::search(&mut search, frontier);
    let lower = frontier.lower(search.dropped);
    Ok(search.answer(field, lower, end.stop()))
}

/// The highest samples, in radii of the element and besides its way.
const HIGHEST: f64 = 16.0;

/// The search for the first touch, as a problem of the engine.
struct ElementSearch<'s, 'a, const N: usize, const D: usize> {
    sampler: Sampler<'a, D>,
    field: &'a Shape<D>,
    cells: &'s mut Block<Model, D, BLOCK>,
    models: &'s mut Column<Model, BLOCK>,
    path: Path<D>,
    way: WayBounds,
    settings: &'s SweepSettings,
    /// The weights of a part's vertices in its centre, and the number of its halves.
    weights: [f64; N],
    parts: usize,
    /// The vertex across from the longest edge.
    apex: usize,
    /// Of the smallest ball around the element, and of the highest sample [m].
    radius: f64,
    highest: f64,
    /// The first time known of a touch, and the point of the element that does.
    upper: f64,
    best: Option<Point<D>>,
    /// The least bound of closed parts.
    dropped: f64,
}

/// A part on its way, in the field's coordinates.
#[derive(Clone, Copy)]
struct Way<const N: usize, const D: usize> {
    places: [Point<D>; N],
    velocities: [Vector<f64, D>; N],
    /// The centre, and the velocity there.
    centre: Point<D>,
    mean: Vector<f64, D>,
}

/// How long a part is free, and how long its centre alone is: smaller parts may gain the difference.
#[derive(Clone, Copy, Debug, Default)]
struct Stay {
    part: f64,
    centre: f64,
}

impl Stay {
    fn pays(&self) -> bool {
        self.part > 0.0 && self.part >= PAYS * self.centre
    }

    fn or(&mut self, other: Self) {
        *self = Self { part: self.part.max(other.part), centre: self.centre.max(other.centre) };
    }
}

impl<const N: usize, const D: usize> ElementSearch<'_, '_, N, D> {
    fn answer(&mut self, field: Moving<'_, D>, lower: f64, stop: Stop) -> FirstTouch<D> {
        let evaluations = self.sampler.evaluations;
        if stop == Stop::SignKnown {
            let (lower, upper) = (1.0, 1.0);
            return FirstTouch { lower, upper, contact: None, start: None, stop, evaluations };
        }
        let upper = self.upper;
        let lower = lower.min(upper).min(1.0);
        let mut touch =
            FirstTouch { lower, upper, contact: None, start: None, stop, evaluations };
        if let Some(p) = self.best {
            let place = self.path.at(upper);
            let q = place.point(p);
            let (_, gradient) = self.sampler.slope(q);
            touch.evaluations = self.sampler.evaluations;
            let surface = field.shape.surface_point(q);
            if let (Some(surface), Some(normal)) = (surface, normal(gradient)) {
                let world = self.path.field.pose(upper);
                touch.contact = Some(Contact::new(surface, q, normal).placed(&world));
                let relative = self.path.velocity(&place, p, q);
                touch.start = (upper == 0.0).then(|| Start::of(relative, normal));
            }
        }
        touch
    }

    /// Notes a point of the element that touches at a time.
    fn found(&mut self, time: f64, p: Point<D>) {
        if time < self.upper {
            (self.upper, self.best) = (time, Some(p));
        }
    }

    /// The way of a part.
    #[inline]
    fn way_of(&self, part: &Part<N, D>, place: &Place<D>) -> Way<N, D> {
        let mut way = Way {
            places: [Vector::ZERO; N],
            velocities: [Vector::ZERO; N],
            centre: Vector::ZERO,
            mean: Vector::ZERO,
        };
        for (k, p) in part.element.vertices.iter().enumerate() {
            let q = place.point(*p);
            let v = self.path.velocity(place, *p, q);
            (way.places[k], way.velocities[k]) = (q, v);
            way.centre += q * self.weights[k];
            way.mean += v * self.weights[k];
        }
        way
    }

    /// How long a part stays in a ball of a `radius` about `p`; zero if it is not in it.
    #[inline]
    fn stays(&self, way: &Way<N, D>, p: Point<D>, radius: f64) -> Stay {
        let mut far = 0.0_f64;
        for place in &way.places {
            let apart = *place - p;
            far = far.max(apart.dot(apart));
        }
        let centre = self.exit(way.centre - p, way.mean, radius);
        let spare = radius - far.sqrt();
        // Written so that NaN is no time.
        if !(spare > 0.0) {
            return Stay { part: 0.0, centre };
        }
        let bend = if self.way.acceleration > 0.0 { BEND * spare } else { 0.0 };
        let mut part = if bend > 0.0 {
            (2.0 * bend / self.way.acceleration).sqrt()
        } else {
            f64::INFINITY
        };
        let centre = centre.min(part);
        for (place, velocity) in way.places.iter().zip(&way.velocities) {
            let exit = self.exit(*place - p, *velocity, radius - bend);
            part = if exit < part { exit } else { part };
        }
        Stay { part: part * (1.0 - 1e-12), centre }
    }

    /// When a point leaves a ball, `apart` from its middle at first.
    #[inline]
    fn exit(&self, apart: Vector<f64, D>, velocity: Vector<f64, D>, radius: f64) -> f64 {
        // |o + s v| < radius from s = 0 on.
        let (half, squared) = (apart.dot(velocity), velocity.dot(velocity));
        let rest = radius * radius - apart.dot(apart);
        // Written so that NaN is no time.
        if !(radius > 0.0 && rest > 0.0) {
            return 0.0;
        }
        let root = (half * half + squared * rest).sqrt();
        // Of both forms of the root that which does not cancel; a point at rest stays.
        if half > 0.0 { rest / (root + half) } else { (root - half) / squared }
    }

    /// Advances the parts of a round.
    fn advance(&mut self, parts: &mut [Part<N, D>]) {
        let count = parts.len();
        let mut place = self.path.at(parts[0].free);
        let ways: [Way<N, D>; SHORT] = std::array::from_fn(|i| {
            let part = &parts[i.min(count - 1)];
            if part.free != place.time {
                place = self.path.at(part.free);
            }
            self.way_of(part, &place)
        });
        let centres = ways.map(|way| way.centre);
        let (values, directions) = self.sampler.slopes(&centres);
        let mut stays = [Stay::default(); SHORT];
        for i in 0..count {
            if values[i] <= (1.0 - FREE) * self.settings.gap {
                self.found(parts[i].free, parts[i].element.at(&self.weights));
            }
            stays[i] =
                self.stays(&ways[i], centres[i], self.free_radius(centres[i], values[i]));
        }
        self.lift(parts, &ways, &directions, &mut stays);
        self.look(parts, &ways, &values, &directions);
        self.model(parts, &ways, &mut stays);
        for (part, stay) in parts.iter_mut().zip(&stays) {
            part.free += stay.part;
            part.is_whole = stay.pays();
        }
    }

    /// Lengthens steps that are short for the size of their parts by models of the field over the
    /// parts and spans of time.
    fn model(
        &mut self,
        parts: &[Part<N, D>],
        ways: &[Way<N, D>; SHORT],
        stays: &mut [Stay; SHORT],
    ) {
        let latest = self.upper.min(1.0);
        let (mut open, mut spans, mut count) = ([0; SHORT], [0.0; SHORT], 0);
        for (i, part) in parts.iter().enumerate() {
            if !stays[i].pays() && part.free + stays[i].part < latest {
                open[count] = i;
                spans[count] = stays[i].centre.max(SHORTEST).min(latest - part.free);
                count += 1;
            }
        }
        if count == 0 {
            return;
        }
        let (apex, acceleration) = (self.apex, self.way.acceleration);
        self.cells.fill(count, |lane| {
            let (way, span) = (&ways[open[lane]], spans[lane]);
            let half = 0.5 * span;
            let ([c, e], [v, de]) = (frame(&way.places, apex), frame(&way.velocities, apex));
            let bend = 0.5 * acceleration * span * span;
            Vector(std::array::from_fn(|k| {
                let [u, w] = [0, 1].map(|i| e[i][k] + de[i][k] * half);
                let cross = half * (de[0][k].abs() + de[1][k].abs()) + bend;
                let (value, along) = (c[0][k] + v[0][k] * half, v[0][k] * half);
                Model { value, gradient: [u, w, along], lower: cross, upper: cross }
            }))
        });
        self.sampler.evaluations += count as u32;
        self.field.block_distances(self.cells, count, self.models);
        let steepness = &self.sampler.steepness;
        let level = FREE * self.settings.gap
            + steepness.slack
            + self.way.rounding * steepness.lipschitz;
        for (lane, &i) in open[..count].iter().enumerate() {
            let Model { value, gradient: [u, v, t], lower, .. } = self.models.get(lane);
            let (base, middle) = (value - lower - level, value - level);
            let corners = if N == 2 {
                [base + u, base - u, base + u]
            } else {
                [base + v, base - v + u, base - v - u]
            };
            let positive = |values: &[f64]| {
                values.iter().fold(1.0_f64, |share, value| share.min(positive_share(*value, t)))
            };
            let [part, centre] =
                [positive(&corners), positive(&[middle])].map(|share| share * spans[lane]);
            stays[i].or(Stay { part, centre: centre.min(spans[lane]) });
        }
    }

    #[inline]
    fn free_radius(&self, p: Point<D>, value: f64) -> f64 {
        self.sampler.free_radius(p, value - self.way.rounding)
    }

    /// Lengthens the steps by points lifted over the centres.
    fn lift(
        &mut self,
        parts: &mut [Part<N, D>],
        ways: &[Way<N, D>; SHORT],
        directions: &[Vector<f64, D>; SHORT],
        stays: &mut [Stay; SHORT],
    ) {
        let count = parts.len();
        let mut best = [0.0; SHORT];
        let rounds = if count > SHORT / 2 { 2 } else { 1 };
        let of_each = SHORT / count;
        for round in 0..rounds {
            let share = |lane: usize| SHARES[lane % of_each + round];
            let points: [Point<D>; SHORT] = std::array::from_fn(|lane| {
                let i = (lane / of_each).min(count - 1);
                ways[i].centre + directions[i] * (share(lane) * parts[i].height)
            });
            let values = self.sampler.values(&points);
            for lane in 0..of_each * count {
                let i = lane / of_each;
                let radius = self.free_radius(points[lane], values[lane]);
                let stay = self.stays(&ways[i], points[lane], radius);
                if stay.part > stays[i].part {
                    best[i] = share(lane);
                }
                stays[i].or(stay);
            }
        }
        for (part, best) in parts.iter_mut().zip(best) {
            let factor = match best {
                0.0 => 0.3,
                1.0 => 1.5,
                share => share,
            };
            part.height = (part.height * factor).min(self.highest);
        }
    }

    /// Looks for touches where the tangent planes say that they are: of the centres, and of the
    /// vertices that are lowest.
    fn look(
        &mut self,
        parts: &[Part<N, D>],
        ways: &[Way<N, D>; SHORT],
        values: &[f64; SHORT],
        directions: &[Vector<f64, D>; SHORT],
    ) {
        let gap = (1.0 - FREE) * self.settings.gap;
        for of_centre in [false, true] {
            let latest = self.upper.min(1.0);
            let mut points = [ways[0].centre; SHORT];
            let (mut times, mut lowest) = ([f64::INFINITY; SHORT], [0; SHORT]);
            for (i, part) in parts.iter().enumerate() {
                let (way, direction) = (&ways[i], directions[i]);
                let after = |q: Point<D>, v: Vector<f64, D>| {
                    let clear = values[i] - gap + direction.dot(q - way.centre);
                    let nears = -direction.dot(v);
                    match () {
                        () if clear <= 0.0 => 0.0,
                        () if nears > 0.0 => clear / nears + 0.5 * self.settings.time_tolerance,
                        () => f64::INFINITY,
                    }
                };
                let (mut when, mut at) = (after(way.centre, way.mean), (way.centre, way.mean));
                if !of_centre {
                    when = f64::INFINITY;
                    for k in 0..N {
                        let soon = after(way.places[k], way.velocities[k]);
                        if soon < when {
                            (when, at) = (soon, (way.places[k], way.velocities[k]));
                            lowest[i] = k;
                        }
                    }
                }
                if part.free + when < latest {
                    times[i] = part.free + when;
                    points[i] = at.0 + at.1 * when;
                }
            }
            if times.iter().all(|time| *time == f64::INFINITY) {
                continue;
            }
            let found = self.sampler.values(&points);
            for (i, part) in parts.iter().enumerate() {
                let since = times[i] - part.free;
                let bend = 0.5 * self.way.acceleration * since * since;
                if found[i] + bend * self.sampler.steepness.lipschitz <= gap {
                    let vertex = part.element.vertices[lowest[i]];
                    let p = if of_centre { part.element.at(&self.weights) } else { vertex };
                    self.found(times[i], p);
                }
            }
        }
    }
}

/// Up to which share of a span `value + t w` is positive, for w from −1 to 1.
fn positive_share(value: f64, t: f64) -> f64 {
    let (first, last) = (value - t, value + t);
    // Written so that NaN is not positive.
    if !(first > 0.0) {
        0.0
    } else if last > 0.0 {
        1.0
    } else {
        first / (first - last) * (1.0 - 1e-12)
    }
}

/// The centre of a parallelogram that holds a triangle, and its half sides: half the longest edge,
/// and half of the way from its middle to the apex. Of a segment, the second is zero.
fn frame<const N: usize, const D: usize>(
    vertices: &[Vector<f64, D>; N],
    apex: usize,
) -> [[Vector<f64, D>; 2]; 2] {
    let v = |k: usize| vertices[(apex + k) % N];
    let (middle, half) = ((v(N - 2) + v(N - 1)) * 0.5, (v(N - 2) - v(N - 1)) * 0.5);
    if N == 2 {
        return [[middle, Vector::ZERO], [half, Vector::ZERO]];
    }
    let up = (v(0) - middle) * 0.5;
    [[middle + up, Vector::ZERO], [half, up]]
}

/// The vertex across from the longest edge; the first of a segment.
fn apex<const N: usize, const D: usize>(element: &Element<N, D>) -> usize {
    let v = element.vertices();
    let edge = |k: usize| (v[(k + 1) % N] - v[(k + 2) % N]).norm();
    if N == 2 {
        0
    } else {
        (0..N).fold(0, |long, k| if edge(k) > edge(long) { k } else { long })
    }
}

impl<const N: usize, const D: usize> Problem for ElementSearch<'_, '_, N, D> {
    type Queue = Vec<Part<N, D>>;

    fn round_and_parts(&self) -> (usize, usize) {
        (SHORT, self.parts)
    }

    fn decided(&self, lower: f64) -> Option<Stop> {
        if lower >= self.upper - self.settings.time_tolerance {
            Some(Stop::Converged)
        } else {
            (lower >= 1.0).then_some(Stop::SignKnown)
        }
    }

    fn has_room(&self, frontier: &Frontier<Self::Queue>) -> bool {
        frontier.queue.len() + SHORT <= ROOM
    }

    fn is_spent(&self) -> bool {
        self.sampler.evaluations >= self.settings.budget
    }

    fn can_split(&self, queue: &Self::Queue) -> bool {
        !queue.is_empty()
    }

    fn split(&mut self, part: &Part<N, D>, round: &mut Vec<Part<N, D>>) {
        if part.is_whole {
            round.push(*part);
        } else {
            let level = part.level + 1;
            let halves = part.element.halves();
            round.extend(halves[..self.parts].iter().map(|&element| Part {
                element,
                level,
                ..*part
            }));
        }
    }

    fn bound(&mut self, frontier: &mut Frontier<Self::Queue>) {
        self.advance(&mut frontier.round);
    }

    fn is_open(&self, part: &Part<N, D>) -> bool {
        part.free < self.upper.min(1.0) && part.level < MOST_LEVELS
    }

    fn close(&mut self, part: &Part<N, D>, _queue: &mut Self::Queue) {
        self.dropped = self.dropped.min(part.free);
    }

    fn closed(&self) -> f64 {
        self.dropped
    }
}
