// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What `palpate feel` says of its run, and what it refuses before one.

use crate::common::{Folder, assert_refused, errors, json, palpate, root, status, text};
use crate::pictures::words;

const BALL: &str = r#"{ "palpate": 1, "dimension": 3,
  "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.5 } } } ] }"#;

/// A table of 1 m with a cup of 6 cm, and a marble in a corner.
const TABLE: &str = r#"{ "palpate": 1, "dimension": 3, "bodies": [
  { "name": "table", "shape": { "translate": [0, -0.02, 0], "of": { "cuboid": { "size": [1, 0.04, 1] } } } },
  { "name": "cup", "shape": { "translate": [0.2, 0.03, -0.1], "of": { "difference": [
    { "cylinder": { "radius": 0.03, "height": 0.06 } },
    { "translate": [0, 0.005, 0], "of": { "cylinder": { "radius": 0.025, "height": 0.06 } } } ] } } },
  { "name": "marble", "shape": { "translate": [-0.48, 0.01, 0.47], "of": { "ball": { "radius": 0.01 } } } } ] }"#;

/// Every row of a column of a trace.
fn column(trace: &str, name: &str) -> Vec<String> {
    let mut lines = trace.lines();
    let place = lines.next().unwrap().split(',').position(|column| column == name).unwrap();
    lines.map(|line| line.split(',').nth(place).unwrap().to_owned()).collect()
}

/// The tour touched the table only.
#[test]
fn feel_touches_every_body_on_a_table() {
    let folder = Folder::new();
    let (scene, trace) = (folder.write("table.json", TABLE), folder.name("trace.csv"));
    let tool = r#""tool": { "shape": { "capsule": { "radius": 0.002, "height": 0.02 } } }, "#;
    let stylus = TABLE.replace("\"bodies\"", &format!("{tool}\"bodies\""));
    let stylus = folder.write("stylus.json", &stylus);
    for scene in [scene, stylus] {
        json(&["feel", &scene, "--fast", "--json", "--trace", &trace]);
        let trace = std::fs::read_to_string(&trace).unwrap();
        let (contacts, bodies) = (column(&trace, "contact"), column(&trace, "body"));
        for body in ["0", "1", "2"] {
            let touches = contacts.iter().zip(&bodies);
            let touches = touches.filter(|(contact, its)| *contact == "true" && *its == body);
            assert!(touches.count() > 20, "body {body} of {scene}");
        }
    }
}

/// A hand begins 1.2 mm inside, leaves, and comes back.
#[test]
fn a_force_waits_until_the_hand_is_out_if_asked() {
    let folder = Folder::new();
    let scene = folder.write("ball.json", BALL);
    let rows = "time_s,x_m,y_m,z_m\n0,0,0.4988,0\n0.4,0,0.4988,0\n0.5,0,0.6,0\n0.6,0,0.6,0\n\
                0.7,0,0.4988,0\n1,0,0.4988,0\n";
    let (hand, trace) = (folder.write("hand.csv", rows), folder.name("trace.csv"));
    let forces = |recovery: &[&str]| {
        let device = ["--device", "simulated:omega", "--trace", &trace, "--json"];
        let feel = ["feel", &scene, "--path", &hand, "--fast"];
        json(&[&feel[..], &device, recovery].concat());
        let forces = column(&std::fs::read_to_string(&trace).unwrap(), "force_y_n");
        let forces: Vec<f64> = forces.iter().map(|force| force.parse().unwrap()).collect();
        let most = |part: &[f64]| part.iter().copied().fold(0.0, f64::max);
        [most(&forces[..400]), most(&forces[700..])]
    };
    let [at_once, again] = forces(&["--recovery", "rise"]);
    assert!(at_once > 0.1 && again > 0.1, "{at_once} N, {again} N");
    let [at_once, again] = forces(&["--recovery", "once-out"]);
    assert!(at_once == 0.0 && again > 0.1, "{at_once} N, {again} N");
}

