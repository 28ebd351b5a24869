// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Every primitive, and every operator, on a grid.

use palpate_field::catalogue::Entry;
use palpate_field::operator::Operator;
use palpate_testkit::kernels::{Dimension, Sample, Space};

/// From one body to the next [m].
const SPACING: f64 = 0.15;

/// Bodies in a row.
const COLUMNS: usize = 7;

/// The operators on shapes of space that are in no catalogue, each by name and as JSON; `bar`,
/// `bead` and `flat` are shapes.
const OPERATORS: &[(&str, &str)] = &[
    ("union", r#"{ "union": ["bar", "bead"] }"#),
    ("intersection", r#"{ "intersection": ["bar", "bead"] }"#),
    ("difference", r#"{ "difference": ["bar", "bead"] }"#),
    ("symmetric_difference", r#"{ "symmetric_difference": ["bar", "bead"] }"#),
    ("smooth_union", r#"{ "smooth_union": ["bar", "bead"], "width": 0.006 }"#),
    (
        "smooth_intersection",
        r#"{ "smooth_intersection": ["bar", "bead"], "width": 0.004, "profile": "circular" }"#,
    ),
    (
        "smooth_difference",
        r#"{ "smooth_difference": ["bar", "bead"], "width": 0.004, "profile": "cubic" }"#,
    ),
    (
        "displace",
        r#"{ "displace": ["bead", { "repeat": { "x": { "spacing": 0.02 },
             "y": { "spacing": 0.02 }, "z": { "spacing": 0.02 } },
             "of": { "ball": { "radius": 0.008 } } }], "height": 0.004 }"#,
    ),
    ("morph", r#"{ "morph": ["bar", "bead"], "progress": 0.5 }"#),
    ("translate", r#"{ "translate": [0.01, 0.02, 0], "of": "bar" }"#),
    (
        "rotate_degrees",
        r#"{ "rotate_degrees": { "axis": [0, 0, 1], "angle": 30 }, "of": "bar" }"#,
    ),
    ("rotation", r#"{ "rotation": [0, 0, 1, 1], "of": "bar" }"#),
    ("scale", r#"{ "scale": [1, 2, 1], "of": "bar" }"#),
    ("offset", r#"{ "offset": 0.01, "of": "bar" }"#),
    (
        "mirror",
        r#"{ "mirror": "x", "of": { "translate": [0.025, 0, 0],
             "rotate_degrees": { "axis": [0, 0, 1], "angle": 40 },
             "of": { "cuboid": { "size": [0.06, 0.02, 0.02] } } } }"#,
    ),
    (
        "repeat",
        r#"{ "repeat": { "x": { "spacing": 0.03, "first": -1, "last": 1 },
             "y": { "spacing": 0.03, "first": -1, "last": 1 } },
             "of": { "ball": { "radius": 0.01 } } }"#,
    ),
    (
        "bend_degrees",
        r#"{ "bend_degrees": 600, "of": { "cuboid": { "size": [0.1, 0.02, 0.02] } } }"#,
    ),
    (
        "twist_degrees",
        r#"{ "twist_degrees": 1800, "of": { "cuboid": { "size": [0.04, 0.1, 0.015] } } }"#,
    ),
    ("extrude", r#"{ "extrude": 0.03, "of": "flat" }"#),
    ("revolve", r#"{ "revolve": "y", "of": { "translate": [0.03, 0], "of": "flat" } }"#),
];

/// Every primitive of the plane or of space, each about 0.1 m wide.
pub(crate) fn primitives<const D: usize>() -> String
where
    Space: Dimension<D>,
{
    let (space, size) =
        if D == 2 { ("the plane", "[0.1, 0.1]") } else { ("space", "[0.1, 0.1, 0.1]") };
    let shape = |(of, entry): (&Sample, &Entry<D>)| {
        let alone = format!(r#"{{ "{}": {} }}"#, of.name, of.sample);
        let whole =
            format!(r#"{{ "intersection": [{alone}, {{ "cuboid": {{ "size": {size} }} }}] }}"#);
        let has_end = entry.example().unwrap().promise().bounds.is_some();
        (of.name, if has_end { alone } else { whole })
    };
    let samples: Vec<_> = Space::SAMPLES.iter().zip(Space::CATALOGUE).map(shape).collect();
    format!(
        r#"{{ "palpate": 1, "dimension": {D},
        "description": "Every primitive of {space}; those without end are cut off by a box.",
        "bodies": [{}] }}"#,
        bodies(D, &samples)
    )
}

/// Every operator on a shape of space, by name and as JSON.
pub(crate) fn operator_samples() -> Vec<(&'static str, String)> {
    let others = OPERATORS.iter().map(|&(name, of)| (name, of.to_owned()));
    others
        .chain(Operator::ALL.iter().map(|operator| (operator.name, sample(operator))))
        .collect()
}

/// An operator of the catalogue, on a bead.
fn sample(operator: &Operator) -> String {
    let [x, y, z] = operator.first;
    let argument =
        if operator.is_per_axis { format!("[{x}, {y}, {z}]") } else { x.to_string() };
    format!(r#"{{ "{}": {argument}, "of": "bead" }}"#, operator.name)
}

/// Every operator.
pub(crate) fn operators() -> String {
    let samples = operator_samples();
    format!(
        r#"{{ "palpate": 1, "dimension": 3,
        "description": "Every operator, most of them on a bar and a bead.",
        "shapes": {{
          "bar": {{ "cuboid": {{ "size": [0.08, 0.03, 0.03] }} }},
          "bead": {{ "translate": [0.01, 0.01, 0], "of": {{ "ball": {{ "radius": 0.03 }} }} }},
          "flat": {{ "regular_star": {{
            "branches": 5, "outer_radius": 0.02, "inner_radius": 0.01 }} }} }},
        "bodies": [{}] }}"#,
        bodies(3, &samples)
    )
}

/// Bodies in rows, the first row on top, in the middle of the plane of x and y.
fn bodies(dimension: usize, samples: &[(&str, String)]) -> String {
    let rows = samples.len().div_ceil(COLUMNS);
    let body = |(i, (name, shape)): (usize, &(&str, String))| {
        let x = (i % COLUMNS) as f64 - (COLUMNS - 1) as f64 / 2.0;
        let y = (rows - 1) as f64 / 2.0 - (i / COLUMNS) as f64;
        let depth = if dimension == 2 { "" } else { ", 0" };
        format!(
            r#"{{ "name": "{name}", "shape": {shape},
            "pose": {{ "translation": [{}, {}{depth}] }} }}"#,
            super::short(x * SPACING),
            super::short(y * SPACING)
        )
    };
    samples.iter().enumerate().map(body).collect::<Vec<_>>().join(",")
}
