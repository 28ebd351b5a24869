// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate feel`, `devices` and `jitter`.

use crate::common::{Folder, errors, json, number, palpate, status, text};
use crate::pictures::words;

const BALL: &str = r#"{ "palpate": 1, "dimension": 3,
  "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.5 } } } ] }"#;

#[test]
fn devices_lists_limits_with_units_sources_and_what_is_assumed() {
    let all = json(&["devices", "--json"]);
    let all = all["devices"].as_array().unwrap();
    assert_eq!(all.len(), palpate::device::PROFILES.len());
    let omega = all.iter().find(|device| device["name"] == "omega").unwrap();
    let force = serde_json::json!({ "value": 12.0, "unit": "N", "is_assumed": false });
    assert_eq!(omega["max_force"], force);
    assert_eq!(omega["least_damping"]["is_assumed"], true);
    assert!(omega["source"].as_str().unwrap().contains("CHAI3D 3.3.0"));
    assert!(omega["turning"].is_null());
    let sigma = all.iter().find(|device| device["name"] == "sigma7").unwrap();
    let torque = serde_json::json!({ "value": 0.2, "unit": "N·m", "is_assumed": false });
    assert_eq!(sigma["turning"]["max_torque"], torque);
    assert_eq!(sigma["turning"]["inertia"]["is_assumed"], true);
    let table = text(&palpate(&["devices"]));
    let row = table.lines().find(|line| line.starts_with("omega ")).unwrap();
    let cells: Vec<_> = row.split_whitespace().collect();
    assert_eq!(cells[1..5], ["12", "~12", "~6000", "5000"]);
    let rows: Vec<_> = table.lines().filter(|line| line.starts_with("sigma7 ")).collect();
    let cells: Vec<_> = rows[1].split_whitespace().collect();
    assert_eq!(cells[1..5], ["0.2", "~0.2", "~100", "1"]);
    assert!(table.contains("\nomega: Force Dimension omega; source: "));
    assert!(table.contains(&format!("\n{} devices\n\nactuators", all.len())));
    let alone = text(&palpate(&["devices", "--actuators"]));
    assert!(table.ends_with(&alone) && alone.ends_with("\n4 actuators\n"));
    let lra = "\nlra: LRA, Vybronics VG1040003D, a coin of 10 mm: resonance 170 Hz, \
               bandwidth ~10 Hz, overdrive ~1.2\nlra: source: ";
    assert!(alone.contains(lra), "{alone}");
    let actuators = json(&["devices", "--actuators", "--json"]);
    let voltage = serde_json::json!({ "value": 1.5, "unit": "", "is_assumed": false });
    assert_eq!(actuators["actuators"][0]["overdrive"], voltage);
    assert_eq!(actuators["actuators"][2]["bandwidth"]["is_assumed"], true);
}

/// The built-in scene, felt without waiting for the clock, twice the same.
#[test]
fn feel_reports_traces_and_draws() {
    let folder = Folder::new();
    let (trace, plot) = (folder.name("trace.csv"), folder.name("feel.svg"));
    let arguments =
        ["feel", "--fast", "--duration", "2", "--json", "--trace", &trace, "--plot", &plot];
    let report = json(&arguments);
    assert_eq!(report["ticks"], 2000);
    assert_eq!(report["ending"]["kind"], "finished");
    assert!(report["contact_time"].as_f64().unwrap() > 0.1);
    assert!(report["largest_force"].as_f64().unwrap() <= 3.3);
    assert!(report["cost"]["p50"].as_f64().unwrap() > 0.0);
    let rows = std::fs::read_to_string(&trace).unwrap();
    // Ten fingers.
    assert_eq!(rows.lines().count(), 20_001);
    assert_eq!(
        rows.lines().next().unwrap(),
        "time_s,point,device_x_m,device_y_m,device_z_m,proxy_x_m,proxy_y_m,proxy_z_m,\
         wanted_x_n,wanted_y_n,wanted_z_n,force_x_n,force_y_n,force_z_n,\
         normal_x,normal_y,normal_z,contact,body,slipping,lifted,taken_j,given_j,kept_j,\
         evaluations,cost_ns,lateness_ns"
    );
    let svg = std::fs::read_to_string(&plot).unwrap();
    // A colour and a panel a finger, and the bodies with their materials.
    let found = words(&svg);
    for word in ["proxy 0", "proxy 9", "hand of each", "point 0", "point 9", "force [N]"] {
        assert!(found.contains(&word), "{word} in {found:?}");
    }
    assert!(svg.contains("stroke=\"#5cb8f0\""), "the tenth colour");
    assert!(found.contains(&"sphere") && found.contains(&"1000 N/m"), "{found:?}");
    let again = json(&arguments);
    for key in ["ticks", "contact_time", "largest_force", "largest_depth", "evaluations"] {
        assert_eq!(report[key], again[key], "{key}");
    }
}