#[test]
fn a_path_that_starts_inside_a_body_is_said() {
    let folder = Folder::new();
    let scene = folder.write("ball.json", BALL);
    let rows = "time_s,x_m,y_m,z_m\n0,0,0.4988,0\n0.41,0,0.4988,0\n0.42,0,0.6,0\n0.5,0,0.6,0\n";
    let hand = folder.write("hand.csv", rows);
    let feel = ["feel", &scene, "--path", &hand, "--fast"];
    let said = text(&palpate(&feel));
    let expected = "  start          contact point 0 started 1.2 mm inside body \"ball\": \
                    its force rose from zero\n";
    assert!(said.contains(expected), "{said}");
    let soft = [&feel[..], &["--stiffness", "0", "--damping", "0"]].concat();
    let report = json(&[&soft[..], &["--json"]].concat());
    let start = &report["starts_inside"][0];
    assert_eq!(report["bodies"][0]["name"], "ball");
    assert_eq!(start["body"], 0);
    let ticks = start["ticks_without_force"].as_u64().unwrap();
    assert!((405..=415).contains(&ticks), "{start}");
    let time = start["time_without_force"].as_f64().unwrap();
    let said = text(&palpate(&soft));
    let expected = format!(
        "  start          contact point 0 started 1.2 mm inside body \"ball\": no force for \
         {time} s, until it left\n"
    );
    assert!(said.contains(&expected), "{said}");
    let outside = folder.write("out.csv", "time_s,x_m,y_m,z_m\n0,0,0.6,0\n0.1,0,0.6,0\n");
    let report = json(&["feel", &scene, "--path", &outside, "--fast", "--json"]);
    assert_eq!(report["starts_inside"], serde_json::json!([]));
}

#[test]
fn what_is_too_much_or_too_little_is_refused_before_the_run() {
    let folder = Folder::new();
    let scene = folder.write("ball.json", BALL);
    let plot = folder.name("touch.svg");
    let feel = |more: &[&str], said: &str| {
        assert_refused(&[&["feel", &scene, "--fast"], more].concat(), said);
    };
    feel(
        &["--duration", "1e-9"],
        "a run of 1e-9 s has no tick at 1000 Hz; the least duration is 0.0005 s",
    );
    feel(
        &["--duration", "40000", "--plot", &plot],
        "--plot and --wav keep 3600000 rows at most, got 40000000; \
         shorten --duration, lower --rate, or use fewer contact points",
    );
    let output = palpate(&["feel", &scene, "--fast", "--points", "1000", "--duration", "100"]);
    let said = errors(&output);
    assert_eq!(status(&output), 2);
    assert!(said.starts_with("palpate: the paths of 1000 contact points with "), "{said}");
    let end = " GB of memory, more than 1 GB; shorten the path, or use fewer contact points\n";
    assert!(said.contains(" samples each would take ") && said.ends_with(end), "{said}");
    let short = folder.write("short.csv", "time_s,x_m,y_m,z_m\n0,0,1,0\n0.01,0,0.9,0\n");
    assert_refused(
        &["feel", &scene, "--path", &short, "--rate", "10"],
        "a run of 0.01 s has no tick at 10 Hz; the least duration is 0.05 s",
    );
}

/// The program ended without a word where it got no memory for its rows.
#[cfg(target_os = "linux")]
#[test]
fn rows_that_the_system_has_no_memory_for_are_refused() {
    let folder = Folder::new();
    let plot = folder.name("touch.svg");
    let shell = "ulimit -v 1000000; exec \"$@\"";
    let feel = ["feel", "scenes/s1.json", "--fast", "--duration", "3600", "--plot", &plot];
    let output = std::process::Command::new("sh")
        .args(["-c", shell, "sh", env!("CARGO_BIN_EXE_palpate")])
        .args(feel)
        .current_dir(root(""))
        .output()
        .unwrap();
    let said = errors(&output);
    let start = "palpate: --plot and --wav keep 3600000 rows of this run, ";
    let end = " GB of memory, which the system does not give; shorten --duration, lower --rate, \
               or use fewer contact points\n";
    assert!(said.starts_with(start) && said.ends_with(end), "{said}");
    assert_eq!(status(&output), 2);
}

