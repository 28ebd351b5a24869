// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scenes of `scenes/` that are written by the modules here, and laws on them.

mod gears;
mod sampler;
mod thousand;
mod thread;

use std::path::Path;

use palpate_field::catalogue::Entry;
use palpate_scene::{AnyScene, Scene, schema};

/// Set to write the scenes instead of comparing them.
const RENEW: &str = "PALPATE_RENEW";

/// Compares the scene `name` of the repository with the generated `text`.
fn assert_current(name: &str, text: &str) {
    let scene = Scene::from_json(text).unwrap_or_else(|error| panic!("{name}: {error}"));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
    if std::env::var_os(RENEW).is_some() {
        std::fs::write(&path, scene.to_json()).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == scene.to_json(),
        "scenes/{name} is stale; `cargo xtask renew` renews it"
    );
}

/// `x` with seven decimals, a tenth of a micrometre where it is a length.
///
/// The last bits of sines differ between machines; what is written must not.
fn short(x: f64) -> f64 {
    // The sum makes 0 of −0.
    (x * 1e7).round() / 1e7 + 0.0
}

/// A ring of points as JSON.
fn ring(points: &[[f64; 2]]) -> String {
    let points: Vec<_> =
        points.iter().map(|&[x, y]| format!("[{}, {}]", short(x), short(y))).collect();
    format!("[{}]", points.join(", "))
}

/// Each point of a ring turned by `angle` [rad] from x towards y.
fn turned(points: &[[f64; 2]], angle: f64) -> Vec<[f64; 2]> {
    let (sine, cosine) = angle.sin_cos();
    points.iter().map(|[x, y]| [x * cosine - y * sine, x * sine + y * cosine]).collect()
}

#[test]
fn the_samplers_are_current() {
    assert_current("sampler_plane.json", &sampler::primitives::<2>());
    assert_current("sampler_space.json", &sampler::primitives::<3>());
}

fn sorted(mut names: Vec<&str>) -> Vec<&str> {
    names.sort_unstable();
    names
}

/// Keys of a shape's object that are neither primitive nor operator, or change no shape.
const OTHERS: [&str; 11] = [
    "width",
    "profile",
    "height",
    "progress",
    "of",
    "shape",
    "mesh",
    "volume",
    "grid",
    "bake",
    "description",
];

/// Operators of the sampler in another unit.
const IN_RADIANS: [&str; 2] = ["bend", "twist"];

#[test]
fn the_sampler_of_operators_is_current_and_has_every_operator() {
    let schema = schema();
    let keys = schema["$defs"]["space"]["Shape"]["properties"].as_object().unwrap();
    let known = keys.keys().map(String::as_str).filter(|key| {
        let is_operator = !OTHERS.contains(key) && Entry::<3>::find(key).is_none();
        is_operator && !IN_RADIANS.contains(key)
    });
    let samples = sampler::operator_samples();
    let names = samples.iter().map(|(name, _)| *name).collect();
    assert_eq!(sorted(names), sorted(known.collect()));
    for (name, shape) in &samples {
        assert!(shape.contains(&format!("\"{name}\"")), "{name} is not in its shape");
    }
    assert_current("sampler_operators.json", &sampler::operators());
}

#[test]
fn the_thousand_primitives_are_current() {
    assert_current("thousand.json", &thousand::scene());
}

#[test]
fn the_nut_is_current_and_clear_of_the_bolt() {
    assert_current("nut_on_bolt.json", &thread::scene());
    let AnyScene::Spatial(world) = Scene::from_json(&thread::scene()).unwrap().build().unwrap()
    else {
        panic!("not spatial")
    };
    let (bolt, nut) = (&world.bodies[0].shape, &world.bodies[1].shape);
    let mut both_close = 0;
    for (i, j, k) in grid([60; 3]) {
        let point = [i * 0.04 - 0.02, 0.02 + j * 0.03, k * 0.04 - 0.02];
        let (a, b) = (bolt.distance(point), nut.distance(point));
        assert!(a.max(b) > 0.0, "{point:?} is in both: {a} m and {b} m");
        both_close += usize::from(a.max(b) < thread::CLEARANCE);
    }
    assert!(both_close > 100, "{both_close} points are close to nut and bolt");
    // Right-handed: from the middle of the thread, where a crest is at +x, it turns by
    // −z to −x.
    let out = thread::RADIUS - 1e-5;
    for (quarters, [x, z]) in [[out, 0.0], [0.0, -out], [-out, 0.0]].into_iter().enumerate() {
        let y = thread::MIDDLE + thread::PITCH * quarters as f64 / 4.0;
        assert!(bolt.distance([x, y, z]) < 0.0, "no crest after {quarters} quarters");
        assert!(bolt.distance([-x, y, -z]) > 0.0, "no root after {quarters} quarters");
    }
}

#[test]
fn the_gears_are_current_and_mesh_without_overlap() {
    assert_current("gears.json", &gears::scene());
    let AnyScene::Planar(world) = Scene::from_json(&gears::scene()).unwrap().build().unwrap()
    else {
        panic!("not planar")
    };
    let (pinion, gear) = (&world.bodies[0].shape, &world.bodies[1].shape);
    let mut closest = f64::INFINITY;
    for (i, j, _) in grid([400, 400, 1]) {
        let point = [0.02 + i * 0.02, j * 0.06 - 0.03];
        let (a, b) = (pinion.distance(point), gear.distance(point));
        assert!(a.max(b) > -1e-5, "{point:?} is in both: {a} m and {b} m");
        closest = closest.min(a.max(b));
    }
    assert!(closest < gears::BACKLASH, "the gears are {closest} m apart");
}

/// The points of a grid of the unit cube, so many along each axis; one is at 0.
fn grid([x, y, z]: [usize; 3]) -> impl Iterator<Item = (f64, f64, f64)> {
    let at = |i: usize, side: usize| i as f64 / (side - 1).max(1) as f64;
    (0..x * y * z).map(move |i| (at(i % x, x), at(i / x % y, y), at(i / (x * y), z)))
}
