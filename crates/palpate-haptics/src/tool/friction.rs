// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Coulomb friction of a tool: the tool sticks, or its goal is held back.
//!
//! A contact pushes with any force in its friction cone, spanned by `n + μ t` for unit vectors
//! `t` along the surface: two in the plane, eight in space. The tool sticks if forces in the
//! cones of the last tick's contacts balance the coupling. Equivalently, the closest motion
//! that satisfies `(n + μ t)·Δ ≥ −gap` for all contacts is zero (Stewart and Trinkle 1996; as a
//! convex problem Anitescu, "Optimization-based simulation of nonsmooth rigid multibody
//! dynamics", 2006). When the tool slips, the convex problem would also lift it off the
//! surface. So only its friction is used, scaled to what contacts push without that lift: the
//! friction shifts the goal towards which the tool then moves without friction. For one contact
//! this is the friction cone of a [`Proxy`](crate::Proxy). A tool that sticks does not move at
//! all, so it never creeps.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::FRAC_1_SQRT_2;

use palpate_field::{Pose, Vector};

use super::closest::{Closest, FREEDOMS, Row, closest};
use super::coupling::Twist;
use super::scan::{Path, Scan};
use super::settle::{Lengths, Near, Push, RestSearch, stacked_along};
use crate::nearby::Nearby;
use crate::surface::Friction;

/// Directions along a surface, in a basis of two orthogonal ones.
const AROUND: [(f64, f64); MOST_AROUND] = [
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.0, 1.0),
    (0.0, -1.0),
    (FRAC_1_SQRT_2, FRAC_1_SQRT_2),
    (-FRAC_1_SQRT_2, FRAC_1_SQRT_2),
    (FRAC_1_SQRT_2, -FRAC_1_SQRT_2),
    (-FRAC_1_SQRT_2, -FRAC_1_SQRT_2),
];

/// The number of directions in space.
pub(super) const MOST_AROUND: usize = 8;

/// The tool sticks if it would move by at most this part of the displacement to the device:
/// more than the rounding error of a balance of forces.
const STUCK: f64 = 1e-9;

/// The effect of friction in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Hold {
    /// No friction acts.
    None,
    /// The tool does not move.
    Stick,
    /// The tool slips towards another goal.
    Slip(Pose<3>),
}

/// A contact with friction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    push: Push,
    friction: Friction,
    /// Orthonormal directions along the surface; the second is zero for a planar tool.
    sides: [Vector<f64, 3>; 2],
}

