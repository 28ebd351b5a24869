// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Values of a field in a grid.

use palpate::field::{Point, Shape, Vector};
use palpate::scene::BuiltScene;

use super::{Cancel, shape};
use crate::stage::points::{longest_edge, point_of};
use crate::wire::{Ask, Grid, GridPlace};

/// By how much samples reach over the bounds of the scene on each side, as a share of its longest edge.
const MARGIN: f64 = 0.05;

/// The most values along a side of a slice.
const MOST_ALONG: usize = 512;

/// The most values of a grid: 16 MB as single floats.
const MOST_VALUES: usize = 1 << 22;

/// Values on a plane.
pub(super) fn slice<const D: usize>(
    scene: &BuiltScene<D>,
    ask: &Ask,
    cancel: &Cancel,
) -> Result<Grid, String> {
    let Ask::Slice { origin, right, up, width, height, columns, rows, body } = ask else {
        return Err("not about a slice".to_owned());
    };
    let shape = shape(scene, *body)?;
    let axis = |given: &Option<Vec<f64>>, number: usize| match given {
        Some(axis) => point_of::<D>(axis),
        None if D == 2 => {
            Ok(Vector(std::array::from_fn(|k| if k == number { 1.0 } else { 0.0 })))
        }
        None => Err("a slice in space has the directions `right` and `up`".to_owned()),
    };
    let (origin, right, up) = (point_of::<D>(origin)?, axis(right, 0)?, axis(up, 1)?);
    if columns.max(rows) > &MOST_ALONG {
        return Err(format!("a slice has at most {MOST_ALONG} values along a side"));
    }
    let counts = checked([*columns, *rows, 1])?;
    if !(*width > 0.0 && *height > 0.0 && width.is_finite() && height.is_finite()) {
        return Err(format!("a slice has a width and a height, got {width} m and {height} m"));
    }
    let (first, last) = ([-0.5 * width, -0.5 * height, 0.0], [0.5 * width, 0.5 * height, 0.0]);
    let place = GridPlace { dimension: 2, counts, first, last };
    let at = |[across, along, _]: [f64; 3]| origin + right * across + up * along;
    let values = filled(shape, place, at, cancel)?;
    Ok(Grid { place, values, is_half: false })
}

/// Values in the bounds of the scene, for a texture.
pub(super) fn samples<const D: usize>(
    scene: &BuiltScene<D>,
    cells: usize,
    body: Option<usize>,
    cancel: &Cancel,
) -> Result<Grid, String> {
    let shape = shape(scene, body)?;
    let bounds = scene.bounds().ok_or("a scene without bounds cannot be sampled")?;
    let longest = longest_edge(&bounds);
    let grown = MARGIN * longest;
    if !(2..=2048).contains(&cells) {
        return Err(format!("samples lie in 2 to 2048 cells, got {cells}"));
    }
    let step = (longest + 2.0 * grown) / cells as f64;
    let (min, max) = (bounds.min.in_space().0, bounds.max.in_space().0);
    let grow = |axis: usize, side: f64| if axis < D { side * grown } else { 0.0 };
    let first: [f64; 3] = std::array::from_fn(|axis| min[axis] + grow(axis, -1.0));
    let last: [f64; 3] = std::array::from_fn(|axis| max[axis] + grow(axis, 1.0));
    let count = |axis: usize| {
        if axis < D { ((last[axis] - first[axis]) / step).ceil() as usize + 1 } else { 1 }
    };
    let counts = checked(std::array::from_fn(count))?;
    let place = GridPlace { dimension: D as u8, counts, first, last };
    let at = |at: [f64; 3]| Vector(std::array::from_fn(|axis| at[axis]));
    let values = filled(shape, place, at, cancel)?;
    Ok(Grid { place, values, is_half: true })
}

fn checked(counts: [usize; 3]) -> Result<[usize; 3], String> {
    let product = counts.iter().try_fold(1_usize, |all, count| all.checked_mul(*count));
    match product {
        Some(1..=MOST_VALUES) => Ok(counts),
        _ => Err(format!("a grid has 1 to {MOST_VALUES} values, got {counts:?}")),
    }
}

/// The values of a shape in a grid whose points `place` maps to the scene.
fn filled<const D: usize>(
    shape: &Shape<D>,
    grid: GridPlace,
    place: impl Fn([f64; 3]) -> Point<D>,
    cancel: &Cancel,
) -> Result<Vec<f32>, String> {
    let GridPlace { counts, first, last, .. } = grid;
    let at = |axis: usize, number: usize| {
        let share = number as f64 / (counts[axis].max(2) - 1) as f64;
        first[axis] + share * (last[axis] - first[axis])
    };
    let mut points = Vec::with_capacity(counts[0]);
    let mut row = vec![0.0; counts[0]];
    let mut values = Vec::with_capacity(counts.iter().product());
    for z in 0..counts[2] {
        for y in 0..counts[1] {
            cancel.check()?;
            points.clear();
            points.extend((0..counts[0]).map(|x| place([at(0, x), at(1, y), at(2, z)])));
            shape.distances(&points, &mut row);
            values.extend(row.iter().map(|distance| *distance as f32));
        }
    }
    Ok(values)
}
