// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Identification of simulated devices, which know their own numbers.

use std::panic::{AssertUnwindSafe, catch_unwind};

use palpate_devices::{
    Device, DeviceAxis, DeviceLost, DeviceProfile, EncoderStep, Hand, Identified, IdentifiedAxis,
    IdentifyError, IdentifyOptions, PROFILES, PointState, SimulatedDevice, TurnState,
    profile_named,
};
use palpate_field::Vector;

/// Where the handle is at first: on no encoder step.
const START: Vector<f64, 2> = Vector([0.0123, -0.0207]);

/// Identifies on virtual time.
fn identify<const D: usize>(
    device: &mut dyn Device<D>,
    options: IdentifyOptions,
) -> Result<Identified, IdentifyError> {
    let mut tick = 0.0;
    palpate_devices::identify(device, options, &mut |_| {
        tick += 1.0;
        Some(tick / options.rate)
    })
}

fn free(profile: DeviceProfile) -> SimulatedDevice<2> {
    SimulatedDevice::new(profile, vec![Hand::free(START).unwrap()]).unwrap()
}

/// Factors of the mass, damping, friction and encoder step of a profile.
type Factors = [f64; 4];

/// `profile` with other numbers, along and about its axes.
fn scaled(profile: &DeviceProfile, [mass, damping, friction, step]: Factors) -> DeviceProfile {
    let plant = profile
        .clone()
        .with_mass(profile.mass * mass)
        .with_least_damping(profile.least_damping * damping)
        .with_friction(profile.friction * friction)
        .with_encoder_step(profile.encoder_step * step);
    let Some(turning) = profile.turning.clone() else { return plant };
    let (inertia, least, coulomb) =
        (turning.inertia * mass, turning.least_damping * damping, turning.friction * friction);
    let encoder = turning.encoder_step * step;
    plant.with_turning(
        turning
            .with_inertia(inertia)
            .with_least_damping(least)
            .with_friction(coulomb)
            .with_encoder_step(encoder),
    )
}

/// Mass, damping, friction and encoder step of an axis of a profile.
fn truth(profile: &DeviceProfile, axis: DeviceAxis) -> [f64; 4] {
    match (axis, &profile.turning) {
        (DeviceAxis::About(_), Some(turning)) => {
            [turning.inertia, turning.least_damping, turning.friction, turning.encoder_step]
        }
        _ => [profile.mass, profile.least_damping, profile.friction, profile.encoder_step],
    }
}

/// Checks that every number that is seen is within 10 %, and every other within twice its error,
/// which comes from a normal distribution: 4 standard deviations. Returns how many are not seen.
fn check(profile: &DeviceProfile, found: &IdentifiedAxis, name: &str) -> usize {
    let [mass, damping, friction, step] = truth(profile, found.axis);
    let numbers = [
        ("mass", found.mass, mass),
        ("damping", found.damping, damping),
        ("friction", found.friction, friction),
    ];
    for (number, estimate, truth) in numbers {
        let error = (estimate.value - truth).abs();
        let allowed = if estimate.is_seen() { 0.1 * truth } else { 2.0 * estimate.error };
        assert!(error <= allowed, "{name} {}: {number} {estimate:?}, is {truth}", found.axis);
    }
    let missed = found.encoder_step.size() / step - 1.0;
    assert!(missed.abs() < 1e-9, "{name} {}: {:?}, is {step}", found.axis, found.encoder_step);
    numbers.iter().filter(|(_, estimate, _)| !estimate.is_seen()).count()
}

/// Identifies devices at two rates, with a seed each, and returns how many numbers are not seen.
fn unseen(plants: impl IntoIterator<Item = Factors> + Clone, rates: &[f64]) -> (usize, usize) {
    let (mut count, mut not_seen) = (0, 0);
    for (i, (name, profile)) in PROFILES.iter().enumerate() {
        for factors in plants.clone() {
            let plant = scaled(profile, factors);
            for (j, rate) in rates.iter().enumerate() {
                let options = IdentifyOptions::new(*rate).with_seed((2 * i + j) as u64);
                let shown = format!("{name} × {factors:?} at {rate} Hz");
                let found = identify(&mut free(plant.clone()), options)
                    .unwrap_or_else(|error| panic!("{shown}: {error}"));
                for axis in &found.axes {
                    not_seen += check(&plant, axis, &shown);
                    count += 3;
                }
            }
        }
    }
    (count, not_seen)
}

#[test]
fn every_profile_is_found() {
    let (count, not_seen) = unseen([[1.0; 4]], &[1000.0, 4000.0]);
    // 16 devices along 2 axes, and 5 with torques about one, at 2 rates, 3 numbers each.
    assert_eq!((count, not_seen), (2 * 3 * (2 * 16 + 5), 0));
}
