// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate identify`, and the profiles that it writes.

use crate::common::{Folder, assert_refused, errors, json, number, palpate, status, text};

/// The options of a device that differs from its profile.
const OTHER: [&str; 8] = [
    "--plant-mass",
    "1.5",
    "--plant-damping",
    "0.5",
    "--plant-friction",
    "2",
    "--plant-encoder-step",
    "2",
];

#[test]
fn a_device_that_differs_from_its_profile_is_found_within_a_tenth() {
    let device = ["identify", "--device", "sigma7", "--json"];
    let found = json(&[&device[..], &OTHER].concat());
    let axes = found["axes"].as_array().unwrap();
    assert_eq!(axes.len(), 6);
    for (i, axis) in axes.iter().enumerate() {
        let mass = if i < 3 { "mass" } else { "inertia" };
        for (key, factor) in
            [(mass, 1.5), ("damping", 0.5), ("friction", 2.0), ("encoder_step", 2.0)]
        {
            let of = |name: &str| number(&axis[key][name]);
            assert!((of("value") / of("made_with") - 1.0).abs() < 0.1, "{axis}");
            assert!((of("made_with") / of("profile") - factor).abs() < 1e-12, "{axis}");
            assert_eq!(axis[key]["is_seen"], true, "{axis}");
        }
        assert_eq!((&axis["steps"], &axis["has_weight"]), (&"even".into(), &false.into()));
    }
    assert_eq!(found["written"], serde_json::Value::Null);
}

#[test]
fn what_is_found_is_a_profile_that_devices_feel_and_identify_read() {
    let folder = Folder::new();
    let file = folder.path("found.json");
    let file = file.to_str().unwrap();
    let options = ["identify", "--device", "omega", "--out", file];
    let output = palpate(&[&options[..], &OTHER].concat());
    assert_eq!(status(&output), 0, "{}", errors(&output));
    let said = text(&output);
    assert!(
        said.starts_with("Force Dimension omega, simulated, at 1000 Hz, seed 0\nalong x: ")
    );
    assert!(said.contains("% of the profile's 0.2; within 0.0"), "{said}");
    assert!(said.ends_with(&format!("wrote {file}\n")), "{said}");
    let told = "let go of the handle of the Force Dimension omega: it moves by at most 5 mm";
    assert!(errors(&output).starts_with(told), "{}", errors(&output));

    let rows = json(&["devices", "--profile", file, "--json"]);
    let row = &rows["devices"][0];
    assert!((number(&row["friction"]["value"]) / 0.2 - 1.0).abs() < 0.02, "{row}");
    assert_eq!(
        (&row["friction"]["is_assumed"], number(&row["max_force"]["value"])),
        (&false.into(), 12.0)
    );
    assert_eq!(row["continuous_force"]["is_assumed"], true);
    let source = row["source"].as_str().unwrap();
    assert!(source.contains("palpate identify ") && source.contains(", 1000 Hz, seed 0"));

    // Its damping is half of the omega's, so less is rendered of a damped wall.
    let device = format!("simulated:{file}");
    let felt = |device: &str| {
        let feel = ["feel", "--fast", "--duration", "0.5", "--json", "--device"];
        json(&[&feel[..], &[device]].concat())
    };
    let [found, usual] = [felt(&device), felt("simulated:omega")];
    assert_eq!(found["device"], usual["device"]);
    // Once nothing told a profile of a file from the one of that name in the list.
    assert_eq!(
        (&found["device_file"], &usual["device_file"]),
        (&file.into(), &serde_json::Value::Null)
    );
    let device = ["feel", "--fast", "--duration", "0.1", "--device", &device];
    let said = text(&palpate(&device));
    assert!(
        said.contains(&format!("  device         Force Dimension omega, by {file}\n")),
        "{said}"
    );
    assert_ne!(found["bodies"], usual["bodies"]);

    let again = json(&["identify", "--device", file, "--json"]);
    let friction = &again["axes"][0]["friction"];
    assert!((number(&friction["value"]) / number(&friction["profile"]) - 1.0).abs() < 0.01);
}

#[test]
#[ignore = "slow: cargo xtask test --thorough"]
fn a_number_that_cannot_be_told_is_said_and_the_status_is_1() {
    let output = palpate(&[
        "identify",
        "--device",
        "touch",
        "--plant-damping",
        "0.3",
        "--plant-friction",
        "3",
        "--plant-encoder-step",
        "3",
    ]);
    assert_eq!(status(&output), 1, "{}", errors(&output));
    assert!(
        text(&output).contains("  damping       cannot be told: from 0.0"),
        "{}",
        text(&output)
    );
}

