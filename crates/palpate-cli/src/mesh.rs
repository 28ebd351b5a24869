// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate mesh`: checks a mesh, or makes one of a scene.

use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use palpate::grid::Volume;
use palpate::mesh::{
    Findings, Format, MOST_TRIANGLES, ReadError, ReadProblem, Solid, SolidError, TriangleMesh,
    read_file,
};
use palpate::scene::text::rounded;
use serde::Serialize;
use serde_json::Value;

use crate::answers::Bounds;
use crate::arguments::Reading;
use crate::arguments::numbers::length;
use crate::input::longest_edge;
use crate::interrupt::Interrupt;
use crate::kind::Kind;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, shown};
use crate::units::hint;

pub(crate) mod contour;

/// Reports on a mesh; the answer is no if it is not watertight or has degenerate triangles.
pub(crate) fn run(options: &MeshOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    if let Some(output) = &options.output {
        return contour::run(options, output, interrupt);
    }
    let checked = Checked::of(&mesh(options)?, options);
    output::answer().print(&checked, options.json)?;
    Ok(if checked.ok { Outcome::Yes } else { Outcome::No })
}

/// The answer of `palpate mesh FILE`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Checked {
    #[serde(skip)]
    name: String,
    /// `true` if the mesh is watertight, no triangle is degenerate, and none cross or touch.
    pub(crate) ok: bool,
    /// The number of triangles.
    pub(crate) elements: usize,
    /// The number of vertices, unused ones included.
    pub(crate) vertices: usize,
    /// `true` if each edge joins two triangles that agree on the inside.
    pub(crate) is_watertight: bool,
    /// Edges of one triangle only.
    pub(crate) boundary: usize,
    /// Edges of more than two triangles.
    pub(crate) non_manifold: usize,
    /// Edges between triangles that disagree on the inside.
    pub(crate) inconsistent: usize,
    /// Triangles without area.
    pub(crate) degenerate: usize,
    /// Triangles with the vertices of an earlier one.
    pub(crate) duplicates: usize,
    /// Vertices of no triangle.
    pub(crate) unreferenced: usize,
    /// Vertices at the position of another.
    pub(crate) coincident: usize,
    /// The box around the triangles.
    pub(crate) bounds: Bounds,
    /// The area of all triangles [m²].
    pub(crate) surface: f64,
    /// The enclosed volume [m³]; negative if the mesh is inside out, `null` if it is not watertight.
    pub(crate) enclosed: Option<f64>,
    /// What to do if the file seems to be in another unit than metres.
    pub(crate) hint: Option<String>,
    /// The solid that the mesh bounds; `null` if there is none.
    pub(crate) solid: Option<Bounded>,
    /// Why there is no solid.
    pub(crate) error: Option<String>,
}

/// The solid of a mesh.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Bounded {
    /// What the distance to it promises, in words.
    pub(crate) promise: String,
    /// Pairs of triangles that cross.
    pub(crate) crossings: usize,
    /// Pairs of triangles that touch without a common corner.
    pub(crate) touching: usize,
    /// What was found, in words.
    pub(crate) findings: String,
    #[serde(skip)]
    found: Findings<3>,
}

impl Checked {
    fn of(mesh: &TriangleMesh, options: &MeshOptions) -> Self {
        let report = mesh.report();
        let solid = options.solid(mesh);
        let crosses =
            solid.as_ref().is_ok_and(|(_, found)| found.crossings + found.touching > 0);
        let bounded = |(solid, found): (Solid<3, 3>, Findings<3>)| Bounded {
            promise: solid.promise().in_words(),
            crossings: found.crossings,
            touching: found.touching,
            findings: found.to_string(),
            found,
        };
        let (solid, error) = match solid {
            Ok(solid) => (Some(bounded(solid)), None),
            Err(error) => (None, Some(error.to_string())),
        };
        Self {
            name: options.file.display().to_string(),
            ok: report.is_watertight() && report.degenerate == 0 && !crosses,
            elements: report.elements,
            vertices: report.vertices,
            is_watertight: report.is_watertight(),
            boundary: report.boundary,
            non_manifold: report.non_manifold,
            inconsistent: report.inconsistent,
            degenerate: report.degenerate,
            duplicates: report.duplicates,
            unreferenced: report.unreferenced,
            coincident: report.coincident,
            hint: hint(longest_edge(&report.bounds), "--scale", options.scale),
            bounds: report.bounds.into(),
            surface: report.surface,
            enclosed: report.enclosed,
            solid,
            error,
        }
    }
}

