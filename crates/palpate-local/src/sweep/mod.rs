// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches for a first touch.

use std::fmt;

use palpate_field::{Point, Vector};
use palpate_mesh::Mesh;
use palpate_query::{Element, Motion, Moving, QueryError, parts_of_one};

use crate::projected_gradient::{least_on_unit, support};
use crate::{ElementMethod, PairMethod, SumDescent, halton_starts};

/// A touch that a local search found, of a motion over the time from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LocalTouch<const D: usize> {
    /// The time of the touch: nothing says that it is the first.
    pub time: f64,
    /// Where, in world coordinates [m].
    pub point: Point<D>,
    /// The field there, at most the gap that was asked for [m]; between two bodies, the larger of both.
    pub value: f64,
    /// The index of the mesh's element; zero of one element alone, and between two bodies.
    pub element: usize,
}

/// What a local search for a first touch found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LocalSweep<const D: usize> {
    /// The earliest touch that was found; `None` says that none was found, not that there is none.
    pub touch: Option<LocalTouch<D>>,
    /// How often fields were asked; a gradient counts twice.
    pub evaluations: u32,
    /// Elements that the broad phase left to the search; between two bodies, starts of searches.
    pub searched: u32,
}

impl<const D: usize> LocalSweep<D> {
    fn nothing() -> Self {
        Self { touch: None, evaluations: 0, searched: 0 }
    }

    fn asked(&mut self, evaluations: u32) {
        self.evaluations = self.evaluations.saturating_add(evaluations);
    }

    /// Keeps the touch if it is earlier.
    fn keep(&mut self, touch: LocalTouch<D>) {
        if self.touch.is_none_or(|known| touch.time < known.time) {
            self.touch = Some(touch);
        }
    }

    /// Keeps what is at most `gap`, if it is the lowest.
    fn keep_lower(&mut self, touch: LocalTouch<D>, gap: f64) {
        if touch.value <= gap && self.touch.is_none_or(|known| touch.value < known.value) {
            self.touch = Some(touch);
        }
    }
}

impl<const D: usize> fmt::Display for LocalSweep<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.touch {
            Some(touch) => write!(f, "a touch at {} at {:?} m", touch.time, touch.point.0)?,
            None => write!(f, "no touch found")?,
        }
        write!(f, ", {} evaluations", self.evaluations)
    }
}

/// Steps of a march at most; the search begins where it is then.
const STEPS: u32 = 64;

/// The first time from `from` to `to` at which the field may be at most `gap` [m] on the element;
/// `None` if there is none. The second is how often the field was asked.
///
/// The smallest ball around the element turns in itself, so what counts is how its centre moves. Where a
/// field of steepness L has the value f at the centre, the ball meets no surface until the centre has
/// moved by `f/L` less the radius. So the march passes over no touch, but for rounding; where the
/// steepness holds in a region only, the march ends.
fn approach<const N: usize, const D: usize>(
    course: &Course<'_, D>,
    element: &Element<N, D>,
    [from, to]: [f64; 2],
    gap: f64,
) -> (Option<f64>, u32) {
    /// Shorter steps, as a share of the time that is left, end the march.
    const LEAST: f64 = 1e-3;
    let ball = element.smallest_ball();
    let promise = course.field.shape.promise();
    if promise.region.is_some() {
        return (Some(from), 0);
    }
    let steepness = promise.lipschitz.max(1.0);
    let mut time = from;
    for asked in 1..=STEPS {
        let free = (course.value(ball.centre, time) - gap) / steepness - ball.radius;
        if free.is_nan() || free <= 0.0 {
            return (Some(time), asked);
        }
        let step = free / course.fastest(ball.centre, time);
        if time + step > to {
            return (None, asked);
        }
        time += step;
        if step < LEAST * (to - from) {
            return (Some(time), asked);
        }
    }
    (Some(time), STEPS)
}

/// A field, and how the frame of an element moves past it.
#[derive(Clone, Copy, Debug)]
struct Course<'a, const D: usize> {
    field: Moving<'a, D>,
    motion: Motion<D>,
}

/// A field at a point of an element and a time, and how it changes with both.
#[derive(Clone, Copy, Debug)]
struct Slope<const D: usize> {
    /// [m].
    value: f64,
    /// By the point, in the element's coordinates.
    gradient: Vector<f64, D>,
    /// By the time, of which the motion takes one unit [m].
    rate: f64,
}

