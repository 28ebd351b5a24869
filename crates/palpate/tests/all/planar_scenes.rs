// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Planar scenes are felt in space, where nothing leaves the plane z = 0.

use palpate::device::profile_named;
use palpate::field::{Pose, Rotation, Shape, Vector};
use palpate::hands::{HandWay, swing};
use palpate::haptics::{Guide, GuideOptions, NextPose};
use palpate::scene::{AnyScene, BuiltScene, BuiltTool, Scene};
use palpate::servo_loop::{Pace, Recorder, RunOptions, TraceRow, run};
use palpate::sim::{Hand, SimulatedDevice};

const DURATION: f64 = 2.0;

/// All planar scenes that come with the program, by their names.
fn planar_scenes() -> Vec<(String, BuiltScene<2>)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
    let mut scenes = Vec::new();
    for file in files.filter(|file| file.extension().is_some_and(|ending| ending == "json")) {
        if let AnyScene::Planar(scene) = Scene::from_file(&file).unwrap().build().unwrap() {
            scenes.push((file.display().to_string(), scene));
        }
    }
    scenes
}

/// The size of a scene [m].
fn size(scene: &BuiltScene<2>) -> f64 {
    scene.bounds().unwrap().half_extents().norm()
}

/// The scene with a tool that turns, and guides of all kinds around its middle.
fn with_tool_and_guides(scene: &BuiltScene<2>) -> BuiltScene<2> {
    let (mut scene, size) = (scene.clone(), size(scene));
    let mut tool = BuiltTool::of_radius(0.01 * size);
    let [width, height] = [0.05 * size, 0.2 * size];
    tool.shape = Some(Shape::rectangle([width, height]).unwrap());
    scene.tool = Some(tool);
    let middle = scene.bounds().unwrap().centre().in_space();
    let (along, options) = (Vector([0.6, 0.8, 0.0]), GuideOptions::default());
    scene.guides = vec![
        Guide::to_point(middle, options).unwrap(),
        Guide::along_line(middle, along, options).unwrap(),
        Guide::on_plane(middle, along, options).unwrap(),
        Guide::well(middle, size, options).unwrap(),
    ];
    scene
}

/// What a hand feels on its tour of a scene whose first body turns and moves, with a device that gives forces and
/// torques.
fn felt(scene: &BuiltScene<2>) -> Vec<TraceRow> {
    let profile = profile_named("sigma7").unwrap();
    let tool = scene.tool.as_ref().map_or(Ok(None), BuiltTool::in_hand).unwrap();
    let map = scene.workspace_of(&profile, tool.as_ref()).unwrap();
    let paths = HandWay::tour(scene, DURATION, 1).unwrap().paths().unwrap();
    let hand = |path: &palpate::sim::HandPath| {
        let hand = Hand::new(path.mapped(|point| map.point_to_device(point)).unwrap());
        hand.with_turns(swing::<2>(DURATION).unwrap())
    };
    let hands = paths.iter().map(hand).collect();
    let mut device = SimulatedDevice::new(profile, hands).unwrap();
    let mut servo = scene.servo(&device).unwrap();
    let mut recorder = Recorder::new(2 * 1000 * DURATION as usize);
    let (way, start) = (0.05 * size(scene), scene.bodies[0].world_from_body);
    let mut motion = |time: f64, set_pose: &mut dyn FnMut(usize, NextPose)| {
        let turn = Rotation::from_angle(0.1 * time.sin()).unwrap();
        let moved = Pose::new(turn, [way * time.sin(), 0.5 * way * time.sin()]);
        set_pose(0, (moved * start).in_space().into());
    };
    let options = RunOptions {
        pace: Pace::AsFastAsPossible,
        recorder: Some(&mut recorder),
        motion: Some(&mut motion),
        ..RunOptions::new(DURATION)
    };
    run(&mut servo, &mut device, options).unwrap();
    recorder.rows().to_vec()
}

/// Hands, proxies and forces have z = 0 exactly, whether along z or about x and y.
#[test]
fn nothing_leaves_the_plane_of_a_planar_scene() {
    let scenes = planar_scenes();
    assert!(scenes.len() >= 9);
    for (name, scene) in scenes {
        for scene in [scene.clone(), with_tool_and_guides(&scene)] {
            let rows = felt(&scene);
            let has_tool = scene.tool.as_ref().is_some_and(|tool| tool.shape.is_some());
            assert_eq!(rows.iter().all(|row| row.tool.is_some()), has_tool, "{name}");
            assert!(rows.iter().any(|row| row.contact), "{name}");
            for row in &rows {
                let vectors = [row.device, row.proxy, row.wanted, row.force, row.normal];
                assert!(vectors.iter().all(|v| v[2] == 0.0), "{name}: {row:?}");
                let Some(tool) = &row.tool else { continue };
                let about = [tool.turn, tool.torque, tool.given.unwrap()];
                let is_about_z = about.iter().all(|v| (v[0], v[1]) == (0.0, 0.0));
                assert!(is_about_z, "{name}: {row:?}");
                assert_eq!(tool.pose.truncated::<2>().in_space(), tool.pose, "{name}");
            }
            if has_tool {
                let turns = rows.iter().filter_map(|row| row.tool.as_ref()?.given);
                assert!(turns.clone().any(|torque| torque[2] != 0.0), "{name}");
            }
        }
    }
}
