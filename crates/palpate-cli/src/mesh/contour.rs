// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A mesh of a scene, or of another mesh.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;

use palpate::field::{Quality, Shape};
use palpate::mesh::{ContourError, ContourOptions, Format, Solid, TriangleMesh};
use palpate::scene::AnyScene;
use serde_json::json;

use crate::arguments::MeshOptions;
use crate::error_map::bar;
use crate::input::{self, longest_edge};
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files, counted, shown};

/// Cells along the longest side of the scene unless the options say another number.
const CELLS: f64 = 100.0;

/// Cells along the longest side with which a tolerance is tried first.
const FIRST_TRY: f64 = 30.0;

/// How often cells are made smaller for a tolerance.
const MOST_TRIES: usize = 12;

/// Steps of the progress bar.
const STEPS: f64 = 1000.0;

/// A mesh, and how far it is from the surface.
struct Made {
    mesh: TriangleMesh,
    cell: f64,
    /// The largest size of the field on a triangle [m]: found, and proven.
    error: [f64; 2],
}

/// Writes the mesh; the answer is no if its error is above the tolerance, or it is not good.
pub(super) fn run(
    options: &MeshOptions,
    output: &Path,
    interrupt: &Interrupt,
) -> Result<Outcome, Failure> {
    let mut files = Files::reading([options.file.as_path()]);
    let destination = files.output(output)?;
    let format = Format::of(output).ok_or_else(|| {
        Failure::file(output, "the name of a mesh must end in .obj, .stl, .ply or .glb")
    })?;
    let shape = shape(options)?;
    interrupt.heed();
    let Some(made) = made(options, &shape, interrupt)? else {
        output::remark("interrupted: nothing was written");
        return Ok(Outcome::Interrupted);
    };
    destination.write(|out| Ok(made.mesh.write(format, out)?))?;
    report(options, output, &shape, &made)
}

/// The shape that a mesh is made of.
fn shape(options: &MeshOptions) -> Result<Shape<3>, Failure> {
    if Format::of(&options.file).is_some() {
        let solid = Solid::from_mesh(&super::mesh(options)?);
        return solid
            .map(|(solid, _)| solid.into())
            .map_err(|error| Failure::file(&options.file, error));
    }
    let named = input::scene(Some(&options.file))?;
    let AnyScene::Spatial(scene) = named.scene else {
        let problem = "the scene is in the plane; a mesh needs \"dimension\": 3";
        return Err(Failure::file(&options.file, problem));
    };
    let shape = match &options.body {
        None => scene.whole,
        Some(name) => {
            let names: Vec<_> = scene.bodies.iter().map(|body| body.name.as_str()).collect();
            let found = input::bodies(std::slice::from_ref(name), &names)?;
            scene.bodies[found[0]].shape.clone()
        }
    };
    match options.scale {
        None => Ok(shape),
        Some(scale) => shape.scaled(scale).map_err(Failure::input),
    }
}

/// The mesh with the cells that the options ask for; `None` if the program is asked to end.
fn made(
    options: &MeshOptions,
    shape: &Shape<3>,
    interrupt: &Interrupt,
) -> Result<Option<Made>, Failure> {
    let Some(bounds) = shape.promise().bounds else {
        return Err(Failure::file(&options.file, ContourError::Unbounded));
    };
    let longest = longest_edge(&bounds.aabb);
    let Some(tolerance) = options.tolerance else {
        return with_cells(options, shape, options.cell.unwrap_or(longest / CELLS), interrupt);
    };
    let mut cell = (longest / FIRST_TRY).max(tolerance);
    let mut last = None;
    for _ in 0..MOST_TRIES {
        let made = match with_cells(options, shape, cell, interrupt) {
            Ok(made) => made,
            // Finer cells than the limit allows: the last mesh is the best.
            Err(failure) => return last.map(Some).ok_or(failure),
        };
        let Some(made) = made else { return Ok(None) };
        let share = tolerance / made.error[1];
        if share >= 1.0 {
            return Ok(Some(made));
        }
        // Errors go with the square of a cell where a surface is curved, with the cell at edges.
        cell *= (0.9 * share).sqrt().clamp(0.3, 0.9);
        last = Some(made);
    }
    Ok(last)
}

fn with_cells(
    options: &MeshOptions,
    shape: &Shape<3>,
    cell: f64,
    interrupt: &Interrupt,
) -> Result<Option<Made>, Failure> {
    let bar = bar();
    bar.set_length(STEPS as u64);
    let mut progress = |share: f64| {
        bar.set_position((share * STEPS) as u64);
        if interrupt.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let mesh =
        TriangleMesh::of_shape_with(shape, &ContourOptions::with_cell(cell), &mut progress);
    bar.finish_and_clear();
    match mesh {
        Err(ContourError::Stopped) => Ok(None),
        Err(error) => Err(Failure::file(&options.file, error)),
        Ok(mesh) => {
            let error = mesh.largest_distance(shape);
            Ok(Some(Made { mesh, cell, error }))
        }
    }
}

fn report(
    options: &MeshOptions,
    output: &Path,
    shape: &Shape<3>,
    made: &Made,
) -> Result<Outcome, Failure> {
    let Made { mesh, cell, error: [found, proven] } = made;
    let is_reached = options.tolerance.is_none_or(|tolerance| *proven <= tolerance);
    let mesh_report = mesh.report();
    let solid = Solid::from_mesh(mesh);
    let crosses = solid.as_ref().map_or(0, |(_, found)| found.crossings + found.touching);
    let is_good = mesh_report.is_watertight() && crosses == 0;
    let promise = shape.promise();
    // A bound may be smaller than the distance.
    let is_exact = promise.outside == Quality::Exact && promise.inside == Quality::Exact;
    let mut out = output::answer();
    let name = output.display().to_string();
    if options.json {
        out.json(&json!({
            "ok": is_good && is_reached,
            "output": name,
            "cell_m": cell,
            "triangles": mesh.elements().len(),
            "vertices": mesh.vertices().len(),
            "watertight": mesh_report.is_watertight(),
            "crossing_pairs": crosses,
            "enclosed_m3": mesh_report.enclosed,
            "field_on_triangles_m": { "found": found, "at_most": proven },
            "field_is_distance": is_exact,
        }))?;
    } else {
        let closed = if is_good {
            "closed, none cross"
        } else {
            "not good: check it with `palpate mesh`"
        };
        writeln!(
            out,
            "{}: {} with cells of {cell:.3e} m, {closed}",
            shown(&name),
            counted(mesh.elements().len(), "triangle", "triangles"),
        )?;
        let what = if is_exact {
            "distance from the surface"
        } else {
            "size of the field, a bound of the distance,"
        };
        writeln!(out, "  error    the {what} is at most {proven:.3e} m on every triangle")?;
        if let Some(tolerance) = options.tolerance.filter(|_| !is_reached) {
            writeln!(
                out,
                "  open     --tolerance asks for {tolerance} m: edges that cells cut off need smaller --cell"
            )?;
        }
    }
    Ok(if is_good && is_reached { Outcome::Yes } else { Outcome::No })
}
