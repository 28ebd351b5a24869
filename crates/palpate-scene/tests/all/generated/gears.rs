// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Two involute gears in mesh.
//!
//! Cylindrical gears after ISO 53 and ISO 21771, of module m, pressure angle α and
//! profile shift x (in modules), with z teeth:
//!
//! - pitch radius r = m·z/2, base radius r·cos α, tip radius r + (1 + x)·m,
//!   root radius r − (1.25 − x)·m;
//! - on the pitch circle a tooth is (π/2 + 2·x·tan α)·m thick, that is half an angle of
//!   (π/2 + 2·x·tan α)/z to either side;
//! - at the radius ρ its flank is an involute: the half angle there is that on the
//!   pitch circle + inv α − inv(arccos(r·cos α/ρ)), where inv φ = tan φ − φ.
//!
//! The involute starts on the base circle; below, the flank is radial. Twelve teeth
//! are so few that the tips of the larger gear would reach below the pinion's base
//! circle; shifting the profiles by 0.3 m, outwards on the pinion and inwards on the
//! gear, mends that and keeps the centre distance m·(12 + 20)/2.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The module [m].
const MODULE: f64 = 0.005;

/// The teeth of the pinion and of the gear.
const TEETH: [usize; 2] = [12, 20];

/// The profile shift of the pinion, in modules; the gear has its opposite.
const SHIFT: f64 = 0.3;

/// How much thinner than they could be both teeth together are [m].
pub(crate) const BACKLASH: f64 = 0.0001;

/// Points along a flank's involute.
const POINTS: usize = 7;

/// The involute function of `angle` [rad].
fn inv(angle: f64) -> f64 {
    angle.tan() - angle
}

/// A gear about the origin, the middle of a tooth at +x.
fn outline(teeth: usize, shift: f64) -> Vec<[f64; 2]> {
    let alpha = 20.0_f64.to_radians();
    let pitch = MODULE * teeth as f64 / 2.0;
    let base = pitch * alpha.cos();
    let tip = pitch + (1.0 + shift) * MODULE;
    let root = pitch - (1.25 - shift) * MODULE;
    let thickness = (FRAC_PI_2 + 2.0 * shift * alpha.tan()) * MODULE - BACKLASH / 2.0;
    let half_angle = |radius: f64| {
        thickness / (2.0 * pitch) + inv(alpha) - inv((base / radius).min(1.0).acos())
    };
    let polar = |radius: f64, angle: f64| [radius * angle.cos(), radius * angle.sin()];
    let start = base.max(root);
    // The upper flank, from the root to the tip.
    let mut flank = vec![polar(root, half_angle(start))];
    for i in 0..POINTS {
        // Closer at the start, where the involute is bent most.
        let part = (i as f64 / (POINTS - 1) as f64).powi(2);
        let radius = start + (tip - start) * part;
        flank.push(polar(radius, half_angle(radius)));
    }
    let mut tooth: Vec<_> = flank.iter().map(|&[x, y]| [x, -y]).collect();
    // The chords of the tip and the root would cut into their circles.
    tooth.push([tip, 0.0]);
    tooth.extend(flank.into_iter().rev());
    tooth.push(polar(root, PI / teeth as f64));
    let step = TAU / teeth as f64;
    (0..teeth).flat_map(|i| super::turned(&tooth, step * i as f64)).collect()
}

/// The scene's text.
pub(crate) fn scene() -> String {
    let [pinion, gear] = TEETH;
    let body = |name: &str, teeth, shift, bore: f64, pose: &str| {
        format!(
            r#"{{ "name": "{name}", "shape": {{ "difference": [
               {{ "polygon": {{ "rings": [{}] }} }}, {{ "ball": {{ "radius": {bore} }} }} ] }},
               "pose": {pose} }}"#,
            super::ring(&outline(teeth, shift))
        )
    };
    let distance = MODULE * (pinion + gear) as f64 / 2.0;
    // The pinion has a tooth at +x; the gear, turned by half a step, a gap at −x, for
    // its number of teeth is even.
    let pose = format!(
        r#"{{ "translation": [{distance}, 0], "rotate_degrees": {} }}"#,
        180.0 / gear as f64
    );
    format!(
        r#"{{ "palpate": 1, "dimension": 2,
        "description": "Two involute gears in mesh: module 5 mm, 12 and 20 teeth, pressure angle 20°, profiles shifted by 0.3 modules so that twelve teeth are enough, 0.1 mm of backlash.",
        "bodies": [{}, {}],
        "views": [{{ "name": "mesh", "center": [0.033, 0], "width": 0.04, "height": 0.03,
          "spacing": 0.001 }}] }}"#,
        body("pinion", pinion, SHIFT, 0.01, r#"{ "translation": [0, 0] }"#),
        body("gear", gear, -SHIFT, 0.015, &pose),
    )
}
