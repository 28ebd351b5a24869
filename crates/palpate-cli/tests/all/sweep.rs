// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate sweep`: when the bodies of a scene touch first.

use crate::common::{Folder, assert_refused, errors, json, palpate, status, text};

/// A ball of 10 mm falls from 0.5 m by 1 m in a second, onto a floor, past a wall; and a stone lies.
pub(crate) const FALL: &str = r#"{ "palpate": 1, "dimension": 3, "bodies": [
    { "name": "floor", "shape": { "half_space": { "normal": [0, 1, 0], "offset": 0 } } },
    { "name": "ball", "shape": { "ball": { "radius": 0.01 } },
      "pose": { "translation": [0, 0.5, 0] } },
    { "name": "wall", "shape": { "box": { "size": [0.1, 3, 1] } },
      "pose": { "translation": [0.1, 0, 0] } } ],
  "motions": [ { "body": "ball", "to": { "translation": [0, -0.5, 0] } } ] }"#;

#[test]
fn a_ball_that_falls_touches_the_floor_and_passes_the_wall() {
    let folder = Folder::new();
    let scene = folder.write("fall.json", FALL);
    let found = palpate(&["sweep", &scene]);
    assert_eq!(status(&found), 0);
    let said = text(&found);
    // At (0.5 − 0.01) m of 1 m/s.
    assert!(said.starts_with("floor – ball: touching at 0.490000"), "{said}");
    assert!(
        said.contains("ball – wall: apart all the time by more than half of the gap, proven ("),
        "{said}"
    );
    assert!(said.contains("\n3 bodies until 1 s: 1 pair touches (separation up to "), "{said}");
    let found = json(&["sweep", &scene, "--tolerance", "1e-7", "--json"]);
    let pair = &found["pairs"][0];
    let [lower, upper] = ["lower", "upper"].map(|key| pair[key].as_f64().unwrap());
    assert!(lower <= 0.49 && upper - lower <= 1e-7 && (upper - 0.49).abs() <= 2e-7, "{pair}");
    assert_eq!((&pair["verdict"], &pair["start"]), (&"touching".into(), &().into()));
    assert!((pair["contact"]["normal"][1].as_f64().unwrap() - 1.0).abs() < 1e-9);
    // The same pair alone, and a time at which nothing touches yet.
    let wall = palpate(&["sweep", &scene, "--body", "wall"]);
    assert_eq!(status(&wall), 1);
    let early = palpate(&["sweep", &scene, "--until", "0.48"]);
    assert_eq!(status(&early), 1);
    assert!(text(&early).contains("0 pairs touch"), "{}", text(&early));
}

/// A pendulum of three whole turns meets a stop on its first, and one that repeats does so again.
#[test]
fn motions_of_many_turns_and_those_that_repeat_are_looked_at_part_by_part() {
    let folder = Folder::new();
    let scene = |repeat: &str, stop: f64| {
        format!(
            r#"{{ "palpate": 1, "dimension": 2, "bodies": [
              {{ "name": "stop", "shape": {{ "rectangle": {{ "size": [0.1, 0.1] }} }},
                 "pose": {{ "translation": [0, {stop}] }} }},
              {{ "name": "bar", "shape": {{ "rectangle": {{ "size": [1, 0.02] }} }} }} ],
              "motions": [ {{ "body": "bar", "to": {{ "rotate_degrees": 0 }}, "turns": 3,
                              "duration": 3, "repeat": "{repeat}" }} ] }}"#
        )
    };
    let near = folder.write("near.json", &scene("once", 0.45));
    let found = json(&["sweep", &near, "--json"]);
    // The bar's end reaches the stop's lower right corner, at (0.05, 0.4).
    let upper = found["pairs"][0]["upper"].as_f64().unwrap();
    let corner = 0.4_f64.atan2(0.05) - (0.01 / 0.05_f64.hypot(0.4)).asin();
    let truth = corner / std::f64::consts::TAU;
    assert!((upper - truth).abs() < 1e-3, "{upper} s, {truth} s");
    let far = folder.write("far.json", &scene("loop", 0.6));
    let found = palpate(&["sweep", &far, "--until", "7.5"]);
    assert_eq!(status(&found), 1);
    assert!(text(&found).starts_with("stop – bar: apart all the time"), "{}", text(&found));
}

#[test]
fn a_picture_shows_the_touch_the_way_and_the_boxes() {
    let folder = Folder::new();
    let scene = folder.write("fall.json", FALL);
    let picture = folder.path("touch.svg").display().to_string();
    let drawn = palpate(&["sweep", &scene, "--plot", &picture]);
    assert_eq!(status(&drawn), 0, "{}", errors(&drawn));
    let svg = std::fs::read_to_string(&picture).unwrap();
    for word in [
        "first touch",
        "ball before",
        "way of the point of ball",
        "no touch there",
        "separation",
    ] {
        assert!(svg.contains(word), "{word}");
    }
    // Apart all the time: neither a touch nor a way to it.
    let apart = ["sweep", &scene, "--body", "wall", "--plane", "xz", "--plot", &picture];
    assert_eq!(status(&palpate(&apart)), 1);
    let svg = std::fs::read_to_string(&picture).unwrap();
    assert!(svg.contains("apart all the time") && !svg.contains("first touch"));
    let over = palpate(&["sweep", &scene, "--plot", &scene]);
    assert_eq!(status(&over), 2, "{}", errors(&over));
}