#[test]
fn outputs_of_other_endings_are_refused() {
    let folder = Folder::new();
    for (option, name, said) in [
        ("--trace", "touch.txt", "the name of a trace must end in .csv"),
        ("--trace", "touch", "the name of a trace must end in .csv"),
        ("--wav", "touch.mp3", "the name of a vibration must end in .wav"),
        ("--plot", "touch.gif", "the name of a picture must end in .svg or .png"),
    ] {
        let path = folder.name(name);
        let said = format!("{path}: {said}");
        assert_refused(&["feel", "--fast", "--duration", "0.01", option, &path], &said);
    }
    let upper = folder.name("TOUCH.CSV");
    json(&["feel", "--fast", "--duration", "0.01", "--json", "--trace", &upper]);
}

#[test]
fn feel_names_the_files_that_it_wrote() {
    let folder = Folder::new();
    let [trace, wav, plot] = ["t.csv", "t.wav", "t.svg"].map(|name| folder.name(name));
    let files = ["--trace", &trace, "--wav", &wav, "--plot", &plot];
    let feel = ["feel", "scenes/cup.json", "--fast", "--duration", "0.1"];
    let output = palpate(&[&feel[..], &files].concat());
    assert_eq!(errors(&output), format!("wrote {trace} (100 rows), {wav}, {plot}\n"));
    assert_eq!(errors(&palpate(&feel)), "");
}

#[test]
fn the_scale_that_the_program_chose_is_told() {
    let folder = Folder::new();
    let scene = folder.write("ball.json", BALL);
    let feel = ["feel", &scene, "--fast", "--duration", "0.1"];
    let omega = [&feel[..], &["--device", "simulated:omega"]].concat();
    let scale = json(&[&omega[..], &["--json"]].concat())["workspace_scale"].as_f64().unwrap();
    // Half the diagonal of the ball's box over the radius of the workspace.
    let radius = palpate::device::profile_named("omega").unwrap().workspace_radius;
    assert!((scale - 0.75_f64.sqrt() / radius).abs() < 1e-12, "{scale}");
    let said = "  workspace      11.55 m of the scene for each metre of the device\n";
    assert!(text(&palpate(&omega)).contains(said), "{}", text(&palpate(&omega)));
    assert!(json(&[&feel[..], &["--json"]].concat())["workspace_scale"].is_null());
    let given =
        BALL.replace("\"bodies\"", r#""tool": { "workspace": { "scale": 9 } }, "bodies""#);
    let given = folder.write("given.json", &given);
    let omega = ["feel", &given, "--fast", "--duration", "0.1", "--device", "simulated:omega"];
    assert!(json(&[&omega[..], &["--json"]].concat())["workspace_scale"].is_null());
}

/// A path led the first point alone, and the others were not there.
#[test]
fn a_path_carries_the_points_of_a_tool_or_leads_each() {
    let folder = Folder::new();
    let tool = r#""tool": { "points": [[-0.1, 0, 0], [0, 0, 0], [0.1, 0.02, 0]] }"#;
    let fingers = BALL.replace("\"bodies\"", &format!("{tool}, \"bodies\""));
    let scene = folder.write("fingers.json", &fingers);
    let trace = folder.name("trace.csv");
    let hand = |points: usize| {
        let mut rows = "time_s,point,x_m,y_m,z_m\n".to_owned();
        for time in 0..2 {
            (0..points).for_each(|i| rows.push_str(&format!("{time},{i},0.{i},0.6,0\n")));
        }
        folder.write("hand.csv", &rows)
    };
    let first = |points: usize| -> Vec<String> {
        let run = ["feel", &scene, "--path", &hand(points), "--fast", "--json"];
        let report = json(&[&run[..], &["--trace", &trace]].concat());
        assert_eq!(report["points"], 3);
        let trace = std::fs::read_to_string(&trace).unwrap();
        let [x, y] = ["device_x_m", "device_y_m"].map(|name| column(&trace, name));
        x.into_iter().zip(y).take(3).map(|(x, y)| format!("{x} {y}")).collect()
    };
    assert_eq!(first(1), ["-0.1 0.6", "0 0.6", "0.1 0.62"]);
    assert_eq!(first(3), ["0 0.6", "0.1 0.6", "0.2 0.6"]);
    let two = hand(2);
    let said = format!(
        "{two}: there are 2 contact points, and the tool of the scene has 3; give one, which \
         carries the tool, or 3, one for each point"
    );
    assert_refused(&["feel", &scene, "--path", &two, "--fast"], &said);
}

/// A ruler and a well, and a plane that is out of reach.
const GUIDED: &str = r#"{ "palpate": 1, "dimension": 3,
  "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.05 } } } ],
  "guides": [ { "line": { "through": [0, 0.055, 0], "direction": [1, 0, 0] }, "snap_distance": 0.01 },
    { "well": { "center": [0.04, 0.06, 0], "reach": 0.02 }, "stiffness": 200, "max_force": 1 },
    { "plane": { "through": [0, 9, 0], "normal": [0, 1, 0] }, "snap_distance": 0.01 } ] }"#;

