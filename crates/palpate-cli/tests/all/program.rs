// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The program as its users run it.

use crate::common::{Folder, errors, json, palpate, root, status, text};
use crate::pictures::words;
use serde_json::Value;

const BALL: &str = r#"{ "palpate": 1, "dimension": 3,
  "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.5 } } } ] }"#;

#[test]
fn eval_answers_at_one_point() {
    let folder = Folder::new();
    let scene = folder.write("ball.json", BALL);
    let answer = json(&["eval", &scene, "--at", "0,2,0", "--json"]);
    assert_eq!(answer["distance"], 1.5);
    assert_eq!(answer["gradient"], serde_json::json!([0.0, 1.0, 0.0]));
    assert_eq!(answer["surface"], serde_json::json!([0.0, 0.5, 0.0]));
    assert_eq!(answer["is_inside"], false);
    assert_eq!(answer["promise"], "exact outside, exact inside");
    let radius = answer["safe_radius"].as_f64().unwrap();
    assert!((1.5 - 1e-14..=1.5).contains(&radius));
}

#[test]
fn eval_refuses_what_is_no_point() {
    for at in ["1,2", "1,2,x", "1,2,nan", "1e300,0,0", "", "1,2,3,4"] {
        let output = palpate(&["eval", "scenes/s1.json", "--at", at]);
        assert_eq!(status(&output), 2, "{at}");
        assert!(!errors(&output).is_empty());
    }
}

/// A file that is not there was once named twice in a line.
#[test]
fn a_scene_that_is_not_there_is_named_once() {
    for command in ["check", "contact", "plot", "feel"] {
        let output = palpate(&[command, "no/such/scene.json"]);
        assert_eq!(status(&output), 2, "{command}");
        assert_eq!(errors(&output).matches("no/such/scene.json").count(), 1, "{command}");
    }
}

/// The file was read until the memory was full.
#[cfg(target_os = "linux")]
#[test]
fn a_scene_without_an_end_is_refused() {
    let output = palpate(&["check", "/dev/zero"]);
    let expected = "palpate: /dev/zero: is longer than 268435456 bytes, the most that are read; \
                    --largest-file raises that\n";
    assert_eq!(
        (status(&output), String::from_utf8_lossy(&output.stderr).as_ref()),
        (2, expected)
    );
}

/// Many points give the bytes of one point each, for any number of threads.
#[test]
fn eval_streams_the_same_bytes_for_any_number_of_threads() {
    let folder = Folder::new();
    let mut points = "x_m,y_m,z_m\n".to_owned();
    for i in 0..70_000 {
        let t = f64::from(i);
        let [x, y, z] = [t * 0.618, t * 0.414, t * 0.732].map(|x| 2.0 * x.fract() - 1.0);
        points.push_str(&format!("{x},{y},{z}\n"));
    }
    let points = folder.write("points.csv", &points);
    let eval = |threads: &str| {
        let arguments = ["eval", "scenes/s3.json", "--points", &points, "--threads", threads];
        let output = palpate(&arguments);
        assert_eq!(status(&output), 0, "{}", errors(&output));
        text(&output)
    };
    let one = eval("1");
    assert_eq!(one, eval("3"));
    let lines: Vec<_> = one.lines().collect();
    assert_eq!(lines.len(), 70_001);
    assert_eq!(
        lines[0],
        "x_m,y_m,z_m,distance_m,gradient_x,gradient_y,gradient_z,\
         surface_x_m,surface_y_m,surface_z_m,inside,safe_radius_m"
    );
    let row: Vec<_> = lines[66_000].split(',').collect();
    let at = row[..3].join(",");
    let single = json(&["eval", "scenes/s3.json", "--at", &at, "--json"]);
    assert_eq!(row[3].parse::<f64>().unwrap(), single["distance"].as_f64().unwrap());
}

#[test]
fn check_answers_yes_or_no() {
    let output = palpate(&["check", "scenes/cup.json"]);
    assert_eq!(status(&output), 0);
    let folder = Folder::new();
    let bad = folder.write("bad.json", &BALL.replace("0.5", "-0.5"));
    let output = palpate(&["check", &bad]);
    assert_eq!(status(&output), 1);
    let message = "bodies[0].shape.ball.radius, line 2: radius must be positive, got -0.5 m";
    assert!(text(&output).contains(message), "{}", text(&output));
    let answer: Value =
        serde_json::from_slice(&palpate(&["check", &bad, "--json"]).stdout).unwrap();
    assert_eq!(answer["ok"], false);
    assert_eq!(answer["problems"][0]["line"], 2);
    assert_eq!(status(&palpate(&["check", "no/such/file.json"])), 2);
    assert_eq!(status(&palpate(&["plot", &bad])), 2);
}

