// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Elements, and the search for the least value over one.
//!
//! The least value of a field over a segment or a triangle.
//!
//! Best-first branch and bound, with bounds from points that need not lie on the
//! element. A field varies by at most L times the way, in all of space: so from `f(p)`
//! at any `p`,
//!
//! ```text
//! f ≥ f(p) − L·max‖p − vertex‖   on the element,
//! ```
//!
//! since the distance from `p` is convex. From the centre, the loss is the element's
//! radius r. From a point lifted off it along the gradient by s, the free ball about it
//! is nearly a half-space, and the loss is about r²/2s: of second order, without
//! curvature, exactness or a correct gradient (a wrong one only widens the bound).
//!
//! The first samples are over the centre and then over the lowest point, most often a vertex.
//! If the other vertices lie above the tangent plane at that point, a ball about a point high
//! over it that just reaches it holds them all, and the bound is exact.
//!
//! Cells are halves of halves of the element, all similar to it, so that one set of
//! weights gives all their centres, and each level halves the radius.

use palpate_field::{BoundingBall, Point, Shape, Vector};

use crate::certified::{Certified, Goal, Limits, Stop};
use crate::contacts::{ElementContacts, MOST_CELLS, Patches};
use crate::engine::{self, Bounded, Frontier, Problem};
use crate::error::QueryError;
use crate::pair::search::ROUNDINGS;
use crate::sampler::{AT_ONCE, Sampler, Samples, larger, unit};

/// The first heights over the centre, in radii.
pub(crate) const FIRST_HEIGHTS: [f64; 5] = [0.75, 1.5, 3.0, 6.0, 12.0];

/// Heights over the lowest point, in radii.
const OVER_LOWEST: [f64; 5] = [1.0, 2.0, 4.0, 8.0, HIGHEST];

/// A cell's second height, as a share of its first.
const LOWER: f64 = 0.4;

/// Factors of a height: where the ball about the centre gave the better bound, and where the
/// lifted ball nearly gave the value at the centre.
const SHRINK: f64 = 0.5;
const GROW: f64 = 1.5;

/// The highest sample over the element, in radii of the whole; the rounding of values is
/// computed for points up to there.
const HIGHEST: f64 = FIRST_HEIGHTS[FIRST_HEIGHTS.len() - 1] * GROW;

/// The largest number of halvings: such cells are as small as roundings of the whole.
const MOST_LEVELS: u32 = 48;

/// The largest number of waiting cells.
const ROOM: usize = 4096;

/// A part of the element with its bounds: 128 bytes for a triangle in space. Larger values
/// are copied by a call, which takes longer than all other work on a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ElementCell<const N: usize, const D: usize> {
    pub(crate) element: Element<N, D>,
    /// Proven lower bound on the cell [m].
    pub(crate) lower: f64,
    /// Upper bound of the least value on the cell [m].
    pub(crate) upper: f64,
    /// How far samples are lifted [m], and in which direction.
    height: f64,
    pub(crate) direction: Vector<f64, D>,
    /// How often the element was halved.
    pub(crate) level: u32,
}

impl<const N: usize, const D: usize> Bounded for ElementCell<N, D> {
    #[inline]
    fn lower(&self) -> f64 {
        self.lower
    }
}

impl<const N: usize, const D: usize> ElementCell<N, D> {
    /// Appends the first `count` of its halves.
    #[inline]
    pub(crate) fn halve_into(&self, count: usize, cells: &mut Vec<Self>) {
        let level = self.level + 1;
        let halves = self.element.halves();
        cells.extend(halves[..count].iter().map(|&element| Self { element, level, ..*self }));
    }
}

/// Memory of searches over elements, kept from one to the next: it is allocated once.
#[derive(Debug)]
pub struct ElementWorkspace<const N: usize, const D: usize> {
    pub(crate) frontier: Frontier<Vec<ElementCell<N, D>>>,
    pub(crate) samples: Samples<D>,
    pub(crate) patches: Patches<N, D>,
    pub(crate) found: ElementContacts<D>,
}

impl<const N: usize, const D: usize> ElementWorkspace<N, D> {
    /// Room for searches over elements of `N` points in `D` dimensions.
    #[must_use]
    #[inline(never)]
    pub fn new() -> Self {
        Self {
            frontier: Frontier {
                queue: Vec::with_capacity(ROOM),
                pending: Vec::new(),
                round: Vec::with_capacity(AT_ONCE),
            },
            samples: Samples::new(),
            patches: Patches::new(),
            found: ElementContacts::with_capacity(MOST_CELLS),
        }
    }
}

