// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate grid`, and meshes of scenes by `palpate mesh --output`.

use std::path::Path;

use crate::common::{Folder, errors, json, number, palpate, program, status, text};

const BALL: &str = r#"{ "palpate": 1, "dimension": 3, "bodies": [
  { "name": "ball", "shape": { "ball": { "radius": 0.05 } } },
  { "name": "block", "shape": { "translate": [0.2, 0, 0],
    "of": { "cuboid": { "size": [0.06, 0.06, 0.06] } } } } ] }"#;

/// Runs a command that must fail with status 2 and say this among other things.
fn refuses(arguments: &[&str], said: &str) {
    let output = palpate(arguments);
    assert!(errors(&output).contains(said), "{}", errors(&output));
    assert_eq!((status(&output), text(&output).as_str()), (2, ""), "{arguments:?}");
}

#[test]
fn a_grid_is_made_and_used() {
    let folder = Folder::new();
    let (scene, grid) = (folder.write("ball.json", BALL), folder.name("ball.grid"));
    let made = json(&[
        "grid",
        &scene,
        "--body",
        "ball",
        "--tolerance",
        "1e-3",
        "--output",
        &grid,
        "--json",
    ]);
    assert!(number(&made["deviation"]) <= 1e-3, "{made}");
    let used = r#"{ "palpate": 1, "dimension": 3, "bodies": [
      { "name": "baked", "shape": { "grid": { "file": "ball.grid" } } } ] }"#;
    let used = folder.write("used.json", used);
    let said = text(&palpate(&["check", &used]));
    assert!(said.contains("off its source's by at most"), "{said}");
    let at = json(&["eval", &used, "--at", "0,0.06,0", "--json"]);
    assert!((number(&at["distance"]) - 0.01).abs() <= 1e-3, "{at}");
    let felt = palpate(&["feel", &used, "--fast", "--duration", "1"]);
    assert_eq!(status(&felt), 0, "{}", text(&felt));
    // A grid of both bodies takes a band.
    let said = palpate(&["grid", &scene, "--cell", "0.004", "--band", "5", "--output", &grid]);
    assert!(text(&said).contains("quadratic, f32"), "{}", text(&said));
    let disc = folder.write("disc.json", &crate::common::disc(0.05));
    let flat = folder.name("disc.grid");
    let said = palpate(&["grid", &disc, "--cell", "0.004", "--output", &flat]);
    assert_eq!(status(&said), 0);
    refuses(&["grid", &scene, "--cell", "0.004", "--output", &scene], "ball.json");
    refuses(&["grid", &scene, "--output", &grid], "--tolerance");
    let long = ["grid", &scene, "--tolerance", "1e-9", "--output", &grid];
    refuses(&long, "more than the 67108864 nodes allowed");
}

#[test]
fn a_mesh_is_made_of_a_scene_and_is_good() {
    let folder = Folder::new();
    let scene = folder.write("ball.json", BALL);
    for ending in ["stl", "obj", "ply", "glb"] {
        let mesh = folder.name(&format!("ball.{ending}"));
        let made = json(&["mesh", &scene, "--cell", "0.0031", "--output", &mesh, "--json"]);
        assert_eq!(made["ok"], true, "{made}");
        let checked = palpate(&["mesh", &mesh]);
        assert_eq!(status(&checked), 0, "{}", text(&checked));
    }
    let (mesh, again) = (folder.name("ball.ply"), folder.name("again.ply"));
    let made = text(&palpate(&[
        "mesh",
        &scene,
        "--body",
        "ball",
        "--tolerance",
        "1e-4",
        "--output",
        &mesh,
    ]));
    assert!(made.contains("closed, none cross"), "{made}");
    assert!(made.contains("every triangle is within"), "{made}");
    let made = palpate(&["mesh", &mesh, "--cell", "0.004", "--output", &again]);
    assert_eq!(status(&made), 0, "{}", text(&made));
    refuses(&["mesh", &mesh, "--output", &mesh], "ball.ply");
    refuses(&["mesh", &scene, "--output", &folder.name("ball.txt")], ".glb");
    let disc = folder.write("disc.json", &crate::common::disc(0.05));
    refuses(&["mesh", &disc, "--output", &mesh], "dimension");
}

/// The scenes of a scan and of a volume are checked, felt and asked. A scene named alone, in its own folder, once
/// found none of its files.
#[test]
fn what_was_scanned_is_checked_and_felt() {
    let scans = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/scans");
    let folder = Folder::new();
    for file in ["bunny.json", "bunny.ply", "bone.json", "bone.nrrd"] {
        std::fs::copy(scans.join(file), folder.path(file)).unwrap();
    }
    let good = folder.run(&["check", "bunny.json"]);
    let bunny = "3674 faces, 0.07926 × 0.07726 × 0.06032 m";
    assert!(text(&good).contains(bunny), "{}{}", text(&good), errors(&good));
    let bone = folder.run(&["check", "bone.json"]);
    assert!(text(&bone).contains("bone.nrrd at 300"), "{}{}", text(&bone), errors(&bone));
    let felt = ["feel", "bone.json", "--fast", "--duration", "1", "--cell", "0.002", "--json"];
    let felt = text(&folder.run(&felt));
    let felt: serde_json::Value = serde_json::from_str(&felt).unwrap();
    assert_eq!(felt["as_grids"][0]["name"], "bone", "{felt}");
    assert!(number(&felt["as_grids"][0]["deviation"]) < 2e-3, "{felt}");
    let exact = ["feel", "bunny.json", "--fast", "--duration", "1", "--exact"];
    assert!(!text(&folder.run(&exact)).contains("as a grid"));
}

#[test]
fn grids_of_scenes_are_kept_from_run_to_run() {
    let folder = Folder::new();
    let scene = r#"{ "palpate": 1, "dimension": 2, "bodies": [ { "name": "disc",
      "shape": { "bake": { "cell": 0.002 }, "of": { "ball": { "radius": 0.05 } } } } ] }"#;
    folder.write("disc.json", scene);
    let check = |kept: &str| {
        let mut check = program(&["check", "disc.json"]);
        let output = check.current_dir(folder.path("")).env("PALPATE_CACHE", kept).output();
        assert_eq!(status(&output.unwrap()), 0);
    };
    let kept = folder.name("kept");
    check(&kept);
    let grid = std::fs::read_dir(&kept).unwrap().next().unwrap().unwrap().path();
    let made = std::fs::read(&grid).unwrap();
    check(&kept);
    assert_eq!(std::fs::read(&grid).unwrap(), made);
    // A damaged file is made anew.
    std::fs::write(&grid, &made[..made.len() / 2]).unwrap();
    check(&kept);
    assert_eq!(std::fs::read(&grid).unwrap(), made);
    // A folder that cannot be made keeps nothing from being checked.
    check(&folder.name("disc.json/kept"));
}
