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
    let expected =
        json!({ "palpate": 2, "ok": false, "problems": [name, radius], "maybe_more": false });
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
        "latin.json: the file is not UTF-8: byte 58, in line 2, is 0xe4; save it as UTF-8\n"
    );
    let marked = ["\u{feff}", BALL].concat();
    let marked = folder.write("marked.json", &marked);
    assert_eq!(status(&palpate(&["check", &marked])), 0);
}

/// What a command that cannot use its input says.
fn refused(folder: &Folder, arguments: &[&str]) -> String {
    let output = folder.run(arguments);
    assert_eq!(status(&output), 2, "{arguments:?}: {}", text(&output));
    assert_eq!(text(&output), "", "{arguments:?}");
    errors(&output)
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn a_mesh_given_as_a_scene_is_recognised() {
    let folder = Folder::new();
    folder.write("part.obj", TRIANGLE);
    folder.write("part.json", TRIANGLE);
    for command in ["plot", "feel", "contact", "mass"] {
        assert_eq!(
            refused(&folder, &[command, "part.obj"]),
            "palpate: part.obj: it is a mesh (OBJ), not a scene; `palpate mesh part.obj` checks it\n"
        );
    }
    let eval = refused(&folder, &["eval", "part.obj", "--at", "0,0,0"]);
    assert!(eval.contains("`palpate mesh part.obj` checks it"), "{eval}");
    assert_eq!(
        checked(&folder, "part.json", TRIANGLE.as_bytes()),
        "part.json: it is a mesh (OBJ), not a scene; rename it to part.obj, for `palpate mesh`\n"
    );
    let answer = folder.run(&["check", "part.obj", "--json"]);
    let answer: Value = serde_json::from_slice(&answer.stdout).unwrap();
    let problem = "it is a mesh (OBJ), not a scene; `palpate mesh part.obj` checks it";
    assert_eq!(answer["problems"][0]["problem"], problem);
}

#[test]
fn other_files_given_as_a_scene_are_recognised() {
    let folder = Folder::new();
    for (name, content, expected) in [
        (
            "points.csv",
            &b"x_m,y_m\n0,0\n"[..],
            "points.csv: it is a table (CSV), not a scene; `palpate eval SCENE --points points.csv` \
             reads points, `palpate feel SCENE --path points.csv` the path of a hand\n",
        ),
        (
            "star.png",
            b"\x89PNG\r\n\x1a\n",
            "star.png: it is a picture (PNG), not a scene; pictures are outputs alone\n",
        ),
        (
            "empty.json",
            b"",
            "empty.json: it is an empty file; a small scene is { \"palpate\": 1, \"dimension\": 3, \
             \"bodies\": [ { \"name\": \"bead\", \"shape\": { \"ball\": { \"radius\": 0.02 } } } ] }\n",
        ),
    ] {
        assert_eq!(checked(&folder, name, content), expected);
    }
    let folder_name = refused(&folder, &["check", "."]);
    assert_eq!(folder_name, "palpate: .: is a folder; name a file in it\n");
    let small = checked(&folder, "empty.json", b"");
    let (_, small) = small.split_once("a small scene is ").unwrap();
    let small = folder.write("small.json", small);
    assert_eq!(status(&palpate(&["check", &small])), 0);
}

#[test]
fn other_files_given_as_a_mesh_are_recognised() {
    let folder = Folder::new();
    folder.write("ball.json", BALL);
    folder.write("part.txt", TRIANGLE);
    folder.write("part.stl", TRIANGLE);
    folder.write("points.csv", "x_m,y_m\n0,0\n");
    for (name, expected) in [
        ("ball.json", "it is a scene (JSON), not a mesh; `palpate check ball.json` checks it"),
        ("part.txt", "it is a mesh (OBJ); rename it to part.obj, for `palpate mesh`"),
        ("part.stl", "it is a mesh (OBJ); rename it to part.obj, for `palpate mesh`"),
        (
            "points.csv",
            "it is a table (CSV), not a mesh; `palpate eval SCENE --points points.csv` reads points, \
             `palpate feel SCENE --path points.csv` the path of a hand",
        ),
        (".", "is a folder; name a file in it"),
    ] {
        let expected = format!("palpate: {name}: {expected}\n");
        assert_eq!(refused(&folder, &["mesh", name]), expected);
    }
}

/// A small ball minus a large one, a ball minus itself, and a ball.
const HOLLOW: &str = r#"{ "palpate": 1, "dimension": 3, "bodies": [
  { "name": "none", "shape": { "difference": [ { "ball": { "radius": 0.02 } }, { "ball": { "radius": 0.03 } } ] } },
  { "name": "skin", "shape": { "difference": [ { "ball": { "radius": 0.02 } }, { "ball": { "radius": 0.02 } } ] } },
  { "name": "ball", "shape": { "ball": { "radius": 0.02 } } } ] }"#;

