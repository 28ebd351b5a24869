// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What bodies, tools and guides ask of a device, and what is made of it.

use crate::common::{Folder, errors, json, palpate, status, text};
use crate::pictures::words;

/// A ball that asks for a part of what the device renders, and one that asks for a stiffness.
const BALLS: &str = r#"{ "palpate": 1, "dimension": 3, "bodies": [
  { "name": "relative", "shape": { "ball": { "radius": 0.05 } },
    "material": { "relative_stiffness": 0.8 } },
  { "name": "absolute", "shape": { "translate": [0.1, 0, 0], "of": { "ball": { "radius": 0.05 } } },
    "material": { "stiffness": 50 } } ],
  "tool": { "workspace": { "scale": 2 } } }"#;

/// A soft ball and a stiff guide.
const GUIDED: &str = r#"{ "palpate": 1, "dimension": 3,
  "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.05 } },
                "material": { "stiffness": 100, "damping": 0 } } ],
  "guides": [ { "line": { "through": [0, 0, 0], "direction": [1, 0, 0] },
                "stiffness": 3000, "max_force": 50 } ],
  "tool": { "workspace": { "scale": 1 } } }"#;

/// Runs a command that must fail with status 2 and say this among other things.
fn refuses(arguments: &[&str], said: &str) {
    let output = palpate(arguments);
    assert!(errors(&output).contains(said), "{}", errors(&output));
    assert_eq!((status(&output), text(&output).as_str()), (2, ""), "{arguments:?}");
}

/// The picture said "asked 500 N/m", the default that does not count, and the text "asked 50".
#[test]
fn a_part_of_the_stiffness_of_a_device_is_said_to_be_one() {
    let folder = Folder::new();
    let (scene, plot) = (folder.write("balls.json", BALLS), folder.name("touch.svg"));
    let feel = ["feel", &scene, "--fast", "--duration", "2", "--plot", &plot];
    let touch = ["--device", "simulated:touch"];
    // 0.8 of 400 N/m in a world of twice the size.
    let said = text(&palpate(&[&feel[..], &touch].concat()));
    let asked = "\n  stiffness 50 to 160 (asked 50, and 0.8 of what the device renders) N/m, ";
    assert!(said.contains(asked), "{said}");
    let has = |word: &str| {
        let svg = std::fs::read_to_string(&plot).unwrap();
        words(&svg).iter().any(|found| found.contains(word))
    };
    assert!(has("160 N/m, asked 0.8 of the device's") && has("50 N/m") && !has("asked 500"));
    let half = ["--relative-stiffness", "0.5"];
    text(&palpate(&[&feel[..], &touch, &half].concat()));
    assert!(has("100 N/m, asked 0.5 of the device's") && !has("asked 500"));
    // A hand whose device has no largest stiffness renders that of the material.
    text(&palpate(&feel));
    assert!(has("500 N/m") && !has("asked"));
}

/// One body of eleven was named, with numbers at the device alone.
#[test]
fn strict_protection_lists_all_that_it_refuses() {
    let materials =
        ["feel", "scenes/materials.json", "--fast", "--duration", "0.1", "--strict"];
    let strict = palpate(&[&materials[..], &["--device", "simulated:touch"]].concat());
    assert_eq!(status(&strict), 2);
    let told = errors(&strict);
    assert_eq!(told.matches("\": the device renders ").count(), 13, "{told}");
    for asked in [
        "body \"steel\": ",
        "magnet of body \"magnet\": ",
        "(asked 1000) and damping 0 N·s/m (asked 1)",
    ] {
        assert!(told.contains(asked), "{told}");
    }
    assert!(told.contains(" times as large, are 400 (asked "), "{told}");
    // A tool says which of both asks.
    let stylus =
        ["feel", "scenes/stylus_in_cup.json", "--fast", "--duration", "0.1", "--strict"];
    let told = errors(&palpate(&[&stylus[..], &["--device", "simulated:omega6"]].concat()));
    let coupling =
        "palpate: coupling of the tool, which is softer than body \"cup\": the device ";
    assert!(told.starts_with(coupling), "{told}");
    let long = |word: &str| word.trim_matches(|c: char| !c.is_ascii_digit()).len() > 6;
    assert!(!told.split_whitespace().any(long), "{told}");
}

/// A guide far beyond the device's stiffness was told nowhere.
#[test]
fn guides_are_told_as_the_device_renders_them() {
    let folder = Folder::new();
    let scene = folder.write("guided.json", GUIDED);
    let feel = ["feel", &scene, "--fast", "--duration", "0.1", "--device", "simulated:touch"];
    let said = text(&palpate(&feel));
    let guides = "\n  guides         stiffness 400 (asked 3000) N/m, damping 0 (asked 1) N·s/m\n    \
                  \u{20}            1 of 1 guide softer than asked, 0.1333 of the stiffness: K ≤ ";
    assert!(said.contains(guides), "{said}");
    let report = json(&[&feel[..], &["--json"]].concat());
    let guide = &report["accepted_guides"][0];
    assert_eq!(guide["requested_stiffness"], 3000.0);
    assert_eq!(guide["device_stiffness"], 400.0);
    assert_eq!(
        (&guide["stiffness_rule"], &report["guides"][0]["kind"]),
        (&"max_stiffness".into(), &"line".into())
    );
    let strict = [&feel[..], &["--strict"]].concat();
    refuses(&strict, "guide 0: the device renders stiffness 400 N/m (asked");
    // Bodies and guides together.
    let both = [&strict[..], &["--stiffness", "900"]].concat();
    refuses(&both, "body \"ball\": the device renders ");
    assert!(errors(&palpate(&both)).contains("\n  guide 0: the device renders "));
}

