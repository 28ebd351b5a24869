// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What `docs/formats.md` says of the output of `feel`, `devices`, `identify` and `jitter` is what they print.

use std::collections::BTreeSet;

use crate::common::{Folder, json, palpate, root, text};
use serde_json::Value;

type Names = BTreeSet<String>;

/// Keys of failures that no test can bring about, and the reason of a refused priority, which
/// depends on the machine.
const OF_FAILURES: [&str; 4] = ["reason", "message", "last_loss", "not_closed"];

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

/// The names in the tables of a section: those of the first cells, or of all.
fn documented(heading: &str, in_all_cells: bool) -> Names {
    let section = section(heading);
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    let cells = rows.flat_map(|row| {
        let cells = row.trim_matches('|').split('|');
        cells.take(if in_all_cells { usize::MAX } else { 1 }).collect::<Vec<_>>()
    });
    cells.flat_map(words).filter(|word| !is_value(word)).map(str::to_owned).collect()
}

/// Words in backticks that are values of JSON.
fn is_value(word: &str) -> bool {
    ["true", "false", "null"].contains(&word)
}

/// All keys of a value, at any depth.
fn keys(value: &Value, found: &mut Names) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                found.insert(key.clone());
                keys(value, found);
            }
        }
        Value::Array(items) => items.iter().for_each(|item| keys(item, found)),
        _ => {}
    }
}

/// Compares names in both directions.
fn assert_same(documented: &Names, printed: &Names) {
    let missing: Vec<_> = printed.difference(documented).collect();
    assert!(missing.is_empty(), "not documented: {missing:?}");
    let surplus = documented.difference(printed);
    let surplus: Vec<_> = surplus.filter(|key| !OF_FAILURES.contains(&key.as_str())).collect();
    assert!(surplus.is_empty(), "documented, but not printed: {surplus:?}");
}

/// A ball that rises, a guide, a hand that begins inside and leaves the workspace.
const RISING: &str = r#"{ "palpate": 1, "dimension": 3,
  "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.05 } } } ],
  "guides": [ { "point": [0, 0.1, 0] } ],
  "motions": [ { "body": "ball", "to": { "translation": [0, 0.01, 0] } } ] }"#;

/// Runs that print every key, with the traces that they write.
fn runs() -> (Names, Names) {
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
    let (mut printed, mut columns) = (Names::new(), Names::new());
    let stylus = ["scenes/stylus_in_cup.json", "--fast", "--duration", "0.1"];
    for run in [
        &[&stylus[..], &["--device", "simulated:sigma7"]].concat()[..],
        &[&scene, "--path", &hand, "--device", &omega],
        &[&flat, "--fast", "--duration", "0.1"],
        &["scenes/materials.json", "--fast", "--duration", "2", "--wav", &wav],
    ] {
        let feel = [&["feel"], run, &["--json", "--trace", &trace]].concat();
        keys(&json(&feel), &mut printed);
        let trace = std::fs::read_to_string(&trace).unwrap();
        let header = trace.lines().next().unwrap().replace("body_0_", "body_N_");
        columns.extend(header.split(',').map(str::to_owned));
    }
    (printed, columns)
}

#[test]
fn the_keys_and_columns_of_feel_are_documented() {
    let (printed, columns) = runs();
    assert_same(&documented("Reports of runs", true), &printed);
    assert_same(&documented("Traces", false), &columns);
}

#[test]
fn the_keys_of_devices_identify_and_jitter_are_documented() {
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
    for (heading, commands) in [
        (
            "Devices",
            &[
                &["devices", "--json"][..],
                &["devices", "--profile", &profile, "--json"],
                &["devices", "--materials", "--profile", "touch", "--json"],
                &["devices", "--actuators", "--json"],
                &["devices", "--stability", "--profile", "touch", "--json"],
            ][..],
        ),
        ("First touches", &[&["sweep", &fall, "--method", "sum_descent", "--json"]]),
        ("Identified devices", &[&["identify", "--device", "premium15", "--json"]]),
        ("Lateness", &[&["jitter", "--duration", "0.03", "--json"]]),
    ] {
        let mut printed = Names::new();
        commands.iter().for_each(|command| keys(&json(command), &mut printed));
        assert_same(&documented(heading, true), &printed);
    }
}

/// One row, since all of them take minutes; `palpate devices --stability` prints the table.
#[test]
fn the_table_of_devices_that_differ_from_their_profiles_is_current() {
    let page =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide/touch.md");
    let written = std::fs::read_to_string(page).unwrap();
    let row = text(&palpate(&["devices", "--stability", "--profile", "omni"]));
    assert!(written.contains(row.lines().last().unwrap()), "{row}");
}

/// `cargo xtask renew` writes the table of materials on devices anew.
#[test]
fn the_table_of_materials_on_devices_is_current() {
    let page =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide/touch.md");
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
