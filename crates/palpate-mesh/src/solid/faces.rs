// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Faces of a solid, their boxes and normals.
//!
//! Boxes around groups of eight elements, around eight of those groups, and so on.
//!
//! The groups are those of [`BallTree`](crate::tree::BallTree): runs of elements in its order.

use palpate_field::{Aabb, Point, Vector, Wide, wide};

use super::field::{Foot, Part, across, foot};
use super::repair::{by_rim, sides};
use crate::tree::FAN;

/// The rounding of a distance in single precision, as a share of the distance of the point from the group's middle plus
/// the group's radius: a product of unit vectors, coordinates that were rounded, and sums of a dozen terms.
const ROUNDING: f32 = 64.0 * f32::EPSILON;

/// The least rounding of a distance, in units of the size of all faces: below it squares have no digits.
const LEAST: f32 = 1e-18;

/// The bits of a number that tell which of eight faces it is of.
const NUMBER: u32 = FAN as u32 - 1;

/// One number of each of eight faces.
type Lanes = [f32; FAN];

/// The faces of a solid, in the order of its boxes.
#[derive(Clone, Debug)]
pub(super) struct Faces<const N: usize, const D: usize> {
    corners: Vec<[Point<D>; N]>,
    groups: Vec<Group<N, D>>,
    /// One over the size of all faces, about.
    scale: f64,
}

/// Eight faces, in single precision, from the middle of their box and in units of the size of all.
///
/// A face lies in a plane of two axes at its first corner: one along its first edge, the other towards the third corner.
/// Of a segment there is the first axis alone.
#[derive(Clone, Debug)]
struct Group<const N: usize, const D: usize> {
    middle: Point<D>,
    /// How far corners are from the middle, at most.
    radius: f32,
    first: [Lanes; D],
    axes: [[Lanes; D]; 2],
    /// The length of the first edge.
    length: Lanes,
    /// The edges from the second corner to the third, and from the first to it, in the plane of the axes: their
    /// directions and lengths.
    edges: [Edge; 2],
}

#[derive(Clone, Copy, Debug)]
struct Edge {
    direction: [Lanes; 2],
    length: Lanes,
}

impl<const N: usize, const D: usize> Faces<N, D> {
    /// Of faces in the order of the tree.
    pub(super) fn new(faces: &[[Point<D>; N]]) -> Self {
        const { assert!(N == 2 || N == 3, "segments and triangles") };
        let far = faces
            .iter()
            .flatten()
            .fold(0.0_f64, |far, corner| far.max((*corner - faces[0][0]).norm()));
        // A power of two, by which nothing is rounded.
        let scale = if far > 0.0 { 2.0_f64.powi(-(far.log2().ceil() as i32)) } else { 1.0 };
        let groups = faces.chunks(FAN).map(|faces| Group::of(faces, scale)).collect();
        Self { corners: faces.to_vec(), groups, scale }
    }

    pub(super) fn len(&self) -> usize {
        self.corners.len()
    }

    /// The size of all faces, about [m]: no edge is longer than twice this.
    #[inline(always)]
    pub(super) fn size(&self) -> f64 {
        1.0 / self.scale
    }

    /// The corners of a face.
    #[inline(always)]
    pub(super) fn corners(&self, face: usize) -> &[Point<D>; N] {
        &self.corners[face]
    }

    /// Takes the nearest point of each face of a group that may be nearer to a point than the nearest so far, if it is.
    #[inline(always)]
    pub(super) fn nearer(&self, group: usize, p: Point<D>, nearest: &mut (usize, Foot<D>)) {
        let Squared { squared, rounding } = self.groups[group].squared(p, self.scale);
        let (first, last) = (group * FAN, self.corners.len() - 1);
        // The likeliest first, so that others need not be looked at; its number in the last bits.
        let mut key = f32::MAX.to_bits();
        for (lane, squared) in squared.iter().enumerate() {
            let other = squared.to_bits() & !NUMBER | lane as u32;
            key = if other < key { other } else { key };
        }
        let mut lane = (key & NUMBER) as usize;
        let mut left = u32::MAX;
        loop {
            let farthest = {
                let far = ((nearest.1.squared * self.scale * self.scale) as f32).sqrt();
                let within = far * (1.0 + 4.0 * f32::EPSILON) + rounding;
                within * within
            };
            let mut near = 0;
            for (lane, squared) in squared.iter().enumerate() {
                near |= u32::from(*squared <= farthest) << lane;
            }
            left &= near;
            if left == 0 {
                return;
            }
            if (left >> lane) & 1 == 0 {
                lane = left.trailing_zeros() as usize;
            }
            left &= !(1 << lane);
            let face = last.min(first + lane);
            let found = foot(&self.corners[face], p);
            if found.squared < nearest.1.squared {
                *nearest = (face, found);
            }
        }
    }

