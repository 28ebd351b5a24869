// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Points and lengths of a scene, as the page and the core write them.

use palpate::field::{Aabb, LARGEST_LENGTH, Point, Vector};
use palpate::scene::BuiltScene;

/// A point of the page.
pub(super) fn point_of<const D: usize>(numbers: &[f64]) -> Result<Point<D>, String> {
    let wrong = || format!("a point of this scene is {D} numbers, got {}", numbers.len());
    let point: [f64; D] = numbers.try_into().map_err(|_| wrong())?;
    let is_usable = |x: &f64| x.abs() <= LARGEST_LENGTH;
    match point.iter().find(|x| !is_usable(x)) {
        None => Ok(Vector(point)),
        Some(x) => Err(format!("a coordinate is at most {LARGEST_LENGTH:e} m, got {x} m")),
    }
}

/// A vector in space: in the plane, the third coordinate is zero.
pub(super) fn in_space<const D: usize>(vector: Vector<f64, D>) -> [f64; 3] {
    std::array::from_fn(|axis| vector.0.get(axis).copied().unwrap_or_default())
}

/// The longest edge of a scene's bounds [m]; 1 m for a scene without.
pub(super) fn size<const D: usize>(scene: &BuiltScene<D>) -> f64 {
    scene.bounds().as_ref().map_or(1.0, longest_edge).max(f64::MIN_POSITIVE)
}

/// The longest edge of a box [m].
pub(super) fn longest_edge<const D: usize>(bounds: &Aabb<D>) -> f64 {
    2.0 * bounds.half_extents().0.into_iter().fold(0.0, f64::max)
}
