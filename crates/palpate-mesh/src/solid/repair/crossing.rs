// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Faces that cross or touch each other elsewhere than at common corners, by exact predicates (Shewchuk 1997).

use std::collections::BTreeSet;

use palpate_field::{Aabb, Point, Vector};
use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::mesh::Mesh;
use crate::solid::boxes::Boxes;
use crate::tree::FAN;

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
}

/// The corners of an element in the order of the boxes, with their names.
#[derive(Clone, Copy)]
struct Element<const N: usize, const D: usize> {
    corners: [Point<D>; N],
    names: [u32; N],
}

impl<const D: usize> Crossings<D> {
    /// Of all elements, which are in the order of the boxes. `are_solids` tells whether two of them are of
    /// different pieces, neither a cavity.
    pub(in crate::solid) fn of<const N: usize>(
        vertices: &[Point<D>],
        elements: &[[u32; N]],
        boxes: &Boxes<D>,
        are_solids: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let mut found = Self { only_solids: true, ..Self::default() };
        let mut touching_at = None;
        each_meeting(vertices, elements, boxes, |[i, k], meeting, place| match meeting {
            Meeting::Apart => {}
            Meeting::Touching => {
                found.touching += 1;
                touching_at.get_or_insert(place);
            }
            Meeting::Crossing => {
                found.crossings += 1;
                found.only_solids &= are_solids(i, k);
                found.at.get_or_insert(place);
            }
        });
        found.at = found.at.or(touching_at);
        found
    }
}

/// The faces of a mesh that cross others, or touch them elsewhere than at common corners.
pub(crate) fn crossing_faces<const N: usize, const D: usize>(
    mesh: &Mesh<N, D>,
) -> BTreeSet<usize> {
    let order = mesh.tree().order();
    let ordered: Vec<_> = order.iter().map(|face| mesh.elements()[*face as usize]).collect();
    let corners = |element: &[u32; N]| element.map(|index| mesh.vertices()[index as usize]);
    let boxes = Boxes::new(&ordered.iter().map(corners).collect::<Vec<_>>());
    let mut found = BTreeSet::new();
    each_meeting(mesh.vertices(), &ordered, &boxes, |pair, meeting, _| {
        if meeting != Meeting::Apart {
            found.extend(pair.map(|face| order[face] as usize));
        }
    });
    found
}

/// Calls `visit` with each pair of elements whose boxes share a point, how they meet, and the middle of the first
/// one. Elements are in the order of the boxes.
fn each_meeting<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &[[u32; N]],
    boxes: &Boxes<D>,
    mut visit: impl FnMut([usize; 2], Meeting, Point<D>),
) {
    let of = |i: usize| Element {
        corners: elements[i].map(|index| vertices[index as usize]),
        names: elements[i],
    };
    for i in 0..elements.len() {
        let one = of(i);
        let Some(around) = Aabb::around(one.corners) else { continue };
        boxes.overlapping(&around, |group| {
            for k in (group * FAN).max(i + 1)..elements.len().min((group + 1) * FAN) {
                visit([i, k], one.meeting(&of(k)), one.middle());
            }
        });
    }
}

impl<const N: usize, const D: usize> Element<N, D> {
    fn middle(&self) -> Point<D> {
        self.corners.iter().fold(Vector::ZERO, |sum, corner| sum + *corner * (1.0 / N as f64))
    }

    fn meeting(&self, other: &Self) -> Meeting {
        let [one, two] = [self, other].map(|element| Aabb::around(element.corners));
        let (Some(one), Some(two)) = (one, two) else { return Meeting::Apart };
        if (0..D).any(|k| one.min[k] > two.max[k] || two.min[k] > one.max[k]) {
            return Meeting::Apart;
        }
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
            three(&element.corners).map(|p| side(a, b, c, p))
        };
        let (here, there) = (sides(other, self), sides(self, other));
        let is_beside =
            |sides: [i32; 3]| sides.iter().all(|s| *s > 0) || sides.iter().all(|s| *s < 0);
        if is_beside(here) || is_beside(there) {
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
