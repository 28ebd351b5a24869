// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sweeps of elements, meshes and balls.
//!
//! The first touch of segments and triangles that move, alone or in a mesh, and a field.
//!
//! Best-first branch and bound over parts of the elements, where the bound of a part is the time
//! until which it is free. A value f at any point p, on the part or off it, proves a ball of radius
//! f/L about p empty; the part is free until its first vertex leaves the ball, as the distance from
//! p is convex. So each part advances through time on its own: those near the surface in small
//! steps or in smaller parts, those that are passed by in one. From points lifted off the part along
//! the gradient, the ball is nearly a half-space, and the step is nearly that of the tangent plane.
//!
//! Where the balls are too small for a part, as those of fields that are steeper than one, a model
//! bounds the field over the part and a span of time: the parameters are two along the part, and
//! time.
//!
//! A mesh begins as the root of its tree of balls, and comes apart into nodes and elements where
//! that gains time.

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Block, Column, Point, Shape, Vector};
use palpate_mesh::{FAN, Mesh};

use super::first_touch::{FREE, FirstTouch, HALVES, Start, SweepSettings};
use super::motion::{Motion, Moving, Path, Places, Stay, WayBounds, corners, later};
use super::pair::{Of, Part, Way};
use crate::ball::{BallWorkspace, contact_ball};
use crate::certified::{Certified, Limits, Stop};
use crate::contact::Contact;
use crate::element_search::{Element, parts_of_one};
use crate::engine::{self, Frontier, Problem};
use crate::error::QueryError;
use crate::ray::{Advance, FreeWay, Gap, Ray};
use crate::sampler::{AT_ONCE, Sampler, Samples, normal};

/// Heights of the lifted samples, as shares of the part's height: the first ones, where a part has few
/// samples.
const SHARES: [f64; AT_ONCE] = [1.0, 0.35, 3.0, 0.1, 8.0, 0.03, 20.0, 0.01];

/// A height shrinks to this where no sample over the centre helps, and grows by this where the
/// first does.
const LOWER: f64 = 0.3;
const HIGHER: f64 = 1.5;

/// The highest samples, in radii of the body and besides its way.
const HIGHEST: f64 = 16.0;

/// The shortest span of a model.
const SHORTEST: f64 = 1e-6;

/// How far into the tolerance after a time a touch is looked for.
const SOON: f64 = 0.5;

/// The largest number of halvings: such parts are as small as roundings of the whole.
const MOST_LEVELS: u32 = 48;

/// The largest number of waiting parts.
const ROOM: usize = 8192;

/// Parts of a round at most.
const ROUND: usize = 2 * FAN;

/// Memory of sweeps of elements and meshes, kept from one to the next: it is allocated once.
#[derive(Debug)]
pub struct ElementSweep<const N: usize, const D: usize> {
    frontier: Frontier<Vec<Part<N, D>>>,
    samples: Samples<D>,
    places: Places<D>,
    cells: Block<Model, D, BLOCK>,
    models: Column<Model, BLOCK>,
}

impl<const N: usize, const D: usize> ElementSweep<N, D> {
    /// Room for sweeps of elements of `N` points in `D` dimensions.
    #[must_use]
    #[inline(never)]
    pub fn new() -> Self {
        Self {
            frontier: Frontier {
                queue: Vec::with_capacity(ROOM),
                pending: Vec::new(),
                round: Vec::with_capacity(ROUND),
            },
            samples: Samples::new(),
            places: Places::new(),
            cells: Block::zero(),
            models: Column::zero(),
        }
    }

