// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate descend` over elements: the memoir's descent, starts, circles.

use serde_json::Value;

use crate::common::{
    Folder, assert_refused, disc, errors, json, number, palpate, status, text,
};
use crate::pictures::words;

const STAR: [&str; 2] = ["descend", "scenes/memoir_star.json"];
/// The minimum over this triangle is the centre of the scene's circle, 0.2 m deep.
const DEEP: [&str; 4] = ["--triangle", "0.5,0.3", "1.1,0.9", "0.6,1.1"];
/// The centroid is outside, and the minimum inside.
const ACROSS: [&str; 4] = ["--triangle", "1.2,0.2", "1.6,0.9", "1.0,0.75"];
/// 1 m by 1 cm, clear of the star.
const SLIVER: [&str; 4] = ["--triangle", "0.2,1.4", "1.2,1.5", "0.7,1.46"];

fn naive(triangle: &[&str], more: &[&str]) -> Value {
    json(&[&STAR[..], triangle, &["--method", "naive", "--json"], more].concat())
}

/// The path of three steps is that of the library's test, by hand: from 3 m, halves of the value.
#[test]
fn the_naive_descent_takes_the_steps_that_are_asked_for() {
    let folder = Folder::new();
    let scene = folder.write("disc.json", &disc(1.0));
    let answer = json(&[
        "descend",
        &scene,
        "--segment",
        "0,0",
        "0,4",
        "--start",
        "0.25,0.75",
        "--method",
        "naive",
        "--alpha",
        "0.5",
        "--mu",
        "0.25",
        "--iterations",
        "3",
        "--gradient",
        "exact",
        "--json",
    ]);
    assert_eq!(
        answer["path"],
        serde_json::json!([[0.0, 3.0], [0.0, 2.0], [0.0, 1.5], [0.0, 1.25]])
    );
    assert_eq!((&answer["alpha"], &answer["mu"]), (&0.5.into(), &0.25.into()));
    assert_eq!((&answer["steps"], &answer["evaluations"]), (&3.into(), &10.into()));
    assert_eq!(
        (&answer["gradient"], &answer["memoir_evaluations"]),
        (&"exact".into(), &30.into())
    );
    assert_eq!(answer["ending"]["at"], "elsewhere");
    // The least value, −1 at the centre, is proven to within a ten-thousandth of 4 m.
    assert!((number(&answer["ending"]["above_minimum"]) - 1.25).abs() < 4e-4);
}

#[test]
fn the_naive_descent_counts_its_evaluations_and_those_of_the_memoir() {
    let answer = naive(&DEEP, &[]);
    assert_eq!((&answer["steps"], &answer["evaluations"]), (&64.into(), &(64 * 13 + 1).into()));
    assert_eq!(
        (&answer["memoir_evaluations"], &answer["gradient"]),
        (&640.into(), &"dichotomy".into())
    );
    assert_eq!(answer["path"].as_array().unwrap().len(), 65);
    // From the centroid, with a tenth of the longest edge for µ: that of 0.6·√2 m.
    assert!((number(&answer["path"][0][0]) - 2.2 / 3.0).abs() < 1e-15, "{answer}");
    assert!((number(&answer["mu"]) - 0.06 * 2.0_f64.sqrt()).abs() < 1e-15, "{answer}");
    for time in [&answer["time"], &answer["certified"]["time"]] {
        assert!((1e-9..10.0).contains(&number(time)), "{answer}");
    }
}

/// Steps of α·µ = 0.1 m cross the deepest point; with a step of 2 mm the amplitude is 2 mm.
#[test]
fn an_oscillation_is_named_with_its_amplitude() {
    let folder = Folder::new();
    let plot = folder.name("oscillation.svg");
    let answer = naive(&DEEP, &["--mu", "1", "--start", "0.6,0.2,0.2", "--plot", &plot]);
    assert!((number(&answer["ending"]["oscillation"]) - 0.1).abs() < 1e-12, "{answer}");
    let svg = std::fs::read_to_string(&plot).unwrap();
    let words = words(&svg);
    for word in ["naive", "step", "start", "smallest circle", "circumscribed circle"] {
        assert!(words.contains(&word), "{word} in {words:?}");
    }
    let caption = words.join(" ");
    assert!(caption.contains("oscillating by 0.10000 m."), "{caption}");
    let fine = naive(&DEEP, &["--alpha", "0.02", "--iterations", "500", "--mu", "0.1"]);
    assert!((number(&fine["ending"]["oscillation"]) - 0.002).abs() < 1e-12, "{fine}");
    let found = json(&[&STAR[..], &DEEP, &["--json"]].concat());
    assert_eq!(found["ending"]["oscillation"], Value::Null);
}

