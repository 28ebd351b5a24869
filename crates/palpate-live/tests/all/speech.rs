// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the server answers.

use std::time::Duration;

use palpate::servo_loop::VirtualClock;
use palpate_live::{Live, LiveOptions};
use serde_json::{Value, json};

use crate::talk::{BALL, Page, request_trace, served};

const STAR: &str = include_str!("../../../../scenes/memoir_star.json");

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn hello_is_answered_by_what_there_is() {
    let live = served(LiveOptions { points: 3, ..LiveOptions::default() });
    let mut page = Page::silent(&live);
    page.say(&json!({ "do": "hello", "version": 2, "id": 0 }));
    let welcome = page.text(|message| message["do"] == "welcome");
    assert!(welcome["catalogue"].as_array().unwrap().len() > 80);
    assert!(welcome["schema"].is_object());
    let rubber = palpate::haptics::Material::preset("rubber").unwrap();
    assert_eq!(number(&welcome["presets"]["rubber"]["stiffness"]), rubber.stiffness);
    let names = welcome["presets"].as_object().unwrap().keys();
    assert!(names.eq(palpate::haptics::Material::preset_names()));
    let scene = page.text(|message| message["do"] == "scene");
    assert_eq!(scene["bodies"][0]["name"], "ball");
    assert_eq!(scene["bodies"][0]["promise"], "exact outside, exact inside");
    assert_eq!(scene["device"]["points"], 3);
    assert_eq!(scene["way"]["kind"], "formula");
    assert!(scene["way"]["glsl"].as_str().unwrap().contains("vec2 field(vec3 p, int only)"));
    let frame = page.binary(1);
    assert_eq!((frame.len(), frame[2]), (64 + 3 * 72, 3));

    let mut old = Page::silent(&live);
    old.say(&json!({ "do": "hello", "version": 1, "id": 0 }));
    assert_eq!(
        old.answer(0)["message"],
        "this program speaks version 2 and the page 1: load the page again"
    );
}

#[test]
fn questions_have_proven_answers() {
    let live = Live::start("star", None, STAR, LiveOptions::default()).unwrap();
    let mut page = Page::open(&live);
    let ball = page.answer_to(json!({ "question": "point", "at": [3, 1], "radius": 0.1 }));
    assert_eq!((&ball["palpate"], &ball["answer"]), (&json!(2), &json!("point")));
    assert!(number(&ball["distance"]) > 0.0 && number(&ball["safe_radius"]) > 0.0);
    assert_eq!(ball["ball"]["touches"], false);
    let at_point = page.ask(json!({ "do": "element", "corners": [[3, 1]] }));
    let least = &at_point["certified"];
    assert!(number(&least["lower"]) <= number(&ball["distance"]), "{least}");
    assert!(number(&least["upper"]) >= number(&ball["distance"]), "{least}");
    assert_eq!((&least["best"], &at_point["local"]), (&json!([3.0, 1.0]), &Value::Null));
    let triangle = json!([[1.35, 1.1], [1.8, 0.45], [1.0, 0.99]]);
    let found = page.ask(json!({
        "do": "element", "corners": triangle, "method": "naive", "iterations": 8,
    }));
    let certified = &found["certified"];
    assert!(number(&certified["lower"]) <= number(&certified["upper"]), "{found}");
    assert_eq!(certified["stop"], "converged");
    assert!(number(&certified["time"]) > 0.0);
    assert_eq!(found["local"]["path"].as_array().unwrap().len(), 9);
    assert!(found["enclosing"]["excludes"].is_boolean());
    let swept = page.ask(json!({ "do": "sweep", "corners": triangle, "by": [0.0, -0.5] }));
    assert!(swept["lower"].is_number(), "{swept}");
    let wrong = page.ask(json!({ "do": "element", "corners": triangle, "method": "guess" }));
    assert_eq!(wrong["do"], "refused");
    for (question, why) in [
        (json!({ "question": "point", "at": [1, 2, 3] }), "a point has 2 numbers, got 3"),
        (json!({ "question": "point", "at": [1, 2], "body": "moon" }), "moon"),
        (json!({ "question": "mass", "cells": 6_000_000 }), "at most 5000000"),
        (json!({ "question": "contacts", "margin_m": 1 }), "unknown field `margin_m`"),
    ] {
        let wrong = page.ask(json!({ "do": "ask", "question": question }));
        assert!(wrong["message"].as_str().unwrap().contains(why), "{wrong}");
    }
}

