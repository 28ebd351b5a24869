// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Profiles of devices as files: what they keep, and what is told of wrong ones.

use palpate_device::{Buttons, DeviceProfile, GripperProfile};
use palpate_scene::{device_from_json, device_to_json};

fn text(name: &str) -> String {
    device_to_json(&palpate_device::profile_named(name).unwrap()).unwrap()
}

#[test]
fn every_profile_is_read_as_it_was_written() {
    for (name, profile) in &palpate_device::PROFILES {
        assert_eq!(&device_from_json(text(name).as_bytes()).unwrap(), profile, "{name}");
    }
}

/// Once they were left out.
#[test]
fn grippers_and_buttons_are_kept() {
    let gripper = GripperProfile { max_force_rate: 2000.0, ..GripperProfile::new(0.025, 8.0) };
    let omega = palpate_device::profile_named("omega7").unwrap();
    let device =
        (DeviceProfile { gripper: Some(gripper), ..omega }).with_buttons(["front", "rear"]);
    let text = device_to_json(&device).unwrap();
    assert_eq!(device_from_json(text.as_bytes()).unwrap(), device);
    let wrong = text
        .replace("\"max_opening\": 0.025", "\"max_opening\": 0")
        .replace("\"rear\"", "\"front\", \"\"");
    let error = device_from_json(wrong.as_bytes()).unwrap_err().to_string();
    for said in [
        "max_opening must be positive, got 0 m",
        "two buttons are named \"front\"",
        "buttons[2], line ",
    ] {
        assert!(error.contains(said), "{said}\n{error}");
    }
    let many = device.with_buttons((0..=Buttons::MOST).map(|i| i.to_string()));
    let error = device_to_json(&many).unwrap_err().to_string();
    assert!(error.contains("buttons must be at most "), "{error}");
}

#[test]
fn all_that_is_wrong_is_told_with_its_place() {
    let wrong = text("sigma7")
        .replace("\"palpate_device\": 1", "\"palpate_device\": 2")
        .replace("\"friction\": 0.15", "\"friction\": -0.15")
        .replace("\"inertia\": 0.0002", "\"inertia\": 0")
        .replace("\"max_acceleration\": 10000", "\"max_acceleration\": 0")
        .replace("\"mass\",", "\"mas\",");
    let error = device_from_json(wrong.as_bytes()).unwrap_err().to_string();
    for said in [
        "5 problems:",
        "palpate_device, line 2: palpate_device must be 1, got 2",
        "friction, line 12: friction must be zero or more, got -0.15 N",
        "turning.inertia, line 22: inertia must be positive, got 0 kg·m²",
        "turning.max_acceleration, line 27: max_acceleration must be positive, got 0 rad/s²",
        "assumed[2], line 44: unknown number of a device `mas`, did you mean `mass`?",
    ] {
        assert!(error.contains(said), "{said}\n{error}");
    }
}

#[test]
fn numbers_that_are_missing_or_unknown_are_refused() {
    let missing = text("touch").replace("  \"max_force\": 3.3,\n", "");
    let error = device_from_json(missing.as_bytes()).unwrap_err().to_string();
    assert_eq!(error, "line 1: missing key `max_force`");
    let unknown = text("touch").replace("\"mass\": 0.045", "\"weight\": 0.045");
    let error = device_from_json(unknown.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("weight"), "{error}");
    let error = device_from_json(b"{ \"palpate\": 1 }").unwrap_err().to_string();
    assert!(error.contains("unknown key `palpate`"), "{error}");
}

