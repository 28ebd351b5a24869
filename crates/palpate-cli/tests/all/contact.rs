// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate contact`, and contacts in pictures.

use crate::common::{Folder, errors, json, palpate, status, text};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Three balls of a metre in a row, `gap` apart, and a floor under the first.
fn row(gap: f64) -> String {
    let ball = |name: &str, x: f64, y: f64| {
        format!(
            r#"{{ "name": "{name}", "shape": {{ "ball": {{ "radius": 0.5 }} }},
                  "pose": {{ "translation": [{x}, {y}, 0] }} }}"#
        )
    };
    let floor = r#"{ "name": "floor", "shape": { "half_space": { "normal": [0, 1, 0], "offset": 0 } } }"#;
    format!(
        r#"{{ "palpate": 1, "dimension": 3, "bodies": [{}, {}, {}, {floor}] }}"#,
        ball("left", 0.0, 0.5),
        ball("middle", 1.0 + gap, 1.0),
        ball("right", 2.0 + 2.0 * gap, 1.0)
    )
}

#[test]
fn all_pairs_are_told_of_with_bounds_that_hold() {
    let folder = Folder::new();
    let scene = folder.write("row.json", &row(0.001));
    let answer = json(&["contact", &scene, "--json"]);
    let pair = |a: &str, b: &str| {
        let pairs = answer["pairs"].as_array().unwrap();
        pairs.iter().find(|pair| pair["bodies"] == serde_json::json!([a, b])).unwrap().clone()
    };
    assert_eq!(answer["pairs"].as_array().unwrap().len(), 6);
    // 2 mm are 0.2 % of a body, so that a gap of 1 mm touches.
    assert!((number(&answer["margin_m"]) - 0.002).abs() < 1e-12);
    let touching = pair("middle", "right");
    assert_eq!(touching["verdict"], "touching");
    let contact = &touching["contacts"][0];
    assert!((number(&contact["gap_m"]) - 0.001).abs() < 1e-9);
    assert!((number(&contact["normal"][0]) - 1.0).abs() < 1e-9);
    let bounds = &touching["separation_m"];
    assert!(number(&bounds["lower"]) <= 0.001 && 0.001 <= number(&bounds["upper"]));
    let resting = pair("left", "floor");
    assert_eq!(resting["verdict"], "touching");
    assert!(number(&resting["contacts"][0]["gap_m"]).abs() < 1e-9);
    let apart = pair("left", "right");
    assert_eq!(apart["verdict"], "apart");
    let truth = (2.002_f64.powi(2) + 0.25).sqrt() - 1.0;
    let bounds = &apart["separation_m"];
    assert!(number(&bounds["lower"]) <= truth && truth <= number(&bounds["upper"]));
    assert!((number(&apart["witnesses"][0]["gap_m"]) - truth).abs() < 1e-3);
}

#[test]
fn what_the_budget_left_out_is_told() {
    let folder = Folder::new();
    let cube = |name: &str, x: f64| {
        format!(
            r#"{{ "name": "{name}", "shape": {{ "cuboid": {{ "size": [1, 1, 1] }} }},
                  "pose": {{ "translation": [{x}, 0, 0] }} }}"#
        )
    };
    let scene = format!(
        r#"{{ "palpate": 1, "dimension": 3, "bodies": [{}, {}] }}"#,
        cube("one", 0.0),
        cube("other", 0.999)
    );
    let scene = folder.write("cubes.json", &scene);
    let whole = json(&["contact", &scene, "--json"]);
    assert_eq!(whole["pairs"][0]["is_whole"], true);
    let options = ["contact", &scene, "--spacing", "1e-6", "--budget", "20000"];
    let part = json(&[&options[..], &["--json"]].concat());
    assert_eq!(part["pairs"][0]["is_whole"], false);
    let told = text(&palpate(&options));
    assert!(told.contains("the budget of 20000 evaluations is spent"), "{told}");
}

#[test]
fn the_status_says_whether_anything_touches() {
    let folder = Folder::new();
    let scene = folder.write("row.json", &row(0.001));
    let yes = palpate(&["contact", &scene]);
    assert_eq!(status(&yes), 0, "{}", errors(&yes));
    assert!(text(&yes).contains("4 bodies: 2 pairs touch"), "{}", text(&yes));
    // The one on the floor still does; without it nothing would.
    let alone = r#"{ "palpate": 1, "dimension": 2, "bodies": [
        { "name": "a", "shape": { "ball": { "radius": 0.5 } } },
        { "name": "b", "shape": { "ball": { "radius": 0.5 } },
          "pose": { "translation": [1.1, 0] } } ] }"#;
    let alone = folder.write("alone.json", alone);
    let no = palpate(&["contact", &alone]);
    assert_eq!(status(&no), 1, "{}", errors(&no));
    let touched = palpate(&["contact", &alone, "--margin", "0.11"]);
    assert_eq!(status(&touched), 0, "{}", text(&touched));
    for (option, value) in
        [("--margin", "-1"), ("--spacing", "0"), ("--tolerance", "nan"), ("--margin", "1e99")]
    {
        let bad = palpate(&["contact", &alone, option, value]);
        assert_eq!(status(&bad), 2, "{option} {value}");
        assert!(errors(&bad).contains(option), "{}", errors(&bad));
    }
}

#[test]
fn two_bodies_without_bounds_are_undecided_and_said_to_be() {
    let folder = Folder::new();
    let walls = r#"{ "palpate": 1, "dimension": 2, "bodies": [
        { "name": "floor", "shape": { "half_space": { "normal": [0, 1], "offset": 0 } } },
        { "name": "wall", "shape": { "half_space": { "normal": [1, 0], "offset": 0 } } } ] }"#;
    let scene = folder.write("walls.json", walls);
    let said = palpate(&["contact", &scene]);
    assert_eq!(status(&said), 1);
    assert!(text(&said).contains("floor – wall: undecided"), "{}", text(&said));
}

#[test]
fn a_nut_touches_its_bolt_on_both_flanks() {
    let answer = json(&["contact", "scenes/nut_on_bolt.json", "--margin", "0.0003", "--json"]);
    let contacts = answer["pairs"][0]["contacts"].as_array().unwrap();
    let up = |contact: &&Value| number(&contact["normal"][1]);
    assert!(contacts.iter().any(|contact| up(&contact) > 0.3), "{contacts:?}");
    assert!(contacts.iter().any(|contact| up(&contact) < -0.3), "{contacts:?}");
}

#[test]
fn pictures_show_contacts_and_their_proof() {
    let folder = Folder::new();
    let name = folder.name("gears.svg");
    let answer = json(&[
        "plot",
        "scenes/gears.json",
        "--contacts",
        "--proof",
        "--output",
        &name,
        "--json",
    ]);
    assert_eq!(answer["touching_pairs"], 1);
    assert!(answer["proof_boxes"].as_u64().unwrap() > 50, "{answer}");
    let svg = std::fs::read_to_string(folder.path("gears.svg")).unwrap();
    for word in ["ruled out", "normal", "contact"] {
        assert!(svg.contains(word), "{word} is missing");
    }
    let alone = palpate(&["plot", "scenes/gears.json", "--proof", "--output", &name]);
    assert_eq!(status(&alone), 2, "a proof is of contacts");
}
