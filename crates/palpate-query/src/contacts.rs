// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts of an element: parts that each have a minimum of their own.
//!
//! All contacts of a field on one segment or triangle.
//!
//! An element that crosses two bumps touches twice. The part of it within the gap is
//! divided into [patches](crate::patches), each with a minimum of its own, and each is
//! searched by itself.
//!
//! Parts of an element that each have a minimum of their own.
//!
//! This is the persistence of minima (Edelsbrunner, Letscher and Zomorodian 2002) with bounds
//! in place of values, so that two minima that are told apart are proven to be apart.
//!
//! Water rises over the cells of an element. A cell floods at its lower bound, and joins the
//! flooded cells that it may touch. A path between two pools climbs at least to the lower
//! bound of the cell that joins them. If this bound exceeds the least value found in each
//! pool by more than the tolerance, the shallower pool is a patch; else the pools become one.
//! At the end the deepest pool of each connected part is a patch too.

use palpate_field::{LARGEST_LENGTH, Point, Shape, Vector};

use crate::certified::{Certified, Goal, Limits, Stop};
use crate::contact::{Contact, NormalSource};
use crate::element_search::{Element, ElementCell, ElementSearch, ElementWorkspace, Terms};
use crate::engine::{self, Frontier};
use crate::error::QueryError;
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

/// The largest number of cells divided together: 32 along the edge of a triangle.
pub(crate) const MOST_CELLS: usize = 1024;

/// Room for the rounding of distances between centres of cells, relative to their radii.
const ROUNDINGS: f64 = 1e-9;

/// Memory of a division into patches.
#[derive(Debug)]
pub(crate) struct Patches<const N: usize, const D: usize> {
    pub(crate) cells: Vec<ElementCell<N, D>>,
    /// Of all cells [m].
    pub(crate) radius: f64,
    /// While cells are halved: the next `cells`.
    pub(crate) halves: Vec<ElementCell<N, D>>,
    /// The places of the cells along a direction, by which they are sorted.
    places: Vec<f64>,
    centres: Vec<Point<D>>,
    /// Cells in the order of flooding; at the end the deepest cell of each patch.
    order: Vec<u32>,
    /// What cells are sorted by.
    keys: Vec<f64>,
    is_wet: Vec<bool>,
    /// For each cell, another of the same pool, and another of the same patch (union-find):
    /// both chains end at the deepest.
    water: Vec<u32>,
    patch: Vec<u32>,
}

/// Puts the number of each key into `order`, as [`sort_by_keys`] sorts them.
fn sort_all(order: &mut Vec<u32>, keys: &[f64]) {
    order.clear();
    order.extend(0..keys.len() as u32);
    sort_by_keys(order, keys);
}

/// Sorts numbers by their keys; of equal keys the lower number is first. One function for all
/// elements: a sort is much machine code.
fn sort_by_keys(order: &mut [u32], keys: &[f64]) {
    order.sort_unstable_by(|&a, &b| {
        keys[a as usize].total_cmp(&keys[b as usize]).then(a.cmp(&b))
    });
}

impl<const N: usize, const D: usize> Patches<N, D> {
    pub(crate) fn new() -> Self {
        let room = MOST_CELLS;
        Self {
            cells: Vec::with_capacity(room),
            radius: 0.0,
            halves: Vec::with_capacity(room),
            places: Vec::with_capacity(room),
            centres: Vec::with_capacity(room),
            order: Vec::with_capacity(room),
            keys: Vec::with_capacity(room),
            is_wet: Vec::with_capacity(room),
            water: Vec::with_capacity(room),
            patch: Vec::with_capacity(room),
        }
    }

