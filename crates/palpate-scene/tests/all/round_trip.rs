// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Writing and reading back is the identity.

use crate::random::{Generator, Known, known, written};
use arbtest::arbtest;
use palpate_field::Shape;
use palpate_field::catalogue::Entry;
use palpate_scene::{AnyScene, Dimension, Scene, SceneError, WrittenBody, schema};

/// Set to write the scenes as they should be instead of comparing them.
const RENEW: &str = "PALPATE_RENEW";

#[test]
fn every_scene_of_the_repository_is_written_as_it_is() {
    for (name, text) in crate::common::files("scenes") {
        let scene = Scene::from_json(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(scene.description.is_some(), "{name} does not say what it shows");
        if std::env::var_os(RENEW).is_some() {
            std::fs::write(
                crate::common::repository().join("scenes").join(name),
                scene.to_json(),
            )
            .unwrap();
            continue;
        }
        assert!(
            scene.to_json() == text,
            "{name} is not as `Scene::to_json` writes it; `cargo xtask renew` renews it"
        );
    }
}

/// The paths and problems of an error, sorted.
fn told(error: &SceneError) -> Vec<(&str, &str)> {
    let mut told: Vec<_> =
        error.problems().map(|p| (p.path.as_str(), p.problem.as_str())).collect();
    told.sort_unstable();
    told
}

#[test]
fn random_scenes_come_back_and_are_judged_alike() {
    let generator = Generator::new();
    let validator = jsonschema::validator_for(&schema()).unwrap();
    let (mut built, mut seen) = (0, 0);
    arbtest(|u| {
        let scene = generator.scene(u)?;
        let text = scene.to_json();
        // Through plain serde, without checks.
        assert_eq!(serde_json::from_str::<Scene>(&text).unwrap(), scene, "{text}");
        seen += 1;
        match (scene.build(), Scene::from_json(&text)) {
            (Ok(_), again) => {
                assert_eq!(again.as_ref(), Ok(&scene), "{text}");
                assert_eq!(again.unwrap().to_json(), text);
                if let Err(error) = validator.validate(&serde_json::from_str(&text).unwrap()) {
                    panic!("the schema refuses {}: {error}\n{text}", error.instance_path());
                }
                built += 1;
            }
            (Err(error), Ok(_)) => panic!("refused as data, taken as a file: {error}\n{text}"),
            (Err(error), Err(located)) => {
                assert_eq!(told(&error), told(&located), "{text}");
                assert!(located.problems().all(|p| p.line > 0 && p.column > 0), "{located}");
            }
        }
        Ok(())
    })
    .budget_ms(2000);
    assert!(3 * built > seen, "only {built} of {seen} scenes could be built");
}

/// A scene with one primitive.
fn alone(known: &Known, dimension: Dimension) -> Scene {
    let mut scene = Scene::new(dimension);
    let shape = written(&known.object().into());
    scene.bodies.push(WrittenBody::new("alone", shape));
    scene
}

#[test]
fn every_primitive_comes_back_as_the_same_field() {
    let samples: Vec<[f64; 3]> = (0..500)
        .map(|i| {
            let turn = |step: f64| (f64::from(i) * step).fract() * 3.0 - 1.5;
            [turn(0.618_034), turn(0.414_214), turn(0.732_051)]
        })
        .collect();
    let check = |name: &str, ours: &dyn Fn(usize) -> f64, theirs: &dyn Fn(usize) -> f64| {
        for (i, sample) in samples.iter().enumerate() {
            let (a, b) = (ours(i), theirs(i));
            // Angles pass through degrees; everything else keeps its bits.
            assert!((a - b).abs() <= 1e-12, "{name} at {sample:?}: {a}, not {b}");
        }
    };
    for (entry, known) in Entry::<2>::ALL.iter().zip(known(Entry::<2>::ALL)) {
        let scene = Scene::from_json(&alone(&known, Dimension::Two).to_json()).unwrap();
        let AnyScene::Planar(world) = scene.build().unwrap() else { panic!("not planar") };
        let shape: Shape<2> = entry.build(&known.arguments).unwrap();
        let at = |shape: &Shape<2>, i: usize| shape.distance([samples[i][0], samples[i][1]]);
        check(known.name, &|i| at(&world.whole, i), &|i| at(&shape, i));
    }
    for (entry, known) in Entry::<3>::ALL.iter().zip(known(Entry::<3>::ALL)) {
        let scene = Scene::from_json(&alone(&known, Dimension::Three).to_json()).unwrap();
        let AnyScene::Spatial(world) = scene.build().unwrap() else { panic!("not spatial") };
        let shape: Shape<3> = entry.build(&known.arguments).unwrap();
        let at = |shape: &Shape<3>, i: usize| shape.distance(samples[i]);
        check(known.name, &|i| at(&world.whole, i), &|i| at(&shape, i));
    }
}

#[test]
fn the_scenes_are_finite_everywhere_on_a_grid() {
    fn grid<const D: usize>(name: &str, whole: &Shape<D>) {
        let bounds = whole.promise().bounds.expect("the scenes are bounded").aabb;
        let side: usize = if D == 2 { 64 } else { 21 };
        let mut inside = 0;
        for i in 0..side.pow(D as u32) {
            let point = std::array::from_fn(|axis| {
                let step = (i / side.pow(axis as u32) % side) as f64 / (side - 1) as f64;
                // Half as wide again as the scene.
                let extent = bounds.max[axis] - bounds.min[axis];
                bounds.min[axis] + extent * (1.5 * step - 0.25)
            });
            let (distance, gradient) = whole.distance_gradient(point);
            assert!(distance.is_finite() && gradient.is_finite(), "{name} at {point:?}");
            inside += usize::from(distance < 0.0);
        }
        assert!(inside > 10, "{name} has {inside} points inside");
    }
    for (name, text) in crate::common::files("scenes") {
        match Scene::from_json(&text).unwrap().build().unwrap() {
            AnyScene::Planar(world) => grid(&name, &world.whole),
            AnyScene::Spatial(world) => grid(&name, &world.whole),
        }
    }
}