/// The last body of the gallery has a bore that is narrower at its top, where a proxy may stay
/// behind.
#[test]
fn no_proxy_is_left_behind_in_the_gallery() {
    for duration in ["10", "11"] {
        let report = json(&["feel", "--fast", "--duration", duration, "--json"]);
        let depth = report["largest_depth"].as_f64().unwrap();
        // Pressed to 3/4 of a probe of 3 mm. Friction keeps the proxy on one side of an apex for some
        // milliseconds, while the hand passes over it; one left behind would be decimetres away.
        assert!(depth < 0.01, "{depth} m deep in {duration} s");
    }
}

#[test]
fn a_scene_in_space_is_drawn_on_two_slices_and_says_so() {
    let folder = Folder::new();
    let plot = folder.name("cup.svg");
    json(&["feel", "scenes/cup.json", "--fast", "--json", "--plot", &plot]);
    let svg = std::fs::read_to_string(&plot).unwrap();
    let words = words(&svg);
    let has = |start: &str| words.iter().any(|word| word.starts_with(start));
    assert!(has("From above: slice at y = 0.0"), "{words:?}");
    assert!(has("From the front: slice at z = ") || has("From the side: slice at x = "));
    assert!(has("bound outside, exact inside. Bold: within 5 mm of the slice; thin: in front"));
    for once in ["inside", "behind the slice", "in front of the slice", "proxy", "hand"] {
        assert_eq!(words.iter().filter(|word| **word == once).count(), 1, "{once}");
    }
    assert!(has("surface of cup (800 N/m)"), "{words:?}");
}

#[test]
fn a_scene_in_the_plane_is_drawn_once() {
    let folder = Folder::new();
    let plot = folder.name("star.svg");
    json(&["feel", "scenes/memoir_star.json", "--fast", "--json", "--plot", &plot]);
    let svg = std::fs::read_to_string(&plot).unwrap();
    let words = words(&svg);
    assert!(words.contains(&"bound outside, bound inside") && words.contains(&"proxy"));
    assert!(!words.iter().any(|word| word.contains("slice")), "{words:?}");
}

#[test]
fn feel_follows_a_hand_of_several_points() {
    let folder = Folder::new();
    let scene = folder.write("ball.json", BALL);
    let hand = folder.write(
        "hand.csv",
        "time_s,point,x_m,y_m,z_m\n0,0,0,0.6,0\n0,1,0.6,0,0\n1,0,0,0.499,0\n1,1,0.499,0,0\n",
    );
    let arguments = [
        "feel",
        &scene,
        "--path",
        &hand,
        "--fast",
        "--stiffness",
        "1000",
        "--damping",
        "0",
        "--json",
    ];
    let report = json(&arguments);
    assert_eq!(report["points"], 2);
    // A probe of 2 mm on a ball pressed by 1 mm: 3 mm deep.
    assert!((report["largest_depth"].as_f64().unwrap() - 0.003).abs() < 1e-4);
    assert!((report["largest_force"].as_f64().unwrap() - 3.0).abs() < 0.1);
    let bad = folder.write("bad.csv", "time_s,x_m,y_m,z_m\n0,0,0,0\n0,0,0,1\n");
    assert_eq!(status(&palpate(&["feel", &scene, "--path", &bad])), 2);
    assert_eq!(status(&palpate(&["feel", &scene, "--rate", "-5", "--fast"])), 2);
    for contacts in ["0", "1000000000"] {
        assert_eq!(status(&palpate(&["feel", &scene, "--contacts", contacts, "--fast"])), 2);
    }
    for huge in ["1e300", "1e9", "nan", "-1"] {
        assert_eq!(
            status(&palpate(&["feel", &scene, "--duration", huge, "--fast"])),
            2,
            "{huge}"
        );
    }
}

