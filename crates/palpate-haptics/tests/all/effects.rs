// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Guides and vibration in the servo's loop: nothing is allocated, nothing is lost.

use crate::common::ball;
use assert_no_alloc::assert_no_alloc;
use palpate_device::PointState;
use palpate_field::{Shape, Vector};
use palpate_haptics::{Curve, Guide, GuideOptions, Material, Servo, ServoOptions};
use palpate_vibration::{
    ACTUATORS, ActuatorArray, Cue, Mapping, MappingOptions, Publisher, Synthesiser, Tap, Voice,
    one_channel, two_channels,
};

/// A guide of each kind.
fn guides() -> Vec<Guide> {
    let place = Vector([0.0, 0.06, 0.0]);
    let bends = [place, Vector([0.05, 0.07, 0.0]), Vector([0.1, 0.05, 0.0])];
    let options = GuideOptions::default();
    let point = GuideOptions {
        snap_distance: 0.01,
        release_distance: Some(0.02),
        ..GuideOptions::default()
    };
    vec![
        Guide::to_point(place, point).unwrap(),
        Guide::along_line(place, Vector([1.0, 0.0, 1.0]), options).unwrap(),
        Guide::along_segment(place, Vector([0.1, 0.06, 0.0]), options).unwrap(),
        Guide::on_plane(place, Vector([0.0, 3.0, 0.0]), options).unwrap(),
        Guide::along_curve(Curve::polyline(&bends).unwrap(), options).unwrap(),
        Guide::along_curve(Curve::smooth(&bends).unwrap(), options).unwrap(),
        Guide::well(place, 0.02, options).unwrap(),
    ]
}

/// The hand at a time [s]: it taps on a ball of 50 mm from above 5 times a second, and slides.
fn hand(time: f64) -> PointState {
    let turn = 10.0 * std::f64::consts::PI * time;
    let (sin, cos) = turn.sin_cos();
    let position = Vector([0.01 * time, 0.053 + 0.004 * cos, 0.0]);
    let velocity = Vector([0.01, -0.004 * 10.0 * std::f64::consts::PI * sin, 0.0]);
    PointState { position, velocity }
}

#[test]
fn a_tick_with_guides_and_vibration_allocates_nothing() {
    let wood = Material::preset("wood").unwrap();
    let impact = wood.impact.as_ref().map(Tap::from);
    let mut guides = guides();
    let mut servo = Servo::new(ball::<3>(0.05), 1, ServoOptions::default()).unwrap();
    let mapping = Mapping::new(MappingOptions::default()).unwrap();
    let mut voice = Voice::new(&mapping, 1000.0).unwrap();
    let mut synthesiser = Synthesiser::new(&mapping, 8000.0, 1).unwrap();
    let mut on_actuators = ACTUATORS
        .each_ref()
        .map(|(_, actuator)| Synthesiser::for_actuator(&mapping, actuator, 8000.0, 1).unwrap());
    let places = [-0.05, 0.0, 0.05, 0.1].map(|x| Vector([x, 0.05, 0.0]));
    let array = ActuatorArray::new(places.to_vec(), 0.1).unwrap();
    let mut publisher = Publisher::new(1, 1000.0, 50.0).unwrap();
    let (mut taps, mut loudest, mut published) = (0, 0.0_f64, 0.0_f64);
    let mut touching = false;
    for tick in 0..1000 {
        let state = hand(f64::from(tick) * 1e-3);
        assert_no_alloc(|| {
            let [touch] = servo.step(&[state]) else { return };
            let began = touch.contact && !touching;
            touching = touch.contact;
            let cue = touch.cue(began);
            let felt = mapping.feel(&Cue { wavelength: Some(1e-3), impact, ..cue });
            taps += u32::from(felt.tap.is_some());
            let tones = voice.step(&felt);
            let one = one_channel(&tones);
            loudest = loudest.max(one.amplitude);
            let two = two_channels(&tones, 75.0);
            assert!(two.low <= 1.0 && two.high <= 1.0);
            let mut amplitudes = [0.0; 4];
            array.play(touch.proxy, one.amplitude, &mut amplitudes);
            if let Some([command]) = publisher.mix(&[one]) {
                published = published.max(command.tone.amplitude);
            }
            let mut samples = [0.0; 8];
            synthesiser.render(&[felt], &mut samples);
            for synthesiser in &mut on_actuators {
                synthesiser.render(&[felt], &mut samples);
            }
            for guide in &mut guides {
                let force = guide.force(state.position, state.velocity);
                assert!(force.norm() <= guide.options().max_force * (1.0 + 1e-15));
            }
        });
    }
    // One tap for each of five turns, each of them published in full.
    assert_eq!(taps, 5);
    assert!(loudest > 0.05);
    assert_eq!(published.to_bits(), loudest.to_bits());
}

#[test]
fn a_cue_is_what_the_touch_is() {
    let shape: Shape<2> = ball(0.5);
    let mut servo = Servo::new(shape, 1, ServoOptions::default()).unwrap();
    servo.step(&[PointState::at_rest(Vector([0.0, 0.6, 0.0]))]);
    // The probe has a radius of 2 mm: 1 mm below where it rests.
    let state = PointState {
        position: Vector([0.0, 0.501, 0.0]),
        velocity: Vector([0.25, -0.125, 0.0]),
    };
    let [touch] = servo.step(&[state]) else { panic!("one point") };
    let cue = touch.cue(true);
    assert!((cue.depth - 1e-3).abs() < 1e-7);
    // 500 N/m and 1 N·s/m.
    assert!((cue.normal_force - 0.625).abs() < 1e-4);
    assert!((cue.normal_speed - 0.125).abs() < 1e-4 && (cue.slide_speed - 0.25).abs() < 1e-4);
    assert!(cue.began);
    let [free] = servo.step(&[PointState::at_rest(Vector([0.0, 0.6, 0.0]))]) else { panic!() };
    assert_eq!(free.cue(false), Cue::default());
}
