// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The simulated motion against a thousand tiny steps, and against closed forms; its energies.

use palpate_device::{Device, DeviceProfile, PointState};
use palpate_field::Vector;
use palpate_sim::{Energies, Hand, HandPath, Interpolation, SimulatedDevice};

/// One axis: device, hand, a path in straight pieces of a tick, and a force for each tick.
#[derive(Clone, Copy, Debug)]
struct Case {
    mass: f64,
    damping: f64,
    friction: f64,
    grip: (f64, f64),
    push: f64,
}

const TICK: f64 = 1e-3;
const TICKS: usize = 200;

/// The hand's place at a tick [m]: a slow wave and a faster, smaller one.
fn target(tick: usize) -> f64 {
    let t = tick as f64 * TICK;
    0.01 * (1.0 - (20.0 * t).cos()) + 0.002 * (90.0 * t).sin()
}

/// The servo's force in the tick after `tick` [N]: steps up and down.
fn force(tick: usize) -> f64 {
    1.5 * (0.9 * tick as f64).sin() + if tick % 50 > 25 { 0.8 } else { 0.0 }
}

/// The device of a case in the plane, at rest along y.
fn device(case: &Case) -> SimulatedDevice {
    let profile = DeviceProfile {
        mass: case.mass,
        least_damping: case.damping,
        friction: case.friction,
        ..DeviceProfile::unlimited("case")
    };
    let times = (0..=TICKS).map(|tick| tick as f64 * TICK).collect();
    let places = (0..=TICKS).map(|tick| Vector([target(tick), 0.0, 0.0])).collect();
    let path = HandPath::new(times, places, Interpolation::Linear).unwrap();
    let hand = Hand::new(path).with_mass(0.02).unwrap();
    let hand = hand.with_spring(case.grip.0, case.grip.1).unwrap();
    let hand = hand.with_push(Vector([case.push, 0.0, 0.0])).unwrap();
    SimulatedDevice::new(profile, vec![hand]).unwrap()
}

/// Runs a case tick by tick; calls `see` with every tick's true state.
fn simulated(case: &Case, mut see: impl FnMut(usize, f64, f64, &SimulatedDevice)) {
    let mut device = device(case);
    let mut points = [PointState::at_rest(Vector::ZERO)];
    for tick in 0..=TICKS {
        device.read(tick as f64 * TICK, &mut points).unwrap();
        let state = device.states().next().unwrap();
        assert_eq!((state.position[1], state.velocity[1]), (0.0, 0.0));
        see(tick, state.position[0], state.velocity[0], &device);
        device.write(&[Vector([force(tick), 0.0, 0.0])]).unwrap();
    }
}

/// The oracle's state: position, velocity, work of servo and hand, losses to damping and
/// friction.
type Oracle = [f64; 6];

/// A step of Runge and Kutta of order 4. Within it friction keeps its sign.
fn runge_kutta(state: Oracle, step: f64, slope: impl Fn(f64, &Oracle) -> Oracle) -> Oracle {
    let along = |from: &Oracle, slope: &Oracle, part: f64| {
        std::array::from_fn(|i| from[i] + slope[i] * part)
    };
    let first = slope(0.0, &state);
    let second = slope(0.5 * step, &along(&state, &first, 0.5 * step));
    let third = slope(0.5 * step, &along(&state, &second, 0.5 * step));
    let fourth = slope(step, &along(&state, &third, step));
    std::array::from_fn(|i| {
        let mean = first[i] + 2.0 * second[i] + 2.0 * third[i] + fourth[i];
        state[i] + mean * step / 6.0
    })
}

