// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Evaluation of a shell's points in blocks, where [`Nearby`] evaluates them one by one.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{BLOCK, Block, Gradients, Point, Pose, Vector};

use super::shell::Shell;
use crate::nearby::Nearby;

/// The last evaluation of a shell point, in world coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evaluation {
    /// Its centre [m].
    pub(super) centre: Point<3>,
    /// The field less the point's radius [m].
    pub(super) gap: f64,
    pub(super) gradient: Vector<f64, 3>,
    pub(super) body: u32,
}

/// Points that are evaluated together.
#[derive(Clone, Debug)]
pub(super) struct Batch {
    pub(super) count: usize,
    numbers: [u32; BLOCK],
    radii: [f64; BLOCK],
    seen: [Evaluation; BLOCK],
    block: Block<f64, 3, BLOCK>,
    answers: Gradients<f64, 3, BLOCK>,
    /// The points for which a body is evaluated.
    lanes: [usize; BLOCK],
}

impl Batch {
    pub(super) fn boxed() -> Box<Self> {
        let nothing =
            Evaluation { centre: Vector::ZERO, gap: 0.0, gradient: Vector::ZERO, body: 0 };
        Box::new(Self {
            count: 0,
            numbers: [0; BLOCK],
            radii: [0.0; BLOCK],
            seen: [nothing; BLOCK],
            block: Block::zero(),
            answers: Gradients::zero(),
            lanes: [0; BLOCK],
        })
    }

    /// Takes the next points.
    pub(super) fn gather(
        &mut self,
        shell: &Shell,
        pose: &Pose<3>,
        numbers: &mut impl Iterator<Item = u32>,
    ) {
        self.count = 0;
        let places = self.numbers.iter_mut().zip(&mut self.radii).zip(&mut self.seen);
        // Places come first in the zip: otherwise a number would be consumed when no place is
        // left.
        for (((number, radius), seen), next) in places.zip(numbers) {
            let Some(point) = shell.points().get(next as usize) else { continue };
            (*number, *radius) = (next, point.radius);
            seen.centre = pose.transform_point(point.centre);
            self.count += 1;
        }
    }

    /// Evaluates all near bodies with gradients: [`Nearby::gradient`] in blocks.
    pub(super) fn evaluate(&mut self, nearby: &Nearby<'_>) {
        self.evaluate_with(nearby, true);
    }

    /// Evaluates gaps only, which costs less; gradients are left undefined.
    pub(super) fn evaluate_gaps(&mut self, nearby: &Nearby<'_>) {
        self.evaluate_with(nearby, false);
    }

    fn evaluate_with(&mut self, nearby: &Nearby<'_>, has_gradients: bool) {
        let is_all = nearby.horizon == f64::INFINITY;
        for seen in self.seen.iter_mut().take(self.count) {
            (seen.gap, seen.gradient, seen.body) = (f64::INFINITY, Vector::ZERO, 0);
            if !is_all {
                let way = seen.centre - nearby.centre;
                seen.gap = nearby.horizon - way.norm();
                seen.gradient = -way.normalized().unwrap_or(Vector::ZERO);
            }
        }
        for (index, body) in nearby.all() {
            let mut asked = 0;
            let points = self.seen.iter().take(self.count).enumerate();
            for (lane, seen) in points {
                // Written so that NaN is evaluated.
                if seen.gap < f64::INFINITY && body.above_ball(seen.centre) >= seen.gap {
                    continue;
                }
                self.block.set(asked, body.in_body(seen.centre));
                if let Some(place) = self.lanes.get_mut(asked) {
                    *place = lane;
                }
                asked += 1;
            }
            if asked == 0 {
                continue;
            }
            if has_gradients {
                body.shape().block_gradients(&self.block, asked, &mut self.answers);
            } else {
                body.shape().block_distances(&self.block, asked, &mut self.answers.distance);
            }
            let turn = body.world_from_body();
            for (answer, lane) in self.lanes.iter().take(asked).enumerate() {
                let Some(seen) = self.seen.get_mut(*lane) else { continue };
                let distance = self.answers.distance.get(answer);
                let beyond =
                    body.region.is_some_and(|r| (seen.centre - r.centre).norm() > r.radius);
                let is_bounded = body.is_below_ball || beyond;
                let above = is_bounded.then(|| body.above_ball(seen.centre));
                let (gap, gradient) = match above.filter(|above| *above > distance) {
                    Some(above) => {
                        let outwards = body.off_centre(seen.centre);
                        (above, outwards.and_then(Vector::normalized).unwrap_or(Vector::ZERO))
                    }
                    None if !has_gradients => (distance, Vector::ZERO),
                    None => {
                        let gradient = self.answers.gradient.get(answer);
                        (distance, turn.transform_vector(gradient))
                    }
                };
                // Written so that NaN stays.
                if gap.is_nan() || gap < seen.gap {
                    (seen.gap, seen.gradient, seen.body) = (gap, gradient, index);
                }
            }
        }
        for (seen, radius) in self.seen.iter_mut().zip(&self.radii).take(self.count) {
            seen.gap -= radius;
        }
    }

    pub(super) fn results(&self) -> impl Iterator<Item = (u32, &Evaluation)> {
        self.numbers.iter().copied().zip(&self.seen).take(self.count)
    }
}