/// A page of version 1 asked by messages that have other names now.
#[test]
fn messages_of_version_1_are_refused_with_the_new_one() {
    let live = served(LiveOptions::default());
    let mut page = Page::open(&live);
    for old in [
        json!({ "do": "probe", "at": [0, 1, 0], "body": 0 }),
        json!({ "do": "ball", "centre": [0, 1, 0], "radius": 0.1 }),
        json!({ "do": "contacts", "proof": true }),
    ] {
        let refused = page.ask(old);
        let why = refused["message"].as_str().unwrap();
        assert!(refused["do"] == "refused" && why.contains("is `ask` now, as in {"), "{why}");
    }
}

#[test]
fn boxes_of_a_proof_come_with_their_pose_and_are_bounded() {
    let body = |name: &str, x: f64| {
        json!({ "name": name, "shape": { "ball": { "radius": 0.05 } },
                "pose": { "translation": [x, 0, 0] } })
    };
    let scene = json!({ "palpate": 1, "dimension": 3,
        "bodies": [body("left", -0.06), body("right", 0.06)] });
    let live = Live::start("two", None, &scene.to_string(), LiveOptions::default()).unwrap();
    let mut page = Page::open(&live);
    let question =
        json!({ "question": "contacts", "proof": true, "tolerance": 1e-5, "every_pair": true });
    let told = page.ask(json!({ "do": "ask", "question": question }));
    let pair = &told["answer"]["pairs"][0];
    assert_eq!(
        (&pair["bodies"], &pair["verdict"]),
        (&json!(["left", "right"]), &json!("apart"))
    );
    let proof = &pair["proof"];
    assert_eq!(proof["world_from_boxes"]["translation"], json!([-0.06, 0.0, 0.0]));
    let boxes = proof["boxes"].as_array().unwrap();
    assert!(boxes.len() <= 4000 && boxes[0]["aabb"]["min"].is_array(), "{}", boxes.len());
    assert_eq!(told["boxes_left_out"] != 0, boxes.len() == 4000, "{}", told["boxes_left_out"]);
}

