// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Simulated devices that turn: their motion and energies, and tools on them, stable as theory
//! says.

use palpate_device::{Device, DeviceProfile, PointState, TurnState, TurningProfile};
use palpate_field::kernel::HalfSpace;
use palpate_field::{Rotation, Shape, Vector};
use palpate_haptics::{
    Bodies, Body, Protection, Servo, ServoOptions, Shell, Surface, Tool, ToolOptions,
    Unprotected,
};
use palpate_safety::Acceptance;
use palpate_sim::{Hand, HandPath, Interpolation, SimulatedDevice};

const PERIOD: f64 = 1e-3;

/// `b T / I` of the tests: small, so that 2b/T is the threshold to within as much.
const DAMPING_PER_TICK: f64 = 0.02;

/// [N·m·s/rad]
const DAMPING: f64 = 1e-3;

/// A device without friction and steps, that moves and turns.
fn profile() -> DeviceProfile {
    DeviceProfile {
        mass: 0.05,
        least_damping: 1.0,
        friction: 0.0,
        turning: Some(TurningProfile {
            inertia: DAMPING * PERIOD / DAMPING_PER_TICK,
            least_damping: DAMPING,
            friction: 0.0,
            ..TurningProfile::unlimited()
        }),
        ..DeviceProfile::unlimited("smooth")
    }
}

fn with_turning(change: impl FnOnce(&mut TurningProfile)) -> DeviceProfile {
    let mut turning = profile().turning.unwrap();
    change(&mut turning);
    DeviceProfile { turning: Some(turning), ..profile() }
}

/// A hand that lets go of the device: nothing but what is said.
fn free() -> Hand {
    let hand = Hand::resting(Vector::ZERO).unwrap().with_mass(0.0).unwrap();
    let hand = hand.with_spring(0.0, 0.0).unwrap().with_inertia(0.0).unwrap();
    hand.with_angular_spring(0.0, 0.0).unwrap()
}

fn held_at(turn: Vector<f64, 3>) -> HandPath {
    HandPath::new(vec![0.0, 1.0], vec![turn; 2], Interpolation::Linear).unwrap()
}

fn read(device: &mut SimulatedDevice, time: f64) -> TurnState {
    device.read(time, &mut [PointState::at_rest(Vector::ZERO)]).unwrap();
    device.read_turn().unwrap().unwrap()
}

#[test]
fn a_torque_turns_what_is_free_by_half_of_it_over_the_inertia_and_the_time_squared() {
    let profile = with_turning(|turning| {
        turning.inertia = 0.5;
        turning.least_damping = 0.0;
    });
    let axis = Vector([0.6, 0.0, -0.8]);
    let mut device = SimulatedDevice::new(profile, vec![free()]).unwrap();
    read(&mut device, 0.0);
    device.write_torque(axis).unwrap();
    let turn = read(&mut device, 0.5);
    let expected = Rotation::identity().turned(axis * 0.25);
    assert!(expected.turn_to(&turn.orientation).norm() < 1e-15);
    let state = device.turn().unwrap();
    assert!((state.angular_velocity - axis).norm() < 1e-15);
    assert!((device.kinetic_energy() - 0.25).abs() < 1e-15);
    assert!((device.energy_given() - 0.25).abs() < 1e-15);
}

