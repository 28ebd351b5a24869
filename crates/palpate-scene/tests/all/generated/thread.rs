// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A nut on a bolt with the profile of metric threads.
//!
//! ISO 68-1: the thread's section through the axis is a triangle of 60° with its
//! crests cut to an eighth of the pitch P and its roots to a quarter. So crests and
//! roots are 5/8·H apart, where H = √3/2·P, and a flank falls by √3 for each unit
//! along the axis.

/// An M6 bolt, five times as large.
const ENLARGED: f64 = 5.0;

/// From crest to crest [m].
pub(crate) const PITCH: f64 = 0.001 * ENLARGED;

/// From the axis to the crests [m].
pub(crate) const RADIUS: f64 = 0.003 * ENLARGED;

/// From the axis to a corner of the hexagons [m]: 10 mm between flats.
const HEXAGON: f64 = 0.00577 * ENLARGED;

/// Between the sections of nut and bolt [m].
pub(crate) const CLEARANCE: f64 = 0.0001;

/// The height of the middle of the thread [m].
pub(crate) const MIDDLE: f64 = 0.045;

/// Of a crest and of a root along the axis, and the depth between them [m].
fn profile() -> [f64; 3] {
    let depth = 5.0 / 8.0 * 3.0_f64.sqrt() / 2.0 * PITCH;
    [PITCH / 8.0, PITCH / 4.0, super::short(depth)]
}

/// The scene's text.
pub(crate) fn scene() -> String {
    let [crest, root, depth] = profile();
    format!(
        r#"{{ "palpate": 1, "dimension": 3,
        "description": "A nut on a bolt: M6 with its metric thread, five times as large. The bolt stands on its head; the nut turns with 0.1 mm to spare.",
        "shapes": {{
          "thread": {{
            "description": "ISO 68-1: crests of an eighth of the pitch, roots of a quarter, flanks at 60 degrees.",
            "screw_thread": {{
              "radius": {RADIUS}, "height": 0.06, "pitch": {PITCH}, "starts": 1,
              "profile": [{crest}, {root}, {depth}] }} }} }},
        "bodies": [
          {{ "name": "bolt", "shape": {{ "union": [
            {{ "translate": [0, 0.01, 0],
               "of": {{ "hexagonal_prism": {{ "radius": {HEXAGON}, "height": 0.02 }} }} }},
            {{ "translate": [0, {MIDDLE}, 0], "of": {{ "intersection": [ "thread",
               {{ "description": "Rounds the thread's end off.",
                  "rounded_cylinder": {{
                    "radius": {RADIUS}, "height": 0.06, "rounding": 0.003 }} }} ] }} }} ] }} }},
          {{ "name": "nut", "shape": {{ "difference": [
            {{ "translate": [0, 0.0475, 0],
               "of": {{ "hexagonal_prism": {{ "radius": {HEXAGON}, "height": 0.025 }} }} }},
            {{ "offset": {CLEARANCE},
               "of": {{ "translate": [0, {MIDDLE}, 0], "of": "thread" }} }} ] }} }} ],
        "views": [{{ "name": "thread", "description": "The thread's profile, along the axis.",
          "plane": "xy", "center": [0.015, 0.0475], "width": 0.04, "height": 0.03,
          "spacing": 0.001 }}] }}"#,
    )
}
