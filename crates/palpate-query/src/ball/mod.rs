// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Balls against a field.
//!
//! How deep a ball is in a field.
//!
//! The gap between a ball about C with radius r and a shape is `d(C) − r`, with the signed
//! distance d. Where the field is exact on C's side, `d = f(C)`, and one evaluation is all.
//! Where it is a bound, `f(C) > r` proves that they are apart, and `f(C) ≤ r` nothing.
//! There the nearest point is searched for at which the field has the other sign: d is its
//! distance from C, and its negative from inside.
//!
//! The search is over boxes, the nearest to C first. It leaves out a box if the field's value
//! at its centre, or its model, proves that the box holds no such point. For the other boxes
//! the model bounds the field by an affine function: such points lie in a half-space, and the
//! distance to the part of the box in it bounds the distance of the points.

use palpate_field::scalar::Model;
use palpate_field::{
    Aabb, BLOCK, Block, BoundingBall, Column, Point, Pose, Quality, Shape, Vector,
};

use crate::certified::{Certified, Goal, Limits, Stop};
use crate::contact::Contact;
use crate::element_search::distance_to_cut_box;
use crate::engine::{self, End, Frontier, Heap, Problem, Queue};
use crate::error::QueryError;
use crate::pair::distance_bound::DistanceBound;
use crate::pair::search::{BoxCell, ROUNDINGS};
use crate::sampler::normal;

/// Steps of Newton's method through a surface at most.
const MOST_STEPS: u32 = 64;

/// Boxes that a workspace holds.
const ROOM: usize = 1 << 16;

/// Slides along a surface towards the centre at most.
const MOST_SLIDES: u32 = 24;

/// Memory of searches about balls, kept from one to the next.
#[derive(Debug)]
pub struct BallWorkspace<const D: usize> {
    frontier: Frontier<Heap<BoxCell<D>>>,
    memory: Memory<D>,
}

/// Memory of questions to a field.
#[derive(Debug)]
struct Memory<const D: usize> {
    points: Block<f64, D, BLOCK>,
    boxes: Block<Model, D, BLOCK>,
    values: Column<f64, BLOCK>,
    models: Column<Model, BLOCK>,
}

impl<const D: usize> BallWorkspace<D> {
    /// Room for searches in `D` dimensions.
    #[must_use]
    #[inline(never)]
    pub fn new() -> Self {
        Self {
            frontier: Frontier {
                queue: Heap::new(ROOM, ROOM),
                pending: Vec::new(),
                round: Vec::with_capacity(BLOCK),
            },
            memory: Memory {
                points: Block::zero(),
                boxes: Block::zero(),
                values: Column::zero(),
                models: Column::zero(),
            },
        }
    }
}

impl<const D: usize> Default for BallWorkspace<D> {
    fn default() -> Self {
        Self::new()
    }
}

/// The gap between a ball and a shape [m], between bounds, to `limits.tolerance`: the
/// signed distance of the `centre` [m] less the `radius` [m]. Negative, it is how deep the
/// ball is in the shape.
///
/// Body `a` of the contact is the shape, at the surface point nearest to the centre; body `b`
/// is the ball. Without a surface in reach there is no contact, and `upper` is infinite. Any
/// zero of the field is a surface, also inside a union where two members touch.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Cuboid};
/// use palpate_query::{Limits, BallWorkspace, Stop, contact_ball};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut workspace = BallWorkspace::new();
/// let square = Shape::from_kernel(Cuboid::new(Vector([2.0, 1.0]))?);
/// let centre = Vector([1.3, 0.9]);
/// let answer = contact_ball(&square, centre, 0.75, &Limits::new(1e-4), &mut workspace)?;
/// // Exact, and so known at once: the corner is 0.5 m from the centre.
/// assert_eq!((answer.evaluations, answer.stop), (2, Stop::Converged));
/// let contact = answer.best.ok_or("there is a contact")?;
/// assert!((contact.gap + 0.25).abs() < 1e-15);
/// assert!((contact.point_a - Vector([1.0, 0.5])).norm() < 1e-15);
/// assert!((contact.normal - Vector([0.6, 0.8])).norm() < 1e-15);
/// assert!((contact.point_b - Vector([0.85, 0.3])).norm() < 1e-15);
///
/// // A bound, a quarter of the distance here, needs a search.
/// let ellipse = square.stretched([1.0, 4.0])?;
/// let answer = contact_ball(&ellipse, Vector([0.3, 6.0]), 1.0, &Limits::new(1e-4), &mut workspace)?;
/// assert!(answer.lower <= 3.0 && 3.0 <= answer.upper && answer.upper < 3.0 + 1e-4);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If a coordinate is not finite or beyond 1e15 m, or the radius or the tolerance is negative.
pub fn contact_ball<const D: usize>(
    shape: &Shape<D>,
    centre: impl Into<Point<D>>,
    radius: f64,
    limits: &Limits,
    workspace: &mut BallWorkspace<D>,
) -> Result<Certified<Option<Contact<D>>>, QueryError> {
    let goal = Goal::least(limits.tolerance);
    search(
        shape,
        BoundingBall { centre: centre.into(), radius },
        goal,
        limits.budget,
        workspace,
    )
}

