// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate render`.

use std::fs;

use crate::common::{Folder, errors, json, palpate, status, text};

/// A small picture.
const SMALL: [&str; 4] = ["--width", "48", "--height", "36"];

fn is_png(path: &std::path::Path) -> bool {
    fs::read(path).unwrap().starts_with(b"\x89PNG")
}

/// The message of a run that is refused.
fn refusal(arguments: &[&str]) -> String {
    let output = palpate(&[&["render"], arguments].concat());
    assert_eq!((status(&output), text(&output).as_str()), (2, ""), "{arguments:?}");
    errors(&output)
}

#[test]
fn render_writes_a_picture_and_says_what_is_proven() {
    let folder = Folder::new();
    let png = folder.name("cup.png");
    let run = [&["render", "scenes/cup.json", "--output", &png], &SMALL[..]].concat();
    let answer = json(&[&run[..], &["--json"]].concat());
    assert_eq!(answer["outputs"], serde_json::json!([png]));
    assert_eq!((&answer["width"], &answer["pictures"]), (&48.into(), &1.into()));
    for rays in ["sight", "light"] {
        assert_eq!(answer[rays]["undecided"], 0, "{answer}");
        assert!(answer[rays]["rays"].as_u64().unwrap() >= 48 * 36, "{answer}");
    }
    assert!((answer["ground"].as_f64().unwrap()).abs() < 1e-9, "{answer}");
    let [gap, thin] = ["gap", "thin"].map(|key| answer[key].as_f64().unwrap());
    assert!((thin / gap - 0.6 * 32.0).abs() < 1e-9, "{answer}");
    assert!(is_png(&folder.path("cup.png")));
    let said = text(&palpate(&run));
    assert!(said.starts_with(&format!("{png}: ")) && said.ends_with(" rays, all decided\n"));
}

#[test]
fn a_picture_has_the_same_bytes_on_any_number_of_threads() {
    let folder = Folder::new();
    let picture = |name: &str, threads: &str| {
        let png = folder.name(name);
        let run = ["render", "scenes/bayonet.json", "--time", "1.4", "--slice", "xy"];
        let to = ["--contacts", "--output", &png, "--threads", threads];
        json(&[&run[..], &to, &SMALL, &["--json"]].concat());
        fs::read(folder.path(name)).unwrap()
    };
    assert_eq!(picture("one.png", "1"), picture("two.png", "2"));
}

#[test]
fn a_picture_without_a_name_has_that_of_the_scene() {
    let folder = Folder::new();
    let scene = fs::read_to_string("../../scenes/s1.json").unwrap();
    folder.write("ball.json", &scene);
    let output = folder.run(&[&["render", "ball.json"], &SMALL[..]].concat());
    assert_eq!(status(&output), 0, "{}", errors(&output));
    assert!(is_png(&folder.path("ball.png")));
}

#[test]
fn a_turntable_is_an_animation_or_numbered_files() {
    let folder = Folder::new();
    let png = folder.name("turn.png");
    let turn = ["render", "scenes/cup.json", "--turntable", "3", "--json"];
    let one = json(&[&turn[..], &["--output", &png], &SMALL].concat());
    assert_eq!((&one["pictures"], &one["outputs"]), (&3.into(), &serde_json::json!([png])));
    let bytes = fs::read(&png).unwrap();
    // The chunk that controls an animation: three pictures, without end.
    let control = bytes.windows(4).position(|chunk| chunk == b"acTL").unwrap();
    assert_eq!(bytes[control + 4..control + 12], [0, 0, 0, 3, 0, 0, 0, 0]);
    let frames = folder.name("frames");
    let many = json(&[&turn[..], &["--frames", &frames], &SMALL].concat());
    let names: Vec<_> = many["outputs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|name| {
            let path = std::path::Path::new(name.as_str().unwrap()).to_owned();
            assert!(is_png(&path));
            path.file_name().unwrap().to_str().unwrap().to_owned()
        })
        .collect();
    assert_eq!(names, ["cup-0001.png", "cup-0002.png", "cup-0003.png"]);
}

