// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate gradients`.

use serde_json::Value;

use crate::common::{Folder, assert_refused, disc, json, number, palpate, text};
use crate::pictures::words;

/// What a method found.
fn of<'a>(answer: &'a Value, method: &str) -> &'a Value {
    let methods = answer["methods"].as_array().unwrap();
    methods.iter().find(|found| found["method"] == method).unwrap()
}

/// Of a disc the gradient is P/‖P‖; outside, the closest vector is right, inside it is opposite. A
/// dichotomy is off by at most 120°/2¹⁰; at an angle of 60° it starts at the answer.
#[test]
fn the_gradients_of_a_disc_are_those_of_its_closed_form() {
    let folder = Folder::new();
    let scene = folder.write("disc.json", &disc(1.0));
    for (at, closest, offset) in [("1.8,2.4", 0.0, 5e-4), ("0.3,0.4", 180.0, 1e-5)] {
        let answer = json(&["gradients", &scene, "--at", at, "--json"]);
        let error = |method| number(&of(&answer, method)["error_degrees"]);
        assert!((error("closest_vector") - closest).abs() < 1e-6, "{answer}");
        assert!(error("differences") < 1e-6 && error("exact") < 1e-12, "{answer}");
        for method in ["dichotomy", "adaptive_dichotomy"] {
            // The nearest of the angles 60° − i·120°/512 to that of (3, 4), 53.13°.
            let steps = (60.0 - 4.0_f64.atan2(3.0).to_degrees()) / (120.0 / 512.0);
            let expected = (steps - steps.round()).abs() * (120.0 / 512.0);
            assert!((error(method) - expected).abs() < 1e-6, "{method}: {answer}");
        }
        let evaluations =
            ["closest_vector", "differences", "dichotomy", "adaptive_dichotomy", "exact"]
                .map(|method| of(&answer, method)["evaluations"].as_u64().unwrap());
        assert_eq!(evaluations, [2, 4, 12, 13, 2]);
        // Five millionths of 2 m; the value 2 m outside, over 4000.
        assert!((number(&answer["offset"]) - 1e-5).abs() < 1e-18, "{answer}");
        assert!((number(&answer["adaptive_offset"]) - offset).abs() < 1e-15, "{answer}");
        assert_eq!(answer["precision"], "double");
    }
    // On the surface the closest vector has no length; at the centre all differences are zero.
    let on = json(&["gradients", &scene, "--at", "1,0", "--json"]);
    assert_eq!(of(&on, "closest_vector")["direction"], Value::Null);
    assert!(of(&on, "closest_vector")["obstacle"].as_str().unwrap().contains("on the surface"));
    let centre = text(&palpate(&["gradients", &scene, "--at", "0,0"]));
    let flat = "differences          no direction: the values on both sides are equal\n";
    assert!(centre.contains(flat), "{centre}");
}

/// On the diagonal of a square two sides are equally near, and the gradient is that of one.
#[test]
fn where_the_gradient_jumps_none_is_called_exact() {
    let folder = Folder::new();
    let scene = r#"{ "palpate": 1, "dimension": 2, "bodies":
        [{ "name": "a", "shape": { "rectangle": { "size": [2, 2] } } }] }"#;
    let scene = folder.write("square.json", scene);
    let note = "note                 the gradient jumps here: there is none, and `exact` is that of \
                one side\n";
    let bead = r#"{ "palpate": 1, "dimension": 2, "bodies": [
        { "name": "a", "shape": { "rectangle": { "size": [100, 100] } } },
        { "name": "b", "shape": { "translate": [0, 60], "of": { "circle": { "radius": 0.005 } } } } ] }"#;
    // Within the offset of this point, the gradient turns by a tenth, smoothly.
    let bead = folder.write("bead.json", bead);
    let turned = text(&palpate(&["gradients", &bead, "--at", "0,60.0051"]));
    assert!(!turned.contains("note"), "{turned}");
    for (at, jumps) in [("0.5,0.5", true), ("0.5,0.2", false), ("1.5,0.2", false)] {
        let said = text(&palpate(&["gradients", &scene, "--at", at]));
        assert_eq!(said.contains(note), jumps, "{at}: {said}");
        let answer = json(&["gradients", &scene, "--at", at, "--json"]);
        assert_eq!(answer["gradient_jumps"], jumps);
    }
}