/// Whether a ball and a shape touch, in [`Certified::is_hit`]; arguments and errors as of
/// [`contact_ball`].
///
/// Stops as soon as that is decided, or the gap is proven to be within `limits.tolerance` of
/// zero. One evaluation decides where the field is exact, where it is a bound that exceeds
/// the radius, and where the centre is inside.
///
/// # Errors
///
/// If a coordinate is not finite or beyond 1e15 m, or the radius or the tolerance is negative.
pub fn touches_ball<const D: usize>(
    shape: &Shape<D>,
    centre: impl Into<Point<D>>,
    radius: f64,
    limits: &Limits,
    workspace: &mut BallWorkspace<D>,
) -> Result<Certified<Option<Contact<D>>>, QueryError> {
    let goal = Goal::sign(limits.tolerance);
    search(
        shape,
        BoundingBall { centre: centre.into(), radius },
        goal,
        limits.budget,
        workspace,
    )
}

#[inline(never)]
pub(crate) fn search<const D: usize>(
    shape: &Shape<D>,
    BoundingBall { centre, radius }: BoundingBall<D>,
    goal: Goal,
    budget: u32,
    workspace: &mut BallWorkspace<D>,
) -> Result<Certified<Option<Contact<D>>>, QueryError> {
    QueryError::check_point("centre", centre)?;
    QueryError::check_length(radius)?;
    QueryError::check_length(goal.tolerance)?;
    let (value, gradient) = shape.distance_gradient(centre);
    let promise = shape.promise();
    let is_inside = value < 0.0;
    let extent = promise.bounds.map_or(value.abs(), |bounds| bounds.radius_about_origin());
    let mut search = BallSearch {
        body: DistanceBound::new(shape, Pose::identity()),
        lipschitz: promise.lipschitz,
        centre,
        radius,
        goal,
        budget,
        sign: if is_inside { -1.0 } else { 1.0 },
        fallback: normal(gradient),
        geometry: ROUNDINGS * (centre.norm() + radius + extent),
        safe: 0.0,
        reach: f64::INFINITY,
        best: None,
        dropped: f64::INFINITY,
        evaluations: 2,
    };
    let quality = if is_inside { promise.inside } else { promise.outside };
    let rounding = search.slack(centre) + search.geometry;
    if quality == Quality::Exact {
        let surface = centre - gradient * value;
        let gap = value - radius;
        let best = search.contact(surface);
        return Ok(search.answer(best, gap - rounding, gap + rounding));
    }
    if value.abs() <= rounding {
        return Ok(search.at_the_surface());
    }
    search.safe = (promise.safe_radius(centre, value) - rounding).max(0.0);
    Ok(search.run(workspace))
}

/// A search for the nearest point at which the field does not have the sign that it has at
/// the centre.
struct BallSearch<'a, const D: usize> {
    body: DistanceBound<'a, D>,
    lipschitz: f64,
    centre: Point<D>,
    radius: f64,
    goal: Goal,
    budget: u32,
    /// Of the field at the centre: 1 or −1.
    sign: f64,
    /// The normal where the centre lies on the surface.
    fallback: Option<Vector<f64, D>>,
    /// The rounding of distances from the centre [m].
    geometry: f64,
    /// Proven lower bound of the distance to the surface, from the value at the centre [m].
    safe: f64,
    /// The distance of the nearest point found, and the point [m].
    reach: f64,
    best: Option<Point<D>>,
    /// The least bound of closed boxes [m].
    dropped: f64,
    evaluations: u32,
}

