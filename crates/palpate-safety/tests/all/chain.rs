// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The safety chain: every stage acts where it must and nowhere else; no wall gives energy out.

use assert_no_alloc::assert_no_alloc;
use palpate_device::DeviceProfile;
use palpate_field::Vector;
use palpate_safety::{
    Acceptance, Impedance, PortState, SafetyChain, SafetyOptions, SafetyReport,
    VelocityEstimator,
};
use palpate_testkit::arbitrary::{unit, vector};
use palpate_testkit::cases::each as cases;

const RATE: f64 = 1000.0;
const PERIOD: f64 = 1e-3;

/// A device with limits that a chain can be made to meet.
fn device() -> DeviceProfile {
    DeviceProfile {
        max_force: 8.0,
        continuous_force: 2.0,
        max_force_rate: 2000.0,
        mass: 0.05,
        least_damping: 0.5,
        ..DeviceProfile::unlimited("example")
    }
}

fn at_once(stiffness: f64) -> SafetyOptions {
    let impedance = Impedance::new(stiffness, 0.0).unwrap();
    let acceptance = Acceptance::AsIs;
    SafetyOptions::new(impedance).with(|s| {
        s.rise_rate = f64::INFINITY;
        s.acceptance = acceptance
    })
}

fn chain(device: &DeviceProfile, options: SafetyOptions) -> SafetyChain {
    SafetyChain::new(device, RATE, options).unwrap()
}

fn at(position: [f64; 3]) -> PortState {
    PortState { position: Vector(position), ..PortState::at_rest() }
}

/// A device of one axis whose motion between ticks is exact: `m x\'\' + c x\' = F`.
struct Plant {
    mass: f64,
    damping: f64,
    x: f64,
    v: f64,
}

impl Plant {
    /// Moves for a time under a constant force.
    fn hold(&mut self, force: f64, time: f64) {
        let end = force / self.damping;
        let left = (-self.damping / self.mass * time).exp();
        self.x += end * time + (self.v - end) * (1.0 - left) * self.mass / self.damping;
        self.v = end + (self.v - end) * left;
    }
}

/// How encoders of a step see a position; without one, as it is.
fn reading(x: f64, encoder_step: f64) -> f64 {
    if encoder_step > 0.0 { (x / encoder_step).round() * encoder_step } else { x }
}

/// What a wall at `x < 0` of a stiffness, on a device held with a grip, does under a push.
struct Wall {
    mass: f64,
    stiffness: f64,
    grip: f64,
    start: f64,
    encoder_step: f64,
    max_force_rate: f64,
    has_control: bool,
}

/// 50 g, three times too stiff, free of steps, pushed from the surface on without a grip.
const TOO_STIFF: Wall = Wall {
    mass: 0.05,
    stiffness: 3000.0,
    grip: 0.0,
    start: 0.0,
    encoder_step: 0.0,
    max_force_rate: f64::INFINITY,
    has_control: true,
};

struct Outcome {
    /// The least of the energy that the wall took from the hand, at any time [J].
    least_balance: f64,
    x: f64,
    v: f64,
    report: SafetyReport,
}

impl Wall {
    /// Ten seconds under a push of 1 N.
    fn press(&self) -> Outcome {
        let device = DeviceProfile {
            mass: self.mass,
            least_damping: 0.5,
            encoder_step: self.encoder_step,
            max_force_rate: self.max_force_rate,
            ..DeviceProfile::unlimited("wall")
        };
        let options =
            at_once(self.stiffness).with(|s| s.has_passivity_control = self.has_control);
        let mut chain = chain(&device, options);
        let mut estimator = VelocityEstimator::new(RATE, self.encoder_step).unwrap();
        let damping = 0.5 + self.grip;
        let mut plant = Plant { mass: self.mass, damping, x: self.start, v: 0.0 };
        let (mut balance, mut least_balance) = (0.0, 0.0_f64);
        for _ in 0..10_000 {
            let seen = reading(plant.x, self.encoder_step);
            let position = Vector([0.0, seen, 0.0]);
            let velocity = estimator.update(position);
            let wanted = Vector([0.0, self.stiffness * (-seen).max(0.0), 0.0]);
            let state = PortState { position, velocity, ..PortState::at_rest() };
            let force = chain.step(wanted, &state).0[1];
            // A tenth of a tick at a time, as the balance may be least between ticks.
            for _ in 0..10 {
                let x = plant.x;
                plant.hold(force - 1.0, PERIOD / 10.0);
                balance -= force * (plant.x - x);
                least_balance = least_balance.min(balance);
            }
        }
        Outcome { least_balance, x: plant.x, v: plant.v, report: chain.report() }
    }
}