#[test]
fn single_precision_is_what_spoils_the_memoirs_gradients() {
    let star = [
        "gradients",
        "scenes/memoir_star.json",
        "--at",
        "1.35,0.8",
        "--offset",
        "5e-6",
        "--json",
    ];
    let [double, single] =
        [&[][..], &["--single"]].map(|more| json(&[&star[..], more].concat()));
    assert_eq!(
        (&double["precision"], &single["precision"]),
        (&"double".into(), &"single".into())
    );
    for (method, least) in [("differences", 0.01), ("dichotomy", 0.12)] {
        let [double, single] =
            [&double, &single].map(|answer| number(&of(answer, method)["error_degrees"]));
        assert!(double < 120.0 / 1024.0 && single > least, "{method}: {double} {single}");
    }
    assert_eq!(of(&double, "exact"), of(&single, "exact"));
}

#[test]
fn in_space_the_dichotomy_is_said_to_be_only_in_the_plane() {
    let folder = Folder::new();
    let plot = folder.name("gradients.svg");
    let arguments = ["gradients", "scenes/s1.json", "--at", "0.3,0.4,0", "--plot", &plot];
    let said = text(&palpate(&arguments));
    assert!(said.contains("dichotomy            only in the plane\n"), "{said}");
    assert!(said.contains("adaptive_dichotomy   only in the plane\n"), "{said}");
    let answer = json(&[&arguments[..], &["--json"]].concat());
    assert_eq!(of(&answer, "dichotomy")["obstacle"], "only in the plane");
    assert!(number(&of(&answer, "differences")["error_degrees"]) < 1e-6);
    assert_eq!(of(&answer, "differences")["evaluations"], 6);
    let svg = std::fs::read_to_string(&plot).unwrap();
    let words = words(&svg);
    assert!(words.contains(&"differences") && !words.contains(&"dichotomy"), "{words:?}");
}

/// A panel a method, with one scale.
#[test]
fn errors_are_drawn_in_panels() {
    let folder = Folder::new();
    let scene = folder.write("disc.json", &disc(1.0));
    let plot = folder.name("gradients.svg");
    let output = ["gradients", &scene, "--at", "1,0", "--size", "0.5", "--plot", &plot];
    assert!(text(&palpate(&output)).contains("gradient             1, 0\n"));
    let svg = std::fs::read_to_string(&plot).unwrap();
    let words = words(&svg);
    for word in ["closest vector", "differences", "dichotomy", "adaptive dichotomy", "exact"] {
        assert!(words.contains(&word), "{word} in {words:?}");
    }
    let scales =
        words.iter().filter(|word| **word == "angle from the exact gradient [degrees]");
    assert_eq!(scales.count(), 1);
    for tick in ["0.001", "0.01", "0.1", "1", "10", "100"] {
        assert!(words.contains(&tick), "{tick} in {words:?}");
    }
}

#[test]
fn what_cannot_be_compared_is_refused_in_a_sentence() {
    let folder = Folder::new();
    let floor = folder.write(
        "floor.json",
        r#"{ "palpate": 1, "dimension": 3, "bodies": [ { "name": "floor",
          "shape": { "half_space": { "normal": [0, 1, 0], "offset": 0 } } } ] }"#,
    );
    let unbounded = ["gradients", &floor, "--at", "0,1,0"];
    assert_refused(
        &unbounded,
        "--offset is needed: no body of the scene has bounds to take it from",
    );
    let plot = folder.name("plot.png");
    assert_refused(
        &[&unbounded[..], &["--offset", "1e-5", "--plot", &plot]].concat(),
        "--size is needed: no body of the scene has bounds to draw",
    );
    assert_refused(
        &["gradients", "scenes/s1.json", "--at", "0,1"],
        "the scene is 3D: a point is 3 numbers x,y,z joined by commas, got 2 in \"0,1\"",
    );
}