#[test]
fn mass_is_that_of_a_ball() {
    let folder = Folder::new();
    let ball = folder.write("ball.json", BALL);
    let answer = json(&["mass", &ball, "--density", "2000", "--tolerance", "0.01", "--json"]);
    let body = &answer["bodies"][0];
    let [volume, error, mass] =
        ["volume", "volume_error", "mass"].map(|key| body[key].as_f64().unwrap());
    let expected = std::f64::consts::PI / 6.0;
    assert!((volume - expected).abs() <= error && error <= 0.01 * expected, "{body}");
    assert_eq!(mass, 2000.0 * volume);
    // What cannot be reached is said, and the answer is no.
    let output = palpate(&["mass", &ball, "--tolerance", "1e-9", "--cells", "1000"]);
    assert_eq!(status(&output), 1);
    assert!(text(&output).contains("±"), "{}", text(&output));
    assert_eq!(status(&palpate(&["mass", &ball, "--density", "-1"])), 2);
}

#[test]
fn a_mesh_is_good_if_it_is_watertight() {
    let nut = json(&["mesh", "testdata/meshes/nut.ply", "--scale", "0.001", "--json"]);
    assert_eq!((&nut["ok"], &nut["elements"]), (&Value::Bool(true), &Value::from(1046)));
    let volume = nut["enclosed"].as_f64().unwrap();
    assert!((volume - 3.217_132_223_698_598e-5).abs() < 1e-15, "{volume}");
    let airplane = palpate(&["mesh", "testdata/meshes/airplane.ply"]);
    assert_eq!(status(&airplane), 1);
    assert!(text(&airplane).contains("223      edges of one triangle only"));
    let folder = Folder::new();
    // Two halves of a square with vertices of their own.
    let halves = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nv 0 0 0\nv 1 1 0\nv 0 1 0\nf 4 5 6\n";
    let file = folder.write("halves.obj", halves);
    assert!(text(&palpate(&["mesh", &file])).contains("--weld joins them"));
    let welded = palpate(&["mesh", &file, "--weld", "--json"]);
    let welded: Value = serde_json::from_slice(&welded.stdout).unwrap();
    assert_eq!((&welded["vertices"], &welded["boundary"]), (&4.into(), &4.into()));
    let broken = folder.write("broken.stl", "solid x\nfacet");
    let output = palpate(&["mesh", &broken]);
    assert_eq!(status(&output), 2);
    assert!(errors(&output).contains(&broken), "{}", errors(&output));
}

#[test]
fn the_schema_is_the_committed_one() {
    let committed = include_str!("../../../palpate-scene/schema/scene.schema.json");
    assert_eq!(text(&palpate(&["schema"])), committed);
}

#[test]
fn shapes_lists_the_catalogue_with_units_and_origins() {
    let all = json(&["shapes", "--json"]);
    let all = all["primitives"].as_array().unwrap();
    let spatial = palpate::field::catalogue::Entry::<3>::ALL.len();
    let in_plane = palpate::field::catalogue::Entry::<2>::ALL.len();
    assert_eq!(all.len(), in_plane + spatial);
    let arc = all.iter().find(|shape| shape["name"] == "arc").unwrap();
    assert_eq!(arc["parameters"][1]["key"], "angle_degrees");
    assert_eq!(arc["parameters"][1]["unit"], "degrees");
    assert_eq!(arc["origin"], "at the centre of its circle; open downwards");
    let planar = text(&palpate(&["shapes", "--dimension", "2"]));
    let count = format!("{in_plane} primitives");
    assert!(planar.contains(&count) && !planar.contains("(3D)"));
}