    /// Calls `visit` with the corners of each face of a group that is at most so far from a point [m], with its nearest
    /// point and its distance.
    #[inline]
    pub(super) fn within(
        &self,
        group: usize,
        p: Point<D>,
        farthest: f64,
        mut visit: impl FnMut(&[Point<D>; N], &Foot<D>, f64),
    ) {
        for (face, _) in self.near(group, p, [farthest; 2]) {
            let corners = &self.corners[face];
            let found = foot(corners, p);
            let far = found.squared.sqrt();
            if far <= farthest {
                visit(corners, &found, far);
            }
        }
    }

    /// The faces of a group at most so far from a point [m], and for each whether it is within a second distance too;
    /// some may be a little farther.
    #[inline]
    pub(super) fn near(
        &self,
        group: usize,
        p: Point<D>,
        distances: [f64; 2],
    ) -> impl Iterator<Item = (usize, bool)> {
        let Squared { squared, rounding } =
            wide(FromGroup { group: &self.groups[group], p, scale: self.scale });
        let farthest = distances.map(|distance| {
            let within = (distance * self.scale) as f32 * (1.0 + f32::EPSILON) + rounding;
            within * within
        });
        let faces = self.faces(group).zip(squared);
        faces
            .filter(move |(_, squared)| *squared <= farthest[0])
            .map(move |(face, squared)| (face, squared <= farthest[1]))
    }

    /// The numbers of the faces of a group.
    #[inline]
    fn faces(&self, group: usize) -> std::ops::Range<usize> {
        group * FAN..self.corners.len().min(group * FAN + FAN)
    }
}

/// The squares of the distances from a point to the faces of a group, and what rounding may add to a distance.
struct Squared {
    squared: Lanes,
    rounding: f32,
}

/// The distances to a group, with wide instructions.
struct FromGroup<'a, const N: usize, const D: usize> {
    group: &'a Group<N, D>,
    p: Point<D>,
    scale: f64,
}

impl<const N: usize, const D: usize> Wide for FromGroup<'_, N, D> {
    type Out = Squared;

    #[inline(always)]
    fn run(self) -> Squared {
        self.group.squared(self.p, self.scale)
    }
}

impl<const N: usize, const D: usize> Group<N, D> {
    fn of(faces: &[[Point<D>; N]], scale: f64) -> Self {
        let (mut min, mut max) = (faces[0][0], faces[0][0]);
        for corner in faces.iter().flatten() {
            for i in 0..D {
                (min[i], max[i]) = (min[i].min(corner[i]), max[i].max(corner[i]));
            }
        }
        let middle = min + (max - min) * 0.5;
        let none = Edge { direction: [[0.0; FAN]; 2], length: [0.0; FAN] };
        let mut group = Self {
            middle,
            radius: ((max - min).norm() * scale) as f32,
            first: [[0.0; FAN]; D],
            axes: [[[0.0; FAN]; D]; 2],
            length: [0.0; FAN],
            edges: [none; 2],
        };
        for lane in 0..FAN {
            // The last group is completed by its last face, which changes nothing.
            let face = &faces[lane.min(faces.len() - 1)];
            group.set(lane, &face.map(|corner| (corner - middle) * scale));
        }
        group
    }

