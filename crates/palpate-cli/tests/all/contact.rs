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
    assert!((number(&answer["margin"]) - 0.002).abs() < 1e-12);
    let touching = pair("middle", "right");
    assert_eq!(touching["verdict"], "touching");
    let contact = &touching["contacts"][0];
    assert!((number(&contact["gap"]) - 0.001).abs() < 1e-9);
    assert!((number(&contact["normal"][0]) - 1.0).abs() < 1e-9);
    let bounds = &touching["separation"];
    assert!(number(&bounds["lower"]) <= 0.001 && 0.001 <= number(&bounds["upper"]));
    let resting = pair("left", "floor");
    assert_eq!(resting["verdict"], "touching");
    assert!(number(&resting["contacts"][0]["gap"]).abs() < 1e-9);
    let apart = pair("left", "right");
    assert_eq!(apart["verdict"], "apart");
    let truth = (2.002_f64.powi(2) + 0.25).sqrt() - 1.0;
    let bounds = &apart["separation"];
    assert!(number(&bounds["lower"]) <= truth && truth <= number(&bounds["upper"]));
    assert!((number(&apart["witness"]["gap"]) - truth).abs() < 1e-3);
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
    assert_eq!(whole["pairs"][0]["region_stop"], "converged");
    let options = ["contact", &scene, "--spacing", "1e-6", "--budget", "20000"];
    let part = json(&[&options[..], &["--json"]].concat());
    assert_eq!(part["pairs"][0]["region_stop"], "budget_spent");
    let told = text(&palpate(&options));
    assert!(
        told.contains("the search for contacts spent its budget of 20000 evaluations"),
        "{told}"
    );
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
    assert_eq!(
        text(&said),
        "floor – wall: undecided, neither has bounds; intersect one with a box\n\
         2 bodies: 0 pairs touch (gap up to 2.0000 mm), 0 apart, 1 undecided\n"
    );
}

/// Two balls, `gap` apart.
fn balls(gap: f64) -> String {
    format!(
        r#"{{ "palpate": 1, "dimension": 2, "bodies": [
        {{ "name": "still", "shape": {{ "ball": {{ "radius": 0.5 }} }} }},
        {{ "name": "moved", "shape": {{ "ball": {{ "radius": 0.5 }} }},
          "pose": {{ "translation": [{}, 0] }} }} ],
        "motions": [ {{ "body": "moved", "to": {{ "translation": [1, 0] }}, "duration": 2 }} ] }}"#,
        1.0 + gap
    )
}

#[test]
fn verdicts_are_shown_by_their_bounds() {
    let folder = Folder::new();
    for (gap, margin, expected) in [
        (0.001, "0.0008", "apart"),
        (0.001, "0.0012", "touching"),
        (0.001, "0.001", "undecided"),
    ] {
        let scene = folder.write("balls.json", &balls(gap));
        let output = palpate(&["contact", &scene, "--margin", margin, "--json"]);
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        let pair = &answer["pairs"][0];
        assert_eq!(pair["verdict"], expected, "{margin}: {pair}");
        let margin: f64 = margin.parse().unwrap();
        let bounds = &pair["separation"];
        let [lower, upper] = ["lower", "upper"].map(|key| number(&bounds[key]));
        assert!(lower <= gap && gap <= upper, "{pair}");
        let shown = match expected {
            "apart" => lower > margin,
            "touching" => upper <= margin,
            _ => lower <= margin && margin < upper,
        };
        assert!(shown, "{pair}");
    }
    let scene = folder.write("balls.json", &balls(0.001));
    let said = text(&palpate(&["contact", &scene, "--margin", "0.001"]));
    let why = "       undecided: the margin of 1.0000 mm lies between the bounds; lower the tolerance, \
               or take another margin\n";
    assert!(said.contains(why), "{said}");
}

/// Once a second search dropped what the first had proven.
#[test]
fn what_is_apart_is_proven_for_any_budget() {
    for budget in ["1", "100", "1000"] {
        let scene = "scenes/peg_in_hole.json";
        let answer = json(&["contact", scene, "--budget", budget, "--json"]);
        let margin = number(&answer["margin"]);
        for pair in answer["pairs"].as_array().unwrap() {
            let bounds = &pair["separation"];
            let lower = bounds["lower"].as_f64().unwrap_or(f64::NEG_INFINITY);
            let upper = bounds["upper"].as_f64().unwrap_or(f64::INFINITY);
            match pair["verdict"].as_str().unwrap() {
                "apart" => assert!(lower > margin, "{pair}"),
                "touching" => assert!(upper <= margin, "{pair}"),
                _ => assert!(lower <= margin && margin < upper, "{pair}"),
            }
        }
    }
}