#[test]
fn grids_and_pictures_come_as_bytes() {
    let live = served(LiveOptions::default());
    let mut page = Page::open(&live);
    page.say(&json!({ "do": "samples", "cells": 16, "id": 5 }));
    let grid = page.binary(2);
    assert_eq!(grid[..8], [2, 2, 3, 2, 5, 0, 0, 0]);
    let count = |at: usize| u32::from_le_bytes(grid[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(grid.len(), 48 + 2 * count(12) * count(16) * count(20));
    page.say(&json!({
        "do": "slice", "id": 6, "origin": [0, 0, 0], "right": [1, 0, 0], "up": [0, 1, 0],
        "width": 0.2, "height": 0.2, "columns": 3, "rows": 3,
    }));
    let slice = page.binary(2);
    let middle = f32::from_le_bytes(slice[48 + 16..48 + 20].try_into().unwrap());
    assert!((middle + 0.05).abs() < 1e-6, "the middle of the ball: {middle}");
    page.say(&json!({
        "do": "picture", "id": 7, "eye": [0.3, 0.2, 0.3], "target": [0, 0, 0],
        "field_of_view": 0.5, "width": 64, "height": 48,
    }));
    let picture = page.binary(3);
    assert_eq!(picture[16..20], *b"\x89PNG");
}

#[test]
fn edits_reach_the_servo_and_wrong_ones_do_not() {
    let live = served(LiveOptions::default());
    let mut page = Page::open(&live);
    let radius = "/bodies/0/shape/ball/radius";
    let edit = |base: u64, to: f64| json!({ "do": "edit", "base": base, "changes": [{ "at": radius, "to": to }], "moving": true });
    page.say(&edit(1, 0.06));
    let scene = page.text(|message| message["do"] == "scene" && message["revision"] == 2);
    assert_eq!((&scene["restarted"], &scene["by"]), (&Value::Null, &json!("edit")));
    assert_eq!(scene["way"]["uniforms"].as_array().unwrap().len(), 1);
    let refused = page.ask(edit(2, -1.0));
    assert_eq!(refused["problems"][0]["at"], radius);
    let refused = page.ask(edit(1, 0.05));
    assert!(refused["message"].as_str().unwrap().contains("edited elsewhere"));
    let answer = page.answer_to(json!({ "question": "point", "at": [0, 0.1, 0] }));
    assert!((number(&answer["distance"]) - 0.04).abs() < 1e-12);

    // Another tool needs another servo.
    let tool = json!({ "do": "edit", "base": 2, "changes": [
        { "at": "/tool", "to": { "radius": 0.004, "points": [[0, 0, 0], [0.01, 0, 0]] } } ] });
    page.say(&tool);
    let scene = page.text(|message| message["do"] == "scene" && message["revision"] == 3);
    let why = "another servo began: the tool, the motions or the dimension changed";
    assert_eq!((&scene["restarted"], &scene["device"]["points"]), (&json!(why), &json!(2)));
    page.say(&json!({ "do": "open", "name": "star", "text": STAR }));
    let scene = page.text(|message| message["do"] == "scene" && message["revision"] == 4);
    assert_eq!(scene["dimension"], 2);
    assert_eq!(page.ask(json!({ "do": "open", "name": "x", "text": "{" }))["do"], "refused");
    assert_eq!(page.ask(json!({ "do": "save" }))["do"], "refused");
    assert!(
        Live::start("x", None, &BALL.replace("0.05", "-1"), LiveOptions::default()).is_err()
    );
}

#[test]
fn a_stop_does_not_wait_for_an_edit() {
    let live = served(LiveOptions::default());
    let mut page = Page::open(&live);
    let thousand = include_str!("../../../../scenes/thousand.json");
    page.say(&json!({ "do": "open", "name": "thousand", "text": thousand, "id": 1 }));
    page.say(&json!({ "do": "stop", "id": 2 }));
    let first = page.text(|message| message["id"] == 1 || message["id"] == 2);
    assert_eq!(first, json!({ "do": "done", "id": 2 }));
    assert_eq!(page.answer(1)["do"], "done");
    // The servo of the new scene is stopped too.
    let frame = loop {
        let frame = page.binary(1);
        if frame[4] == 2 && frame[8..16] != [0; 8] {
            break frame;
        }
    };
    assert_eq!(frame[3] & 1, 1, "stopped");
    page.release(1);
}

#[test]
fn what_was_recorded_is_replayed_and_so_is_a_file() {
    let live = served(LiveOptions::default());
    let mut page = Page::open(&live);
    assert_eq!(page.ask(json!({ "do": "replay", "on": true }))["do"], "refused", "no rows yet");
    page.ask(json!({ "do": "record", "on": true }));
    page.ask(json!({ "do": "hand", "held": true, "target": [0.0, 0.045, 0.0] }));
    page.wait_for_tick(400);
    page.ask(json!({ "do": "record", "on": false }));
    page.ask(json!({ "do": "hand", "held": false }));
    let is_replaying = |frame: &[u8]| frame[3] & 32 != 0;
    assert_eq!(page.ask(json!({ "do": "replay", "on": true }))["do"], "done");
    while !is_replaying(&page.binary(1)) {}
    assert_eq!(page.ask(json!({ "do": "replay", "on": false }))["do"], "done");
    while is_replaying(&page.binary(1)) {}

    let answer = request_trace(&live, "GET", "");
    let (_, trace) = answer.split_once("\r\n\r\n").unwrap();
    assert!(trace.starts_with("time_s,point,device_x_m,"), "{trace:.100}");
    assert!(request_trace(&live, "POST", trace).starts_with("HTTP/1.1 204"));
    assert_eq!(page.ask(json!({ "do": "replay", "on": true }))["do"], "done");
    while !is_replaying(&page.binary(1)) {}
    // Who takes the hand ends it.
    page.ask(json!({ "do": "hand", "held": true, "target": [0.0, 0.1, 0.0] }));
    while is_replaying(&page.binary(1)) {}

    let wrong = request_trace(&live, "POST", "time_s,x_m\n0,1\n");
    assert!(wrong.starts_with("HTTP/1.1 422") && wrong.contains("no column y_m"), "{wrong}");
}

#[test]
fn a_long_question_is_cancelled_and_keeps_no_other_page_waiting() {
    let thousand = include_str!("../../../../scenes/thousand.json");
    let live = Live::start("thousand", None, thousand, LiveOptions::default()).unwrap();
    let (mut one, mut other) = (Page::open(&live), Page::open(&live));
    let picture = |id: u32| {
        json!({
            "do": "picture", "id": id, "eye": [2, 1, 2], "target": [0, 0, 0], "field_of_view": 0.6,
            "width": 2048, "height": 2048,
        })
    };
    one.say(&picture(5));
    one.say(&picture(6));
    let answer = other.answer_to(json!({ "question": "point", "at": [0, 0, 1] }));
    assert_eq!(answer["answer"], "point");
    assert_eq!(one.ask(json!({ "do": "cancel", "question": 6 }))["do"], "done");
    one.say(&json!({ "do": "cancel", "question": 5, "id": 7 }));
    assert_eq!(one.answer(5)["message"], "cancelled");
    let none = one.ask(json!({ "do": "cancel", "question": 99 }));
    assert_eq!(none["message"], "no question of number 99 is worked on");
}

#[test]
fn a_page_is_told_of_the_safety_chain_of_a_fall_and_of_what_building_took() {
    // With the machine's clock, late ticks of a busy machine may take the force away before the stop does.
    let (clock, mut driver) = VirtualClock::driven();
    let live = served(LiveOptions { clock: clock.into(), ..LiveOptions::default() });
    let mut page = Page::silent(&live);
    page.say(&json!({ "do": "hello", "version": 2 }));
    let scene = page.text(|message| message["do"] == "scene");
    let parts: Vec<_> =
        scene["spent"].as_array().unwrap().iter().map(|part| &part["name"]).collect();
    assert_eq!(parts, ["build", "hand over", "describe", "formula"]);
    page.ask(json!({ "do": "hand", "held": true, "target": [0.0, 0.02, 0.0] }));
    let acted = |message: &Value| {
        let stages = message["stages"].as_array().unwrap();
        stages.iter().any(|stage| stage["name"] == "emergency stop" && stage["ticks"] != 0)
    };
    let mut advance = || driver.advance(Duration::from_millis(50));
    while page.binary(1)[28..32] == [0; 4] {
        advance();
    }
    page.ask(json!({ "do": "stop" }));
    advance();
    page.text(|message| message["do"] == "safety" && acted(message));
    let fell = page.ask(json!({ "do": "fall", "centre": [0.001, 0.1, 0], "radius": 0.005 }));
    assert_eq!((&fell["do"], &fell["end"]), (&json!("fall"), &json!("leaves")));
    assert!(!fell["bounces"].as_array().unwrap().is_empty());
}

/// A refused order once ended a replay, and let go of the hand that another page held.
#[test]
fn a_refused_hand_changes_nothing() {
    let live = served(LiveOptions::default());
    let (mut one, mut other) = (Page::open(&live), Page::open(&live));
    one.ask(json!({ "do": "hand", "held": true, "target": [0.0, 0.045, 0.0] }));
    let presses = |frame: &[u8]| f32::from_le_bytes(frame[24..28].try_into().unwrap()) > 0.5;
    while !presses(&one.binary(1)) {}
    for wrong in [json!({ "target": [1] }), json!({ "target": [0, 1, 0], "point": 7 })] {
        let mut ask = wrong;
        (ask["do"], ask["held"]) = ("hand".into(), true.into());
        assert_eq!(other.ask(ask)["do"], "refused");
    }
    drop(other);
    one.text(|message| message["do"] == "clients" && message["count"] == 1);
    // Late ticks of a busy machine take the force away for a moment.
    let pressing = (0..30).filter(|_| presses(&one.binary(1))).count();
    assert!(pressing > 10, "{pressing} frames");
}

/// A drag of a page and the edit of another once were one step back.
#[test]
fn edits_of_two_pages_are_two_steps_back() {
    let live = served(LiveOptions::default());
    let (mut one, mut other) = (Page::open(&live), Page::open(&live));
    let edit = |base: u32, at: &str, to: Value, moving: bool| {
        json!({
            "do": "edit", "base": base, "changes": [{ "at": at, "to": to }], "moving": moving,
        })
    };
    one.ask(edit(1, "/bodies/0/shape/ball/radius", json!(0.06), true));
    other.ask(edit(2, "/bodies/0/name", json!("marble"), false));
    other.ask(json!({ "do": "undo" }));
    let scene = one.text(|message| message["do"] == "scene" && message["revision"] == 4);
    assert_eq!(scene["bodies"][0]["name"], "ball");
    assert_eq!(scene["scene"]["bodies"][0]["shape"]["ball"]["radius"], 0.06);
}

/// A file that is broken, mended, deleted and there again is told each time, and once.
#[test]
fn what_becomes_of_the_file_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("ball.json");
    std::fs::write(&file, BALL).unwrap();
    let live = Live::start("ball", Some(file.clone()), BALL, LiveOptions::default()).unwrap();
    let mut page = Page::open(&live);
    let notice = |page: &mut Page| {
        let notice = page.text(|message| message["do"] == "notice");
        assert_eq!(notice["about"], "file");
        notice["message"].as_str().unwrap().to_owned()
    };
    std::fs::write(&file, "{").unwrap();
    assert!(notice(&mut page).contains("was changed, and has an error"));
    std::fs::write(&file, BALL).unwrap();
    assert!(notice(&mut page).ends_with("is as it was again"));
    std::fs::remove_file(&file).unwrap();
    assert!(notice(&mut page).contains("cannot be read any more"));
}

/// A step back that could not be shown had moved the document all the same: the next edit brought back what the
/// page did not show, and a save wrote it.
#[test]
fn a_step_back_that_is_refused_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let part = folder.path().join("part.obj");
    let faces = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    std::fs::write(&part, faces).unwrap();
    let shape = json!({ "mesh": { "file": "part.obj", "scale": 0.01 } });
    let scene =
        json!({ "palpate": 1, "dimension": 3, "bodies": [{ "name": "part", "shape": shape }] })
            .to_string();
    let file = folder.path().join("scene.json");
    std::fs::write(&file, &scene).unwrap();
    let live = Live::start("part", Some(file), &scene, LiveOptions::default()).unwrap();
    let mut page = Page::open(&live);
    let edit = |base: u64, at: &str, to: Value| json!({ "do": "edit", "base": base, "changes": [{ "at": at, "to": to }] });
    let ball = json!({ "ball": { "radius": 0.02 } });
    assert_eq!(page.ask(edit(1, "/bodies/0/shape", ball))["do"], "done");
    std::fs::rename(&part, folder.path().join("hidden.obj")).unwrap();
    let refused = page.ask(json!({ "do": "undo" }));
    assert!(refused["message"].as_str().unwrap().contains("part.obj"), "{refused}");
    std::fs::rename(folder.path().join("hidden.obj"), &part).unwrap();
    assert_eq!(page.ask(edit(2, "/bodies/0/name", json!("ball")))["do"], "done");
    page.say(&json!({ "do": "hello", "version": 2, "id": 77 }));
    let shown = page.text(|message| message["do"] == "scene" && message["revision"] == 3);
    assert_eq!(shown["scene"]["bodies"][0]["shape"]["ball"]["radius"], 0.02, "{shown}");
}

