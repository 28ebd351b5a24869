// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that are moved from outside, under a hand on a simulated device.

use std::collections::VecDeque;
use std::time::Duration;

use palpate_device::{Device, DeviceProfile, PointState, profile_named};
use palpate_field::{Pose, Vector};
use palpate_haptics::servo_loop::{Pace, Recorder, RunOptions, run};
use palpate_haptics::{
    Bodies, Body, HandoffOptions, Material, NextPose, Probe, Protection, Servo, ServoOptions,
    Surface, handoff,
};
use palpate_safety::{SafetyReport, SafetySettings};
use palpate_sim::{Hand, HandPath, Interpolation, RecordedDevice, SimulatedDevice};

use crate::common::{cases, cuboid};

const PERIOD: f64 = 1e-3;

/// A plate whose top is at the height zero, under a hand of 300 N/m.
struct Plate {
    servo: Servo,
    device: SimulatedDevice,
    /// The forces that the device has not yet received.
    delayed: VecDeque<Vector<f64, 3>>,
    /// The height of the plate at a time [s].
    height: fn(f64) -> f64,
    tick: u32,
}

/// A tick of a hand on a plate.
#[derive(Clone, Copy, Debug)]
struct Felt {
    wanted: f64,
    force: f64,
    /// How far the hand and the plate moved relative to each other [m].
    relative: f64,
}

impl Plate {
    /// Under a hand that goes down to `depth` [m] within 0.6 s.
    fn new(
        material: &Material,
        profile: &DeviceProfile,
        depth: f64,
        height: fn(f64) -> f64,
    ) -> Self {
        Self::protected(material, &Protection::new(profile.clone()), depth, height)
    }

    /// The same with other protection.
    fn protected(
        material: &Material,
        protection: &Protection,
        depth: f64,
        height: fn(f64) -> f64,
    ) -> Self {
        let profile = &protection.profile;
        let body =
            Body::new(cuboid([0.2, 0.02, 0.2]), Surface::new(material).unwrap()).unwrap();
        let body = body.at(at(height(0.0))).unwrap();
        let options = ServoOptions {
            probe: Probe::new(0.002).unwrap(),
            max_force: f64::INFINITY,
            ..ServoOptions::default()
        };
        let servo = Servo::new(Bodies::new(vec![body]).unwrap(), 1, options).unwrap();
        let servo = servo.protected(protection).unwrap();
        let end = [0.0, 0.002 - depth, 0.0];
        let hand = Hand::new(path(&[(0.0, [0.0, 0.02, 0.0]), (0.6, end), (60.0, end)]));
        let device = SimulatedDevice::new(profile.clone(), vec![hand]);
        Self { servo, device: device.unwrap(), delayed: VecDeque::new(), height, tick: 0 }
    }

    /// The same with another plant, whose forces come so many ticks late.
    fn on(self, plant: &DeviceProfile, hand: Hand, delay: usize) -> Self {
        let device = SimulatedDevice::new(plant.clone(), vec![hand]).unwrap();
        Self { device, delayed: vec![Vector::ZERO; delay].into(), ..self }
    }

    fn step(&mut self) -> Felt {
        let mut points = [PointState::at_rest(Vector::ZERO)];
        let time = f64::from(self.tick) * PERIOD;
        self.device.read(time, &mut points).unwrap();
        let before = self.servo.touches()[0].device[1];
        self.servo.set_pose(0, at((self.height)(time)));
        let touch = self.servo.step(&points)[0];
        self.delayed.push_back(touch.force);
        self.device.write(&[self.delayed.pop_front().unwrap()]).unwrap();
        self.tick += 1;
        let moved = (self.height)(time) - (self.height)(time - PERIOD);
        let relative = touch.device[1] - before - moved;
        Felt { wanted: touch.wanted[1], force: touch.force[1], relative }
    }

    fn run(&mut self, seconds: f64) -> Vec<Felt> {
        (0..(seconds / PERIOD) as u32).map(|_| self.step()).collect()
    }

    fn report(&self) -> SafetyReport {
        self.servo.safety().remove(0)
    }
}

/// The path through these places [m] at these times [s].
fn path(samples: &[(f64, [f64; 3])]) -> HandPath {
    let (times, places) = samples.iter().map(|(time, place)| (*time, Vector(*place))).unzip();
    HandPath::new(times, places, Interpolation::Monotone).unwrap()
}