impl<'a, const D: usize> Course<'a, D> {
    /// Refuses poses that are not finite or too far away.
    fn new(field: Moving<'a, D>, motion: Motion<D>) -> Result<Self, QueryError> {
        field.motion.check(0)?;
        motion.check(1)?;
        Ok(Self { field, motion })
    }

    /// In world coordinates, a point of the element's.
    fn place(&self, p: Point<D>, time: f64) -> Point<D> {
        self.motion.pose(time).transform_point(p)
    }

    /// The field at a point of the element.
    fn value(&self, p: Point<D>, time: f64) -> f64 {
        let body_from_world = self.field.motion.pose(time).inverse();
        self.field.shape.distance(body_from_world.transform_point(self.place(p, time)))
    }

    fn slope(&self, p: Point<D>, time: f64) -> Slope<D> {
        let (world_from_body, world_from_element) =
            (self.field.motion.pose(time), self.motion.pose(time));
        let there = world_from_body.inverse().transform_point(self.place(p, time));
        let (value, gradient) = self.field.shape.distance_gradient(there);
        let in_world = world_from_body.transform_vector(gradient);
        let velocity = world_from_element.transform_vector(self.motion.velocity(p))
            - world_from_body.transform_vector(self.field.motion.velocity(there));
        Slope {
            value,
            gradient: world_from_element.inverse().transform_vector(in_world),
            rate: in_world.dot(velocity),
        }
    }

    /// A bound of how fast the field sees a point of the element move from `time` on [m].
    ///
    /// Both move on screws, on which each point of a body keeps its speed. What turns with the field
    /// past the point is as fast as the field's origin, and its turn times the distance from there,
    /// which grows at most by both their ways.
    fn fastest(&self, p: Point<D>, time: f64) -> f64 {
        let own = self.motion.velocity(p).norm();
        let origin = self.field.motion.velocity(Vector::ZERO).norm();
        let turn = self.field.motion.angle();
        let apart = self.place(p, time) - self.field.motion.pose(time).translation;
        own + origin + turn * (apart.norm() + (own + origin) * (1.0 - time))
    }
}

/// A local search at rest at each of equal steps of time, until one finds a touch.
///
/// ```
/// use palpate_field::{Pose, Screw, Shape, Vector};
/// use palpate_local::{ElementMethod, SampledSweep};
/// use palpate_mesh::Outline;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // A square of 2 m falls by 8 m: 60 steps find a plate of 0.5 m, and pass one of 2 cm.
/// let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(Vector).to_vec();
/// let square = Outline::new(corners, vec![[0, 1], [1, 2], [2, 3], [3, 0]])?;
/// let [from, to] = [4.0, -4.0].map(|y| Pose::translation([0.0, y]));
/// let falls = Screw::new(from, to, 0)?;
/// let sampled = SampledSweep::new(60, 1e-6);
/// let first = |height: f64| -> Result<_, Box<dyn std::error::Error>> {
///     let plate = Shape::<2>::cuboid([0.1, height])?;
///     Ok(sampled.of_mesh(&plate, &square, falls, ElementMethod::GoldenSection)?.touch)
/// };
/// assert!(first(0.5)?.is_some() && first(0.02)?.is_none());
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SampledSweep {
    /// How many steps the motion has; the begin is asked too.
    pub samples: u32,
    /// The largest value of a touch on a mesh, and the largest separation of one between bodies [m].
    pub gap: f64,
    /// Starts of the search between two bodies at each step; 40.
    pub starts: u32,
}

impl SampledSweep {
    /// A search at so many steps for a separation of at most `gap` [m].
    #[must_use]
    pub const fn new(samples: u32, gap: f64) -> Self {
        Self { samples, gap, starts: SumDescent::STARTS }
    }

    /// The same search with another number of starts between two bodies.
    #[must_use]
    pub const fn with_starts(self, starts: u32) -> Self {
        Self { starts, ..self }
    }