fn presses(stiffness: f64, mut check: impl FnMut(&Wall, Outcome)) {
    for mass in [0.05, 0.1] {
        for start in [0.0, 0.001, 0.01, 0.05] {
            for grip in [0.0, 0.5, 2.0, 10.0] {
                let wall = Wall { mass, stiffness, grip, start, ..TOO_STIFF };
                check(&wall, wall.press());
            }
        }
    }
}

#[test]
fn a_wall_three_times_too_stiff_gives_out_at_most_a_millijoule() {
    let mut acted = 0;
    presses(3000.0, |wall, outcome| {
        let least = outcome.least_balance;
        assert!(least >= -1e-3, "{least} J at grip {}, start {}", wall.grip, wall.start);
        // Halved until its oscillation decays, also without a hand: 1 N rests at an eighth.
        assert!(outcome.x > -1.0 / 370.0 && outcome.x < 0.0 && outcome.v.abs() < 0.01);
        // Seen at ticks only, the balance is that of the observer.
        let seen = outcome.report.passivity.least_balance;
        assert!(seen >= least - 1e-12 && seen < least + 2e-5, "{seen} {least}");
        acted += u32::from(outcome.report.passivity.effect.ticks > 0);
    });
    assert!(acted >= 20, "{acted}");
}

#[test]
fn without_control_it_would_give_out_hundreds() {
    let wall = Wall { has_control: false, ..TOO_STIFF };
    assert!(wall.press().least_balance < -0.3);
}

#[test]
fn a_wall_seen_in_steps_gives_out_at_most_a_millijoule_and_holds_the_hand() {
    for encoder_step in [1e-6, 1e-5, 3e-5] {
        for grip in [0.0, 0.5, 2.0, 10.0] {
            for start in [0.0, 0.01, 0.05] {
                let wall = Wall { grip, start, encoder_step, ..TOO_STIFF };
                let Outcome { least_balance, x, v, .. } = wall.press();
                assert!(least_balance >= -1e-3, "{least_balance} J: {encoder_step}, {grip}");
                // Halved twice to be below 2 b / T, the wall has 750 N/m, of which the controller
                // leaves a quarter: 5.3 mm at 1 N, and some steps.
                assert!(
                    x > -5.4e-3 && v.abs() < 0.02,
                    "{x} m, {v} m/s: {encoder_step}, {grip}"
                );
            }
        }
    }
}

#[test]
fn a_millijoule_bounds_a_wall_whose_force_changes_slowly() {
    for (start, max_force_rate) in [(0.0, 300.0), (0.001, 1000.0), (0.01, 3000.0)] {
        for grip in [0.0, 0.5, 2.0, 10.0] {
            let outcome = Wall { grip, start, max_force_rate, ..TOO_STIFF }.press();
            let least = outcome.least_balance;
            assert!(least >= -1e-3, "{least} J: {max_force_rate} N/s, grip {grip}");
            // A force that only the slew limit holds was no number for the observer.
            let seen = outcome.report.passivity.least_balance;
            assert!(seen >= least - 1e-12 && seen < least + 5e-5, "{seen} {least}");
        }
    }
}

#[test]
fn a_passive_wall_is_never_touched() {
    for stiffness in [50.0, 500.0, 900.0] {
        presses(stiffness, |wall, outcome| {
            let effect = outcome.report.passivity.effect;
            assert_eq!(effect.ticks, 0, "at grip {}, start {}", wall.grip, wall.start);
        });
        for encoder_step in [1e-5, 3e-5] {
            let wall = Wall { stiffness, start: 0.01, encoder_step, ..TOO_STIFF };
            assert_eq!(wall.press().report.passivity.effect.ticks, 0);
        }
    }
}