impl fmt::Display for Checked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let overlaps = |Bounded { found, .. }: &Bounded| found.crossings + found.nested > 0;
        let overlaps = self.solid.as_ref().is_some_and(overlaps);
        let twice = if overlaps { ": what overlaps is counted twice" } else { "" };
        let verdict = if self.ok { "good" } else { "not good" };
        let (elements, vertices) = (self.elements, self.vertices);
        writeln!(
            f,
            "{}: {verdict}, {elements} triangles, {vertices} vertices",
            shown(&self.name)
        )?;
        let size: Vec<_> = self.bounds.size().into_iter().map(rounded).collect();
        writeln!(f, "  size     {} m", size.join(" × "))?;
        writeln!(f, "  area     {:.6e} m²{twice}", self.surface)?;
        match self.enclosed {
            Some(volume) if volume < 0.0 => {
                writeln!(f, "  volume   {volume:.6e} m³: inside out")?;
            }
            Some(volume) => writeln!(f, "  volume   {volume:.6e} m³{twice}")?,
            None => writeln!(f, "  volume   none: not watertight")?,
        }
        let flaws = [
            (self.boundary, "edges of one triangle only"),
            (self.non_manifold, "edges of more than two triangles"),
            (self.inconsistent, "edges between triangles that disagree on the inside"),
            (self.degenerate, "triangles without area"),
            (self.duplicates, "triangles that repeat an earlier one"),
            (self.unreferenced, "vertices of no triangle"),
            (self.coincident, "vertices at the position of another: --weld joins them"),
        ];
        for (count, what) in flaws.into_iter().filter(|(count, _)| *count > 0) {
            writeln!(f, "  {count:<8} {what}")?;
        }
        if let Some(Bounded { promise, findings, found, .. }) = &self.solid {
            let findings =
                if found.is_clean() { String::new() } else { format!(": {findings}") };
            writeln!(f, "  solid    {promise}{findings}")?;
        }
        if let Some(error) = &self.error {
            writeln!(f, "  solid    none: {error}")?;
        }
        match &self.hint {
            Some(hint) => writeln!(f, "  hint     {hint}"),
            None => Ok(()),
        }
    }
}

impl MeshOptions {
    /// The solid of a mesh, with its corners joined as the options say.
    pub(crate) fn solid(
        &self,
        mesh: &TriangleMesh,
    ) -> Result<(Solid<3, 3>, Findings<3>), SolidError> {
        match self.weld_within {
            None => Solid::from_mesh(mesh),
            Some(within) => Solid::from_mesh_within(mesh, within),
        }
    }
}

/// The mesh of the file, as the options change it.
fn mesh(options: &MeshOptions) -> Result<TriangleMesh, Failure> {
    let mut mesh = read_file(&options.file).map_err(|error| refused(&options.file, &error))?;
    if let Some(scale) = options.scale {
        mesh = mesh.scaled(scale).map_err(|error| Failure::file(&options.file, error))?;
    }
    Ok(if options.weld { mesh.welded() } else { mesh })
}

/// Bytes of a file that tell what it is.
const HEAD: u64 = 1 << 16;