    /// The first step at which `method` finds a place on a mesh at which the field is at most the gap.
    /// Elements at the centre of whose smallest ball the field is more than its steepness times the radius
    /// are passed over, as `PhysX` does.
    ///
    /// # Errors
    ///
    /// If there is no step, the gap is not positive, or a pose is not finite.
    pub fn of_mesh<'a, const N: usize, const D: usize>(
        &self,
        field: impl Into<Moving<'a, D>>,
        mesh: &Mesh<N, D>,
        motion: impl Into<Motion<D>>,
        method: ElementMethod,
    ) -> Result<LocalSweep<D>, QueryError> {
        let course = Course::new(field.into(), motion.into())?;
        let shape = course.field.shape;
        let steepness = shape.promise().lipschitz.max(1.0);
        self.first(|time, found| {
            let (world_from_body, world_from_element) =
                (course.field.motion.pose(time), course.motion.pose(time));
            let body_from_element = world_from_body.inverse() * world_from_element;
            for index in 0..mesh.elements().len() {
                let corners =
                    mesh.corners(index).map(|corner| body_from_element.transform_point(corner));
                let element = Element::new(corners)?;
                let ball = element.smallest_ball();
                found.asked(1);
                if shape.distance(ball.centre) > steepness * ball.radius + self.gap {
                    continue;
                }
                found.searched += 1;
                let descent = method.descend(shape, &element);
                found.asked(descent.evaluations);
                let point = world_from_body.transform_point(descent.best);
                let value = descent.value;
                found.keep_lower(LocalTouch { time, point, value, element: index }, self.gap);
            }
            Ok(())
        })
    }

    /// The first step at which `method` finds a point at which both fields are at most half of the gap,
    /// from one of the [`halton_starts`].
    ///
    /// # Errors
    ///
    /// As [`of_mesh`](Self::of_mesh).
    pub fn of_pair<'a, const D: usize>(
        &self,
        a: impl Into<Moving<'a, D>>,
        b: impl Into<Moving<'a, D>>,
        method: PairMethod,
    ) -> Result<LocalSweep<D>, QueryError> {
        let bodies = [a.into(), b.into()];
        self.first(|time, found| {
            let [a, b] = bodies.map(|body| body.at(time));
            for start in halton_starts(a, b, self.starts) {
                let descent = method.descend(a, b, start, 0.1 * self.gap)?;
                found.searched += 1;
                found.asked(descent.evaluations);
                let (point, value) = (descent.best, descent.value);
                found.keep_lower(LocalTouch { time, point, value, element: 0 }, 0.5 * self.gap);
            }
            Ok(())
        })
    }

    /// What `search` finds at the first step at which it finds a touch.
    fn first<const D: usize>(
        &self,
        mut search: impl FnMut(f64, &mut LocalSweep<D>) -> Result<(), QueryError>,
    ) -> Result<LocalSweep<D>, QueryError> {
        for (what, value) in [("samples", f64::from(self.samples)), ("gap", self.gap)] {
            if value.is_nan() || value <= 0.0 {
                return Err(QueryError::Setting { what, value });
            }
        }
        let mut found = LocalSweep::nothing();
        for k in 0..=self.samples {
            search(f64::from(k) / f64::from(self.samples), &mut found)?;
            if found.touch.is_some() {
                break;
            }
        }
        Ok(found)
    }
}

/// The first touch of an element or a mesh that moves and a field that may move too, by golden sections
/// in turns: over the time at a point, over a line across the element at a time.
///
/// From the corner that approaches the surface fastest (their section 4.4), at the time to which the
/// broad phase has marched (4.6). Each round:
///
/// 1. Time: where the field is positive, the least |f| from now to the end if the point approaches, from
///    the begin to now if it recedes (equation 17); where it is not, the touch is not later than now
///    (equation 9), and the least |f| from the begin to now is sought.
/// 2. Space: the least f on the line from the point to the corner that lies farthest against the
///    gradient (equation 15).
///
/// until neither changes. Of a mesh, each element is searched up to the earliest touch that is known.
/// Parts of elements that are longer than [`longest`](Self::longest) are searched one by one (4.5), so
/// that a large triangle has several touches, and fewer valleys to be caught in.
///
/// A touch is a point where the field was seen to be at most the gap, so a touch is never too early: it
/// may be late, and it may be missed. The search for the least |f| may lead to where a point leaves a
/// thin body rather than to where it enters, and ends in the valley where it began.
/// [`sweep_mesh`](palpate_query::sweep_mesh) proves that there is no earlier touch.
///
/// ```
/// use palpate_field::{Pose, Screw, Shape, Vector};
/// use palpate_local::SpaceTimeGoldenSection;
/// use palpate_query::Element;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // It falls by 4 m on a ball, which it meets with its middle at a height of 1 m.
/// let ball = Shape::<3>::ball(1.0)?;
/// let corners = [[0.3, 0.0, 0.0], [-0.2, 0.0, 0.2], [-0.1, 0.0, -0.2]].map(Vector);
/// let [from, to] = [3.0, -1.0].map(|y| Pose::translation([0.0, y, 0.0]));
/// let falls = Screw::new(from, to, 0)?;
/// let method = SpaceTimeGoldenSection::default();
/// let found = method.first_touch(&ball, &Element::new(corners)?, falls, 1e-6)?;
/// let touch = found.touch.ok_or("none was found")?;
/// assert!(touch.time > 0.5 - 1e-6 && touch.time < 0.51);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SpaceTimeGoldenSection {
    /// Rounds at most; 16.
    pub rounds: u32,
    /// Sections of a line, and of the time; 30, which leave a millionth of it.
    pub sections: u32,
    /// The search ends with a round that changes the time by less than this, and the point by less than
    /// this share of the longest way to a corner; 1e-6.
    pub tolerance: f64,
    /// Parts of elements with longer edges are halved [m]; infinite.
    pub longest: f64,
}

