// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! CSV files of points and of hand paths, and what the program says of bad ones.

use std::fmt::Write;

use crate::common::{Folder, errors, status, text};

const BALL: &str = r#"{ "palpate": 1, "dimension": 3,
  "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.5 } } } ] }"#;

/// What `eval` says of a file of points that it cannot use; no row is answered.
fn refused(content: &[u8]) -> String {
    let folder = Folder::new();
    folder.write("ball.json", BALL);
    std::fs::write(folder.path("points.csv"), content).unwrap();
    let output = folder.run(&["eval", "ball.json", "--points", "points.csv"]);
    assert_eq!(status(&output), 2);
    assert!(text(&output).lines().count() <= 1, "{}", text(&output));
    errors(&output)
}

/// What `feel` says of a hand path that it cannot use.
fn refused_path(content: &str) -> String {
    let folder = Folder::new();
    folder.write("ball.json", BALL);
    folder.write("hand.csv", content);
    let output = folder.run(&["feel", "ball.json", "--fast", "--path", "hand.csv"]);
    assert_eq!((status(&output), text(&output)), (2, String::new()));
    errors(&output)
}

#[test]
fn every_bad_value_is_told_with_its_line_and_column() {
    let rule = "must be a finite number of at most 1e15 in size, got";
    assert_eq!(
        refused(b"x_m,y_m,z_m\n0,0,0\n0,oops,nan\n1,2\n1,2,3,4\n\"0,5\",,1e16\n"),
        format!(
            "palpate: points.csv: 7 problems:\n  \
             line 3, column y_m: {rule} \"oops\"\n  \
             line 3, column z_m: {rule} \"nan\"\n  \
             line 4: 2 fields, and the header has 3\n  \
             line 5: 4 fields, and the header has 3; a decimal comma makes two fields of a number\n  \
             line 6, column x_m: {rule} \"0,5\"; a decimal comma is written 0.5\n  \
             line 6, column y_m: {rule} nothing\n  \
             line 6, column z_m: {rule} \"1e16\"\n"
        )
    );
    assert_eq!(
        refused(b"x_m,y_m,z_m\n0,oops,0\n"),
        format!("palpate: points.csv: line 2, column y_m: {rule} \"oops\"\n")
    );
}

#[test]
fn at_most_twenty_bad_values_are_told_and_all_are_counted() {
    let mut points = "x_m,y_m,z_m\n".to_owned();
    for i in 0..70_000 {
        writeln!(points, "{i},0,{}", if i % 1000 == 3 { "x" } else { "1" }).unwrap();
    }
    let said = refused(points.as_bytes());
    assert!(said.starts_with(
        "palpate: points.csv: 70 problems, the first 20:\n  line 5, column z_m: "
    ));
    assert_eq!(said.lines().count(), 21);
    assert!(said.lines().last().unwrap().starts_with("  line 19005, column z_m: "), "{said}");
}

#[test]
fn columns_that_are_missing_are_told_with_those_that_may_be_meant() {
    let has = "line 1: a point in 3D has the columns x_m,y_m,z_m, the file has";
    for (header, expected) in [
        ("x_m,y_m", "there is no z_m"),
        ("x_m,zz_m,y_m", "there is no z_m, did you mean `zz_m`?"),
        (
            "x_mm,y [cm],z (in)",
            "`x_mm` is in mm: divide by 1000, and call it x_m; \
             `y [cm]` is in cm: divide by 100, and call it y_m; \
             `z (in)` is in in: multiply by 0.0254, and call it z_m",
        ),
        (
            "x,y [m],z_m",
            "`x` says no unit: if it is in m, call it x_m; if not, convert it first; rename `y [m]` to y_m",
        ),
    ] {
        let said = refused(format!("{header}\n0,0,0\n").as_bytes());
        assert_eq!(said, format!("palpate: points.csv: {has} {header}: {expected}\n"));
    }
}