#[test]
fn plot_writes_svg_and_png() {
    let folder = Folder::new();
    for (scene, plane) in [
        ("scenes/memoir_star.json", "xy"),
        ("scenes/s2.json", "xz"),
        ("scenes/s2.json", "0,0,0:1,0,0:0,1,1"),
    ] {
        let svg = folder.name("picture.svg");
        let output = palpate(&["plot", scene, "--plane", plane, "--output", &svg]);
        assert_eq!(status(&output), 0, "{}", errors(&output));
        assert!(std::fs::read_to_string(&svg).unwrap().starts_with("<svg"));
    }
    let png = folder.name("picture.png");
    let answer =
        json(&["plot", "scenes/s1.json", "--output", &png, "--width", "400", "--json"]);
    assert!(answer["step"].as_f64().unwrap() > 0.0);
    assert_eq!(&std::fs::read(&png).unwrap()[1..4], b"PNG");
    assert_eq!(status(&palpate(&["plot", "scenes/s1.json", "--output", "picture.gif"])), 2);
}

#[test]
fn plot_shows_a_part_of_a_scene() {
    let folder = Folder::new();
    let svg = folder.name("part.svg");
    // A ball of 0.7 m about the origin, seen where x is from 1.6 m to 1.8 m.
    let around = ["plot", "scenes/s1.json", "--output", &svg, "--json", "--size", "0.2"];
    let answer = json(&[&around[..], &["--centre", "1.7,0,0"]].concat());
    // To within a cell of the samples.
    assert!((answer["smallest"].as_f64().unwrap() - 0.9).abs() < 1e-3, "{answer}");
    assert!((answer["largest"].as_f64().unwrap() - 1.103).abs() < 1e-3, "{answer}");
    for (size, centre) in [("0.2", "1.7,0"), ("-1", "0,0,0"), ("nan", "0,0,0")] {
        let output = palpate(&[
            "plot",
            "scenes/s1.json",
            "--output",
            &svg,
            "--size",
            size,
            "--centre",
            centre,
        ]);
        assert_eq!(status(&output), 2, "{size} {centre}");
    }
    assert_eq!(status(&palpate(&["plot", "scenes/s1.json", "--size", "0.2"])), 2);
}

#[test]
fn plot_draws_gradients() {
    let folder = Folder::new();
    for (scene, plane) in [("scenes/memoir_star.json", "xy"), ("scenes/cup.json", "xz")] {
        let svg = folder.name("gradient.svg");
        let answer = json(&[
            "plot", scene, "--map", "gradient", "--plane", plane, "--output", &svg, "--json",
        ]);
        assert_eq!(answer["map"], "gradient");
        assert!(answer["smallest"].as_f64().unwrap() < 0.0 && answer["step"].is_null());
        let svg = std::fs::read_to_string(&svg).unwrap();
        let words = words(&svg);
        assert!(words.iter().any(|word| word.starts_with("direction in which")), "{words:?}");
        assert!(words.contains(&if plane == "xz" { "z" } else { "y" }), "{words:?}");
    }
}

/// Two discs that overlap: the union is exact outside and a bound inside, loosest between the
/// two points where they cross.
#[test]
fn plot_shows_where_a_union_is_loose() {
    let folder = Folder::new();
    let scene = folder.write(
        "union.json",
        r#"{ "palpate": 1, "dimension": 2, "bodies": [ { "name": "union", "shape": { "union": [
            { "ball": { "radius": 0.3 } },
            { "translate": [0.4, 0], "of": { "ball": { "radius": 0.3 } } } ] } } ] }"#,
    );
    let svg = folder.name("promise.svg");
    let answer = json(&["plot", &scene, "--map", "promise", "--output", &svg, "--json"]);
    let measured = &answer["value_over_distance"];
    let number = |value: &Value| value.as_f64().unwrap();
    // At (0.2, 0) the value is 0.1 and the distance that to the crossings, √(0.3² − 0.2²).
    let expected = 0.1 / (0.09_f64 - 0.04).sqrt();
    let smallest = number(&measured["smallest"]);
    assert!(smallest >= expected && smallest < 1.03 * expected, "{smallest}");
    assert!((number(&measured["smallest_at"][0]) - 0.2).abs() < 0.01, "{measured}");
    assert!(number(&measured["smallest_at"][1]).abs() < 0.01, "{measured}");
    assert_eq!(number(&measured["largest"]), 1.0);
    let svg = std::fs::read_to_string(&svg).unwrap();
    let words = words(&svg);
    for expected in [
        "outside exact: the value is the distance",
        "inside bound: true distance may be larger",
        "value over true distance: 1 where it is exact",
    ] {
        assert!(words.contains(&expected), "{expected} in {words:?}");
    }
}