impl Default for SpaceTimeGoldenSection {
    fn default() -> Self {
        Self { rounds: 16, sections: 30, tolerance: 1e-6, longest: f64::INFINITY }
    }
}

impl SpaceTimeGoldenSection {
    /// The same method with another number of rounds at most.
    #[must_use]
    pub const fn with_rounds(self, rounds: u32) -> Self {
        Self { rounds, ..self }
    }

    /// The same method with another number of sections of a line.
    #[must_use]
    pub const fn with_sections(self, sections: u32) -> Self {
        Self { sections, ..self }
    }

    /// The same method with another longest edge of parts [m].
    #[must_use]
    pub const fn with_longest(self, longest: f64) -> Self {
        Self { longest, ..self }
    }

    /// The first touch of an element, whose coordinates the motion moves.
    ///
    /// # Errors
    ///
    /// If the gap [m] or the longest edge is not positive, or a pose is not finite.
    pub fn first_touch<'a, const N: usize, const D: usize>(
        &self,
        field: impl Into<Moving<'a, D>>,
        element: &Element<N, D>,
        motion: impl Into<Motion<D>>,
        gap: f64,
    ) -> Result<LocalSweep<D>, QueryError> {
        let mut search = self.search(field.into(), motion.into(), gap)?;
        search.parts(element, 0.0);
        Ok(search.found())
    }

    /// The first touch of a mesh.
    ///
    /// # Errors
    ///
    /// As [`first_touch`](Self::first_touch).
    pub fn first_touch_of_mesh<'a, const N: usize, const D: usize>(
        &self,
        field: impl Into<Moving<'a, D>>,
        mesh: &Mesh<N, D>,
        motion: impl Into<Motion<D>>,
        gap: f64,
    ) -> Result<LocalSweep<D>, QueryError> {
        let mut search = self.search(field.into(), motion.into(), gap)?;
        search.mesh(mesh)?;
        Ok(search.found())
    }

    /// The first touch of each part of each element of a mesh over the whole motion, in the order of the
    /// elements.
    ///
    /// # Errors
    ///
    /// As [`first_touch`](Self::first_touch).
    pub fn touches_of_mesh<'a, const N: usize, const D: usize>(
        &self,
        field: impl Into<Moving<'a, D>>,
        mesh: &Mesh<N, D>,
        motion: impl Into<Motion<D>>,
        gap: f64,
    ) -> Result<Vec<LocalTouch<D>>, QueryError> {
        let mut search = self.search(field.into(), motion.into(), gap)?;
        search.wants_all = true;
        search.mesh(mesh)?;
        Ok(search.touches)
    }

    fn search<'a, const D: usize>(
        &self,
        field: Moving<'a, D>,
        motion: Motion<D>,
        gap: f64,
    ) -> Result<Search<'a, D>, QueryError> {
        for (what, value) in [("gap", gap), ("longest", self.longest)] {
            if value.is_nan() || value <= 0.0 {
                return Err(QueryError::Setting { what, value });
            }
        }
        let course = Course::new(field, motion)?;
        let found = LocalSweep::nothing();
        let touches = Vec::new();
        Ok(Search { method: *self, course, gap, wants_all: false, index: 0, found, touches })
    }
}