#[test]
fn other_tables_are_told_of() {
    let separated = |by: &str| {
        format!(
            "line 1: the columns are separated by {by}; separate them by commas, and write numbers \
             with a decimal point"
        )
    };
    let utf16: Vec<u8> =
        "\u{feff}x_m,y_m,z_m\n".encode_utf16().flat_map(u16::to_be_bytes).collect();
    for (content, expected) in [
        (&b"x_m;y_m;z_m\n0,5;1;2\n"[..], separated("semicolons")),
        (b"x_m\ty_m\tz_m\n0\t1\t2\n", separated("tabs")),
        (
            b"0,0,0\n1,1,1\n",
            "line 1: there is no header; the first line names the columns".to_owned(),
        ),
        (b"", "it is an empty file".to_owned()),
        (
            b"x_m,y_m,z_m\n0,0,0\n0,\xe9,0\n",
            "line 3 is not UTF-8; save the file as UTF-8".to_owned(),
        ),
        (
            &utf16,
            "the file is UTF-16 (big-endian); save it as UTF-8, for example with `iconv -f UTF-16BE \
             -t UTF-8`"
                .to_owned(),
        ),
        (
            BALL.as_bytes(),
            "it is a scene (JSON), not a table (CSV); `palpate check points.csv` checks it".to_owned(),
        ),
    ] {
        assert_eq!(refused(content), format!("palpate: points.csv: {expected}\n"));
    }
}

#[test]
fn a_byte_order_mark_is_passed_over() {
    let folder = Folder::new();
    folder.write("ball.json", BALL);
    let eval = |name: &str| folder.run(&["eval", "ball.json", "--points", name]);
    folder.write("plain.csv", "x_m,y_m,z_m\n0,2,0\n");
    folder.write("marked.csv", "\u{feff}x_m,y_m,z_m\r\n0,2,0\r\n");
    let [plain, marked] = ["plain.csv", "marked.csv"].map(eval);
    assert_eq!(status(&marked), 0, "{}", errors(&marked));
    assert_eq!(text(&marked), text(&plain));
}

#[test]
fn a_flat_scene_has_no_third_column() {
    let folder = Folder::new();
    folder.write("disc.json", &BALL.replace("\"dimension\": 3", "\"dimension\": 2"));
    folder.write("points.csv", "x_m,y_m,z_m\n0,0,0\n");
    let output = folder.run(&["eval", "disc.json", "--points", "points.csv"]);
    let expected = "line 1: the column z_m is for 3D scenes, but this scene is 2D";
    assert_eq!(errors(&output), format!("palpate: points.csv: {expected}\n"));
}

#[test]
fn every_bad_value_of_a_hand_path_is_told() {
    let rule = "must be a finite number of at most 1e15 in size, got";
    assert_eq!(
        refused_path("time_s,point,x_m,y_m,z_m\n0,0,0,0,0\n0,0,0,0,1\n1,2,0,0,0\n2,0,0,x,0\n"),
        format!(
            "palpate: hand.csv: 3 problems:\n  \
             line 3, column time_s: must be more than that of the row before, 0 s, got 0 s\n  \
             line 4, column point: points must be numbered 0, 1, 2 … in order, got \"2\" after 1 points\n  \
             line 5, column y_m: {rule} \"x\"\n"
        )
    );
    let has = "line 1: a hand path in 3D has the columns time_s,x_m,y_m,z_m, the file has";
    for (content, expected) in [
        (
            "time_ms,x_m,y_m,z_m\n0,0,0,0\n",
            format!(
                "{has} time_ms,x_m,y_m,z_m: `time_ms` is in ms: divide by 1000, and call it time_s"
            ),
        ),
        (
            "t,x_m,y_m,z_m\n0,0,0,0\n",
            format!(
                "{has} t,x_m,y_m,z_m: `t` says no unit: if it is in s, call it time_s; if not, convert it first"
            ),
        ),
        ("time_s,x_m,y_m,z_m\n", "there are no rows".to_owned()),
        (
            "time_s,x_m,y_m,z_m\n0,0,0,0\n",
            "a hand path needs at least 2 samples, got 1".to_owned(),
        ),
    ] {
        assert_eq!(refused_path(content), format!("palpate: hand.csv: {expected}\n"));
    }
}
