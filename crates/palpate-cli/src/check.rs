// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate check`: checks a scene file.

use std::io::Write;

use palpate::field::Shape;
use palpate::mesh::Findings;
use palpate::scene::{AnyScene, BuiltMesh, Scene, SceneProblem};
use serde_json::{Value, json};

use crate::arguments::CheckOptions;
use crate::emptiness::is_empty;
use crate::input::{Bakes, bytes, folder, other_than_scene};
use crate::outcome::{Failure, Outcome};
use crate::output::{self, counted, shown};

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
                writeln!(
                    out,
                    "{name}: good, {dimension}D, {}",
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
                    let found = if mesh.findings.is_clean() {
                        "closed, and no faces cross".to_owned()
                    } else {
                        mesh.findings.to_string()
                    };
                    let size = mesh
                        .shape
                        .promise()
                        .bounds
                        .map(|bounds| bounds.aabb.half_extents() * 2.0);
                    let size =
                        size.map(|size| size.0.map(|side| format!("{side:.4}")).join(" × "));
                    let at =
                        mesh.value.map_or_else(String::new, |value| format!(" at {value}"));
                    writeln!(
                        out,
                        "  {}{at}: {}, {} m: {found}",
                        shown(&mesh.file),
                        counted(mesh.findings.faces, "face", "faces"),
                        size.unwrap_or_default(),
                    )?;
                }
            }
            Ok(Outcome::Yes)
        }
    }
}

/// A mesh of the scene.
fn of_mesh(mesh: &BuiltMesh) -> Value {
    let Findings { faces, welded, degenerate, duplicates, turned, inside_out, .. } =
        mesh.findings;
    let findings = &mesh.findings;
    let openings: Vec<_> = findings
        .openings
        .iter()
        .map(|opening| json!({ "place_m": opening.place.0, "size_m": opening.size, "edges": opening.edges }))
        .collect();
    json!({
        "file": mesh.file,
        "scale": mesh.scale,
        "value": mesh.value,
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
