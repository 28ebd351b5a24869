// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate check`: checks a scene file.

use std::io::{self, Write};

use palpate::field::{Shape, Vector};
use palpate::mesh::Findings;
use palpate::scene::{AnyScene, BuiltMesh, Samples, Scene, SceneProblem, is_empty};
use serde_json::{Value, json};

use crate::arguments::CheckOptions;
use crate::input::{Bakes, bytes, folder, longest_edge, other_than_scene};
use crate::outcome::{Failure, Outcome};
use crate::output::{self, counted, shown};
use crate::units::hint;
use palpate::scene::text::rounded;

pub(crate) fn run(options: &CheckOptions) -> Result<Outcome, Failure> {
    let bytes = bytes(&options.scene)?;
    let mut out = output::answer();
    let name = options.scene.display().to_string();
    let name = shown(&name);
    let bakes = Bakes::new(Some(folder(&options.scene)));
    let built = Scene::from_bytes_in(&bytes, bakes.resources.clone());
    match built.and_then(|scene| scene.build()) {
        Err(error) => {
            let other = other_than_scene(&options.scene, &bytes);
            if options.json {
                let problems: Vec<_> = match &other {
                    Some(other) => {
                        vec![json!({ "path": "", "line": 0, "column": 0, "problem": other })]
                    }
                    None => error.problems().map(told).collect(),
                };
                let more = other.is_none() && !error.is_all();
                out.json(&json!({ "ok": false, "problems": problems, "maybe_more": more }))?;
            } else {
                writeln!(out, "{name}: {}", other.unwrap_or_else(|| error.to_string()))?;
            }
            Ok(Outcome::No)
        }
        Ok(world) => {
            let (dimension, bodies) = match &world {
                AnyScene::Planar(scene) => (2, described(&scene.bodies)),
                AnyScene::Spatial(scene) => (3, described(&scene.bodies)),
            };
            let meshes = match &world {
                AnyScene::Planar(scene) => &scene.meshes,
                AnyScene::Spatial(scene) => &scene.meshes,
            };
            if options.json {
                let meshes: Vec<_> = meshes.iter().map(of_mesh).collect();
                let answer = json!({
                    "ok": true, "dimension": dimension, "bodies": bodies, "meshes": meshes,
                });
                out.json(&answer)?;
            } else {
                let is_mended =
                    |mesh: &&BuiltMesh| mesh.thickness.is_none() && !mesh.findings.is_clean();
                let mended = match meshes.iter().filter(is_mended).count() {
                    0 => String::new(),
                    count => {
                        let files = counted(count, "mesh is", "meshes are");
                        format!("; {files} used as mended, and not good alone")
                    }
                };
                writeln!(
                    out,
                    "{name}: good, {dimension}D, {}{mended}",
                    counted(bodies.len(), "body", "bodies")
                )?;
                for body in &bodies {
                    let text = |key: &str| body[key].as_str().unwrap_or_default().to_owned();
                    let empty = match body["empty"].as_bool() {
                        Some(false) => "",
                        Some(true) => "; empty: no point is in it, which is proven",
                        None => "; may be empty: no point was found in it",
                    };
                    writeln!(out, "  {}: {}{empty}", shown(&text("name")), text("promise"))?;
                }
                for mesh in meshes {
                    write_mesh(&mut out, mesh)?;
                }
            }
            Ok(Outcome::Yes)
        }
    }
}

/// Says what a file of a mesh or of a volume holds.
fn write_mesh(out: &mut impl Write, mesh: &BuiltMesh) -> io::Result<()> {
    let found = match mesh.thickness {
        Some(thickness) => format!("a plate {thickness} m thick"),
        None if mesh.findings.is_clean() => "closed, and no faces cross".to_owned(),
        None => mesh.findings.to_string(),
    };
    let grid = mesh.grid.as_ref().map_or_else(String::new, |grid| format!(", {}", shown(grid)));
    let at = mesh.value.map_or_else(String::new, |value| format!(" at {value}"));
    let faces = counted(mesh.findings.faces, "face", "faces");
    let bounds = mesh.shape.promise().bounds.map(|bounds| bounds.aabb);
    let size = bounds.map_or([0.0; 3], |aabb| (aabb.half_extents() * 2.0).0);
    let size = size.map(rounded).join(" × ");
    let name = mesh.file.as_deref().map_or("a mesh".into(), shown);
    writeln!(out, "  {name}{grid}{at}: {faces}, {size} m: {found}")?;
    if let Some(samples) = &mesh.samples {
        let Samples { counts, range: [least, largest], .. } = samples;
        let steps = samples.steps.map(|step| rounded(step.norm() * mesh.scale)).join(" × ");
        writeln!(
            out,
            "    samples  {} from {least} to {largest}, {steps} m apart along {}",
            counts.map(|count| count.to_string()).join(" × "),
            samples.steps.map(direction).join(", "),
        )?;
        if samples.cut_off {
            let cut = "their border cuts the body off: it is closed half a sample beyond";
            writeln!(out, "    border   {cut}")?;
        }
        if let Some(aabb) = bounds {
            let [min, max] = [aabb.min, aabb.max].map(|p| p.0.map(rounded).join(", "));
            writeln!(out, "    surface  from ({min}) to ({max}) m")?;
        }
    }
    if let Some(hint) = unit_hint(mesh) {
        writeln!(out, "    hint     {hint}")?;
    }
    Ok(())
}