#[test]
fn a_material_that_was_accepted_is_never_touched() {
    for (stiffness, damping) in [(500.0, 1.0), (1000.0, 0.2), (3000.0, 0.5), (100.0, 5.0)] {
        for encoder_step in [0.0, 1e-5, 3e-5] {
            let device = DeviceProfile {
                mass: 0.05,
                least_damping: 0.5,
                encoder_step,
                ..DeviceProfile::unlimited("wall")
            };
            let wanted = SafetyOptions::new(Impedance::new(stiffness, damping).unwrap());
            let mut chain = chain(&device, wanted.with(|s| s.rise_rate = f64::INFINITY));
            let impedance = chain.accepted().impedance;
            let mut estimator = VelocityEstimator::new(RATE, encoder_step).unwrap();
            // A hand of 0.5 N·s/m: without one, a wall of 2 b / T is a spring without loss.
            let mut plant = Plant { mass: 0.05, damping: 1.0, x: 0.01, v: 0.0 };
            for _ in 0..5000 {
                let position = Vector([0.0, reading(plant.x, encoder_step), 0.0]);
                let velocity = estimator.update(position);
                let depth = (-position.0[1]).max(0.0);
                // A spring, and a damper against the approach.
                let approach = if depth > 0.0 { (-velocity.0[1]).max(0.0) } else { 0.0 };
                let push = impedance.stiffness() * depth + impedance.damping() * approach;
                let wanted = Vector([0.0, push, 0.0]);
                let state = PortState { position, velocity, ..PortState::at_rest() };
                let force = chain.step(wanted, &state);
                assert_eq!(force, wanted);
                plant.hold(force.0[1] - 1.0, PERIOD);
            }
            assert!(plant.x < 0.0);
        }
    }
}

#[test]
fn a_stiff_wall_still_feels_like_one() {
    let device =
        DeviceProfile { mass: 0.05, least_damping: 0.5, ..DeviceProfile::unlimited("") };
    let mut chain = chain(&device, at_once(3000.0));
    let mut least = f64::INFINITY;
    for tick in 0..=2000 {
        // To a depth of 2 mm in a second, and held for another.
        let depth = 2e-6 * f64::from(tick.min(1000));
        let speed = if tick < 1000 { -2e-3 } else { 0.0 };
        let state = PortState { velocity: Vector([0.0, speed, 0.0]), ..at([0.0, -depth, 0.0]) };
        let force = chain.step(Vector([0.0, 3000.0 * depth, 0.0]), &state).0[1];
        if tick >= 1000 {
            least = least.min(force);
        }
    }
    assert!(least > 0.7 * 6.0, "{least} N");
}

#[test]
fn a_long_rub_does_not_pay_for_an_oscillation() {
    let device =
        DeviceProfile { mass: 0.05, least_damping: 0.5, ..DeviceProfile::unlimited("") };
    let mut chain = chain(&device, at_once(1000.0));
    // Ten metres against 1 N take 10 J.
    for tick in 0..10_000 {
        let _ = chain.step(Vector([-1.0, 0.0, 0.0]), &at([1e-3 * f64::from(tick), 0.0, 0.0]));
    }
    // Along the way, the same force gives out what its spring, the reserve and the damping of
    // the device, 0.5 N·s/m and a hundredth at 1 m/s over 1 m, allow.
    let (mut x, mut given) = (9.999, 0.0);
    for _ in 0..1000 {
        let state = PortState { velocity: Vector([-1.0, 0.0, 0.0]), ..at([x, 0.0, 0.0]) };
        given += chain.step(Vector([-1.0, 0.0, 0.0]), &state).0[0] * -1e-3;
        x -= 1e-3;
    }
    let allowed = 0.5 / 1000.0 + 1e-4 + 0.505;
    assert!(given <= allowed + 1e-9 && given > 0.4, "{given} J, allowed {allowed} J");
    assert!(chain.report().passivity.energy_in > 9.9);
}

#[test]
fn what_is_placed_inside_a_passive_shape_is_pushed_out_in_full() {
    let device =
        DeviceProfile { mass: 0.05, least_damping: 0.5, ..DeviceProfile::unlimited("") };
    let pushed_out = |is_placed: bool| {
        let mut chain = chain(&device, at_once(500.0));
        let mut plant = Plant { mass: 0.05, damping: 0.5, x: -0.002, v: 0.0 };
        let _ = chain.step(Vector::ZERO, &at([0.0, plant.x, 0.0]));
        for tick in 0..100 {
            let velocity = Vector([0.0, plant.v, 0.0]);
            let start = if is_placed && tick == 0 { 0.0 } else { 1.0 };
            let state = PortState { velocity, start, ..at([0.0, plant.x, 0.0]) };
            let wanted = Vector([0.0, 500.0 * (-plant.x).max(0.0), 0.0]);
            plant.hold(chain.step(wanted, &state).0[1], PERIOD);
        }
        (plant.x > 0.0, chain.report().passivity.effect.ticks)
    };
    assert_eq!(pushed_out(true), (true, 0));
    assert!(pushed_out(false).1 > 0);
}

