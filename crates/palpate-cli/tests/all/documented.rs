// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Programs print what their schema and `docs/formats.md` say.

use std::collections::BTreeSet;

use crate::common::{Folder, json, palpate, root, text};
use serde_json::Value;

type Names = BTreeSet<String>;

/// A section of the page, from its heading to the next.
fn section(heading: &str) -> String {
    let page = std::fs::read_to_string(root("docs/formats.md")).unwrap();
    let start = page.find(&format!("\n## {heading}\n")).unwrap();
    let rest = &page[start + 4..];
    rest[..rest.find("\n## ").unwrap_or(rest.len())].to_owned()
}

/// The words in backticks in a cell that are keys or columns: no options, no values in quotes.
fn words(cell: &str) -> impl Iterator<Item = &str> {
    let words = cell.split('`').skip(1).step_by(2);
    words.filter(|word| word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'))
}

/// The columns in the tables of a section.
fn documented(heading: &str) -> Names {
    let section = section(heading);
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    let cells = rows.filter_map(|row| row.split('|').nth(1));
    cells.flat_map(words).map(str::to_owned).collect()
}

/// Checks answers against the schema of a command, in which no other key may stand.
fn assert_valid(command: &str, answers: &[Value]) {
    let text = std::fs::read_to_string(root("crates/palpate-cli/schema/answers.schema.json"));
    let mut schema: Value = serde_json::from_str(&text.unwrap()).unwrap();
    let mut asked = schema["properties"][command].take();
    // An alternative adds its keys to those of the object that it names.
    let alternatives = asked.get("oneOf").and_then(Value::as_array).into_iter().flatten();
    let named: Vec<_> = alternatives.filter_map(|of| of["$ref"].as_str()).collect();
    for (name, object) in schema["$defs"].as_object_mut().unwrap() {
        if !named.iter().any(|of| of.ends_with(&format!("/{name}"))) {
            close(object);
        }
    }
    close(&mut asked);
    asked["$defs"] = schema["$defs"].take();
    let validator = jsonschema::validator_for(&asked).unwrap();
    for answer in answers {
        let wrong: Vec<_> = validator.iter_errors(answer).map(|e| e.to_string()).collect();
        assert!(wrong.is_empty(), "palpate {command}: {wrong:?}");
    }
}

/// Allows no key beside those of an object, or of its alternatives.
fn close(object: &mut Value) {
    if object["type"] == "object" || object.get("oneOf").is_some() {
        object["unevaluatedProperties"] = (!object["additionalProperties"].is_null()).into();
    }
}

/// A ball that rises, a guide, a hand that begins inside and leaves the workspace.
const RISING: &str = r#"{ "palpate": 1, "dimension": 3,
  "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.05 } } } ],
  "guides": [ { "point": [0, 0.1, 0] } ],
  "motions": [ { "body": "ball", "to": { "translation": [0, 0.01, 0] } } ] }"#;

/// Runs that print every key, and the columns of the traces that they write.
fn runs() -> (Vec<Value>, Names) {
    let folder = Folder::new();
    let scene = folder.write("rising.json", RISING);
    let flat = RISING.replace("\"dimension\": 3", "\"dimension\": 2");
    let flat = folder
        .write("flat.json", &flat.replace(", 0] }", "] }").replace(", 0.1, 0]", ", 0.1]"));
    let rows = "time_s,x_m,y_m,z_m\n0,0,0.049,0\n0.1,0,0.06,0\n0.2,0,0.3,0\n";
    let hand = folder.write("hand.csv", rows);
    let omega = palpate::device::profile_named("omega").unwrap();
    let omega = folder.write("omega.json", &palpate::scene::device_to_json(&omega).unwrap());
    let omega = format!("simulated:{omega}");
    let [trace, wav] = ["trace.csv", "touch.wav"].map(|name| folder.name(name));
    let (mut printed, mut columns) = (Vec::new(), Names::new());
    let stylus = ["scenes/stylus_in_cup.json", "--fast", "--duration", "0.1"];
    for run in [
        &[&stylus[..], &["--device", "simulated:sigma7"]].concat()[..],
        &[&scene, "--path", &hand, "--device", &omega],
        &[&flat, "--fast", "--duration", "0.1"],
        &["scenes/materials.json", "--fast", "--duration", "2", "--wav", &wav],
    ] {
        let feel = [&["feel"], run, &["--json", "--trace", &trace]].concat();
        printed.push(json(&feel));
        let trace = std::fs::read_to_string(&trace).unwrap();
        let header = trace.lines().next().unwrap().replace("body_0_", "body_N_");
        columns.extend(header.split(',').map(str::to_owned));
    }
    (printed, columns)
}