/// Turning is to angles what moving is to lengths, friction and steps of the hand included.
#[test]
fn what_turns_in_the_plane_moves_as_what_goes_along_an_axis() {
    let samples = [0.0, 0.02, -0.05, 0.01, 0.04];
    let times: Vec<_> = (0..samples.len()).map(|i| 0.05 * i as f64).collect();
    let path = |at: fn(f64) -> Vector<f64, 3>| {
        let places = samples.iter().map(|x| at(*x)).collect();
        HandPath::new(times.clone(), places, Interpolation::Smooth).unwrap()
    };
    let along = HandPath::new(
        times.clone(),
        samples.map(|x| Vector([x, 0.0, 0.0])).to_vec(),
        Interpolation::Smooth,
    );
    let profile = DeviceProfile {
        mass: 2e-3,
        least_damping: 3e-3,
        friction: 0.015,
        ..with_turning(|turning| {
            turning.inertia = 2e-3;
            turning.least_damping = 3e-3;
            turning.friction = 0.015;
        })
    };
    let hand = Hand::new(along.unwrap()).with_turns(path(|x| Vector([0.0, 0.0, x])));
    let hand = hand.with_mass(1e-3).unwrap().with_inertia(1e-3).unwrap();
    let hand = hand.with_spring(2.0, 0.05).unwrap().with_angular_spring(2.0, 0.05).unwrap();
    let hand = hand.with_push(Vector([0.01, 0.0, 0.0])).unwrap();
    let hand = hand.with_torque(Vector([0.0, 0.0, 0.01])).unwrap();
    let mut device = SimulatedDevice::new(profile, vec![hand]).unwrap();
    let mut stuck = 0;
    for tick in 0..300 {
        let turn = read(&mut device, f64::from(tick) * PERIOD);
        let state = device.states().next().unwrap();
        assert!(
            (Rotation::identity().turn_to(&turn.orientation)[2] - state.position[0]).abs()
                < 1e-13,
            "{tick}"
        );
        let spin = device.turn().unwrap().angular_velocity;
        assert_eq!((spin[0], spin[1]), (0.0, 0.0));
        assert!((spin[2] - state.velocity[0]).abs() < 1e-11, "{tick}");
        stuck += u32::from(spin[2] == 0.0);
        let force = 0.02 * (0.1 * f64::from(tick)).sin();
        device.write(&[Vector([force, 0.0, 0.0])]).unwrap();
        device.write_torque(Vector([0.0, 0.0, force])).unwrap();
    }
    assert!((5..200).contains(&stuck), "{stuck}");
}

#[test]
fn the_work_of_torques_is_seen_and_every_energy_is_accounted_for() {
    let turns = vec![Vector::ZERO, Vector([1.0, 0.3, -0.5]), Vector([-0.4, 1.2, 0.7])];
    let turns = HandPath::new(vec![0.0, 0.6, 1.2], turns, Interpolation::Smooth).unwrap();
    let hand = Hand::resting(Vector([0.01, -0.02, 0.03])).unwrap().with_turns(turns);
    let profile = with_turning(|turning| turning.friction = 2e-3);
    let mut device = SimulatedDevice::new(profile, vec![hand]).unwrap();
    let (mut seen, mut last, mut torque) = (0.0, None::<Rotation<3>>, Vector::ZERO);
    for tick in 0..2000 {
        let t = f64::from(tick) * PERIOD;
        let turn = read(&mut device, t).orientation;
        if let Some(last) = last {
            seen += last.turn_to(&turn).dot(torque);
        }
        let energies = device.energies();
        assert!((energies.servo - seen).abs() < 1e-12, "{tick}: {energies:?}, {seen} J");
        assert!((device.kinetic_energy() - energies.balance()).abs() < 1e-12, "{tick}");
        torque = Vector([(9.0 * t).sin(), (13.0 * t).cos(), -(7.0 * t).sin()]) * 0.05;
        device.write_torque(torque).unwrap();
        last = Some(turn);
    }
    assert!(device.energies().friction > 1e-4 && seen.abs() > 1e-4);
}

#[test]
fn turns_come_in_steps_and_torques_are_cut() {
    let profile = with_turning(|turning| {
        turning.encoder_step = 0.01;
        turning.max_torque = 0.25;
    });
    let hand = free().with_turns(held_at(Vector([0.0, 0.104, -0.003])));
    let mut device = SimulatedDevice::new(profile, vec![hand]).unwrap();
    let turn = read(&mut device, 0.0).orientation;
    let steps = Rotation::identity().turn_to(&turn) * 100.0;
    assert!((steps - Vector([0.0, 10.0, 0.0])).norm() < 1e-12);
    for (written, expected) in [
        ([0.3, 0.0, -0.4], [0.15, 0.0, -0.2]),
        ([0.1, 0.1, 0.1], [0.1, 0.1, 0.1]),
        ([f64::NAN, 1.0, 0.0], [0.0; 3]),
        ([f64::INFINITY, 1.0, 0.0], [0.0; 3]),
    ] {
        device.write_torque(Vector(written)).unwrap();
        assert!((device.torque() - Vector(expected)).norm() < 1e-15);
    }
}

