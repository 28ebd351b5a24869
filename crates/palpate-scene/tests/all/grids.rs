// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes of grid files, and shapes baked into grids.

use palpate_field::{Shape, Vector};
use palpate_grid::{Grid, GridOptions};
use palpate_scene::{AnyScene, BuiltScene, Scene};

fn text(shape: &str) -> String {
    format!(
        r#"{{ "palpate": 1, "dimension": 3, "bodies": [ {{ "name": "a", "shape": {shape} }} ] }}"#
    )
}

fn built(scene: Result<Scene, palpate_scene::SceneError>) -> Result<BuiltScene<3>, String> {
    match scene.and_then(|scene| scene.build()) {
        Ok(AnyScene::Spatial(scene)) => Ok(scene),
        Ok(AnyScene::Planar(_)) => Err("in the plane".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

#[test]
fn a_shape_is_baked_where_the_scene_says_so() {
    let ball = r#"{ "ball": { "radius": 0.05 } }"#;
    for how in [
        r#"{ "tolerance": 1e-3 }"#,
        r#"{ "cell": 0.01, "kernel": "trilinear", "store": "i16", "band": 5 }"#,
    ] {
        let scene = text(&format!(r#"{{ "bake": {how}, "of": {ball} }}"#));
        let scene = built(Scene::from_json(&scene)).unwrap();
        let deviation = scene.whole.promise().deviation.unwrap();
        assert!(deviation.value > 0.0 && deviation.value < 3e-3, "{how}: {deviation:?}");
        assert!((scene.whole.distance(Vector([0.0, 0.06, 0.0])) - 0.01).abs() < 3e-3);
        assert!(scene.whole.promise().in_words().contains("off its source's by at most"));
    }
    let plane = r#"{ "bake": { "tolerance": 1e-3 }, "of": { "half_space": { "normal": [0, 1, 0], "offset": 0 } } }"#;
    for (shape, expected) in [
        (plane, "the shape has no bounds"),
        (
            r#"{ "bake": {}, "of": { "ball": { "radius": 1 } } }"#,
            "bake takes either a tolerance [m] or the size of a cell [m]",
        ),
        (
            r#"{ "bake": { "cell": 0.1, "kernel": "cubic" }, "of": { "ball": { "radius": 1 } } }"#,
            "kernel must be one of \"quadratic\", \"trilinear\", got \"cubic\"",
        ),
        (
            r#"{ "bake": { "cell": 1e-9 }, "of": { "ball": { "radius": 1 } } }"#,
            "more than the 33554432 allowed",
        ),
        (r#"{ "bake": { "cell": -1 }, "of": { "ball": { "radius": 1 } } }"#, "cell must be"),
        (
            r#"{ "bake": { "cell": 0.1 }, "of": { "ball": { "radius": -1 } } }"#,
            "radius must be",
        ),
    ] {
        let error = built(Scene::from_json(&text(shape))).unwrap_err();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn a_grid_is_looked_for_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let grid =
        Grid::bake(&Shape::sphere(0.05).unwrap(), &GridOptions::with_cell(0.01)).unwrap();
    grid.save(folder.path().join("ball.grid")).unwrap();
    let read = |shape: &str| built(Scene::from_json_in(&text(shape), folder.path()));
    let scene = read(r#"{ "grid": { "file": "ball.grid" } }"#).unwrap();
    assert_eq!(scene.whole.promise().lipschitz, grid.promise().lipschitz);
    std::fs::write(folder.path().join("bad.grid"), "no grid").unwrap();
    for (file, expected) in [
        ("gone.grid", "gone.grid: "),
        ("../ball.grid", "a grid is a file in the scene's folder or below it"),
        ("bad.grid", "bad.grid: it is no grid of this version of palpate"),
    ] {
        let error = read(&format!(r#"{{ "grid": {{ "file": "{file}" }} }}"#)).unwrap_err();
        assert!(error.contains(expected), "{error}");
    }
}