/// The times were those of another clock. The error spoke of too many ticks, or of none.
#[test]
fn a_hand_path_of_another_clock_is_refused_with_its_times() {
    let folder = Folder::new();
    let scene = folder.write("guided.json", GUIDED);
    for (times, said) in [
        ([-5.0, -4.0], "from -5 s to -4 s"),
        ([1.7e9, 1.7e9 + 1.0], "from 1700000000 s to 1700000001 s"),
    ] {
        let [first, last] = times;
        let rows = format!("time_s,x_m,y_m,z_m\n{first},0,0.057,0\n{last},0.05,0.057,0\n");
        let hand = folder.write("hand.csv", &rows);
        let said = format!(
            "{hand}: the hand moves {said}, and the run begins at 0 s: times count from the start of the run"
        );
        assert_refused(&["feel", &scene, "--path", &hand, "--fast"], &said);
    }
}

#[test]
fn guides_are_named_counted_and_drawn() {
    let folder = Folder::new();
    let scene = folder.write("guided.json", GUIDED);
    let rows = "time_s,x_m,y_m,z_m\n0,-0.05,0.057,0\n1,0.05,0.057,0\n";
    let (hand, plot) = (folder.write("hand.csv", rows), folder.name("guided.svg"));
    let feel = ["feel", &scene, "--path", &hand, "--fast"];
    let report = json(&[&feel[..], &["--plot", &plot, "--json"]].concat());
    let [line, well, plane] = &report["guides"].as_array().unwrap()[..] else {
        panic!("{report}")
    };
    assert_eq!(
        (&line["kind"], &well["kind"], &plane["kind"]),
        (&"line".into(), &"well".into(), &"plane".into())
    );
    assert_eq!((&line["time"], &plane["time"]), (&1.0.into(), &0.0.into()));
    // 2 mm off, at 300 N/m; nothing moves across it.
    assert!((line["largest_force"].as_f64().unwrap() - 0.6).abs() < 1e-9, "{line}");
    assert!(well["given"].as_f64().unwrap() > 1e-3, "{well}");
    let said = text(&palpate(&feel));
    assert!(
        said.contains(
            "  guide 0        a line, held the hand for 1.000 s with at most 0.600 N; "
        ),
        "{said}"
    );
    assert!(said.contains("  guide 2        a plane, did not hold the hand\n"), "{said}");
    assert!(said.contains("  energy         contacts took "), "{said}");
    let svg = std::fs::read_to_string(&plot).unwrap();
    assert!(words(&svg).contains(&"guides"), "{:?}", words(&svg));
    let cup = ["feel", "scenes/cup.json", "--fast", "--duration", "0.1"];
    assert!(text(&palpate(&cup)).contains(" mJ were kept back\n"));
    assert_eq!(json(&[&cup[..], &["--json"]].concat())["guides"], serde_json::json!([]));
}