#[test]
fn without_mu_a_descent_ends_at_the_surface() {
    let answer = naive(&ACROSS, &["--mu", "0"]);
    let ending = &answer["ending"];
    assert_eq!((&ending["at"], &ending["oscillation"]), (&"surface".into(), &Value::Null));
    assert!(number(&ending["value"]) > 0.0 && number(&ending["value"]) < 1e-4, "{ending}");
    assert!(number(&ending["above_minimum"]) > 0.139, "{ending}");
    let output = palpate(&[&STAR[..], &ACROSS, &["--method", "naive", "--mu", "0"]].concat());
    let said = text(&output);
    assert!(said.contains("ended        at the surface, 0.1397"), "{said}");
    assert!(said.contains(" m above the minimum, which is inside\n"), "{said}");
    assert!(said.contains("; the memoir counts 10 a gradient: 640)\n"), "{said}");
    assert_eq!(naive(&ACROSS, &["--mu", "0.3", "--alpha", "0.3"])["ending"]["at"], "minimum");
}

/// The circle of radius 12.7 m meets the star, the smallest one does not.
#[test]
fn the_smallest_circle_excludes_a_sliver_that_the_circumscribed_one_does_not() {
    let folder = Folder::new();
    let plot = folder.name("sliver.svg");
    let answer = json(&[&STAR[..], &SLIVER, &["--json", "--plot", &plot]].concat());
    let [smallest, around] = ["smallest", "circumscribed"].map(|key| &answer["circles"][key]);
    assert_eq!((&smallest["excludes"], &smallest["is_proven"]), (&true.into(), &true.into()));
    assert_eq!((&around["excludes"], &around["is_proven"]), (&false.into(), &false.into()));
    assert!((number(&smallest["radius"]) - 0.5 * 1.01_f64.sqrt()).abs() < 1e-12, "{smallest}");
    // R = abc/4A.
    let sides = [1.01_f64.sqrt(), 0.2516_f64.sqrt(), 0.2536_f64.sqrt()];
    let radius = sides.iter().product::<f64>() / (4.0 * 0.005);
    assert!((number(&around["radius"]) - radius).abs() < 1e-9 * radius, "{around} {radius}");
    let svg = std::fs::read_to_string(&plot).unwrap();
    let caption = words(&svg).join(" ");
    assert!(
        caption.contains(
            "Smallest circle: f(C) = 0.57162 m &gt; r = 0.50249 m: excludes the triangle."
        ),
        "{caption}"
    );
    assert!(caption.contains("does not exclude the triangle."), "{caption}");
    // A segment has one circle, corners on a line too.
    let segment = json(&[&STAR[..], &["--segment", "0.2,1.4", "1.2,1.5", "--json"]].concat());
    let line = ["--triangle", "0,2", "1,2", "0.5,2"];
    let line = json(&[&STAR[..], &line, &["--json"]].concat());
    for answer in [&segment, &line] {
        assert_eq!(answer["circles"]["circumscribed"], Value::Null, "{answer}");
    }
    // In space they are balls.
    let space = ["--triangle", "-1,0.3,0", "1,0.2,0.1", "0.1,0.9,-0.6"];
    let output = palpate(&[&["descend", "scenes/s3.json"][..], &space].concat());
    assert!(
        text(&output).contains("smallest ball about 0, 0.25, 0.05 m: f(C) = "),
        "{}",
        text(&output)
    );
}

#[test]
fn every_search_over_an_element_starts_where_it_is_told() {
    for method in ["naive", "projected_gradient", "frank_wolfe", "golden_section", "macklin"] {
        let start = ["--start", "0.5,0.25,0.25", "--method", method, "--json"];
        let answer = json(&[&STAR[..], &DEEP, &start].concat());
        let first = [0, 1].map(|i| number(&answer["path"][0][i]));
        assert!(
            (first[0] - 0.675).abs() < 1e-15 && (first[1] - 0.65).abs() < 1e-15,
            "{first:?}"
        );
    }
}