    /// Sets a face.
    fn set(&mut self, lane: usize, face: &[Point<D>; N]) {
        let (along, length) = direction(face[1] - face[0]);
        let to_third = face[N - 1] - face[0];
        let side = if N == 2 { Vector::ZERO } else { square(along, to_third) };
        let third = [to_third.dot(along), to_third.dot(side)];
        for i in 0..D {
            self.first[i][lane] = face[0][i] as f32;
            self.axes[0][i][lane] = along[i] as f32;
            self.axes[1][i][lane] = side[i] as f32;
        }
        self.length[lane] = length as f32;
        for (edge, from) in self.edges.iter_mut().zip([length, 0.0]) {
            let (direction, length) = direction(Vector([third[0] - from, third[1]]));
            for i in 0..2 {
                edge.direction[i][lane] = direction[i] as f32;
            }
            edge.length[lane] = length as f32;
        }
    }

    /// The squares of the distances from a point to the faces, never larger by more than the rounding.
    #[inline(always)]
    fn squared(&self, p: Point<D>, scale: f64) -> Squared {
        let q = (p - self.middle) * scale;
        let rounding = ROUNDING * (q.norm() as f32 + self.radius) + LEAST;
        let mut at = [0.0_f32; D];
        for i in 0..D {
            at[i] = q[i] as f32;
        }
        let mut squared = [0.0; FAN];
        // A loop without branches over numbers side by side: LLVM treats several lanes at once.
        for (lane, squared) in squared.iter_mut().enumerate() {
            let mut away = at;
            let [mut u, mut v] = [0.0_f32; 2];
            for (i, away) in away.iter_mut().enumerate() {
                *away -= self.first[i][lane];
                u += *away * self.axes[0][i][lane];
                v += *away * self.axes[1][i][lane];
            }
            // Off the plane of the axes, and in it.
            let mut off = 0.0_f32;
            for (i, away) in away.iter().enumerate() {
                let left = away - u * self.axes[0][i][lane] - v * self.axes[1][i][lane];
                off += left * left;
            }
            let first = u - clamped(u, self.length[lane]);
            let mut least = first * first + v * v;
            if N == 3 {
                let (mut is_outside, mut side) = (v < 0.0, 1.0);
                for (edge, from) in self.edges.iter().zip([self.length[lane], 0.0]) {
                    let (x, y, w) =
                        (edge.direction[0][lane], edge.direction[1][lane], u - from);
                    let along = clamped(w * x + v * y, edge.length[lane]);
                    let (dx, dy) = (w - along * x, v - along * y);
                    let other = dx * dx + dy * dy;
                    least = if other < least { other } else { least };
                    is_outside |= side * (x * v - y * w) < 0.0;
                    side = -1.0;
                }
                least = if is_outside { least } else { 0.0 };
            }
            let sum = off + least;
            // Where squares overflow, the foot tells.
            *squared = if sum < f32::MAX { sum } else { 0.0 };
        }
        Squared { squared, rounding }
    }
}

/// A number moved to between zero and the largest.
#[inline(always)]
fn clamped(x: f32, largest: f32) -> f32 {
    let x = if x > 0.0 { x } else { 0.0 };
    if x < largest { x } else { largest }
}

/// The direction square to a unit vector, towards another vector if that has another direction.
fn square<const D: usize>(along: Vector<f64, D>, towards: Vector<f64, D>) -> Vector<f64, D> {
    let off = |v: Vector<f64, D>| v - along * v.dot(along);
    let units = (0..D).map(Vector::unit);
    for towards in std::iter::once(towards).chain(units) {
        let aside = off(direction(towards).0);
        // Less is rounding.
        if aside.norm() > 1e-12 {
            // Once more, for what the length has blown up.
            return direction(off(direction(aside).0)).0;
        }
    }
    Vector::ZERO
}

/// A vector's direction and length; of none, any direction.
fn direction<const D: usize>(v: Vector<f64, D>) -> (Vector<f64, D>, f64) {
    v.normalized().map_or((Vector::unit(0), 0.0), |direction| (direction, v.norm()))
}

