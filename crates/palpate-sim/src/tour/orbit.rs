// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The orbit about a shape from which a tour casts its rays.

use std::f64::consts::TAU;

use palpate_field::{Aabb, Point, Vector};

/// The most turns about the axis in a pass from end to end: neighbouring turns are then a
/// twelfth of the shape apart. Not a whole number, so that passes interleave.
const MOST_TURNS: f64 = 6.18;

/// The fewest turns in a pass, however short the orbit: with fewer the hand would climb one
/// side and miss the others.
const FEWEST_TURNS: f64 = 0.62;

/// Points at which the length of a pass is measured: at least 40 a turn, so that the error is
/// below one per cent.
const PASS_POINTS: u32 = 256;

/// Bisections for the turns of a pass: to a thousandth of a turn.
const HALVINGS: u32 = 12;

/// The highest latitude of an orbit, as a part of that of the pole.
const HIGHEST_LATITUDE: f64 = 0.97;

/// The lowest latitude, as a part of that of the other pole: where a turn begins to pass below
/// the box, at `tan⁻¹ √½` of a quarter turn.
const LOWEST_LATITUDE: f64 = 0.39;

/// Points `step` apart [m] on a box `height` [m] around the scene. In space the orbit winds
/// from the foot of the box to its upper pole and back, and no point is below the box, where
/// the table is. In the plane the orbit goes round the box.
///
/// An orbit too short for a pass of [`MOST_TURNS`] is one pass with fewer turns, so that the
/// hand reaches the sides and the top of the shape in any time.
pub(super) fn orbit(
    bounds: &Aabb<3>,
    is_flat: bool,
    height: f64,
    step: f64,
    count: usize,
) -> impl Iterator<Item = Point<3>> {
    let grown = bounds.grown(height);
    let (mut centre, mut half) = (grown.centre(), grown.half_extents());
    let turns = if is_flat {
        half.0[2] = 0.0;
        None
    } else {
        centre.0[1] += 0.5 * height;
        half.0[1] -= 0.5 * height;
        Some(turns_a_pass(centre, half, step * count as f64))
    };
    // The step in angle is adapted to the distance of the last step.
    let mut angle = 0.0;
    let mut rate = step / half.norm();
    let mut here = on_box(direction(angle, turns), centre, half);
    (0..=count).map(move |_| {
        let result = here;
        let ahead = on_box(direction(angle + rate, turns), centre, half);
        let travelled = (ahead - here).norm();
        rate *= (step / travelled.max(0.1 * step)).clamp(0.5, 2.0);
        angle += rate;
        here = on_box(direction(angle, turns), centre, half);
        result
    })
}

/// The number of turns that makes a pass `way` long [m].
fn turns_a_pass(centre: Point<3>, half: Vector<f64, 3>, way: f64) -> f64 {
    let length = |turns: f64| -> f64 {
        let at = |i: u32| {
            let part = f64::from(i) / f64::from(PASS_POINTS);
            on_box(direction(TAU * turns * part, Some(turns)), centre, half)
        };
        (0..PASS_POINTS).map(|i| (at(i + 1) - at(i)).norm()).sum()
    };
    let (mut low, mut high) = (FEWEST_TURNS, MOST_TURNS);
    if length(high) <= way {
        return high;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if length(middle) <= way {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The unit vector of the orbit at `angle` [rad], with `turns` turns in a pass; round in the plane,
/// without passes, if that is `None`.
fn direction(angle: f64, turns: Option<f64>) -> Vector<f64, 3> {
    let (sin, cos) = libm::sincos(angle);
    let Some(turns) = turns else { return Vector([sin, cos, 0.0]) };
    // From the foot up to the pole and back.
    let pass = angle / (TAU * turns);
    let risen = 1.0 - 2.0 * ((0.5 * pass).fract() - 0.5).abs();
    let part = risen * (HIGHEST_LATITUDE + LOWEST_LATITUDE) - LOWEST_LATITUDE;
    let (height, radius) = libm::sincos(0.25 * TAU * part);
    Vector([radius * sin, height, radius * cos])
}

/// The point of the box `|pᵢ − cᵢ| ≤ hᵢ` in `direction`, with the box stretched to a cube.
fn on_box(direction: Vector<f64, 3>, centre: Point<3>, half: Vector<f64, 3>) -> Point<3> {
    let largest = direction.0.into_iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    centre + Vector(std::array::from_fn(|i| half.0[i] * direction.0[i] / largest))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The heights of the lowest and the highest point of an orbit `way` long [m].
    fn heights(way: f64) -> (f64, f64) {
        let bounds = Aabb { min: Vector([-0.3, 0.0, -0.05]), max: Vector([0.3, 0.1, 0.05]) };
        let points = orbit(&bounds, false, 0.1, 0.001, (way / 0.001) as usize).map(|p| p[1]);
        points.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(y), h.max(y)))
    }

    #[test]
    fn an_orbit_comes_from_the_foot_to_the_top_however_short_it_is() {
        for way in [2.0, 3.0, 5.0, 9.0, 20.0, 40.0] {
            let (lowest, highest) = heights(way);
            assert!((0.0..0.03).contains(&lowest), "{way} m: {lowest}");
            assert!((highest - 0.2).abs() < 1e-9, "{way} m: {highest}");
        }
    }

    #[test]
    fn a_pass_has_as_many_turns_as_its_way_is_long_for() {
        let half = Vector([0.1, 0.2, 0.3]);
        let turns = |way: f64| turns_a_pass(Vector([1.0, 2.0, 3.0]), half, way);
        assert_eq!(
            (turns(0.1).to_bits(), turns(100.0).to_bits()),
            (FEWEST_TURNS.to_bits(), MOST_TURNS.to_bits())
        );
        let (few, more) = (turns(2.0), turns(4.0));
        assert!(FEWEST_TURNS < few && 1.5 * few < more && more < MOST_TURNS, "{few} {more}");
    }
}
