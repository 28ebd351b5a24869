// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Beams that go alike, and the balls that none of them meets.

use palpate_field::{BoundingBall, Point, Vector};

use crate::beam::Beam;

/// The cosine of the largest angle between a beam and the axis: of 60°. Wider bundles hold
/// everything.
const LEAST_COSINE: f64 = 0.5;

/// A cone that holds beams with their cones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bundle {
    origin: Point<3>,
    axis: Vector<f64, 3>,
    /// No beam begins farther from the bundle's origin [m].
    radius: f64,
    /// The largest radius of a beam's cone where it begins [m].
    cone: f64,
    /// The growth of the bundle for each metre; infinite if it holds everything.
    spread: f64,
}

impl Bundle {
    /// The bundle of these beams; `None` if there are none.
    pub(crate) fn around<'a>(beams: impl Iterator<Item = &'a Beam> + Clone) -> Option<Self> {
        let count = beams.clone().count();
        // An orthographic beam begins before its origin. One that begins after it counts from
        // its origin, where beams from one eye are nearer to each other.
        let begin = |beam: &Beam| beam.near.min(0.0);
        let mean = |sum: Vector<f64, 3>| sum * (1.0 / count as f64);
        let sum = beams.clone().fold(Vector::ZERO, |sum, beam| sum + beam.at(begin(beam)));
        let origin = mean(sum);
        let axis = beams.clone().fold(Vector::ZERO, |sum, beam| sum + beam.direction);
        let axis = axis.normalized().unwrap_or(Vector::ZERO);
        let (mut radius, mut cone, mut spread) = (0.0_f64, 0.0_f64, 0.0_f64);
        for beam in beams {
            let cosine = beam.direction.dot(axis);
            radius = radius.max((beam.at(begin(beam)) - origin).norm());
            cone = cone.max(beam.radius(begin(beam)));
            let tangent = (1.0 - cosine * cosine).max(0.0).sqrt() / cosine;
            // Written so that NaN holds everything.
            let holds = cosine >= LEAST_COSINE;
            let growth = if holds { tangent + beam.spread / cosine } else { f64::INFINITY };
            spread = spread.max(growth);
        }
        (count > 0).then_some(Self { origin, axis, radius, cone, spread })
    }

    /// `false` if no beam, with its cone, meets the ball from where it begins.
    ///
    /// Heights are along the axis, from the bundle's origin. Each beam begins within R of that
    /// one, so at a height of at least −R, and its cone has at most the radius r there. A point P
    /// of the cone at the height z is then at most `R + r + (z + R) s` off the axis, where s is
    /// the growth that the beam's angle and its cone add for each metre of height. A ball that
    /// holds P has its centre within its radius of P.
    pub(crate) fn may_meet(&self, ball: &BoundingBall<3>) -> bool {
        let offset = ball.centre - self.origin;
        let height = offset.dot(self.axis);
        let aside = (offset - self.axis * height).norm();
        let along = height + ball.radius + self.radius;
        let reach = self.radius + self.cone + ball.radius + along * self.spread;
        // Room for rounding. Of an infinite reach times zero, NaN, it may be met.
        let reach = reach + 1e-9 * (reach.abs() + offset.norm());
        let is_beside = aside > reach;
        !is_beside && (self.spread == f64::INFINITY || along >= 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bundle_meets_what_any_of_its_beams_meets() {
        let beam = |x: f64, slope: f64| {
            let direction = Vector([slope, 0.0, 1.0]).normalized().unwrap();
            Beam { radius: 0.1, spread: 0.01, ..Beam::ray(Vector([x, 0.0, 0.0]), direction) }
        };
        let bundle = |beams: &[Beam]| Bundle::around(beams.iter()).unwrap();
        let [all, apart] = [
            bundle(&[beam(-1.0, -0.2), beam(1.0, 0.2), beam(0.0, 0.0)]),
            bundle(&[beam(0.0, 3.0), beam(0.0, -3.0)]),
        ];
        let meets = |centre, radius| all.may_meet(&BoundingBall { centre, radius });
        // The outer beam is at x = 3 after 10 m, and its cone 0.2 m wide.
        assert!(meets(Vector([3.5, 0.0, 10.0]), 0.4));
        assert!(!meets(Vector([7.0, 0.0, 10.0]), 0.5));
        assert!(!meets(Vector([0.0, 0.0, -3.0]), 1.0));
        assert!(meets(Vector([0.0, 0.0, -1.5]), 1.0));
        // An orthographic beam that begins 20 m before its origin meets what is there.
        let behind = Beam { near: -20.0, ..Beam::ray(Vector::ZERO, Vector::unit(2)) };
        let ball = BoundingBall { centre: Vector([0.0, 0.0, -10.0]), radius: 1.0 };
        assert!(bundle(&[behind]).may_meet(&ball));
        assert!(!bundle(&[Beam { near: -5.0, ..behind }]).may_meet(&ball));
        // Beams that part by more than 60° from their middle meet everything.
        assert!(apart.may_meet(&BoundingBall { centre: Vector([0.0, 9.0, 0.1]), radius: 0.1 }));
    }
}