#[test]
fn what_cannot_be_swept_is_refused() {
    let folder = Folder::new();
    let end = FALL.find(",\n  \"motions\"").unwrap();
    let still = folder.write("still.json", &format!("{} }}", &FALL[..end]));
    assert_refused(
        &["sweep", &still],
        "sweep is about bodies that move, and there are no `motions`: give some to the scene, or a file \
         of them by --motion; palpate contact tells where bodies at rest touch",
    );
    let rises = r#"{ "palpate_motions": 1, "motions": [ { "body": "wall", "duration": 2,
        "to": { "translation": [-0.1, 0, 0] } } ] }"#;
    let file = folder.write("rises.json", rises);
    let found = json(&["sweep", &still, "--motion", &file, "--json"]);
    // 0.04 m of 0.2 m in 2 s, and the floor from the first.
    let pair =
        found["pairs"].as_array().unwrap().iter().find(|pair| pair["bodies"][0] == "ball");
    let upper = pair.unwrap()["upper"].as_f64().unwrap();
    assert!((upper - 0.4).abs() < 1e-3, "{upper}");
    let wrong = folder.write("wrong.json", &rises.replace("wall", "well"));
    let told = errors(&palpate(&["sweep", &still, "--motion", &wrong]));
    assert!(told.contains("wrong.json: motions[0].body, line 1: unknown body"), "{told}");
    let scene = folder.write("fall.json", FALL);
    assert_eq!(status(&palpate(&["sweep", &scene, "--until", "1e9"])), 0);
    // Once only periods counted, and each of so many half turns took memory.
    for (more, until) in [("\"turns\": 2000000000", "1"), ("\"repeat\": \"loop\"", "1e9")] {
        let spins = FALL.replace("} } ] }", &format!("}}, {more} }} ] }}"));
        let spins = folder.write("spins.json", &spins);
        let refused = palpate(&["sweep", &spins, "--until", until]);
        let told = errors(&refused);
        assert_eq!(status(&refused), 2, "{told}");
        assert!(told.ends_with(", of which 1e5 are looked at; lower --until\n"), "{told}");
    }
    let turns = FALL.replace("\"body\": \"ball\"", "\"body\": \"floor\"").replace(
        "\"translation\": [0, -0.5, 0]",
        "\"rotate_degrees\": { \"axis\": [1, 0, 0], \"angle\": 20 }",
    );
    // A floor without bounds may turn; the wall stands in it.
    let turns = folder.write("turns.json", &turns);
    let found = palpate(&["sweep", &turns]);
    assert_eq!(status(&found), 0);
    assert!(text(&found).contains("floor – ball: apart all the time"), "{}", text(&found));
}

#[test]
fn local_searches_stand_beside_the_proven_answer() {
    let folder = Folder::new();
    let scene = folder.write("fall.json", FALL);
    for method in ["golden_section", "naive", "macklin", "minimax_proximal", "sum_descent"] {
        let asked = ["sweep", &scene, "--method", method, "--json"];
        let found = json(&asked);
        let local = &found["pairs"][0]["local"];
        assert_eq!(local["method"], method);
        // A floor has no surface for triangles, the ball has; steps are a sixtieth of a second.
        let time = local["time"].as_f64().unwrap();
        assert!((0.4899..0.51).contains(&time), "{method}: {time}");
        assert!(found["pairs"][1]["local"]["time"].is_null(), "{method}: {found}");
    }
    let said = text(&palpate(&["sweep", &scene, "--method", "golden_section"]));
    assert!(said.contains("\n    golden_section finds a touch at 0.49000"), "{said}");
    assert!(said.contains("no touch, which proves nothing"), "{said}");
    // A plate that is thinner than a step is long is passed.
    let thin = FALL.replace(
        "\"half_space\": { \"normal\": [0, 1, 0], \"offset\": 0 }",
        "\"box\": { \"size\": [1, 0.001, 1] }",
    );
    let thin = folder.write("thin.json", &thin);
    let said = text(&palpate(&["sweep", &thin, "--method", "sum_descent", "--samples", "7"]));
    assert!(said.contains("sum_descent finds no touch: missed"), "{said}");
}

#[test]
fn methods_and_their_options_are_checked() {
    let folder = Folder::new();
    let scene = folder.write("fall.json", FALL);
    for (arguments, said) in [
        (&["--method", "newton"][..], "there is no method \"newton\"; there are naive, "),
        (&["--samples", "9"], "--method"),
        (
            &["--method", "golden_section", "--samples", "9"],
            "--samples is not for --method golden_section",
        ),
        (
            &["--method", "sum_descent", "--cells", "9"],
            "--cells is not for --method sum_descent",
        ),
    ] {
        let asked: Vec<&str> = ["sweep", &scene].iter().chain(arguments).copied().collect();
        let refused = palpate(&asked);
        assert_eq!(status(&refused), 2, "{arguments:?}");
        assert!(errors(&refused).contains(said), "{}", errors(&refused));
    }
}