#[test]
fn a_glove_feels_what_it_vibrates_like() {
    let folder = Folder::new();
    let (wav, plot) = (folder.name("touch.wav"), folder.name("glove.svg"));
    let report = json(&[
        "feel",
        "--device",
        "glove",
        "--duration",
        "1",
        "--fast",
        "--wav",
        &wav,
        "--plot",
        &plot,
        "--json",
    ]);
    assert_eq!((&report["points"], &report["largest_force"]), (&10.into(), &0.0.into()));
    let bytes = std::fs::read(&wav).unwrap();
    // A header of 44 bytes, and for each actuator 8000 samples of two bytes a second.
    assert_eq!((&bytes[..4], &bytes[22..24]), (&b"RIFF"[..], &[10, 0][..]));
    let seconds = report["duration"].as_f64().unwrap();
    assert_eq!(bytes.len(), 44 + 10 * 2 * (8000.0 * seconds) as usize);
    let (samples, _) = bytes[44..].as_chunks::<2>();
    let channel = |number: usize| {
        let samples = samples.iter().skip(number).step_by(10);
        Vec::from_iter(samples.map(|sample| i16::from_le_bytes(*sample)))
    };
    let sounding = (0..10).filter(|number| channel(*number).iter().any(|sample| *sample != 0));
    assert!(sounding.count() > 1, "silence");
    assert_ne!(channel(0), channel(1));
    let svg = std::fs::read_to_string(&plot).unwrap();
    let words = words(&svg);
    for word in ["actuator 0", "actuator 9", "level [1 = largest]", "pressure", "slide", "tap"]
    {
        assert!(words.contains(&word), "{word} in {words:?}");
    }
    assert!(!words.contains(&"force [N]"), "{words:?}");
}

#[test]
fn ten_fingers_are_felt_on_every_actuator_and_none_is_clipped() {
    let folder = Folder::new();
    let wav = folder.name("touch.wav");
    let run = ["feel", "--device", "glove", "--duration", "2", "--fast", "--wav", &wav];
    let mut files = Vec::new();
    for (name, kind) in [("erm", "ERM"), ("lra", "LRA"), ("voice_coil", "voice coil")] {
        let report = json(&[&run[..], &["--actuator", name, "--json"]].concat());
        let vibration = &report["played"];
        assert_eq!((&vibration["kind"], &vibration["channels"]), (&kind.into(), &10.into()));
        let levels = vibration["sensation_levels"].as_array().unwrap();
        assert_eq!(levels.len(), 10);
        for level in levels.iter().filter_map(serde_json::Value::as_f64) {
            assert!(level > 6.0, "{name}: {level} dB");
        }
        assert!(levels.iter().any(|level| !level.is_null()), "{name}: silence");
        files.push(std::fs::read(&wav).unwrap());
        let said = text(&palpate(&[&run[..], &["--actuator", name]].concat()));
        assert!(said.contains(&format!("10 actuators: {kind}, ")), "{said}");
        assert!(said.contains(" dB above the threshold of the skin"), "{said}");
    }
    assert!(files[0] != files[1] && files[1] != files[2]);
    // Pressure and taps together are more than the largest level: they are limited, not cut off.
    let report = json(&[&run[..], &["--json"]].concat());
    let vibration = &report["played"];
    assert!(vibration["limited_ticks"].as_u64().unwrap() > 0);
    assert!(vibration["largest_reduction"].as_f64().unwrap() > 1.0);
    let bytes = std::fs::read(&wav).unwrap();
    let (samples, _) = bytes[44..].as_chunks::<2>();
    let samples: Vec<i16> = samples.iter().map(|bytes| i16::from_le_bytes(*bytes)).collect();
    let channel = |number: usize| samples.iter().skip(number).step_by(10).copied();
    for number in 0..10 {
        let samples: Vec<i16> = channel(number).collect();
        // What is cut off stays at the largest value for several samples.
        let is_cut = |five: &[i16]| five.iter().all(|sample| sample.unsigned_abs() >= 32767);
        assert!(!samples.windows(5).any(is_cut), "actuator {number}");
    }
    let unknown = palpate(&[&run[..], &["--actuator", "lar"]].concat());
    assert_eq!(status(&unknown), 2);
    assert!(errors(&unknown).contains("unknown actuator `lar`, did you mean `lra`?"));
}

#[test]
fn the_actuator_of_a_scene_plays_unless_the_command_line_names_another() {
    let folder = Folder::new();
    let scene = r#"{ "palpate": 1, "dimension": 3, "tool": { "actuator": "lra" },
      "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.05 } } } ] }"#;
    let (scene, wav) = (folder.write("ball.json", scene), folder.name("touch.wav"));
    let run = ["feel", &scene, "--fast", "--duration", "0.5", "--wav", &wav, "--json"];
    assert_eq!(json(&run)["played"]["kind"], "LRA");
    let other = json(&[&run[..], &["--actuator", "erm"]].concat());
    assert_eq!(other["played"]["kind"], "ERM");
}

