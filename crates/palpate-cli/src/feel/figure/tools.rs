// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The tool where it was: at its first touch, where it was deepest, at its last touch.

use palpate::field::{Aabb, Shape};
use palpate::plot::{Color, Dash, Isolines, PlaneView, PlotError, Polyline, Sampling};
use palpate::scene::BuiltTool;
use palpate::servo_loop::TraceRow;

use crate::feel::slices::FeltSlice;
use crate::outcome::Failure;
use crate::picture::{self, Dimensions, Drawable};

/// A tool at a time.
pub(super) struct Placed<'a, const D: usize> {
    name: String,
    dash: Dash,
    /// In the world.
    shape: Shape<D>,
    row: &'a TraceRow,
}

/// The tool at its times; none without a shape, or if it touched nothing.
pub(super) fn placed<'a, const D: usize>(
    tool: Option<&BuiltTool<D>>,
    rows: &'a [TraceRow],
) -> Result<Vec<Placed<'a, D>>, Failure> {
    let Some((tool, shape)) = tool.and_then(|tool| Some((tool, tool.shape.as_ref()?))) else {
        return Ok(Vec::new());
    };
    let depth = |row: &TraceRow| (row.proxy - row.device).norm();
    let touches = || rows.iter().filter(|row| row.contact && row.tool.is_some());
    let times = [
        ("first touch", Dash::Dotted, touches().next()),
        ("deepest", Dash::Solid, touches().max_by(|a, b| depth(a).total_cmp(&depth(b)))),
        ("last touch", Dash::Dashed, touches().next_back()),
    ];
    let mut placed = Vec::new();
    for (what, dash, row) in times {
        let Some((row, held)) = row.and_then(|row| Some((row, row.tool.as_ref()?))) else {
            continue;
        };
        let shape = match tool.radius {
            radius if radius > 0.0 => shape.clone().offset(radius),
            _ => Ok(shape.clone()),
        };
        let shape = shape
            .and_then(|shape| shape.placed(&held.pose.truncated()))
            .map_err(Failure::input)?;
        let name = format!("tool, {what}: {:.2} s", row.time_s);
        placed.push(Placed { name, dash, shape, row });
    }
    Ok(placed)
}

/// `bounds` and the tools.
pub(super) fn around<const D: usize>(bounds: Aabb<D>, tools: &[Placed<'_, D>]) -> Aabb<D> {
    let tools = tools.iter().filter_map(|tool| tool.shape.promise().bounds);
    tools.fold(bounds, |all, tool| all.union(&tool.aabb))
}

/// The isolines with the outlines of the tools. In space a tool is cut parallel to the slice,
/// through its origin.
pub(super) fn drawn<const D: usize>(
    mut isolines: Isolines,
    slice: &FeltSlice,
    view: &PlaneView,
    tools: &[Placed<'_, D>],
) -> Result<Isolines, PlotError>
where
    Dimensions: Drawable<D>,
{
    for tool in tools {
        let plane = slice.plane.parallel(tool.row.proxy.0);
        let outline = picture::outline(&tool.shape, &plane, view, Sampling::default())?;
        let line = Polyline::of_pieces(&tool.name, outline.lines().iter().cloned())?;
        let line = line.with_color(Color::NAVY).with_dash(tool.dash);
        isolines = isolines.with_polyline(line);
    }
    Ok(isolines)
}