#[test]
fn feel_prints_the_keys_of_its_schema_and_the_columns_of_the_page() {
    let (printed, columns) = runs();
    assert_valid("feel", &printed);
    assert_eq!(documented("Traces"), columns);
}

#[test]
fn answers_are_as_their_schema_says() {
    let folder = Folder::new();
    let profile = palpate::device::profile_named("omega7").unwrap();
    let gripper = palpate::device::GripperProfile {
        max_force_rate: 2000.0,
        ..palpate::device::GripperProfile::new(0.025, 8.0)
    };
    let profile = (palpate::device::DeviceProfile { gripper: Some(gripper), ..profile })
        .with_buttons(["front"]);
    let profile = palpate::scene::device_to_json(&profile).unwrap();
    let profile = folder.write("omega.json", &profile);
    let fall = folder.write("fall.json", crate::sweep::FALL);
    for (command, arguments) in [
        ("answer", &["contact", "scenes/gears.json"][..]),
        ("answer", &["eval", "scenes/cup.json", "--at", "0,0.1,0", "--radius", "0.1"]),
        ("answer", &["mass", "scenes/cup.json"]),
        ("answer", &["sweep", &fall, "--method", "sum_descent"]),
        ("check", &["check", "scenes/gears.json"]),
        ("devices", &["devices"]),
        ("devices", &["devices", "--profile", &profile]),
        ("devices --actuators", &["devices", "--actuators"]),
        ("devices --materials", &["devices", "--materials", "--profile", "touch"]),
        ("devices --stability", &["devices", "--stability", "--profile", "touch"]),
        ("identify", &["identify", "--device", "premium15"]),
        ("jitter", &["jitter", "--duration", "0.03"]),
        ("shapes", &["shapes", "torus"]),
    ] {
        assert_valid(command, &[json(&[arguments, &["--json"]].concat())]);
    }
}

/// One row, since all of them take minutes; `palpate devices --stability` prints the table.
#[test]
fn the_table_of_devices_that_differ_from_their_profiles_is_current() {
    let page =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide/rendered.md");
    let written = std::fs::read_to_string(page).unwrap();
    let row = text(&palpate(&["devices", "--stability", "--profile", "omni"]));
    assert!(written.contains(row.lines().last().unwrap()), "{row}");
}

/// `cargo xtask renew` writes the table of materials on devices anew.
#[test]
fn the_table_of_materials_on_devices_is_current() {
    let page =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide/rendered.md");
    let written = std::fs::read_to_string(&page).unwrap();
    let (begin, end) = ("<!-- palpate devices --materials -->\n", "<!-- end -->\n");
    let (before, rest) = written.split_once(begin).unwrap();
    let (_, after) = rest.split_once(end).unwrap();
    let table = text(&palpate(&["devices", "--materials"]));
    let current = format!("{before}{begin}\n{table}\n{end}{after}");
    if std::env::var_os("PALPATE_RENEW").is_some() {
        std::fs::write(&page, &current).unwrap();
    }
    assert!(
        std::fs::read_to_string(&page).unwrap() == current,
        "the table is stale; `cargo xtask renew` renews it"
    );
    let faster = json(&["devices", "--materials", "--rate", "4000", "--json"]);
    let of = |rows: &Value, device: &str, material: &str| {
        let rows = rows["devices"].as_array().unwrap();
        let row = rows.iter().find(|row| row["device"] == device).unwrap().clone();
        let materials = row["materials"].as_array().unwrap();
        let found = materials.iter().find(|found| found["name"] == material).unwrap();
        found["device_stiffness"].as_f64().unwrap()
    };
    // 400 N/m at 1 kHz, and 1600 N/m at 4 kHz: glass has 1000 N/m.
    let usual = json(&["devices", "--materials", "--json"]);
    assert_eq!(of(&usual, "touch", "glass"), 400.0);
    assert_eq!(of(&faster, "touch", "glass"), 1000.0);
}