#[test]
fn a_body_without_any_point_is_told_of() {
    let folder = Folder::new();
    folder.write("hollow.json", HOLLOW);
    let check = folder.run(&["check", "hollow.json"]);
    assert_eq!(
        text(&check),
        "hollow.json: good, 3D, 3 bodies\n  \
         none: bound outside, exact inside; empty: no point is in it, which is proven\n  \
         skin: bound outside, exact inside; may be empty: no point was found in it\n  \
         ball: exact outside, exact inside\n"
    );
    let answer = folder.run(&["check", "hollow.json", "--json"]);
    let answer: Value = serde_json::from_slice(&answer.stdout).unwrap();
    let empty: Vec<_> = (0..3).map(|i| answer["bodies"][i]["is_empty"].clone()).collect();
    assert_eq!(empty, [json!(true), Value::Null, json!(false)]);
    let mass = folder.run(&["mass", "hollow.json", "--cells", "1000"]);
    assert_eq!(status(&mass), 1);
    let said = text(&mass);
    let empty = "none, at 1000 kg/m³ (329 cells)\n  \
                 empty: no point is in it, its volume is proven to be 0 m³\nskin, ";
    assert!(said.starts_with(empty), "{said}");
    assert!(said.contains("\n  may be empty: no point was found in it\n"), "{said}");
    let answer = folder.run(&["mass", "hollow.json", "--cells", "1000", "--json"]);
    let answer: Value = serde_json::from_slice(&answer.stdout).unwrap();
    let none = &answer["bodies"][0];
    assert_eq!(
        (&none["empty"], &none["volume"], &none["volume_error"]),
        (&json!(true), &json!(0.0), &json!(0.0))
    );
    assert_eq!(none["centroid"], Value::Null);
    let warning = "warning: body \"none\" is empty: no point is in it, which is proven\n";
    for arguments in [&["plot"][..], &["contact"], &["feel", "--fast", "--duration", "0.01"]] {
        let command = [&arguments[..1], &["hollow.json"], &arguments[1..]].concat();
        let output = folder.run(&command);
        assert!(errors(&output).starts_with(warning), "{command:?}: {}", errors(&output));
    }
}

/// The message said that the matrix is not orthonormal, which it is.
#[test]
fn a_left_handed_frame_is_called_a_reflection() {
    let folder = Folder::new();
    let end = BALL.trim_end().strip_suffix('}').unwrap();
    let frame = r#""tool": { "workspace": { "pose": {
        "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, -1]] } } } }"#;
    let scene = format!("{end}, {frame}");
    let said = "rotation must not mirror: the matrix is a reflection, with determinant -1; palpate is \
                right-handed, so mirror one axis of a left-handed frame before, for instance in the \
                device's driver\n";
    let checked = checked(&folder, "left.json", scene.as_bytes());
    assert_eq!(checked, format!("left.json: tool.workspace.pose.rotation, line 3: {said}"));
    let felt = folder.run(&["feel", "left.json", "--fast", "--duration", "0.01"]);
    assert!(errors(&felt).ends_with(said), "{}", errors(&felt));
}

