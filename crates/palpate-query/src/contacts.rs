// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! All contacts of a field on one segment or triangle.
//!
//! An element that crosses two bumps touches twice. The part of it within the gap is
//! divided into [patches](crate::patches), each with a minimum of its own, and each is
//! searched by itself.

use palpate_field::{LARGEST_LENGTH, Point, Shape, Vector};

use crate::certified::{Certified, Limits, Stop};
use crate::contact::{Contact, NormalSource};
use crate::element::Element;
use crate::element_search::{ElementCell, ElementSearch, ElementWorkspace, Terms};
use crate::engine::{self, Frontier};
use crate::error::QueryError;
use crate::goal::Goal;
use crate::patches::{MOST_CELLS, Patches};
use crate::sampler::{AT_ONCE, arbitrary, normal as direction, unit};

/// Heights over and under the centre of an element, in radii, from which [`is_plain`] proves
/// that the element has one minimum: half a block each.
///
/// [`is_plain`]: ElementSearch::is_plain
const HEIGHTS: [f64; AT_ONCE / 2] = [1.5, 4.0, 12.0, 40.0];

/// An element that is not plain is divided into at least this many cells: 8 along the edge of
/// a triangle. Narrower bumps may hide between the centres of cells.
const FEW_CELLS: usize = 64;

/// From this distance on, as a share of the coordinates, the vector to the surface gives the
/// normal.
const DIRECTION: f64 = 1e-9;

/// All contacts of one element.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ElementContacts<const D: usize> {
    /// The contacts, the deepest first, in the shape's coordinates.
    pub contacts: Vec<Contact<D>>,
    /// The field's least value on the element. If the element comes within the gap, it is
    /// what [`minimum`](crate::minimum) finds; if `lower` exceeds the gap, the element is
    /// proven to stay out of it, and the search stopped there.
    pub least: Certified<Point<D>>,
}

impl<const D: usize> ElementContacts<D> {
    /// Room for `count` contacts of an element of which nothing is known.
    pub(crate) fn with_capacity(count: usize) -> Self {
        let least = Certified {
            best: Vector::ZERO,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            stop: Stop::BudgetSpent,
            evaluations: 0,
        };
        Self { contacts: Vec::with_capacity(count), least }
    }
}

/// All contacts of a shape on an element, up to a gap [m], in the shape's coordinates.
///
/// The element comes within `gap` where the field is at most that, times its steepness if
/// that is more than one. There is a contact for each patch of it:
///
/// - **The deepest** contact comes first, at the least value of the field on the element, to
///   `limits.tolerance`.
/// - **Others** are deepest in their patches, to the tolerance. Between any two contacts
///   lies a barrier: every path on the element from one to the other passes a point where
///   the field is larger than at both, by more than the tolerance. That is proven.
/// - **Nothing is missed**, unless the search stopped [early](Stop::is_early): every point
///   within the gap belongs to the basin of a contact that is at least as deep, up to the
///   tolerance. Basins that no bound proves apart count as one.
///
/// Not promised: two minima closer to each other than an eighth of a triangle's edge,
/// or a sixty-fourth of a segment, may share a contact, at the deeper one. So may any two
/// between which no barrier can be proven with a thirty-second of the edge, or with
/// `limits.budget`.
///
/// A contact's normal points from the shape to the element. Its gap is the way to the
/// surface point that Newton's method finds, the nearest one where the field is exact. It
/// may exceed `gap` by the tolerance, and more where the field is a bound.
///
/// # Errors
///
/// If `gap` or the tolerance is negative, NaN or too large.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_query::{Element, Limits, ElementWorkspace, contacts};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let bump = |x: f64| Shape::from_kernel(Ball::new(1.0)?).translated(Vector([x, 0.0]));
/// let bumps = Shape::union([bump(-2.0)?, bump(2.0)?])?;
/// let segment = Element::new([Vector([-3.0, 0.8]), Vector([3.0, 0.9])])?;
/// let mut workspace = ElementWorkspace::new();
/// let touching = contacts(&bumps, &segment, 0.0, &Limits::new(1e-4), &mut workspace)?;
/// let [left, right] = touching.contacts.as_slice() else { panic!("two contacts") };
/// assert!(left.point_b[0] < 0.0 && right.point_b[0] > 0.0 && left.gap < right.gap);
/// # Ok(())
/// # }
/// ```
pub fn contacts<'w, const N: usize, const D: usize>(
    shape: &Shape<D>,
    element: &Element<N, D>,
    gap: f64,
    limits: &Limits,
    workspace: &'w mut ElementWorkspace<N, D>,
) -> Result<&'w ElementContacts<D>, QueryError> {
    limits.check()?;
    let terms = Terms {
        goal: Goal::least(limits.tolerance),
        budget: limits.budget,
        level: level(shape, gap)?,
        reach: 0.0,
    };
    find(shape, element, &terms, workspace);
    Ok(&workspace.found)
}

