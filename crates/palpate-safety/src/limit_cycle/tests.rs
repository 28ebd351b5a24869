// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Which motions are limit cycles, and how a wall becomes softer and stiffer.

use std::f64::consts::TAU;

use palpate_field::Vector;

use super::governor::STEP;
use super::*;

pub(super) const PERIOD: f64 = 1e-3;

/// A device of 0.1 kg at a wall of 1000 N/m: with a hand of 0.1 kg, half cycles up to 89 ms are
/// quick.
pub(super) fn options() -> LimitCycleOptions {
    LimitCycleOptions {
        is_on: true,
        stiffness: 1000.0,
        mass: 0.1,
        encoder_step: 0.0,
        damping: 0.5,
        period: PERIOD,
    }
}

fn stage() -> LimitCycle<Vector<f64, 3>> {
    LimitCycle::new(options())
}

/// Moves a device to `depth(t)` for two seconds at a wall that is `stiff` [N/m].
fn moved(stage: &mut LimitCycle<Vector<f64, 3>>, stiff: f64, depth: impl Fn(f64) -> f64) {
    for tick in 0..2000 {
        let depth = depth(f64::from(tick) * PERIOD);
        let force = Vector([0.0, stiff * depth.max(0.0), 0.0]);
        let position = Vector([0.0, -depth, 0.0]);
        let input = CycleInput::of(
            ForcesOf { bodies: force, guides: Vector::ZERO },
            force.norm(),
            position,
            1000.0,
        );
        let _ = stage.step(&input);
    }
}

fn found(stiff: f64, depth: impl Fn(f64) -> f64) -> u64 {
    let mut stage = stage();
    moved(&mut stage, stiff, depth);
    stage.report().found
}

#[test]
fn what_persists_is_a_limit_cycle_and_what_decays_is_none() {
    let wave = |frequency: f64, decay: f64| {
        move |t: f64| 2e-3 + 1e-3 * (-decay * t).exp() * (TAU * frequency * t).sin()
    };
    assert!(found(1000.0, wave(20.0, 0.0)) > 0);
    // Eight half cycles at 20 Hz take 0.2 s.
    assert_eq!(found(1000.0, wave(20.0, 3.0)), 0);
    // A hand goes to and fro three times a second, and tremor is small.
    assert_eq!(found(1000.0, wave(3.0, 0.0)), 0);
    assert_eq!(found(1000.0, |t| 2e-3 + 2e-5 * (TAU * 10.0 * t).sin()), 0);
    // A mass that bounces higher each time.
    assert!(found(1000.0, |t| 1e-3 * (0.5 * t).exp() * (TAU * 4.0 * t).sin()) > 0);
}

/// Once walls and guides fell to a thirty-second of their stiffness and stayed there.
#[test]
fn a_trembling_hand_gets_its_wall_back() {
    for (frequency, way) in [(7.0, 1e-4), (10.0, 2e-4), (12.0, 1e-3)] {
        let mut stage = stage();
        let mut last = 0.0_f64;
        let mut soft = 0;
        for tick in 0..60_000 {
            let depth = 5e-3 + way * (TAU * frequency * f64::from(tick) * PERIOD).sin();
            let force = Vector([0.0, 1000.0 * depth, 0.0]);
            let position = Vector([0.0, -depth, 0.0]);
            let part = stage.step(&CycleInput::of(
                ForcesOf { bodies: force, guides: Vector::ZERO },
                force.norm(),
                position,
                1000.0,
            ));
            let felt = part * force.norm();
            assert!(tick == 0 || (felt - last).abs() <= STEP + 0.1, "{tick}: {felt} N");
            last = felt;
            soft += i32::from(part < 0.9);
        }
        // Twice in 60 s, for ten and for twenty seconds of which it is whole.
        assert!(soft < 20_000, "{frequency} Hz: {soft} ms");
        // A device that oscillates farther is found meanwhile.
        let before = stage.report().found;
        moved(&mut stage, 1000.0, |t| 1e-2 + 3.0 * way * (TAU * 20.0 * t).sin());
        assert!(stage.report().found > before, "{frequency} Hz");
    }
}

#[test]
fn a_body_that_moves_the_hand_makes_no_limit_cycle() {
    for stiff in [500.0, 2000.0] {
        assert_eq!(found(stiff, |t| 2e-3 + 1e-3 * (TAU * 20.0 * t).sin()), 0);
    }
}

/// Once the step was taken from the force after the limit, and the written force fell faster.
#[test]
fn a_wall_beyond_the_force_limit_is_halved_smoothly_too() {
    let mut stage = stage();
    let limit = 1.5;
    let mut last = limit;
    for tick in 0..800 {
        let depth = 5e-3 + 1e-3 * (TAU * 20.0 * f64::from(tick) * PERIOD).sin();
        let (effort, position) = (1000.0 * depth, Vector([0.0, -depth, 0.0]));
        let force = Vector([0.0, effort.min(limit), 0.0]);
        let part = stage.step(&CycleInput::of(
            ForcesOf { bodies: force, guides: Vector::ZERO },
            effort,
            position,
            1000.0,
        ));
        let left = (part * effort).min(limit);
        assert!((left - last).abs() <= STEP + 0.13, "{tick}: {left}"); // the wave's 0.13 N
        last = left;
    }
    assert!(stage.report().found > 1 && last < limit);
}

#[test]
fn a_wall_is_halved_smoothly_and_comes_back_when_nothing_touches() {
    let mut stage = stage();
    let mut last = 1.0;
    let mut least = 1.0_f64;
    for tick in 0..250 {
        let depth = 2e-3 + 1e-3 * (TAU * 20.0 * f64::from(tick) * PERIOD).sin();
        let force = Vector([0.0, 1000.0 * depth, 0.0]);
        let position = Vector([0.0, -depth, 0.0]);
        let part = stage.step(&CycleInput::of(
            ForcesOf { bodies: force, guides: Vector::ZERO },
            force.norm(),
            position,
            1000.0,
        ));
        assert!((part - last).abs() * force.norm() <= STEP * (1.0 + 1e-9));
        last = part;
        least = least.min(part);
    }
    assert_eq!((least, stage.report().least_part, stage.report().found), (0.5, 0.5, 1));
    // By a factor of e in 20 s: e^0.1 in two, and all of it after 14.
    moved(&mut stage, 0.0, |_| -0.01);
    assert!(
        (stage.governor.part() - 0.5 * 0.1_f64.exp()).abs() < 1e-5,
        "{}",
        stage.governor.part()
    );
    (0..6).for_each(|_| moved(&mut stage, 0.0, |_| -0.01));
    assert_eq!(stage.governor.part(), 1.0);
}

/// A hand that taps eight times a second on a wall that cannot oscillate in it had a thirty-second of
/// the stiffness for as long as it tapped.
#[test]
fn a_tapping_hand_gets_its_wall_back() {
    let mut stage = stage();
    let mut soft = 0;
    for _ in 0..30 {
        moved(&mut stage, 1000.0, |t| 3e-3 * (TAU * 8.0 * t).sin());
        soft += i32::from(stage.governor.part() < 0.9);
    }
    assert!(soft < 10, "{soft} of 30 times");
}