/// Motions that jump, go nowhere, or go faster than a hand follows.
#[test]
fn odd_motions_are_told() {
    let folder = Folder::new();
    let checked = |motion: &str| {
        let scene = format!(
            r#"{{ "palpate": 1, "dimension": 2,
                 "bodies": [ {{ "name": "arm", "shape": {{ "ball": {{ "radius": 0.01 }} }} }} ],
                 "motions": [ {{ "body": "arm", {motion} }} ] }}"#
        );
        folder.write("arm.json", &scene);
        text(&folder.run(&["check", "arm.json"]))
    };
    let warnings = |motion: &str| {
        let said = checked(motion);
        said.lines()
            .filter_map(|line| line.strip_prefix("  warning: "))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert_eq!(
        warnings(r#""from": { "translation": [0, 0.1] }, "to": { "translation": [0.1, 0.1] }"#),
        [
            "body \"arm\" jumps at 0 s, by 0.100000 m and 0.000000 rad: the motion begins elsewhere than where \
          the body is then; without \"from\" it begins at the body's pose"
        ]
    );
    assert_eq!(
        warnings(r#""to": { "translation": [0.1, 0] }, "duration": 2, "repeat": "loop""#),
        [
            "body \"arm\" jumps at 2 s, by 0.100000 m and 0.000000 rad, and again each 2 s: the loop does not \
          end where it begins; \"repeat\": \"back_and_forth\" goes back without a jump"
        ]
    );
    assert_eq!(
        warnings(r#""to": { "rotate_degrees": 360 }, "repeat": "loop""#),
        [
            "the motion of body \"arm\" from 0 s on goes nowhere: its ends are one pose; \"turns\" gives whole \
          turns"
        ]
    );
    assert_eq!(
        warnings(r#""to": { "translation": [40, 0] }, "start": 1, "duration": 0.5"#),
        [
            "the motion of body \"arm\" from 1 s on moves points of the body at up to 80.000 m/s: a hand that \
          it meets faster than 2 m/s gets a blow"
        ]
    );
    assert_eq!(warnings(r#""to": { "translation": [0.1, 0] }"#), [""; 0]);
}

/// A soft skin with a hard ball in it, which a hand never reaches.
const NODULE: &str = r#"{ "palpate": 1, "dimension": 3, "bodies": [
  { "name": "skin", "shape": { "cuboid": { "size": [0.1, 0.04, 0.1] } } },
  { "name": "nodule", "shape": { "ball": { "radius": 0.012 } },
    "pose": { "translation": [0, 0.006, 0] } } ] }"#;

#[test]
fn a_body_wholly_within_another_is_told() {
    let folder = Folder::new();
    folder.write("nodule.json", NODULE);
    folder.write("bump.json", &NODULE.replace("0.006", "0.0081"));
    let told = "warning: body \"nodule\" lies wholly within body \"skin\": it cannot be felt, because \
                a hand stays on the surface of \"skin\"; let it come out there, or give the material of \
                \"skin\" \"layers\", with \"pop_through\" if the hand is to reach what lies within\n";
    let feel =
        |scene: &str| errors(&folder.run(&["feel", scene, "--fast", "--duration", "0.01"]));
    assert_eq!(feel("nodule.json"), told);
    assert_eq!(feel("bump.json"), "");
    let check = |scene: &str, rest: &[&str]| {
        let output = folder.run(&[&["check", scene], rest].concat());
        assert_eq!(status(&output), 0);
        text(&output)
    };
    assert!(check("nodule.json", &[]).ends_with(&format!("    {told}")));
    assert!(!check("bump.json", &[]).contains("warning"));
    let answer: Value = serde_json::from_str(&check("nodule.json", &["--json"])).unwrap();
    assert_eq!(answer["bodies"][1]["hidden_in"], "skin");
    assert!(answer["bodies"][0]["hidden_in"].is_null());
}

#[test]
fn a_device_that_renders_less_than_asked_is_told() {
    let folder = Folder::new();
    let end = BALL.trim_end().strip_suffix('}').unwrap();
    folder.write("strong.json", &format!(r#"{end}, "tool": {{ "max_force": 100 }} }}"#));
    folder.write("ball.json", BALL);
    let feel = |scene: &str, rest: &[&str]| {
        let omega =
            ["feel", scene, "--fast", "--duration", "0.01", "--device", "simulated:omega"];
        let output = folder.run(&[&omega[..], rest].concat());
        (status(&output), errors(&output), text(&output))
    };
    let (_, said, report) = feel("strong.json", &["--stiffness", "9000"]);
    let start = "warning: the Force Dimension omega renders less than asked: at most 12 N of 100 N, \
                 and ";
    assert!(said.starts_with(start) && said.ends_with(" N/m of body \"ball\"\n"), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(report.contains("at most 12 (asked 100) N"), "{report}");
    let (code, said, _) = feel("ball.json", &["--max-force", "100"]);
    let refused = "palpate: --max-force must be at most 12 N, the largest force of the Force Dimension \
                   omega, got 100 N\n";
    assert_eq!((code, said.as_str()), (2, refused));
    let (_, said, _) = feel("ball.json", &["--stiffness", "1"]);
    assert_eq!(said, "");
}

/// A floor without end, a curve, and a ball.
const ENDLESS: &str = r#"{ "palpate": 1, "dimension": 3, "bodies": [
  { "name": "floor", "shape": { "half_space": { "normal": [0, 1, 0], "offset": 0 } } },
  { "name": "wire", "shape": { "segment": { "from": [0, 0, 0], "to": [1, 0, 0], "radius": 0 } } },
  { "name": "box", "shape": { "box": { "size": [0.5, 0.5, 0.5] } } } ] }"#;

#[test]
fn mass_says_of_each_body_what_it_is() {
    let folder = Folder::new();
    folder.write("endless.json", ENDLESS);
    let mass = folder.run(&["mass", "endless.json", "--tolerance", "0.01"]);
    let said = text(&mass);
    let first = "floor: mass needs a shape with bounds\n\
                 wire, at 1000 kg/m³ (0 cells)\n  \
                 no inside: curves and sheets have a volume of 0 m³\n\
                 box, at 1000 kg/m³ (";
    assert!(said.starts_with(first), "{said}");
    // Digits below the error say nothing.
    assert!(said.contains("\n  centroid       [0, 0, 0] ± "), "{said}");
    assert_eq!((status(&mass), errors(&mass)), (1, String::new()));
    let answer = folder.run(&["mass", "endless.json", "--tolerance", "0.01", "--json"]);
    let answer: Value = serde_json::from_slice(&answer.stdout).unwrap();
    let floor = json!({ "name": "floor", "problem": "mass needs a shape with bounds" });
    assert_eq!(answer["bodies"][0], floor);
    let wire = &answer["bodies"][1];
    assert_eq!((&wire["volume"], &wire["empty"]), (&json!(0.0), &json!(false)));
}

/// Options and numbers that were ignored, or refused for another reason.
#[test]
fn what_has_no_effect_is_refused() {
    let folder = Folder::new();
    let ball = r#"{ "palpate": 1, "dimension": 3, "bodies":
        [{ "name": "b", "shape": { "ball": { "radius": 0.5 } } }]"#;
    folder.write("ball.json", &format!("{ball} }}"));
    folder.write("tool.json", &format!("{ball}, \"tool\": {{ \"radius\": 1e300 }} }}"));
    let scaled = ball
        .replace("\"ball\"", "\"scale\": 1e10, \"of\": { \"scale\": 1e10, \"of\": { \"ball\"");
    folder.write(
        "scaled.json",
        &format!("{} }}", scaled.replace("0.5 } } }]", "0.5 } } } } }]")),
    );
    let refused = |arguments: &[&str]| refused(&folder, arguments);
    for (option, value) in [("--output", "x.csv"), ("--threads", "2")] {
        let said = refused(&["eval", "ball.json", "--at", "0,0,0", option, value]);
        assert!(said.contains("cannot be used with"), "{said}");
    }
    assert_eq!(
        refused(&["render", "ball.json", "--budget", "5"]),
        "palpate: --budget is about contacts, and needs --contacts\n"
    );
    let check = |name| text(&folder.run(&["check", name]));
    assert_eq!(
        check("tool.json"),
        "tool.json: tool.radius, line 2: must be at most 1e15 m, got 1e300 m\n"
    );
    let said = check("scaled.json");
    let expected =
        "scale must be such that the shape stays within 1e16 m of the origin, got 10000000000";
    assert!(said.contains(expected), "{said}");
}

/// The search for contacts took the surface of an empty body for one that can be touched.
#[test]
fn nothing_touches_an_empty_body() {
    let folder = Folder::new();
    folder.write("hollow.json", HOLLOW);
    let said = text(&folder.run(&["contact", "hollow.json", "--body", "none"]));
    let expected = "none – skin: apart, none has no point\nnone – ball: apart, none has no point\n\
                    3 bodies: 0 pairs touch (gap up to 0.0800 mm), 2 apart, 0 undecided\n";
    assert_eq!(said, expected);
    let answer = folder.run(&["contact", "hollow.json", "--body", "none", "--json"]);
    let answer: Value = serde_json::from_slice(&answer.stdout).unwrap();
    let pair = &answer["pairs"][1];
    assert_eq!((&pair["empty"], &pair["verdict"]), (&json!("none"), &json!("apart")));
    assert_eq!(pair.get("separation_m"), None);
}

/// What clap says of a value that breaks the rule of its option.
fn invalid(value: &str, option: &str, rule: &str) -> String {
    format!(
        "error: invalid value '{value}' for '{option}': {rule}\n\nFor more information, try '--help'.\n"
    )
}

#[test]
fn every_number_of_the_command_line_keeps_a_rule_that_is_said() {
    let folder = Folder::new();
    folder.write("ball.json", BALL);
    let length = "must be positive and at most 1e15 m";
    let length_or_zero = "must be zero or more and at most 1e15 m";
    let positive = "must be positive and finite";
    let zero_or_more = "must be zero or more and finite";
    for (command, option, value, rule) in [
        ("feel", "--duration <DURATION>", "-1", format!("{positive}, got -1 s")),
        ("feel", "--duration <DURATION>", "0", format!("{positive}, got 0 s")),
        ("feel", "--rate <RATE>", "0", format!("{positive}, got 0 Hz")),
        ("feel", "--rate <RATE>", "fast", "must be a number".into()),
        (
            "feel",
            "--points <POINTS>",
            "0",
            "must be a whole number from 1 to 1000, got 0".into(),
        ),
        (
            "feel",
            "--points <POINTS>",
            "1001",
            "must be a whole number from 1 to 1000, got 1001".into(),
        ),
        ("feel", "--stiffness <STIFFNESS>", "-1", format!("{zero_or_more}, got -1 N/m")),
        ("feel", "--damping <DAMPING>", "nan", format!("{zero_or_more}, got NaN N·s/m")),
        ("feel", "--max-force <MAX_FORCE>", "0", format!("{positive}, got 0 N")),
        ("feel", "--radius <RADIUS>", "-0.1", format!("{length_or_zero}, got -0.1 m")),
        (
            "feel",
            "--device <DEVICE>",
            "omega",
            "a device of this name is written simulated:omega".into(),
        ),
        (
            "feel",
            "--device <DEVICE>",
            "simulated:desktopp",
            "unknown device `desktopp`, did you mean `desktop`?".into(),
        ),
        (
            "feel",
            "--device <DEVICE>",
            "hand",
            "must be recorded, simulated:NAME or glove".into(),
        ),
        ("contact", "--margin <MARGIN>", "-1", format!("{length_or_zero}, got -1 m")),
        ("contact", "--margin <MARGIN>", "1e99", format!("{length_or_zero}, got 1e99 m")),
        ("contact", "--spacing <SPACING>", "0", format!("{length}, got 0 m")),
        ("contact", "--tolerance <TOLERANCE>", "nan", format!("{length_or_zero}, got NaN m")),
        (
            "contact",
            "--tolerance <TOLERANCE>",
            "0,5",
            "must be a number; a decimal comma is written 0.5".into(),
        ),
        (
            "contact",
            "--budget <BUDGET>",
            "0",
            "must be a whole number from 1 to 4294967295, got 0".into(),
        ),
        (
            "contact",
            "--budget <BUDGET>",
            "1e6",
            "must be a whole number from 1 to 4294967295, got 1e6".into(),
        ),
        ("contact", "--time <TIME>", "-1", format!("{zero_or_more}, got -1 s")),
        ("plot", "--time <TIME>", "-1", format!("{zero_or_more}, got -1 s")),
        ("plot", "--time <TIME>", "inf", format!("{zero_or_more}, got inf s")),
        ("plot", "--offset <OFFSET>", "0", format!("{length}, got 0 m")),
        ("gradients", "--offset <OFFSET>", "0", format!("{length}, got 0 m")),
        ("gradients", "--offset <OFFSET>", "-1", format!("{length}, got -1 m")),
        ("gradients", "--offset <OFFSET>", "nan", format!("{length}, got NaN m")),
        ("gradients", "--offset <OFFSET>", "1e16", format!("{length}, got 1e16 m")),
        ("gradients", "--size <SIZE>", "-1", format!("{length}, got -1 m")),
        ("plot", "--step <STEP>", "0", format!("{length}, got 0 m")),
        (
            "plot",
            "--at <AT>",
            "inf",
            "must be finite and at most 1e15 m in size, got inf m".into(),
        ),
        ("plot", "--size <SIZE>", "-1", format!("{length}, got -1 m")),
        (
            "plot",
            "--width <WIDTH>",
            "0",
            "must be a whole number from 64 to 16384, got 0".into(),
        ),
        (
            "mass",
            "--density <DENSITY>",
            "-1",
            "must be from 1e-15 to 1e15 kg/m³, got -1 kg/m³".into(),
        ),
        ("mass", "--tolerance <TOLERANCE>", "0", format!("{positive}, got 0")),
        (
            "mass",
            "--cells <CELLS>",
            "0",
            "must be a whole number from 1 to 100000000, got 0".into(),
        ),
        ("mesh", "--scale <METRES>", "-1", format!("{length}, got -1 m")),
        (
            "eval",
            "--threads <THREADS>",
            "0",
            "must be a whole number from 1 to 1000000, got 0".into(),
        ),
        ("descend", "--tolerance <TOLERANCE>", "-1", format!("{length_or_zero}, got -1 m")),
    ] {
        let name = option.split(' ').next().unwrap();
        let said = refused(&folder, &[command, "ball.json", name, value]);
        assert_eq!(said, invalid(value, option, &rule));
    }
    for (command, option, value, rule) in [
        ("jitter", "--rate <RATE>", "0", format!("{positive}, got 0 Hz")),
        ("jitter", "--duration <DURATION>", "-1", format!("{positive}, got -1 s")),
        (
            "gallery",
            "--width <WIDTH>",
            "63",
            "must be a whole number from 64 to 16384, got 63".into(),
        ),
    ] {
        let name = option.split(' ').next().unwrap();
        assert_eq!(refused(&folder, &[command, name, value]), invalid(value, option, &rule));
    }
}

#[test]
fn numbers_of_pictures_keep_the_rules_of_render() {
    let folder = Folder::new();
    folder.write("ball.json", BALL);
    let whole = |rule: &str| format!("must be a whole number {rule}");
    let degrees = |least: f64, most: f64| format!("must be from {least} to {most} degrees");
    let length = "must be positive and at most 1e15 m";
    for (option, value, rule) in [
        ("--azimuth <AZIMUTH>", "nan", degrees(-360.0, 360.0) + ", got NaN degrees"),
        ("--azimuth <AZIMUTH>", "361", degrees(-360.0, 360.0) + ", got 361 degrees"),
        ("--elevation <ELEVATION>", "-91", degrees(-90.0, 90.0) + ", got -91 degrees"),
        ("--field-of-view <FIELD_OF_VIEW>", "0", degrees(1.0, 170.0) + ", got 0 degrees"),
        ("--field-of-view <FIELD_OF_VIEW>", "180", degrees(1.0, 170.0) + ", got 180 degrees"),
        ("--time <TIME>", "-1", "must be zero or more and finite, got -1 s".into()),
        ("--time <TIME>", "nan", "must be zero or more and finite, got NaN s".into()),
        (
            "--slice-at <SLICE_AT>",
            "inf",
            "must be finite and at most 1e15 m in size, got inf m".into(),
        ),
        ("--step <STEP>", "-1", format!("{length}, got -1 m")),
        ("--step <STEP>", "0", format!("{length}, got 0 m")),
        ("--samples <SAMPLES>", "0", whole("from 1 to 8, got 0")),
        ("--samples <SAMPLES>", "9", whole("from 1 to 8, got 9")),
        ("--ray-budget <RAY_BUDGET>", "0", whole("from 1 to 4294967295, got 0")),
        ("--turntable <PICTURES>", "0", whole("from 1 to 3600, got 0")),
        ("--turntable <PICTURES>", "3601", whole("from 1 to 3600, got 3601")),
        ("--turn-time <TURN_TIME>", "0", "must be positive and finite, got 0 s".into()),
        ("--width <WIDTH>", "0", whole("from 1 to 16384, got 0")),
        ("--width <WIDTH>", "-1", whole("from 1 to 16384, got -1")),
        ("--height <HEIGHT>", "99999999999", whole("from 1 to 16384, got 99999999999")),
        ("--threads <THREADS>", "0", whole("from 1 to 1000000, got 0")),
    ] {
        let name = option.split(' ').next().unwrap();
        let said = refused(&folder, &["render", "ball.json", name, value]);
        assert_eq!(said, invalid(value, option, &rule));
    }
}

#[test]
fn options_without_an_effect_are_refused() {
    let folder = Folder::new();
    folder.write("ball.json", BALL);
    folder.write("disc.json", &BALL.replace("\"dimension\": 3", "\"dimension\": 2"));
    let glove = ["feel", "ball.json", "--fast", "--device", "glove"];
    for (arguments, expected) in [
        (
            &[&glove[..], &["--max-force", "1"]].concat()[..],
            "--max-force has no meaning for a glove, which has no forces",
        ),
        (
            &[&glove[..], &["--stiffness", "1", "--damping", "1", "--strict"]].concat(),
            "--stiffness, --damping, --strict have no meaning for a glove, which has no forces",
        ),
        (
            &[
                "feel",
                "ball.json",
                "--fast",
                "--device",
                "simulated:omega",
                "--max-force",
                "100",
            ],
            "--max-force must be at most 12 N, the largest force of the Force Dimension omega, got 100 N",
        ),
        (
            &["plot", "disc.json", "--plane", "xz"],
            "--plane is for scenes in space; this scene is in the plane, and drawn whole",
        ),
        (
            &["plot", "disc.json", "--at", "1"],
            "--at is for scenes in space; this scene is in the plane, and drawn whole",
        ),
        (
            &["plot", "ball.json", "--at", "1", "--centre", "0,0,0", "--size", "1"],
            "--at and the point of --centre both say where the plane is; leave out --at",
        ),
        (
            &["plot", "ball.json", "--at", "1", "--plane", "0,0,0:1,0,0:0,1,0"],
            "--at and the point of --plane both say where the plane is; leave out --at",
        ),
        (
            &["plot", "ball.json", "--output", "ball.svg", "--width", "500"],
            "--width is for PNG pictures; an SVG is drawn at any width",
        ),
        (
            &["gallery", "--format", "svg", "--width", "500"],
            "--width is for PNG pictures; an SVG is drawn at any width",
        ),
        (
            &["plot", "ball.json", "--margin", "1"],
            "--margin is about contacts, and needs --contacts",
        ),
        (
            &["plot", "ball.json", "--budget", "1"],
            "--budget is about contacts, and needs --contacts",
        ),
    ] {
        assert_eq!(refused(&folder, arguments), format!("palpate: {expected}\n"));
    }
}

#[test]
fn what_a_command_needs_is_said_with_an_example_of_the_scene() {
    let folder = Folder::new();
    folder.write("ball.json", BALL);
    for (arguments, expected) in [
        (
            &["eval", "ball.json"][..],
            "eval needs a point, as with --at 0,0,0, or many with --points FILE",
        ),
        (
            &["eval", "ball.json", "--at", "1,2"],
            "the scene is 3D: a point is 3 numbers x,y,z joined by commas, got 2 in \"1,2\"",
        ),
        (
            &["eval", "ball.json", "--at", "0,5,1,0,2,0"],
            "the scene is 3D: a point is 3 numbers x,y,z joined by commas, got 6 in \"0,5,1,0,2,0\"; a decimal comma is written as a point",
        ),
        (
            &["eval", "ball.json", "--at", "1;2;3"],
            "the scene is 3D: a point is 3 numbers x,y,z joined by commas, got \"1;2;3\"; numbers are joined by commas alone",
        ),
        (
            &["eval", "ball.json", "--at", "1,x,3"],
            "the scene is 3D: a point is 3 numbers x,y,z joined by commas, got \"1,x,3\"",
        ),
        (
            &["eval", "ball.json", "--at", "0,0,nan"],
            "z must be finite and at most 1e15 m in size, got NaN m",
        ),
        (
            &["descend", "ball.json"],
            "descend needs --segment with 2 points, --triangle with 3, or, between two bodies, --start with 1 or --halton with their number; for example: palpate descend ball.json --segment -0.5,0,0 0.5,0,0",
        ),
    ] {
        assert_eq!(refused(&folder, arguments), format!("palpate: {expected}\n"));
    }
    // The example runs.
    let example = ["descend", "ball.json", "--segment", "-0.5,0,0", "0.5,0,0"];
    assert_eq!(status(&folder.run(&example)), 0);
}

#[test]
fn a_mesh_in_another_unit_gets_a_hint() {
    let nut = ["mesh", "testdata/meshes/nut.ply"];
    let said = text(&palpate(&nut));
    let hint = "  hint     it is 46.04 m across: if the file is in millimetres, --scale 0.001 makes \
                that 46.04 mm\n";
    assert!(said.ends_with(hint), "{said}");
    let scaled = [&nut[..], &["--scale", "0.001"]].concat();
    assert!(!text(&palpate(&scaled)).contains("hint"));
    let answer = palpate(&[&nut[..], &["--json"]].concat());
    let answer: Value = serde_json::from_slice(&answer.stdout).unwrap();
    assert!(answer["hint"].as_str().unwrap().starts_with("it is 46.04 m across"));
    let answer = palpate(&[&scaled[..], &["--json"]].concat());
    let answer: Value = serde_json::from_slice(&answer.stdout).unwrap();
    assert_eq!(answer["hint"], Value::Null);
}

#[test]
fn a_mesh_that_cannot_be_read_is_told_with_its_line() {
    let folder = Folder::new();
    folder.write("part.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    assert_eq!(
        refused(&folder, &["mesh", "part.obj"]),
        "palpate: part.obj: it is no good OBJ: line 4: a face names vertex 4, and there are 3; export \
         it again\n"
    );
}