#[test]
fn where_nothing_is_wrong_nothing_is_changed() {
    let mut chain = chain(
        &device(),
        at_once(500.0).with(|s| (s.acceptance, s.is_strict) = (Acceptance::Passive, true)),
    );
    for tick in 0..2000 {
        let depth = 1e-3 * (1.0 - (0.01 * f64::from(tick)).cos());
        let wanted = Vector([0.3, 0.7, -0.2]) * (500.0 * depth);
        let state = at([-0.3 * depth, -0.7 * depth, 0.2 * depth]);
        assert_eq!(chain.step(wanted, &state), wanted);
    }
    let report = chain.report();
    let accepted = &report.impedance;
    assert_eq!((accepted.stiffness_factor, accepted.stiffness_rule), (1.0, None));
    let idle = [
        report.passivity.effect,
        report.slew,
        report.force_limit,
        report.continuous.effect,
        report.guard,
        report.ramp,
        report.watchdog.effect,
        report.emergency_stop,
    ];
    assert!(idle.iter().all(|effect| effect.ticks == 0 && effect.largest == 0.0));
}

#[test]
fn every_stage_can_be_made_to_act() {
    let options = SafetyOptions::new(Impedance::default()).with(|s| s.rise_rate = 100.0);
    let impedance = Impedance::new(4000.0, 0.0).unwrap();
    // The controller would not let a force rise that far on a hand at rest.
    let stiff =
        SafetyOptions { impedance, ..options }.with(|s| s.has_passivity_control = false);
    let mut chain = chain(&device(), stiff.with(|s| s.acceptance = Acceptance::Passive));
    assert_eq!(chain.report().impedance.stiffness_factor, 0.25);
    let mut run = |ticks: u32, force: [f64; 3], state: PortState| {
        (0..ticks).map(|_| chain.step(Vector(force), &state)).last().unwrap()
    };
    // The start's ramp; the slew limit; the largest force; then the continuous one.
    assert_eq!(run(1, [0.0, 1.0, 0.0], at([0.0, 0.0, 0.0])), Vector([0.0, 0.1, 0.0]));
    assert_eq!(run(20, [0.0, 1.0, 0.0], at([0.0, 0.0, 0.0])), Vector([0.0, 1.0, 0.0]));
    assert_eq!(run(20, [6.0, 8.0, 0.0], at([0.0, 0.0, 0.0])), Vector([4.8, 6.4, 0.0]));
    assert!(run(20_000, [6.0, 8.0, 0.0], at([0.0, 0.0, 0.0])).norm() < 2.2);
    // The guard; the watchdog; the emergency stop.
    assert_eq!(run(1, [1.0, f64::NAN, 0.0], at([0.0, 0.0, 0.0])), Vector::ZERO);
    let late = PortState { late: 2.0 * PERIOD, ..at([0.0, 0.0, 0.0]) };
    assert_eq!(run(50, [1.0, 0.0, 0.0], late), Vector::ZERO);
    assert_eq!(run(50, [1.0, 0.0, 0.0], at([0.0, 0.0, 0.0])), Vector([1.0, 0.0, 0.0]));
    chain.stop();
    assert!(chain.is_stopped());
    assert_eq!(chain.step(Vector([1.0, 0.0, 0.0]), &at([0.0, 0.0, 0.0])), Vector::ZERO);
    chain.release();
    let rising = chain.step(Vector([1.0, 0.0, 0.0]), &at([0.0, 0.0, 0.0])).0[0];
    assert!(rising > 0.0 && rising <= 0.1);

    let report = chain.report();
    let acted = [
        report.slew,
        report.force_limit,
        report.continuous.effect,
        report.ramp,
        report.watchdog.effect,
        report.emergency_stop,
    ];
    assert!(acted.iter().all(|effect| effect.ticks > 0 && effect.largest > 0.0), "{report:#?}");
    assert_eq!((report.guard.ticks, report.watchdog.trips, report.stops), (1, 1, 1));
}

/// Once the force limit made zero of a force that was no number, and the next one kicked.
#[test]
fn what_is_no_number_is_guarded_before_it_is_cut_and_the_force_rises_again() {
    let options = SafetyOptions::new(Impedance::default()).with(|s| s.rise_rate = 20.0);
    let mut chain = chain(&device(), options);
    let state = at([0.0, 0.0, 0.0]);
    let mut step = |y: f64| chain.step_within(Vector([0.0, y, 0.0]), 8.0, &state).0[1];
    (0..100).for_each(|_| assert!(step(1.0) <= 1.0));
    assert_eq!(step(f64::NAN), 0.0);
    assert!((step(1.0) - 0.02).abs() < 1e-12);
    assert_eq!(chain.report().guard.ticks, 1);
}

