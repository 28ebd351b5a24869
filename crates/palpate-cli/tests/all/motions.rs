// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scenes at a time, and views of scenes.

use crate::common::{Folder, errors, json, palpate, status, text};
use crate::pictures::words;

/// A ball that rises by 12 mm in half a second, and a view.
const RISING: &str = r#"{ "palpate": 1, "dimension": 3,
  "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.05 } },
                "material": { "stiffness": 500, "damping": 1 } } ],
  "motions": [ { "body": "ball", "to": { "translation": [0, 0.012, 0] }, "duration": 0.5 } ],
  "views": [ { "name": "top", "plane": "xz", "at": 0.03, "center": [0.02, 0], "width": 0.1,
               "height": 0.08, "spacing": 0.004 },
             { "name": "front" } ] }"#;

/// The column of a trace with this name, as numbers.
fn column(trace: &str, name: &str) -> Vec<f64> {
    let mut lines = trace.lines();
    let place = lines.next().unwrap().split(',').position(|column| column == name).unwrap();
    lines.map(|line| line.split(',').nth(place).unwrap().parse().unwrap()).collect()
}

#[test]
fn feel_moves_the_bodies_of_a_scene() {
    let folder = Folder::new();
    let scene = folder.write("rising.json", RISING);
    let hand = folder.write("hand.csv", "time_s,x_m,y_m,z_m\n0,0,0.06,0\n1,0,0.06,0\n");
    let (trace, plot) = (folder.name("trace.csv"), folder.name("feel.svg"));
    let run = ["feel", &scene, "--path", &hand, "--fast"];
    let report = json(&[&run[..], &["--trace", &trace, "--plot", &plot, "--json"]].concat());
    assert_eq!(report["moving"], serde_json::json!(["ball"]));
    let trace = std::fs::read_to_string(&trace).unwrap();
    let (heights, forces) = (column(&trace, "body_0_y_m"), column(&trace, "wanted_y_n"));
    assert_eq!((heights[0], heights[250], heights[999]), (0.0, 0.006, 0.012));
    assert_eq!(column(&trace, "body_0_turn_z_rad")[999], 0.0);
    // The probe of 2 mm is touched from 8 mm on; the ball comes at 24 mm/s, then rests.
    assert!(forces[330] == 0.0 && forces[340] > 0.024, "{:?}", &forces[330..341]);
    let expected = 500.0 * (heights[400] + 0.052 - 0.06) + 0.024;
    assert!((forces[400] - expected).abs() < 1e-6, "{} {expected}", forces[400]);
    assert!((forces[999] - 2.0).abs() < 1e-6, "{}", forces[999]);
    let svg = std::fs::read_to_string(&plot).unwrap();
    for expected in ["bodies on their way", "bodies at 0.999 s"] {
        assert!(words(&svg).contains(&expected), "{:?}", words(&svg));
    }
    let report = text(&palpate(&run));
    assert!(report.contains("  moving         ball\n"), "{report}");
}

#[test]
fn a_scene_without_motions_says_nothing_of_them() {
    let report = json(&["feel", "scenes/cup.json", "--fast", "--duration", "0.1", "--json"]);
    assert_eq!(report["moving"], serde_json::json!([]));
}

#[test]
fn plot_draws_a_scene_at_a_time() {
    let folder = Folder::new();
    let scene = folder.write("rising.json", RISING);
    let png = folder.name("plot.png");
    let plot = ["plot", &scene, "--centre", "0,0,0", "--size", "0.01", "--output", &png];
    let deepest = |time: &str| {
        let answer = json(&[&plot[..], &["--time", time, "--json"]].concat());
        answer["smallest"].as_f64().unwrap()
    };
    // The window holds the centre of the ball first, and ends 7 mm below it later.
    assert!((deepest("0") + 0.05).abs() < 1e-4);
    assert!((deepest("1") + 0.043).abs() < 1e-4);
}

#[test]
fn plot_draws_a_view_of_a_scene() {
    let folder = Folder::new();
    let scene = folder.write("rising.json", RISING);
    let svg = folder.name("view.svg");
    let view = ["plot", &scene, "--view", "top", "--output", &svg, "--json"];
    let answer = json(&view);
    assert_eq!(answer["step"], 0.004);
    // The window is x from −0.03 to 0.07, z from −0.04 to 0.04, at y = 0.03.
    let [smallest, largest] = ["smallest", "largest"].map(|key| answer[key].as_f64().unwrap());
    assert!((smallest + 0.02).abs() < 1e-4, "{smallest}");
    let corner = 0.07_f64.hypot(0.04).hypot(0.03) - 0.05;
    assert!((largest - corner).abs() < 1e-3, "{largest} {corner}");
    let picture = std::fs::read_to_string(&svg).unwrap();
    assert!(words(&picture).contains(&"z [m]"), "{:?}", words(&picture));
    // The command line may ask for other isolines.
    let finer = json(&[&view[..], &["--step", "0.002"]].concat());
    assert_eq!(finer["step"], 0.002);
    // A view with a name alone shows the whole scene, as a plot without a view does.
    let front = folder.name("front.svg");
    json(&["plot", &scene, "--view", "front", "--output", &front, "--json"]);
    json(&["plot", &scene, "--output", &svg, "--json"]);
    assert_eq!(std::fs::read(&front).unwrap(), std::fs::read(&svg).unwrap());
}

#[test]
fn a_view_that_is_not_there_is_refused_with_those_that_are() {
    let folder = Folder::new();
    let scene = folder.write("rising.json", RISING);
    for command in ["plot", "render"] {
        let output = palpate(&[command, &scene, "--view", "side"]);
        assert_eq!(
            errors(&output),
            "palpate: --view \"side\": the scene has the views \"top\", \"front\"\n"
        );
        assert_eq!(status(&output), 2);
        let output = palpate(&[command, "scenes/cup.json", "--view", "side"]);
        assert_eq!(errors(&output), "palpate: --view \"side\": the scene has no views\n");
    }
}

#[test]
fn a_view_goes_with_no_other_window() {
    for (option, value) in [("--plane", "xz"), ("--at", "0.1"), ("--centre", "0,0,0")] {
        let size: &[&str] = if option == "--centre" { &["--size", "1"] } else { &[] };
        let view = ["plot", "scenes/nut_on_bolt.json", "--view", "thread", option, value];
        let output = palpate(&[&view[..], size].concat());
        assert_eq!(status(&output), 2, "{option}");
        assert!(errors(&output).contains("cannot be used with"), "{}", errors(&output));
    }
}
