// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that move, in the picture of a run: the isolines show them where the run begins, lines
//! where it ends and between.

use palpate::field::Aabb;
use palpate::plot::{Color, Dash, Isolines, PlaneView, PlotError, Polyline, Sampling, Slice};
use palpate::scene::BuiltScene;

use crate::picture::{self, Dimensions, Drawable};

/// Times between the beginning and the end at which bodies are drawn, as shares of the run.
const BETWEEN: [f64; 3] = [0.25, 0.5, 0.75];

/// The box around the bodies that move, where they are drawn; `None` if there are none.
pub(super) fn bounds<const D: usize>(scene: &BuiltScene<D>, end: f64) -> Option<Aabb<D>> {
    let mut all: Option<Aabb<D>> = None;
    for share in BETWEEN.into_iter().chain([1.0]) {
        for body in scene.moving() {
            let shape = &scene.bodies[body].shape_in_body;
            let Some(bounds) = shape.promise().bounds else { continue };
            let there = bounds.placed(&scene.pose_at(body, share * end)).aabb;
            all = Some(all.map_or(there, |all| all.union(&there)));
        }
    }
    all
}

/// The isolines with outlines of the bodies that move.
pub(super) fn drawn_over<const D: usize>(
    isolines: Isolines,
    scene: &BuiltScene<D>,
    plane: &Slice,
    view: &PlaneView,
    end: f64,
) -> Result<Isolines, PlotError>
where
    Dimensions: Drawable<D>,
{
    if scene.motions.is_empty() {
        return Ok(isolines);
    }
    let mut between = Vec::new();
    for share in BETWEEN {
        between.extend(outlines(scene, plane, view, share * end)?);
    }
    let last = outlines(scene, plane, view, end)?;
    let between = Polyline::of_pieces("bodies on their way", between)?.faint();
    let last = Polyline::of_pieces(format!("bodies at {end} s"), last)?;
    let last = last.with_color(Color::INK).with_dash(Dash::Dashed);
    Ok(isolines.with_polyline(between).with_polyline(last))
}

/// The outlines of the bodies that move, at a time [s].
fn outlines<const D: usize>(
    scene: &BuiltScene<D>,
    plane: &Slice,
    view: &PlaneView,
    time: f64,
) -> Result<Vec<Vec<[f64; 2]>>, PlotError>
where
    Dimensions: Drawable<D>,
{
    let mut lines = Vec::new();
    for body in scene.moving() {
        let pose = scene.pose_at(body, time);
        // A pose that a scene accepted places every shape: `feel` has been there.
        let Ok(shape) = scene.bodies[body].shape_in_body.clone().placed(&pose) else {
            continue;
        };
        let outline = picture::outline(&shape, plane, view, Sampling::default())?;
        lines.extend(outline.lines().iter().cloned());
    }
    Ok(lines)
}
