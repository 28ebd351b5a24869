// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! An oracle of the shortest way out of bodies: many directions, all around.

use palpate_field::{Point, Vector};
use palpate_haptics::Bodies;

/// The nearest of many points outside to which the straight way was free before, in many
/// directions; `None` within `most`.
pub(crate) fn nearest<const D: usize>(
    [before, after]: [&Bodies; 2],
    (from, radius): (Point<3>, f64),
    most: f64,
) -> Option<f64> {
    let gap = |bodies: &Bodies, p| bodies.everything().look(p).0 - radius;
    let mut best = None;
    for way in directions::<D>() {
        let mut length = 0.0;
        loop {
            let here = gap(after, from + way * length);
            if here >= 0.0 {
                break;
            }
            length += (-here).max(1e-7);
            if length > best.unwrap_or(most) {
                break;
            }
        }
        let was_free =
            |k: u32| gap(before, from + way * (length * f64::from(k) / 32.0)) > -1e-7;
        if length <= best.unwrap_or(most) && (0..=32).all(was_free) {
            best = Some(length);
        }
    }
    best
}

/// Directions all around.
fn directions<const D: usize>() -> Vec<Vector<f64, 3>> {
    let spiral = |k: u32, of: f64| {
        let y = 1.0 - 2.0 * (f64::from(k) + 0.5) / of;
        let (turn, around) = (2.399_963_229_728_653 * f64::from(k), (1.0 - y * y).sqrt());
        [around * turn.cos(), y, around * turn.sin()]
    };
    let circle = |k: u32, of: f64| {
        let turn = std::f64::consts::TAU * f64::from(k) / of;
        [turn.cos(), turn.sin(), 0.0]
    };
    let count = if D == 2 { 720 } else { 2000 };
    let all = (0..count).map(|k| {
        let of = f64::from(count);
        Vector(if D == 2 { circle(k, of) } else { spiral(k, of) })
    });
    all.chain((0..D).flat_map(|axis| [Vector::unit(axis), -Vector::unit(axis)])).collect()
}