#[test]
fn a_texture_that_is_too_fast_for_the_rate_says_which_rate_it_wants() {
    let folder = Folder::new();
    let scene = r#"{ "palpate": 1, "dimension": 3, "bodies": [ { "name": "plate",
      "shape": { "box": { "size": [2, 0.2, 2] } }, "material": { "texture":
        { "kind": "height", "amplitude": 1e-4, "wavelength": 1e-3, "direction": [1, 0, 0] } } } ] }"#;
    let scene = folder.write("plate.json", scene);
    let hand = "time_s,x_m,y_m,z_m\n0,0,0.1,0\n1,0.4,0.1,0\n";
    let hand = folder.write("hand.csv", hand);
    let run = |rate| ["feel", &scene, "--path", &hand, "--fast", "--rate", rate];
    let said = text(&palpate(&run("1000")));
    assert!(said.contains("crests a second want a rate of 2400 Hz"), "{said}");
    // The hand goes 0.4 m in a second along a cubic: up to 0.6 m/s over crests 1 mm apart.
    let report = json(&[&run("1000")[..], &["--json"]].concat());
    let texture = &report["texture"];
    assert!((texture["highest_frequency"].as_f64().unwrap() - 600.0).abs() < 1.0, "{texture}");
    assert!((texture["wanted_rate"].as_f64().unwrap() - 2400.0).abs() < 4.0);
    // 2.4 t (1 − t) m/s is more than 0.25 m/s for 764 ms.
    assert!((760..=768).contains(&texture["faded_ticks"].as_u64().unwrap()), "{texture}");
    let report = json(&[&run("4000")[..], &["--json"]].concat());
    assert_eq!(report["texture"]["faded_ticks"], 0);
    assert!(!text(&palpate(&run("4000"))).contains("faded"));
}

#[test]
fn a_device_is_simulated_with_its_limits() {
    let arguments = ["feel", "--device", "simulated:touch", "--points", "2", "--duration", "1"];
    let report = json(&[&arguments[..], &["--fast", "--json"]].concat());
    assert_eq!(report["device"], "Phantom Touch");
    assert!(report["largest_force"].as_f64().unwrap() <= 3.3);
    assert_eq!(report["safety"].as_array().unwrap().len(), 2);
    // The gallery asks for more than the device's 400 N/m.
    assert!(report["bodies"][0]["accepted"]["stiffness_factor"].as_f64().unwrap() < 1.0);
    assert_eq!(report["bodies"][0]["accepted"]["stiffness_rule"], "max_stiffness");
    let strict = palpate(&[&arguments[..], &["--fast", "--strict"]].concat());
    assert_eq!(status(&strict), 2);
    assert!(
        errors(&strict).contains(": K ≤ the device's largest stiffness at this rate"),
        "{}",
        errors(&strict)
    );
    let unknown = palpate(&["feel", "--device", "simulated:nothing"]);
    assert!(errors(&unknown).contains("omega"), "{}", errors(&unknown));
}

#[test]
fn ten_points_feel_a_flat_scene() {
    let report = json(&[
        "feel",
        "scenes/wrench.json",
        "--contacts",
        "10",
        "--duration",
        "1",
        "--fast",
        "--json",
    ]);
    assert_eq!((&report["points"], &report["ticks"]), (&10.into(), &1000.into()));
}

#[test]
fn more_points_than_colours_are_drawn_alike_and_more_than_panels_together() {
    let folder = Folder::new();
    let plot = folder.name("many.svg");
    let drawn = |points: &str| {
        let run = ["feel", "scenes/wrench.json", "--fast", "--duration", "0.5", "--json"];
        json(&[&run[..], &["--points", points, "--plot", &plot]].concat());
        std::fs::read_to_string(&plot).unwrap()
    };
    for (points, expected, missing) in [
        ("10", ["proxy 9", "point 9"], "proxy"),
        ("11", ["proxy", "point 10"], "proxy 0"),
        ("25", ["proxy", "largest force on one of 25 points"], "point 0"),
    ] {
        let svg = drawn(points);
        let words = words(&svg);
        assert!(expected.iter().all(|word| words.contains(word)), "{points}: {words:?}");
        assert!(!words.contains(&missing), "{points}: {words:?}");
    }
}

