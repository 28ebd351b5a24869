// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Cones of sight and of light.

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