/// The report named what was asked for as if it were rendered.
#[test]
fn the_stiffness_that_a_device_renders_is_told_beside_the_one_asked_for() {
    let folder = Folder::new();
    let (scene, plot) = (folder.write("ball.json", BALL), folder.name("soft.svg"));
    let feel = ["feel", &scene, "--fast", "--duration", "1", "--plot", &plot];
    let soft = palpate(&[&feel[..], &["--device", "simulated:omega"]].concat());
    let said = text(&soft);
    assert!(said.contains("\n  stiffness 433 (asked 500) N/m, damping "), "{said}");
    let svg = std::fs::read_to_string(&plot).unwrap();
    let has = |svg: &str, word: &str| words(svg).iter().any(|found| found.contains(word));
    assert!(has(&svg, "433 N/m, asked 500 N/m"), "{:?}", words(&svg));
    let why = "                 1 of 1 body softer than asked, 0.866 of the stiffness: K ≤ the \
               device's largest stiffness at this rate\n";
    assert!(said.contains(why) && said.contains("\n  at the hand    stiffness "), "{said}");
    // At ten times the rate the device renders all.
    let fast = [&feel[..], &["--device", "simulated:omega", "--rate", "10000"]].concat();
    let said_fast = text(&palpate(&fast));
    assert!(said_fast.contains("\n  stiffness 500 N/m, damping "), "{said_fast}");
    // Half of what it renders.
    let half = ["--device", "simulated:omega", "--relative-stiffness", "0.5"];
    let said_half = text(&palpate(&[&feel[..], &half].concat()));
    assert!(
        said_half.contains(
            "\n  stiffness 216.5 (asked 0.5 of what the device renders) N/m, damping "
        ),
        "{said_half}"
    );
    // As it is too, which once meant the material's own stiffness.
    let as_is = ["--acceptance", "as-is"];
    let said_as_is = text(&palpate(&[&feel[..], &half, &as_is].concat()));
    assert!(
        said_as_is.contains(
            "\n  stiffness 216.5 (asked 0.5 of what the device renders) N/m, damping 1 "
        ),
        "{said_as_is}"
    );
    // All of it is no more than that: rounding took it above.
    let all = ["--relative-stiffness", "1", "--damping", "0", "--strict", "--device"];
    assert_eq!(status(&palpate(&[&feel[..], &all, &["simulated:omega"]].concat())), 0);
    let said = text(&palpate(&feel));
    assert!(said.contains("\n  stiffness 500 N/m, damping 1 N·s/m, "), "{said}");
    let svg = std::fs::read_to_string(&plot).unwrap();
    assert!(has(&svg, "500 N/m") && !has(&svg, "asked"), "{:?}", words(&svg));
}

/// A path through irregular samples left them by several times their range.
#[test]
fn a_path_stays_between_the_rows_of_its_file() {
    let folder = Folder::new();
    let scene = folder.write("ball.json", BALL);
    let rows = "time_s,x_m,y_m,z_m\n0,0,0.62,0\n1,0,0.61,0\n1.002,0,0.63,0\n1.9,0,0.63,0\n\
                1.91,0,0.6,0\n3,0,0.61,0\n";
    let (hand, trace) = (folder.write("hand.csv", rows), folder.name("trace.csv"));
    let feel = ["feel", &scene, "--path", &hand, "--fast", "--trace", &trace];
    assert_eq!(status(&palpate(&feel)), 0);
    let trace = std::fs::read_to_string(&trace).unwrap();
    let heights = column(&trace, "device_y_m");
    let heights: Vec<f64> = heights.iter().map(|height| height.parse().unwrap()).collect();
    assert_eq!(heights.len(), 3000);
    let within = |times: std::ops::Range<usize>, least: f64, most: f64| {
        let outside = heights[times].iter().find(|y| !(least..=most).contains(*y));
        assert_eq!(outside, None, "{least} to {most}");
    };
    within(0..1000, 0.61, 0.62);
    within(1002..1900, 0.63, 0.63);
    within(1910..3000, 0.6, 0.61);
}

