// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Guides that are stiffer than the device's damping bears, through the real servo.

use palpate_device::{Device, DeviceProfile, PointState};
use palpate_field::{Shape, Vector};
use palpate_haptics::{Guide, GuideOptions, Protection, Servo, ServoOptions};
use palpate_safety::Acceptance;
use palpate_sim::{Hand, SimulatedDevice};

const PERIOD: f64 = 1e-3;

/// What a guide did with a hand in 10 s.
#[derive(Debug)]
struct Guided {
    /// The most energy given out beyond what the guide stored at first and what the device's damping
    /// dissipates at least, at any time [J].
    beyond: f64,
    /// The span of the last second [m].
    swing: f64,
    /// The stiffness in the end over that of the guide.
    left: f64,
}

/// A guide of so many times the stiffness that is passive, `2 b / T`, taken as it is.
#[derive(Clone, Copy, Debug)]
struct Case {
    times: f64,
    max_force: f64,
    /// The damping of the hand that is let go [N·s/m].
    grip: f64,
    /// Where it is let go [m].
    start: f64,
}

fn guided(profile: &DeviceProfile, case: &Case) -> Guided {
    let Case { times, max_force, grip, start } = *case;
    let stiffness = times * 2.0 * profile.least_damping / PERIOD;
    let hand = Hand::resting(Vector([start, 0.0, 0.0])).unwrap();
    let hand = hand.with_mass(0.0).unwrap().with_spring(0.0, grip).unwrap();
    let mut device = SimulatedDevice::new(profile.clone(), vec![hand]).unwrap();
    let far = Shape::half_space([0.0, 1.0], -10.0).unwrap();
    let protection = Protection::new(profile.clone()).with(|s| {
        s.acceptance = Acceptance::AsIs;
        s.rise_rate = f64::INFINITY
    });
    let options = ServoOptions { max_force: f64::INFINITY, ..ServoOptions::default() };
    let servo = Servo::new(far, 1, options).unwrap();
    let mut servo = servo.protected(&protection).unwrap();
    let options =
        GuideOptions { stiffness, damping: 0.0, max_force, ..GuideOptions::default() };
    servo.guide(&[Guide::to_point(Vector::ZERO, options).unwrap()]).unwrap();
    let elastic = start.min(max_force / stiffness);
    let stored = (start - 0.5 * elastic) * stiffness * elastic;
    let mut points = [PointState::at_rest(Vector::ZERO)];
    let (mut beyond, mut span) = (0.0_f64, [f64::INFINITY, f64::NEG_INFINITY]);
    let (mut left, mut last, mut dissipated) = (1.0, start, 0.0);
    for tick in 0..10_000 {
        device.read(f64::from(tick) * PERIOD, &mut points).unwrap();
        let x = points[0].position[0];
        let way = x - last;
        dissipated += profile.least_damping * way * way / PERIOD;
        last = x;
        beyond = beyond.max(device.energy_given() - stored - dissipated);
        if tick >= 9000 {
            span = [span[0].min(x), span[1].max(x)];
        }
        servo.step(&points);
        device.write(servo.forces()).unwrap();
        let wanted = (stiffness * x).clamp(-max_force, max_force);
        if wanted != 0.0 {
            left = servo.forces()[0][0] / -wanted;
        }
    }
    Guided { beyond, swing: span[1] - span[0], left }
}

#[test]
fn a_stiff_guide_gives_out_its_reserve_beyond_its_potential_at_most() {
    let device = DeviceProfile {
        mass: 0.05,
        least_damping: 0.5,
        friction: 0.0,
        ..DeviceProfile::unlimited("light")
    };
    for times in [0.9, 2.0, 3.0] {
        for max_force in [0.5, f64::INFINITY] {
            for grip in [0.0, 0.1, 1.0] {
                for start in [0.0005, 0.004, 0.01, 0.05] {
                    let case = Case { times, max_force, grip, start };
                    let found = guided(&device, &case);
                    let told = format!("{case:?}: {found:?}");
                    // The reserve.
                    assert!(found.beyond <= 1e-4, "{told}");
                    // The stage of limit cycles leaves 1/32, and this one a part of that.
                    assert!(found.swing < 1e-4 && found.left >= 0.01, "{told}");
                    assert!(times > 1.0 || grip < 1.0 || found.left == 1.0, "{told}");
                }
            }
        }
    }
}
