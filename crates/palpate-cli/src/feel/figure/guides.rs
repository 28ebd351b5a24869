// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The guides of a scene over isolines, as far as they have a shape.

use palpate::field::{Aabb, Point};
use palpate::plot::{Color, Dash, Isolines, PlotError, Polyline};
use palpate::scene::BuiltScene;

use crate::feel::slices::FeltSlice;

/// The isolines with the lines of all guides, seen across the slice.
pub(super) fn drawn<const D: usize>(
    isolines: Isolines,
    scene: &BuiltScene<D>,
    slice: &FeltSlice,
    bounds: &Aabb<D>,
) -> Result<Isolines, PlotError> {
    let bounds = bounds.in_space();
    let flat = |point: Point<3>| slice.plane.project(point.0);
    let lines = scene.guides.iter().flat_map(|guide| guide.lines_within(&bounds));
    let lines: Vec<Vec<_>> = lines.map(|line| line.into_iter().map(flat).collect()).collect();
    if lines.is_empty() {
        return Ok(isolines);
    }
    let name = if scene.guides.len() == 1 { "guide" } else { "guides" };
    let lines = Polyline::of_pieces(name, lines)?;
    Ok(isolines.with_polyline(lines.with_color(Color::INK).with_dash(Dash::Dotted)))
}