    /// The first touch of what moves, and a field.
    ///
    /// # Errors
    ///
    /// If a pose is NaN or out of range, or a setting is not positive.
    #[inline(never)]
    pub(crate) fn run(
        &mut self,
        field: Moving<'_, D>,
        whole: &Whole<'_, N, D>,
        motion: Motion<D>,
        settings: &SweepSettings,
    ) -> Result<FirstTouch<D>, QueryError> {
        settings.check()?;
        field.motion.check(0)?;
        motion.check(1)?;
        let path = Path { field: field.motion, body: motion };
        let Self { frontier, samples, places, cells, models } = self;
        places.clear();
        let way = path.bounds(whole.corners);
        let highest = way.speed + HIGHEST * whole.part.height;
        let reach = way.far + highest;
        let mut search = ElementSearch {
            sampler: Sampler::new(field.shape, samples, reach, FREE * settings.gap),
            field: field.shape,
            mesh: whole.mesh,
            places,
            cells,
            models,
            path,
            way,
            settings,
            highest,
            upper: f64::INFINITY,
            best: None,
            dropped: f64::INFINITY,
        };
        frontier.queue.clear();
        frontier.queue.push(whole.part);
        let end = engine::search(&mut search, frontier);
        let lower = frontier.lower(search.dropped);
        Ok(search.answer(field, lower, end.stop()))
    }
}

impl<const N: usize, const D: usize> Default for ElementSweep<N, D> {
    fn default() -> Self {
        Self::new()
    }
}

/// What moves, in its own coordinates.
pub(crate) struct Whole<'a, const N: usize, const D: usize> {
    pub(super) part: Part<N, D>,
    pub(super) mesh: Option<&'a Mesh<N, D>>,
    /// Points whose convex hull holds it [m].
    pub(super) corners: &'a [Point<D>],
}

/// A point that touches, and what it is on.
#[derive(Clone, Copy, Debug)]
struct Touching<const D: usize> {
    point: Point<D>,
    /// The index of the element.
    element: u32,
}

/// The search for the first touch, as a problem of the engine.
struct ElementSearch<'s, 'a, const N: usize, const D: usize> {
    sampler: Sampler<'a, D>,
    field: &'a Shape<D>,
    mesh: Option<&'s Mesh<N, D>>,
    places: &'s mut Places<D>,
    cells: &'s mut Block<Model, D, BLOCK>,
    models: &'s mut Column<Model, BLOCK>,
    path: Path<D>,
    way: WayBounds,
    settings: &'s SweepSettings,
    /// Of the highest sample [m].
    highest: f64,
    /// The first time known of a touch, and what touches then.
    upper: f64,
    best: Option<Touching<D>>,
    /// The least bound of closed parts.
    dropped: f64,
}

impl<const N: usize, const D: usize> ElementSearch<'_, '_, N, D> {
    fn answer(&mut self, field: Moving<'_, D>, lower: f64, stop: Stop) -> FirstTouch<D> {
        let evaluations = self.sampler.evaluations;
        if stop == Stop::SignKnown {
            let (lower, upper) = (1.0, 1.0);
            return FirstTouch { lower, upper, contact: None, start: None, stop, evaluations };
        }
        if let (0.0, Some(Touching { point, .. })) = (lower, self.best) {
            // A touch soon after the start may be one at the start.
            let value = self.sampler.value(self.path.at(0.0).point(point));
            if value <= self.settings.touch_level() {
                self.upper = 0.0;
            }
        }
        let lower = lower.min(self.upper).min(1.0);
        self.refine(lower);
        let upper = self.upper;
        let mut touch =
            FirstTouch { lower, upper, contact: None, start: None, stop, evaluations };
        if let Some(Touching { point: p, element }) = self.best {
            let place = self.path.at(upper);
            let q = place.point(p);
            let (_, gradient) = self.sampler.slope(q);
            touch.evaluations = self.sampler.evaluations;
            let surface = field.shape.surface_point(q);
            if let (Some(surface), Some(normal)) = (surface, normal(gradient)) {
                let world = self.path.field.pose(upper);
                let contact = Contact::new(surface, q, normal).placed(&world);
                touch.contact = Some(contact.with_id(u64::from(element)));
                let relative = self.path.velocity(&place, p, q);
                touch.start = (upper == 0.0).then(|| Start::of(relative, normal));
            }
        }
        touch
    }

