// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The tangent planes that constrain a proxy, learnt one evaluation at a time.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};
use palpate_query::constraints::{CAPACITY, PlaneConstraint, closest_point};

/// Normals closer than this [rad] count as one plane: rounding would decide where two such
/// planes meet.
const SAME_NORMAL: f64 = 1e-6;

/// A plane is dropped if the surface falls below it by more than this part of `‖displacement‖ ×
/// angle between normals`. The ratio is 1/2 on a circular arc, about 1 beyond a sharp edge, and
/// vanishes with the step length at a crease of two rounded walls.
const LEFT_BEHIND: f64 = 0.25;

/// A plane and the point of the surface at which it was tangent.
#[derive(Clone, Copy, Debug)]
struct Wall {
    half_space: PlaneConstraint<3>,
    foot: Point<3>,
    /// How far the plane was lowered since it was learnt [m].
    lowered: f64,
}

/// Up to [`CAPACITY`] tangent planes of the offset surface about one place.
///
/// At a concave crease several planes constrain the proxy, but an evaluation shows only one; so
/// the planes of one tick are kept. A plane of a convex neighbour no longer constrains the
/// proxy and is dropped.
#[derive(Clone, Debug)]
pub(crate) struct Planes {
    walls: [Wall; CAPACITY],
    count: usize,
}

impl Planes {
    pub(crate) fn new() -> Self {
        let half_space = PlaneConstraint { point: Vector::ZERO, normal: Vector::ZERO };
        let none = Wall { half_space, foot: Vector::ZERO, lowered: 0.0 };
        Self { walls: [none; CAPACITY], count: 0 }
    }

    /// Forgets all planes.
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    /// Whether exactly one plane is known.
    pub(crate) fn is_one(&self) -> bool {
        self.count == 1
    }

    /// Whether no plane is known.
    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Forgets the planes of the wall that has the unit normal `normal` at `foot`. A plane
    /// belongs to that wall if `is_turn` accepts the displacement and the change of the normal
    /// between the two feet.
    pub(crate) fn forget_wall(
        &mut self,
        foot: Point<3>,
        normal: Vector<f64, 3>,
        is_turn: impl Fn(Vector<f64, 3>, Vector<f64, 3>) -> bool,
    ) {
        self.retain(|wall| !is_turn(foot - wall.foot, normal - wall.half_space.normal));
    }

    fn known(&self) -> &[Wall] {
        self.walls.get(..self.count).unwrap_or(&[])
    }

    /// Passes each plane to `keep`, which may change it, and drops the planes for which `keep`
    /// returns `false`.
    fn retain(&mut self, mut keep: impl FnMut(&mut Wall) -> bool) {
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
    /// Older planes are revised first. Where walls meet in a crease, `f` is the least of their
    /// fields, so a wall whose plane lies `h` below `seen_from` implies `gap ≤ h`. A larger gap
    /// contradicts the plane by `gap − h`. Either the plane belongs to a face left behind, and
    /// is dropped, or its wall is rounded, and the plane is lowered by the contradiction. The
    /// angle between the normals decides (see [`LEFT_BEHIND`]).
    #[inline(always)]
    pub(crate) fn learn(
        &mut self,
        seen_from: Point<3>,
        half_space: PlaneConstraint<3>,
        gap: f64,
    ) {
        let PlaneConstraint { point: foot, normal } = half_space;
        self.retain(|wall| {
            let (way, turn) = (wall.foot - foot, wall.half_space.normal - normal);
            let excess = gap - wall.half_space.height(seen_from);
            let (way, turn) = (way.dot(way), turn.dot(turn));
            let is_behind =
                excess > 0.0 && excess * excess > LEFT_BEHIND * LEFT_BEHIND * turn * way;
            // Written so that NaN drops the plane.
            let stays = turn > SAME_NORMAL * SAME_NORMAL && !is_behind && !excess.is_nan();
            if stays {
                let lowered = excess.max(0.0);
                wall.half_space.point -= wall.half_space.normal * lowered;
                wall.lowered += lowered;
            }
            stays
        });
        if !self.add(half_space) {
            self.replace_loosest(Wall { half_space, foot, lowered: 0.0 });
        }
    }

    /// Adds a plane without revising the older ones; `false` if there is no room.
    #[inline(always)]
    pub(crate) fn add(
        &mut self,
        PlaneConstraint { point: foot, normal }: PlaneConstraint<3>,
    ) -> bool {
        let Some(place) = self.walls.get_mut(self.count) else { return false };
        // Field by field, because copying the whole struct would stall on store forwarding.
        place.half_space.point = foot;
        place.half_space.normal = normal;
        place.foot = foot;
        place.lowered = 0.0;
        self.count += 1;
        true
    }

    /// Replaces the plane that lies farthest below the foot of `wall`.
    fn replace_loosest(&mut self, wall: Wall) {
        let height = |t: &Wall| t.half_space.height(wall.foot);
        let loosest = self.walls.iter_mut().max_by(|a, b| height(a).total_cmp(&height(b)));
        if let Some(place) = loosest {
            *place = wall;
        }
    }

    /// Drops the planes that were lowered by more than `limit` [m]. Returns the largest such
    /// amount; `None` if no plane was dropped.
    ///
    /// A lowered plane is an estimate: it may guide a move, but a proxy must not rest on it.
    pub(crate) fn forget_lowered(&mut self, limit: f64) -> Option<f64> {
        let mut most = None;
        self.retain(|wall| {
            let stays = wall.lowered <= limit;
            if !stays {
                most = Some(wall.lowered.max(most.unwrap_or(0.0)));
            }
            stays
        });
        most
    }

    /// The unit vector away from all planes, along the mean of their normals; `None` if the
    /// planes face each other.
    pub(crate) fn up(&self) -> Option<Vector<f64, 3>> {
        let normals = self.known().iter().map(|t| t.half_space.normal);
        normals.fold(Vector::ZERO, |sum, normal| sum + normal).normalized()
    }

    /// The point closest to `x` above all planes; `None` if the planes have no common point.
    pub(crate) fn closest(&self, x: Point<3>) -> Option<Point<3>> {
        let none = PlaneConstraint { point: Vector::ZERO, normal: Vector::ZERO };
        let mut half_spaces = [none; CAPACITY];
        for (place, wall) in half_spaces.iter_mut().zip(self.known()) {
            *place = wall.half_space;
        }
        half_spaces.get(..self.count).and_then(|known| closest_point(x, known))
    }
}
