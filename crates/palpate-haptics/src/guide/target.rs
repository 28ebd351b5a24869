// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The target of a guide, and its closest point.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use super::curve::Curve;

#[derive(Clone, Debug)]
pub(super) enum Target<const D: usize> {
    Point(Point<D>),
    Line { through: Point<D>, direction: Vector<f64, D> },
    Plane { through: Point<D>, normal: Vector<f64, D> },
    Curve(Curve<D>),
}

/// The closest point of a target, and the free directions there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest<const D: usize> {
    pub(super) point: Point<D>,
    freedom: Freedom<D>,
}

#[derive(Clone, Copy, Debug)]
enum Freedom<const D: usize> {
    None,
    /// Free along a unit vector.
    Along(Vector<f64, D>),
    /// Free across a unit vector.
    Across(Vector<f64, D>),
}

impl<const D: usize> Closest<D> {
    /// A point of a curve with the unit `tangent`; `None` at its ends.
    pub(super) fn on_curve(point: Point<D>, tangent: Option<Vector<f64, D>>) -> Self {
        Self { point, freedom: tangent.map_or(Freedom::None, Freedom::Along) }
    }

    /// The constrained part of `velocity`.
    pub(super) fn constrained(&self, velocity: Vector<f64, D>) -> Vector<f64, D> {
        match self.freedom {
            Freedom::None => velocity,
            Freedom::Along(tangent) => velocity - tangent * velocity.dot(tangent),
            Freedom::Across(normal) => normal * velocity.dot(normal),
        }
    }
}

impl<const D: usize> Target<D> {
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn closest(&self, position: Point<D>) -> Closest<D> {
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