/// Why a file is no mesh: what it is instead, or what is wrong with it.
fn refused(path: &Path, error: &ReadError) -> Failure {
    if path.is_dir() {
        return Failure::file(path, "is a folder; name a file in it");
    }
    if let Some(volume) = as_volume(path) {
        return volume;
    }
    let named = Format::of_input(path);
    let mut head = Vec::new();
    match &error.problem {
        ReadProblem::Unreadable(_) | ReadProblem::TooLarge { .. } => {
            return Failure::input(error);
        }
        // A file that was read can be read again; of one that cannot, the error is told.
        _ => drop(File::open(path).map(|file| file.take(HEAD).read_to_end(&mut head))),
    }
    match Kind::of(&head) {
        Some(kind @ Kind::Mesh(format)) if named != Some(format) => {
            Failure::file(path, format_args!("{kind}; {}", kind.advice(path)))
        }
        None | Some(Kind::Mesh(_)) => Failure::input(error),
        Some(kind) => {
            Failure::file(path, format_args!("{kind}, not a mesh; {}", kind.advice(path)))
        }
    }
}

/// What to do with a volume, if the file has the name of one.
fn as_volume(path: &Path) -> Option<Failure> {
    if !Volume::is_named(path) {
        return None;
    }
    let volume = match Volume::open(path) {
        Ok(volume) => volume,
        Err(error) => return Some(Failure::input(error)),
    };
    let ([least, largest], [x, y, z]) = (volume.range(), volume.counts());
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    Some(Failure::file(
        path,
        format_args!(
            "it is a volume of {x} × {y} × {z} samples from {least} to {largest}, not a mesh; a scene takes \
             a surface in it: {{ \"volume\": {{ \"file\": {}, \"value\": {} }} }}",
            Value::from(file),
            rounded(0.5 * (f64::from(least) + f64::from(largest))),
        ),
    ))
}

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate mesh testdata/meshes/nut.ply
  palpate mesh part.stl --scale 0.001 --json
  palpate mesh scenes/cup.json --tolerance 2e-4 --output cup.stl

Status 1 if the mesh is not watertight, or has triangles without area or that cross; of one
that is written, also if --tolerance is not reached, or a part is known to be lost. A mesh that is
written is closed, faces outwards and keeps edges sharp; what it says of its error is certified.";

/// The options of `palpate mesh`.
#[derive(Args, Debug)]
pub(crate) struct MeshOptions {
    /// The mesh file to check: .obj, .stl, .ply, .glb or .gltf. With --output, the scene or the mesh to make a
    /// mesh of.
    pub(crate) file: PathBuf,
    /// Write the surface of the scene as a mesh; the name ends in .obj, .stl, .ply or .glb.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// The largest distance of a triangle from the surface [m], or size of the field on it where the scene's values are
    /// bounds: triangles are as large as that allows.
    #[arg(long, requires = "output", allow_negative_numbers = true, value_parser = length, conflicts_with = "cell")]
    pub(crate) tolerance: Option<f64>,
    /// The side of the cells in which vertices lie [m]; a hundredth of the scene if left out.
    #[arg(long, requires = "output", allow_negative_numbers = true, value_parser = length)]
    pub(crate) cell: Option<f64>,
    /// More triangles than these are refused.
    #[arg(long, requires = "output", value_name = "COUNT", default_value_t = MOST_TRIANGLES)]
    pub(crate) most_triangles: usize,
    /// Of a scene, one body instead of all.
    #[arg(long, requires = "output", value_name = "NAME")]
    pub(crate) body: Option<String>,
    /// The unit of the file in metres: 0.001 for millimetres.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true, value_parser = length)]
    pub(crate) scale: Option<f64>,
    /// Merge vertices that are exactly equal, as is always done for STL.
    #[arg(long)]
    pub(crate) weld: bool,
    /// Of the solid, join corners at open edges that are at most this far apart [m], where that closes edges. If left
    /// out, those that are equal up to rounding are joined; with 0, those that are exactly equal.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    pub(crate) weld_within: Option<f64>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}