/// Once the first was told alone, and nothing of the values.
#[test]
fn all_keys_that_are_missing_are_told_beside_what_is_wrong() {
    let lines = text("sigma7");
    let without =
        ["device\"", "max_force\"", "friction\"", "max_torque\"", "encoder_step\"", "source\""];
    let is_left = |line: &&str| !without.iter().any(|key| line.contains(&format!("\"{key}:")));
    let left: Vec<_> = lines.lines().filter(is_left).collect();
    let wrong = left.join("\n").replace("\"mass\": 0.", "\"mass\": -0.");
    let wrong =
        wrong.replacen("\"max_acceleration\"", "\"gripper\": {}, \"max_acceleration\"", 1);
    let error = device_from_json(wrong.as_bytes()).unwrap_err().to_string();
    for said in [
        "13 problems:",
        "line 1: missing key `device`",
        "line 1: missing key `max_force`",
        "line 1: missing key `friction`",
        "line 1: missing key `encoder_step`",
        "line 1: missing key `source`",
        "mass, line 8: mass must be positive, got -0.3 kg",
        "gripper, line 11: missing key `max_opening`",
        "gripper, line 11: missing key `max_force`",
        "gripper, line 11: missing key `max_force_rate`",
        "turning, line 12: missing key `max_torque`",
        "turning, line 12: missing key `friction`",
        "turning, line 12: missing key `encoder_step`",
        "turning, line 12: missing key `source`",
    ] {
        assert!(error.contains(said), "{said}\n{error}");
    }
}

/// Once they were read, and refused without a place when a servo was made.
#[test]
fn limits_that_leave_no_force_are_told_with_their_places() {
    let wrong = text("sigma7")
        .replace("\"max_force_rate\": 6000", "\"max_force_rate\": 0")
        .replace("\"continuous_force\": 12", "\"continuous_force\": 13")
        .replace("\"friction\": 0.15", "\"friction\": 0")
        .replace("\"Force Dimension sigma.7\"", "\"Force\\nDimension\"");
    let error = device_from_json(wrong.as_bytes()).unwrap_err().to_string();
    for said in [
        "max_force_rate must be positive, got 0 N/s",
        "continuous_force must be at most max_force, 12 N, got 13 N",
        "friction must be positive beside encoder steps, got 0 N",
        "device must be one line without control characters",
    ] {
        assert!(error.contains(said), "{said}\n{error}");
    }
    // A device that gives no forces needs none of the limits.
    let senses = text("omega").replace("\"max_force\": 12", "\"max_force\": 0");
    let senses = senses.replace("\"max_force_rate\": ", "\"max_force_rate\": 0.0e-");
    let error = device_from_json(senses.as_bytes()).unwrap_err().to_string();
    let said = "continuous_force must be at most max_force, 0 N, got 12 N";
    assert!(error.ends_with(said), "{error}");
    let senses = senses.replace("\"continuous_force\": 12", "\"continuous_force\": 0");
    assert!(device_from_json(senses.as_bytes()).is_ok(), "{senses}");
    // A largest force that is wrong says nothing of the lasting one.
    let wrong = text("omega").replace("\"max_force\": 12", "\"max_force\": -12");
    let error = device_from_json(wrong.as_bytes()).unwrap_err().to_string();
    assert!(error.ends_with(": max_force must be zero or more, got -12 N"), "{error}");
}

/// Once it was read as if it stood there once.
#[test]
fn a_number_that_is_assumed_twice_is_told() {
    let wrong = text("omega").replace("\"assumed\": [", "\"assumed\": [\"mass\", \"mass\", ");
    let error = device_from_json(wrong.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("`mass` is listed twice"), "{error}");
}

/// Once a metre of the device was 3e299 m of the scene.
#[test]
fn numbers_of_no_device_are_told() {
    let wrong = text("omega")
        .replace("\"workspace_radius\": 0.08", "\"workspace_radius\": 1e-300")
        .replace("\"workspace_radius\": 0.075", "\"workspace_radius\": 1e-300")
        .replace("\"max_stiffness\": 5000", "\"max_stiffness\": 1e308");
    let error = device_from_json(wrong.as_bytes()).unwrap_err().to_string();
    for said in [
        "workspace_radius must be from 1e-9 to 1e9 in size, got 1e-300",
        "max_stiffness must be from 1e-9 to 1e9 in size, got 1e308",
    ] {
        assert!(error.contains(said), "{said}\n{error}");
    }
}

#[test]
fn a_device_without_limits_is_not_written() {
    let ideal = DeviceProfile::unlimited("ideal");
    let error = device_to_json(&ideal).unwrap_err().to_string();
    assert!(
        error.contains("max_force: max_force must be zero or more and finite, got inf N"),
        "{error}"
    );
}