fn at(height: f64) -> Pose<3> {
    Pose::translation(Vector([0.0, height - 0.01, 0.0]))
}

fn hard() -> Material {
    Material {
        stiffness: 1000.0,
        damping: 1.0,
        static_friction: 0.4,
        dynamic_friction: 0.3,
        ..Material::default()
    }
}

fn omega() -> DeviceProfile {
    profile_named("omega").unwrap()
}

/// The largest step of the force [N] beyond the stiffness times the relative motion.
fn largest_step(felt: &[Felt], stiffness: f64) -> f64 {
    felt.windows(2).fold(0.0, |most, pair| {
        let step = (pair[1].force - pair[0].force).abs();
        f64::max(most, step - stiffness * pair[1].relative.abs())
    })
}

fn mean(felt: &[Felt], of: fn(&Felt) -> f64) -> f64 {
    felt.iter().map(of).sum::<f64>() / felt.len() as f64
}

/// The root mean square of what is left of the force beside its mean over 40 ticks [N].
fn ripple(felt: &[Felt]) -> f64 {
    let rest: Vec<_> =
        felt.windows(41).map(|near| near[20].force - mean(near, |f| f.force)).collect();
    (rest.iter().map(|rest| rest * rest).sum::<f64>() / rest.len() as f64).sqrt()
}

/// A linear motion to and fro over `way` [m] that takes `duration` [s] each way and begins after 1 s.
fn to_and_fro(time: f64, way: f64, duration: f64) -> f64 {
    let part = ((time - 1.0).max(0.0) / duration).rem_euclid(2.0);
    way * part.min(2.0 - part)
}

/// A plate at 4 mm/s once buzzed by 0.38 N, and gave half of the force.
#[test]
fn a_plate_that_moves_slowly_does_not_buzz() {
    let mut plate = Plate::new(&hard(), &omega(), 0.006, |time| to_and_fro(time, 0.004, 1.0));
    plate.run(2.0);
    let felt = plate.run(4.0);
    let (wanted, force) = (mean(&felt, |f| f.wanted), mean(&felt, |f| f.force));
    assert!(wanted > 1.5 && force >= 0.95 * wanted, "{force} of {wanted} N");
    assert!(ripple(&felt) <= 0.03, "{} N", ripple(&felt));
    assert!(largest_step(&felt, 1000.0) <= 0.3);
}

/// A lift at 10 mm/s once gave 3 N of 14 N, and let the hand sink to 14 mm.
#[test]
fn a_lift_carries_the_hand() {
    for name in ["omega", "falcon"] {
        let profile = profile_named(name).unwrap();
        let mut plate =
            Plate::new(&hard(), &profile, 0.014, |time| to_and_fro(time, 0.02, 2.0) - 0.02);
        plate.run(1.5);
        let felt = plate.run(4.5);
        let most = felt.iter().map(|f| f.wanted).fold(0.0, f64::max);
        assert!(most > 3.3, "{most}");
        for (tick, f) in felt.iter().enumerate() {
            assert!(f.force >= 0.95 * f.wanted, "{name}: {f:?} at {tick}");
        }
        let step = largest_step(&felt, 1000.0);
        assert!(step <= 0.3, "{name}: {step} N");
        let report = plate.report();
        let acted = (report.limit_cycles.found, report.passivity.cuts);
        assert_eq!(acted, (0, 0), "{name}: {report:?}");
        assert!(report.drives.driven.abs() > 0.001, "{name}: {:?}", report.drives);
    }
}

/// A wall at 50 mm/s once gave 3 N of 22 N.
#[test]
fn a_wall_pushes_the_hand_along() {
    let mut plate =
        Plate::new(&hard(), &omega(), 0.004, |time| 0.05 * (time - 1.0).clamp(0.0, 0.5));
    plate.run(0.9);
    let felt = plate.run(1.0);
    assert!(felt.iter().any(|f| f.wanted > 5.0));
    let limit = omega().max_force;
    for (tick, f) in felt.iter().enumerate() {
        assert!(f.force >= 0.95 * f.wanted.min(limit), "{f:?} at {tick}");
    }
    assert!(largest_step(&felt, 1000.0) <= 0.3);
    assert_eq!(plate.report().limit_cycles.found, 0);
}

