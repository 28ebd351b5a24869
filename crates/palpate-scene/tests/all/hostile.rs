// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Files made to exhaust memory, stack or time get an error at once.

use std::fmt::Write;

use palpate_scene::Scene;

fn error_of(text: &str) -> String {
    Scene::from_json(text).expect_err("a hostile file").to_string()
}

fn scene(shapes: &str, shape: &str) -> String {
    format!(
        r#"{{ "palpate": 1, "dimension": 3, "shapes": {{ {shapes} }},
            "bodies": [{{ "name": "a", "shape": {shape} }}] }}"#
    )
}

const BALL: &str = r#"{ "ball": { "radius": 1 } }"#;

#[test]
fn deep_json_is_refused_before_it_is_parsed() {
    let limit = "objects and lists are nested 100000 deep, at most 250 are allowed";
    let error = error_of(&"[".repeat(100_000));
    let open = "`]` is missing for the `[` of line 1, and of 99999 around it";
    assert!(error.contains(open) && error.len() < 500, "{error}");
    let lists = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    assert_eq!(error_of(&lists), format!("line 1: {limit}"));
    let objects = format!("{}0{}", "{\"a\":".repeat(100_000), "}".repeat(100_000));
    assert_eq!(error_of(&objects), format!("line 1: {limit}"));
}

#[test]
fn deep_shapes_are_refused_by_the_shapes_themselves() {
    let nested = |depth: usize| {
        let open = r#"{ "shell": 0.1, "of": "#.repeat(depth);
        scene("", &format!("{open}{BALL}{}", "}".repeat(depth)))
    };
    assert_eq!(Scene::from_json(&nested(63)).map(drop), Ok(()));
    assert!(
        error_of(&nested(64)).ends_with("shapes are nested 65 deep, at most 64 are allowed"),
        "{}",
        error_of(&nested(64))
    );
}

#[test]
fn long_chains_of_references_are_refused() {
    for forward in [true, false] {
        let mut shapes = String::new();
        let count = 100_000;
        for i in 0..count {
            let last = if forward { i == count - 1 } else { i == 0 };
            let next = if forward { i + 1 } else { i.max(1) - 1 };
            let shape = if last { BALL.to_owned() } else { format!("\"s{next}\"") };
            let comma = if i == 0 { "" } else { "," };
            write!(shapes, "{comma}\"s{i}\": {shape}").unwrap();
        }
        let error = error_of(&scene(&shapes, "\"s0\""));
        assert!(
            error.ends_with("shapes are nested more than 128 deep, references followed"),
            "{error}"
        );
    }
}

#[test]
fn doubling_references_are_refused() {
    for operator in ["union", "intersection", "symmetric_difference", "difference"] {
        let mut shapes = format!("\"s0\": {BALL}");
        for i in 1..60 {
            let inner = i - 1;
            write!(shapes, ",\"s{i}\": {{ \"{operator}\": [\"s{inner}\", \"s{inner}\"] }}")
                .unwrap();
        }
        let error = error_of(&scene(&shapes, "\"s59\""));
        assert!(
            error.ends_with(
                "with all references followed the scene has more than 1000000 nodes, the most allowed"
            ),
            "{error}"
        );
    }
}

#[test]
fn many_moves_of_many_shapes_are_refused() {
    // Each level would copy all members of the union.
    let mut shapes = format!("\"s0\": {BALL}");
    for i in 1..16 {
        let inner = i - 1;
        write!(shapes, ",\"s{i}\": {{ \"union\": [\"s{inner}\", \"s{inner}\"] }}").unwrap();
    }
    let open = r#"{ "translate": [1, 0, 0], "of": "#.repeat(90);
    let text = scene(&shapes, &format!("{open}\"s15\"{}", "}".repeat(90)));
    assert!(error_of(&text).contains("more than 1000000 nodes"), "{}", error_of(&text));
}

#[test]
fn a_million_references_to_one_shape_are_counted() {
    let list = vec!["\"s\""; 1_000_000].join(",");
    let error =
        error_of(&scene(&format!("\"s\": {BALL}"), &format!("{{ \"union\": [{list}] }}")));
    assert!(error.contains("more than 1000000 nodes"), "{error}");
}

/// A million bodies took 5 GB.
#[test]
fn too_many_bodies_are_counted() {
    let body = |i| format!("{{ \"name\": \"{i}\", \"shape\": {BALL} }}");
    let bodies = (0..=100_000).map(body).collect::<Vec<_>>().join(",");
    let text = format!("{{ \"palpate\": 1, \"dimension\": 3, \"bodies\": [{bodies}] }}");
    let error = error_of(&text);
    assert!(error.ends_with("must have at most 100000 bodies, got 100001"), "{error}");
}

#[test]
fn long_names_and_values_are_shortened() {
    let long = "x".repeat(1_000_000);
    for text in [
        scene("", &format!("\"{long}\"")),
        scene("", &format!("{{ \"{long}\": 1 }}")),
        scene("", &format!("{{ \"ball\": {{ \"radius\": \"{long}\" }} }}")),
        scene("", &format!("{{ \"ball\": {{ \"radius\": {} }} }}", "9".repeat(1_000_000))),
        scene(&format!("\"{long}\": \"{long}\""), BALL),
    ] {
        let error = error_of(&text);
        assert!(error.len() < 1000, "{} bytes: {}…", error.len(), &error[..200]);
    }
}

#[test]
fn many_names_are_not_all_listed() {
    let mut shapes = format!("\"s\": {BALL}");
    for i in 0..100_000 {
        write!(shapes, ",\"name {i}\": \"s\"").unwrap();
    }
    let error = error_of(&scene(&shapes, "\"other\""));
    assert!(error.ends_with("`name 14` and 99985 more"), "{error}");
}

#[test]
fn the_largest_scenes_allowed_are_built() {
    // 17 doublings make 131 072 members, and half a million nodes on the way.
    let mut shapes = format!("\"s0\": {BALL}");
    for i in 1..=17 {
        let inner = i - 1;
        write!(shapes, ",\"s{i}\": {{ \"union\": [\"s{inner}\", \"s{inner}\"] }}").unwrap();
    }
    assert_eq!(Scene::from_json(&scene(&shapes, "\"s17\"")).map(drop), Ok(()));
}