#[test]
fn wrong_wrists_are_refused_and_several_hands_turn_nothing() {
    let refused = |change: fn(&mut TurningProfile)| {
        let device = SimulatedDevice::new(with_turning(change), vec![free()]);
        device.unwrap_err().to_string()
    };
    assert_eq!(
        refused(|t| t.inertia = -1.0),
        "inertia must be zero or more and finite, got -1 kg·m²"
    );
    assert!(refused(|t| t.inertia = 0.0).starts_with("inertia of device and hand must be"));
    assert!(refused(|t| t.least_damping = f64::INFINITY).starts_with("turning least_damping"));
    assert!(refused(|t| t.max_torque = f64::NAN).starts_with("max_torque"));
    assert!(refused(|t| t.encoder_step = -1.0).starts_with("turning encoder_step"));
    let mut pair = SimulatedDevice::new(profile(), vec![free(), free()]).unwrap();
    assert_eq!(pair.read_turn().unwrap(), None);
}

/// A rod along x of two points, 5 cm to each side, on a coupling.
fn on_ground(stiffness: f64, angular: f64) -> Servo<Unprotected> {
    let end = Vector::unit(0) * 0.05;
    let options = ToolOptions {
        stiffness,
        angular_stiffness: Some(angular),
        damping: 0.0,
        max_force: Some(f64::INFINITY),
        max_torque: f64::INFINITY,
        rise_time: 1e-9,
        ..ToolOptions::default()
    };
    let tool = Tool::new(Shell::capsule([-end, end], 1e-4, 2).unwrap(), options).unwrap();
    let wall = Shape::from_kernel(HalfSpace::new(Vector::<f64, 3>::unit(1), -1e-4).unwrap());
    let body = Body::new(wall, Surface::smooth(1e6, 0.0).unwrap()).unwrap();
    let options = ServoOptions {
        rate: 1.0 / PERIOD,
        max_force: f64::INFINITY,
        ..ServoOptions::default()
    };
    let mut servo = Servo::with_tool(Bodies::new(vec![body]).unwrap(), tool, options).unwrap();
    servo.step(&[PointState::at_rest(Vector::unit(1) * 0.01)]);
    servo
}

/// A rod held flat on the ground by its ends, and a device that turns it.
struct Flat {
    device: SimulatedDevice,
    servo: Servo<Unprotected>,
    tick: u32,
}

impl Flat {
    fn new(angular: f64, hand: Hand) -> Self {
        let device = SimulatedDevice::new(profile(), vec![hand]).unwrap();
        Self { device, servo: on_ground(500.0, angular), tick: 0 }
    }

    /// The span of the device's angle about z during the next `ticks` [rad].
    fn span(&mut self, ticks: u32) -> f64 {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..ticks {
            let turn = read(&mut self.device, f64::from(self.tick) * PERIOD);
            self.servo.set_turn(Some(turn));
            // Pressed by 2 cm: 10 N, of which each end bears half.
            self.servo.step(&[PointState::at_rest(Vector::unit(1) * -0.02)]);
            self.device.write_torque(self.servo.torque()).unwrap();
            self.tick += 1;
            let angle = Rotation::identity().turn_to(&turn.orientation)[2];
            (low, high) = (low.min(angle), high.max(angle));
        }
        high - low
    }

    /// `true` if a small oscillation dies away.
    fn settles(angular: f64) -> bool {
        let hand = free().with_turns(held_at(Vector([0.0, 0.0, 1e-3])));
        let mut flat = Self::new(angular, hand);
        let early = flat.span(200);
        flat.span(400);
        flat.span(200) < early
    }
}

fn threshold() -> f64 {
    let theory = 2.0 * DAMPING / PERIOD;
    let (mut stable, mut unstable) = (0.5 * theory, 2.0 * theory);
    assert!(Flat::settles(stable) && !Flat::settles(unstable));
    while unstable - stable > 1e-3 * theory {
        let middle = 0.5 * (stable + unstable);
        if Flat::settles(middle) { stable = middle } else { unstable = middle }
    }
    stable / theory
}

#[test]
fn what_turns_is_stable_up_to_twice_the_damping_over_the_period() {
    let ratio = threshold();
    println!("threshold {ratio:.4} of 2b/T");
    assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
}

