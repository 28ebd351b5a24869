// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! An edit of the bodies carries a tool out of them.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Pose, Vector};

use super::Tool;
use super::closest::{Row, closest};
use super::coupling::Twist;
use super::scan::{Path, Surroundings};
use super::settle::{Lengths, stacked_along};
use crate::nearby::Nearby;

/// The most iterations: a flat wall takes one, an edge or a corner a few.
const MOST_ITERATIONS: usize = 6;

/// The part of the remaining budget of each iteration; the tool must come to rest with what is left.
const SHARE: f64 = 0.25;

/// A gradient shorter than this part of the Lipschitz constant says nothing about the surface.
const LEAST_SLOPE: f64 = 0.1;

/// What new bodies do to a tool.
pub(super) enum Covering {
    /// They do not cover it, or the budget is too small to tell.
    None,
    /// They carry it to a pose, so far [m].
    Carried(Pose<3>, f64),
    /// They cover it by more than they may carry it.
    Deep,
}

impl Tool {
    /// What new bodies do to a tool at `start`: they carry it to the nearest pose outside of them, in
    /// the metric of the coupling, if no point is covered by more than the least radius of the
    /// tool's points, or the longest way of a point without a radius.
    ///
    /// Each iteration moves the tool to the pose nearest to `start` that is above the tangent planes
    /// of all points in reach. A thin body keeps the tool on the side where it was:
    /// a point beyond the body's middle goes back along the normals of the last pushes.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; at most the evaluations that
    /// the budget has left.
    pub(super) fn carry_out(
        &mut self,
        nearby: &Nearby<'_>,
        start: &Pose<3>,
        lengths: Lengths,
    ) -> Covering {
        let is_ball = self.radius >= lengths.skin;
        let most = if is_ball { self.radius } else { self.most_of_point };
        let surroundings = Surroundings { shell: &self.shell, nearby };
        let linear = Vector(std::array::from_fn(|axis| if axis == 0 { most } else { 0.0 }));
        let reach = Twist { linear, angular: Vector::ZERO };
        let pushes = &self.rest_search.rest.pushes;
        let up = pushes.iter().fold(Vector::ZERO, |sum, push| sum + push.normal * push.push);
        let up = up.normalized();
        let (lipschitz, mut pose) = (nearby.lipschitz(), *start);
        for iteration in 0..MOST_ITERATIONS {
            let path = Path { pose: &pose, twist: &reach };
            if !self.scan.look(surroundings, path, most, SHARE) {
                return if iteration == 0 { Covering::None } else { Covering::Deep };
            }
            let way = Twist::between(start, &pose).squared(lengths.unit).sqrt();
            if self.scan.least_gap() >= -lengths.tolerance {
                let is_carried = iteration > 0;
                return if is_carried { Covering::Carried(pose, way) } else { Covering::None };
            }
            let rows = &mut self.rest_search.rows;
            rows.clear();
            for (_, seen) in self.scan.seen().filter(|(_, seen)| seen.gap <= lipschitz * most) {
                let slope = seen.gradient.norm();
                // Written so that NaN is left out.
                if slope > LEAST_SLOPE * lipschitz && rows.len() < rows.capacity() {
                    let normal = seen.gradient * (1.0 / slope);
                    let pushed = pushes.iter().any(|push| push.body == seen.body);
                    let normal = match up.filter(|up| pushed && up.dot(normal) < 0.0) {
                        Some(up) if seen.gap < 0.0 => up,
                        _ => normal,
                    };
                    let along =
                        stacked_along(seen.centre - pose.translation, normal, lengths.unit);
                    rows.push(Row { along, least: -seen.gap / slope });
                }
            }
            let back = Twist::between(&pose, start).stacked(lengths.unit);
            let found = closest(back, rows, lengths.slack());
            let twist = Twist::unstacked(found.motion, lengths.unit);
            pose = twist.moved(&pose);
            self.scan.moved(&twist);
            let way = Twist::between(start, &pose).squared(lengths.unit).sqrt();
            // Written so that NaN is too far.
            let is_near = way <= most + lengths.tolerance;
            if !is_near {
                break;
            }
        }
        // The evaluations are those of other poses.
        self.scan.moved(&Twist::between(&pose, start));
        Covering::Deep
    }
}