/// The value of the field that stands for a gap [m].
pub(crate) fn level<const D: usize>(shape: &Shape<D>, gap: f64) -> Result<f64, QueryError> {
    if !(0.0..=LARGEST_LENGTH).contains(&gap) {
        return Err(QueryError::Length { value: gap });
    }
    Ok(gap * shape.promise().lipschitz.max(1.0))
}

/// Finds the contacts on an element, and writes them into the workspace.
#[inline(never)]
pub(crate) fn find<const N: usize, const D: usize>(
    shape: &Shape<D>,
    element: &Element<N, D>,
    terms: &Terms,
    workspace: &mut ElementWorkspace<N, D>,
) {
    let ElementWorkspace { frontier, samples, patches, found } = workspace;
    let ElementContacts { contacts, least } = found;
    contacts.clear();
    let tolerance = terms.goal.tolerance;
    let mut search = ElementSearch::new(shape, element, terms, samples);
    let answer = search.patches(element, patches, frontier, |answer| {
        if answer.lower <= 0.0 && answer.upper <= tolerance.max(0.0) {
            contacts.push(at(shape, answer.best));
        }
    });
    contacts.sort_unstable_by(|a, b| a.gap.total_cmp(&b.gap));
    for (id, contact) in contacts.iter_mut().enumerate() {
        contact.id = id as u64;
    }
    let (lower, upper) = (answer.lower + terms.level, answer.upper + terms.level);
    *least = Certified { lower, upper, ..answer };
}

