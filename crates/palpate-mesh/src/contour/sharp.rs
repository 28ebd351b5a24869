// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Places on the surface of a shape: on edges and corners where there are any.

use palpate_field::{Point, Shape, Vector};

use super::cells::Crossing;
use super::vertex::best;

/// Steps down the slope of the field at most.
const STEPS: usize = 6;

/// A place is on the surface if the field there is at most this share of the way to it.
const ON: f64 = 1e-6;

/// How often the planes around a place are looked at, each time this share as far away.
const LOOKS: usize = 5;
const NEARER: f64 = 0.4;

/// Directions in which planes are looked for.
const DIRECTIONS: usize = 14;

/// The place found is at most this many times as far away as the planes were first looked for.
const FARTHEST: f64 = 4.0;

/// The place of a surface near a point, and its normal, by Newton's steps; `None` if they do not lead there.
pub(super) fn landed(shape: &Shape<3>, from: Point<3>) -> Option<Crossing> {
    let mut place = from;
    let mut first = None;
    for _ in 0..STEPS {
        let (value, slope) = shape.distance_gradient(place);
        let steep = slope.norm();
        let is_slope = steep > 0.0 && steep.is_finite() && value.is_finite();
        if !is_slope {
            return None;
        }
        let far = *first.get_or_insert(value.abs());
        let normal = slope * (1.0 / steep);
        place -= normal * (value / steep);
        if value.abs() <= ON * far {
            return Some(Crossing { place, normal });
        }
    }
    // Where the field is not smooth, steps may go to and fro.
    let end = shape.distance_gradient(place);
    let normal = end.1.normalized()?;
    (end.0.abs() <= 0.1 * first?).then_some(Crossing { place, normal })
}

/// The place of the surface near a point: of an edge or a corner, if the planes of the surface within about `reach` [m]
/// have one. `None` if none is found.
pub(super) fn sharp(shape: &Shape<3>, near: Point<3>, reach: f64) -> Option<Point<3>> {
    let (mut place, mut radius) = (near, reach);
    for _ in 0..LOOKS {
        let around = (0..DIRECTIONS).map(|i| place + direction(i) * radius);
        let planes: Vec<_> = around.filter_map(|from| landed(shape, from)).collect();
        if planes.is_empty() {
            return None;
        }
        let [found, _] = best(&planes);
        // Written so that NaN is too far.
        let is_near = (found - near).norm() <= FARTHEST * reach;
        if !is_near {
            return None;
        }
        place = found;
        radius *= NEARER;
    }
    let off = shape.distance(place).abs();
    if off <= ON * reach { Some(place) } else { landed(shape, place).map(|on| on.place) }
}

/// Directions spread evenly, by the golden angle; none lies in a plane of the axes.
fn direction(i: usize) -> Vector<f64, 3> {
    let height = 1.0 - (2.0 * i as f64 + 1.0) / DIRECTIONS as f64;
    let angle = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt()) * (i as f64 + 0.3);
    let radius = (1.0 - height * height).sqrt();
    Vector([radius * angle.cos(), height, radius * angle.sin()])
}

#[cfg(test)]
mod tests {
    use palpate_field::Rotation;

    use super::*;

    #[test]
    fn edges_and_corners_are_found_from_beside_them() {
        let turn = Rotation::from_axis_angle([1.0, 2.0, 3.0], 0.7).unwrap();
        let cuboid = Shape::cuboid([0.5, 0.3, 0.4]).unwrap().rotated(turn).unwrap();
        let corner = turn.rotate(Vector([0.25, 0.15, 0.2]));
        let edge = turn.rotate(Vector([0.25, 0.15, 0.03]));
        for i in 0..DIRECTIONS {
            let off = direction((i + 3) % DIRECTIONS) * 0.008;
            let found = sharp(&cuboid, corner + off, 0.02).unwrap();
            assert!((found - corner).norm() < 1e-9, "{i}: {:?}", found - corner);
            let found = sharp(&cuboid, edge + off, 0.02).unwrap();
            let along = turn.rotate(Vector([0.0, 0.0, 1.0]));
            let aside = found - edge - along * (found - edge).dot(along);
            assert!(aside.norm() < 1e-9, "{i}: {found:?}");
        }
    }

    /// The rim of a cylinder: the edge is curved, its planes are not the same everywhere.
    #[test]
    fn a_curved_edge_is_found() {
        let cylinder = Shape::cylinder(0.3, 0.4).unwrap();
        let near = Vector([0.28, 0.21, 0.02]);
        let found = sharp(&cylinder, near, 0.03).unwrap();
        assert!((found[0].hypot(found[2]) - 0.3).abs() < 1e-9, "{found:?}");
        assert!((found[1] - 0.2).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn a_smooth_place_is_below() {
        let ball = Shape::sphere(0.3).unwrap();
        let found = sharp(&ball, Vector([0.29, 0.0, 0.0]), 0.02).unwrap();
        assert!((found.norm() - 0.3).abs() < 1e-9, "{found:?}");
        assert!((found - Vector([0.3, 0.0, 0.0])).norm() < 0.02 * 0.02, "{found:?}");
    }
}
