// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Points and lengths of a scene, as the page and the core write them.

use palpate::field::{Aabb, LARGEST_LENGTH, Point, Vector};
use palpate::scene::BuiltScene;

/// A point of the page.
pub(super) fn point_of<const D: usize>(numbers: &[f64]) -> Result<Point<D>, String> {
    point_in_space(numbers, D).map(Vector::truncated)
}

/// A point of the page, of a scene of so many dimensions. One of the plane has z = 0.
pub(super) fn point_in_space(numbers: &[f64], dimension: usize) -> Result<Point<3>, String> {
    if numbers.len() != dimension {
        let given = numbers.len();
        return Err(format!("a point of this scene is {dimension} numbers, got {given}"));
    }
    let is_usable = |x: &f64| x.abs() <= LARGEST_LENGTH;
    match numbers.iter().find(|x| !is_usable(x)) {
        None => Ok(Vector(std::array::from_fn(|k| numbers.get(k).copied().unwrap_or(0.0)))),
        Some(x) => Err(format!("a coordinate is at most {LARGEST_LENGTH:e} m, got {x} m")),
    }
}

/// The longest edge of a scene's bounds [m]; 1 m for a scene without.
pub(super) fn size<const D: usize>(scene: &BuiltScene<D>) -> f64 {
    scene.bounds().as_ref().map_or(1.0, longest_edge).max(f64::MIN_POSITIVE)
}

/// The longest edge of a box [m].
pub(super) fn longest_edge<const D: usize>(bounds: &Aabb<D>) -> f64 {
    2.0 * bounds.half_extents().0.into_iter().fold(0.0, f64::max)
}
