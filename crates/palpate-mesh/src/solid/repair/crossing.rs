// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Faces that cross or touch each other elsewhere than at common corners, by exact predicates (Shewchuk 1997).

use std::collections::{BTreeSet, HashSet};
use std::ops::ControlFlow;

use palpate_field::{Aabb, Point, Vector};
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::super::faces::Boxes;
use super::super::field::across;
use super::rims::Hubs;
use crate::mesh::Mesh;
use crate::tree::{BallTree, FAN};

/// How two faces meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Meeting {
    /// At common corners at most; in one plane, at a border at most.
    Apart,
    /// At points of a border, or in a part of their common plane.
    Touching,
    /// Through each other.
    Crossing,
}

/// The faces that cross or touch.
#[derive(Clone, Debug, Default)]
pub(in crate::solid) struct Crossings<const D: usize> {
    /// How many pairs cross.
    pub(in crate::solid) crossings: usize,
    /// Whether all that cross are of two different pieces, neither a cavity.
    pub(in crate::solid) only_solids: bool,
    /// How many pairs touch.
    pub(in crate::solid) touching: usize,
    /// Where the first pair that crosses is, or if none does, the first that touches [m].
    pub(in crate::solid) at: Option<Point<D>>,
    /// Of each element, whether it crosses or touches another; of all, if the search stopped.
    pub(in crate::solid) is_met: Vec<bool>,
    /// Whether more than [`MOST_PAIRS`] meet, and the search stopped there.
    pub(in crate::solid) are_more: bool,
}

/// After so many pairs that meet, no more are sought: copies of a part that lie in each other meet in as many pairs
/// as the square of their faces.
const MOST_PAIRS: usize = 1_000_000;

/// The corners of an element in the order of the boxes, with their names, and what separates it from most others.
#[derive(Clone, Copy)]
struct Element<const N: usize, const D: usize> {
    corners: [Point<D>; N],
    names: [u32; N],
    around: Aabb<D>,
    /// Along this unit vector the element has next to no extent.
    normal: Vector<f64, D>,
    /// From where to where it is along that.
    span: [f64; 2],
    /// By how much a place of one of its corners along a unit vector may be off.
    room: f64,
}

/// Rounded operations of a place along a unit vector, relative to the largest coordinates: three products, their
/// sum, and the room itself.
const ROUNDINGS: f64 = 8.0 * f64::EPSILON;

/// What is known of pairs of elements before they are compared.
pub(in crate::solid) struct Known<A, S> {
    /// Whether two elements meet at common corners and edges alone.
    pub(in crate::solid) are_apart: A,
    /// Whether two elements are of different pieces, neither a cavity.
    pub(in crate::solid) are_solids: S,
}

impl<const D: usize> Crossings<D> {
    /// Of all elements, which are in the order of the boxes.
    pub(in crate::solid) fn of<const N: usize>(
        vertices: &[Point<D>],
        elements: &[[u32; N]],
        boxes: &Boxes<D>,
        known: &Known<impl Fn(usize, usize) -> bool, impl Fn(usize, usize) -> bool>,
    ) -> Self {
        let mut found =
            Self { only_solids: true, is_met: vec![false; elements.len()], ..Self::default() };
        // The lowest element that crosses another, and that touches one.
        let mut first = [None::<usize>; 2];
        let search = Search { vertices, elements, boxes, are_apart: &known.are_apart };
        let searched = search.each_meeting(|[i, k], meeting| {
            let kind = match meeting {
                Meeting::Apart => return ControlFlow::Continue(()),
                Meeting::Touching => {
                    found.touching += 1;
                    1
                }
                Meeting::Crossing => {
                    found.crossings += 1;
                    0
                }
            };
            found.only_solids &= (known.are_solids)(i, k);
            (found.is_met[i], found.is_met[k]) = (true, true);
            first[kind] = Some(first[kind].map_or(i, |lowest| lowest.min(i)));
            continue_if(found.crossings + found.touching < MOST_PAIRS)
        });
        if searched.is_break() {
            found.are_more = true;
            found.only_solids = false;
            found.is_met.fill(true);
        }
        found.at = first[0].or(first[1]).map(|i| search.element(elements[i]).middle());
        found
    }
}

