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

use palpate_field::{Point, SHORT, Vector};

use super::first_touch::{FirstTouch, Start};
use super::motion::Motion;
use super::moving::Moving;
use super::path::{Path, WayBounds};
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

/// A part goes on undivided if its step is at least this share of the tangent plane's.
const PAYS: f64 = 0.3;

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
    let ElementSweep { frontier, samples } = workspace;
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
        sampler,
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
    path: Path<D>,
    way: WayBounds,
    settings: &'s SweepSettings,
    /// The weights of a part's vertices in its centre, and the number of its halves.
    weights: [f64; N],
    parts: usize,
    /// Of the smallest ball around the element, and of the highest sample [m].
    radius: f64,
    highest: f64,
    /// The first time known of a touch, and the point of the element that does.
    upper: f64,
    best: Option<Point<D>>,
    /// The least bound of closed parts.
    dropped: f64,
}

/// Parts of a round on their way, in the field's coordinates.
struct Ways<const N: usize, const D: usize> {
    places: [[Point<D>; N]; SHORT],
    velocities: [[Vector<f64, D>; N]; SHORT],
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

    /// How long a part stays in a ball of a `radius` about `p`; zero if it is not in it.
    #[inline]
    fn stays(
        &self,
        places: &[Point<D>; N],
        velocities: &[Vector<f64, D>; N],
        p: Point<D>,
        radius: f64,
    ) -> f64 {
        let mut far = 0.0_f64;
        for place in places {
            let apart = *place - p;
            far = far.max(apart.dot(apart));
        }
        let spare = radius - far.sqrt();
        // Written so that NaN is no time.
        if !(spare > 0.0) {
            return 0.0;
        }
        let bend = if self.way.acceleration > 0.0 { BEND * spare } else { 0.0 };
        let mut stays = if bend > 0.0 {
            (2.0 * bend / self.way.acceleration).sqrt()
        } else {
            f64::INFINITY
        };
        let inner = radius - bend;
        for (place, velocity) in places.iter().zip(velocities) {
            // |o + s v| < inner from s = 0 on.
            let apart = *place - p;
            let (half, squared) = (apart.dot(*velocity), velocity.dot(*velocity));
            let rest = inner * inner - apart.dot(apart);
            let root = (half * half + squared * rest).sqrt();
            // Of both forms of the root that which does not cancel; a point at rest stays.
            let exit = if half > 0.0 { rest / (root + half) } else { (root - half) / squared };
            stays = if exit < stays { exit } else { stays };
        }
        stays * (1.0 - 1e-12)
    }

    /// Advances the parts of a round.
    fn advance(&mut self, parts: &mut [Part<N, D>]) {
        let count = parts.len();
        let mut ways =
            Ways { places: [[Vector::ZERO; N]; SHORT], velocities: [[Vector::ZERO; N]; SHORT] };
        let mut place = self.path.at(parts[0].free);
        for (i, part) in parts.iter().enumerate() {
            if part.free != place.time {
                place = self.path.at(part.free);
            }
            for (k, p) in part.element.vertices.iter().enumerate() {
                let q = place.point(*p);
                ways.places[i][k] = q;
                ways.velocities[i][k] = self.path.velocity(&place, *p, q);
            }
        }
        let centres: [Point<D>; SHORT] = std::array::from_fn(|i| {
            let mut centre = Vector::ZERO;
            for (q, weight) in ways.places[i.min(count - 1)].iter().zip(self.weights) {
                centre += *q * weight;
            }
            centre
        });
        let (values, directions) = self.sampler.slopes(&centres);
        let gap = (1.0 - FREE) * self.settings.gap;
        let mut ideal = [0.0; SHORT];
        let mut witnesses = centres;
        let mut times = [f64::INFINITY; SHORT];
        let mut stays = [0.0; SHORT];
        let mut lowest = [0; SHORT];
        for (i, part) in parts.iter().enumerate() {
            if values[i] <= gap {
                self.found(part.free, part.element.at(&self.weights));
            }
            let radius = self.free_radius(centres[i], values[i]);
            stays[i] = self.stays(&ways.places[i], &ways.velocities[i], centres[i], radius);
            // When the tangent plane says that a vertex touches.
            ideal[i] = f64::INFINITY;
            for k in 0..N {
                let (q, v) = (ways.places[i][k], ways.velocities[i][k]);
                let clear = values[i] + directions[i].dot(q - centres[i]) - gap;
                let nears = -directions[i].dot(v);
                let when = if clear <= 0.0 {
                    0.0
                } else if nears > 0.0 {
                    clear / nears
                } else {
                    f64::INFINITY
                };
                if when < ideal[i] {
                    ideal[i] = when;
                    let soon = if when > 0.0 {
                        when + 0.5 * self.settings.time_tolerance
                    } else {
                        0.0
                    };
                    times[i] = part.free + soon;
                    witnesses[i] = q + v * soon;
                    lowest[i] = k;
                }
            }
        }
        self.lift(parts, &ways, &centres, &directions, &mut stays);
        self.look(parts, &witnesses, &times, &lowest);
        for (i, part) in parts.iter_mut().enumerate() {
            let before = part.free;
            part.free = before + stays[i];
            let most = ideal[i].min(self.upper.min(1.0) - before);
            part.is_whole = stays[i] >= PAYS * most;
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
        ways: &Ways<N, D>,
        centres: &[Point<D>; SHORT],
        directions: &[Vector<f64, D>; SHORT],
        stays: &mut [f64; SHORT],
    ) {
        let count = parts.len();
        let mut best = [0.0; SHORT];
        let rounds = if count > SHORT / 2 { 2 } else { 1 };
        let of_each = SHORT / count;
        for round in 0..rounds {
            let points: [Point<D>; SHORT] = std::array::from_fn(|lane| {
                let i = (lane / of_each).min(count - 1);
                let share = SHARES[lane % of_each + round];
                centres[i] + directions[i] * (share * parts[i].height)
            });
            let values = self.sampler.values(&points);
            for lane in 0..of_each * count {
                let i = lane / of_each;
                let radius = self.free_radius(points[lane], values[lane]);
                let stay =
                    self.stays(&ways.places[i], &ways.velocities[i], points[lane], radius);
                if stay > stays[i] {
                    stays[i] = stay;
                    best[i] = SHARES[lane % of_each + round];
                }
            }
        }
        for (part, best) in parts.iter_mut().zip(best) {
            let factor = if best == 0.0 {
                0.3
            } else if best == 1.0 {
                1.5
            } else {
                best
            };
            part.height = (part.height * factor).min(self.highest);
        }
    }

    /// Looks for touches where the tangent planes say that they are.
    fn look(
        &mut self,
        parts: &[Part<N, D>],
        witnesses: &[Point<D>; SHORT],
        times: &[f64; SHORT],
        lowest: &[usize; SHORT],
    ) {
        let latest = self.upper.min(1.0);
        if !times.iter().take(parts.len()).any(|time| *time < latest) {
            return;
        }
        let values = self.sampler.values(witnesses);
        let gap = (1.0 - FREE) * self.settings.gap;
        for i in 0..parts.len() {
            let since = times[i] - parts[i].free;
            let bend = 0.5 * self.way.acceleration * since * since;
            if times[i] < latest && values[i] + bend * self.sampler.steepness.lipschitz <= gap {
                self.found(times[i], parts[i].element.vertices[lowest[i]]);
            }
        }
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
