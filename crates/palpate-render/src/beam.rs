// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Beams of rays.

use palpate_field::{Aabb, BoundingBall, Point, Vector};

/// The radius of a cone that holds all lines of sight through a pixel, over the pixel's side: half
/// a diagonal, and more than the obliqueness of lines adds.
pub(crate) const COVER: f64 = 0.75;

/// A part of a straight line, and a cone about it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam {
    pub(crate) origin: Point<3>,
    /// Of length one.
    pub(crate) direction: Vector<f64, 3>,
    /// Where it begins and ends, from the origin [m].
    pub(crate) near: f64,
    pub(crate) far: f64,
    /// The radius of the cone at the origin [m].
    pub(crate) radius: f64,
    /// The growth of the radius for each metre.
    pub(crate) spread: f64,
}

impl Beam {
    /// A ray without a cone.
    pub(crate) fn ray(origin: Point<3>, direction: Vector<f64, 3>) -> Self {
        Self { origin, direction, near: 0.0, far: f64::INFINITY, radius: 0.0, spread: 0.0 }
    }

    pub(crate) fn at(&self, distance: f64) -> Point<3> {
        self.origin + self.direction * distance
    }

    /// The radius of the cone at a distance from the origin [m].
    pub(crate) fn radius(&self, distance: f64) -> f64 {
        self.radius + self.spread * distance
    }

    /// Two unit vectors at right angles to the direction and to each other (Frisvad 2012, with the
    /// sign of Duff and others 2017).
    pub(crate) fn across(&self) -> [Vector<f64, 3>; 2] {
        let Vector([x, y, z]) = self.direction;
        let sign = 1.0_f64.copysign(z);
        let a = -1.0 / (sign + z);
        let b = x * y * a;
        [
            Vector([1.0 + sign * x * x * a, sign * b, -sign * x]),
            Vector([b, sign + y * y * a, -y]),
        ]
    }

    /// The side of the square that its cone covers, at a distance from the origin [m].
    pub(crate) fn side(&self, distance: f64) -> f64 {
        self.radius(distance) / COVER
    }

    /// The beam with a cone `share` times as wide.
    pub(crate) fn narrowed(self, share: f64) -> Self {
        Self { radius: share * self.radius, spread: share * self.spread, ..self }
    }

    /// How far the beam may advance from where its cone has the radius `ρ`, through a ball of
    /// radius `r > ρ` about its axis that holds no surface [m].
    ///
    /// The cone, which grows by s for each metre, leaves the ball after the step t with
    /// `t² + (ρ + s t)² = r²`.
    pub(crate) fn step_through(&self, radius: f64, ball: f64) -> f64 {
        let s = self.spread;
        let a = 1.0 + s * s;
        let root = (radius * radius * s * s + a * (ball * ball - radius * radius)).sqrt();
        (root - radius * s) / a
    }
}

/// Where bodies are: surfaces beyond are not drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Extent {
    /// In a box, outside of which there are none.
    Box(Aabb<3>),
    /// In a ball, at the edge of which bodies without bounds fade.
    Ball(BoundingBall<3>),
}

impl Extent {
    /// The part of a beam that may meet a surface, with `margin` to spare [m].
    pub(crate) fn cut(&self, beam: &Beam, margin: f64) -> Beam {
        let (near, far) = match self {
            Self::Box(aabb) => through_box(&aabb.grown(margin), beam),
            Self::Ball(ball) => {
                through_ball(&BoundingBall { radius: ball.radius + margin, ..*ball }, beam)
            }
        };
        Beam { near: beam.near.max(near), far: beam.far.min(far), ..*beam }
    }

    /// The distance from a point beyond which nothing is [m].
    pub(crate) fn farthest(&self, from: Point<3>) -> f64 {
        match self {
            Self::Box(aabb) => (aabb.centre() - from).norm() + aabb.half_extents().norm(),
            Self::Ball(ball) => (ball.centre - from).norm() + ball.radius,
        }
    }
}

/// Where a line enters and leaves a box; enters after it leaves if it misses.
fn through_box(aabb: &Aabb<3>, beam: &Beam) -> (f64, f64) {
    let mut part = (f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..3 {
        let (origin, direction) = (beam.origin[k], beam.direction[k]);
        if direction == 0.0 {
            if origin < aabb.min[k] || origin > aabb.max[k] {
                return (f64::INFINITY, f64::NEG_INFINITY);
            }
            continue;
        }
        let [a, b] = [aabb.min[k], aabb.max[k]].map(|side| (side - origin) / direction);
        part = (part.0.max(a.min(b)), part.1.min(a.max(b)));
    }
    part
}

/// The same for a ball.
fn through_ball(ball: &BoundingBall<3>, beam: &Beam) -> (f64, f64) {
    let offset = beam.origin - ball.centre;
    let middle = -offset.dot(beam.direction);
    let across = (offset + beam.direction * middle).norm();
    if across > ball.radius {
        return (f64::INFINITY, f64::NEG_INFINITY);
    }
    let half = ((ball.radius - across) * (ball.radius + across)).sqrt();
    (middle - half, middle + half)
}

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
    fn a_cone_advances_to_where_it_leaves_the_ball() {
        let ray = Beam::ray(Vector::ZERO, Vector::unit(0));
        assert_eq!(Beam { spread: 0.0, ..ray }.step_through(3.0, 5.0), 4.0);
        let cone = Beam { spread: 0.75, ..ray };
        assert_eq!(cone.step_through(0.0, 5.0), 4.0);
        let step = Beam { spread: 0.1, ..ray }.step_through(0.2, 1.0);
        assert!((step.hypot(0.2 + 0.1 * step) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn what_is_across_a_beam_is_at_right_angles() {
        for direction in
            [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [0.48, -0.64, 0.6], [0.6, 0.8, 0.0]]
        {
            let beam = Beam::ray(Vector::ZERO, Vector(direction));
            let [a, b] = beam.across();
            for (u, v, product) in [
                (a, b, 0.0),
                (a, beam.direction, 0.0),
                (b, beam.direction, 0.0),
                (a, a, 1.0),
                (b, b, 1.0),
            ] {
                assert!((u.dot(v) - product).abs() < 1e-15, "{direction:?}");
            }
        }
    }

    #[test]
    fn a_beam_is_cut_at_boxes_and_balls() {
        let beam = Beam::ray(Vector([-3.0, 0.5, 0.0]), Vector::unit(0));
        let cut = Extent::Box(Aabb::centred(Vector([1.0, 1.0, 1.0]))).cut(&beam, 0.5);
        assert_eq!((cut.near, cut.far), (1.5, 4.5));
        let ball = BoundingBall { centre: Vector([0.0, 0.5, 0.0]), radius: 1.0 };
        let cut = Extent::Ball(ball).cut(&beam, 0.0);
        assert_eq!((cut.near, cut.far), (2.0, 4.0));
        let beside = Beam { origin: Vector([-3.0, 5.0, 0.0]), ..beam };
        for extent in [Extent::Box(Aabb::centred(Vector([1.0; 3]))), Extent::Ball(ball)] {
            let cut = extent.cut(&beside, 0.0);
            assert!(cut.near > cut.far);
        }
    }
}

#[cfg(test)]
mod bundle_tests {
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