impl<const D: usize> BallSearch<'_, D> {
    fn run(&mut self, workspace: &mut BallWorkspace<D>) -> Certified<Option<Contact<D>>> {
        if let Some(stop) = self.reached(self.safe) {
            return self.finish(self.safe, stop);
        }
        if let Some(found) = self.through(self.centre, self.sign) {
            self.slide(found);
        }
        self.look_past_bounds();
        if self.reach.is_finite() {
            self.geometry += ROUNDINGS * self.reach;
        }
        let BallWorkspace { frontier, memory } = workspace;
        frontier.queue.clear();
        if let Some(root) = self.root() {
            frontier.queue.push(&BoxCell { lower: self.safe, ..BoxCell::unknown(&root) });
        }
        let end = engine::search(&mut BallRounds { search: self, memory }, frontier);
        let lower = frontier.lower(self.dropped).max(self.safe);
        let stop = match end {
            // The whole box was searched, and holds no surface.
            End::Exhausted if self.gaps(lower).0 > 0.0 => Stop::SignKnown,
            end => end.stop(),
        };
        self.finish(lower, stop)
    }

    /// The bounds of the gap, if no surface is nearer than `lower`.
    fn gaps(&self, lower: f64) -> (f64, f64) {
        let lower = (lower - self.geometry).max(0.0);
        let reach = self.reach + self.geometry;
        if self.sign > 0.0 {
            (lower.min(reach) - self.radius, reach - self.radius)
        } else {
            (-reach - self.radius, -lower.min(reach) - self.radius)
        }
    }

    fn reached(&self, lower: f64) -> Option<Stop> {
        let (low, high) = self.gaps(lower);
        self.goal.reached(low, high)
    }

    fn finish(&self, lower: f64, stop: Stop) -> Certified<Option<Contact<D>>> {
        let (lower, upper) = self.gaps(lower);
        let best = self.best.and_then(|surface| self.contact(surface));
        Certified { best, lower, upper, stop, evaluations: self.evaluations }
    }

    fn answer(
        &self,
        best: Option<Contact<D>>,
        lower: f64,
        upper: f64,
    ) -> Certified<Option<Contact<D>>> {
        let stop = self.goal.reached(lower, upper).unwrap_or(Stop::RoundingReached);
        Certified { best, lower, upper, stop, evaluations: self.evaluations }
    }

    /// The answer where the field at the centre is rounding, and its side unknown.
    fn at_the_surface(&mut self) -> Certified<Option<Contact<D>>> {
        let [inside, outside] = [1.0, -1.0].map(|sign| {
            let found = self.through(self.centre, sign);
            found.map_or(f64::INFINITY, |p| (p - self.centre).norm() + self.geometry)
        });
        let best = self.contact(self.centre);
        self.answer(best, -outside - self.radius, inside - self.radius)
    }

    /// The contact with this point of the surface, if there is a normal.
    fn contact(&self, surface: Point<D>) -> Option<Contact<D>> {
        let away = self.centre - surface;
        let distance = away.norm();
        let is_far = distance > self.geometry;
        let direction = is_far.then(|| away * (self.sign / distance)).or(self.fallback)?;
        Some(Contact::new(surface, self.centre - direction * self.radius, direction))
    }

    /// The rounding of the field at a point [m].
    fn slack(&self, p: Point<D>) -> f64 {
        self.body.shape.promise().rounding.within(p.norm())
    }

    /// The rounding of the field in a box [m].
    fn slack_of(&self, aabb: &Aabb<D>) -> f64 {
        self.body.shape.promise().rounding.within(aabb.radius_about_origin())
    }

    /// Whether a value is proven not to have `sign`. A shape without interior is reached where
    /// the value is zero up to rounding.
    fn is_through(&self, sign: f64, value: f64, slack: f64) -> bool {
        let has_inside = self.body.shape.promise().has_interior;
        sign * value <= if has_inside || sign < 0.0 { -slack } else { slack }
    }

    /// A point near the surface at which the field does not have `sign`, by Newton's method
    /// from `start`; bisects back from a step that overshot.
    fn through(&mut self, start: Point<D>, sign: f64) -> Option<Point<D>> {
        let (mut before, mut p) = (None, start);
        for _ in 0..MOST_STEPS {
            let (value, gradient) = self.body.shape.distance_gradient(p);
            self.evaluations += 2;
            let slack = self.slack(p);
            if self.is_through(sign, value, slack) {
                let is_deep = sign * value < -8.0 * slack;
                let before = before.unwrap_or(self.centre);
                return Some(if is_deep { self.between(before, p, sign) } else { p });
            }
            normal(gradient)?;
            before = Some(p);
            p -= gradient * ((value + sign * 2.0 * slack) / gradient.dot(gradient));
        }
        None
    }

    /// A point just through the surface on the way from a point with `sign` to one without,
    /// halved until the next halves are roundings.
    fn between(&mut self, with: Point<D>, without: Point<D>, sign: f64) -> Point<D> {
        let (mut with, mut without) = (with, without);
        for _ in 0..f64::MANTISSA_DIGITS {
            let middle = (with + without) * 0.5;
            self.evaluations += 1;
            let value = self.body.shape.distance(middle);
            let is_through = self.is_through(sign, value, self.slack(middle));
            *(if is_through { &mut without } else { &mut with }) = middle;
        }
        without
    }

    /// Takes a point as the nearest, if it is, and slides it along the surface towards the
    /// centre: to the nearest point of the tangent plane, and back through the surface.
    fn slide(&mut self, start: Point<D>) {
        let mut share = 1.0;
        self.take(start);
        let mut p = start;
        for _ in 0..MOST_SLIDES {
            let before = (p - self.centre).norm();
            let (value, gradient) = self.body.shape.distance_gradient(p);
            self.evaluations += 2;
            let squared = gradient.dot(gradient);
            if normal(gradient).is_none() || before == 0.0 {
                return;
            }
            let along = (gradient.dot(p - self.centre) - value) / squared;
            let there = p + (self.centre + gradient * along - p) * share;
            let next = self.through(there, self.sign);
            match next.filter(|next| (*next - self.centre).norm() < before) {
                Some(next) => {
                    self.take(next);
                    if (next - p).norm() < 1e-3 * self.goal.tolerance {
                        return;
                    }
                    p = next;
                    share = (2.0_f64 * share).min(1.0);
                }
                None if share < 1e-2 => return,
                None => share *= 0.25,
            }
        }
    }

    fn take(&mut self, p: Point<D>) {
        let distance = (p - self.centre).norm();
        if distance < self.reach {
            (self.reach, self.best) = (distance, Some(p));
        }
    }

    /// From inside, the nearest point past the shape's box is outside.
    fn look_past_bounds(&mut self) {
        let Some(aabb) = self.body.aabb().filter(|_| self.sign < 0.0) else { return };
        let grown = aabb.grown(self.slack_of(&aabb) + self.geometry);
        for k in 0..D {
            for face in [grown.min[k], grown.max[k]] {
                if (face - self.centre[k]).abs() < self.reach {
                    let mut outside = self.centre;
                    outside[k] = face;
                    let found = self.between(self.centre, outside, self.sign);
                    self.take(found);
                }
            }
        }
    }

    /// A box that holds all points that can decide the question.
    fn root(&mut self) -> Option<Aabb<D>> {
        let aabb = self.body.aabb().filter(|_| self.sign > 0.0);
        let enough = self.radius + self.goal.tolerance.max(self.geometry);
        let is_bounded = self.reach.is_finite() || aabb.is_some();
        let asks_for_all = is_bounded && self.goal.apart.is_infinite();
        let far = if asks_for_all { self.reach } else { self.reach.min(enough) };
        self.dropped = far;
        let cube = Aabb { min: self.centre, max: self.centre }.grown(far * (1.0 + 1e-12));
        let Some(aabb) = aabb else { return Some(cube) };
        let mut root = aabb.grown(self.slack_of(&aabb) + self.geometry);
        for k in 0..D {
            root.min[k] = root.min[k].max(cube.min[k]);
            root.max[k] = root.max[k].min(cube.max[k]);
            if root.min[k] > root.max[k] {
                return None;
            }
        }
        Some(root)
    }

    /// Boxes at least this far are closed.
    fn threshold(&self) -> f64 {
        self.goal.threshold(self.reach - self.radius) + self.radius + 2.0 * self.geometry
    }

    fn distance_to_box(&self, part: &BoxCell<D>) -> f64 {
        let mut away = (part.centre - self.centre).abs() - part.half;
        for x in &mut away.0 {
            *x = x.max(0.0);
        }
        away.norm()
    }

    /// How far the part of a box is in which a model leaves room for points beyond the
    /// surface, a half-space; infinite if it leaves none.
    fn distance_to_room(&self, part: &BoxCell<D>, model: &Model) -> f64 {
        let remainder = if self.sign > 0.0 { model.lower } else { model.upper };
        let slack = self.slack(part.centre) + self.geometry;
        let value = self.sign * model.value - remainder - slack;
        let (mut at_centre, mut fall, mut slope) = (value, 0.0, Vector::ZERO);
        let mut size = model.value.abs();
        for k in 0..D {
            let change = self.sign * model.gradient[k];
            fall += change.abs();
            if part.half[k] > 0.0 {
                slope[k] = change / part.half[k];
                let term = slope[k] * (self.centre[k] - part.centre[k]);
                at_centre += term;
                size += term.abs();
            }
        }
        if value - fall - ROUNDINGS * (size + fall) > 0.0 {
            return f64::INFINITY;
        }
        let (height, steepness) = (at_centre - ROUNDINGS * size, slope.norm());
        if height <= 0.0 || steepness == 0.0 {
            return 0.0;
        }
        let offset = part.centre - self.centre;
        let sides = [offset - part.half, offset + part.half];
        distance_to_cut_box(sides, slope * (1.0 / steepness), height / steepness)
    }
}