/// A hand that touches nothing, above a wall that comes at 400 mm/s. Once, its force rose from zero, by
/// 20 N/s, while the wall went through the hand.
#[test]
fn a_wall_that_meets_a_free_hand_pushes_it() {
    let mut plate =
        Plate::new(&hard(), &omega(), -0.004, |time| 0.4 * (time - 1.0).clamp(0.0, 0.05));
    plate.run(1.0);
    let felt = plate.run(0.05);
    let limit = omega().max_force;
    let pushed: Vec<_> = felt.iter().filter(|f| f.wanted > 0.0).collect();
    assert!(pushed.len() > 30 && pushed.iter().any(|f| f.wanted > 2.0), "{}", pushed.len());
    // 1 W at 0.4 m/s are 2.5 N.
    for f in &pushed {
        assert!(f.force >= 0.95 * f.wanted.min(limit).min(2.5), "{f:?}");
    }
    assert!(largest_step(&felt, 1000.0) <= 0.3);
}

/// The forces of a plate that moves up and down at 8 mm/s and sideways at 50 mm/s under a finger, with
/// poses set at 60 Hz.
fn posed_at_60_hz(over: Duration) -> Vec<Vector<f64, 3>> {
    let plate = Plate::new(&hard(), &omega(), 0.004, |_| 0.0);
    let Plate { mut servo, mut device, .. } = plate;
    let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
    let mut points = [PointState::at_rest(Vector::ZERO)];
    let mut forces = Vec::new();
    let mut frame = 0;
    for tick in 0..2500 {
        let time = f64::from(tick) * PERIOD;
        while f64::from(frame) / 60.0 <= time {
            let now = f64::from(frame) / 60.0;
            let place = Vector([0.05 * now - 0.06, to_and_fro(now, 0.002, 0.25) - 0.01, 0.0]);
            control.set_poses(&[(0, Pose::translation(place))], over).unwrap();
            frame += 1;
        }
        end.receive(&mut servo);
        device.read(time, &mut points).unwrap();
        let force = servo.step(&points)[0].force;
        device.write(&[force]).unwrap();
        if tick > 1500 {
            forces.push(force);
        }
    }
    forces
}

/// Poses that were set at 60 Hz once gave a step of 0.25 N with each.
#[test]
fn poses_at_60_hz_feel_smooth_over_the_time_of_a_frame() {
    let largest = |forces: &[Vector<f64, 3>]| {
        forces.windows(2).map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, f64::max)
    };
    let (smooth, steps) =
        (posed_at_60_hz(Duration::from_secs_f64(1.0 / 60.0)), posed_at_60_hz(Duration::ZERO));
    assert!(smooth.iter().all(|force| force[0] > 0.1), "it is dragged along");
    assert!(largest(&smooth) < 0.05, "{} N", largest(&smooth));
    assert!(largest(&steps) > 0.1, "{} N", largest(&steps));
}

/// A body that is put 5 mm into the hand in one call once kicked with all of its force.
#[test]
fn a_body_that_jumps_lets_the_force_rise() {
    let mut plate = Plate::new(&hard(), &omega(), 0.004, |_| 0.0);
    plate.run(1.0);
    let before = plate.servo.touches()[0].force[1];
    let (mut control, mut end) = handoff(&plate.servo, HandoffOptions::default());
    control.set_poses(&[(0, at(0.005))], Duration::ZERO).unwrap();
    end.receive(&mut plate.servo);
    plate.height = |_| 0.005;
    let (mut last, mut most) = (before, 0.0_f64);
    for tick in 0..400 {
        let felt = plate.step();
        assert!((felt.force - last).abs() < 0.1, "{felt:?} after {last} N in tick {tick}");
        (last, most) = (felt.force, most.max(felt.force));
    }
    assert!(most > before + 0.5, "{most} N after {before} N");
    assert_eq!(plate.report().drives.driven, 0.0);
}