impl<const N: usize, const D: usize> Default for ElementWorkspace<N, D> {
    fn default() -> Self {
        Self::new()
    }
}

/// The least value of a field over an element, between bounds [m], and where it is.
///
/// Stops when the bounds are no farther apart than the tolerance.
///
/// # Errors
///
/// If the tolerance is negative, NaN or too large.
pub fn minimum<const N: usize, const D: usize>(
    shape: &Shape<D>,
    element: &Element<N, D>,
    limits: &Limits,
    workspace: &mut ElementWorkspace<N, D>,
) -> Result<Certified<Point<D>>, QueryError> {
    limits.check()?;
    let goal = Goal::least(limits.tolerance);
    Ok(search(shape, element, &Terms::new(goal, limits.budget), workspace))
}

/// Whether a field is at most zero anywhere on an element.
///
/// Stops as soon as [`Certified::is_hit`] is decided. A touch within rounding of the surface
/// stays undecided; `limits.tolerance` is the clearance at which the search stops.
///
/// # Errors
///
/// If the tolerance is negative, NaN or too large.
pub fn touches<const N: usize, const D: usize>(
    shape: &Shape<D>,
    element: &Element<N, D>,
    limits: &Limits,
    workspace: &mut ElementWorkspace<N, D>,
) -> Result<Certified<Point<D>>, QueryError> {
    limits.check()?;
    let goal = Goal::sign(limits.tolerance);
    Ok(search(shape, element, &Terms::new(goal, limits.budget), workspace))
}

/// Values of the field at points.
#[derive(Clone, Copy)]
struct ValuesAt<'a, const D: usize> {
    points: &'a [Point<D>],
    values: &'a [f64],
}

/// The terms of a search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Terms {
    pub(crate) goal: Goal,
    pub(crate) budget: u32,
    /// Subtracted from all values [m].
    pub(crate) level: f64,
    /// Rounding is computed for coordinates at least this large [m].
    pub(crate) reach: f64,
}

impl Terms {
    fn new(goal: Goal, budget: u32) -> Self {
        Self { goal, budget, level: 0.0, reach: 0.0 }
    }
}

#[inline(never)]
pub(crate) fn search<const N: usize, const D: usize>(
    shape: &Shape<D>,
    element: &Element<N, D>,
    terms: &Terms,
    workspace: &mut ElementWorkspace<N, D>,
) -> Certified<Point<D>> {
    ElementSearch::new(shape, element, terms, &mut workspace.samples)
        .run(element, &mut workspace.frontier)
}

/// The search for the least value on an element, as a problem of the engine.
pub(crate) struct ElementSearch<'a, const N: usize, const D: usize> {
    pub(crate) sampler: Sampler<'a, D>,
    pub(crate) goal: Goal,
    pub(crate) budget: u32,
    /// The weights of a cell's vertices in its centre.
    pub(crate) weights: [f64; N],
    /// The number of halves of a cell.
    pub(crate) parts: usize,
    pub(crate) radius: f64,
    /// The least value found plus its rounding, and where it was found.
    pub(crate) upper: f64,
    pub(crate) best: Point<D>,
    /// The least bound of closed cells.
    pub(crate) dropped: f64,
    /// Keeps all cells that may be below zero, not only those that may hold the minimum.
    pub(crate) keeps_all: bool,
}

impl<'a, const N: usize, const D: usize> ElementSearch<'a, N, D> {
    // Always inlined: most searches end after the first samples and are mostly this.
    #[inline(always)]
    pub(crate) fn new(
        shape: &'a Shape<D>,
        element: &Element<N, D>,
        terms: &Terms,
        samples: &'a mut Samples<D>,
    ) -> Self {
        let weights = element.centre_weights();
        let centre = element.at(&weights);
        let radius = element.farthest(centre);
        // No less than the norm, and without a root.
        let away = centre.0.iter().fold(0.0, |sum, x| sum + x.abs());
        let reach = larger(terms.reach, away + (1.0 + HIGHEST) * radius);
        Self {
            sampler: Sampler::new(shape, samples, reach, terms.level),
            goal: terms.goal,
            budget: terms.budget,
            weights,
            parts: parts_of_one::<N>(),
            radius,
            upper: f64::INFINITY,
            best: centre,
            dropped: f64::INFINITY,
            keeps_all: false,
        }
    }