/// The normals of a mesh, out of the solid.
#[derive(Clone, Debug)]
pub(super) struct Normals<const N: usize, const D: usize> {
    /// Of each face: of its own, of its edges, and the numbers of its corners.
    faces: Vec<FaceNormals<N, D>>,
    /// Of each vertex: the sum of the normals of its faces, each times the angle that it has there.
    corners: Vec<Vector<f64, D>>,
}

#[derive(Clone, Copy, Debug)]
struct FaceNormals<const N: usize, const D: usize> {
    face: Vector<f64, D>,
    /// A bound of the error of the face's own; 2 if it has no area, and no direction is known.
    error: f64,
    edges: [Vector<f64, D>; N],
    corners: [u32; N],
}

impl<const N: usize, const D: usize> Normals<N, D> {
    pub(super) fn new(vertices: usize, elements: &[[u32; N]], faces: &[[Point<D>; N]]) -> Self {
        let own: Vec<_> = faces
            .iter()
            .map(|corners| across(corners).normalized().unwrap_or(Vector::ZERO))
            .collect();
        let errors = faces.iter().map(error);
        let mut normals = Self {
            faces: elements
                .iter()
                .zip(&own)
                .zip(errors)
                .map(|((element, face), error)| FaceNormals {
                    face: *face,
                    error,
                    edges: [*face; N],
                    corners: *element,
                })
                .collect(),
            corners: vec![Vector::ZERO; vertices],
        };
        for ((element, corners), normal) in elements.iter().zip(faces).zip(&own) {
            for (i, vertex) in element.iter().enumerate() {
                normals.corners[*vertex as usize] += *normal * angle(corners, i);
            }
        }
        for corner in &mut normals.corners {
            *corner = corner.normalized().unwrap_or(Vector::ZERO);
        }
        if N == 3 {
            for at_rim in by_rim(&sides(elements)) {
                let sum = at_rim
                    .iter()
                    .fold(Vector::ZERO, |sum, side| sum + own[side.element as usize]);
                let edge = sum.normalized().unwrap_or(Vector::ZERO);
                for side in at_rim {
                    normals.faces[side.element as usize].edges[side.number as usize] = edge;
                }
            }
        }
        normals
    }

    /// The normal of a face, and a bound of its error.
    #[inline]
    pub(super) fn of_face(&self, face: usize) -> (Vector<f64, D>, f64) {
        let FaceNormals { face, error, .. } = &self.faces[face];
        (*face, *error)
    }

    /// The normal at a part of a face.
    pub(super) fn at(&self, face: usize, part: Part) -> Vector<f64, D> {
        let normals = &self.faces[face];
        match part {
            Part::Face => normals.face,
            Part::Edge(i) => normals.edges[i],
            Part::Corner(i) => self.corners[normals.corners[i] as usize],
        }
    }
}

/// A bound of the error of a unit normal.
fn error<const N: usize, const D: usize>(corners: &[Point<D>; N]) -> f64 {
    let longest = corners.iter().fold(0.0_f64, |longest, corner| {
        longest.max((*corner - corners[0]).norm()).max((*corner - corners[N - 1]).norm())
    });
    // Each component of a product of two sides is rounded thrice; the product of one side is exact.
    let error = 16.0 * f64::EPSILON * longest.powi(N as i32 - 1) / across(corners).norm();
    if error < 1.0 { error } else { 2.0 }
}

/// The angle of a triangle at a corner [rad]; 1 at the end of a segment.
fn angle<const N: usize, const D: usize>(corners: &[Point<D>; N], i: usize) -> f64 {
    if N == 2 {
        return 1.0;
    }
    let [to, from] = [1, 2].map(|step| corners[(i + step) % N] - corners[i]);
    to.in_space().cross(from.in_space()).norm().atan2(to.dot(from))
}

/// The most levels: eight boxes around eight each, up to `u32::MAX` elements.
const MOST_LEVELS: usize = 11;

/// The bits of a key that tell the number of its box.
const BOX_NUMBER: u64 = FAN as u64 - 1;

/// The key of a box that was visited, or of padding: `f64::MAX` without the bits of the number. All others are less.
const DONE: f64 = f64::from_bits(f64::MAX.to_bits() & !BOX_NUMBER);