#[test]
fn cameras_are_where_they_are_asked_to_be() {
    let folder = Folder::new();
    let png = folder.name("picture.png");
    let camera = |arguments: &[&str]| {
        let run = ["render", "scenes/nut_on_bolt.json", "--output", &png, "--json"];
        let quick = ["--width", "16", "--height", "12", "--samples", "1", "--shadows", "none"];
        json(&[&run[..], &quick, arguments].concat())["camera"].clone()
    };
    let from = camera(&["--from", "0.3,0.1,-0.2", "--at", "0,0.1,-0.2"]);
    assert_eq!(from["from"], serde_json::json!([0.3, 0.1, -0.2]));
    assert_eq!(from["direction"], serde_json::json!([-1.0, 0.0, 0.0]));
    assert_eq!(from["is_orthographic"], false);
    let above = camera(&["--elevation", "90", "--azimuth", "0", "--orthographic"]);
    let direction = above["direction"].as_array().unwrap();
    assert!((direction[1].as_f64().unwrap() + 1.0).abs() < 1e-15, "{above}");
    assert_eq!(above["is_orthographic"], true);
    let view = camera(&["--view", "thread"]);
    assert_eq!(view["direction"], serde_json::json!([0.0, 0.0, -1.0]));
    let eye: Vec<_> = view["from"].as_array().unwrap().iter().map(|x| x.as_f64()).collect();
    assert_eq!(eye[..2], [Some(0.015), Some(0.0475)]);
}

#[test]
fn a_scene_in_the_plane_is_sent_to_plot() {
    let said = refusal(&["scenes/wrench.json"]);
    assert_eq!(
        said,
        "palpate: scenes/wrench.json: the scene is in the plane, which `palpate plot` draws; \
         render needs \"dimension\": 3\n"
    );
}

#[test]
fn what_cannot_be_rendered_is_said() {
    let folder = Folder::new();
    let cup = "scenes/cup.json";
    for (arguments, expected) in [
        (
            &[cup, "--output", "cup.svg"][..],
            "cup.svg: the name of a rendered picture must end in .png",
        ),
        (
            &[cup, "--width", "10000", "--height", "5000"],
            "a picture must have 1 to 40000000 pixels, got 10000 x 5000",
        ),
        (
            &[cup, "--from", "0,0.045,0.035", "--at", "0,0,0"],
            "the camera at [0.0, 0.045, 0.035] m is inside the body \"cup\": move it out",
        ),
        (
            &[cup, "--from", "1,1,1", "--at", "1,1,1"],
            "a camera must look at another point than its own, got [1.0, 1.0, 1.0] m for both",
        ),
        (
            &[cup, "--slice", "xx"],
            "--slice must be xy, xz, yz, or origin:right:up, each of these three numbers joined by commas, got \"xx\"",
        ),
        (&[cup, "--slice", "view"], "--slice view needs --view NAME, which has the plane"),
        (
            &[cup, "--turntable", "360"],
            "an animation has 200000000 pixels at most, got 388800000; make it smaller, or write its pictures into a folder with --frames",
        ),
        (
            &[cup, "--turntable", "2", "--turn-time", "131"],
            "--turn-time must be at most 130 s for 2 pictures, 65 s for each, got 131 s",
        ),
    ] {
        let png = folder.name("cup.png");
        let has_output = arguments.contains(&"--output");
        let to: &[&str] = if has_output { &[] } else { &["--output", &png] };
        assert_eq!(refusal(&[arguments, to].concat()), format!("palpate: {expected}\n"));
        assert!(!folder.path("cup.png").exists());
    }
    for arguments in [
        &[cup, "--azimuth", "3", "--from", "1,1,1"][..],
        &[cup, "--at", "0,0,0"],
        &[cup, "--orthographic", "--field-of-view", "30"],
        &[cup, "--slice-at", "0.1"],
        &[cup, "--frames", "folder"],
        &["scenes/nut_on_bolt.json", "--view", "thread", "--turntable", "4"],
    ] {
        assert!(refusal(arguments).starts_with("error: "), "{arguments:?}");
    }
}

#[test]
fn undecided_rays_are_said_and_are_no_yes() {
    let folder = Folder::new();
    let png = folder.name("cup.png");
    let run = ["render", "scenes/cup.json", "--output", &png, "--ray-budget", "2"];
    let output = palpate(&[&run[..], &SMALL].concat());
    assert_eq!(status(&output), 1, "{}", errors(&output));
    let said = text(&output);
    assert!(said.contains("undecided\n  after 2 evaluations"), "{said}");
    assert!(said.contains("raise --ray-budget"), "{said}");
    assert!(is_png(&folder.path("cup.png")));
}

#[test]
fn contacts_are_counted_and_drawn() {
    let folder = Folder::new();
    let picture = |name: &str, more: &[&str]| {
        let png = folder.name(name);
        let run = ["render", "scenes/peg_in_hole.json", "--output", &png, "--json"];
        let answer = json(&[&run[..], &SMALL, more].concat());
        (answer, fs::read(folder.path(name)).unwrap())
    };
    let (plain, without) = picture("plain.png", &[]);
    let (answer, with) = picture("contacts.png", &["--contacts"]);
    assert!(plain["touching"].is_null());
    assert_eq!(answer["touching"], 2);
    assert_ne!(with, without);
}