#[test]
fn what_does_not_fit_is_refused_in_a_sentence() {
    let with = |more: &[&'static str]| [&STAR[..], &DEEP, more].concat();
    let in_metres = "--start of a triangle is the barycentric weights u,v,w of its corners, got \"0.2,0.5\"; \
                     a point in metres starts a search between two bodies, without --triangle and --segment";
    for (more, said) in [
        (&["--start", "0.2,0.5"][..], in_metres),
        (
            &["--start", "0.5,0.5,0.5"],
            "--start: barycentric weights must add up to 1, got 0.5,0.5,0.5, which is 1.5",
        ),
        (
            &["--start", "1.5,-0.5,0"],
            "--start: a barycentric weight must be from 0 to 1, got 1.5",
        ),
        (
            &["--start", "1,0,0", "--start", "0,1,0"],
            "a search over an element has one --start, got 2",
        ),
        (&["--alpha", "0.1"], "--alpha is only for --method naive"),
        (&["--mu", "0.1"], "--mu is only for --method naive"),
        (&["--iterations", "3"], "--iterations is only for --method naive"),
        (&["--gradient", "exact"], "--gradient is only for --method naive"),
        (
            &["--method", "naive", "--alpha", "-1"],
            "--alpha must be positive and finite, got -1.0",
        ),
        (
            &["--method", "naive", "--alpha", "nan"],
            "--alpha must be positive and finite, got NaN",
        ),
        (&["--method", "naive", "--mu", "-1"], "--mu must be from 0 m to 1e15 m, got -1.0 m"),
        (
            &["--method", "naive", "--iterations", "100001"],
            "--iterations must be at most 100000, got 100001",
        ),
        (
            &["--method", "naive", "--gradient", "newton"],
            "--gradient: there is no method \"newton\"; there are closest_vector, differences, dichotomy, adaptive_dichotomy, exact",
        ),
        (
            &["--method", "newton"],
            "--method: there is no method \"newton\"; there are naive, projected_gradient, frank_wolfe, golden_section, macklin",
        ),
        (
            &["--method", "minimax_proximal"],
            "--method minimax_proximal searches between two bodies: leave out --triangle and --segment",
        ),
    ] {
        assert_refused(&with(more), said);
    }
    let two = ["descend", "scenes/memoir_two_bodies.json", "--start", "0,0"];
    for (more, said) in [
        (
            &["--method", "naive"][..],
            "--method naive searches over an element: give --triangle or --segment",
        ),
        (&["--alpha", "1"], "--alpha is only for --method naive"),
    ] {
        assert_refused(&[&two[..], more].concat(), said);
    }
    let segment = ["descend", "scenes/s3.json", "--segment", "-1,0,0", "1,0,0"];
    assert_refused(
        &[&segment[..], &["--start", "1,0,0"]].concat(),
        "--start of a segment is the barycentric weights u,v of its corners, got \"1,0,0\"; \
         a point in metres starts a search between two bodies, without --triangle and --segment",
    );
    assert_refused(
        &[&segment[..], &["--method", "naive", "--gradient", "dichotomy"]].concat(),
        "--gradient dichotomy turns in the plane, and this scene is in 3D: take differences, closest_vector or exact",
    );
    assert_refused(
        &[&segment[..], &["--halton", "4"]].concat(),
        "--halton is for starts between two bodies: leave out --triangle and --segment",
    );
    let output = palpate(&["descend", "scenes/s3.json", "--method", "naive"]);
    assert_eq!(status(&output), 2, "{}", errors(&output));
}

#[test]
fn starts_of_halton_find_the_overlap() {
    let scene = "scenes/memoir_two_bodies.json";
    let found =
        json(&["descend", scene, "--method", "sum_descent", "--halton", "40", "--json"]);
    let descents = found["descents"].as_array().unwrap();
    assert_eq!(descents.len(), 40);
    let inside = descents.iter().filter(|descent| descent["value"].as_f64().unwrap() <= 0.0);
    let right = |descent: &Value| descent["best"][0].as_f64().unwrap() > 0.0;
    let inside: Vec<_> = inside.collect();
    assert!(inside.len() > 10 && inside.iter().all(|descent| right(descent)), "{found}");
}