/// The boxes of one level, padded to whole groups of eight.
#[derive(Clone, Debug)]
struct Level<const D: usize> {
    min: [Vec<f64>; D],
    max: [Vec<f64>; D],
}

/// Boxes on the implicit order of the elements of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct Boxes<const D: usize> {
    /// The first level has boxes around eight elements each, the last at most eight boxes.
    levels: Vec<Level<D>>,
}

impl<const D: usize> Boxes<D> {
    /// The boxes around elements, which are in the order of the tree.
    pub(crate) fn new<const N: usize>(elements: &[[Point<D>; N]]) -> Self {
        let around = |group: &[[Point<D>; N]]| Aabb::around(group.iter().flatten().copied());
        let mut boxes: Vec<_> = elements.chunks(FAN).filter_map(around).collect();
        let mut levels = vec![Level::new(&boxes)];
        while boxes.len() > FAN {
            let union = |group: &[Aabb<D>]| group.iter().copied().reduce(|a, b| a.union(&b));
            boxes = boxes.chunks(FAN).filter_map(union).collect();
            levels.push(Level::new(&boxes));
        }
        Self { levels }
    }

    /// The groups of eight elements as seen from a point.
    #[inline(always)]
    pub(crate) fn from(&self, p: Point<D>) -> Walk<'_, D> {
        let level = self.levels.len() - 1;
        let mut keys = [[DONE; FAN]; MOST_LEVELS];
        keys[level] = self.levels[level].keys(p, 0);
        Walk { boxes: self, p, level, groups: [0; MOST_LEVELS], keys }
    }

    /// Calls `visit` with the groups of eight elements, by number, whose boxes share a point with a box.
    pub(crate) fn overlapping(&self, around: &Aabb<D>, mut visit: impl FnMut(usize)) {
        let _all = self.try_overlapping(around, |group| {
            visit(group);
            Some(())
        });
    }

    /// The same until `visit` returns `None`: then so does this.
    pub(crate) fn try_overlapping(
        &self,
        around: &Aabb<D>,
        mut visit: impl FnMut(usize) -> Option<()>,
    ) -> Option<()> {
        let mut waiting = [(0, 0); MOST_LEVELS * FAN];
        waiting[0] = (self.levels.len() - 1, 0);
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (level, group) = waiting[count];
            for i in self.levels[level].overlapping(around, group) {
                let node = group * FAN + i;
                if level == 0 {
                    visit(node)?;
                } else {
                    waiting[count] = (level - 1, node);
                    count += 1;
                }
            }
        }
        Some(())
    }
}

/// A walk over groups, the nearest first as far as boxes tell.
pub(crate) struct Walk<'a, const D: usize> {
    boxes: &'a Boxes<D>,
    p: Point<D>,
    level: usize,
    /// Of each level, the group that is looked into, and the keys of its boxes.
    groups: [usize; MOST_LEVELS],
    keys: [[f64; FAN]; MOST_LEVELS],
}

impl<const D: usize> Walk<'_, D> {
    /// The number of the next group of eight elements whose box is nearer than the square of a distance [m²]; none
    /// from a point that is not finite.
    #[inline(always)]
    pub(crate) fn next(&mut self, least: f64) -> Option<usize> {
        loop {
            let keys = &mut self.keys[self.level];
            let mut nearest = DONE;
            for key in *keys {
                nearest = if key < nearest { key } else { nearest };
            }
            let matters = nearest < least && nearest < DONE;
            if !matters {
                if self.level + 1 == self.boxes.levels.len() {
                    return None;
                }
                self.level += 1;
                continue;
            }
            let number = (nearest.to_bits() & BOX_NUMBER) as usize;
            keys[number] = DONE;
            let node = self.groups[self.level] * FAN + number;
            if self.level == 0 {
                return Some(node);
            }
            self.level -= 1;
            self.groups[self.level] = node;
            self.keys[self.level] = self.boxes.levels[self.level].keys(self.p, node);
        }
    }
}