impl<const N: usize, const D: usize> ElementSearch<'_, N, D> {
    /// Hands the answer of each patch to `tell`, and returns the answer for the element.
    fn patches(
        &mut self,
        element: &Element<N, D>,
        patches: &mut Patches<N, D>,
        frontier: &mut Frontier<Vec<ElementCell<N, D>>>,
        mut tell: impl FnMut(&Certified<Point<D>>),
    ) -> Certified<Point<D>> {
        let tolerance = self.goal.tolerance;
        let whole = match self.begin(element) {
            Err(answer) => {
                tell(&answer);
                return answer;
            }
            Ok(whole) if whole.lower > 0.0 => return self.answer(whole.lower, Stop::SignKnown),
            Ok(whole) => whole,
        };
        patches.cells.clear();
        patches.cells.push(whole);
        patches.radius = self.radius;
        if !self.sampler.is_convex() && !self.is_plain(&whole, tolerance) {
            self.keeps_all = true;
            self.refine(tolerance, patches, &mut frontier.round);
            self.keeps_all = false;
        }
        if patches.cells.is_empty() {
            let is_known = self.dropped > 0.0;
            let stop = if is_known { Stop::SignKnown } else { Stop::RoundingReached };
            return self.answer(self.dropped, stop);
        }
        let is_whole = patches.cells.len() == 1 && patches.cells[0].level == 0;
        let mut all = self.answer(self.dropped, Stop::Converged);
        for patch in 0..patches.divide(&self.weights, tolerance, |cell| cell.lower) {
            let deepest = patches.copy(patch, &mut frontier.queue);
            self.dropped = f64::INFINITY;
            if !is_whole {
                // The least value of a patch was found at the centre of its deepest cell.
                (self.upper, self.best) = (deepest.upper, deepest.element.at(&self.weights));
            }
            let answer = self.finish(frontier);
            tell(&answer);
            if answer.upper < all.upper {
                (all.upper, all.best) = (answer.upper, answer.best);
            }
            all.lower = all.lower.min(answer.lower);
            if answer.stop.is_early() {
                all.stop = answer.stop;
            }
        }
        Certified { evaluations: self.sampler.evaluations, ..all }
    }

    /// Halves all cells until the bounds prove as many patches as the values suggest, or there
    /// are [`MOST_CELLS`].
    fn refine(
        &mut self,
        tolerance: f64,
        patches: &mut Patches<N, D>,
        round: &mut Vec<ElementCell<N, D>>,
    ) {
        let parts = self.parts;
        let mut cells_of_whole = 1;
        while !patches.cells.is_empty()
            && patches.cells.len() * parts <= MOST_CELLS
            && patches.radius * self.sampler.steepness.lipschitz > tolerance
            && self.sampler.evaluations < self.budget
        {
            let Patches { cells, halves, .. } = &mut *patches;
            halves.clear();
            for parents in cells.chunks(AT_ONCE / parts) {
                round.clear();
                for parent in parents {
                    parent.halve_into(parts, round);
                }
                self.bound_parts(round);
                engine::keep(self, round, halves);
            }
            std::mem::swap(cells, halves);
            patches.radius *= 0.5;
            cells_of_whole *= parts;
            if cells_of_whole >= FEW_CELLS {
                let seen = patches.divide(&self.weights, tolerance, |cell| cell.upper);
                let proven = patches.divide(&self.weights, tolerance, |cell| cell.lower);
                if proven >= seen {
                    return;
                }
            }
        }
    }

    /// `true` if no barrier on a cell is higher than the tolerance.
    ///
    /// The field lies between `f(p) − L‖x − p‖` and `f(q) + L‖x − q‖`, of points over and
    /// under the centre. The second is convex: from any point to a lower one a straight
    /// path on the cell does not climb. So where both differ by at most the tolerance, it
    /// climbs by no more in the field. Their difference is convex, and largest at a vertex.
    fn is_plain(&mut self, cell: &ElementCell<N, D>, tolerance: f64) -> bool {
        let centre = cell.element.at(&self.weights);
        let mut points = [centre; AT_ONCE];
        for (k, height) in HEIGHTS.iter().enumerate() {
            let offset = cell.direction * (height * self.radius_of(cell));
            (points[2 * k], points[2 * k + 1]) = (centre + offset, centre - offset);
        }
        let values = self.sampler.values(&points);
        let steepness = &self.sampler.steepness;
        (0..HEIGHTS.len()).any(|k| {
            let change = |i: usize, vertex: Point<D>| {
                steepness.change(|| points[i], (vertex - points[i]).norm())
            };
            cell.element.vertices.iter().all(|&vertex| {
                let changes = change(2 * k, vertex) + change(2 * k + 1, vertex);
                values[2 * k + 1] - values[2 * k] + changes <= tolerance
            })
        })
    }
}

/// The contact of a shape with a point `p` of an element; the caller gives the id.
#[inline(never)]
pub(crate) fn at<const D: usize>(shape: &Shape<D>, p: Point<D>) -> Contact<D> {
    let (value, gradient) = shape.distance_gradient(p);
    let sign = if value < 0.0 { -1.0 } else { 1.0 };
    let surface = shape
        .surface_point(p)
        .unwrap_or_else(|| p - unit(gradient) * (value / shape.promise().lipschitz.max(1.0)));
    let apart = (p - surface) * sign;
    let length = apart.norm();
    let normal = if length > DIRECTION * p.norm() {
        Some(apart * (1.0 / length))
    } else {
        // On the surface, or where the field has no direction.
        let there = direction(shape.distance_gradient(surface).1);
        there.or(direction(gradient))
    };
    match normal {
        Some(normal) => Contact::new(surface, p, normal),
        None => Contact::new(surface, p, arbitrary()).with_normal_from(NormalSource::Assumed),
    }
}