#[test]
fn jitter_measures_every_way_to_wait_and_advises() {
    let answer = json(&["jitter", "--rate", "4000", "--duration", "0.03", "--json"]);
    assert_eq!(answer["rate"], 4000.0);
    let loops = answer["loops"].as_array().unwrap();
    let is_raised = answer["priority"]["kind"] == "raised";
    assert_eq!(loops.len(), if is_raised { 6 } else { 3 });
    let count = if is_raised { 20 } else { 40 };
    assert!(loops.iter().all(|measured| measured["lateness"]["times"]["count"] == count));
    assert_eq!(loops[1]["waiting"], "sleep_then_spin");
    assert!(!answer["advice"].as_array().unwrap().is_empty());

    let report = text(&palpate(&["jitter", "--duration", "0.03"]));
    assert!(report.starts_with("how late a loop of 1000 Hz wakes on this machine\nsleep\n"));
    assert!(report.contains("p99.9 ") && report.contains("\nadvice\n  - "), "{report}");
    for bad in [["--rate", "0"], ["--rate", "20000"], ["--duration", "nan"]] {
        let output = palpate(&["jitter", bad[0], bad[1]]);
        assert_eq!(status(&output), 2, "{bad:?}");
        assert!(!errors(&output).is_empty());
    }
}

/// A plate of 6 cm by 4 cm on the ground, 3 mm deep at last.
const PLATE: &str = r#"{ "palpate": 1, "dimension": 2,
  "bodies": [ { "name": "ground",
    "shape": { "translate": [0, -0.05], "of": { "cuboid": { "size": [0.4, 0.1] } } },
    "material": { "stiffness": 500, "damping": 0, "static_friction": 0, "dynamic_friction": 0 } } ],
  "tool": { "shape": { "cuboid": { "size": [0.06, 0.04] } },
    "coupling": { "stiffness": 500, "damping": 0 } } }"#;

#[test]
fn a_tool_with_a_shape_is_felt_as_a_whole() {
    let folder = Folder::new();
    let scene = folder.write("plate.json", PLATE);
    let hand = folder.write("hand.csv", "time_s,x_m,y_m\n0,0.01,0.05\n1,0.01,0.017\n");
    let trace = folder.name("trace.csv");
    let report = json(&[
        "feel",
        &scene,
        "--path",
        &hand,
        "--fast",
        "--json",
        "--trace",
        &trace,
        "--duration",
        "1.2",
    ]);
    // 3 mm of 500 N/m, on a face that stays flat.
    assert!((report["largest_force"].as_f64().unwrap() - 1.5).abs() < 1e-3);
    assert!((report["largest_depth"].as_f64().unwrap() - 0.003).abs() < 1e-6);
    let tool = &report["tool"];
    assert_eq!((&tool["points"], &tool["degraded_ticks"]), (&500.into(), &0.into()));
    assert!(tool["largest_torque"].as_f64().unwrap() < 1e-3, "{tool}");
    assert!(tool["most_contacts"].as_u64().unwrap() >= 2, "{tool}");
    assert_eq!(report["events"]["touches"], 1);
    assert_eq!(report["coupling"]["stiffness_factor"], 1.0);
    assert_eq!(report["points"], 1);
    let rows = std::fs::read_to_string(&trace).unwrap();
    let header: Vec<_> = rows.lines().next().unwrap().split(',').collect();
    let ending = ["torque_z_nm", "turn_z_rad", "contacts", "resolution_m", "degraded"];
    assert!(header.ends_with(&ending), "{header:?}");
    assert!(rows.lines().all(|row| row.split(',').count() == header.len()));
    // Fingers have no shape.
    let refused = palpate(&["feel", &scene, "--points", "3", "--fast"]);
    assert_eq!(status(&refused), 2);
    assert!(errors(&refused).contains("the tool of the scene has a shape"));
}

