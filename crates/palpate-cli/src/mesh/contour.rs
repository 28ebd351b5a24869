// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A mesh of a scene, or of another mesh: of one whose faces bound its solid these faces, mended, else a surface made
//! anew.

use std::fmt::{self, Display};
use std::ops::ControlFlow;
use std::path::Path;

use palpate::field::node::Node;
use palpate::field::{Point, Quality, Shape};
use palpate::mesh::{
    ContourError, ContourOptions, FitProgress, FittedMesh, Format, Report, Solid, TriangleMesh,
};
use palpate::scene::AnyScene;
use serde::Serialize;

use crate::input::{self, longest_edge};
use crate::interrupt::{Interrupt, Progress};
use crate::mesh::MeshOptions;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, Files, counted, shown};
use palpate::scene::text::rounded;

/// Cells along the longest side of the scene unless the options say another number.
const CELLS: f64 = 100.0;

/// Steps of the progress.
const STEPS: f64 = 1000.0;

/// A mesh as its file holds it, and how far it is from the surface.
struct Made {
    mesh: TriangleMesh,
    /// The cells of its vertices [m]; `None` of the faces of another mesh.
    cell: Option<f64>,
    /// The largest size of the field on a triangle [m]: found, and proven.
    error: [f64; 2],
    /// A point of a part that has no triangle [m].
    lost: Option<Point<3>>,
}

/// Writes the mesh; the answer is no if its error is above the tolerance, or it is not good.
pub(super) fn run(
    options: &MeshOptions,
    output: &Path,
    interrupt: &Interrupt,
) -> Result<Outcome, Failure> {
    let mut files = Files::reading([options.file.as_path()], options.reading);
    let destination = files.output(output)?;
    let format = Format::of(output).ok_or_else(|| {
        Failure::file(output, "the name of a mesh must end in .obj, .stl, .ply or .glb")
    })?;
    let shape = match Format::of_input(&options.file) {
        None => shape(options)?,
        Some(_) => solid(options)?.into(),
    };
    let mended = match own_faces(&shape, options) {
        Some(faces) => Some(mended(&faces, options, format)?),
        None => None,
    };
    interrupt.heed();
    let work = Work { options, shape: &shape, format, interrupt };
    let made = if mended.is_some() { mended } else { work.made()? };
    let judged = made.map(|made| (Judgement::of(&made.mesh), made));
    let Some((judgement, made)) = judged.filter(|_| !interrupt.is_asked()) else {
        output::remark("interrupted: nothing was written");
        return Ok(Outcome::Interrupted);
    };
    destination.write(|out| Ok(made.mesh.write(format, out)?))?;
    let answer = Answer::of(options, output, shape.promise().is_exact(), &made, &judgement);
    output::answer().print(&answer, options.json)?;
    Ok(if answer.ok { Outcome::Yes } else { Outcome::No })
}

/// Whether a mesh bounds a solid.
struct Judgement {
    report: Report<3>,
    /// Pairs of faces that cross or touch.
    crosses: usize,
    is_good: bool,
}

impl Judgement {
    fn of(mesh: &TriangleMesh) -> Self {
        let report = mesh.report();
        let solid = Solid::from_mesh(mesh);
        let crosses = solid.as_ref().map_or(0, |(_, found)| found.crossings + found.touching);
        let is_good =
            report.is_watertight() && report.degenerate == 0 && solid.is_ok() && crosses == 0;
        Self { report, crosses, is_good }
    }
}

/// The solid of a mesh.
fn solid(options: &MeshOptions) -> Result<Solid<3, 3>, Failure> {
    if options.body.is_some() {
        return Err(Failure::file(&options.file, "a mesh has no bodies: leave --body out"));
    }
    let solid = options.solid(&super::mesh(options)?);
    solid.map(|(solid, _)| solid).map_err(|error| Failure::file(&options.file, error))
}

/// The mended faces of a shape that is the solid of a mesh, moved and scaled, if they bound it and no cells are asked
/// for.
fn own_faces(shape: &Shape<3>, options: &MeshOptions) -> Option<TriangleMesh> {
    let promise = shape.promise();
    let are_boundary = [promise.outside, promise.inside] == [Quality::Exact; 2];
    if !are_boundary || options.cell.is_some() || options.tolerance.is_some() {
        return None;
    }
    let (vertices, faces) = faces_of(shape)?;
    TriangleMesh::new(vertices, faces).ok()
}

