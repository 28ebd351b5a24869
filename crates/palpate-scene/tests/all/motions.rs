// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where motions take the bodies of a scene.

use std::f64::consts::PI;

use palpate_field::Vector;
use palpate_scene::{AnyScene, BuiltScene, Scene};

use crate::common::repository;
use crate::refusal::Schema::{Accepts, Refuses};
use crate::refusal::check_all;

/// A scene of two balls, `a` at (1, 0, 0) and `b` at the origin, with these motions.
fn scene(motions: &str) -> BuiltScene<3> {
    let AnyScene::Spatial(scene) = Scene::from_json(&text(motions)).unwrap().build().unwrap()
    else {
        panic!("dimension is 3")
    };
    scene
}

fn text(motions: &str) -> String {
    format!(
        r#"{{ "palpate": 1, "dimension": 3,
             "bodies": [
               {{ "name": "a", "shape": {{ "ball": {{ "radius": 0.5 }} }},
                  "pose": {{ "translation": [1, 0, 0] }} }},
               {{ "name": "b", "shape": {{ "ball": {{ "radius": 0.25 }} }} }} ],
             "motions": [{motions}] }}"#
    )
}

/// The x coordinate of a body at these times.
fn x<const N: usize>(scene: &BuiltScene<3>, body: usize, times: [f64; N]) -> [f64; N] {
    times.map(|time| scene.pose_at(body, time).translation[0])
}

#[test]
fn a_body_rests_before_its_motion_and_after_it() {
    let scene = scene(
        r#"{ "body": "b", "to": { "translation": [2, 0, 0] }, "start": 1, "duration": 4 }"#,
    );
    let times = [-1.0, 0.0, 1.0, 2.0, 3.0, 5.0, 100.0];
    assert_eq!(x(&scene, 1, times), [0.0, 0.0, 0.0, 0.5, 1.0, 2.0, 2.0]);
    assert_eq!(x(&scene, 0, times), [1.0; 7]);
    assert_eq!(scene.motions[0].end(), Some(5.0));
    assert_eq!(scene.moving().collect::<Vec<_>>(), [1]);
}

#[test]
fn of_the_motions_of_a_body_the_one_that_began_last_holds() {
    // In the file the later one comes first; the earlier one goes on behind it.
    let motions = r#"
        { "body": "b", "from": { "translation": [5, 0, 0] }, "to": { "translation": [6, 0, 0] },
          "start": 2, "duration": 2 },
        { "body": "b", "to": { "translation": [4, 0, 0] }, "duration": 4 },
        { "body": "a", "to": { "translation": [1, 2, 0] }, "start": 3 }"#;
    let scene = scene(motions);
    assert_eq!(x(&scene, 1, [0.0, 1.0, 1.5, 2.0, 3.0, 9.0]), [0.0, 1.0, 1.5, 5.0, 5.5, 6.0]);
    assert_eq!(scene.pose_at(0, 3.5).translation.0, [1.0, 1.0, 0.0]);
    assert_eq!(scene.moving().collect::<Vec<_>>(), [1, 0]);
}

#[test]
fn of_motions_that_begin_together_the_last_of_the_file_holds() {
    let motions = r#"
        { "body": "b", "to": { "translation": [4, 0, 0] }, "start": 1 },
        { "body": "b", "to": { "translation": [8, 0, 0] }, "start": 1 }"#;
    assert_eq!(x(&scene(motions), 1, [1.5, 2.0]), [4.0, 8.0]);
}

#[test]
fn a_loop_begins_again_and_back_and_forth_returns() {
    let moved = |repeat: &str| {
        scene(&format!(
            r#"{{ "body": "b", "to": {{ "translation": [2, 0, 0] }}, "start": 1, "duration": 2,
                 "repeat": "{repeat}" }}"#
        ))
    };
    let times = [0.5, 1.0, 2.0, 2.5, 3.0, 3.5, 5.0, 6.0];
    let again = moved("loop");
    assert_eq!(x(&again, 1, times), [0.0, 0.0, 1.0, 1.5, 0.0, 0.5, 0.0, 1.0]);
    let back = moved("back_and_forth");
    assert_eq!(x(&back, 1, times), [0.0, 0.0, 1.0, 1.5, 2.0, 1.5, 0.0, 1.0]);
    assert_eq!((again.motions[0].end(), back.motions[0].end()), (None, None));
}