    /// Looks for an earlier touch of the same point after `lower`, by halves: within the tolerance,
    /// it may be deep in the field already.
    fn refine(&mut self, mut lower: f64) {
        let Some(Touching { point, .. }) = self.best else { return };
        for _ in 0..HALVES {
            if lower >= self.upper {
                return;
            }
            let middle = 0.5 * (lower + self.upper);
            let value = self.sampler.value(self.path.at(middle).point(point));
            if value <= self.settings.touch_level() {
                self.upper = middle;
            } else {
                lower = middle;
            }
        }
    }

    /// Notes a point of an element that touches at a time.
    fn found(&mut self, time: f64, point: Point<D>, of: Of) {
        if let Of::Element(element) = of
            && time < self.upper
        {
            (self.upper, self.best) = (time, Some(Touching { point, element }));
        }
    }

    /// Advances the parts of a round.
    fn advance(&mut self, parts: &mut [Part<N, D>]) {
        let count = parts.len();
        let ways: [Way<N, D>; AT_ONCE] = std::array::from_fn(|i| {
            let part = &parts[i.min(count - 1)];
            part.way(&self.path, self.places.at(&self.path, part.free))
        });
        let centres = ways.map(|way| way.centre);
        let (values, directions) = self.sampler.slopes(&centres);
        let mut stays = [Stay::default(); AT_ONCE];
        for i in 0..count {
            let part = &parts[i];
            if values[i] <= self.settings.touch_level() {
                self.found(part.free, part.element.at(&part.form.weights), part.of);
            }
            stays[i] = self.stays(&ways[i], centres[i], values[i]);
        }
        self.lift(parts, &ways, &directions, &mut stays);
        self.look(parts, &ways, &values, &directions);
        self.model(parts, &ways, &mut stays);
        for (part, stay) in parts.iter_mut().zip(&stays) {
            part.free = later(part.free, stay.part);
            part.is_whole = stay.pays();
        }
    }