/// The direction of an axis of a volume.
fn direction(step: Vector<f64, 3>) -> String {
    let along = step * (1.0 / step.norm());
    let axis = (0..3).find(|i| along[*i].abs() > 1.0 - 1e-6);
    match axis {
        Some(i) => format!("{}{}", if along[i] < 0.0 { "-" } else { "" }, ["x", "y", "z"][i]),
        None => format!("({})", along.0.map(rounded).join(", ")),
    }
}

/// What to do if the size of a mesh, or of a volume without a head that tells lengths, is that of another unit.
pub(crate) fn unit_hint(mesh: &BuiltMesh) -> Option<String> {
    let aabb = mesh.shape.promise().bounds?.aabb;
    // A factor of one may have been left out.
    let scale = Some(mesh.scale).filter(|scale| (scale - 1.0).abs() > 0.0);
    let file = mesh.file.as_ref()?;
    let is_without_unit = mesh.samples.is_none() || file.to_ascii_lowercase().ends_with(".npy");
    is_without_unit.then(|| hint(longest_edge(&aabb), "\"scale\":", scale)).flatten()
}

/// A mesh of the scene.
fn of_mesh(mesh: &BuiltMesh) -> Value {
    let Findings { faces, welded, degenerate, duplicates, turned, inside_out, .. } =
        mesh.findings;
    let findings = &mesh.findings;
    let openings: Vec<_> = findings
        .openings
        .iter()
        .map(|opening| json!({ "place_m": opening.place.0, "size_m": opening.size, "doubtful_m": opening.doubtful, "edges": opening.edges }))
        .collect();
    json!({
        "file": mesh.file,
        "scale": mesh.scale,
        "grid": mesh.grid,
        "value": mesh.value,
        "thickness_m": mesh.thickness,
        "faces": faces,
        "welded": welded,
        "degenerate": degenerate,
        "duplicates": duplicates,
        "turned": turned,
        "inside_out": inside_out,
        "nested": findings.nested,
        "parted": findings.parted,
        "inner": findings.inner,
        "openings": openings,
        "crowded_edges": findings.crowded_rims,
        "crossing_pairs": findings.crossings,
        "touching_pairs": findings.touching,
        "first_crossing_m": findings.crossing_at.map(|at| at.0),
        "samples": mesh.samples.map(|samples| json!({
            "counts": samples.counts,
            "range": samples.range,
            "cut_off": samples.cut_off,
            "origin_m": samples.origin.0,
            "steps_m": samples.steps.map(|step| step.0),
        })),
        "hint": unit_hint(mesh),
    })
}

fn told(problem: &SceneProblem) -> Value {
    json!({
        "path": problem.path,
        "line": problem.line,
        "column": problem.column,
        "problem": problem.problem,
    })
}

fn described<const D: usize>(bodies: &[palpate::scene::BuiltBody<D>]) -> Vec<Value> {
    bodies
        .iter()
        .map(|body| {
            json!({
                "name": body.name,
                "promise": body.shape.promise().in_words(),
                "lipschitz": body.shape.promise().lipschitz,
                "bounds": bounds(&body.shape),
                "depth": body.shape.depth(),
                "empty": is_empty(&body.shape_in_body),
            })
        })
        .collect()
}

fn bounds<const D: usize>(shape: &Shape<D>) -> Value {
    match shape.promise().bounds {
        None => Value::Null,
        Some(bounds) => json!({
            "min_m": bounds.aabb.min.0.to_vec(),
            "max_m": bounds.aabb.max.0.to_vec(),
        }),
    }
}
