// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Screw threads: exact numbers, their helix, and how tight their models are.

use std::f64::consts::TAU;

use palpate_field::kernel::{Kernel, ScrewThread};
use palpate_field::scalar::Model;
use palpate_field::{ShapeError, Vector};

/// M6: pitch and depth by ISO 68-1, in millimetres.
const PITCH: f64 = 1.0;
const RADIUS: f64 = 3.0;

fn depth() -> f64 {
    5.0 / 8.0 * 3.0_f64.sqrt() / 2.0 * PITCH
}

fn metric(pitch: f64, starts: u32) -> Result<ScrewThread, ShapeError> {
    let profile = Vector([PITCH / 8.0, PITCH / 4.0, depth()]);
    ScrewThread::new(RADIUS, 20.0, pitch, starts, profile)
}

/// A point at `radius` and `turn` of a circle, right-handed about y.
fn at(radius: f64, turn: f64, y: f64) -> Vector<f64, 3> {
    let angle = TAU * turn;
    Vector([radius * angle.cos(), y, -radius * angle.sin()])
}

#[test]
fn a_metric_thread_has_the_profile_of_its_standard() -> Result<(), ShapeError> {
    let thread = metric(PITCH, 1)?;
    // The middle of a flank is at the radius of the pitch line, D − 3/4·H.
    let pitch_radius = RADIUS - 3.0 / 8.0 * 3.0_f64.sqrt() / 2.0 * PITCH;
    for (radius, y) in [
        (RADIUS, 0.0),
        (RADIUS, PITCH / 16.0),
        (pitch_radius, PITCH / 4.0),
        (RADIUS - depth(), 3.0 / 8.0 * PITCH),
        (RADIUS - depth(), PITCH / 2.0),
        (RADIUS - depth(), -PITCH / 2.0),
        (pitch_radius, -5.25 * PITCH),
    ] {
        for turn in [0.0, 0.3, 0.5, 0.9] {
            let f = thread.distance(at(radius, turn, y + turn * PITCH));
            assert!(f.abs() < 1e-14, "{f:e} at {radius}, {y}, {turn}");
        }
    }
    // A tenth off the middle of a flank, less the slope of the helix there.
    let [out, along] = [0.5, 0.5 * 3.0_f64.sqrt()].map(|part| 0.1 * part);
    let f = thread.distance(at(pitch_radius + out, 0.0, PITCH / 4.0 + along));
    let slope = 0.5 * 3.0_f64.sqrt() * PITCH / (TAU * (RADIUS - depth()));
    assert!((f - 0.1 / 1.0_f64.hypot(slope)).abs() < 1e-14, "{f}");
    assert!(f > 0.0997, "{f}");
    Ok(())
}

#[test]
fn a_left_handed_thread_is_the_mirror_image() -> Result<(), ShapeError> {
    for starts in [1, 3] {
        let (right, left) = (metric(PITCH, starts)?, metric(-PITCH, starts)?);
        for i in 0..2000 {
            let share = |k: f64| (f64::from(i) * k).fract();
            let radius = 5.0 * share(0.618_034);
            let p = at(radius, share(0.414_214), 24.0 * share(0.732_051) - 12.0);
            let mirrored = Vector([p[0], p[1], -p[2]]);
            let (f, g) = (right.distance(p), left.distance(mirrored));
            assert!((f - g).abs() < 1e-13, "{f} and {g} at {p:?}");
        }
    }
    Ok(())
}

#[test]
fn each_start_climbs_by_the_lead() -> Result<(), ShapeError> {
    let thread = metric(PITCH, 3)?;
    for i in 0..300 {
        let turn = f64::from(i) / 97.0 - 1.5;
        for start in 0..3 {
            let y = 3.0 * PITCH * turn + f64::from(start) * PITCH;
            let [crest, root] = [RADIUS, RADIUS - depth()];
            let f = thread.distance(at(crest + 0.01, turn, y));
            assert!((f - 0.01).abs() < 1e-13, "{f} over a crest");
            let f = thread.distance(at(root + 0.01, turn, y + 0.5 * PITCH));
            assert!((f - 0.01).abs() < 1e-13, "{f} over a root");
        }
    }
    Ok(())
}

/// The width of the model of a cube off a flank.
fn width_off_a_flank(thread: &ScrewThread, half: f64) -> f64 {
    let turn = 0.37;
    let p = at(RADIUS - 0.5 * depth(), turn, PITCH * (turn + 0.27));
    let model = thread.model(Vector(Model::cell(p.0, [half; 3])));
    model.lower + model.upper
}

#[test]
fn the_remainders_of_a_flanks_model_are_of_second_order() -> Result<(), ShapeError> {
    let thread = metric(PITCH, 1)?;
    let mut half = 0.05;
    let mut width = width_off_a_flank(&thread, half);
    // A cube of half the size of the flank: the circle bends by half² over its radius.
    assert!(width < 2.0 * half * half / RADIUS, "{width:e}");
    for _ in 0..8 {
        half *= 0.5;
        let next = width_off_a_flank(&thread, half);
        assert!(next < 0.27 * width, "{next:e} after {width:e}, half {half}");
        width = next;
    }
    Ok(())
}
