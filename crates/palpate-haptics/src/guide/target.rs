// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The target of a guide, and its closest point.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use super::curve::Curve;

#[derive(Clone, Debug)]
pub(super) enum Target {
    Point(Point<3>),
    Line { through: Point<3>, direction: Vector<f64, 3> },
    Plane { through: Point<3>, normal: Vector<f64, 3> },
    Curve(Curve),
}

/// The closest point of a target, and the free directions there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest {
    pub(super) point: Point<3>,
    freedom: Freedom,
}

#[derive(Clone, Copy, Debug)]
enum Freedom {
    None,
    /// Free along a unit vector.
    Along(Vector<f64, 3>),
    /// Free across a unit vector.
    Across(Vector<f64, 3>),
}

impl Closest {
    /// A point of a curve with the unit `tangent`; `None` at its ends.
    pub(super) fn on_curve(point: Point<3>, tangent: Option<Vector<f64, 3>>) -> Self {
        Self { point, freedom: tangent.map_or(Freedom::None, Freedom::Along) }
    }

    /// The constrained part of `velocity`.
    pub(super) fn constrained(&self, velocity: Vector<f64, 3>) -> Vector<f64, 3> {
        match self.freedom {
            Freedom::None => velocity,
            Freedom::Along(tangent) => velocity - tangent * velocity.dot(tangent),
            Freedom::Across(normal) => normal * velocity.dot(normal),
        }
    }
}

impl Target {
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn closest(&self, position: Point<3>) -> Closest {
        match self {
            Self::Point(point) => Closest { point: *point, freedom: Freedom::None },
            Self::Line { through, direction } => {
                let along = (position - *through).dot(*direction);
                let point = *through + *direction * along;
                Closest { point, freedom: Freedom::Along(*direction) }
            }
            Self::Plane { through, normal } => {
                let height = (position - *through).dot(*normal);
                Closest {
                    point: position - *normal * height,
                    freedom: Freedom::Across(*normal),
                }
            }
            Self::Curve(curve) => curve.closest(position),
        }
    }
}
