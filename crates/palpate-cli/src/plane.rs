// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Planes in space, as the command line names them.

use palpate::field::Point;
use palpate::plot::Slice;

use crate::input;
use crate::outcome::Failure;
use palpate::scene::text::rounded;

/// The plane that `text` names: one along two axes goes through the third coordinate `at`, or
/// else through `middle` [m]. `option` is the option that names the plane.
pub(crate) fn named(
    option: &str,
    text: &str,
    at: Option<f64>,
    middle: Point<3>,
) -> Result<Slice, Failure> {
    let at = |axis: usize| at.unwrap_or(middle[axis]);
    match text {
        "xy" => Slice::xy(at(2)),
        "xz" => Slice::xz(at(1)),
        "yz" => Slice::yz(at(0)),
        free => {
            let points: Vec<_> = free.split(':').collect();
            let [origin, right, up] = points[..] else {
                let rule = "xy, xz, yz, or origin:right:up, each of these three numbers joined by commas";
                return Err(Failure::input(format!("{option} must be {rule}, got {free:?}")));
            };
            let [origin, right, up] =
                [input::point::<3>(origin)?, input::point(right)?, input::point(up)?];
            Slice::free(origin.0, right.0, up.0)
        }
    }
    .map_err(Failure::input)
}

/// Where a plane in space is: "slice at z = 0.02 m".
pub(crate) fn in_words(plane: &Slice) -> String {
    let (origin, normal) = (plane.point([0.0; 2]), plane.normal());
    let axis = |(k, name): (usize, &'static str)| (normal[k].abs() == 1.0).then_some((k, name));
    match input::AXES.into_iter().enumerate().find_map(axis) {
        Some((k, name)) => format!("slice at {name} = {} m", rounded(origin[k])),
        None => {
            let [x, y, z] = origin.map(rounded);
            let normal = normal.map(rounded).join(", ");
            format!("slice through ({x}, {y}, {z}) m, across ({normal})")
        }
    }
}