/// A tick of the oracle in `steps`. A step in which the velocity changes its sign ends where the
/// line between its velocities does, which is off by the square of the step.
fn oracle_tick(case: &Case, tick: usize, mut state: Oracle, steps: usize) -> Oracle {
    let step = TICK / steps as f64;
    let mass = case.mass + 0.02;
    let (start, end) = (target(tick), target(tick + 1));
    let hand_velocity = (end - start) / TICK;
    let mut since = 0.0;
    while since < TICK - 1e-6 * step {
        let pull = |time: f64, [x, v, ..]: &Oracle| {
            let stretch = start + hand_velocity * (since + time) - x;
            let hand = case.push + case.grip.0 * stretch + case.grip.1 * (hand_velocity - v);
            (hand, force(tick) + hand)
        };
        let (_, all) = pull(0.0, &state);
        let mut length = step.min(TICK - since);
        if state[1] == 0.0 && all.abs() <= case.friction {
            since += length;
            continue;
        }
        let sign = if state[1] == 0.0 { all.signum() } else { state[1].signum() };
        let slope = |time: f64, state: &Oracle| {
            let (hand, all) = pull(time, state);
            let v = state[1];
            let viscous = case.damping * v;
            let acceleration = (all - viscous - sign * case.friction) / mass;
            [v, acceleration, force(tick) * v, hand * v, viscous * v, sign * case.friction * v]
        };
        let mut next = runge_kutta(state, length, slope);
        if case.friction > 0.0 && state[1] != 0.0 && next[1] * sign < 0.0 {
            length *= state[1] / (state[1] - next[1]);
            next = runge_kutta(state, length, slope);
            next[1] = 0.0;
        }
        state = next;
        since += length;
    }
    state
}

/// Compares positions, velocities and energies with the oracle's at every tick.
fn agrees_with_the_oracle(case: &Case, steps: usize, tolerance: f64) {
    let mut oracle = [target(0), 0.0, 0.0, 0.0, 0.0, 0.0];
    simulated(case, |tick, position, velocity, device| {
        let Energies { servo, hand, viscous, friction } = device.energies();
        let state = [position, velocity, servo, hand, viscous, friction];
        for (found, expected) in state.iter().zip(oracle) {
            assert!(
                (found - expected).abs() <= tolerance,
                "{case:?}, tick {tick}: {found} is not {expected}; {state:?}"
            );
        }
        if tick < TICKS {
            oracle = oracle_tick(case, tick, oracle, steps);
        }
    });
}

/// Without friction: under-damped, critical, over-damped, no spring, only a push, nothing at
/// all, and a grip so stiff that a tick takes several pieces.
const SMOOTH: [Case; 7] = [
    Case { mass: 0.08, damping: 0.5, friction: 0.0, grip: (300.0, 5.0), push: 0.3 },
    Case { mass: 0.08, damping: 2.0, friction: 0.0, grip: (40.0, 2.0), push: 0.3 },
    Case { mass: 0.08, damping: 30.0, friction: 0.0, grip: (100.0, 10.0), push: 0.0 },
    Case { mass: 0.08, damping: 0.5, friction: 0.0, grip: (0.0, 5.0), push: -0.2 },
    Case { mass: 0.05, damping: 0.5, friction: 0.0, grip: (0.0, 0.0), push: -1.0 },
    Case { mass: 0.05, damping: 0.0, friction: 0.0, grip: (0.0, 0.0), push: 0.0 },
    Case { mass: 0.03, damping: 5.0, friction: 0.0, grip: (5e5, 100.0), push: 0.0 },
];

/// With friction: sliding, sticking now and then, at each of the regimes; stuck for good.
const ROUGH: [Case; 5] = [
    Case { mass: 0.08, damping: 0.5, friction: 0.3, grip: (300.0, 5.0), push: 0.3 },
    Case { mass: 0.08, damping: 2.0, friction: 0.9, grip: (40.0, 2.0), push: 0.0 },
    Case { mass: 0.08, damping: 30.0, friction: 0.2, grip: (100.0, 10.0), push: 0.0 },
    Case { mass: 0.05, damping: 0.5, friction: 0.6, grip: (0.0, 0.0), push: 0.0 },
    Case { mass: 0.05, damping: 0.0, friction: 9.0, grip: (10.0, 1.0), push: 0.0 },
];

#[test]
fn motion_without_friction_is_that_of_tiny_steps() {
    for case in &SMOOTH {
        agrees_with_the_oracle(case, 512, 1e-11);
    }
}

#[test]
fn motion_with_friction_is_that_of_tiny_steps() {
    for case in &ROUGH {
        // The oracle lets go at the end of a step, up to 0.5 µs late; the force grows by up to
        // 100 N/s, on 0.07 kg or more: 2e-10 m/s each time.
        agrees_with_the_oracle(case, 2048, 1e-9);
    }
}

