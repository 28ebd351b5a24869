// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Strikes on plates down to 0.1 mm, from 1000 directions, with and without friction.

use crate::common::{ball, body, cases, cuboid, direction, rotation, unit, vector};
use arbitrary::Unstructured;
use palpate_device::PointState;
use palpate_field::{Pose, Shape, Vector};
use palpate_haptics::{Material, Probe, Servo, ServoOptions, Surface, Touch};

/// Directions that every plate is struck from.
const DIRECTIONS: u64 = 1000;

/// How thin the thinnest is [m].
const THINNEST: f64 = 1e-4;

/// Strikes a plate that is thin along y at its middle, at up to 10 m/s at 1 kHz, and presses on
/// until 50 mm beyond; its proxy stays on the side that it came from.
fn strike(
    u: &mut Unstructured<'_>,
    plate: &Shape<3>,
    (thickness, friction): (f64, f64),
) -> arbitrary::Result<()> {
    let pose = Pose::new(rotation(u)?, vector(u)? * 0.1);
    let material = Material {
        static_friction: friction,
        dynamic_friction: 0.7 * friction,
        ..Material::default()
    };
    let shape = plate.clone().placed(&pose).unwrap();
    let radius = [0.0, 1e-4, 0.002][u.choose_index(3)?];
    let probe = Probe::new(radius).unwrap();
    let options = ServoOptions { probe, ..ServoOptions::default() };
    let mut servo = Servo::new(body(&shape, Surface::new(&material).unwrap()), 1, options);
    let servo = servo.as_mut().unwrap();

    let mut way: Vector<f64, 3> = direction(u)?;
    // Not along the plate, around which it could go.
    way[1] = -(way[1].abs() + 0.3);
    let speed = 0.01 * (0.02 + 0.98 * unit(u)?.abs());
    let step = way.normalized().unwrap() * speed;
    let target = Vector([0.01 * unit(u)?, 0.0, 0.01 * unit(u)?]);
    // Never exactly in step with the plate.
    let mut device = target - step * ((0.03 / speed).ceil() + unit(u)?.abs());
    // As far as the way round the rim is longer.
    while device[1] > -0.05 && device[0].hypot(device[2]) < 0.1 {
        let held = servo.step(&[PointState::at_rest(pose.transform_point(device))])[0];
        let proxy = pose.inverse().transform_point(held.proxy);
        let least = 0.5 * thickness + radius - 1e-9;
        // Over the middle, the plate is as thick as it is said to be.
        assert!(proxy[1] >= 0.5 * least, "{proxy:?} of radius {radius} for {device:?}");
        assert!(device[1] > 0.0 || held.contact, "{held:?}");
        device += step;
    }
    Ok(())
}

fn strikes(plate: &Shape<3>, thickness: f64) {
    for friction in [0.0, 0.8] {
        cases(DIRECTIONS, |u| strike(u, plate, (thickness, friction)));
    }
}

#[test]
fn a_plate_holds() {
    strikes(&cuboid([0.4, THINNEST, 0.4]), THINNEST);
}

#[test]
fn a_plate_of_a_bound_holds() {
    // A cube of 0.4 m made thin: its values are a 4000th of the distance across it.
    let plate = cuboid([0.4; 3]).stretched([1.0, THINNEST / 0.4, 1.0]).unwrap();
    strikes(&plate, THINNEST);
}

#[test]
fn a_lens_of_a_bound_holds() {
    let lens = ball(0.2).stretched([1.0, 0.002, 0.8]).unwrap();
    strikes(&lens, 0.0);
}

#[test]
fn a_shell_holds() {
    // The far wall of a hollow box: struck from inside and outside alike.
    let shell = cuboid([0.4, 0.2, 0.4]).shell(THINNEST).unwrap();
    let top = shell.translated(Vector([0.0, -0.1, 0.0])).unwrap();
    strikes(&top, THINNEST);
}

#[test]
fn what_a_difference_leaves_holds() {
    let hollow = cuboid([0.4, 0.2 - THINNEST, 0.4 - THINNEST]);
    let shell = cuboid([0.4 + THINNEST, 0.2 + THINNEST, 0.4]).difference([hollow]).unwrap();
    let top = shell.translated(Vector([0.0, -0.1, 0.0])).unwrap();
    strikes(&top, THINNEST);
}

/// A point pressed through a plate of 0.1 mm, 14 mm beyond it, and then moved along it by 20 mm, by
/// `step` [m] a tick: what is felt in each.
fn beyond(friction: f64, budget: u32, step: f64) -> Vec<Touch> {
    let material = Material {
        static_friction: friction,
        dynamic_friction: 0.7 * friction,
        ..Material::default()
    };
    let plate = cuboid([0.4, THINNEST, 0.4]);
    let probe = Probe::new(0.0).unwrap().with_budget(budget).unwrap();
    let options = ServoOptions { probe, ..ServoOptions::default() };
    let bodies = body(&plate, Surface::new(&material).unwrap());
    let mut servo = Servo::new(bodies, 1, options).unwrap();
    let mut at = |x: f64, y: f64| servo.step(&[PointState::at_rest(Vector([x, y, 0.0]))])[0];
    for tick in 0..=200 {
        at(0.0, 0.006 - 1e-4 * f64::from(tick));
    }
    let ticks = (0.02 / step) as u32;
    (1..=ticks).map(|tick| at(step * f64::from(tick), -0.014)).collect()
}

/// Behind a thin wall the hand is outside again. A proxy that ran out of budget on its way along
/// the wall, as where static friction lets go of a point, once let go of the wall for a tick, with
/// no force at all.
#[test]
fn a_late_proxy_is_held_beyond_a_thin_wall() {
    for (friction, budget, step) in [(0.0, 4, 0.002), (0.8, 64, 0.0002)] {
        let felt = beyond(friction, budget, step);
        assert!(felt.iter().any(|touch| touch.evaluations >= budget - 1), "none is late");
        for touch in felt {
            assert!(touch.contact && touch.force[1] > 1.0, "{touch:?}");
        }
    }
}