/// The vertices and faces of a shape that is the solid of a mesh, moved and scaled.
fn faces_of(shape: &Shape<3>) -> Option<(Vec<Point<3>>, Vec<[u32; 3]>)> {
    let changed = |of: &Shape<3>, change: &dyn Fn(Point<3>) -> Point<3>| {
        let (vertices, faces) = faces_of(of)?;
        Some((vertices.into_iter().map(change).collect(), faces))
    };
    match shape.node() {
        Node::Opaque(opaque) => {
            let solid: &Solid<3, 3> = opaque.custom()?;
            Some((solid.vertices().to_vec(), solid.elements().to_vec()))
        }
        Node::Placed { pose, of } => changed(of, &|p| pose.transform_point(p)),
        Node::Scaled { factor, of } => changed(of, &|p| p * *factor),
        _ => None,
    }
}

/// These faces as a file holds them.
fn mended(
    faces: &TriangleMesh,
    options: &MeshOptions,
    format: Format,
) -> Result<Made, Failure> {
    let refused = |error: &dyn Display| Failure::file(&options.file, error);
    let mesh = faces.clone().in_format(format).map_err(|error| refused(&error))?;
    // No point of a triangle moves farther than its corners do.
    let moved = (0..faces.elements().len()).flat_map(|face| {
        let corners = faces.corners(face).into_iter().zip(mesh.corners(face));
        corners.map(|(from, to)| (to - from).norm())
    });
    let moved = moved.fold(0.0, f64::max) * (1.0 + 1e-12);
    Ok(Made { mesh, cell: None, error: [moved; 2], lost: None })
}

/// The shape of a scene.
fn shape(options: &MeshOptions) -> Result<Shape<3>, Failure> {
    if options.weld {
        return Err(Failure::file(&options.file, "a scene has no vertices: leave --weld out"));
    }
    if options.weld_within.is_some() {
        let problem = "a scene says itself how corners are joined: leave --weld-within out, and write \
                       \"weld_within\" beside \"file\"";
        return Err(Failure::file(&options.file, problem));
    }
    let named = input::scene(Some(&options.file), options.reading)?;
    let AnyScene::Spatial(scene) = named.scene else {
        let problem = "the scene is in the plane; a mesh needs \"dimension\": 3";
        return Err(Failure::file(&options.file, problem));
    };
    let shape = input::body_or_whole(&scene, options.body.as_deref())?.clone();
    match options.scale {
        None => Ok(shape),
        Some(scale) => shape.scaled(scale).map_err(Failure::input),
    }
}

/// What a mesh is made of, and how.
struct Work<'a> {
    options: &'a MeshOptions,
    shape: &'a Shape<3>,
    format: Format,
    interrupt: &'a Interrupt,
}

impl Work<'_> {
    /// The mesh with the cells that the options ask for; `None` if the program is asked to end.
    fn made(&self) -> Result<Option<Made>, Failure> {
        let refused = |error: &dyn Display| Failure::file(&self.options.file, error);
        let Some(bounds) = self.shape.promise().bounds else {
            return Err(refused(&ContourError::Unbounded));
        };
        let shown = Progress::of("making triangles");
        let mut progress = |FitProgress { cell, share }: FitProgress| {
            let cells = format_args!("cells of {} m", rounded(cell));
            shown.show((share * STEPS) as usize, STEPS as usize, cells);
            if self.interrupt.is_asked() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let by = |cell| ContourOptions {
            is_single: self.format.is_single(),
            most_triangles: self.options.most_triangles,
            ..ContourOptions::with_cell(cell)
        };
        let longest = longest_edge(&bounds.aabb);
        let fitted = match self.options.tolerance {
            Some(tolerance) => {
                FittedMesh::by_tolerance(self.shape, tolerance, &by(longest), &mut progress)
            }
            None => {
                let cell = self.options.cell.unwrap_or(longest / CELLS);
                FittedMesh::by_cells(self.shape, &by(cell), &mut progress)
            }
        };
        match fitted {
            Ok(FittedMesh { mesh, cell, error, lost, .. }) => {
                let mesh = mesh.in_format(self.format).map_err(|error| refused(&error))?;
                Ok(Some(Made { mesh, cell: Some(cell), error, lost }))
            }
            Err(ContourError::Stopped) => Ok(None),
            Err(error) => Err(refused(&error)),
        }
    }
}

