// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Walls on devices whose damping, friction and encoders differ from their profile.

use palpate_devices::{
    Device, DeviceProfile, Hand, HandPath, Interpolation, PROFILES, PointState, SimulatedDevice,
};
use palpate_field::kernel::HalfSpace;
use palpate_field::{Shape, Vector};
use palpate_haptics::{
    Bodies, Body, Material, Probe, Protection, ServoOptions, Surface, UnprotectedServo,
};

const PERIOD: f64 = 1e-3;

/// How the device differs from its profile, in multiples, and the hand that holds it.
#[derive(Clone, Copy, Debug)]
struct Plant {
    damping: f64,
    friction: f64,
    /// The damping of the hand [N·s/m].
    hand: f64,
    /// The stiffness of its grip [N/m]; zero for a hand that only pushes.
    grip: f64,
}

/// What a hand feels in the last three of ten seconds on a wall.
#[derive(Clone, Copy, Debug)]
struct Rest {
    /// The span of positions [m].
    motion: f64,
    /// The span of forces [N].
    force: f64,
    /// Given out by the servo in all ten seconds [J].
    given: f64,
}

/// Presses a wall of `material` with half of the force that the device bears for long.
fn pressed(profile: &DeviceProfile, material: &Material, plant: Plant) -> Rest {
    let radius = 0.002;
    let wall = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0]), -radius).unwrap());
    let wall = Body::new(wall, Surface::new(material).unwrap()).unwrap();
    let options = ServoOptions::default()
        .with_probe(Probe::new(radius).unwrap())
        .with_max_force(f64::INFINITY);
    let servo = UnprotectedServo::new(Bodies::new(vec![wall]).unwrap(), 1, options).unwrap();
    let mut servo = servo.protected(&Protection::new(profile.clone())).unwrap();
    let stiffness = servo.bodies().bodies()[0].surface().stiffness();
    let force = 0.5 * profile.max_force.min(profile.continuous_force);
    let Plant { hand, grip, .. } = plant;
    let (push, depth) =
        if grip > 0.0 { (0.0, force / stiffness + force / grip) } else { (force, 0.0) };
    let way = vec![Vector([0.0, 0.003]), Vector([0.0, -depth])];
    let path = HandPath::new(vec![0.0, 0.5], way, Interpolation::Smooth).unwrap();
    let hand = Hand::new(path).with_spring(grip, hand).unwrap();
    let hand = hand.with_push(Vector([0.0, -push])).unwrap();
    let real = profile
        .clone()
        .with_least_damping(profile.least_damping * plant.damping)
        .with_friction(profile.friction * plant.friction);
    let mut device = SimulatedDevice::new(real, vec![hand]).unwrap();
    let mut points = [PointState::at_rest(Vector::ZERO)];
    let (mut places, mut forces) = (Vec::new(), Vec::new());
    for tick in 0..10_000 {
        device.read(f64::from(tick) * PERIOD, &mut points).unwrap();
        servo.step(&points);
        device.write(servo.forces()).unwrap();
        if tick >= 7000 {
            places.extend(device.states().map(|state| state.position[1]));
            forces.push(servo.forces()[0].norm());
        }
    }
    let span = |all: &[f64]| {
        let most = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        most - all.iter().copied().fold(f64::INFINITY, f64::min)
    };
    Rest { motion: span(&places), force: span(&forces), given: device.energy_given() }
}

#[test]
fn walls_rest_on_devices_as_good_as_their_profiles() {
    for (name, profile) in PROFILES.iter().filter(|(_, p)| p.max_force < f64::INFINITY) {
        for preset in ["steel", "rubber"] {
            let material = Material::preset(preset).unwrap();
            for (damping, friction) in [(1.0, 1.0), (1.0, 3.0), (3.0, 1.0), (3.0, 3.0)] {
                for (hand, grip) in [(1.0, 0.0), (1.0, 100.0), (10.0, 0.0), (10.0, 1000.0)] {
                    let plant = Plant { damping, friction, hand, grip };
                    let rest = pressed(profile, &material, plant);
                    assert!(
                        rest.motion <= 2e-4 && rest.force <= 0.5 && rest.given <= 1e-3,
                        "{name}, {preset}, {plant:?}: {rest:?}"
                    );
                }
            }
        }
    }
}
