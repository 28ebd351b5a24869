// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the program says of input that it cannot use.

use crate::common::{Folder, errors, palpate, status, text};
use serde_json::{Value, json};

const BALL: &str = r#"{ "palpate": 1, "dimension": 3,
  "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.5 } } } ] }"#;

/// What `palpate check` says of a file.
fn checked(folder: &Folder, name: &str, content: &[u8]) -> String {
    std::fs::write(folder.path(name), content).unwrap();
    let output = folder.run(&["check", name]);
    assert_eq!(status(&output), 1, "{}", errors(&output));
    text(&output)
}

#[test]
fn text_that_is_no_json_is_shown_with_a_caret() {
    let folder = Folder::new();
    let comma = BALL.replace("0.5", "0,5");
    assert_eq!(
        checked(&folder, "comma.json", comma.as_bytes()),
        "comma.json: line 2, column 65: not JSON: a decimal comma; write 0.5\n  \
         …odies\": [ { \"name\": \"ball\", \"shape\": { \"ball\": { \"radius\": 0,5 } } } ] }\n  \
         \u{20}                                                            ^\n"
    );
}

#[test]
fn every_problem_of_a_scene_is_told() {
    let folder = Folder::new();
    let bad = BALL.replace("\"ball\",", "\"\",").replace("0.5", "-0.5");
    assert_eq!(
        checked(&folder, "bad.json", bad.as_bytes()),
        "bad.json: 2 problems:\n  \
         bodies[0].name, line 2: name must not be empty\n  \
         bodies[0].shape.ball.radius, line 2: radius must be positive, got -0.5 m\n"
    );
    let answer = folder.run(&["check", "bad.json", "--json"]);
    let answer: Value = serde_json::from_slice(&answer.stdout).unwrap();
    let problem = |path: &str, column: u32, problem: &str| json!({ "path": path, "line": 2, "column": column, "problem": problem });
    let name = problem("bodies[0].name", 17, "name must not be empty");
    let radius = "radius must be positive, got -0.5 m";
    let radius = problem("bodies[0].shape.ball.radius", 50, radius);
    let expected = json!({ "ok": false, "problems": [name, radius], "maybe_more": false });
    assert_eq!(answer, expected);
    let plot = folder.run(&["plot", "bad.json"]);
    assert_eq!(status(&plot), 2);
    assert!(
        errors(&plot).starts_with("palpate: bad.json: 2 problems:\n  bodies[0].name, line 2")
    );
}

#[test]
fn other_encodings_are_named() {
    let folder = Folder::new();
    let units: Vec<u8> = BALL.encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_eq!(
        checked(&folder, "utf16.json", &units),
        "utf16.json: the file is UTF-16 (little-endian); save it as UTF-8, for example with \
         `iconv -f UTF-16LE -t UTF-8`\n"
    );
    let (before, after) = BALL.split_once("all\",").unwrap();
    let latin = [before.as_bytes(), b"\xe4ll\",", after.as_bytes()].concat();
    assert_eq!(
        checked(&folder, "latin.json", &latin),
        "latin.json: the file is not UTF-8: byte 61, in line 2, is 0xe4; save it as UTF-8\n"
    );
    let marked = ["\u{feff}", BALL].concat();
    let marked = folder.write("marked.json", &marked);
    assert_eq!(status(&palpate(&["check", &marked])), 0);
}