/// The nearest surface may lie outside the slice: the wall behind it is searched for too.
#[test]
fn plot_compares_values_on_a_slice_with_distances_in_space() {
    let folder = Folder::new();
    // Half the distance to a wall 0.1 m behind the slice, and a ball far to the right.
    let scene = folder.write(
        "wall.json",
        r#"{ "palpate": 1, "dimension": 3, "bodies": [
            { "name": "wall", "shape": { "translate": [0, 0, -0.2], "of":
                { "scale": [1, 1, 2], "of": { "cuboid": { "size": [2, 2, 0.1] } } } } } ] }"#,
    );
    let svg = folder.name("promise.svg");
    let view = ["--plane", "xy", "--centre", "0,0,0", "--size", "0.2", "--map", "promise"];
    let answer = json(&[&["plot", &scene, "--output", &svg, "--json"][..], &view].concat());
    let measured = &answer["value_over_distance"];
    // The box is stretched about its middle: 0.1 m from it, the value is half the distance.
    for key in ["smallest", "largest"] {
        assert!((measured[key].as_f64().unwrap() - 0.5).abs() < 0.006, "{measured}");
        assert_eq!(measured[format!("{key}_at")].as_array().unwrap().len(), 3);
    }
    assert_eq!(measured["open"], 0.0);
    let svg = std::fs::read_to_string(&svg).unwrap();
    let words = words(&svg);
    assert!(words.contains(&"outside bound: true distance may be larger"), "{words:?}");
    assert!(words.contains(&"no surface in view"), "{words:?}");
}

#[test]
fn plot_without_an_answer_leaves_no_picture() {
    let folder = Folder::new();
    let (scene, picture) = (root("scenes/memoir_star.json"), folder.name("star.svg"));
    let interrupt = palpate_cli::Interrupt::new();
    interrupt.asked().store(true, std::sync::atomic::Ordering::Relaxed);
    let plot = ["palpate", "plot", &scene, "--map", "promise", "--output", &picture];
    assert_eq!(palpate_cli::run_until(plot, &interrupt), 130);
    assert!(!folder.path("star.svg").exists());
}

#[test]
#[ignore = "slow: cargo xtask test --thorough"]
fn the_gallery_shows_every_primitive_on_every_plane() {
    let folder = Folder::new();
    for (map, plane) in [("distance", "yz"), ("gradient", "xy"), ("promise", "xz")] {
        let answer = json(&[
            "gallery",
            "--output",
            &folder.name(map),
            "--map",
            map,
            "--plane",
            plane,
            "--format",
            "svg",
            "--json",
        ]);
        assert_eq!(answer["map"], map);
        let pictures = answer["pictures"].as_array().unwrap();
        let stems = ["shapes-of-the-plane", "shapes-of-space-", "operators-"];
        assert_eq!(pictures.len(), stems.len());
        for (picture, stem) in pictures.iter().zip(stems) {
            let file = picture["output"].as_str().unwrap();
            let end = if stem.ends_with('-') { plane } else { "" };
            assert!(file.ends_with(&format!("{stem}{end}.svg")), "{file}");
            let svg = std::fs::read_to_string(file).unwrap();
            let words = words(&svg);
            for shape in picture["shapes"].as_array().unwrap() {
                assert!(words.contains(&shape.as_str().unwrap()), "{shape} in {words:?}");
            }
        }
        let [planar, spatial] = [0, 1].map(|i| pictures[i]["shapes"].as_array().unwrap().len());
        assert_eq!(planar, palpate::field::catalogue::Entry::<2>::ALL.len());
        assert_eq!(spatial, palpate::field::catalogue::Entry::<3>::ALL.len());
    }
}