#[test]
fn whatever_comes_in_the_force_is_finite_and_within_every_limit() {
    let wild = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e308, 1e-308];
    cases(60, |u| {
        let device = device();
        let impedance = Impedance::new(f64::from(u.int_in_range(1..=5000)?), 0.0).unwrap();
        let options = SafetyOptions::new(impedance).with(|s| s.rise_rate = 200.0);
        let acceptance =
            *u.choose(&[Acceptance::Passive, Acceptance::Device, Acceptance::AsIs])?;
        let mut chain = chain(&device, options.with(|s| s.acceptance = acceptance));
        let mut last = Vector::ZERO;
        for _ in 0..150 {
            let mut wanted = vector(u)? * 20.0;
            let mut state = at((vector::<3>(u)? * 0.01).0);
            state.velocity = vector(u)?;
            state.late = if u.ratio(1, 3)? { 0.01 * unit(u)? } else { 0.0 };
            state.start = if u.ratio(1, 50)? { *u.choose(&wild)? } else { 1.0 };
            state.elapsed = if u.ratio(1, 3)? { Some(*u.choose(&wild)?) } else { None };
            if u.ratio(1, 10)? {
                let (axis, value) = (u.int_in_range(0..=2)?, *u.choose(&wild)?);
                match u.int_in_range(0..=2)? {
                    0 => wanted.0[axis] = value,
                    1 => state.position.0[axis] = value,
                    _ => state.velocity.0[axis] = value,
                }
            }
            if u.ratio(1, 50)? {
                chain.stop();
            }
            let guarded = chain.report().guard.ticks;
            let force = if u.arbitrary()? {
                chain.step(wanted, &state)
            } else {
                chain.step_within(wanted, device.max_force, &state)
            };
            let excepted = chain.is_stopped() || chain.report().guard.ticks > guarded;
            assert!(force.is_finite() && force.norm() <= device.max_force * (1.0 + 1e-12));
            let change = (force - last).norm();
            assert!(
                change <= device.max_force_rate * PERIOD * (1.0 + 1e-12)
                    || excepted && force == Vector::ZERO,
                "{change} N"
            );
            last = force;
            if u.ratio(1, 2)? {
                chain.release();
            }
        }
        Ok(())
    });
}

#[test]
fn a_step_allocates_and_frees_nothing() {
    let mut chain = chain(&device(), at_once(3000.0));
    let mut estimator = VelocityEstimator::new(RATE, 1e-5).unwrap();
    for tick in 0..5000 {
        let position = Vector([0.0, 0.01 * (0.01 * f64::from(tick)).sin(), 0.0]);
        assert_no_alloc(|| {
            let velocity = estimator.update(position);
            let wanted = Vector([0.0, -3000.0 * position.0[1].min(0.0), 0.0]);
            let state = PortState { position, velocity, ..PortState::at_rest() };
            assert!(chain.step(wanted, &state).is_finite());
        });
    }
}

#[test]
fn wrong_numbers_are_named() {
    let options = SafetyOptions::new(Impedance::default());
    let refuses = |device: DeviceProfile, options: SafetyOptions| {
        SafetyChain::new(&device, RATE, options).unwrap_err().to_string()
    };
    let fine = DeviceProfile::unlimited("fine");
    assert_eq!(
        refuses(DeviceProfile { max_force: 0.0, ..fine.clone() }, options),
        "max_force must be positive, got 0 N"
    );
    assert_eq!(
        refuses(fine.clone(), options.with(|s| s.reserve = f64::NAN)),
        "reserve must be zero or more and finite, got NaN J"
    );
    let weak = DeviceProfile { least_damping: 0.1, ..fine.clone() };
    let strict = options.with(|s| s.is_strict = true);
    let stated = DeviceProfile { max_stiffness: 1000.0, ..weak.clone() };
    assert!(refuses(stated, strict).ends_with("B ≤ b − K T / 2"));
    assert!(
        refuses(weak, strict.with(|s| s.acceptance = Acceptance::Passive))
            .ends_with("K ≤ 2 b / T")
    );
    assert!(SafetyChain::new(&fine, f64::INFINITY, options).is_err());
}