/// The faces of a mesh that cross others, or touch them elsewhere than at common corners.
pub(crate) fn crossing_faces<const N: usize, const D: usize>(
    mesh: &Mesh<N, D>,
) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    let _ = each_meeting(mesh.vertices(), mesh.elements(), |pair, _| {
        found.extend(pair);
        ControlFlow::Continue(())
    });
    found
}

/// Whether any two segments of the plane meet elsewhere than at common ends.
pub(super) fn meet_in_the_plane(vertices: &[Point<2>], segments: &[[u32; 2]]) -> bool {
    each_meeting(vertices, segments, |_, _| ControlFlow::Break(())).is_break()
}

/// The pairs of pieces that cross, the lower first.
#[derive(Debug, Default)]
pub(super) struct PiecesThatCross(HashSet<[usize; 2]>);

impl PiecesThatCross {
    /// Of each element the number of its piece is known. Of pairs that meet, so many as [`MOST_PAIRS`] are found.
    pub(super) fn of<const N: usize, const D: usize>(
        vertices: &[Point<D>],
        elements: &[[u32; N]],
        of_piece: &[usize],
    ) -> Self {
        let (mut found, mut pairs) = (Self::default(), 0);
        let _ = each_meeting(vertices, elements, |[i, k], meeting| {
            let [a, b] = [of_piece[i], of_piece[k]];
            if meeting == Meeting::Crossing && a != b {
                found.0.insert([a.min(b), a.max(b)]);
            }
            pairs += 1;
            continue_if(pairs < MOST_PAIRS)
        });
        found
    }

    /// Whether two pieces cross.
    pub(super) fn cross(&self, a: usize, b: usize) -> bool {
        self.0.contains(&[a.min(b), a.max(b)])
    }
}

/// Calls `visit` with the pairs of elements that cross or touch, and how, until it breaks.
fn each_meeting<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &[[u32; N]],
    mut visit: impl FnMut([usize; 2], Meeting) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let tree = BallTree::new(vertices, elements);
    let order = tree.order();
    let ordered: Vec<_> = order.iter().map(|i| elements[*i as usize]).collect();
    let corners = |element: &[u32; N]| element.map(|index| vertices[index as usize]);
    let boxes = Boxes::new(&ordered.iter().map(corners).collect::<Vec<_>>());
    let search =
        Search { vertices, elements: &ordered, boxes: &boxes, are_apart: |_, _| false };
    search.each_meeting(|pair, meeting| match meeting {
        Meeting::Apart => ControlFlow::Continue(()),
        _ => visit(pair.map(|i| order[i] as usize), meeting),
    })
}

fn continue_if(is_to_continue: bool) -> ControlFlow<()> {
    if is_to_continue { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
}

/// The elements among which pairs that meet are looked for, in the order of the boxes.
struct Search<'a, const N: usize, const D: usize, A> {
    vertices: &'a [Point<D>],
    elements: &'a [[u32; N]],
    boxes: &'a Boxes<D>,
    /// Whether two elements are known to meet at common corners and edges alone.
    are_apart: A,
}

impl<const N: usize, const D: usize, A: Fn(usize, usize) -> bool> Search<'_, N, D, A> {
    /// Calls `visit` with pairs of elements, the lower first, and how they meet; among them are all that cross or
    /// touch, each once, until it breaks.
    fn each_meeting(
        &self,
        mut visit: impl FnMut([usize; 2], Meeting) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let hubs = Hubs::of(self.vertices.len(), self.elements);
        let all: Vec<_> = self.elements.iter().map(|names| self.element(*names)).collect();
        // Apart from the rest, since most pairs need no more.
        let boxes: Vec<_> = all.iter().map(|element| element.around).collect();
        let mut state = ControlFlow::Continue(());
        for (i, (one, around)) in all.iter().zip(&boxes).enumerate() {
            self.boxes.overlapping(around, |group| {
                for k in (group * FAN).max(i + 1)..all.len().min((group + 1) * FAN) {
                    if state.is_continue()
                        && hubs.common([i, k]).is_none()
                        && share_a_point(around, &boxes[k])
                        && !(self.are_apart)(i, k)
                        && !one.is_separate(&all[k])
                    {
                        state = visit([i, k], one.meeting(&all[k]));
                    }
                }
            });
            state?;
        }
        hubs.each_pair(self.vertices, self.elements, |[i, k]| {
            let may_meet = share_a_point(&boxes[i], &boxes[k]) && !(self.are_apart)(i, k);
            if state.is_continue() && may_meet {
                state = visit([i, k], all[i].meeting(&all[k]));
            }
        });
        state
    }

    fn element(&self, names: [u32; N]) -> Element<N, D> {
        let corners = names.map(|index| self.vertices[index as usize]);
        let around = Aabb::around(corners).unwrap_or(Aabb { min: corners[0], max: corners[0] });
        let normal = across(&corners).normalized().unwrap_or(Vector::ZERO);
        let most = |k: usize| around.min[k].abs().max(around.max[k].abs());
        let room = ROUNDINGS * (0..D).map(most).sum::<f64>();
        Element { corners, names, around, normal, span: span(normal, &corners), room }
    }
}

