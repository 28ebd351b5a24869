// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Golden sections over space and time: Pelletier-Guénette, Mercier-Aubin and Andrews 2025,
//! "Real-Time Triangle-SDF Continuous Collision Detection".

use palpate_field::Point;
use palpate_mesh::Mesh;
use palpate_query::parts_of_one;
use palpate_query::{Element, Motion, Moving, QueryError};

use super::approach::approach;
use super::course::Course;
use super::{LocalSweep, LocalTouch};
use crate::section::least_on_unit;
use crate::support;

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
            let (vertex, _) = support(part, p, slope.gradient);
            let towards = part.vertices()[vertex] - p;
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
