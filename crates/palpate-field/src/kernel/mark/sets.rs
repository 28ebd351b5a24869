// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Marks that several primitives have.

use super::{Mark, across, at, turned};
use crate::vector::Vector;

/// A radius about the y axis, and a height that is as wide.
pub(crate) fn cylinder<const D: usize>(radius: f64, height: f64) -> Vec<Mark<D>> {
    vec![Mark::from_origin("radius", at(radius, 0.0)), Mark::height(height, radius, radius)]
}

/// The radius of a base below, and the height of the tip.
pub(crate) fn cone<const D: usize>(radius: f64, height: f64) -> Vec<Mark<D>> {
    let middle = at(0.0, -0.5 * height);
    vec![
        Mark::length_between("radius", middle, middle + at(radius, 0.0)).below(),
        Mark::height(height, radius, 0.0),
    ]
}

/// The full width of a base below, under its name, and the height in the middle.
pub(crate) fn arch<const D: usize>(
    name: &'static str,
    width: f64,
    height: f64,
) -> Vec<Mark<D>> {
    let half = 0.5 * width;
    vec![Mark::width(name, half, -0.5 * height), Mark::height(height, half, 0.0)]
}

/// The radius of a ring about the y axis, and that of its tube.
pub(crate) fn ring<const D: usize>(ring_radius: f64, radius: f64) -> Vec<Mark<D>> {
    vec![
        Mark::from_origin("ring_radius", at(ring_radius, 0.0)),
        Mark::length_between("radius", at(-ring_radius, 0.0), at(-ring_radius, radius)),
    ]
}

/// The radius and the angle of a sector about +y.
pub(crate) fn sector<const D: usize>(radius: f64, angle: f64) -> Vec<Mark<D>> {
    let place = |share: f64, radius: f64| turned(share * angle, radius);
    vec![
        Mark::from_origin("radius", place(0.2, radius)),
        Mark::angle("angle", |share| place(share, 0.4 * radius)),
    ]
}

/// The radius of an arc about `centre`, its angle about +y, and the radius of its tube.
pub(crate) fn arc<const D: usize>(
    centre: Vector<f64, D>,
    ring_radius: f64,
    angle: f64,
    radius: f64,
) -> Vec<Mark<D>> {
    let place = |share: f64, radius: f64| centre + turned(share * angle, radius);
    let tube = place(-0.2, ring_radius);
    vec![
        Mark::length_between("ring_radius", centre, place(0.2, ring_radius)),
        Mark::angle("angle", |share| place(share, 0.4 * ring_radius)),
        Mark::length_between("radius", tube, tube + turned(-0.2 * angle, radius)),
    ]
}

/// The radius of a ball about the origin, and where it is cut.
pub(crate) fn cut<const D: usize>(radius: f64, cut_height: f64) -> Vec<Mark<D>> {
    vec![
        Mark::from_origin("radius", at(0.6 * radius, 0.8 * radius)),
        Mark::from_origin("cut_height", at(0.0, cut_height)),
    ]
}

/// The radius of a ball about the origin, and the radius and distance of the one above that is
/// taken off.
pub(crate) fn bite<const D: usize>(
    radius: f64,
    cut_radius: f64,
    distance: f64,
) -> Vec<Mark<D>> {
    let above = at(0.0, distance);
    let cut = at(0.6 * cut_radius, -0.8 * cut_radius);
    vec![
        Mark::from_origin("radius", at(-0.8 * radius, -0.6 * radius)),
        Mark::length_between("cut_radius", above, above + cut),
        Mark::from_origin("distance", above),
    ]
}

/// The radii of two balls above each other, and the distance of their centres.
pub(crate) fn two_balls<const D: usize>(
    bottom_radius: f64,
    top_radius: f64,
    height: f64,
) -> Vec<Mark<D>> {
    let [bottom, top] = [-0.5 * height, 0.5 * height].map(|y| at(0.0, y));
    let out: Vector<f64, D> = at(0.6, 0.8);
    vec![
        Mark::length_between("bottom_radius", bottom, bottom - out * bottom_radius),
        Mark::length_between("top_radius", top, top + out * top_radius),
        Mark::length_between("height", bottom, top),
    ]
}

/// The two points of what is between them, and the full width across.
pub(crate) fn between<const D: usize>(
    from: Vector<f64, D>,
    to: Vector<f64, D>,
    width: f64,
) -> Vec<Mark<D>> {
    let (middle, half) = ((from + to) * 0.5, across(to - from) * (0.5 * width));
    vec![
        Mark::position("from", from),
        Mark::position("to", to),
        Mark::length_between("width", middle - half, middle + half),
    ]
}

/// The points of a sheet, and its radius at the second, away from the middle of all.
pub(crate) fn sheet(points: &[Vector<f64, 3>], radius: f64) -> Vec<Mark<3>> {
    let sum = points.iter().fold(Vector::ZERO, |sum, point| sum + *point);
    let middle = sum * (1.0 / points.len().max(1) as f64);
    let corner = points.get(1).copied().unwrap_or(middle);
    let out = (corner - middle).normalized().unwrap_or(Vector::unit(0));
    let mut marks = Mark::positions("points", points);
    marks.push(Mark::length_between("radius", corner, corner + out * radius));
    marks
}
