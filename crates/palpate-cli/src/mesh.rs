// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate mesh`: checks a mesh file, or makes one of a scene.

mod contour;

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

use palpate::grid::Volume;
use palpate::mesh::{Format, ReadError, ReadProblem, Report, Solid, TriangleMesh, read_file};
use serde_json::json;

use crate::arguments::MeshOptions;
use crate::input::longest_edge;
use crate::interrupt::Interrupt;
use crate::kind::Kind;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, shown};
use crate::units::hint;
use palpate::scene::text::rounded;

/// Reports on a mesh; the answer is no if it is not watertight or has degenerate triangles.
pub(crate) fn run(options: &MeshOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    if let Some(output) = &options.output {
        return contour::run(options, output, interrupt);
    }
    let mesh = mesh(options)?;
    let report = mesh.report();
    let solid = Solid::from_mesh(&mesh);
    let crosses = solid.as_ref().is_ok_and(|(_, found)| found.crossings + found.touching > 0);
    let overlaps = solid.as_ref().is_ok_and(|(_, found)| found.crossings + found.nested > 0);
    let is_good = report.is_watertight() && report.degenerate == 0 && !crosses;
    let mut out = output::answer();
    let hint = hint(longest_edge(&report.bounds), "--scale", options.scale);
    if options.json {
        let mut answer = as_json(&report, is_good);
        answer["hint"] = hint.into();
        answer["solid"] = match &solid {
            Ok((solid, found)) => json!({
                "promise": solid.promise().in_words(),
                "crossing_pairs": found.crossings,
                "touching_pairs": found.touching,
                "findings": found.to_string(),
            }),
            Err(error) => json!({ "error": error.to_string() }),
        };
        out.json(&answer)?;
    } else {
        let name = options.file.display().to_string();
        let verdict = if is_good { "good" } else { "not good" };
        writeln!(out, "{}: {verdict}, {}", shown(&name), in_words(&report, overlaps))?;
        match &solid {
            Ok((solid, found)) => {
                let separator = if found.is_clean() { "" } else { ": " };
                let found = if found.is_clean() { String::new() } else { found.to_string() };
                writeln!(out, "  solid    {}{separator}{found}", solid.promise().in_words())?;
            }
            Err(error) => writeln!(out, "  solid    none: {error}")?,
        }
        if let Some(hint) = hint {
            writeln!(out, "  hint     {hint}")?;
        }
    }
    Ok(if is_good { Outcome::Yes } else { Outcome::No })
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
    let named = Format::of(path);
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
            json!(file),
            rounded(0.5 * (f64::from(least) + f64::from(largest))),
        ),
    ))
}

fn as_json(report: &Report<3>, is_good: bool) -> serde_json::Value {
    json!({
        "ok": is_good,
        "triangles": report.elements,
        "vertices": report.vertices,
        "watertight": report.is_watertight(),
        "boundary_edges": report.boundary,
        "non_manifold_edges": report.non_manifold,
        "inconsistent_edges": report.inconsistent,
        "degenerate_triangles": report.degenerate,
        "duplicate_triangles": report.duplicates,
        "unreferenced_vertices": report.unreferenced,
        "coincident_vertices": report.coincident,
        "bounds": { "min_m": report.bounds.min.0, "max_m": report.bounds.max.0 },
        "area_m2": report.surface,
        "volume_m3": report.enclosed,
    })
}

fn in_words(report: &Report<3>, overlaps: bool) -> String {
    let size = (report.bounds.half_extents() * 2.0).0.map(rounded);
    let twice = if overlaps { ": what overlaps is counted twice" } else { "" };
    let mut words = format!(
        "{} triangles, {} vertices\n  size     {} m\n  area     {:.6e} m²{twice}\n",
        report.elements,
        report.vertices,
        size.join(" × "),
        report.surface,
    );
    words += &match report.enclosed {
        Some(volume) if volume < 0.0 => format!("  volume   {volume:.6e} m³: inside out"),
        Some(volume) => format!("  volume   {volume:.6e} m³{twice}"),
        None => "  volume   none: not watertight".to_owned(),
    };
    let flaws = [
        (report.boundary, "edges of one triangle only"),
        (report.non_manifold, "edges of more than two triangles"),
        (report.inconsistent, "edges between triangles that disagree on the inside"),
        (report.degenerate, "triangles without area"),
        (report.duplicates, "triangles that repeat an earlier one"),
        (report.unreferenced, "vertices of no triangle"),
        (report.coincident, "vertices at the position of another: --weld joins them"),
    ];
    for (count, what) in flaws.into_iter().filter(|(count, _)| *count > 0) {
        words += &format!("\n  {count:<8} {what}");
    }
    words
}
