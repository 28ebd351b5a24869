// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate shapes` of one primitive.

use palpate::field::catalogue::Entry;
use palpate::field::kernel::{Mark, MarkKind};

use crate::common::{Folder, assert_refused, errors, json, palpate, status, text};

#[test]
fn one_primitive_is_described_with_its_example() {
    let said = "\
capped_cone (3D): A cone about the y axis with its tip cut off.
    bottom_radius [m]: the radius at the bottom
    top_radius [m]: the radius at the top
    height [m]: the full height
    origin: centred, at half its height; axis along y, `bottom_radius` below
    promise: exact outside, exact inside
    example: { \"capped_cone\": { \"bottom_radius\": 0.6, \"top_radius\": 0.25, \"height\": 0.9 } }
";
    assert_eq!(text(&palpate(&["shapes", "capped_cone"])), said);
    let both = text(&palpate(&["shapes", "ball"]));
    assert!(both.contains("ball (2D)") && both.contains("ball (3D)"), "{both}");
    let planar = text(&palpate(&["shapes", "ball", "--dimension", "2"]));
    assert!(planar.contains("ball (2D)") && !planar.contains("ball (3D)"), "{planar}");
    let rows = json(&["shapes", "torus", "--json"])["primitives"].clone();
    assert_eq!(rows.as_array().map(Vec::len), Some(1));
    assert_eq!(rows[0]["origin"], "centred; axis along y");
    assert_eq!(rows[0]["example"]["torus"]["ring_radius"], 0.6);
}

#[test]
fn other_names_are_explained() {
    let said = text(&palpate(&["shapes", "cube"]));
    let head = "`cube` is another name of `cuboid` in 3D, with one number as `size`: the length \
                of every edge\ncuboid (3D): ";
    assert!(said.starts_with(head), "{said}");
}

#[test]
fn unknown_primitives_get_near_names() {
    assert_refused(
        &["shapes", "torsu"],
        "unknown primitive `torsu`, did you mean `torus`? (`palpate shapes` lists all)",
    );
    assert_refused(
        &["shapes", "torus", "--dimension", "2"],
        "`torus` is a primitive of space: leave out `--dimension 2`",
    );
    assert_refused(
        &["shapes", "egg", "--dimension", "3"],
        "`egg` is a primitive of the plane: leave out `--dimension 3`",
    );
    let output = palpate(&["shapes", "teapot"]);
    let said = errors(&output);
    assert_eq!(status(&output), 2);
    assert!(
        said.starts_with("palpate: unknown primitive `teapot`; known are `arc`, "),
        "{said}"
    );
    assert!(said.ends_with(" more (`palpate shapes` lists all)\n"), "{said}");
}

#[test]
fn a_picture_needs_a_name_and_an_ending() {
    assert_refused(
        &["shapes", "--output", "all.svg"],
        "--output is for the picture of one primitive: palpate shapes torus --output torus.svg",
    );
    assert_refused(
        &["shapes", "--width", "400"],
        "--width is for the picture of one primitive: palpate shapes torus --output torus.svg",
    );
    assert_refused(
        &["shapes", "egg", "--width", "400"],
        "--width is for a picture, and needs --output: palpate shapes egg --output egg.png",
    );
    assert_refused(
        &["shapes", "egg", "--output", "egg.gif"],
        "egg.gif: the name of a picture must end in .svg or .png",
    );
    assert_refused(
        &["shapes", "egg", "--output", "egg.svg", "--width", "400"],
        "--width is for PNG pictures; an SVG is drawn at any width",
    );
}

#[test]
fn a_picture_is_written_and_named() {
    let folder = Folder::new();
    let output = folder.run(&["shapes", "egg", "--output", "egg.png", "--width", "300"]);
    assert!(text(&output).ends_with("\negg.png: egg with its parameters\n"), "{output:?}");
    assert_eq!(&std::fs::read(folder.path("egg.png")).unwrap()[1..4], b"PNG");
    let svg = folder.name("egg.svg");
    let rows = json(&["shapes", "egg", "--output", &svg, "--json"])["primitives"].clone();
    assert_eq!(rows[0]["output"], svg.as_str());
}

/// The names of the marks that the picture of a primitive must show.
fn marked<const D: usize>() -> Vec<(&'static str, Vec<String>)> {
    let can_be_seen = |mark: &Mark<D>| mark.kind != MarkKind::Length || mark.length() > 0.0;
    let names = |entry: &Entry<D>| {
        let marks = entry.marks(&entry.example_arguments().unwrap()).unwrap();
        let names = marks.iter().filter(|mark| can_be_seen(mark)).map(Mark::name).collect();
        (entry.name, names)
    };
    Entry::<D>::all().iter().map(names).collect()
}

#[test]
#[ignore = "slow: cargo xtask test --thorough"]
fn every_picture_shows_every_parameter() {
    let folder = Folder::new();
    for (name, marks) in [marked::<2>(), marked::<3>()].concat() {
        let svg = folder.name("shape.svg");
        let output = palpate(&["shapes", name, "--output", &svg]);
        assert_eq!(status(&output), 0, "{name}: {}", errors(&output));
        let picture = std::fs::read_to_string(&svg).unwrap();
        for mark in marks {
            let label = format!("aria-label=\"{mark}");
            let is_there =
                [" ", "\""].iter().any(|end| picture.contains(&format!("{label}{end}")));
            assert!(is_there, "{name}: {mark}");
        }
    }
}
