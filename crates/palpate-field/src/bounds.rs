// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Boxes and balls that bound a shape.

use crate::pose::Pose;
use crate::scalar::Scalar;
use crate::vector::{Point, Vector, array, unrolled};

/// A box along the axes, `min ≤ p ≤ max` in each coordinate [m].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Aabb<const D: usize> {
    /// The corner with the smallest coordinates.
    pub min: Point<D>,
    /// The corner with the largest coordinates.
    pub max: Point<D>,
}

impl<const D: usize> Aabb<D> {
    /// The box `|pᵢ| ≤ half_extentsᵢ`.
    #[must_use]
    pub fn centred(half_extents: Vector<f64, D>) -> Self {
        Self { min: -half_extents, max: half_extents }
    }

    /// The smallest box around `points`; `None` if there are none.
    pub fn around(points: impl IntoIterator<Item = Point<D>>) -> Option<Self> {
        points.into_iter().map(|p| Self { min: p, max: p }).reduce(|a, b| a.union(&b))
    }

    /// The centre of the box [m].
    #[must_use]
    #[inline]
    pub fn centre(&self) -> Point<D> {
        Vector(array!(i < D => 0.5 * (self.min[i] + self.max[i])))
    }

    /// Half the edge lengths [m].
    #[must_use]
    #[inline]
    pub fn half_extents(&self) -> Vector<f64, D> {
        Vector(array!(i < D => 0.5 * (self.max[i] - self.min[i])))
    }

    /// A distance from the origin that none of its points exceeds [m].
    #[must_use]
    pub fn radius_about_origin(&self) -> f64 {
        self.centre().norm() + self.half_extents().norm()
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: Vector(array!(i < D => Scalar::min(self.min[i], other.min[i]))),
            max: Vector(array!(i < D => Scalar::max(self.max[i], other.max[i]))),
        }
    }

    /// The box with every face moved outwards by `margin` [m].
    #[must_use]
    pub fn grown(&self, margin: f64) -> Self {
        let margin = Vector::constant(margin);
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// The smallest box around this one after `pose`.
    #[must_use]
    #[inline(always)]
    pub fn placed(&self, pose: &Pose<D>) -> Self {
        let centre = pose.transform_point(self.centre());
        let half = self.half_extents();
        let matrix = pose.rotation.matrix();
        let reach = Vector(array!(i < D => Vector(matrix[i]).abs().dot(half)));
        // Room for the roundings of a change of frame.
        let mut largest = 0.0;
        unrolled!(i < D => largest = Scalar::max(largest, centre[i].abs() + reach[i]));
        Self { min: centre - reach, max: centre + reach }.grown(8.0 * f64::EPSILON * largest)
    }

    /// `true` if `point` lies in the box or on its faces.
    #[must_use]
    pub fn contains(&self, point: Point<D>) -> bool {
        (0..D).all(|i| self.min[i] <= point[i] && point[i] <= self.max[i])
    }
}

/// A ball that bounds a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BoundingBall<const D: usize> {
    /// The centre [m].
    pub centre: Point<D>,
    /// The radius [m].
    pub radius: f64,
}

impl<const D: usize> BoundingBall<D> {
    /// The smallest ball that holds both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        let between = other.centre - self.centre;
        let apart = between.norm();
        if apart + other.radius <= self.radius {
            return *self;
        }
        if apart + self.radius <= other.radius {
            return *other;
        }
        let radius = 0.5 * (apart + self.radius + other.radius);
        let centre = self.centre + between * ((radius - self.radius) / apart);
        Self { centre, radius: radius * (1.0 + 8.0 * f64::EPSILON) }
    }
}

/// A box and a ball, each of which holds the set `f ≤ 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Bounds<const D: usize> {
    /// The box.
    pub aabb: Aabb<D>,
    /// The ball; often tighter than the one around the box.
    pub ball: BoundingBall<D>,
}

impl<const D: usize> Bounds<D> {
    /// The box `|pᵢ| ≤ half_extentsᵢ` and a ball of `radius` about the origin.
    #[must_use]
    pub fn centred(half_extents: Vector<f64, D>, radius: f64) -> Self {
        Self {
            aabb: Aabb::centred(half_extents),
            ball: BoundingBall { centre: Vector::ZERO, radius },
        }
    }

    /// `aabb` and the ball around it.
    #[must_use]
    pub fn of_box(aabb: Aabb<D>) -> Self {
        let radius = aabb.half_extents().norm() * (1.0 + 4.0 * f64::EPSILON);
        Self { aabb, ball: BoundingBall { centre: aabb.centre(), radius } }
    }

    /// Bounds of the union of both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        let aabb = self.aabb.union(&other.aabb);
        let ball = self.ball.union(&other.ball);
        let around = Self::of_box(aabb).ball;
        Self { aabb, ball: if around.radius < ball.radius { around } else { ball } }
    }

    /// Bounds of the union of all; `None` if there are none, or one has none.
    ///
    /// The ball is about the centre of the box.
    #[must_use]
    pub fn union_of<'a>(parts: impl Iterator<Item = Option<&'a Self>> + Clone) -> Option<Self> {
        let mut others = parts.clone();
        let mut aabb = others.next()??.aabb;
        for part in others {
            aabb = aabb.union(&part?.aabb);
        }
        let around = Self::of_box(aabb).ball;
        let reach = parts.flatten().fold(0.0_f64, |reach, Self { ball, .. }| {
            Scalar::max(reach, (ball.centre - around.centre).norm() + ball.radius)
        });
        let radius = around.radius.min(reach * (1.0 + 4.0 * f64::EPSILON));
        Some(Self { aabb, ball: BoundingBall { radius, ..around } })
    }

    /// Bounds of all points within `margin` [m].
    #[must_use]
    pub fn grown(&self, margin: f64) -> Self {
        let radius = self.ball.radius + margin;
        Self {
            aabb: self.aabb.grown(margin),
            ball: BoundingBall { centre: self.ball.centre, radius },
        }
    }

    /// Bounds after `pose`.
    #[must_use]
    #[inline(always)]
    pub fn placed(&self, pose: &Pose<D>) -> Self {
        let centre = pose.transform_point(self.ball.centre);
        let slack = 8.0 * f64::EPSILON * (centre.norm() + self.ball.radius);
        Self {
            aabb: self.aabb.placed(pose),
            ball: BoundingBall { centre, radius: self.ball.radius + slack },
        }
    }

    /// Bounds after scaling axis `i` by `factors[i]`, all positive.
    #[must_use]
    pub fn scaled(&self, factors: [f64; D]) -> Self {
        let scale = |p: Point<D>| Vector(array!(i < D => p[i] * factors[i]));
        let largest = factors.iter().fold(0.0_f64, |m, f| m.max(*f));
        let aabb = Aabb { min: scale(self.aabb.min), max: scale(self.aabb.max) };
        let ball = BoundingBall {
            centre: scale(self.ball.centre),
            radius: self.ball.radius * largest * (1.0 + 4.0 * f64::EPSILON),
        };
        Self { aabb, ball }
    }

    /// The largest distance of a point of the shape from the origin.
    #[must_use]
    pub fn radius_about_origin(&self) -> f64 {
        self.ball.centre.norm() + self.ball.radius
    }
}