#[test]
fn a_stylus_tours_a_cup_and_is_drawn() {
    let folder = Folder::new();
    let plot = folder.name("stylus.svg");
    let arguments =
        ["feel", "scenes/stylus_in_cup.json", "--fast", "--duration", "5", "--json"];
    let report = json(&[&arguments[..], &["--plot", &plot]].concat());
    assert!(report["contact_time"].as_f64().unwrap() > 2.0, "{report}");
    // The tour presses the whole stylus no deeper than a probe.
    assert!(report["largest_depth"].as_f64().unwrap() < 0.006, "{report}");
    let tool = &report["tool"];
    assert_eq!(tool["covered_ticks"], 0);
    assert!(tool["largest_torque"].as_f64().unwrap() > 0.01, "{tool}");
    let svg = std::fs::read_to_string(&plot).unwrap();
    let words = words(&svg);
    for word in
        ["stylus in cup, felt with a tool", "tool's origin", "torque in the world [mN·m]"]
    {
        assert!(words.contains(&word), "{word} is not among {words:?}");
    }
    for start in ["tool, first touch: ", "tool, deepest: ", "tool, last touch: "] {
        let found = words.iter().filter(|word| word.starts_with(start) && word.ends_with(" s"));
        assert_eq!(found.count(), 1, "{start} in {words:?}");
    }
    let again = json(&arguments);
    for key in ["contact_time", "largest_force", "evaluations", "tool"] {
        assert_eq!(report[key], again[key], "{key}");
    }
    // A device that bears less is given a softer coupling.
    let simulated = json(&[&arguments[..], &["--device", "simulated:touch"]].concat());
    let factor = simulated["coupling"]["stiffness_factor"].as_f64().unwrap();
    let stiffness = simulated["tool"]["stiffness"].as_f64().unwrap();
    assert!(factor < 1.0 && (stiffness - 600.0 * factor).abs() < 1e-9, "{factor} {stiffness}");
    let text =
        text(&palpate(&["feel", "scenes/stylus_in_cup.json", "--fast", "--duration", "1"]));
    assert!(text.contains("felt with a tool of 57 points"), "{text}");
}

#[test]
fn a_stylus_turns_with_a_device_that_turns() {
    let folder = Folder::new();
    let (trace, plot) = (folder.name("trace.csv"), folder.name("turn.svg"));
    let arguments = ["feel", "scenes/stylus_in_cup.json", "--fast", "--duration", "5"];
    let on = |device: &str, more: &[&str]| {
        json(&[&arguments[..], &["--json", "--device", device], more].concat())
    };
    let report = on("simulated:sigma7", &["--trace", &trace, "--plot", &plot]);
    let written = report["tool"]["largest_torque_written"].as_f64().unwrap();
    let turning = &report["safety"][0]["turning"];
    let (at_device, scale) =
        (number(&turning["largest_torque"]), number(&report["workspace_scale"]));
    assert!(at_device > 0.01 && at_device <= 0.2, "{report}");
    // In the world, as all torques but those of the safety chain.
    assert!((written - scale * at_device).abs() < 1e-12 && scale != 1.0, "{scale} {report}");
    assert_eq!(report["angular_coupling"]["stiffness_rule"], "max_angular_stiffness");
    assert_eq!(report["angular_coupling"], turning["impedance"]);
    let rows = std::fs::read_to_string(&trace).unwrap();
    let header: Vec<_> = rows.lines().next().unwrap().split(',').collect();
    let given = ["given_torque_x_nm", "given_torque_y_nm", "given_torque_z_nm"];
    assert!(header.ends_with(&given), "{header:?}");
    assert!(rows.lines().all(|row| row.split(',').count() == header.len()));
    let svg = std::fs::read_to_string(&plot).unwrap();
    assert!(words(&svg).contains(&"given to the hand"));
    // One that senses turns alone, one that does not turn.
    let senses = on("simulated:omega6", &[]);
    assert_eq!(senses["tool"]["largest_torque_written"], 0.0);
    assert!(senses["safety"][0]["turning"].is_null());
    let still = on("simulated:omega", &[]);
    assert!(still["tool"]["largest_torque_written"].is_null());
    let text = text(&palpate(&[&arguments[..], &["--device", "simulated:sigma7"]].concat()));
    assert!(
        text.contains("written to the device")
            && text.contains("coupling about axes softer than asked")
    );
}

/// The points of a tool were read, but one finger felt the scene.
#[test]
fn the_contact_points_of_a_tool_are_fingers() {
    let folder = Folder::new();
    let tool =
        r#""tool": { "radius": 0.01, "points": [[-0.1, 0, 0], [0, 0, 0], [0.1, 0, 0]] }"#;
    let fingers = BALL.replace("\"bodies\"", &format!("{tool}, \"bodies\""));
    let scene = folder.write("fingers.json", &fingers);
    let report = json(&["feel", &scene, "--fast", "--duration", "2", "--json"]);
    assert_eq!(report["points"], 3);
    let one = json(&["feel", &scene, "--fast", "--duration", "2", "--json", "--points", "1"]);
    assert_eq!(one["points"], 1);
}