/// The report of a texture whose waves no probe follows did not say so.
#[test]
fn a_texture_that_is_too_narrow_for_the_probe_is_told() {
    let folder = Folder::new();
    let scene = |amplitude: f64| {
        format!(
            r#"{{ "palpate": 1, "dimension": 2, "bodies": [ {{ "name": "plate",
                "shape": {{ "rectangle": {{ "size": [0.4, 0.1] }} }},
                "material": {{ "stiffness": 500, "texture": {{ "kind": "displacement",
                "amplitude": {amplitude}, "wavelength": 0.01, "direction": [1, 0] }} }} }} ] }}"#
        )
    };
    let hand = folder.write("hand.csv", "time_s,x_m,y_m\n0,0,0.06\n0.5,0,0.051\n");
    let said = |amplitude: f64| {
        let scene = folder.write("plate.json", &scene(amplitude));
        text(&palpate(&["feel", &scene, "--path", &hand, "--fast"]))
    };
    // A radius of 10⁻⁴ m² / (4 π² · 2 mm) = 1.267 mm.
    let narrow = said(0.002);
    let line = "  texture        the valleys of body \"plate\" have a radius of 1.267 mm, less than \
                probe and depth together, ";
    assert!(narrow.contains(line), "{narrow}");
    assert!(!said(0.0001).contains("  texture  "));
}

/// The report and the errors said what was asked for, and not of what.
#[test]
fn what_a_device_makes_of_bodies_is_told() {
    let folder = Folder::new();
    let scene = folder.write("ball.json", BALL);
    let feel = |rest: &[&str]| {
        palpate(&[&["feel", &scene, "--fast", "--duration", "0.1"], rest].concat())
    };
    let omega = ["--device", "simulated:omega"];
    let strict = errors(&feel(&[&omega[..], &["--stiffness", "9000", "--strict"]].concat()));
    assert!(strict.starts_with("palpate: body \"ball\": the device renders "), "{strict}");
    let as_is = ["--acceptance", "as_is", "--stiffness", "6000"];
    let said = text(&feel(&[&omega[..], &as_is].concat()));
    let beyond =
        " N/m is rendered as asked (as-is); the device renders at most 5000 N/m stably\n";
    assert!(said.contains(beyond), "{said}");
    assert!(!text(&feel(&omega)).contains("taken as it is"));
    let file = errors(&feel(&["--device", "arm.json"]));
    let hint = "a device with the profile of a file is written simulated:arm.json";
    assert!(file.contains(hint), "{file}");
    let wrong = errors(&feel(&["--relative-stiffness", "2"]));
    assert!(wrong.contains("must be from 0.000001 to 1, got 2"), "{wrong}");
    // A tool that says nothing of points and shape keeps the probe.
    let with = |key: &str| {
        let end = BALL.trim_end().strip_suffix('}').unwrap();
        folder.write("with.json", &format!("{end}, {key} }}"))
    };
    let tool = with(r#""tool": { "acceptance": "passive" }"#);
    assert!(text(&palpate(&["feel", &tool, "--fast"])).contains("probe of 2 mm"));
    // A path beyond the workspace, which is fitted around the scene.
    let hand = folder.write("far.csv", "time_s,x_m,y_m,z_m\n0,0,0.6,0\n0.1,0,9,0\n");
    let far = feel(&[&omega[..], &["--path", &hand]].concat());
    let told = "the path leaves the workspace of the Force Dimension omega by up to ";
    assert!(errors(&far).contains(told), "{}", errors(&far));
    assert!(!errors(&feel(&omega)).contains(told));
    let guided = with(r#""guides": [{ "point": [0, 0, 0] }]"#);
    let glove = ["feel", &guided, "--fast", "--duration", "0.1", "--device", "glove"];
    let said = text(&palpate(&glove));
    let without = "  guides         1 guide without effect, as the device gives no force\n";
    assert!(said.contains(without) && !said.contains("guide 0"), "{said}");
}