    /// The radius of the smallest ball around a cell [m], which each halving halves.
    #[inline]
    pub(crate) fn radius_of(&self, cell: &ElementCell<N, D>) -> f64 {
        // The power of two by its exponent.
        let share = f64::from_bits(u64::from(1023 - cell.level) << 52);
        self.radius * share
    }

    /// Cells with a lower bound from this on are closed.
    #[inline]
    fn threshold(&self) -> f64 {
        if self.keeps_all { f64::MIN_POSITIVE } else { self.goal.threshold(self.upper) }
    }

    /// Takes a value on the element as the least, if it is.
    #[inline]
    fn found(&mut self, p: Point<D>, value: f64) {
        let value = value + self.sampler.steepness.slack;
        if value < self.upper {
            (self.upper, self.best) = (value, p);
        }
    }

    pub(crate) fn answer(&self, lower: f64, stop: Stop) -> Certified<Point<D>> {
        let (best, upper) = (self.best, self.upper);
        let lower = lower.min(upper);
        Certified { best, lower, upper, stop, evaluations: self.sampler.evaluations }
    }

    #[inline(always)]
    fn run(
        &mut self,
        element: &Element<N, D>,
        frontier: &mut Frontier<Vec<ElementCell<N, D>>>,
    ) -> Certified<Point<D>> {
        match self.begin(element) {
            Err(answer) => answer,
            Ok(whole) => {
                frontier.queue.clear();
                frontier.queue.push(whole);
                self.finish(frontier)
            }
        }
    }

    /// The whole element as a cell, or the answer if the first samples suffice.
    #[inline(always)]
    pub(crate) fn begin(
        &mut self,
        element: &Element<N, D>,
    ) -> Result<ElementCell<N, D>, Certified<Point<D>>> {
        let centre = self.best;
        let (value, gradient) = self.sampler.slope(centre);
        self.found(centre, value);
        // A NaN bounds nothing.
        let lower =
            larger(f64::NEG_INFINITY, self.sampler.steepness.bound(centre, value, self.radius));
        if let Some(stop) = self.goal.reached(lower, self.upper) {
            return Err(self.answer(lower, stop));
        }
        if self.goal.is_sign() {
            let lowest = element.lowest_along(gradient);
            if value + gradient.dot(lowest - centre) <= 0.0 {
                let value = self.sampler.value(lowest);
                self.found(lowest, value);
                if self.goal.is_hit(self.upper) {
                    return Err(self.answer(lower, Stop::SignKnown));
                }
            }
        }
        let flat = element.flattened(&self.weights);
        if let Some(flat) = &flat {
            (self.weights, self.parts) = (flat.centre_weights(), 2);
        }
        let mut whole = ElementCell {
            element: flat.unwrap_or(*element),
            lower,
            upper: self.upper,
            height: FIRST_HEIGHTS[0] * self.radius,
            direction: unit(gradient),
            level: 0,
        };
        let values = self.look_around(&mut whole, centre);
        if self.goal.reached(whole.lower, self.upper).is_none() {
            self.look_from_lowest(&mut whole, &values, centre, gradient);
        }
        Ok(whole)
    }

    /// Searches the waiting cells until enough is known.
    #[inline(always)]
    pub(crate) fn finish(
        &mut self,
        frontier: &mut Frontier<Vec<ElementCell<N, D>>>,
    ) -> Certified<Point<D>> {
        let end = engine::search(self, frontier);
        self.answer(frontier.lower(self.dropped), end.stop())
    }

    /// Samples the vertices, and points over the centre at several heights; returns the
    /// values at the vertices.
    #[inline(always)]
    fn look_around(&mut self, cell: &mut ElementCell<N, D>, centre: Point<D>) -> [f64; N] {
        let heights = FIRST_HEIGHTS.map(|height| height * self.radius);
        let points: [Point<D>; AT_ONCE] = std::array::from_fn(|i| match i.checked_sub(N) {
            None => cell.element.vertices[i],
            Some(k) => centre + cell.direction * heights[k.min(heights.len() - 1)],
        });
        let values = self.sampler.values(&points);
        for (i, (p, value)) in points.into_iter().zip(values).enumerate() {
            match i.checked_sub(N) {
                None => self.found(p, value),
                Some(_) if self.goal.is_hit(self.upper) => break,
                Some(k) => {
                    let lower = self.over(cell, p, value);
                    if lower > cell.lower {
                        cell.lower = lower;
                        cell.height = heights[k.min(heights.len() - 1)];
                    }
                }
            }
        }
        std::array::from_fn(|i| values[i])
    }