/// The hand is as free to press as before, if a body far away turns fast or is put elsewhere.
#[test]
fn a_body_that_jumps_far_away_is_not_felt() {
    let surface = || Surface::new(&hard()).unwrap();
    let run = |moves: bool| {
        let plate =
            Body::new(cuboid([0.2, 0.02, 0.2]), surface()).unwrap().at(at(0.0)).unwrap();
        let far = |x: f64| Pose::translation(Vector([x, 0.0, 0.0]));
        let other =
            Body::new(cuboid([0.1, 0.1, 0.1]), surface()).unwrap().at(far(1.0)).unwrap();
        let bodies = Bodies::new(vec![plate, other]).unwrap();
        let servo = Servo::new(bodies, 1, ServoOptions::default()).unwrap();
        let mut servo = servo.protected(&Protection::new(omega())).unwrap();
        let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
        let mut forces = Vec::new();
        for tick in 0..400 {
            let x = if tick % 2 == 0 { 1.0 } else { 1.5 };
            if moves {
                control.set_poses(&[(1, far(x))], Duration::ZERO).unwrap();
            }
            end.receive(&mut servo);
            let height = 0.004 - 2e-5 * f64::from(tick);
            forces
                .push(servo.step(&[PointState::at_rest(Vector([0.0, height, 0.0]))])[0].force);
        }
        forces
    };
    assert_eq!(run(true), run(false));
}

/// A hand of 3000 N/m would be moved with 4 N at 0.5 m/s: 2 W.
#[test]
fn a_drive_gives_at_most_its_power() {
    let undamped = Material { damping: 0.0, ..hard() };
    let mut plate =
        Plate::new(&undamped, &omega(), 0.003, |time| 0.5 * (time - 1.0).clamp(0.0, 0.1));
    plate.run(1.0);
    let felt = plate.run(0.1);
    for (tick, f) in felt.iter().enumerate().skip(40) {
        assert!(f.force * 0.5 <= 1.0 + 1e-9, "{f:?} at {tick}");
    }
    let step = largest_step(&felt, 1000.0);
    assert!(step <= 0.3 + 1e-12, "{step} N");
    let drives = plate.report().drives;
    assert!(drives.effect.ticks > 40 && drives.effect.largest > 1.0, "{drives:?}");
}

/// A plate that may do 10 mW goes 40 mm through the hand and stops. Once, the force then rose by 0.3 N a
/// tick and threw the hand out.
#[test]
fn a_weak_drive_that_stops_lifts_the_hand_gently() {
    let weak = Protection::new(omega()).with(|safety| safety.drive_power = 0.01);
    let height = |time: f64| 0.08 * (time - 1.0).clamp(0.0, 0.5);
    let undamped = Material { damping: 0.0, ..hard() };
    let mut plate = Plate::protected(&undamped, &weak, 0.001, height);
    plate.run(1.5);
    let felt = plate.run(1.5);
    assert!(felt[0].force < 0.2 && felt[0].wanted > 12.0, "{:?}", felt[0]);
    assert!(felt.iter().any(|f| f.force > 5.0));
    for pair in felt.windows(2) {
        let step = pair[1].force - pair[0].force;
        let moved = 1000.0 * pair[1].relative.abs();
        assert!(step <= 20.0 * PERIOD + moved + 1e-9 && step >= -0.3 - moved, "{pair:?}");
    }
}

/// A plate lifts a hand at 0.4 m/s and brakes within 5 ms. Once, the force came back by 3.3 N in a tick.
#[test]
fn a_drive_that_brakes_gives_the_force_back_gently() {
    let height = |time: f64| {
        let (time, brake) = (time - 1.0, 0.005);
        let braked = (time - 0.02).clamp(0.0, brake);
        0.4 * (time.clamp(0.0, 0.02) + braked - braked * braked / (2.0 * brake))
    };
    let undamped = Material { damping: 0.0, ..hard() };
    let mut plate = Plate::new(&undamped, &omega(), 0.004, height);
    plate.run(1.0);
    let felt = plate.run(1.0);
    assert!(felt[25].force < 4.0 && felt[25].wanted > 8.0, "{:?}", felt[25]);
    for pair in felt.windows(2) {
        let step = pair[1].force - pair[0].force;
        let moved = 1000.0 * pair[1].relative.abs();
        assert!(step <= 20.0 * PERIOD + moved + 1e-9 && step >= -0.3 - moved, "{pair:?}");
    }
}