/// The rounds of a search about a ball.
struct BallRounds<'s, 'a, const D: usize> {
    search: &'s mut BallSearch<'a, D>,
    memory: &'s mut Memory<D>,
}

impl<const D: usize> Problem for BallRounds<'_, '_, D> {
    type Queue = Heap<BoxCell<D>>;

    fn round_and_parts(&self) -> (usize, usize) {
        (BLOCK, 1 << D)
    }

    fn decided(&self, lower: f64) -> Option<Stop> {
        self.search.reached(lower.max(self.search.safe))
    }

    fn has_room(&self, frontier: &Frontier<Self::Queue>) -> bool {
        frontier.queue.has_room(BLOCK)
    }

    fn is_spent(&self) -> bool {
        self.search.evaluations >= self.search.budget
    }

    fn can_split(&self, queue: &Self::Queue) -> bool {
        queue.least() < self.search.threshold()
    }

    fn split(&mut self, cell: &BoxCell<D>, round: &mut Vec<BoxCell<D>>) {
        cell.halve(round);
    }

    /// Bounds boxes by the values at their centres, and those that stay by models; looks for
    /// a nearer point of the surface from the nearest box.
    fn bound(&mut self, frontier: &mut Frontier<Self::Queue>) {
        let mut is_steep = [false; BLOCK];
        let nearest = self.bound_by_values(&mut frontier.round, &mut is_steep);
        let search = &mut *self.search;
        if let Some((far, start)) = nearest
            && far < search.reach - 0.25 * search.goal.tolerance
            && let Some(found) = search.through(start, search.sign)
        {
            search.slide(found);
        }
        self.bound_by_models(&mut frontier.round, &is_steep);
    }