    /// Samples around the lowest known point: towards each vertex, at the minimum of the
    /// parabola through both values with the slope at the lowest, and points over the lowest.
    #[inline(always)]
    fn look_from_lowest(
        &mut self,
        cell: &mut ElementCell<N, D>,
        vertices: &[f64; N],
        centre: Point<D>,
        gradient: Vector<f64, D>,
    ) {
        let lowest = self.best;
        let value = self.upper - self.sampler.steepness.slack;
        let gradient = if lowest == centre { gradient } else { self.sampler.slope(lowest).1 };
        let direction = unit(gradient);
        let points: [Point<D>; AT_ONCE] = std::array::from_fn(|i| match i.checked_sub(N) {
            None => {
                let way = cell.element.vertices[i] - lowest;
                let descent = larger(0.0, -gradient.dot(way));
                let bend = descent + vertices[i] - value;
                let share = 0.5 * descent / bend;
                // Outside of (0, 1) or NaN where the values contradict the slope.
                if share > 0.0 && share < 1.0 { lowest + way * share } else { lowest }
            }
            Some(k) => {
                lowest + direction * (OVER_LOWEST[k.min(OVER_LOWEST.len() - 1)] * self.radius)
            }
        });
        let values = self.sampler.values(&points);
        for (i, (p, value)) in points.into_iter().zip(values).enumerate() {
            if i < N {
                self.found(p, value);
            } else {
                cell.lower = larger(cell.lower, self.over(cell, p, value));
            }
        }
    }

    /// The lower bound that a value at any point gives a cell.
    #[inline]
    fn over(&self, cell: &ElementCell<N, D>, p: Point<D>, value: f64) -> f64 {
        self.sampler.steepness.bound(p, value, cell.element.farthest(p))
    }

    /// Bounds parts of one size, at most [`AT_ONCE`]: by their centres, and by points lifted
    /// off them.
    #[inline]
    pub(crate) fn bound_parts(&mut self, parts: &mut [ElementCell<N, D>]) {
        let count = parts.len();
        let mut points: [Point<D>; AT_ONCE] =
            std::array::from_fn(|i| parts[i.min(count - 1)].element.at(&self.weights));
        if parts[0].level.is_multiple_of(2) {
            let (values, directions) = self.sampler.slopes(&points);
            for (part, direction) in parts.iter_mut().zip(directions) {
                part.direction = direction;
            }
            self.settle(parts, &points, &values);
            if count <= AT_ONCE / 2 {
                self.lift(parts, &points, &values, &[1.0, LOWER]);
            } else {
                self.lift(parts, &points, &values, &[1.0]);
                self.lift(parts, &points, &values, &[LOWER]);
            }
        } else if count <= AT_ONCE / 2 {
            // The block has room for the lifted points too.
            let (centres, lifted) = points.split_at_mut(AT_ONCE / 2);
            for ((part, centre), point) in parts.iter().zip(&*centres).zip(lifted) {
                *point = *centre + part.direction * part.height;
            }
            let values = self.sampler.values(&points);
            let (centres, lifted) = points.split_at(AT_ONCE / 2);
            let (values, lifted_values) = values.split_at(AT_ONCE / 2);
            self.settle(parts, centres, values);
            let centres = ValuesAt { points: centres, values };
            let lifted = ValuesAt { points: lifted, values: lifted_values };
            self.learn(parts, centres, lifted, 1.0);
        } else {
            let values = self.sampler.values(&points);
            self.settle(parts, &points, &values);
            self.lift(parts, &points, &values, &[1.0]);
        }
    }

    /// Bounds parts by the values at their centres.
    #[inline]
    fn settle(
        &mut self,
        parts: &mut [ElementCell<N, D>],
        centres: &[Point<D>],
        values: &[f64],
    ) {
        for ((part, centre), value) in parts.iter_mut().zip(centres).zip(values) {
            self.found(*centre, *value);
            part.upper = *value + self.sampler.steepness.slack;
            let lower = self.sampler.steepness.bound(*centre, *value, self.radius_of(part));
            part.lower = larger(part.lower, lower);
        }
    }

