// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate eval --radius`: the memoir's circle.

use serde_json::Value;

use crate::common::{Folder, assert_refused, disc, errors, number, palpate, status, text};

/// The answer of `eval --json`, whose status is 0 if the ball meets the scene.
fn ask(scene: &str, at: &str, radius: &str) -> (i32, Value) {
    let output = palpate(&["eval", scene, "--at", at, "--radius", radius, "--json"]);
    (status(&output), serde_json::from_slice(&output.stdout).unwrap())
}

/// A disc of ½ m, 2 m below the centre of the ball: the gap is 1.5 m less the radius.
#[test]
fn a_ball_meets_a_disc_if_it_reaches_it() {
    let folder = Folder::new();
    let scene = folder.write("disc.json", &disc(0.5));
    for (radius, meets, gap) in
        [("1", false, 0.5), ("1.75", true, -0.25), ("0", false, 1.5), ("100", true, -98.5)]
    {
        let (status, answer) = ask(&scene, "0,2", radius);
        let ball = &answer["ball"];
        assert_eq!((status, &ball["touches"]), (i32::from(!meets), &meets.into()), "{ball}");
        assert_eq!(ball["memoir_test"], meets);
        assert_eq!(
            (&ball["memoir_test_is_right"], &ball["quality"]),
            (&true.into(), &"exact".into())
        );
        assert!(number(&ball["lower"]) <= gap && gap <= number(&ball["upper"]));
        assert!((number(&ball["upper"]) - gap).abs() < 1e-12);
        assert_eq!(ball["contact"]["point_a"], serde_json::json!([0.0, 0.5]));
        assert_eq!(
            ball["contact"]["point_b"],
            serde_json::json!([0.0, 2.0 - number(&ball["radius"])])
        );
        assert_eq!(answer["distance"], 1.5);
    }
    // Where they only touch, rounding decides nothing.
    let (status, answer) = ask(&scene, "0,2", "1.5");
    assert_eq!((status, &answer["ball"]["touches"]), (1, &Value::Null));
    assert_eq!(answer["ball"]["memoir_test_is_right"], Value::Null);
}

/// The shape without the rectangle is a bound outside: at (0.3, −0.24) its value is 0.0345 m and
/// the nearest point, a corner, is 0.1 m away.
#[test]
fn the_memoirs_test_is_wrong_where_a_bound_is_too_small() {
    let arguments =
        ["eval", "scenes/memoir_shapes.json", "--at", "0.3,-0.24", "--radius", "0.05"];
    let output = palpate(&arguments);
    assert_eq!(status(&output), 1, "{}", errors(&output));
    let said = text(&output);
    for line in [
        "ball           of 0.05 m: meets the scene: no\n",
        "f(C) < r       yes: the memoir's test is wrong; the field is a bound outside, so it proves nothing\n",
    ] {
        assert!(said.contains(line), "{line} in {said}");
    }
    let (_, answer) = ask("scenes/memoir_shapes.json", "0.3,-0.24", "0.05");
    let ball = &answer["ball"];
    assert_eq!(
        (&ball["memoir_test"], &ball["memoir_test_is_right"]),
        (&true.into(), &false.into())
    );
    assert!((number(&ball["lower"]) - 0.05).abs() < 2e-4, "{ball}");
    // Above the radius, the value proves that the ball is apart; inside, that it meets the scene.
    for (at, radius, line) in [
        (
            "0.3,-0.24",
            "0.03",
            "no: the memoir's test is right; the field is a bound outside, so it proves this",
        ),
        ("0.2,-0.1", "0.01", "yes: the memoir's test is right; the centre is inside"),
    ] {
        let output = palpate(&["eval", arguments[1], "--at", at, "--radius", radius]);
        assert!(text(&output).contains(line), "{}", text(&output));
    }
}

/// A row for each point, with the bytes of the answer to one point, for any number of threads.
#[test]
fn many_balls_are_rows() {
    let folder = Folder::new();
    let mut points = "x_m,y_m\n".to_owned();
    for i in 0..1500 {
        points.push_str(&format!(
            "{},{}\n",
            0.001 * f64::from(i) - 0.75,
            0.3 - 0.0004 * f64::from(i)
        ));
    }
    let points = folder.write("points.csv", &points);
    let scene = "scenes/memoir_shapes.json";
    let eval = |more: &[&str]| {
        let output = palpate(
            &[&["eval", scene, "--points", &points, "--radius", "0.05"], more].concat(),
        );
        assert_eq!(status(&output), 0, "{}", errors(&output));
        text(&output)
    };
    let rows = eval(&["--threads", "1"]);
    assert_eq!(rows, eval(&["--threads", "2"]));
    let rows: Vec<_> = rows.lines().collect();
    assert_eq!(rows.len(), 1501);
    assert!(rows[0].ends_with(
        "safe_radius_m,radius_m,meets,gap_lower_m,gap_upper_m,nearest_x_m,nearest_y_m,\
         ball_x_m,ball_y_m,memoir_test,memoir_test_is_right"
    ));
    let json = eval(&["--json"]);
    for (row, object) in rows[1..].iter().zip(json.lines()).step_by(97) {
        let columns: Vec<_> = row.split(',').collect();
        assert_eq!(columns.len(), 19, "{row}");
        let object: Value = serde_json::from_str(object).unwrap();
        let (_, alone) = ask(scene, &columns[..2].join(","), "0.05");
        assert_eq!(object["ball"], alone["ball"]);
        assert_eq!(columns[11].parse::<f64>().unwrap(), number(&object["ball"]["lower"]));
        let meets = match &object["ball"]["touches"] {
            Value::Bool(true) => "yes",
            Value::Bool(false) => "no",
            _ => "undecided",
        };
        assert_eq!(columns[10], meets);
    }
}

#[test]
fn a_radius_is_a_length() {
    for (radius, got) in [("-1", "-1.0"), ("nan", "NaN"), ("1e16", "1e16"), ("inf", "inf")] {
        let said = format!("the radius must be from 0 m to 1e15 m, got {got} m");
        assert_refused(&["eval", "scenes/s1.json", "--at", "1,0,0", "--radius", radius], &said);
    }
}

/// A quadrant has no bounds, and is a bound outside: its corner is √2 m away, its value 1 m.
#[test]
fn a_scene_without_bounds_is_asked_about_too() {
    let folder = Folder::new();
    let scene = folder.write(
        "quadrant.json",
        r#"{ "palpate": 1, "dimension": 2, "bodies": [ { "name": "quadrant", "shape":
          { "intersection": [ { "half_space": { "normal": [0, 1], "offset": 0 } },
                              { "half_space": { "normal": [1, 0], "offset": 0 } } ] } } ] }"#,
    );
    for (radius, meets) in [("0", false), ("1.2", false), ("1.5", true)] {
        let (_, answer) = ask(&scene, "1,1", radius);
        let ball = &answer["ball"];
        assert_eq!(ball["touches"], meets, "{ball}");
        let gap = 2.0_f64.sqrt() - number(&ball["radius"]);
        let [lower, upper] = ["lower", "upper"].map(|key| number(&ball[key]));
        assert!(lower <= gap && gap <= upper && upper - lower < 1e-3, "{ball}");
        assert!(number(&ball["evaluations"]) < 1000.0, "{ball}");
    }
}
