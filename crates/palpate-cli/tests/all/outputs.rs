// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! No command loses what was there before it, or what it found.

use std::fs;

use crate::common::{Folder, errors, json, palpate, program, status, text};

pub(crate) const BALL: &str = r#"{ "palpate": 1, "dimension": 3,
  "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.5 } } } ] }"#;

const POINTS: &str = "x_m,y_m,z_m\n0,0,0\n0,1,0\n";

/// Every command with an output, on every input that it has.
#[test]
fn no_command_overwrites_its_input() {
    let folder = Folder::new();
    let scene = folder.write("scene.svg", BALL);
    let points = folder.write("points.csv", POINTS);
    let hand = folder.write("hand.csv", "time_s,x_m,y_m,z_m\n0,0,1,0\n1,0,0.6,0\n");
    let other_name = format!("{}/./scene.svg", folder.name(""));
    let picture = folder.write("scene.png", BALL);
    let commands: [&[&str]; 11] = [
        &["render", &picture, "--output", &picture],
        &["eval", &scene, "--points", &points, "--output", &scene],
        &["eval", &scene, "--points", &points, "--output", &points],
        &["plot", &scene, "--output", &other_name],
        &["descend", &scene, "--segment", "-1,0,0", "1,0,0", "--plot", &scene],
        &["gradients", &scene, "--at", "1,0,0", "--plot", &scene],
        &["plot", "scenes/s1.json", "--map", "error", "--against", &scene, "--output", &scene],
        &["feel", &scene, "--fast", "--plot", &scene],
        &["feel", &scene, "--fast", "--path", &hand, "--trace", &hand],
        &["feel", &scene, "--fast", "--wav", &scene],
        &["feel", &scene, "--fast", "--trace", &hand, "--wav", &hand],
    ];
    for command in commands {
        let output = palpate(command);
        assert_eq!(status(&output), 2, "{command:?}");
        assert!(errors(&output).contains("would overwrite the"), "{}", errors(&output));
        assert_eq!(text(&output), "", "{command:?} ran");
    }
    for (name, content) in [("scene.svg", BALL), ("scene.png", BALL), ("points.csv", POINTS)] {
        assert_eq!(fs::read_to_string(folder.path(name)).unwrap(), content);
    }
    let left: Vec<_> = fs::read_dir(folder.path("")).unwrap().collect();
    assert_eq!(left.len(), 4, "{left:?}");
}

/// Only the files that a command line names were spared: a grid or a mesh of a scene replaced the mesh that it reads.
#[test]
fn no_command_overwrites_what_its_scene_reads() {
    let folder = Folder::new();
    let mesh = folder.write("part.stl", "solid a\nendsolid a\n");
    let samples = folder.write("scan.grid", "samples");
    folder.write("scan.nhdr", "NRRD0004\ndimension: 3\ndata file: scan.grid\n\n");
    let scene = folder.write(
        "scene.json",
        r#"{ "palpate": 1, "dimension": 3, "bodies": [
            { "name": "part", "shape": { "union": [ { "mesh": { "file": "part.stl" } },
              { "volume": { "file": "scan.nhdr", "value": 1 } } ] } } ] }"#,
    );
    let points = folder.write("points.csv", POINTS);
    for command in [
        &["mesh", &scene, "--output", &mesh][..],
        &["grid", &scene, "--cell", "0.1", "--output", &samples],
        &["eval", &scene, "--points", &points, "--output", &mesh],
    ] {
        let output = palpate(command);
        assert_eq!(status(&output), 2, "{command:?}");
    }
    assert_eq!(fs::read_to_string(&samples).unwrap(), "samples");
    assert_eq!(fs::read_to_string(&mesh).unwrap(), "solid a\nendsolid a\n");
    let good = folder.write("part.stl", "solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n  endloop\n endfacet\nendsolid a\n");
    let plate = folder.write(
        "plate.json",
        r#"{ "palpate": 1, "dimension": 3, "bodies": [
            { "name": "plate", "shape": { "mesh": { "file": "part.stl", "thickness": 0.01 } } } ] }"#,
    );
    for command in [
        &["mesh", &plate, "--output", &good][..],
        &["eval", &plate, "--points", &points, "--output", &good],
    ] {
        let output = palpate(command);
        assert_eq!(status(&output), 2, "{command:?}");
        assert!(errors(&output).contains("would overwrite the"), "{}", errors(&output));
    }
}

/// The default name of a plot is made of the scene's.
#[test]
fn a_plot_without_a_name_does_not_overwrite_its_scene() {
    let folder = Folder::new();
    folder.write("scene.svg", BALL);
    let output = folder.run(&["plot", "scene.svg"]);
    assert_eq!(status(&output), 2);
    assert_eq!(fs::read_to_string(folder.path("scene.svg")).unwrap(), BALL);
}

/// The first batch of rows is good, and was written before the bad one was read.
#[test]
fn a_bad_row_in_the_middle_leaves_the_old_output() {
    let folder = Folder::new();
    let mut rows = "x_m,y_m,z_m\n".to_owned();
    rows.push_str(&"0.1,0.2,0.3\n".repeat(70_000));
    rows.push_str("0,oops,0\n");
    let points = folder.write("points.csv", &rows);
    let output = folder.write("distances.csv", "the old distances");
    let scene = folder.write("ball.json", BALL);
    let eval = palpate(&["eval", &scene, "--points", &points, "--output", &output]);
    assert_eq!(status(&eval), 2);
    assert!(errors(&eval).contains("line 70002"), "{}", errors(&eval));
    assert_eq!(fs::read_to_string(&output).unwrap(), "the old distances");
    assert_eq!(fs::read_dir(folder.path("")).unwrap().count(), 3);
}