    /// Bounds parts by points over their centres, at `shares` of their heights, all in one
    /// block.
    #[inline]
    fn lift(
        &mut self,
        parts: &mut [ElementCell<N, D>],
        centres: &[Point<D>; AT_ONCE],
        values: &[f64; AT_ONCE],
        shares: &[f64],
    ) {
        let threshold = self.threshold();
        let is_open = |part: &ElementCell<N, D>| part.lower < threshold;
        if self.goal.is_hit(self.upper) || !parts.iter().any(is_open) {
            return;
        }
        let mut points = *centres;
        let lanes = AT_ONCE / shares.len();
        for (points, share) in points.chunks_exact_mut(lanes).zip(shares) {
            for ((point, part), centre) in points.iter_mut().zip(&*parts).zip(centres) {
                *point = *centre + part.direction * (share * part.height);
            }
        }
        let lifted = self.sampler.values(&points);
        let lifted = points.chunks_exact(lanes).zip(lifted.chunks_exact(lanes));
        for ((points, lifted), share) in lifted.zip(shares) {
            let centres = ValuesAt { points: centres, values };
            self.learn(parts, centres, ValuesAt { points, values: lifted }, *share);
        }
    }

    /// Bounds parts by values over their centres, at `share` of their heights, and adapts the
    /// heights.
    #[inline(always)]
    fn learn(
        &mut self,
        parts: &mut [ElementCell<N, D>],
        centres: ValuesAt<'_, D>,
        lifted: ValuesAt<'_, D>,
        share: f64,
    ) {
        let highest = self.radius * FIRST_HEIGHTS[FIRST_HEIGHTS.len() - 1];
        for (i, part) in parts.iter_mut().enumerate() {
            let radius = self.radius_of(part);
            let (centre, value) = (centres.points[i], centres.values[i]);
            let lower = self.over(part, lifted.points[i], lifted.values[i]);
            if lower >= part.lower {
                let nearly_all = value - 0.25 * self.sampler.steepness.lipschitz * radius;
                let grown = if lower > nearly_all { GROW } else { 1.0 };
                part.height = (grown * share * part.height).min(highest);
                part.lower = lower;
            } else if lower <= self.sampler.steepness.bound(centre, value, radius) {
                part.height *= SHRINK;
            }
        }
    }
}

impl<const N: usize, const D: usize> Problem for ElementSearch<'_, N, D> {
    type Queue = Vec<ElementCell<N, D>>;

    #[inline]
    fn round_and_parts(&self) -> (usize, usize) {
        (AT_ONCE, self.parts)
    }

    #[inline]
    fn decided(&self, lower: f64) -> Option<Stop> {
        self.goal.reached(lower, self.upper)
    }

    #[inline]
    fn has_room(&self, frontier: &Frontier<Self::Queue>) -> bool {
        frontier.queue.len() + AT_ONCE <= frontier.queue.capacity()
    }

    #[inline]
    fn is_spent(&self) -> bool {
        self.sampler.evaluations >= self.budget
    }

    /// A block has room for the parts of several cells, and costs the same with fewer.
    #[inline]
    fn can_split(&self, queue: &Self::Queue) -> bool {
        !queue.is_empty()
    }

    #[inline]
    fn split(&mut self, cell: &ElementCell<N, D>, round: &mut Vec<ElementCell<N, D>>) {
        cell.halve_into(self.parts, round);
    }

    #[inline]
    fn bound(&mut self, frontier: &mut Frontier<Self::Queue>) {
        self.bound_parts(&mut frontier.round);
    }

    #[inline]
    fn is_open(&self, cell: &ElementCell<N, D>) -> bool {
        cell.lower < self.threshold() && cell.level < MOST_LEVELS
    }

    #[inline]
    fn close(&mut self, cell: &ElementCell<N, D>, _queue: &mut Self::Queue) {
        self.dropped = self.dropped.min(cell.lower);
    }

    #[inline]
    fn closed(&self) -> f64 {
        self.dropped
    }
}

