// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! All that is wrong with a file is told at once, and nothing that only follows from it.

use std::fmt::Write;

use palpate_scene::{Scene, SceneError};

fn error(text: &str) -> SceneError {
    Scene::from_json(text).expect_err(text)
}

/// The paths of an error, and what is wrong there.
fn told(text: &str) -> Vec<String> {
    let error = Scene::from_json(text).err();
    let problems = error.iter().flat_map(SceneError::problems);
    problems.map(|problem| format!("{}: {}", problem.path, problem.problem)).collect()
}

/// Parts of a scene: as they should be, with a mistake, and what is told of the mistake.
const PARTS: [(&str, &str, &[&str]); 12] = [
    (
        "\"radius\": 0.04",
        "\"radius\": \"big\"",
        &["shapes.cup.difference[0].cylinder.radius: radius must be a number, got \"big\""],
    ),
    (
        "\"height\": 0.1 } }, 1",
        "\"heigt\": 0.1 } }, 1",
        &[
            "shapes.cup.difference[0].cylinder.heigt: unknown key `heigt`, did you mean `height`?",
        ],
    ),
    (
        "[0, 0.01, 0]",
        "[0, 0.01, 0, 1]",
        &["shapes.cup.difference[1].translate: translate must have 3 numbers in 3D, got 4"],
    ),
    (
        "\"radius\": 0.035",
        "\"radius\": -1",
        &["shapes.cup.difference[1].of.cylinder.radius: radius must be positive, got -1 m"],
    ),
    (
        "\"offset\": -0.002",
        "\"offset\": \"x\"",
        &["shapes.lid.offset: offset must be a number, got \"x\""],
    ),
    (
        "\"cup\" ] }, 2",
        "\"cap\" ] }, 2",
        &["shapes.set.union[1]: unknown shape `cap`, did you mean `cup`?"],
    ),
    ("\"name\": \"first\"", "\"name\": 3", &["bodies[0].name: name must be a string, got 3"]),
    ("\"name\": \"second\", ", "", &["bodies[1]: missing key `name`"]),
    (
        "\"material\": \"wood\"",
        "\"material\": \"wod\"",
        &["bodies[1].material: unknown material `wod`, did you mean `wood`?"],
    ),
    (
        "\"radius\": 0.001, \"max_force\": 3",
        "\"radius\": -1, \"max_force\": 0",
        &[
            "tool.max_force: max_force must be positive, got 0 N",
            "tool.radius: radius must be zero or more, got -1 m",
        ],
    ),
    (
        "\"duration\": 1",
        "\"duration\": 0",
        &["motions[0].duration: duration must be positive, got 0 s"],
    ),
    (
        "\"width\": 1",
        "\"width\": 1e999",
        &["views[0].width: width must be within the range of numbers, got 1e999"],
    ),
];

const SCENE: &str = r#"{ "palpate": 1, "dimension": 3,
  "shapes": {
    "lid": { "offset": -0.002, "of": { "shape": "cup" } },
    "cup": { "difference": [ { "cylinder": { "radius": 0.04, "height": 0.1 } }, 1
      { "translate": [0, 0.01, 0], "of": { "cylinder": { "radius": 0.035, "height": 0.1 } } } ] },
    "set": { "union": [ "lid", "cup" ] }, 2
    "bead": { "ball": { "radius": 1 } } },
  "bodies": [ { "name": "first", "shape": "set" },
    { "name": "second", "shape": "lid", "material": "wood" } ],
  "tool": { "radius": 0.001, "max_force": 3 },
  "motions": [ { "body": "second", "to": { "translation": [0, 1, 0] }, "duration": 1 } ],
  "views": [ { "name": "front", "width": 1 } ] }"#;

/// The scene with the mistakes of a set of parts, and what is to be told of them.
fn scene(mistakes: usize) -> (String, Vec<String>) {
    let mut text = SCENE.to_owned();
    let mut expected = Vec::new();
    for (i, (good, bad, problems)) in PARTS.iter().enumerate() {
        assert_eq!(text.matches(good).count(), 1, "{good}");
        if mistakes >> i & 1 == 1 {
            text = text.replace(good, bad);
            expected.extend(problems.iter().map(ToString::to_string));
        }
    }
    expected.sort();
    (text.replace("} }, 1", "} },").replace("] }, 2", "] },"), expected)
}

#[test]
fn the_mistakes_of_a_file_are_those_of_its_parts() {
    for mistakes in 0..1 << PARTS.len() {
        let (text, expected) = scene(mistakes);
        let mut told = told(&text);
        told.sort();
        assert_eq!(told, expected, "{text}");
    }
}