#[test]
fn places_are_checked_before_a_run_begins() {
    let folder = Folder::new();
    let nowhere = folder.name("no/such/touch.csv");
    let odd = folder.name("touch.gif");
    // A day of ticks: what began would not end.
    let long = ["feel", "--duration", "86400"];
    for (option, place, why) in [
        ("--trace", &nowhere, "there is no folder"),
        ("--wav", &nowhere, "there is no folder"),
        ("--plot", &odd, "must end in .svg or .png"),
    ] {
        let output = palpate(&[&long[..], &[option, place]].concat());
        assert_eq!(status(&output), 2, "{option}");
        assert!(errors(&output).contains(why), "{}", errors(&output));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_keeps_the_report() {
    let folder = Folder::new();
    let picture = folder.path("full.svg");
    std::os::unix::fs::symlink("/dev/full", &picture).unwrap();
    let picture = picture.to_str().unwrap();
    let feel = ["feel", "scenes/s1.json", "--fast", "--duration", "0.1", "--plot", picture];
    let output = palpate(&[&feel[..], &["--trace", "/dev/full"]].concat());
    assert_eq!(status(&output), 2);
    assert!(text(&output).contains("ticks          100 at 1000 Hz"), "{}", text(&output));
    let said = errors(&output);
    assert_eq!(said.matches("No space left").count(), 2, "{said}");
    assert!(said.contains("/dev/full: ") && said.contains("full.svg: "), "{said}");
    let descend = ["descend", "scenes/s1.json", "--segment", "-1,0,0", "1,0,0"];
    let output = palpate(&[&descend[..], &["--plot", picture]].concat());
    assert_eq!(status(&output), 2);
    assert!(text(&output).contains("missed by"), "{}", text(&output));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_an_error() {
    let commands: [&[&str]; 5] =
        [&["shapes"], &["schema"], &["check", "scenes/cup.json"], &["help"], &["--version"]];
    for command in commands {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = program(command).stdout(full).output().unwrap();
        assert_eq!(status(&output), 2, "{command:?}");
        assert!(errors(&output).contains("No space left"), "{}", errors(&output));
    }
}

#[test]
fn devices_and_pipes_are_written_to_directly() {
    let folder = Folder::new();
    let points = folder.write("points.csv", POINTS);
    let eval = ["eval", "scenes/s1.json", "--points", &points];
    let plain = text(&palpate(&eval));
    if cfg!(unix) {
        assert_eq!(text(&palpate(&[&eval[..], &["--output", "/dev/stdout"]].concat())), plain);
        let null = palpate(&[&eval[..], &["--output", "/dev/null"]].concat());
        assert_eq!((status(&null), text(&null)), (0, String::new()));
    }
    let file = folder.name("distances.csv");
    assert_eq!(text(&palpate(&[&eval[..], &["--output", &file]].concat())), "");
    assert_eq!(fs::read_to_string(file).unwrap(), plain);
}

#[test]
fn more_threads_than_the_machine_has_are_not_started() {
    let folder = Folder::new();
    let points = folder.write("points.csv", POINTS);
    let eval = |threads: &str| {
        palpate(&["eval", "scenes/s1.json", "--points", &points, "--threads", threads])
    };
    let (one, many) = (eval("1"), eval("100000"));
    assert_eq!((status(&many), text(&many)), (0, text(&one)));
    assert_eq!(errors(&one), "");
    assert!(errors(&many).contains("--threads 100000: this machine runs"), "{}", errors(&many));
}

/// A scene whose name clears the screen, and turns words around.
#[test]
fn text_from_files_does_not_steer_the_terminal() {
    let folder = Folder::new();
    let hostile = r"x\u001b[2Jy\u202ez\nw";
    let scene =
        folder.write("scene.json", &BALL.replace("\"ball\",", &format!("\"{hostile}\",")));
    for command in ["check", "mass", "contact"] {
        let output = text(&palpate(&[command, &scene]));
        assert!(!output.contains(['\u{1b}', '\u{202e}']), "{command}: {output}");
        if command != "contact" {
            assert!(output.contains(r"x\u{1b}[2Jy\u{202e}z\u{a}w"), "{command}: {output}");
        }
        let plain = palpate(&[command, &scene, "--json"]);
        assert!(!text(&plain).contains(['\u{1b}', '\u{202e}']), "{command}");
    }
    let name = json(&["check", &scene, "--json"])["bodies"][0]["name"].clone();
    assert_eq!(name, "x\u{1b}[2Jy\u{202e}z\nw");
    let bad = folder.write("bad.csv", "x_m,y_m,z_m\n0,\u{1b}[31m\u{202e},0\n");
    let output = palpate(&["eval", "scenes/s1.json", "--points", &bad]);
    let said = errors(&output);
    assert!(said.contains(r"\u{1b}[31m") && !said.contains(['\u{1b}', '\u{202e}']), "{said}");
    let key = folder.write("key.json", &BALL.replace("\"ball\":", r#""\u001b[31m\u202e":"#));
    let said = text(&palpate(&["check", &key]));
    assert!(said.contains(r"\u{1b}[31m") && !said.contains(['\u{1b}', '\u{202e}']), "{said}");
}