/// Without a path the report asked for the units of the path.
#[test]
fn a_hand_that_felt_nothing_is_told_why() {
    let feel = ["feel", "scenes/cup.json", "--fast", "--duration", "0.1"];
    let said = text(&palpate(&[&feel[..], &["--device", "simulated:omega"]].concat()));
    let why = "\n  nothing felt   the built-in hand reached no body in 0.1 s with this device; raise \
               --duration, or choose another --device\n";
    assert!(said.contains(why), "{said}");
    let folder = Folder::new();
    let hand = folder.write("far.csv", "time_s,x_m,y_m,z_m\n0,0,60,0\n0.1,0,61,0\n");
    let said = text(&palpate(&[&feel[..], &["--path", &hand]].concat()));
    assert!(said.contains("; is its path in metres, and in the coordinates of"), "{said}");
}

#[test]
fn a_path_beyond_the_workspace_names_the_scale_that_suffices() {
    let folder = Folder::new();
    let scene = folder.write("balls.json", BALLS);
    let hand = folder.write("far.csv", "time_s,x_m,y_m,z_m\n0,0,0.06,0\n0.1,0,0.3,0\n");
    let feel = ["feel", &scene, "--path", &hand, "--fast", "--device", "simulated:omega"];
    // A workspace of 75 mm that is twice as large in the scene reaches 150 mm.
    let told = errors(&palpate(&feel));
    let scales = "the workspace has a scale of 2 m of the scene for each metre of the device; around \
                  the same centre, [0, 0, 0] m, a scale of 4 would suffice";
    assert!(told.contains("by up to 75 mm") && told.contains(scales), "{told}");
    let ran = palpate(&[&feel[..], &["--json"]].concat());
    assert_eq!(errors(&ran), "");
    let beyond = &json(&[&feel[..], &["--json"]].concat())["beyond_workspace"];
    assert_eq!((&beyond["scale"], &beyond["sufficient_scale"]), (&2.0.into(), &4.0.into()));
    assert!((beyond["distance"].as_f64().unwrap() - 0.075).abs() < 1e-12);
    let enough = folder.write("enough.json", &BALLS.replace("\"scale\": 2", "\"scale\": 4"));
    let feel = ["feel", &enough, "--path", &hand, "--fast", "--device", "simulated:omega"];
    assert_eq!(errors(&palpate(&feel)), "");
    let flat = r#"{ "palpate": 1, "dimension": 2, "tool": { "workspace": { "scale": 2 } },
        "bodies": [ { "name": "disc", "shape": { "circle": { "radius": 0.05 } } } ] }"#;
    let flat = folder.write("flat.json", flat);
    let hand = folder.write("flat.csv", "time_s,x_m,y_m\n0,0,0.06\n0.1,0,0.3\n");
    let feel = ["feel", &flat, "--path", &hand, "--fast", "--device", "simulated:omega"];
    assert!(errors(&palpate(&feel)).contains("around the same centre, [0, 0] m, a scale of 4"));
}

/// They were taken in silence.
#[test]
fn options_without_effect_are_refused() {
    let feel = ["feel", "scenes/cup.json", "--fast", "--duration", "0.1"];
    let whose = "no meaning for a recorded hand, whose device renders everything; choose one by \
                 --device simulated:NAME";
    for (options, given) in [
        (&["--strict"][..], "--strict has "),
        (&["--acceptance", "passive"], "--acceptance has "),
        (&["--relative-stiffness", "0.5", "--strict"], "--relative-stiffness, --strict have "),
    ] {
        refuses(&[&feel[..], options].concat(), &format!("{given}{whose}"));
    }
    let both =
        ["--device", "simulated:omega", "--stiffness", "100", "--relative-stiffness", "0.5"];
    refuses(&[&feel[..], &both].concat(), "cannot be used with");
    refuses(&["devices", "--actuators", "--rate", "3"], "cannot be used with");
}

/// The table had no row, and the status was that of an answer.
#[test]
fn a_device_without_forces_has_no_table_of_materials_either() {
    let folder = Folder::new();
    let profile = palpate::device::profile_named("omega").unwrap();
    let profile =
        palpate::device::DeviceProfile { max_force: 0.0, continuous_force: 0.0, ..profile };
    let profile = palpate::scene::device_to_json(&profile).unwrap();
    let profile = folder.write("weak.json", &profile);
    for table in ["--materials", "--stability"] {
        refuses(&["devices", table, "--profile", &profile], "gives no forces");
    }
}

/// Loops without a tick ended with yes.
#[test]
fn a_measurement_of_lateness_has_ticks() {
    for (rate, duration) in [("1", "1"), ("1000", "0.001")] {
        let jitter = ["jitter", "--rate", rate, "--duration", duration];
        refuses(&jitter, &format!("--duration {duration} s is shared by "));
        refuses(&jitter, &format!(" at {rate} Hz; the least duration is "));
    }
}

#[test]
fn a_seed_is_refused_with_its_range() {
    refuses(
        &["identify", "--device", "omega", "--seed", "-1"],
        "must be a whole number from 0 to 18446744073709551615, got -1",
    );
}