/// A search under way.
struct Search<'a, const D: usize> {
    method: SpaceTimeGoldenSection,
    course: Course<'a, D>,
    gap: f64,
    /// Whether later touches of other parts matter.
    wants_all: bool,
    /// Of the element of the mesh.
    index: usize,
    found: LocalSweep<D>,
    touches: Vec<LocalTouch<D>>,
}

impl<const D: usize> Search<'_, D> {
    fn mesh<const N: usize>(&mut self, mesh: &Mesh<N, D>) -> Result<(), QueryError> {
        for index in 0..mesh.elements().len() {
            self.index = index;
            self.parts(&Element::new(mesh.corners(index))?, 0.0);
        }
        Ok(())
    }

    /// What is known after all elements.
    fn found(mut self) -> LocalSweep<D> {
        self.touches.into_iter().for_each(|touch| self.found.keep(touch));
        self.found
    }

    /// Until when touches matter.
    fn end(&self) -> f64 {
        if self.wants_all { 1.0 } else { self.touches.last().map_or(1.0, |touch| touch.time) }
    }

    /// Searches the parts of an element that are not longer than is asked for, from a time on.
    fn parts<const N: usize>(&mut self, part: &Element<N, D>, from: f64) {
        let (near, asked) = approach(&self.course, part, [from, self.end()], self.gap);
        self.found.asked(asked);
        let Some(near) = near else { return };
        if part.longest_edge() > self.method.longest {
            part.halves()
                .into_iter()
                .take(parts_of_one::<N>())
                .for_each(|half| self.parts(&half, near));
            return;
        }
        self.found.searched += 1;
        if let Some(touch) = self.touch(part, near) {
            self.touches.push(touch);
        }
    }

    /// The touch that golden sections find, from a time on.
    fn touch<const N: usize>(
        &mut self,
        part: &Element<N, D>,
        from: f64,
    ) -> Option<LocalTouch<D>> {
        let SpaceTimeGoldenSection { rounds, sections, tolerance, .. } = self.method;
        let (course, gap) = (self.course, self.gap);
        let (mut time, mut end) = (from, self.end());
        let mut p = self.first(part, from);
        let mut touch = None;
        for _ in 0..rounds {
            let before = (p, time);
            let here = course.slope(p, time);
            let [low, high] = if here.value <= 0.0 {
                end = end.min(time);
                [from, time]
            } else if here.rate < 0.0 {
                [time, end]
            } else {
                [from, time]
            };
            let at = |share: f64| low + (high - low) * share;
            let (share, value) =
                least_on_unit(sections, |share| course.value(p, at(share)).abs());
            if value < here.value.abs() {
                time = at(share);
            }
            let mut slope = course.slope(p, time);
            // The least |f| is known up to a section: a Newton step leads into the gap.
            let inward = (slope.value - 0.5 * gap) / -slope.rate;
            if slope.value > gap && slope.rate < 0.0 && time + inward <= end {
                let there = course.slope(p, time + inward);
                self.found.asked(2);
                if there.value <= gap {
                    (time, slope) = (time + inward, there);
                }
            }
            let towards = support(part, p, slope.gradient) - p;
            let (share, value) =
                least_on_unit(sections, |share| course.value(p + towards * share, time));
            self.found.asked(4 + 2 * (sections + 1));
            if value < slope.value {
                p += towards * share;
            }
            let value = value.min(slope.value);
            if value <= gap && touch.is_none_or(|known: LocalTouch<D>| time < known.time) {
                let (point, element) = (course.place(p, time), self.index);
                touch = Some(LocalTouch { time, point, value, element });
            }
            let moved = (p - before.0).norm() <= tolerance * part.farthest(p);
            if moved && (time - before.1).abs() <= tolerance {
                break;
            }
        }
        touch
    }

    /// The corner that approaches the surface fastest.
    fn first<const N: usize>(&mut self, part: &Element<N, D>, time: f64) -> Point<D> {
        self.found.asked(2 * N as u32);
        let mut first = (part.vertices()[0], f64::INFINITY);
        for vertex in part.vertices() {
            let rate = self.course.slope(*vertex, time).rate;
            if rate < first.1 {
                first = (*vertex, rate);
            }
        }
        first.0
    }
}