#[test]
fn a_scene_at_a_time_has_its_bodies_and_their_union_there() {
    let scene = scene(r#"{ "body": "b", "to": { "translation": [0, 8, 0] }, "duration": 2 }"#);
    let later = scene.at(1.0).unwrap();
    assert_eq!(later.bodies[1].world_from_body.translation.0, [0.0, 4.0, 0.0]);
    for point in [[0.0, 4.5, 0.0], [0.1, 2.0, 0.3], [1.0, 0.7, 0.0]] {
        let expected = [Vector([1.0, 0.0, 0.0]), Vector([0.0, 4.0, 0.0])];
        let [a, b] = expected.map(|centre| (Vector(point) - centre).norm());
        assert_eq!(later.bodies[0].shape.distance(point), a - 0.5);
        assert_eq!(later.whole.distance(point), (a - 0.5).min(b - 0.25));
    }
    // Its motions go on from there as before.
    assert_eq!(later.at(0.0).unwrap().whole.distance([0.0, 1.0, 0.0]), 0.75);
    assert_eq!(later.pose_at(1, 2.0), scene.pose_at(1, 2.0));
}

#[test]
fn whole_turns_go_around_the_way() {
    let scene = scene(
        r#"{ "body": "b", "to": { "translation": [0, 2, 0] }, "turns": 3, "duration": 3 }"#,
    );
    let half = scene.pose_at(1, 0.5);
    let turned = half.rotation.rotate(Vector([1.0, 0.0, 0.0]));
    assert!((turned - Vector([-1.0, 0.0, 0.0])).norm() < 1e-14, "{turned:?}");
    assert!((half.translation - Vector([0.0, 1.0 / 3.0, 0.0])).norm() < 1e-15);
    assert!((scene.motions[0].screw.angle() - 6.0 * PI).abs() < 1e-14);
}

#[test]
fn a_wrong_motion_is_refused_with_its_place() {
    check_all(
        &[
            (
                r#"{ "body": "c", "to": {} }"#,
                "motions[0].body, line 6: unknown body `c`; known are `a` and `b`",
                Accepts,
            ),
            (
                r#"{ "body": "a", "to": {} }, { "body": "a", "to": {}, "start": -1 }"#,
                "motions[1].start, line 6: start must be zero or more, got -1 s",
                Refuses,
            ),
            (
                r#"{ "body": "a", "to": { "translation": [0, 0] } }"#,
                "motions[0].to.translation, line 6: translation must have 3 numbers in 3D, got 2",
                Refuses,
            ),
            (
                r#"{ "body": "a", "to": {}, "from": { "rotate_degrees": 3 } }"#,
                "motions[0].from.rotate_degrees, line 6: rotate_degrees must be an object with `axis` and `angle` in 3D, got a number",
                Refuses,
            ),
            (
                r#"{ "body": "a", "to": {}, "repeat": "twice" }"#,
                "motions[0].repeat, line 6: unknown value `twice`; known are `once`, `loop` and `back_and_forth`",
                Refuses,
            ),
            // The end of such a motion is its start, to rounding.
            (
                r#"{ "body": "a", "to": {}, "start": 1, "duration": 1e-17 }"#,
                "motions[0].duration, line 6: the motion is too short to be timed after 1 s: it must take 1.1e-10 s at least, and takes 1e-17 s; begin earlier",
                Accepts,
            ),
        ],
        text,
    );
    let plane = r#"{ "palpate": 1, "dimension": 2,
      "bodies": [{ "name": "a", "shape": { "ball": { "radius": 1 } } }],
      "motions": [{ "body": "a", "to": { "translation": [1, 0] }, "turns": 1 }] }"#;
    let error = Scene::from_json(plane).unwrap_err();
    assert_eq!(
        error.to_string(),
        "motions[0].turns, line 3: turns must be 0 for a translation in the plane, got 1"
    );
}

#[test]
fn the_key_of_the_bayonet_touches_nothing_on_its_way() {
    let text = std::fs::read_to_string(repository().join("scenes/bayonet.json")).unwrap();
    let AnyScene::Spatial(scene) = Scene::from_json(&text).unwrap().build().unwrap() else {
        panic!("dimension is 3")
    };
    let end = scene.motions.iter().filter_map(|motion| motion.end()).fold(0.0, f64::max);
    for step in 0..=40 {
        let scene = scene.at(end * f64::from(step) / 40.0).unwrap();
        let mut world = scene.world().unwrap();
        let near = world.step();
        assert!(near.is_empty(), "{:?} at step {step}", near[0].bodies);
    }
}
