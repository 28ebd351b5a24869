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
struct Tangent<const D: usize> {
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
#[derive(Debug)]
pub(crate) struct Planes<const D: usize> {
    tangents: [Tangent<D>; CAPACITY],
    count: usize,
}

impl<const D: usize> Planes<D> {
    pub(crate) fn new() -> Self {
        let half_space = HalfSpace { point: Vector::ZERO, normal: Vector::ZERO };
        let none = Tangent { half_space, foot: Vector::ZERO, sunk: 0.0 };
        Self { tangents: [none; CAPACITY], count: 0 }
    }

    fn known(&self) -> &[Tangent<D>] {
        self.tangents.get(..self.count).unwrap_or(&[])
    }

    /// Changes each plane, and keeps those of which `keep` says so.
    fn retain(&mut self, mut keep: impl FnMut(&mut Tangent<D>) -> bool) {
        let mut kept = 0;
        for i in 0..self.count {
            let Some(tangent) = self.tangents.get_mut(i) else { break };
            if keep(tangent) {
                let tangent = *tangent;
                if let Some(place) = self.tangents.get_mut(kept) {
                    *place = tangent;
                }
                kept += 1;
            }
        }
        self.count = kept;
    }

    /// Learns that the offset surface is `gap` [m] below `seen_from` along the unit `normal`.
    ///
    /// Older planes are revised first. Where several walls meet in a crease, `f` is the least
    /// of theirs, so a wall whose plane lies `h` below `seen_from` implies `gap ≤ h`. A larger
    /// gap contradicts the plane by `gap − h`: it was that of a face left behind, and is
    /// dropped, or a rounded wall's, and is moved down by the contradiction. Which one is told
    /// by the angle between the normals (see [`LEFT_BEHIND`]).
    pub(crate) fn learn(&mut self, seen_from: Point<D>, normal: Vector<f64, D>, gap: f64) {
        let foot = seen_from - normal * gap;
        self.retain(|tangent| {
            let turn = tangent.half_space.normal - normal;
            let excess = gap - tangent.half_space.height(seen_from);
            let (turn, way) = (turn.dot(turn), (foot - tangent.foot).dot(foot - tangent.foot));
            let is_behind =
                excess > 0.0 && excess * excess > LEFT_BEHIND * LEFT_BEHIND * turn * way;
            // Written so that NaN drops the plane.
            let stays = turn > SAME_NORMAL * SAME_NORMAL && !is_behind && !excess.is_nan();
            if stays {
                let sunk = excess.max(0.0);
                tangent.half_space.point -= tangent.half_space.normal * sunk;
                tangent.sunk += sunk;
            }
            stays
        });
        let tangent =
            Tangent { half_space: HalfSpace { point: foot, normal }, foot, sunk: 0.0 };
        match self.tangents.get_mut(self.count) {
            Some(place) => {
                *place = tangent;
                self.count += 1;
            }
            None => self.replace_loosest(tangent),
        }
    }

    /// Puts `tangent` in the place of the plane farthest below its foot.
    fn replace_loosest(&mut self, tangent: Tangent<D>) {
        let height = |t: &Tangent<D>| t.half_space.height(tangent.foot);
        let loosest = self.tangents.iter_mut().max_by(|a, b| height(a).total_cmp(&height(b)));
        if let Some(place) = loosest {
            *place = tangent;
        }
    }

    /// Drops the planes that were moved down by more than `limit` [m]; `true` if there were any.
    ///
    /// They are guesses: good enough to go by, not to rest on.
    pub(crate) fn forget_sunk(&mut self, limit: f64) -> bool {
        let before = self.count;
        self.retain(|tangent| tangent.sunk <= limit);
        self.count < before
    }

    /// The unit vector that leads away from all planes, the mean of their normals; `None` if
    /// they face each other.
    pub(crate) fn up(&self) -> Option<Vector<f64, D>> {
        let normals = self.known().iter().map(|t| t.half_space.normal);
        normals.fold(Vector::ZERO, |sum, normal| sum + normal).normalized()
    }

    /// The point closest to `x` above all planes; `None` if they leave no room.
    pub(crate) fn closest(&self, x: Point<D>) -> Option<Point<D>> {
        if let [tangent] = self.known() {
            return Some(tangent.half_space.closest(x));
        }
        let none = HalfSpace { point: Vector::ZERO, normal: Vector::ZERO };
        let mut half_spaces = [none; CAPACITY];
        for (place, tangent) in half_spaces.iter_mut().zip(self.known()) {
            *place = tangent.half_space;
        }
        half_spaces.get(..self.count).and_then(|known| closest_point(x, known))
    }
}