#[test]
fn a_hand_is_noticed_and_wrong_input_is_refused() {
    let output = palpate(&["identify", "--device", "omega", "--grip", "300"]);
    assert_eq!((status(&output), text(&output).as_str()), (2, ""));
    let said = errors(&output);
    assert!(said.contains("palpate: along x: a spring of 300"), "{said}");
    let output = palpate(&["identify", "--device", "omega8"]);
    let said = errors(&output);
    assert!(said.contains("unknown device `omega8`, did you mean `omega"), "{said}");
    let folder = Folder::new();
    let file = folder.path("device.json");
    let file = file.to_str().unwrap();
    std::fs::write(file, "{ \"palpate_device\": 1,\n  \"mass\": \"light\" }").unwrap();
    let output = palpate(&["feel", "--device", &format!("simulated:{file}")]);
    let said = errors(&output);
    assert!(said.contains("mass, line 2: mass must be a number, got"), "{said}");
    assert_eq!(status(&output), 2);
    for (option, value, rule) in [
        ("--rate", "20000", "must be from 500 to 10000 Hz, got 20000 Hz"),
        ("--travel", "0", "must be from 0.0001 to 0.05 m, got 0 m"),
        ("--plant-mass", "0", "must be positive and finite, got 0"),
    ] {
        let said = errors(&palpate(&["identify", "--device", "omega", option, value]));
        assert!(said.contains(rule), "{said}");
    }
    assert_refused(
        &["identify", "--device", "omega", "--out", "no/such/folder.json"],
        "no/such/folder.json: there is no folder no/such",
    );
    assert_refused(
        &["identify", "--device", "omega", "--out", "found.txt"],
        "found.txt: the name of a profile must end in .json",
    );
}

#[test]
fn an_interrupted_run_writes_no_profile() {
    let folder = Folder::new();
    let file = folder.path("found.json");
    let interrupt = palpate_cli::Interrupt::new();
    interrupt.asked().store(true, std::sync::atomic::Ordering::Relaxed);
    let out = file.to_str().unwrap();
    let options = ["palpate", "identify", "--device", "omega", "--out", out];
    assert_eq!(palpate_cli::run_until(options, &interrupt), 130);
    assert!(!file.exists());
}

#[test]
fn devices_without_forces_and_options_that_do_not_go_together_are_refused() {
    let folder = Folder::new();
    let profile = palpate::device::DeviceProfile {
        max_force: 0.0,
        ..palpate::device::profile_named("omega").unwrap()
    };
    let profile = palpate::device::DeviceProfile { continuous_force: 0.0, ..profile };
    let profile = palpate::scene::device_to_json(&profile).unwrap();
    let file = folder.write("senses.json", &profile);
    let refused = |arguments: &[&str], rule: &str| {
        let output = palpate(arguments);
        let said = errors(&output);
        assert!(status(&output) == 2 && said.contains(rule), "{said}");
    };
    refused(
        &["devices", "--stability", "--profile", &file],
        "Force Dimension omega gives no forces, so nothing presses back",
    );
    // Once it was run without any force, in silence.
    let device = format!("simulated:{file}");
    refused(
        &["feel", "--fast", "--device", &device, "--stiffness", "300", "--strict"],
        "--stiffness, --strict have no meaning for Force Dimension omega, which has no forces",
    );
    refused(&["devices", "--materials", "--material", "rubber"], "cannot be used with");
}

/// Once the status was 0, with a damping three times too large and an error of 0.2 %.
#[test]
fn a_hand_too_soft_to_be_noticed_is_told_by_the_misfit() {
    let output = palpate(&["identify", "--device", "omega", "--grip", "3.9"]);
    let said = text(&output);
    assert_eq!(status(&output), 1, "{said}");
    for words in [
        "misfit 1.76 (good: 1.4 at most)\n",
        "  it moves otherwise than a mass with damping and friction, as where a hand holds it softly",
        "  damping       cannot be told: 7.537 N·s/m is nearest; ",
        "  encoder step  0.00001 m; as the profile's 0.00001; ",
    ] {
        assert!(said.contains(words), "{words}\n{said}");
    }
}

/// What does not fit is not always a hand's.
#[test]
fn messages_name_the_causes_and_numbers_that_are_few_digits_long() {
    let told = |option: &str, value: &str| {
        errors(&palpate(&["identify", "--device", "omega", option, value]))
    };
    let coarse = told("--plant-encoder-step", "1000");
    assert!(coarse.contains("the travel is too small for its encoder steps"), "{coarse}");
    let light = told("--plant-mass", "1e-30");
    assert!(light.contains("must be at most 1e4, got 1.2499999999999998e31 1/s"), "{light}");
    let none = text(&palpate(&["identify", "--device", "omega", "--plant-encoder-step", "0"]));
    assert!(
        none.contains("encoder step  0 m; -100 % of the profile's 0.00001; it was made with 0")
    );
}

/// Once a gripper and buttons were not written, and files could not have them.
#[test]
fn the_gripper_and_the_buttons_of_a_file_are_listed() {
    let folder = Folder::new();
    let gripper = palpate::device::GripperProfile::new(0.025, 8.0);
    let profile = palpate::device::profile_named("omega7").unwrap();
    let profile = palpate::device::DeviceProfile {
        gripper: Some(palpate::device::GripperProfile { max_force_rate: 2000.0, ..gripper }),
        ..profile
    };
    let profile = profile.with_buttons(["front", "rear"]);
    let file = palpate::scene::device_to_json(&profile).unwrap();
    let file = folder.write("omega.json", &file);
    let listed = text(&palpate(&["devices", "--profile", &file]));
    assert!(listed.contains(&format!("{file}, buttons: front, rear\n")), "{listed}");
    let words: Vec<_> = listed.split_whitespace().collect();
    assert!(words.windows(3).any(|row| row == ["0.025", "8", "2000"]), "{listed}");
    let rows = json(&["devices", "--profile", &file, "--json"]);
    assert_eq!(rows["devices"][0]["gripper"]["max_force"]["unit"], "N");
    assert_eq!(rows["devices"][0]["buttons"][1], "rear");
}