/// On plants that differ from their profile: with other mass, damping and friction, with delays, and in
/// a loose or firm grip.
#[test]
fn no_plant_gets_more_energy_than_the_report_allows() {
    cases(400, |u| {
        let names = ["touch", "omni", "desktop", "falcon", "omega", "sigma", "delta"];
        let name = *u.choose(&names)?;
        let profile = profile_named(name).unwrap();
        let mut factor = |most| Ok(0.1 * f64::from(u.int_in_range(1..=most)?));
        let stiffness = 500.0 * factor(80)?;
        let plant = DeviceProfile {
            mass: profile.mass * factor(30)?,
            least_damping: profile.least_damping * factor(30)?,
            friction: profile.friction * factor(30)?,
            ..profile.clone()
        };
        let (delay, grip) = (u.int_in_range(0..=2)?, f64::from(u.int_in_range(0..=10)?));
        let heights: [fn(f64) -> f64; 4] = [
            |time| to_and_fro(time, 0.004, 1.0),
            |time| to_and_fro(time, 0.02, 0.4),
            |time| 0.002 * (40.0 * (time - 1.0).max(0.0)).sin(),
            |_| 0.0,
        ];
        let height = *u.choose(&heights)?;
        let material = Material { stiffness, ..hard() };
        let path = path(&[
            (0.0, [0.0, 0.02, 0.0]),
            (0.6, [0.0, -0.004, 0.0]),
            (2.5, [0.01, -0.004, 0.0]),
            (3.0, [0.01, 0.03, 0.0]),
        ]);
        let hand = Hand::new(path).with_spring(300.0, grip).unwrap();
        let mut plate = Plate::new(&material, &profile, 0.006, height).on(&plant, hand, delay);
        for _ in 0..3200 {
            plate.step();
            let seen = plate.servo.safety().remove(0).passivity;
            let given = seen.energy_out - seen.energy_in;
            assert!(given <= seen.most_given(1e-4) + 1e-12, "{name}: {seen:?}");
        }
        Ok(())
    });
}

/// A jump lets the force rise from what it was, at any distance. A motion without a jump pushes the
/// hand, at any speed.
#[test]
fn a_motion_jumps_where_it_says_so_alone() {
    for jumps in [false, true] {
        let profile = DeviceProfile::unlimited("still");
        let body = Body::new(cuboid([0.2, 0.02, 0.2]), Surface::smooth(1000.0, 0.0).unwrap());
        let bodies = Bodies::new(vec![body.unwrap().at(at(0.0)).unwrap()]).unwrap();
        let options = ServoOptions { max_force: f64::INFINITY, ..ServoOptions::default() };
        let servo = Servo::new(bodies, 1, options).unwrap();
        // At 3 m/s, a drive of 1 W gives a third of a newton.
        let strong = |settings: &mut SafetySettings| settings.drive_power = f64::INFINITY;
        let mut servo = servo.protected(&Protection::new(profile).with(strong)).unwrap();
        let hand = Vector([0.0, 0.001, 0.0]);
        let path = HandPath::new(vec![0.0, 1.0], vec![hand; 2], Interpolation::Linear).unwrap();
        let mut device = RecordedDevice::new(vec![path]).unwrap();
        let mut recorder = Recorder::new(1000);
        // The plate is 1 mm under the hand's ball for half a second, then 3 mm higher at once.
        let mut motion = |time: f64, set_pose: &mut dyn FnMut(usize, NextPose)| {
            let is_up = time > 0.4995;
            let pose = at(if is_up { 0.003 } else { 0.0 });
            set_pose(0, NextPose { pose, jumps: jumps && is_up && time < 0.5005 });
        };
        let options = RunOptions {
            pace: Pace::AsFastAsPossible,
            recorder: Some(&mut recorder),
            motion: Some(&mut motion),
            ..RunOptions::new(1.0)
        };
        run(&mut servo, &mut device, options).unwrap();
        let force = |tick: usize| recorder.rows()[tick].force[1];
        assert!((force(499) - 1.0).abs() < 1e-9 && (force(999) - 4.0).abs() < 1e-6);
        let ticks = (500..999).filter(|tick| force(*tick) < 3.99).count();
        let slowest = if jumps { 140..160 } else { 0..20 };
        assert!(slowest.contains(&ticks), "{jumps}: {ticks}");
    }
}
