// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Walls on devices whose damping, friction, encoders and delay differ from their profile.

use palpate::device::{DeviceProfile, PROFILES};
use palpate::haptics::Material;
use palpate::stability::{Plant, Press};

/// The most that a wall gives out within ten seconds to a hand on a device without delay [J].
const MOST_GIVEN: f64 = 1e-3;

/// The most by which the controller changes what it takes in a tick, if no delay deceives it [N].
const STEP: f64 = 0.3;

fn with_forces() -> impl Iterator<Item = (usize, &'static str, &'static DeviceProfile)> {
    let with_forces = PROFILES.iter().filter(|(_, profile)| profile.max_force < f64::INFINITY);
    with_forces.enumerate().map(|(number, (name, profile))| (number, *name, profile))
}

/// Every preset on every profile, each on another few of the plants.
#[test]
fn walls_rest_on_devices_that_differ_from_their_profiles() {
    for (number, name, profile) in with_forces() {
        for (of_preset, preset) in Material::preset_names().enumerate() {
            let material = Material::preset(preset).unwrap();
            // A membrane breaks, and its force is gone at once; a magnet pulls the hand in.
            let step = if preset == "membrane" { f64::INFINITY } else { STEP * (1.0 + 1e-9) };
            let given = if preset == "magnet" { f64::INFINITY } else { MOST_GIVEN };
            let press = Press::new(profile, &material).unwrap();
            for plant in Plant::wrong(0).skip((7 * number + of_preset) % 27).step_by(27) {
                let rest = press.clone().on(plant).unwrap();
                assert!(
                    rest.is_at_rest()
                        && rest.energy_given <= given
                        && rest.controller_step <= step,
                    "{name}, {preset}, {plant:?}: {rest:?}"
                );
            }
        }
    }
}

/// Energy is lost to what is not known here: a delayed force does other work than the observer
/// counts, until its oscillation is found.
#[test]
fn walls_rest_where_forces_come_late() {
    for (number, name, profile) in with_forces() {
        let press = Press::new(profile, &Material::preset("steel").unwrap()).unwrap();
        for delay in [1, 2] {
            for plant in Plant::wrong(delay).skip((5 * number + delay) % 12).step_by(12) {
                let rest = press.clone().on(plant).unwrap();
                assert!(rest.is_at_rest(), "{name}, {plant:?}: {rest:?}");
            }
        }
    }
}

/// A reading that was missing now and then, or a hand that stroked the wall, hid a limit cycle: of 3 to
/// 9 mm on the omega, for good.
#[test]
fn walls_rest_where_readings_are_missing_and_under_hands_that_stroke_them() {
    // As stiff as the device renders, without a damper or friction.
    let hard = Material {
        stiffness: 1e5,
        damping: 0.0,
        static_friction: 0.0,
        dynamic_friction: 0.0,
        ..Material::default()
    };
    for (_, name, profile) in with_forces() {
        for (missing, stroke) in [(50, 0.0), (100, 0.0), (150, 0.0), (0, 0.03), (0, 0.1)] {
            for (delay, hand_damping, grip) in
                [(1, 1.0, 100.0), (2, 1.0, 100.0), (2, 3.0, 500.0)]
            {
                let mut plant = Plant::as_profile();
                (plant.delay, plant.missing, plant.stroke) = (delay, missing, stroke);
                (plant.hand_damping, plant.grip) = (hand_damping, grip);
                (plant.damping, plant.friction) = (0.3, 0.3);
                let rest = Press::new(profile, &hard).unwrap().on(plant).unwrap();
                assert!(rest.is_at_rest(), "{name}, {plant:?}: {rest:?}");
            }
        }
    }
}