    /// Lengthens steps that are short for the size of their parts by models of the field over the
    /// parts and spans of time.
    fn model(
        &mut self,
        parts: &[Part<N, D>],
        ways: &[Way<N, D>; AT_ONCE],
        stays: &mut [Stay; AT_ONCE],
    ) {
        let latest = self.upper.min(1.0);
        let (mut open, mut spans, mut count) = ([0; AT_ONCE], [0.0; AT_ONCE], 0);
        for (i, part) in parts.iter().enumerate() {
            let span = stays[i].centre.max(SHORTEST).min(latest - part.free);
            let way = &ways[i];
            let far = way.places.iter().map(|q| (*q - way.centre).norm()).fold(0.0, f64::max)
                + self.way.speed * span;
            let holds = self.sampler.steepness.holds_within(way.centre, far);
            if part.is_of_element() && !stays[i].pays() && stays[i].part < span && holds {
                (open[count], spans[count]) = (i, span);
                count += 1;
            }
        }
        if count == 0 {
            return;
        }
        let acceleration = self.way.acceleration;
        self.cells.fill(count, |lane| {
            let (way, span) = (&ways[open[lane]], spans[lane]);
            let apex = parts[open[lane]].form.apex;
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

    /// How long a part stays where a value at `p` proves the field positive.
    #[inline]
    fn stays(&self, way: &Way<N, D>, p: Point<D>, value: f64) -> Stay {
        let radius = self.sampler.free_radius(p, value - self.way.rounding);
        way.stays(p, radius, self.way.acceleration)
    }

    /// Lengthens the steps by points lifted over the centres.
    fn lift(
        &mut self,
        parts: &mut [Part<N, D>],
        ways: &[Way<N, D>; AT_ONCE],
        directions: &[Vector<f64, D>; AT_ONCE],
        stays: &mut [Stay; AT_ONCE],
    ) {
        let count = parts.len();
        let mut best = [0.0; AT_ONCE];
        let rounds = if count > AT_ONCE / 2 { 2 } else { 1 };
        let of_each = AT_ONCE / count;
        for round in 0..rounds {
            let share = |lane: usize| SHARES[lane % of_each + round];
            let points: [Point<D>; AT_ONCE] = std::array::from_fn(|lane| {
                let i = (lane / of_each).min(count - 1);
                ways[i].centre + directions[i] * (share(lane) * parts[i].height)
            });
            let values = self.sampler.values(&points);
            for lane in 0..of_each * count {
                let i = lane / of_each;
                let stay = self.stays(&ways[i], points[lane], values[lane]);
                if stay.part > stays[i].part {
                    best[i] = share(lane);
                }
                stays[i].or(stay);
            }
        }
        for (part, best) in parts.iter_mut().zip(best) {
            let factor = match best {
                0.0 => LOWER,
                1.0 => HIGHER,
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
        ways: &[Way<N, D>; AT_ONCE],
        values: &[f64; AT_ONCE],
        directions: &[Vector<f64, D>; AT_ONCE],
    ) {
        let level = self.settings.touch_level();
        for of_centre in [false, true] {
            let latest = self.upper.min(1.0);
            let mut points = [ways[0].centre; AT_ONCE];
            let (mut times, mut lowest) = ([f64::INFINITY; AT_ONCE], [0; AT_ONCE]);
            for (i, part) in parts.iter().enumerate() {
                let (way, direction) = (&ways[i], directions[i]);
                let after = |q: Point<D>, v: Vector<f64, D>| {
                    let clear = values[i] - level + direction.dot(q - way.centre);
                    let nears = -direction.dot(v);
                    match () {
                        () if clear <= 0.0 => 0.0,
                        () if nears > 0.0 => {
                            clear / nears + SOON * self.settings.time_tolerance
                        }
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
                if part.is_of_element() && part.free + when < latest {
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
                if found[i] + bend * self.sampler.steepness.lipschitz <= level {
                    let vertex = part.element.vertices[lowest[i]];
                    let centre = part.element.at(&part.form.weights);
                    self.found(times[i], if of_centre { centre } else { vertex }, part.of);
                }
            }
        }
    }
}

/// Up to which share of a span `value + t w` is positive, for w from −1 to 1.
fn positive_share(value: f64, t: f64) -> f64 {
    let (first, last) = (value - t, value + t);
    // NaN is not positive.
    match () {
        () if first > 0.0 && last > 0.0 => 1.0,
        () if first > 0.0 => first / (first - last) * (1.0 - 1e-12),
        () => 0.0,
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

impl<const N: usize, const D: usize> Problem for ElementSearch<'_, '_, N, D> {
    type Queue = Vec<Part<N, D>>;

    fn round_and_parts(&self) -> (usize, usize) {
        if self.mesh.is_some() { (ROUND, FAN) } else { (AT_ONCE, parts_of_one::<N>()) }
    }

    fn decided(&self, lower: f64) -> Option<Stop> {
        self.settings.decided(lower, self.upper)
    }

    fn has_room(&self, frontier: &Frontier<Self::Queue>) -> bool {
        frontier.queue.len() + ROUND <= ROOM
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
            part.divide(self.mesh, round);
        }
    }

    fn bound(&mut self, frontier: &mut Frontier<Self::Queue>) {
        frontier.round.chunks_mut(AT_ONCE).for_each(|parts| self.advance(parts));
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

/// When an element that moves touches a field first, which may move too: the first time at which the
/// field is at most `settings.gap` anywhere on the element. In the contact, the field is body `a`.
///
/// Each part of the element advances through time on its own, by points that are lifted off it as
/// in [`minimum`](crate::minimum). So no motion is too fast and no body too thin.
///
/// ```
/// use palpate_field::{Pose, Screw, Shape, Vector};
/// use palpate_query::{Element, ElementSweep, SweepSettings, sweep_element};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // It falls by 4 m on a ball, which it meets with its middle at a height of 1 m.
/// let ball = Shape::<3>::ball(1.0)?;
/// let corners = [[0.3, 0.0, 0.0], [-0.2, 0.0, 0.2], [-0.1, 0.0, -0.2]].map(Vector);
/// let [from, to] = [3.0, -1.0].map(|y| Pose::translation([0.0, y, 0.0]));
/// let falls = Screw::new(from, to, 0)?;
/// let settings = SweepSettings::of_size(1.0);
/// let triangle = Element::new(corners)?;
/// let touch = sweep_element(&ball, &triangle, falls, &settings, &mut ElementSweep::new())?;
/// assert!(touch.lower <= 0.5 && touch.upper > 0.5 - 1e-6 && touch.upper <= touch.lower + 1e-4);
/// # Ok(())
/// # }
/// ```
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
    let part = Part::whole(element, 0, 0.0);
    let whole = Whole { part, mesh: None, corners: &element.vertices };
    workspace.run(field.into(), &whole, motion.into(), settings)
}

/// When a mesh that moves touches a field first, which may move too: the first time at which the
/// field is at most `settings.gap` anywhere on an element of the mesh. In the contact, the field is
/// body `a`, and the id is the index of the element.
///
/// As [`sweep_element`](crate::sweep_element), from the root of the mesh's tree on: most elements
/// are never looked at.
///
/// ```
/// use palpate_field::{Pose, Screw, Shape, Vector};
/// use palpate_mesh::Outline;
/// use palpate_query::{ElementSweep, SweepSettings, sweep_mesh};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // A square of 2 m falls by 4 m, and its lower side meets the disc at a height of 1 m.
/// let disc = Shape::<2>::ball(1.0)?;
/// let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(Vector).to_vec();
/// let square = Outline::new(corners, vec![[0, 1], [1, 2], [2, 3], [3, 0]])?;
/// let [from, to] = [4.0, 0.0].map(|y| Pose::translation([0.0, y]));
/// let falls = Screw::new(from, to, 0)?;
/// let settings = SweepSettings::of_size(1.0);
/// let touch = sweep_mesh(&disc, &square, falls, &settings, &mut ElementSweep::new())?;
/// assert!(touch.lower <= 0.5 && touch.upper > 0.5 - 1e-6 && touch.upper <= touch.lower + 1e-4);
/// assert_eq!(touch.contact.ok_or("it touches")?.id, 0);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If a pose is NaN or out of range, or a setting is not positive.
pub fn sweep_mesh<'a, const N: usize, const D: usize>(
    field: impl Into<Moving<'a, D>>,
    mesh: &Mesh<N, D>,
    motion: impl Into<Motion<D>>,
    settings: &SweepSettings,
    workspace: &mut ElementSweep<N, D>,
) -> Result<FirstTouch<D>, QueryError> {
    let corners: Vec<_> = corners(&mesh.bounds()).collect();
    let whole = Whole { part: Part::root(mesh), mesh: Some(mesh), corners: &corners };
    workspace.run(field.into(), &whole, motion.into(), settings)
}

/// A gap is searched to this share of the tolerance in the end: then it is within the tolerance, or
/// a step of the rest is free.
const FINEST: f64 = 0.5;

/// A gap is first searched to so many times the last step that was free, and then always this much
/// finer: a coarse search is cheap, and a long step needs no more.
const COARSER: f64 = 8.0;

/// The first place of a ball of a `radius` [m] whose centre moves along `ray` at which the gap
/// between ball and shape, as [`contact_ball`] defines it, is at most `limits.tolerance`.
///
/// The bounds are distances of the centre from the ray's origin [m]: before `lower` the ball is
/// free, which is proven, rounding included; at `upper` it touches, by the contact, of which the
/// shape is body `a`. They are at most the tolerance apart, if the search converged. A ball that is
/// proven free has no contact, both bounds at the ray's end, and [`Stop::SignKnown`]. A ball that
/// touches at first does so at 0. A budget that is spent leaves `upper` infinite, or where the ball
/// is known to touch.
///
/// Where the field is exact outside, the ball advances by lifted samples, as [`cast_ray`] does;
/// where it is a bound, its values say that the ball is free, and a search about the centre that it
/// touches.
///
/// [`cast_ray`]: crate::cast_ray
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Cuboid};
/// use palpate_query::{BallWorkspace, Limits, Ray, cast_ball};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let plate = Shape::from_kernel(Cuboid::new(Vector([2.0, 0.001, 2.0]))?);
/// let down = Ray::new([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], 5.0)?;
/// let limits = Limits::new(1e-6);
/// let touch = cast_ball(&plate, &down, 0.25, &limits, &mut BallWorkspace::new())?;
/// assert!(touch.lower <= 0.7495 && (touch.upper - 0.7495).abs() <= 1e-6);
/// let contact = touch.best.ok_or("it touches")?;
/// assert!((contact.normal - Vector([0.0, 1.0, 0.0])).norm() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If the radius or the tolerance is negative, NaN or too large.
#[inline(never)]
pub fn cast_ball<const D: usize>(
    shape: &Shape<D>,
    ray: &Ray<D>,
    radius: f64,
    limits: &Limits,
    workspace: &mut BallWorkspace<D>,
) -> Result<Certified<Option<Contact<D>>>, QueryError> {
    limits.check()?;
    QueryError::check_length(radius)?;
    let mut samples = Samples::new();
    let sampler = Sampler::new(shape, &mut samples, ray.at(0.0).norm(), 0.0);
    let mut advance = Advance::new(sampler, ray, radius);
    let finest = FINEST * limits.tolerance;
    let mut gaps = Gaps { shape, radius, coarse: ray.length(), finest, workspace };
    let way = advance.run(limits, |centre, budget| gaps.at(centre, budget));
    let FreeWay { lower, upper, stop } = way;
    let mut evaluations = advance.sampler.evaluations;
    let best = if stop != Stop::SignKnown && upper.is_finite() {
        let near = limits.with_tolerance(finest);
        let found = contact_ball(shape, ray.at(upper), radius, &near, gaps.workspace)?;
        evaluations += found.evaluations;
        found.best
    } else {
        None
    };
    Ok(Certified { best, lower, upper, stop, evaluations })
}

/// The gaps of a ball at places of its way, where values do not tell them.
struct Gaps<'a, const D: usize> {
    shape: &'a Shape<D>,
    radius: f64,
    /// The tolerance to which a gap is searched first, and at last [m].
    coarse: f64,
    finest: f64,
    workspace: &'a mut BallWorkspace<D>,
}

impl<const D: usize> Gaps<'_, D> {
    /// The gap about a centre, to the first tolerance at which it is known to be positive, or to the
    /// finest.
    fn at(&mut self, centre: Point<D>, budget: u32) -> Gap {
        let (mut tolerance, mut gap) = (self.coarse.max(self.finest), Gap::UNKNOWN);
        loop {
            let left = budget.saturating_sub(gap.evaluations);
            let limits = Limits::new(tolerance).with_budget(left);
            let found = contact_ball(self.shape, centre, self.radius, &limits, self.workspace);
            // A point of a ray is in range.
            let Ok(found) = found else { return gap };
            gap = Gap {
                lower: gap.lower.max(found.lower),
                upper: gap.upper.min(found.upper),
                evaluations: gap.evaluations + found.evaluations,
            };
            let is_known = gap.lower >= self.finest || gap.upper <= self.finest;
            if is_known || tolerance <= self.finest || found.stop.is_early() {
                self.coarse = COARSER * gap.lower.max(0.0);
                return gap;
            }
            tolerance = (tolerance / COARSER).max(self.finest);
        }
    }
}