impl RestSearch {
    /// The friction of the last tick's contacts on a tool that would move along `path`, for
    /// which all rows were made.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn hold_back(
        &mut self,
        scan: &Scan,
        nearby: &Nearby<'_>,
        path: Path<'_>,
        lengths: Lengths,
    ) -> Hold {
        let Path { pose, twist: wish } = path;
        let away = wish.stacked(lengths.unit);
        if !self.find_cones(scan, nearby, path, length(&away)) {
            return Hold::None;
        }
        let found = self.solve(pose, away, lengths, self.is_slipping);
        let moves = length(&found.motion);
        // Written so that NaN sticks.
        if moves.is_nan() || moves <= (STUCK * length(&away)).max(lengths.tolerance) {
            self.list_pushes(&found);
            self.list_touching(length(&away));
            if nearby.has_moved() {
                self.list_new_pushes(&found);
            }
            return Hold::Stick;
        }
        // A tool that slipped in the last tick was already solved with its dynamic friction.
        let found =
            if self.is_slipping { found } else { self.solve(pose, away, lengths, true) };
        let mut friction = [0.0; FREEDOMS];
        for held in found.held() {
            let Some((cone, row)) = self.cone_of(held.row) else { continue };
            let arm = cone.push.centre - pose.translation;
            let normal = stacked_along(arm, cone.push.normal, lengths.unit);
            for ((friction, along), normal) in friction.iter_mut().zip(row.along).zip(normal) {
                *friction += held.push * (along - normal);
            }
        }
        let pushes = |found: &Closest| found.held().map(|held| held.push).sum::<f64>();
        self.rows.truncate(self.plain);
        let flat = closest(sum(away, friction, 1.0), &self.rows, lengths.slack());
        // Written so that NaN, from zero push, gives zero.
        let part = (pushes(&flat) / pushes(&found)).clamp(0.0, 1.0).max(0.0);
        // Between faces that jam the tool, pushes have no bound; friction is no greater than its cause.
        let part = part * (length(&away) / length(&friction).max(length(&away)));
        let target = sum(away, friction, part);
        Hold::Slip(Twist::unstacked(target, lengths.unit).moved(pose))
    }

    /// The cone that a row belongs to.
    fn cone_of(&self, row: usize) -> Option<(&Cone, &Row)> {
        let index = row.checked_sub(self.plain)? / self.around();
        Some((self.cones.get(index)?, self.rows.get(row)?))
    }

    /// Lists the friction cones of the last tick's contacts; `false` if none of them has
    /// friction at this depth [m].
    fn find_cones(
        &mut self,
        scan: &Scan,
        nearby: &Nearby<'_>,
        path: Path<'_>,
        depth: f64,
    ) -> bool {
        let Path { pose, twist: wish } = path;
        self.cones.clear();
        let mut has_friction = false;
        for held in self.held.iter().take(FREEDOMS) {
            let same = self.near.iter().find(|near| near.is_of(held)).copied();
            let least = || Some(Near { point: held.point, seen: *scan.point(held.point)? });
            let Some(push) = same.or_else(least).map(|near| near.push(0.0)) else { continue };
            let Some(body) = nearby.body(push.body) else { continue };
            if !(push.normal.is_finite() && push.gap.is_finite()) {
                continue;
            }
            let friction = body.surface().strata.at(0, depth).friction;
            has_friction |= friction.fixed.max(friction.slipping) > 0.0;
            let first = along_surface(push.normal, wish, push.centre - pose.translation);
            let second = if self.is_flat { Vector::ZERO } else { push.normal.cross(first) };
            let sides = [first, second];
            self.cones.push(Cone { push, friction, sides });
        }
        has_friction
    }

    /// The closest motion to the desired one under friction cones.
    fn solve(
        &mut self,
        pose: &Pose<3>,
        wish: [f64; FREEDOMS],
        lengths: Lengths,
        is_slipping: bool,
    ) -> Closest {
        self.rows.truncate(self.plain);
        let around = self.around();
        for cone in &self.cones {
            let Friction { fixed, slipping } = cone.friction;
            let friction = if is_slipping { slipping } else { fixed };
            let Push { centre, normal, gap, .. } = cone.push;
            let [first, second] = cone.sides;
            for (a, b) in AROUND.into_iter().take(around) {
                let pushed = normal + (first * a + second * b) * friction;
                let along = stacked_along(centre - pose.translation, pushed, lengths.unit);
                self.rows.push(Row { along, least: -gap });
            }
        }
        closest(wish, &self.rows, lengths.slack())
    }

    /// The number of directions along a surface.
    fn around(&self) -> usize {
        if self.is_flat { 2 } else { MOST_AROUND }
    }

    /// Records the pushes on a tool that sticks.
    fn list_pushes(&mut self, found: &Closest) {
        for held in found.held() {
            // Against a hand that presses straight in, the tangent plane itself holds.
            let index = match held.row.checked_sub(self.plain) {
                Some(row) => Some(row / self.around()),
                None => self
                    .near
                    .get(held.row)
                    .and_then(|near| self.cones.iter().position(|cone| near.is_of(&cone.push))),
            };
            if let Some(cone) = index.and_then(|index| self.cones.get_mut(index)) {
                cone.push.push += held.push;
            }
        }
        self.rest.pushes.clear();
        let room = self.rest.pushes.capacity();
        let pushing = self.cones.iter().map(|cone| cone.push).filter(|push| push.push > 0.0);
        self.rest.pushes.extend(pushing.take(room));
    }

    /// Records the pushes of bodies that moved onto a sticking tool in this tick.
    fn list_new_pushes(&mut self, found: &Closest) {
        for held in found.held().filter(|held| held.row < self.plain && held.push > 0.0) {
            let Some(near) = self.near.get(held.row) else { continue };
            let is_known = self.cones.iter().any(|cone| near.is_of(&cone.push));
            if !is_known && self.rest.pushes.len() < self.rest.pushes.capacity() {
                self.rest.pushes.push(near.push(held.push));
            }
        }
    }
}

/// A unit vector along a surface, along the desired motion of a point if it has one.
fn along_surface(normal: Vector<f64, 3>, wish: &Twist, arm: Vector<f64, 3>) -> Vector<f64, 3> {
    let way = wish.of_point(arm);
    let flat = |v: Vector<f64, 3>| (v - normal * v.dot(normal)).normalized();
    // The coordinate axis farthest from the normal.
    let steepest = |k: usize| normal.0.get(k).copied().unwrap_or(1.0).abs();
    let axis = (1..3).fold(0, |best, k| if steepest(k) < steepest(best) { k } else { best });
    flat(way).or_else(|| flat(Vector::unit(axis))).unwrap_or(Vector::ZERO)
}

fn sum(a: [f64; FREEDOMS], b: [f64; FREEDOMS], part: f64) -> [f64; FREEDOMS] {
    let mut sum = a;
    for (sum, b) in sum.iter_mut().zip(b) {
        *sum += b * part;
    }
    sum
}

fn length(motion: &[f64; FREEDOMS]) -> f64 {
    motion.iter().map(|x| x * x).sum::<f64>().sqrt()
}
