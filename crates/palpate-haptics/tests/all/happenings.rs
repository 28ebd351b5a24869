// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Events tell what happened, once; reactions are what the hand does to a body.

use crate::common::wild::{servo, step};
use crate::common::{ball, half_space};
use palpate_device::PointState;
use palpate_field::{Pose, Vector};
use palpate_haptics::{
    Bodies, Body, EventKind, Layer, Material, PopThrough, Probe, Servo, ServoOptions, Surface,
};

/// Plays a wild scene, and checks every event against the state before it.
fn events_are_in_order<const D: usize>(count: usize) {
    const POINTS: usize = 4;
    let mut servo = servo::<D>(count, POINTS, 1.0);
    let mut states = [PointState::at_rest(Vector::ZERO); POINTS];
    // Whether a point touches, and whether it slips, as the events tell it.
    let mut told = [(None, false); POINTS];
    let mut counts = [0; 5];
    for tick in 0..12_000 {
        step::<D>(&mut servo, &mut states, (tick, 1.0));
        for event in servo.events() {
            assert_eq!(event.tick, u64::from(tick));
            let (touched, slips) = &mut told[event.point as usize];
            match event.kind {
                EventKind::Touch { speed } => {
                    assert!(*touched != Some(event.body) && speed >= 0.0, "{event:?}");
                    (*touched, *slips) = (Some(event.body), false);
                    counts[0] += 1;
                }
                EventKind::Leave => {
                    assert_eq!(*touched, Some(event.body), "{event:?}");
                    *touched = None;
                    counts[1] += 1;
                }
                EventKind::Slip => {
                    assert!(touched.is_some() && !*slips, "{event:?}");
                    *slips = true;
                    counts[2] += 1;
                }
                EventKind::Stick => {
                    assert!(touched.is_some(), "{event:?}");
                    *slips = false;
                    counts[3] += 1;
                }
                EventKind::Pop { force } => {
                    assert!(*touched == Some(event.body) && force > 0.8, "{event:?}");
                    counts[4] += 1;
                }
                other => panic!("{other:?}"),
            }
        }
        for (touch, (touched, _)) in servo.touches().iter().zip(&told) {
            assert_eq!(touched.is_some(), touch.contact, "{tick} {touch:?}");
        }
    }
    assert!(counts.iter().all(|count| *count > 0), "{counts:?}");
}

#[test]
fn in_the_plane_events_are_in_order() {
    events_are_in_order::<2>(9);
}

#[test]
fn in_space_events_are_in_order() {
    events_are_in_order::<3>(20);
}

fn options() -> ServoOptions {
    let probe = Probe::new(0.0).unwrap();
    ServoOptions { probe, max_force: 1.0, ..ServoOptions::default() }
}

#[test]
fn a_reaction_is_the_wanted_force_turned_round_and_its_torque() {
    // A floor whose origin is elsewhere; 4 N are wanted, 1 N is given.
    let surface = Surface::smooth(512.0, 0.0).unwrap();
    let at = Pose::translation(Vector([1.0, 0.25, 0.5]));
    let floor = Body::new(half_space([0.0, 1.0, 0.0], -0.25), surface).unwrap().at(at).unwrap();
    let mut servo = Servo::new(Bodies::new(vec![floor]).unwrap(), 2, options()).unwrap();
    let state = |y: f64| PointState::at_rest(Vector([0.5, y, 0.125]));
    servo.step(&[state(0.5), state(0.5)]);
    let touches = servo.step(&[state(-0.0078125), state(0.5)]).to_vec();
    assert_eq!(touches[0].force, Vector([0.0, 1.0, 0.0]));
    let [reaction] = servo.reactions() else { panic!("one body") };
    // A proxy rests within 2.5e-10 of the size of the scene: 1e-7 N.
    let is = |a: Vector<f64, 3>, b: [f64; 3]| assert!((a - Vector(b)).norm() < 1e-6, "{a:?}");
    is(reaction.force, [0.0, -4.0, 0.0]);
    assert_eq!(reaction.force, -touches[0].wanted);
    // (−0.5, −0.25, −0.375) × (0, −4, 0).
    is(reaction.torque, [-1.5, 0.0, 2.0]);
    // Two hands press with 4 N and 2 N.
    servo.step(&[state(-0.0078125), state(-0.00390625)]);
    is(servo.reactions()[0].force, [0.0, -6.0, 0.0]);
    is(servo.reactions()[0].torque, [-2.25, 0.0, 3.0]);
}

#[test]
fn in_the_plane_a_torque_is_about_z() {
    let surface = Surface::smooth(512.0, 0.0).unwrap();
    let floor = Body::new(half_space([0.0, 1.0], 0.0), surface).unwrap();
    let mut servo = Servo::new(Bodies::new(vec![floor]).unwrap(), 1, options()).unwrap();
    servo.step(&[PointState::at_rest(Vector([0.5, 0.5, 0.0]))]);
    servo.step(&[PointState::at_rest(Vector([0.5, -0.0078125, 0.0]))]);
    let off = servo.reactions()[0].torque - Vector([0.0, 0.0, -2.0]);
    assert!(off.norm() < 1e-6, "{off:?}");
}

#[test]
fn every_layer_pops_once() {
    let pop = |force| Some(PopThrough { description: None, force, distance: 0.001 });
    let layer = |depth, force| Layer {
        description: None,
        depth,
        stiffness: None,
        damping: None,
        static_friction: None,
        dynamic_friction: None,
        viscosity: None,
        pop_through: pop(force),
    };
    let material = Material {
        stiffness: 1000.0,
        damping: 0.0,
        static_friction: 0.0,
        dynamic_friction: 0.0,
        pop_through: pop(1.0),
        layers: vec![layer(0.004, 2.0), layer(0.008, 3.0)],
        ..Material::default()
    };
    let body = Body::new(ball::<3>(0.05), Surface::new(&material).unwrap()).unwrap();
    let options = ServoOptions { max_force: f64::INFINITY, ..options() };
    let mut servo = Servo::new(Bodies::new(vec![body]).unwrap(), 1, options).unwrap();
    for _ in 0..3 {
        let mut popped = Vec::new();
        for tick in 0..200 {
            let y = 0.055 - 1e-4 * f64::from(tick);
            servo.step(&[PointState::at_rest(Vector([0.0, y, 0.0]))]);
            for event in servo.events() {
                if let EventKind::Pop { force } = event.kind {
                    popped.push((force, 0.05 - y));
                }
            }
        }
        // At 1 N a millimetre: 1 mm deep, 2 mm below the next layer at 4 mm, 3 mm below 8 mm.
        let deep = [0.001, 0.006, 0.011];
        assert_eq!(popped.len(), 3, "{popped:?}");
        for ((force, depth), (expected, at)) in
            popped.iter().zip([1.0, 2.0, 3.0].iter().zip(deep))
        {
            assert!(
                (force - expected).abs() < 0.11 && (depth - at).abs() < 1.1e-4,
                "{popped:?}"
            );
        }
        servo.step(&[PointState::at_rest(Vector([0.0, 0.07, 0.0]))]);
    }
}
