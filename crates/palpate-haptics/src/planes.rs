// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The tangent planes that hold a proxy, learnt one evaluation at a time.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use crate::half_spaces::{CAPACITY, HalfSpace, closest_point};

/// Normals closer than this [rad] are one plane: two would meet in a line that rounding places.
const SAME_NORMAL: f64 = 1e-6;

/// A plane is left behind if the surface fell away from it by more than this part of what its
/// turn explains. On a circular arc the part is 1/2, past a sharp edge about 1, at a crease of
/// two rounded walls it vanishes with the length of the step.
const LEFT_BEHIND: f64 = 0.25;

/// A plane and the point of the surface at which it was tangent.
#[derive(Clone, Copy, Debug)]
struct Wall<const D: usize> {
    half_space: HalfSpace<D>,
    foot: Point<D>,
    /// How far it was moved down since [m].
    sunk: f64,
}

/// Up to [`CAPACITY`] tangent planes of the offset surface about one place.
///
/// A crease of a concave shape is where several planes hold the proxy, but a field shows one at
/// a time; so planes are remembered over the evaluations of one tick. A remembered plane of a
/// convex neighbour would be no constraint any more and is dropped.
#[derive(Clone, Debug)]
pub(crate) struct Planes<const D: usize> {
    walls: [Wall<D>; CAPACITY],
    count: usize,
}

impl<const D: usize> Planes<D> {
    pub(crate) fn new() -> Self {
        let half_space = HalfSpace { point: Vector::ZERO, normal: Vector::ZERO };
        let none = Wall { half_space, foot: Vector::ZERO, sunk: 0.0 };
        Self { walls: [none; CAPACITY], count: 0 }
    }

    /// Forgets all.
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    /// Whether there is one alone.
    pub(crate) fn is_one(&self) -> bool {
        self.count == 1
    }

    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Forgets the planes of one wall: those from whose foot to `foot` the normal turned to
    /// `normal` as `is_turn` says it does along the wall.
    pub(crate) fn forget_wall(
        &mut self,
        (foot, normal): (Point<D>, Vector<f64, D>),
        is_turn: impl Fn(Vector<f64, D>, Vector<f64, D>) -> bool,
    ) {
        self.retain(|wall| !is_turn(foot - wall.foot, normal - wall.half_space.normal));
    }

    fn known(&self) -> &[Wall<D>] {
        self.walls.get(..self.count).unwrap_or(&[])
    }

    /// Changes each plane, and keeps those of which `keep` says so.
    fn retain(&mut self, mut keep: impl FnMut(&mut Wall<D>) -> bool) {
        let mut kept = 0;
        for i in 0..self.count {
            let Some(wall) = self.walls.get_mut(i) else { break };
            if keep(wall) {
                let wall = *wall;
                if let Some(place) = self.walls.get_mut(kept) {
                    *place = wall;
                }
                kept += 1;
            }
        }
        self.count = kept;
    }

    /// Learns the tangent plane of the offset surface, which is `gap` [m] below `seen_from`.
    ///
    /// Older planes are revised first. Where several walls meet in a crease, `f` is the least
    /// of theirs, so a wall whose plane lies `h` below `seen_from` implies `gap ≤ h`. A larger
    /// gap contradicts the plane by `gap − h`: it was that of a face left behind, and is
    /// dropped, or a rounded wall's, and is moved down by the contradiction. Which one is told
    /// by the angle between the normals (see [`LEFT_BEHIND`]).
    #[inline(always)]
    pub(crate) fn learn(&mut self, seen_from: Point<D>, half_space: HalfSpace<D>, gap: f64) {
        let HalfSpace { point: foot, normal } = half_space;
        self.retain(|wall| {
            let (way, turn) = (wall.foot - foot, wall.half_space.normal - normal);
            let excess = gap - wall.half_space.height(seen_from);
            let (way, turn) = (way.dot(way), turn.dot(turn));
            let is_behind =
                excess > 0.0 && excess * excess > LEFT_BEHIND * LEFT_BEHIND * turn * way;
            // Written so that NaN drops the plane.
            let stays = turn > SAME_NORMAL * SAME_NORMAL && !is_behind && !excess.is_nan();
            if stays {
                let sunk = excess.max(0.0);
                wall.half_space.point -= wall.half_space.normal * sunk;
                wall.sunk += sunk;
            }
            stays
        });
        if !self.add(half_space) {
            self.replace_loosest(Wall { half_space, foot, sunk: 0.0 });
        }
    }

    /// Adds a plane to those that are known, as they are; `false` if there is no room.
    #[inline(always)]
    pub(crate) fn add(&mut self, HalfSpace { point: foot, normal }: HalfSpace<D>) -> bool {
        let Some(place) = self.walls.get_mut(self.count) else { return false };
        // Field by field: a copy of a whole waits for its parts to be written.
        place.half_space.point = foot;
        place.half_space.normal = normal;
        place.foot = foot;
        place.sunk = 0.0;
        self.count += 1;
        true
    }

    /// Puts `wall` in the place of the plane farthest below its foot.
    fn replace_loosest(&mut self, wall: Wall<D>) {
        let height = |t: &Wall<D>| t.half_space.height(wall.foot);
        let loosest = self.walls.iter_mut().max_by(|a, b| height(a).total_cmp(&height(b)));
        if let Some(place) = loosest {
            *place = wall;
        }
    }

    /// Drops the planes that were moved down by more than `limit` [m]. By how much they were at
    /// most; none if there were none.
    ///
    /// They are guesses: good enough to go by, not to rest on.
    pub(crate) fn forget_sunk(&mut self, limit: f64) -> Option<f64> {
        let mut most = None;
        self.retain(|wall| {
            let stays = wall.sunk <= limit;
            if !stays {
                most = Some(wall.sunk.max(most.unwrap_or(0.0)));
            }
            stays
        });
        most
    }

    /// The unit vector that leads away from all planes, the mean of their normals; `None` if
    /// they face each other.
    pub(crate) fn up(&self) -> Option<Vector<f64, D>> {
        let normals = self.known().iter().map(|t| t.half_space.normal);
        normals.fold(Vector::ZERO, |sum, normal| sum + normal).normalized()
    }

    /// The point closest to `x` above all planes; `None` if they leave no room.
    pub(crate) fn closest(&self, x: Point<D>) -> Option<Point<D>> {
        let none = HalfSpace { point: Vector::ZERO, normal: Vector::ZERO };
        let mut half_spaces = [none; CAPACITY];
        for (place, wall) in half_spaces.iter_mut().zip(self.known()) {
            *place = wall.half_space;
        }
        half_spaces.get(..self.count).and_then(|known| closest_point(x, known))
    }
}