/// From where to where corners are along a vector, up to rounding.
#[inline]
fn span<const N: usize, const D: usize>(
    along: Vector<f64, D>,
    corners: &[Point<D>; N],
) -> [f64; 2] {
    let places = corners.map(|corner| along.dot(corner));
    places.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| {
        [low.min(*at), high.max(*at)]
    })
}

impl<const N: usize, const D: usize> Element<N, D> {
    fn middle(&self) -> Point<D> {
        self.corners.iter().fold(Vector::ZERO, |sum, corner| sum + *corner * (1.0 / N as f64))
    }

    /// Whether a plane along one of two elements is sure to part them.
    #[inline]
    fn is_separate(&self, other: &Self) -> bool {
        let room = self.room + other.room;
        let is_beside = |element: &Self, of: &Self| {
            let [low, high] = span(of.normal, &element.corners);
            low - of.span[1] > room || of.span[0] - high > room
        };
        is_beside(other, self) || is_beside(self, other)
    }

    fn meeting(&self, other: &Self) -> Meeting {
        if N == 2 { self.meeting_in_the_plane(other) } else { self.meeting_in_space(other) }
    }

    /// Of two segments.
    fn meeting_in_the_plane(&self, other: &Self) -> Meeting {
        let common = self.names.iter().filter(|name| other.names.contains(name)).count();
        let turn = |a: Point<D>, b: Point<D>, p: Point<D>| {
            sign(orient2d(planar(a, [0, 1]), planar(b, [0, 1]), planar(p, [0, 1])))
        };
        let ([a, b], [c, d]) = (ends(&self.corners), ends(&other.corners));
        let (across, along) = ([turn(a, b, c), turn(a, b, d)], [turn(c, d, a), turn(c, d, b)]);
        if across == [0, 0] {
            // On one line: they overlap, or meet at ends alone.
            let far = |p: Point<D>| (p - a).dot(b - a);
            let (low, high) = (far(c).min(far(d)), far(c).max(far(d)));
            let overlap = high.min(far(b)) - low.max(0.0);
            let meets = overlap > 0.0 || common == 0 && overlap == 0.0;
            return if meets { Meeting::Touching } else { Meeting::Apart };
        }
        match (across[0] * across[1], along[0] * along[1]) {
            (-1, -1) => Meeting::Crossing,
            (1, _) | (_, 1) => Meeting::Apart,
            _ if common == 0 => Meeting::Touching,
            _ => Meeting::Apart,
        }
    }