/// The answer of `palpate mesh SCENE --output FILE`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// `true` if the mesh is good, its error is within the tolerance, and no part is lost.
    pub(crate) ok: bool,
    /// The file.
    pub(crate) output: String,
    /// The size of the cells [m]; `null` where the faces are those of a mesh.
    pub(crate) cell: Option<f64>,
    /// The number of triangles.
    pub(crate) elements: usize,
    /// The number of vertices.
    pub(crate) vertices: usize,
    /// `true` if each edge joins two triangles that agree on the inside.
    pub(crate) is_watertight: bool,
    /// Pairs of triangles that cross or touch.
    pub(crate) crossings: usize,
    /// Triangles without area.
    pub(crate) degenerate: usize,
    /// The enclosed volume [m³]; `null` if the mesh is not watertight.
    pub(crate) enclosed: Option<f64>,
    /// The largest |f| that was found on a triangle [m].
    pub(crate) found: f64,
    /// A proven upper bound of |f| on all triangles [m].
    pub(crate) error: f64,
    /// `true` if the field is the distance, so that every triangle is within the error of the surface.
    pub(crate) is_exact: bool,
    /// A point of a part, or of a cavity, that has no triangle, since the cells are too large for it
    /// [m]; `null` if none was found.
    pub(crate) lost: Option<[f64; 3]>,
    /// The mesh or scene.
    #[serde(skip)]
    input: String,
    #[serde(skip)]
    is_good: bool,
    /// The tolerance that is missed [m].
    #[serde(skip)]
    missed: Option<f64>,
}

impl Answer {
    fn of(
        options: &MeshOptions,
        output: &Path,
        is_exact: bool,
        made: &Made,
        Judgement { report, crosses, is_good }: &Judgement,
    ) -> Self {
        let Made { mesh, cell, error: [found, proven], lost } = made;
        let is_reached = options.tolerance.is_none_or(|tolerance| *proven <= tolerance);
        let missed = options.tolerance.filter(|_| !is_reached);
        Self {
            ok: *is_good && missed.is_none() && lost.is_none(),
            output: output.display().to_string(),
            cell: *cell,
            elements: mesh.elements().len(),
            vertices: mesh.vertices().len(),
            is_watertight: report.is_watertight(),
            crossings: *crosses,
            degenerate: report.degenerate,
            enclosed: report.enclosed,
            found: *found,
            error: *proven,
            is_exact,
            lost: lost.map(|point| point.0),
            input: options.file.display().to_string(),
            is_good: *is_good,
            missed,
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let closed = if self.is_good {
            "closed, none cross"
        } else {
            "not good: check it with `palpate mesh`"
        };
        let by = match self.cell {
            Some(cell) => format!("with cells of {cell:.3e} m"),
            None => format!("as {} has them, mended", shown(&self.input)),
        };
        writeln!(
            f,
            "{}: {} {by}, in metres, {closed}",
            shown(&self.output),
            counted(self.elements, "triangle", "triangles"),
        )?;
        let proven = self.error;
        if self.is_exact {
            // A bound may be smaller than the distance.
            writeln!(
                f,
                "  error    every triangle is within {proven:.3e} m of the surface, proven"
            )?;
        } else {
            writeln!(
                f,
                "  error    the field is at most {proven:.3e} m in size on every triangle, proven; it is \
                 a bound, so the surface may be farther away"
            )?;
        }
        if let Some(point) = self.lost {
            writeln!(
                f,
                "  lost     a part or a cavity at ({}) m has no triangle, and others may have none: the cells are too large",
                point.map(rounded).join(", ")
            )?;
        }
        if let Some(tolerance) = self.missed {
            writeln!(
                f,
                "  open     more than --tolerance {tolerance} m, after as many tries as are made: allow more, or ask \
                 for a smaller --cell instead"
            )?;
        }
        Ok(())
    }
}