#[test]
fn the_gallery_draws_each_shape_and_refuses_bad_input() {
    let folder = Folder::new();
    let output = folder.name("pictures");
    let arguments =
        ["gallery", "--output", &output, "--plane", "xy", "--each", "--width", "200", "--json"];
    let answer = json(&arguments);
    let pictures = answer["pictures"].as_array().unwrap();
    let count = palpate::field::catalogue::Entry::<2>::ALL.len()
        + palpate::field::catalogue::Entry::<3>::ALL.len();
    assert!(pictures.len() > count + 3);
    for picture in pictures {
        let bytes = std::fs::read(picture["output"].as_str().unwrap()).unwrap();
        assert_eq!(&bytes[1..4], b"PNG");
    }
    assert!(folder.path("pictures/shapes-of-space-xy/torus.png").exists());
    let file = folder.write("file", "");
    for arguments in [
        &["--output", &file][..],
        &["--plane", "ab"],
        &["--map", "colour"],
        &["--format", "gif"],
        &["--output", &output, "--width", "3"],
    ] {
        let output = palpate(&[&["gallery"], arguments].concat());
        assert_eq!(status(&output), 2, "{arguments:?}");
        assert!(!errors(&output).is_empty());
    }
}

#[test]
fn plot_refuses_maps_that_are_none() {
    for arguments in [&["--map", "colour"][..], &["--map", "gradient", "--step", "0.1"]] {
        let output = palpate(&[&["plot", "scenes/s1.json"], arguments].concat());
        assert_eq!(status(&output), 2);
        assert!(errors(&output).contains(arguments[0]) || errors(&output).contains("--step"));
    }
}

/// Between two tips a descent stops; the other tip is lower, which the bounds prove.
#[test]
fn descend_says_what_was_missed() {
    let folder = Folder::new();
    let plot = folder.name("descent.svg");
    let star = ["descend", "scenes/memoir_star.json", "--json", "--plot", &plot];
    let corners = ["--triangle", "1.35,1.1", "1.8,0.45", "1.0,0.99"];
    let answer = json(&[&star[..], &corners].concat());
    let number = |value: &Value| value.as_f64().unwrap();
    let [lower, upper] = ["lower", "upper"].map(|key| number(&answer["certified"][key]));
    assert!(lower <= upper && upper - lower < 1e-3, "{answer}");
    assert!(number(&answer["value"]) > upper + 0.04, "{answer}");
    assert_eq!(number(&answer["missed_by"]), number(&answer["value"]) - upper);
    assert_eq!(answer["path"][0], serde_json::json!([1.0, 0.99]));
    let svg = std::fs::read_to_string(&plot).unwrap();
    let words = words(&svg);
    for word in ["projected_gradient", "triangle", "start", "best found", "proven minimum"] {
        assert!(words.contains(&word), "{word} in {words:?}");
    }
    // In space, a segment: any plane through it.
    let plot = folder.name("segment.png");
    let segment = ["descend", "scenes/s3.json", "--segment", "-1,0,0", "1,0.2,0.1"];
    let method = ["--method", "golden_section", "--plot", &plot];
    let output = palpate(&[&segment[..], &method].concat());
    assert_eq!(status(&output), 0, "{}", errors(&output));
    assert!(text(&output).contains("missed by"), "{}", text(&output));
    assert_eq!(&std::fs::read(&plot).unwrap()[1..4], b"PNG");
    for wrong in [
        &["--method", "newton"][..],
        &["--tolerance", "nan"],
        &["--triangle", "0,0,0", "1,0,0", "0,1,0"],
    ] {
        let output = palpate(&[&segment[..], wrong].concat());
        assert_eq!(status(&output), 2, "{wrong:?}");
        assert!(!errors(&output).is_empty());
    }
}

/// Two bodies that overlap on one side alone: the start decides what is found.
#[test]
fn descend_between_bodies_finds_what_is_near_its_start() {
    let bodies = ["descend", "scenes/memoir_two_bodies.json", "--json"];
    let starts = ["--start", "-0.2,0.5", "--start", "0.15,0.4"];
    for method in ["alternating_projection", "minimax_proximal"] {
        let answer = json(&[&bodies[..], &starts, &["--method", method]].concat());
        let value = |i: usize| answer["descents"][i]["value"].as_f64().unwrap();
        assert!(value(0) > 0.009 && value(1) <= 0.0, "{answer}");
        let lower = answer["certified"]["lower"].as_f64().unwrap();
        assert!((lower + 0.05).abs() < 1e-3 && lower <= 2.0 * value(1), "{answer}");
    }
    let one = palpate(&["descend", "scenes/s1.json", "--start", "1,1,1"]);
    assert_eq!(status(&one), 2);
    assert!(errors(&one).contains("two bodies or more, this has 1"));
}