/// A lower bound of the distance from the origin to the part of a box with these corners
/// in which `n·y ≤ −d`, with `n` of length one and `d` positive.
///
/// For each λ ≥ 0 the least value of `|y|² + 2λ(n·y + d)` over the box bounds its square.
/// The largest is where `n·y = −d`, and Newton's method finds it, from the λ of a box that
/// does not matter.
pub(crate) fn distance_to_cut_box<const D: usize>(
    [low, high]: [Vector<f64, D>; 2],
    n: Vector<f64, D>,
    d: f64,
) -> f64 {
    /// Each makes one more coordinate free or fixed.
    const STEPS: usize = 8;
    let (mut multiplier, mut best) = (d, 0.0_f64);
    for _ in 0..STEPS {
        let (mut squared, mut along, mut size, mut free) = (0.0, d, d, 0.0);
        for k in 0..D {
            let wanted = -multiplier * n[k];
            let y = wanted.max(low[k]).min(high[k]);
            squared += y * y;
            along += n[k] * y;
            size += (n[k] * y).abs();
            free += if y == wanted { n[k] * n[k] } else { 0.0 };
        }
        let rounding = ROUNDINGS * (squared + 2.0 * multiplier * size);
        best = best.max(squared + 2.0 * multiplier * along - rounding);
        // Where no coordinate is free: all of the box is beyond the plane, or a longer way
        // makes one free, or nothing of it is.
        let next = if free > 0.0 {
            (multiplier + along / free).max(0.0)
        } else if along < 0.0 {
            0.0
        } else {
            2.0 * multiplier
        };
        if next == multiplier {
            break;
        }
        multiplier = next;
    }
    best.sqrt()
}

/// A triangle counts as without area if its height is at most this many roundings of its
/// largest coordinate: fewer than searches allow for.
const FLAT_ROUNDINGS: f64 = 4.0;

/// The convex hull of `N` points: a segment of 2 or a triangle of 3, in `D` dimensions.
/// Points may coincide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element<const N: usize, const D: usize> {
    pub(crate) vertices: [Point<D>; N],
}

impl<const N: usize, const D: usize> Element<N, D> {
    /// The segment or triangle with these `vertices` [m].
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite or beyond 1e15 m.
    pub fn new(vertices: [impl Into<Point<D>>; N]) -> Result<Self, QueryError> {
        const { assert!(N == 2 || N == 3, "segments and triangles") };
        let vertices = vertices.map(Into::into);
        for vertex in vertices {
            QueryError::check_point("vertex", vertex)?;
        }
        Ok(Self { vertices })
    }

    /// The vertices [m].
    #[must_use]
    pub fn vertices(&self) -> &[Point<D>; N] {
        &self.vertices
    }

    /// The length of the longest edge [m].
    #[must_use]
    pub fn longest_edge(&self) -> f64 {
        self.vertices.iter().map(|vertex| self.farthest(*vertex)).fold(0.0, f64::max)
    }