    /// Divides `cells`, all of one size, into patches, and returns their number. A cell
    /// floods at its `shore`: its lower bound where patches are to be proven apart.
    pub(crate) fn divide(
        &mut self,
        weights: &[f64; N],
        tolerance: f64,
        shore: impl Fn(&ElementCell<N, D>) -> f64,
    ) -> usize {
        self.sort_along_element(weights);
        let Self { cells, order, keys, .. } = self;
        keys.clear();
        keys.extend(cells.iter().map(&shore));
        sort_all(order, keys);
        self.is_wet.clear();
        self.is_wet.resize(self.cells.len(), false);
        for names in [&mut self.water, &mut self.patch] {
            names.clear();
            names.extend(0..self.cells.len() as u32);
        }
        for i in 0..self.order.len() {
            let cell = self.order[i];
            self.flood(cell, shore(&self.cells[cell as usize]) - tolerance);
        }
        let Self { cells, order, keys, patch, .. } = self;
        order.retain(|&i| patch[i as usize] == i);
        keys.clear();
        keys.extend(cells.iter().map(|cell| cell.upper));
        sort_by_keys(order, keys);
        order.len()
    }

    /// Sorts the cells along the longest edge: touching cells are near in this order.
    fn sort_along_element(&mut self, weights: &[f64; N]) {
        let Self { cells, halves, places, centres, order, keys, .. } = self;
        let Some(first) = cells.first() else { return };
        let edge = |i: usize| first.element.vertices[(i + 1) % N] - first.element.vertices[i];
        let longest =
            (1..N).fold(edge(0), |l, i| if edge(i).norm() > l.norm() { edge(i) } else { l });
        let direction = unit(longest);
        let place = |cell: &ElementCell<N, D>| cell.element.at(weights).dot(direction);
        keys.clear();
        keys.extend(cells.iter().map(place));
        sort_all(order, keys);
        halves.clear();
        halves.extend(order.iter().map(|&i| cells[i as usize]));
        std::mem::swap(cells, halves);
        places.clear();
        places.extend(cells.iter().map(place));
        centres.clear();
        centres.extend(cells.iter().map(|cell| cell.element.at(weights)));
    }

    /// Floods a cell, and joins the pools that it connects; the shallower of two becomes part
    /// of the other's patch if its floor is at `least` or above.
    fn flood(&mut self, cell: u32, least: f64) {
        let (centre, place) = (self.centres[cell as usize], self.places[cell as usize]);
        let touching = 2.0 * self.radius * (1.0 + ROUNDINGS);
        let start = self.places.partition_point(|&other| other < place - touching);
        let end = self.places.partition_point(|&other| other <= place + touching);
        self.is_wet[cell as usize] = true;
        for other in start..end {
            let apart = self.centres[other] - centre;
            if !self.is_wet[other] || apart.dot(apart) > touching * touching {
                continue;
            }
            let (a, b) = (root(&mut self.water, cell), root(&mut self.water, other as u32));
            if a == b {
                continue;
            }
            let floor = |i: u32| self.cells[i as usize].upper;
            let (deep, shallow) = if floor(a) <= floor(b) { (a, b) } else { (b, a) };
            // A single cell has its floor above its shore, and never becomes a patch here.
            if floor(shallow) >= least {
                self.patch[shallow as usize] = deep;
            }
            self.water[shallow as usize] = deep;
        }
    }

    /// Writes the cells of a patch into `cells`, and returns the one with the least value
    /// found. Patches are in the order of that value.
    pub(crate) fn copy(
        &mut self,
        patch: usize,
        cells: &mut Vec<ElementCell<N, D>>,
    ) -> ElementCell<N, D> {
        let deepest = self.order[patch];
        cells.clear();
        for (i, cell) in self.cells.iter().enumerate() {
            if root(&mut self.patch, i as u32) == deepest {
                cells.push(*cell);
            }
        }
        self.cells[deepest as usize]
    }
}

/// The end of a chain of names; shortens the chain.
fn root(names: &mut [u32], mut name: u32) -> u32 {
    while names[name as usize] != name {
        let next = names[names[name as usize] as usize];
        names[name as usize] = next;
        name = next;
    }
    name
}
