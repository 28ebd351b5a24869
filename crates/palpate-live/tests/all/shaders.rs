// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shaders against the core: every primitive and every scene that is drawn by its formula, at 4096
//! points, in a browser.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use palpate::field::catalogue::Entry;
use palpate::field::{Shape, Vector};
use palpate::scene::{AnyScene, Scene};
use palpate_live::shader::{Formulas, MOST_OPERATIONS};
use palpate_testkit::cases::entropy;
use serde_json::{Value, json};

/// Points of each formula.
const COUNT: usize = 64 * 64;

/// Steeper fields are drawn from samples: an error of a coordinate is so many times larger.
const STEEPEST: f64 = 4.0;

/// Formulas, points with four coordinates, and the values of the core there.
#[derive(Default)]
struct Cases {
    cases: Vec<Value>,
    points: Vec<f32>,
    values: Vec<f32>,
}

impl Cases {
    fn add<const D: usize>(&mut self, name: &str, bodies: &[Shape<D>], whole: &Shape<D>) {
        let formulas = Formulas::of(bodies).unwrap();
        let shader = formulas.shader(&BTreeSet::new());
        if shader.operations > MOST_OPERATIONS || whole.promise().lipschitz > STEEPEST {
            return;
        }
        let half: Vector<f64, D> =
            whole.promise().bounds.map_or(Vector::constant(1.0), |bounds| {
                let (min, max) = (bounds.aabb.min, bounds.aabb.max);
                Vector(std::array::from_fn(|axis| min[axis].abs().max(max[axis].abs())))
            });
        let size = half.norm();
        let seed = 1000 * self.cases.len() as u64;
        let mut random = (seed..).flat_map(entropy);
        // From −1.5 to 1.5 boxes.
        let mut part = || {
            let bytes = std::array::from_fn(|_| random.next().unwrap_or_default());
            3.0 * f64::from(u32::from_le_bytes(bytes)) / f64::from(u32::MAX) - 1.5
        };
        for _ in 0..COUNT {
            let point: [f32; D] = std::array::from_fn(|axis| (part() * half[axis]) as f32);
            self.points.extend((0..4).map(|axis| point.get(axis).copied().unwrap_or(0.0)));
            self.values.push(whole.distance_f32(Vector(point)));
        }
        self.cases.push(json!({
            "name": name, "glsl": shader.glsl, "dimension": D, "size": size,
        }));
    }

    fn compare(&self) {
        let folder = tempfile::tempdir().unwrap();
        let floats = |name: &str, numbers: &[f32]| {
            let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
            std::fs::write(folder.path().join(name), bytes).unwrap();
        };
        floats("points.f32", &self.points);
        floats("values.f32", &self.values);
        let cases = serde_json::to_vec(&self.cases).unwrap();
        std::fs::write(folder.path().join("cases.json"), cases).unwrap();
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/page/shaders.mjs");
        let status = Command::new("node").arg(script).arg(folder.path()).status().unwrap();
        assert!(status.success(), "shaders and core differ: see above");
    }
}

#[test]
fn shaders_have_the_values_of_the_core() {
    let mut cases = Cases::default();
    for entry in Entry::<2>::ALL {
        let shape = entry.example().unwrap();
        cases.add(entry.name, std::slice::from_ref(&shape), &shape);
    }
    for entry in Entry::<3>::ALL {
        let shape = entry.example().unwrap();
        cases.add(entry.name, std::slice::from_ref(&shape), &shape);
    }
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let files = std::fs::read_dir(scenes).unwrap().map(|file| file.unwrap().path());
    let mut files: Vec<_> = files.filter(|file| file.is_file()).collect();
    files.sort();
    let mut drawn = 0;
    for file in files {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let before = cases.cases.len();
        match Scene::from_file(&file).unwrap().build().unwrap() {
            AnyScene::Planar(scene) => {
                let bodies: Vec<_> = scene.bodies.into_iter().map(|body| body.shape).collect();
                cases.add(&name, &bodies, &scene.whole);
            }
            AnyScene::Spatial(scene) => {
                let bodies: Vec<_> = scene.bodies.into_iter().map(|body| body.shape).collect();
                cases.add(&name, &bodies, &scene.whole);
            }
        }
        drawn += cases.cases.len() - before;
    }
    assert!(drawn >= 15, "{drawn} scenes are drawn by their formulas");
    cases.compare();
}