    /// The smallest ball around the element, its radius rounded up. A field of steepness 1 that
    /// is greater at the centre than the radius is positive on the whole element.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_query::Element;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let sliver = [Vector([0.0, 0.0]), Vector([1.0, 0.0]), Vector([0.5, 0.01])];
    /// let element = Element::new(sliver)?;
    /// assert_eq!(element.smallest_ball().centre, Vector([0.5, 0.0]));
    /// let around = element.circumscribed_ball().ok_or("the corners lie on a line")?;
    /// assert!(around.radius > 12.0);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn smallest_ball(&self) -> BoundingBall<D> {
        palpate_mesh::smallest_ball(&self.vertices)
    }

    /// The ball about the circumcentre of a triangle that its vertices lie on, its radius rounded
    /// up; the smallest ball of a segment. `None` if the vertices of a triangle lie on a line.
    #[must_use]
    pub fn circumscribed_ball(&self) -> Option<BoundingBall<D>> {
        palpate_mesh::circumscribed_ball(&self.vertices)
    }

    /// The barycentric weights of the centre of the smallest ball around the element.
    #[inline]
    pub(crate) fn centre_weights(&self) -> [f64; N] {
        palpate_mesh::centre_weights(&self.vertices)
    }

    /// A triangle without area as its longest edge with the second end doubled, so that its
    /// first two halves are all of it; `weights` are those of the triangle's centre.
    pub(crate) fn flattened(&self, weights: &[f64; N]) -> Option<Self> {
        let middle = (0..N).find(|&k| N == 3 && weights[k] == 0.0)?;
        let v = |k: usize| self.vertices[(middle + k) % N];
        let (edge, side) = (v(2) - v(1), v(0) - v(1));
        let squared = edge.dot(edge);
        let share = if squared > 0.0 { side.dot(edge) / squared } else { 0.0 };
        let off = side - edge * share;
        let largest = self.vertices.iter().fold(0.0_f64, |m, v| m.max(v.dot(*v)));
        let rounding = FLAT_ROUNDINGS * f64::EPSILON;
        let is_flat = off.dot(off) <= rounding * rounding * largest;
        let mut vertices = [v(2); N];
        vertices[0] = v(1);
        is_flat.then_some(Self { vertices })
    }

    /// The point with these barycentric weights of the vertices [m].
    #[must_use]
    #[inline]
    pub fn at(&self, weights: &[f64; N]) -> Point<D> {
        let mut point = Vector::ZERO;
        for (vertex, weight) in self.vertices.iter().zip(weights) {
            point += *vertex * *weight;
        }
        point
    }

    /// The vertex that is lowest along `way`.
    #[inline]
    pub(crate) fn lowest_along(&self, way: Vector<f64, D>) -> Point<D> {
        let (mut lowest, mut least) = (self.vertices[0], f64::INFINITY);
        for vertex in &self.vertices {
            let along = way.dot(*vertex);
            (lowest, least) = if along < least { (*vertex, along) } else { (lowest, least) };
        }
        lowest
    }

    /// The distance of `p` from the farthest point of the element, a vertex [m].
    #[must_use]
    #[inline]
    pub fn farthest(&self, p: Point<D>) -> f64 {
        let mut farthest = 0.0;
        for vertex in &self.vertices {
            let apart = *vertex - p;
            let squared = apart.dot(apart);
            farthest = if squared > farthest { squared } else { farthest };
        }
        farthest.sqrt()
    }

    /// The parts of half the size that make up the element, all similar to it: two of a
    /// segment, four of a triangle. Unused places hold the last. Of a triangle with two
    /// equal last vertices, the first two are all of it.
    #[doc(hidden)]
    #[must_use]
    #[inline]
    pub fn halves(&self) -> [Self; 4] {
        let v = &self.vertices;
        let middle = |i: usize, k: usize| (v[i] + v[k]) * 0.5;
        let part = |points: [Point<D>; 3]| {
            let mut vertices = *v;
            vertices.copy_from_slice(&points[..N]);
            Self { vertices }
        };
        if N == 2 {
            let centre = middle(0, 1);
            let last = part([centre, v[1], centre]);
            return [part([v[0], centre, centre]), last, last, last];
        }
        // The middle one is turned by half a turn: each vertex is across from its own.
        let across = [middle(1, 2), middle(2, 0), middle(0, 1)];
        [
            part([v[0], across[2], across[1]]),
            part([across[2], v[1], across[0]]),
            part([across[1], across[0], v[2]]),
            part(across),
        ]
    }
}

/// How many [halves](Element::halves) an element has.
#[must_use]
pub const fn parts_of_one<const N: usize>() -> usize {
    if N == 2 { 2 } else { 4 }
}

#[cfg(test)]
mod cut_box_tests {
    use super::*;

    #[test]
    fn a_cut_box_is_as_far_as_its_part() {
        let n = Vector([-0.6, -0.8]);
        let distance = |low: [f64; 2], high: [f64; 2], d: f64| {
            distance_to_cut_box([Vector(low), Vector(high)], n, d)
        };
        let is = |found: f64, truth: f64| truth - 1e-12 < found && found <= truth;
        // The line alone, from which (0.6, 0.8)·d is nearest.
        assert!(is(distance([-9.0, -9.0], [9.0, 9.0], 0.5), 0.5));
        // A side that cuts off that point: (2, y) with 1.2 + 0.8·y = 2.
        assert!(is(distance([2.0, -9.0], [5.0, 9.0], 2.0), 5.0_f64.sqrt()));
        // A corner alone.
        assert!(is(distance([-1.0, -1.0], [2.0, 1.0], 2.0), 5.0_f64.sqrt()));
        // The box is farther than the line.
        assert!(is(distance([3.0, 4.0], [5.0, 9.0], 2.0), 5.0));
        // No part of the box is beyond the line: farther than any.
        assert!(distance([-1.0, -1.0], [1.0, 1.0], 2.0) > 10.0);
    }
}