#[test]
fn problems_are_told_in_their_order_with_a_count() {
    let text = "{ palpate: 1, \"dimension\": 3, // one\n\"bodies\": [ { \"name\": \"\",\n\
                \"shape\": { \"ball\": { \"radius\": -1, } } } ] }";
    assert_eq!(
        error(text).to_string(),
        "5 problems:\n  \
         line 1, column 3: not JSON: the key `palpate` stands without double quotes\n    \
         { palpate: 1, \"dimension\": 3, // one\n      ^\n  \
         line 1, column 31: not JSON: a comment; JSON has none, but every object may have a \
         `description`\n    \
         { palpate: 1, \"dimension\": 3, // one\n                                  ^\n  \
         bodies[0].name, line 2: name must not be empty\n  \
         bodies[0].shape.ball.radius, line 3: radius must be positive, got -1 m\n  \
         line 3, column 34: not JSON: a comma before `}`; nothing follows it\n    \
         \"shape\": { \"ball\": { \"radius\": -1, } } } ] }\n                                     ^"
    );
}

#[test]
fn a_way_of_writing_is_told_once_with_a_count() {
    let text = SCENE.replace("} }, 1", "} },").replace("] }, 2", "] },").replace('"', "'");
    let error = error(&text);
    assert_eq!(error.problems().count(), 1);
    let more = SCENE.matches('"').count() / 2 - 1;
    let quotes = "not JSON: other quotes than double ones; JSON has `\"` alone";
    assert_eq!(error.first().problem, format!("{quotes}; {more} times more below"));
}

#[test]
fn at_most_twenty_problems_are_told() {
    let scene = |count: usize| {
        let mut bodies = String::new();
        for i in 0..count {
            let comma = if i == 0 { "" } else { "," };
            let ball = r#"{ "ball": { "radius": 0 } }"#;
            write!(bodies, "{comma}\n{{ \"name\": \"{i}\", \"shape\": {ball} }}").unwrap();
        }
        error(&format!("{{ \"palpate\": 1, \"dimension\": 3, \"bodies\": [{bodies}] }}"))
    };
    for (count, is_all, head) in [
        (20, true, "20 problems:\n"),
        (21, false, "20 problems, and maybe more:\n"),
        (100_000, false, "20 problems, and maybe more:\n"),
    ] {
        let error = scene(count);
        assert_eq!((error.problems().count(), error.is_all()), (20, is_all));
        assert!(error.to_string().starts_with(head), "{error}");
        assert_eq!(error.first().path, "bodies[0].shape.ball.radius");
    }
}

/// A guess of what a value may be is not itself judged.
#[test]
fn a_value_that_is_guessed_has_one_problem() {
    let scene = |radius: &str| {
        format!(
            r#"{{ "palpate": 1, "dimension": 3, "bodies": [
                {{ "name": "a", "shape": {{ "ball": {{ "radius": {radius} }} }} }} ] }}"#
        )
    };
    for radius in ["NaN", "None", "-5mm", "0 mm", "-1e999"] {
        assert_eq!(told(&scene(radius)).len(), 1, "{radius}: {:?}", told(&scene(radius)));
    }
    assert_eq!(told(&scene("+0")).len(), 2);
}

#[test]
fn a_shape_of_neither_dimension_is_told_where_it_is_written() {
    let text = r#"{ "palpate": 1, "dimension": 3,
        "shapes": { "a": "b", "b": { "rotate_degrees": 30, "of": { "torus": { "radius": 1 } } } },
        "bodies": [ { "name": "a", "shape": "a" }, { "name": "b", "shape": "b" } ] }"#;
    assert_eq!(
        told(text),
        [
            "shapes.b.rotate_degrees: rotate_degrees must be an object with `axis` and `angle` in 3D, got a number",
            "shapes.b.of.torus: missing key `ring_radius`: the radius of the circle",
        ]
    );
}

#[test]
fn a_wrong_dimension_is_guessed_to_read_on() {
    let scene = |dimension: &str| {
        format!(
            r#"{{ "palpate": 1, {dimension} "bodies": [
                {{ "name": "a", "shape": {{ "cone": {{ "radius": 0, "height": 1 }} }} }} ] }}"#
        )
    };
    let radius = "bodies[0].shape.cone.radius: radius must be positive, got 0 m";
    let expected = "dimension: dimension must be 2 or 3, got \"3D\"";
    assert_eq!(told(&scene("\"dimension\": \"3D\",")), [expected, radius]);
    let expected = ": missing key `dimension`: 2 for the plane, 3 for space";
    assert_eq!(told(&scene("")), [expected]);
    assert!(!error(&scene("")).is_all());
}