#[test]
fn full_memory_is_told_apart_from_a_spent_budget() {
    let folder = Folder::new();
    // A ball in a socket, everywhere equally near.
    let scene = folder.write(
        "socket.json",
        r#"{ "palpate": 1, "dimension": 3, "bodies": [
          { "name": "ball", "shape": { "ball": { "radius": 0.05 } } },
          { "name": "socket", "shape": { "difference": [
             { "cuboid": { "size": [0.2, 0.2, 0.2] } }, { "ball": { "radius": 0.0501 } } ] } } ] }"#,
    );
    let ask = |budget| {
        let options = ["contact", &scene, "--tolerance", "1e-7", "--budget", budget];
        text(&palpate(&options))
    };
    let said = ask("20000000");
    assert!(said.contains("(memory_full; "), "{said}");
    let small = ask("1000");
    assert!(small.contains("(budget_spent; "), "{small}");
    assert!(small.contains("raise the budget"), "{small}");
}

#[test]
fn the_pairs_of_a_body_are_asked_about_alone() {
    let folder = Folder::new();
    let scene = folder.write("row.json", &row(0.001));
    let answer = json(&["contact", &scene, "--body", "middle", "--body", "middle", "--json"]);
    let pairs = answer["pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), 3);
    for pair in pairs {
        assert!(pair["bodies"].as_array().unwrap().contains(&"middle".into()), "{pair}");
    }
    let said = text(&palpate(&["contact", &scene, "--body", "middle", "--body", "floor"]));
    assert!(
        said.ends_with("4 bodies: 2 pairs touch (gap up to 2.0000 mm), 3 apart, 0 undecided\n"),
        "{said}"
    );
    let unknown = palpate(&["contact", &scene, "--body", "midle"]);
    assert_eq!(status(&unknown), 2);
    let expected = "palpate: --body: unknown body `midle`, did you mean `middle`?\n";
    assert_eq!(errors(&unknown), expected);
}

#[test]
fn pairs_that_are_apart_are_listed_for_few_bodies_or_if_asked_for() {
    let folder = Folder::new();
    let body = |i: usize| {
        let x = 3 * i;
        format!(
            r#"{{ "name": "{i}", "shape": {{ "ball": {{ "radius": 1 }} }},
                 "pose": {{ "translation": [{x}, 0] }} }}"#
        )
    };
    let scene = |count: usize| {
        let bodies: Vec<_> = (0..count).map(body).collect();
        let bodies = bodies.join(", ");
        format!(r#"{{ "palpate": 1, "dimension": 2, "bodies": [ {bodies} ] }}"#)
    };
    let listed = |name: &str, options: &[&str]| {
        let output = folder.run(&[&["contact", name, "--json"], options].concat());
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        answer["pairs"].as_array().unwrap().len()
    };
    folder.write("twelve.json", &scene(12));
    folder.write("more.json", &scene(13));
    assert_eq!(listed("twelve.json", &[]), 66);
    assert_eq!(listed("more.json", &[]), 0);
    assert_eq!(listed("more.json", &["--every-pair"]), 78);
    assert_eq!(listed("more.json", &["--body", "4"]), 12);
}

#[test]
fn bodies_are_where_their_motions_have_taken_them() {
    let folder = Folder::new();
    let scene = folder.write("balls.json", &balls(0.5));
    for (time, gap) in [("0", 0.5), ("1", 0.25), ("2", 0.0), ("9", 0.0)] {
        let output = palpate(&["contact", &scene, "--time", time, "--json"]);
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(number(&answer["time"]), time.parse::<f64>().unwrap());
        let bounds = &answer["pairs"][0]["separation"];
        let [lower, upper] = ["lower", "upper"].map(|key| number(&bounds[key]));
        assert!(lower <= gap + 1e-12 && gap - 1e-12 <= upper, "{time} s: {bounds}");
        assert!(upper - lower <= 0.001, "{time} s: {bounds}");
    }
    assert!(
        text(&palpate(&["contact", &scene, "--time", "1"]))
            .starts_with("at 1 s\nstill – moved")
    );
    let peg = text(&palpate(&["contact", "scenes/peg_in_hole.json", "--time", "1"]));
    assert!(peg.starts_with("at 1 s, as at any time: no body moves\n"), "{peg}");
}

#[test]
fn a_body_alone_has_no_contacts() {
    let alone = palpate(&["contact", "scenes/s1.json"]);
    assert_eq!(status(&alone), 2);
    assert_eq!(
        errors(&alone),
        "palpate: contact is about two bodies or more, and the scene has only \"S1\"; add another to \
         its `bodies`\n"
    );
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
    assert_eq!(answer["touching"], 1);
    assert!(answer["boxes"].as_u64().unwrap() > 50, "{answer}");
    let svg = std::fs::read_to_string(folder.path("gears.svg")).unwrap();
    for word in ["ruled out", "normal", "contact"] {
        assert!(svg.contains(word), "{word} is missing");
    }
    let alone = palpate(&["plot", "scenes/gears.json", "--proof", "--output", &name]);
    assert_eq!(status(&alone), 2, "a proof is of contacts");
}