/// The gap of a sweep was a part of the scene's size: beside a body of 1000 km, a point 9 cm from a ball touched it.
#[test]
fn what_is_large_and_far_makes_no_touch_of_what_is_near() {
    let scene = json!({ "palpate": 1, "dimension": 3, "bodies": [
        { "name": "small", "shape": { "ball": { "radius": 0.02 } } },
        { "name": "large", "shape": { "ball": { "radius": 1e6 } },
          "pose": { "translation": [3e6, -3e6, -3e6] } },
    ] });
    let live = Live::start("far", None, &scene.to_string(), LiveOptions::default()).unwrap();
    let mut page = Page::open(&live);
    let corners = json!([[-0.07, 0.05, 0.0], [-0.06, 0.05, 0.0]]);
    let swept = page.ask(json!({ "do": "sweep", "corners": corners, "by": [0.0, 1.0, 0.0] }));
    assert_eq!(swept["touches"], false, "{swept}");
    let swept = page
        .ask(json!({ "do": "sweep", "corners": [[-0.07, 0.05, 0.0]], "by": [0.0, 1.0, 0.0] }));
    assert_eq!(swept["touches"], false, "{swept}");
}

/// A mesh that another program writes anew is shown anew, and an error in it told.
#[test]
fn a_mesh_that_is_changed_is_shown_anew() {
    let folder = tempfile::tempdir().unwrap();
    let part = folder.path().join("part.obj");
    let faces = |height: u32| {
        format!(
            "v 0 0 0\nv 1 0 0\nv 0 {height} 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
        )
    };
    std::fs::write(&part, faces(2)).unwrap();
    let shape = json!({ "mesh": { "file": "part.obj", "scale": 0.01 } });
    let bodies = [json!({ "name": "part", "shape": shape })];
    let scene = json!({ "palpate": 1, "dimension": 3, "bodies": bodies }).to_string();
    let file = folder.path().join("scene.json");
    std::fs::write(&file, &scene).unwrap();
    let live = Live::start("part", Some(file), &scene, LiveOptions::default()).unwrap();
    let mut page = Page::open(&live);
    std::fs::write(&part, faces(20)).unwrap();
    let shown = page.text(|message| message["do"] == "scene" && message["revision"] == 2);
    assert_eq!(shown["by"], "file");
    let top = number(&shown["bodies"][0]["bounds"]["max"][1]);
    assert!((top - 0.2).abs() < 1e-6, "{shown}");
    std::fs::write(&part, "v 0 0 no\n").unwrap();
    let notice = page.text(|message| message["do"] == "notice");
    let message = notice["message"].as_str().unwrap();
    assert!(message.contains("was changed, and has an error") && message.contains("part.obj"));
}