impl<const D: usize> Level<D> {
    fn new(boxes: &[Aabb<D>]) -> Self {
        let padded = boxes.len().div_ceil(FAN) * FAN;
        // Padding boxes are at infinity.
        let mut level = Self {
            min: std::array::from_fn(|_| vec![f64::INFINITY; padded]),
            max: std::array::from_fn(|_| vec![f64::INFINITY; padded]),
        };
        for (i, aabb) in boxes.iter().enumerate() {
            for k in 0..D {
                (level.min[k][i], level.max[k][i]) = (aabb.min[k], aabb.max[k]);
            }
        }
        level
    }

    /// The squares of the distances to the boxes of a group [m²], each with the box's number in its last three bits, so
    /// that the least tells which box it is without a branch.
    #[inline(always)]
    fn keys(&self, p: Point<D>, group: usize) -> [f64; FAN] {
        let mut squared = [0.0; FAN];
        for k in 0..D {
            let min = &self.min[k][group * FAN..][..FAN];
            let max = &self.max[k][group * FAN..][..FAN];
            for i in 0..FAN {
                let away = (min[i] - p[k]).max(p[k] - max[i]).max(0.0);
                squared[i] += away * away;
            }
        }
        for (i, squared) in squared.iter_mut().enumerate() {
            // Padding is at infinity; what is not a number is passed over.
            let far = if *squared < DONE { *squared } else { DONE };
            *squared = f64::from_bits(far.to_bits() & !BOX_NUMBER | i as u64);
        }
        squared
    }

    /// Which boxes of a group share a point with a box.
    fn overlapping(&self, around: &Aabb<D>, group: usize) -> impl Iterator<Item = usize> {
        let is_apart = move |i: usize| {
            let i = group * FAN + i;
            (0..D).any(|k| self.min[k][i] > around.max[k] || self.max[k][i] < around.min[k])
        };
        (0..FAN).filter(move |i| !is_apart(*i))
    }
}

#[cfg(test)]
mod tests {
    use palpate_testkit::cases;

    use super::super::field::Part;
    use super::*;

    /// The nearest of all faces by their feet, and by groups.
    fn same<const N: usize, const D: usize>() {
        cases::check(4000, |u| {
            let scale = *u.choose(&[1e-12, 1e-3, 1.0, 1e9])?;
            let spread = *u.choose(&[1.0, 1e-3, 1e-6])?;
            let shift = *u.choose(&[0.0, 1.0, 1e3])?;
            let mut point = |far: f64| -> arbitrary::Result<Point<D>> {
                let mut p = Vector::ZERO;
                for i in 0..D {
                    // Few numbers, so that corners coincide, and triangles are flat or nearly so.
                    let step = f64::from(u.int_in_range(-4..=4)?) / 4.0;
                    let off = *u.choose(&[0.0, 0.0, 1e-9, 1e-5])?;
                    p[i] = scale * (shift + far * (step + off));
                }
                Ok(p)
            };
            let mut faces = Vec::new();
            for _ in 0..11 {
                let mut face = [Vector::ZERO; N];
                for corner in &mut face {
                    *corner = point(spread)?;
                }
                faces.push(face);
            }
            let lanes = Faces::new(&faces);
            for far in [spread, 3.0 * spread, 1e3] {
                let p = point(far)?;
                let least = faces.iter().map(|face| foot(face, p).squared).fold(
                    f64::INFINITY,
                    |least, squared| if squared < least { squared } else { least },
                );
                let mut nearest =
                    (0, Foot { point: p, part: Part::Corner(0), squared: f64::INFINITY });
                for group in 0..2 {
                    lanes.nearer(group, p, &mut nearest);
                }
                assert_eq!(nearest.1.squared, least, "{p:?} of {faces:?}");
                let (mut found, reach) = (0, 1.5 * least.sqrt());
                for group in 0..2 {
                    lanes.within(group, p, reach, |_, _, _| found += 1);
                }
                let all = faces.iter().filter(|face| foot(face, p).squared.sqrt() <= reach);
                assert_eq!(found, all.count(), "{p:?} of {faces:?}");
            }
            Ok(Ok(()))
        });
    }

    #[test]
    fn single_precision_passes_no_face_over() {
        same::<2, 2>();
        same::<3, 3>();
    }
}