    /// Of two triangles.
    fn meeting_in_space(&self, other: &Self) -> Meeting {
        let common = self.names.iter().filter(|name| other.names.contains(name)).count();
        let sides = |of: &Self, element: &Self| {
            let [a, b, c] = three(&of.corners);
            // A common corner is on the plane.
            let at = |i: usize| {
                let is_common = of.names.contains(&element.names[i]);
                if is_common { 0 } else { side(a, b, c, element.corners[i]) }
            };
            [0, 1, 2].map(at)
        };
        // Strictly on one side, but for a common corner.
        let is_beside = |sides: [i32; 3]| {
            let [least, most] = [sides.iter().min(), sides.iter().max()];
            let away = sides.iter().filter(|side| **side != 0).count();
            away + common.min(1) >= 3 && (least >= Some(&0) || most <= Some(&0))
        };
        let here = sides(other, self);
        if is_beside(here) {
            return Meeting::Apart;
        }
        let there = sides(self, other);
        if is_beside(there) {
            return Meeting::Apart;
        }
        if here == [0; 3] || there == [0; 3] {
            return if self.overlaps_in_its_plane(other) {
                Meeting::Touching
            } else {
                Meeting::Apart
            };
        }
        if common >= 2 {
            // Triangles of two planes that share an edge meet there alone.
            return Meeting::Apart;
        }
        let mut meeting = Meeting::Apart;
        for (element, of, sides) in [(self, other, here), (other, self, there)] {
            for i in 0..N {
                let k = (i + 1) % N;
                let is_shared = [i, k].iter().any(|i| of.names.contains(&element.names[*i]));
                if common > 0 && is_shared {
                    continue;
                }
                let edge = [element.corners[i], element.corners[k]];
                meeting = meeting.max(of.crossed_by(edge, [sides[i], sides[k]]));
            }
        }
        meeting
    }

    /// How an edge meets a triangle, of whose plane its ends are at these sides.
    fn crossed_by(&self, [from, to]: [Point<D>; 2], sides: [i32; 2]) -> Meeting {
        if sides[0] * sides[1] > 0 || sides == [0, 0] {
            return Meeting::Apart;
        }
        let [a, b, c] = three(&self.corners);
        let turns = [side(from, to, a, b), side(from, to, b, c), side(from, to, c, a)];
        let has = |sign: i32| turns.contains(&sign);
        match () {
            () if has(1) && has(-1) => Meeting::Apart,
            () if !has(0) && sides[0] * sides[1] < 0 => Meeting::Crossing,
            () => Meeting::Touching,
        }
    }

    /// Whether two triangles of one plane share more than a border: no edge of either has the other on its
    /// outer side.
    fn overlaps_in_its_plane(&self, other: &Self) -> bool {
        let [a, b, c] = three(&self.corners);
        let normal = (b - a).in_space().cross((c - a).in_space());
        let axis = (1..3).fold(0, |k, i| if normal[i].abs() > normal[k].abs() { i } else { k });
        let axes = [(axis + 1) % 3, (axis + 2) % 3];
        let flat = |element: &Self| three(&element.corners).map(|p| planar(p, axes));
        let separates = |[a, b, c]: [Coord<f64>; 3], others: [Coord<f64>; 3]| {
            let whole = sign(orient2d(a, b, c));
            [(a, b), (b, c), (c, a)].iter().any(|(from, to)| {
                others.iter().all(|p| sign(orient2d(*from, *to, *p)) * whole <= 0)
            })
        };
        let (one, two) = (flat(self), flat(other));
        !separates(one, two) && !separates(two, one)
    }
}

/// Whether two boxes share a point.
#[inline]
fn share_a_point<const D: usize>(one: &Aabb<D>, two: &Aabb<D>) -> bool {
    (0..D).all(|k| one.min[k] <= two.max[k] && two.min[k] <= one.max[k])
}

fn ends<const N: usize, const D: usize>(corners: &[Point<D>; N]) -> [Point<D>; 2] {
    [corners[0], corners[1]]
}

fn three<const N: usize, const D: usize>(corners: &[Point<D>; N]) -> [Point<D>; 3] {
    std::array::from_fn(|i| corners[i.min(N - 1)])
}

fn planar<const D: usize>(p: Point<D>, [x, y]: [usize; 2]) -> Coord<f64> {
    Coord { x: p[x], y: p[y] }
}

/// On which side of the plane of three points a point is: 1, −1, or 0 on it.
fn side<const D: usize>(a: Point<D>, b: Point<D>, c: Point<D>, p: Point<D>) -> i32 {
    let coordinates = |p: Point<D>| {
        let Vector([x, y, z]) = p.in_space();
        Coord3D { x, y, z }
    };
    sign(orient3d(coordinates(a), coordinates(b), coordinates(c), coordinates(p)))
}

fn sign(x: f64) -> i32 {
    i32::from(x > 0.0) - i32::from(x < 0.0)
}
