// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Isolines of shapes, and picture files.

use std::path::Path;

use palpate::field::{Aabb, Shape, Vector};
use palpate::plot::{Figure, Isolines, PlotError, Sampling, Slice, View};

use crate::outcome::Failure;

/// Room around a scene, as a share of its longer side.
const MARGIN: f64 = 0.15;

/// A dimension whose shapes can be drawn.
pub(crate) trait Drawable<const D: usize> {
    /// The window that shows `bounds` on `plane`.
    fn view(plane: &Slice, bounds: &Aabb<D>) -> Result<View, PlotError>;

    /// The point of space at plane coordinates.
    fn point(plane: &Slice, st: [f64; 2]) -> Vector<f64, D>;
}

/// Marks the dimension of a shape.
pub(crate) struct Dimensions;

impl Drawable<2> for Dimensions {
    fn view(_: &Slice, bounds: &Aabb<2>) -> Result<View, PlotError> {
        View::from_bounds(bounds.min.0, bounds.max.0, MARGIN)
    }

    fn point(_: &Slice, st: [f64; 2]) -> Vector<f64, 2> {
        Vector(st)
    }
}

impl Drawable<3> for Dimensions {
    fn view(plane: &Slice, bounds: &Aabb<3>) -> Result<View, PlotError> {
        View::of_box(plane, bounds.min.0, bounds.max.0, MARGIN)
    }

    fn point(plane: &Slice, st: [f64; 2]) -> Vector<f64, 3> {
        Vector(plane.point(st))
    }
}

/// The isolines of `shape` on `plane`.
pub(crate) fn isolines<const D: usize>(
    shape: &Shape<D>,
    plane: &Slice,
    view: &View,
) -> Result<Isolines, PlotError>
where
    Dimensions: Drawable<D>,
{
    let mut points = Vec::new();
    Isolines::sample(plane, view, Sampling::default(), |st, distances| {
        points.clear();
        points.extend(st.iter().map(|st| Dimensions::point(plane, *st)));
        shape.distances(&points, distances);
    })
}

/// Writes `figure` to `path`, as its ending says.
pub(crate) fn save(figure: &Figure, path: &Path, width: u32) -> Result<(), Failure> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let bytes = match ending.to_ascii_lowercase().as_str() {
        "svg" => figure.to_svg().into_bytes(),
        "png" => figure.to_png(width).map_err(Failure::input)?,
        _ => {
            let problem = "a picture's name must end in .svg or .png";
            return Err(Failure::file(path, problem));
        }
    };
    std::fs::write(path, bytes).map_err(|error| Failure::file(path, error))
}