#[test]
fn a_passive_coupling_gives_no_energy_to_a_hand_that_turns() {
    let angular = 0.99 * 2.0 * DAMPING / PERIOD;
    let mut most_given = 0.0_f64;
    for grip in [0.0, 1e-3, 0.02] {
        for spring in [0.0, 0.5] {
            let turns = [0.0, 0.03, -0.03, 0.01].map(|angle| Vector([0.0, 0.0, angle]));
            let times = vec![0.0, 0.1, 0.13, 2.0];
            let turns = HandPath::new(times, turns.to_vec(), Interpolation::Smooth).unwrap();
            let hand = free()
                .with_turns(turns)
                .with_inertia(2e-5)
                .unwrap()
                .with_angular_spring(spring, grip);
            let hand = hand.unwrap().with_torque(Vector([0.0, 0.0, 0.02])).unwrap();
            let mut flat = Flat::new(angular, hand);
            for _ in 0..2000 {
                flat.span(1);
                most_given = most_given.max(flat.device.energy_given());
                let given = flat.device.energy_to_hand();
                assert!(given <= 1e-12, "{grip}, {spring}: {given} J");
            }
        }
    }
    assert!(most_given > 1e-9, "the torque held gave no energy: {most_given} J");
}

/// A device that moves and turns, on a rod of which one end is on the ground.
struct Leaning {
    device: SimulatedDevice,
    servo: Servo,
}

impl Leaning {
    /// With couplings so many times as stiff as is passive.
    fn new(part: f64, acceptance: Acceptance) -> Self {
        let (stiffness, angular) = (2.0 / PERIOD, 2.0 * DAMPING / PERIOD);
        let servo = on_ground(part * stiffness, part * angular);
        let protection = Protection::new(profile()).with(|s| {
            s.acceptance = acceptance;
            s.rise_rate = f64::INFINITY
        });
        let servo = servo.protected(&protection).unwrap();
        let hand = Hand::resting(Vector([0.0, 0.015, 0.0])).unwrap().with_mass(0.02).unwrap();
        let hand = hand.with_spring(100.0, 1.0).unwrap().with_push(Vector([0.1, -1.0, 0.0]));
        let hand = hand.unwrap().with_turns(held_at(Vector([0.05, 0.1, -0.3])));
        let hand = hand.with_inertia(2e-5).unwrap().with_angular_spring(0.1, 1e-3).unwrap();
        let device = SimulatedDevice::new(profile(), vec![hand]).unwrap();
        Self { device, servo }
    }

    fn tick(&mut self, tick: u32) {
        let mut points = [PointState::at_rest(Vector::ZERO)];
        self.device.read(f64::from(tick) * PERIOD, &mut points).unwrap();
        let turn = self.device.read_turn().unwrap();
        self.servo.set_turn(turn);
        self.servo.step(&points);
        self.device.write(self.servo.forces()).unwrap();
        self.device.write_torque(self.servo.torque()).unwrap();
    }
}

#[test]
fn force_and_torque_of_a_passive_lever_are_never_changed_and_give_nothing() {
    let mut leaning = Leaning::new(0.99, Acceptance::AsIs);
    let mut contacts = 0;
    for tick in 0..4000 {
        leaning.tick(tick);
        contacts += u32::from(leaning.servo.touches()[0].contact);
        let given = leaning.device.energy_to_hand();
        assert!(given <= 1e-12, "{tick}: {given} J");
    }
    let report = &leaning.servo.safety()[0];
    assert_eq!(report.passivity.effect.ticks, 0, "{report:?}");
    assert!(contacts > 3000 && leaning.servo.torque().norm() > 0.01);
    // What the observer counted is what the device was given, but for the last tick's.
    let energy = leaning.servo.energy(0);
    let given = leaning.device.energy_given();
    assert!((energy.given - energy.taken - given).abs() < 1e-12, "{energy:?}, {given}");
}

#[test]
fn a_lever_too_stiff_is_made_softer_or_kept_in_bounds() {
    let mut softer = Leaning::new(3.0, Acceptance::Passive);
    let mut as_it_is = Leaning::new(3.0, Acceptance::AsIs);
    let mut most = 0.0_f64;
    for tick in 0..8000 {
        softer.tick(tick);
        as_it_is.tick(tick);
        assert!(softer.device.energy_to_hand() <= 1e-12, "{tick}");
        most = most.max(as_it_is.device.energy_given());
    }
    println!("given at most {most} J");
    assert!(most < 1e-3, "{most} J");
    let report = &as_it_is.servo.safety()[0];
    assert!(report.limit_cycles.found > 0, "{report:?}");
}