#[test]
fn friction_sticks_and_lets_go() {
    let mut stuck_ticks = 0;
    let mut last = f64::NAN;
    simulated(&ROUGH[1], |_, position, velocity, _| {
        stuck_ticks += usize::from(velocity == 0.0 && position == last);
        last = position;
    });
    assert!((10..TICKS - 10).contains(&stuck_ticks), "{stuck_ticks}");
    simulated(&ROUGH[4], |_, position, velocity, device| {
        assert_eq!((position, velocity), (target(0), 0.0));
        assert_eq!(device.energies(), Energies::default());
    });
}

#[test]
fn energies_balance_to_twelve_digits() {
    for case in SMOOTH.iter().chain(&ROUGH) {
        // What went back and forth leaves its rounding.
        let mut turned_over = 0.0;
        let mut last = Energies::default();
        simulated(case, |tick, _, _, device| {
            let energies = device.energies();
            let kinetic = device.kinetic_energy();
            turned_over +=
                (energies.servo - last.servo).abs() + (energies.hand - last.hand).abs();
            last = energies;
            let missing = (energies.balance() - kinetic).abs();
            assert!(missing <= 1e-12 * turned_over, "{case:?}, tick {tick}: {missing}");
            assert!(energies.viscous >= 0.0 && energies.friction >= 0.0);
            assert_eq!(device.energy_given(), energies.servo);
        });
    }
}

#[test]
fn a_sliding_mass_stops_where_friction_has_taken_its_energy() {
    // 1 N on 0.5 kg for 0.1 s against 0.5 N: 0.1 m/s after 5 mm; then 0.5 N stops it in 5 mm.
    let profile = DeviceProfile {
        mass: 0.5,
        least_damping: 0.0,
        friction: 0.5,
        ..DeviceProfile::unlimited("slider")
    };
    let hand = Hand::resting(Vector([0.0, 0.0, 0.0])).unwrap().with_mass(0.0).unwrap();
    let hand = hand.with_spring(0.0, 0.0).unwrap();
    let mut device = SimulatedDevice::new(profile, vec![hand]).unwrap();
    let mut points = [PointState::at_rest(Vector::ZERO)];
    device.read(0.0, &mut points).unwrap();
    device.write(&[Vector([1.0, 0.0, 0.0])]).unwrap();
    device.read(0.1, &mut points).unwrap();
    assert!((points[0].position - Vector([0.005, 0.0, 0.0])).norm() < 1e-16);
    device.write(&[Vector::ZERO]).unwrap();
    for time in [0.15, 0.25, 9.0] {
        device.read(time, &mut points).unwrap();
    }
    assert!((points[0].position - Vector([0.01, 0.0, 0.0])).norm() < 1e-15);
    assert_eq!(device.kinetic_energy(), 0.0);
    let energies = device.energies();
    assert!(
        (energies.servo - 0.005).abs() < 1e-16 && (energies.friction - 0.005).abs() < 1e-16
    );
}

#[test]
fn a_hand_draws_the_device_along_its_path() {
    let path = HandPath::new(
        vec![0.0, 1.0, 2.0],
        vec![Vector([0.0, 0.1, 0.0]), Vector([0.2, 0.0, -0.1]), Vector([0.2, 0.0, -0.1])],
        Interpolation::Smooth,
    );
    let path = path.unwrap();
    let profile = palpate_device::profile_named("omni").unwrap();
    let (damping, friction) = (profile.least_damping, profile.friction);
    let hand = Hand::new(path.clone());
    let stiffness = hand.stiffness();
    let mut device = SimulatedDevice::new(profile, vec![hand]).unwrap();
    let mut points = [PointState::at_rest(Vector::ZERO)];
    for tick in 0..=3000 {
        let time = f64::from(tick) * TICK;
        device.read(time, &mut points).unwrap();
        let wanted = path.state_at(time);
        // What damping, friction and inertia stretch the grip by; the last of 0.15 kg at 2 m/s².
        let bound =
            (damping * wanted.velocity.norm() + 3.0_f64.sqrt() * friction + 0.3) / stiffness;
        let behind = (points[0].position - wanted.position).norm();
        assert!(behind < 2.0 * bound, "{time} s: {behind} m");
    }
}
