// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is felt of touches on actuators: the models of the actuators are the oracle.

use palpate_haptics::Material;
use palpate_vibration::{
    ACTUATORS, Actuator, ActuatorModel, Cue, Limiting, Mapping, MappingOptions, Mechanism,
    Sensation, Synthesiser, Tap, Tone, sensation_level,
};

/// Samples a second [Hz], and in a tick of 1 kHz.
const RATE: f64 = 8000.0;
const TICK: usize = 8;

/// What an actuator gets, and how it shakes.
struct Felt {
    levels: Vec<f32>,
    shaking: Vec<f64>,
    limiting: Limiting,
}

impl Felt {
    /// How far that is above the threshold from a sample on [dB].
    fn level_from(&self, second: f64) -> Option<f64> {
        sensation_level(&self.shaking[(second * RATE) as usize..], RATE).unwrap()
    }
}

/// A cue in each tick, on an actuator.
fn felt(actuator: &Actuator, cues: impl Iterator<Item = Cue>) -> Felt {
    let mapping = Mapping::new(actuator.options(MappingOptions::default())).unwrap();
    let mut synthesiser = Synthesiser::for_actuator(&mapping, actuator, RATE, 1).unwrap();
    let mut model = ActuatorModel::new(actuator, RATE).unwrap();
    let mut levels = Vec::new();
    for cue in cues {
        let mut samples = [0.0; TICK];
        synthesiser.render(&[mapping.feel(&cue)], &mut samples);
        levels.extend(samples);
    }
    let shaking = levels.iter().map(|level| model.step(f64::from(*level))).collect();
    Felt { levels, shaking, limiting: synthesiser.limiting() }
}

/// A tap on a material at 0.1 m/s; the hand leaves at once.
fn tap(material: &Material) -> impl Iterator<Item = Cue> {
    let impact = material.impact.as_ref().map(Tap::from);
    let struck = Cue { normal_speed: 0.1, impact, began: true, ..Cue::default() };
    (0..300).map(move |tick| if tick == 0 { struck } else { Cue::default() })
}

/// A finger that rests at a depth [m] for some time [s].
fn hold(depth: f64, time: f64) -> impl Iterator<Item = Cue> {
    let ticks = (time * 1000.0) as usize;
    (0..ticks).map(move |tick| Cue { depth, began: tick == 0, ..Cue::default() })
}

#[test]
fn a_tap_on_every_material_is_felt_on_every_actuator() {
    for name in Material::preset_names() {
        let material = Material::preset(name).unwrap();
        if material.impact.is_none() {
            continue;
        }
        for (kind, actuator) in &ACTUATORS {
            let felt = felt(actuator, tap(&material));
            let level = felt.level_from(0.0).unwrap();
            assert!(level > 6.0, "{name} on {kind}: {level} dB");
        }
    }
}

#[test]
fn a_tap_ends_within_a_third_of_a_second() {
    let glass = Material::preset("glass").unwrap();
    for (kind, actuator) in &ACTUATORS {
        let felt = felt(actuator, tap(&glass));
        let level = felt.level_from(0.25).unwrap_or(f64::NEG_INFINITY);
        assert!(level < 0.0, "{kind}: {level} dB");
    }
}

#[test]
fn the_lightest_hold_is_felt_on_every_actuator_and_stronger_ones_no_less() {
    for (kind, actuator) in &ACTUATORS {
        let mut last = 6.0;
        for depth in [1e-6, 1e-3, 5e-3] {
            let level = felt(actuator, hold(depth, 0.5)).level_from(0.0).unwrap();
            assert!(level > last - 0.01, "{kind}, {depth} m: {level} dB");
            last = level;
        }
    }
}

#[test]
fn nobody_shakes_for_minutes_and_a_change_of_depth_is_felt_again() {
    for (kind, actuator) in &ACTUATORS {
        let harder = hold(4e-3, 0.5).map(|cue| Cue { began: false, ..cue });
        let felt = felt(actuator, hold(2e-3, 20.0).chain(harder));
        let loudest = |[from, to]: [f64; 2]| {
            let levels = &felt.levels[(from * RATE) as usize..(to * RATE) as usize];
            levels.iter().fold(0.0, |most: f32, x| most.max(x.abs()))
        };
        let (begun, left) = (loudest([0.3, 0.5]), loudest([19.5, 20.0]));
        let is_motor = matches!(actuator.mechanism, Mechanism::RotatingMass { .. });
        // A tenth of what it was when it began, which had faded to 0.86 after 0.3 s.
        let most = if is_motor { 0.0 } else { 0.12 * begun };
        assert!(begun > 0.0 && left <= most, "{kind}: {begun}, {left}");
        assert!(felt.level_from(20.0).unwrap() > 6.0, "{kind}");
    }
}

#[test]
fn a_slide_is_felt_on_every_actuator_and_slow_crests_are_counted_on_a_resonance() {
    // 40 mm/s over crests 2 mm apart: 20 a second.
    let slide = |_| Cue {
        normal_force: 1.0,
        slide_speed: 0.04,
        wavelength: Some(2e-3),
        ..Cue::default()
    };
    for (kind, actuator) in &ACTUATORS {
        let felt = felt(actuator, (0..1000).map(slide));
        assert!(felt.level_from(0.0).unwrap() > 6.0, "{kind}");
        if *kind != "lra" {
            continue;
        }
        // The envelope, as the largest of each 5 ms, falls below half and rises again 20 times.
        let envelope: Vec<f64> = felt.shaking.chunks(40).map(largest).collect();
        let half = 0.5 * largest(&envelope);
        let crests = envelope.windows(2).filter(|pair| pair[0] < half && pair[1] >= half);
        assert!((19..=21).contains(&crests.count()));
    }
}

fn largest(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |most, x| most.max(x.abs()))
}

#[test]
fn nothing_exceeds_the_largest_level_and_what_is_limited_is_counted() {
    let all = Sensation {
        hold: Tone { frequency: 60.0, amplitude: 1.0 },
        slide: Tone { frequency: 250.0, amplitude: 1.0 },
        tap: Some(Tap { amplitude: 1.0, frequency: 250.0, decay: 10.0 }),
    };
    for (kind, actuator) in &ACTUATORS {
        let mapping = Mapping::new(actuator.options(MappingOptions::default())).unwrap();
        let mut synthesiser = Synthesiser::for_actuator(&mapping, actuator, RATE, 10).unwrap();
        let mut samples = [0.0; TICK];
        for _ in 0..1000 {
            synthesiser.render(&[all; 10], &mut samples);
            assert!(samples.iter().all(|sample| sample.abs() <= 1.0), "{kind}");
        }
        let Limiting { ticks, least_gain } = synthesiser.limiting();
        assert!(ticks > 900 && least_gain < 0.5, "{kind}: {ticks} ticks, {least_gain}");
    }
    let coil = &ACTUATORS.iter().find(|(kind, _)| *kind == "voice_coil").unwrap().1;
    assert_eq!(felt(coil, hold(5e-3, 0.5)).limiting, Limiting::default());
}
