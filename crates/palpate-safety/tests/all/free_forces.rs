// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Forces of guides at the limits of the device.

use std::f64::consts::TAU;

use palpate_device::DeviceProfile;
use palpate_field::Vector;
use palpate_safety::{Impedance, PortState, SafetyChain, SafetyOptions};

const RATE: f64 = 1000.0;

/// A guide towards the origin along y [N/m], beside a wall that gives a force along x [N].
const GUIDE: f64 = 200.0;

fn device() -> DeviceProfile {
    DeviceProfile { least_damping: 0.5, mass: 0.2, ..DeviceProfile::unlimited("test") }
}

fn chain(device: &DeviceProfile) -> SafetyChain {
    let options = SafetyOptions::new(Impedance::new(1.0, 0.0).unwrap());
    SafetyChain::new(device, RATE, options).unwrap()
}

/// The guide's written force in a tick of a hand at `y`.
fn guided(chain: &mut SafetyChain, wall: f64, y: f64) -> f64 {
    let state = PortState {
        position: Vector([0.0, y, 0.0]),
        free_force: Vector([0.0, -GUIDE * y, 0.0]),
        ..PortState::at_rest()
    };
    -chain.step(Vector([wall, 0.0, 0.0]), &state)[1]
}

/// Once a hand that moved away from the middle while the motors were hot seemed to be given what
/// the limit took, and the guide faded to nothing.
#[test]
fn a_guide_at_the_continuous_limit_keeps_it() {
    let device = DeviceProfile { max_force: 12.0, continuous_force: 4.0, ..device() };
    let mut chain = chain(&device);
    for tick in 0..60_000_u32 {
        let time = f64::from(tick) / RATE;
        let y = 0.03 + 0.005 * (0.25 * TAU * time).sin();
        let force = guided(&mut chain, 0.0, y);
        assert!(time < 2.0 || force > 3.9, "{force} N at {time} s");
    }
    assert_eq!(chain.report().free_forces.effect.ticks, 0);
}

/// Likewise beside a wall that takes what the device gives.
#[test]
fn a_guide_beside_a_wall_at_the_force_limit_keeps_its_share() {
    let mut chain = chain(&DeviceProfile { max_force: 12.0, ..device() });
    for tick in 0..60_000_u32 {
        let time = f64::from(tick) / RATE;
        let y = 0.02 * (0.25 * TAU * time).sin();
        let force = guided(&mut chain, 12.0, y);
        let share = 12.0 / 12.0_f64.hypot(GUIDE * y);
        assert!(
            time < 2.0 || (force - share * GUIDE * y).abs() < 1e-6,
            "{force} N at {time} s"
        );
    }
    assert_eq!(chain.report().free_forces.effect.ticks, 0);
}

/// Once it was one where damping is zero, which made a bound of the losses no number, and a panic.
#[test]
fn a_jump_whose_square_overflows_is_no_panic() {
    let mut chain =
        chain(&DeviceProfile { least_damping: 0.0, max_stiffness: 1000.0, ..device() });
    for y in [0.0, 1e200, -1e200, 0.0] {
        let state = PortState {
            position: Vector([0.0, y, 0.0]),
            free_force: Vector([0.0, -1.0, 0.0]),
            ..PortState::at_rest()
        };
        assert!(chain.step(Vector::ZERO, &state).is_finite());
    }
}

/// Once the rounding of a guide at the force limit counted as a force of bodies, so that what the
/// slew limit held of the guide did too.
#[test]
fn a_guide_at_the_force_limit_is_no_body_after_a_touch() {
    let energy = |touched: f64| {
        let device = DeviceProfile {
            max_force_rate: 1000.0,
            ..DeviceProfile { max_force: 3.0, ..device() }
        };
        let mut chain = chain(&device);
        let mut step = |wanted: [f64; 3], free: [f64; 3], y: f64| {
            let state = PortState {
                position: Vector([0.0, y, 0.0]),
                free_force: Vector(free),
                ..PortState::at_rest()
            };
            let _ = chain.step(Vector(wanted), &state);
        };
        step([touched, 0.0, 0.0], [1.7, 5.1, 0.0], 0.0);
        (0..500).for_each(|_| step([0.0; 3], [1.7, 5.1, 0.0], 0.0));
        (0..20).for_each(|tick| step([0.0; 3], [0.0; 3], 1e-3 * f64::from(tick)));
        chain.report().passivity.energy_out
    };
    assert_eq!(energy(1e-3), energy(0.0));
}

/// Once each lift waited twice as long as the one before for the rest of a session.
#[test]
fn a_guide_comes_back_as_soon_after_many_disturbances() {
    let mut chain =
        chain(&DeviceProfile { least_damping: 0.0, max_stiffness: 1000.0, ..device() });
    let waits: Vec<_> = (0..6)
        .map(|_| {
            // A force that turns with the motion takes it away.
            for tick in 0..400 {
                guided(&mut chain, 0.0, if tick % 2 == 0 { 0.02 } else { 0.01 });
            }
            let waited = (0..60_000).find(|_| guided(&mut chain, 0.0, 0.01) > 0.5);
            (0..60_000).for_each(|_| {
                guided(&mut chain, 0.0, 0.01);
            });
            waited.unwrap()
        })
        .collect();
    assert!(waits.iter().all(|wait| *wait < 1000), "{waits:?}");
}
