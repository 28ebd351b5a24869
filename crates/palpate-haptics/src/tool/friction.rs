// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Coulomb friction of a tool: it sticks, or the device is held back.
//!
//! A contact pushes with any force in its cone, spanned by `n + μ t` for unit vectors `t` along
//! the surface: two in the plane, eight in space. The tool sticks if forces of the cones of the
//! contacts that held it balance the coupling, which is to say that the closest motion with
//! `(n + μ t)·Δ ≥ −gap` for all of them, contacts as rows of a rigid motion, is none (Stewart
//! and Trinkle 1996; as a convex problem Anitescu, "Optimization-based simulation of nonsmooth
//! rigid multibody dynamics", 2006). Where it is not, that problem would lift the tool off the
//! surface as it slips; so only its friction is kept: it holds back the pose that the tool,
//! without friction, then goes to. For one contact this is the friction cone of a
//! [`Proxy`](crate::Proxy). A tool that sticks does not move at all, so it never creeps.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::FRAC_1_SQRT_2;

use palpate_field::{Pose, Vector};

use super::closest::{Closest, FREEDOMS, Row, closest};
use super::scan::Scan;
use super::settle::{Lengths, Push, Settler, stacked_along};
use super::twist::{Twist, cross, in_place, in_space};
use crate::nearby::Nearby;

/// Directions along a surface, as parts of two that are square to one another.
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

/// How many of them there are in space.
pub(super) const MOST_AROUND: usize = 8;

/// The tool sticks if it would move by this part of the way to the device or less: above what
/// rounding leaves of a balance.
const STUCK: f64 = 1e-9;

/// What friction does in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Hold<const D: usize> {
    /// There is none.
    None,
    /// The tool stays where it is.
    Stick,
    /// The tool goes to another goal.
    Slip(Pose<D>),
}

impl<const D: usize> Settler<D> {
    /// What the friction of the contacts that pushed in the last tick does to a tool at `pose`,
    /// of which all rows were made for `wish`.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn hold_back(
        &mut self,
        (scan, nearby): (&Scan<D>, &Nearby<'_, D>),
        (pose, wish): (&Pose<D>, &Twist<D>),
        lengths: Lengths,
    ) -> Hold<D> {
        let most = self.solve((scan, nearby), (pose, wish), lengths, self.is_slipping);
        let Some(found) = most else { return Hold::None };
        let (moves, away) = (length(&found.motion), length(&wish.stacked(lengths.unit)));
        // Written so that NaN sticks.
        if !(moves > (STUCK * away).max(lengths.tolerance)) {
            self.list_pushes(&found);
            return Hold::Stick;
        }
        let slipping = if self.is_slipping {
            Some(found)
        } else {
            self.solve((scan, nearby), (pose, wish), lengths, true)
        };
        let Some(found) = slipping else { return Hold::None };
        let mut target = wish.stacked(lengths.unit);
        for held in found.held() {
            let Some(k) = held.row.checked_sub(self.plain) else { continue };
            let Some(row) = self.rows.get(held.row) else { continue };
            let Some(contact) = self.cones.get(k / around::<D>()) else { continue };
            let arm = contact.centre - pose.translation;
            let normal = stacked_along(arm, contact.normal, lengths.unit);
            for ((target, along), normal) in target.iter_mut().zip(row.along).zip(normal) {
                *target += held.push * (along - normal);
            }
        }
        Hold::Slip(Twist::unstacked(target, lengths.unit).moved(pose))
    }

    /// The closest motion to the wish with cones of friction; none if nothing has any.
    fn solve(
        &mut self,
        (scan, nearby): (&Scan<D>, &Nearby<'_, D>),
        (pose, wish): (&Pose<D>, &Twist<D>),
        lengths: Lengths,
        is_slipping: bool,
    ) -> Option<Closest> {
        self.rows.truncate(self.plain);
        self.cones.clear();
        let mut has_friction = false;
        for number in &self.held {
            let (Some(seen), true) = (scan.point(*number), self.cones.len() < FREEDOMS) else {
                continue;
            };
            let slope = seen.gradient.norm();
            let normal = seen.gradient * (1.0 / slope);
            let (gap, body) = (seen.gap / slope, seen.body);
            if !(normal.is_finite() && gap.is_finite()) {
                continue;
            }
            let surface = nearby.body(body).map(|body| body.surface());
            let friction = surface.map(|surface| surface.strata.at(0, 0.0).friction);
            let friction = friction.map_or(0.0, |friction| {
                if is_slipping { friction.slipping } else { friction.fixed }
            });
            has_friction |= friction > 0.0;
            let arm = seen.centre - pose.translation;
            let (first, second) = along_surface(normal, wish, arm);
            for (a, b) in AROUND.into_iter().take(around::<D>()) {
                let pushed = normal + (first * a + second * b) * friction;
                let along = stacked_along(arm, pushed, lengths.unit);
                self.rows.push(Row { along, least: -gap });
            }
            let centre = seen.centre;
            self.cones.push(Push { point: *number, centre, normal, gap, body, push: 0.0 });
        }
        let wish = wish.stacked(lengths.unit);
        has_friction.then(|| closest(wish, &self.rows, lengths.slack()))
    }

    /// Notes what pushes the tool that sticks.
    fn list_pushes(&mut self, found: &Closest) {
        for held in found.held() {
            let cone = held.row.checked_sub(self.plain).map(|k| k / around::<D>());
            if let Some(contact) = cone.and_then(|k| self.cones.get_mut(k)) {
                contact.push += held.push;
            }
        }
        self.rest.pushes.clear();
        let room = self.rest.pushes.capacity();
        let pushing = self.cones.iter().filter(|contact| contact.push > 0.0);
        self.rest.pushes.extend(pushing.take(room));
    }
}

/// How many directions along a surface there are.
fn around<const D: usize>() -> usize {
    if D == 2 { 2 } else { MOST_AROUND }
}

/// Two unit vectors along a surface, the first the way that a point goes by its wish; in the
/// plane the second is none.
fn along_surface<const D: usize>(
    normal: Vector<f64, D>,
    wish: &Twist<D>,
    arm: Vector<f64, D>,
) -> (Vector<f64, D>, Vector<f64, D>) {
    let turning: Vector<f64, D> = in_place(cross(wish.angular, in_space(arm)));
    let way = wish.linear + turning;
    let flat = |v: Vector<f64, D>| (v - normal * v.dot(normal)).normalized();
    // An axis that is far from the normal.
    let steepest = |k: usize| normal.0.get(k).copied().unwrap_or(1.0).abs();
    let axis = (1..D).fold(0, |best, k| if steepest(k) < steepest(best) { k } else { best });
    let first = flat(way).or_else(|| flat(Vector::unit(axis))).unwrap_or(Vector::ZERO);
    let second =
        if D == 2 { Vector::ZERO } else { in_place(cross(in_space(normal), in_space(first))) };
    (first, second)
}

fn length(motion: &[f64; FREEDOMS]) -> f64 {
    motion.iter().map(|x| x * x).sum::<f64>().sqrt()
}