    fn is_open(&self, cell: &BoxCell<D>) -> bool {
        cell.lower < self.search.threshold()
    }

    fn close(&mut self, cell: &BoxCell<D>, _queue: &mut Self::Queue) {
        self.search.dropped = self.search.dropped.min(cell.lower);
    }

    fn closed(&self) -> f64 {
        self.search.dropped
    }
}

impl<const D: usize> BallRounds<'_, '_, D> {
    /// Takes out the boxes that hold no point beyond the surface, as their values tell, and
    /// notes of the others whether the field is as steep as promised there. Returns the
    /// nearest centre from which the surface may be found, and its distance.
    fn bound_by_values(
        &mut self,
        round: &mut Vec<BoxCell<D>>,
        is_steep: &mut [bool; BLOCK],
    ) -> Option<(f64, Point<D>)> {
        let Self { search, memory } = self;
        for (i, part) in round.iter().enumerate() {
            memory.points.set(i, part.centre);
        }
        search.body.shape.block_distances(&memory.points, round.len(), &mut memory.values);
        search.evaluations += round.len() as u32;
        let mut open = 0;
        let mut nearest: Option<(f64, Point<D>)> = None;
        for i in 0..round.len() {
            let mut part = round[i];
            let value = search.sign * memory.values.get(i);
            let radius = part.radius();
            let is_known = search.body.is_known(part.centre, radius);
            let slack = search.slack(part.centre) + search.geometry;
            if is_known && value - search.lipschitz * radius > slack {
                continue;
            }
            part.lower = part.lower.max(search.distance_to_box(&part));
            let far = (part.centre - search.centre).norm();
            let may_help = search.best.is_none() || search.is_through(1.0, value, slack);
            if may_help && nearest.is_none_or(|(least, _)| far < least) {
                nearest = Some((far, part.centre));
            }
            (round[open], is_steep[open]) = (part, is_known);
            open += 1;
        }
        round.truncate(open);
        nearest
    }

    /// Bounds boxes by models, where the field is as steep as promised.
    fn bound_by_models(&mut self, round: &mut [BoxCell<D>], is_steep: &[bool; BLOCK]) {
        if round.is_empty() {
            return;
        }
        let Self { search, memory } = self;
        for (lane, part) in round.iter().enumerate() {
            memory.boxes.set(lane, Vector(Model::cell(part.centre.0, part.half.0)));
        }
        let models = &mut memory.models;
        search.body.shape.block_distances(&memory.boxes, round.len(), models);
        search.evaluations += round.len() as u32;
        for (lane, part) in round.iter_mut().enumerate() {
            if is_steep[lane] {
                let room = search.distance_to_room(part, &models.get(lane));
                part.lower = part.lower.max(room);
            }
        }
    }
}
