// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What zeroes a force under a hand that presses on: which of it lets the force rise at once, and
//! after which it waits until the hand is out.

use crate::common::tools::smooth;
use crate::common::{body, half_space};
use palpate_device::{PointState, Reading, TurnState, profile_named};
use palpate_field::{Pose, Vector};
use palpate_haptics::{
    Bodies, Material, Probe, Protection, Servo, ServoOptions, Shell, Surface, Tool, ToolOptions,
};
use palpate_safety::Recovery;

const PERIOD: f64 = 1e-3;

/// How fast a force rises [N/s].
const RISE: f64 = 20.0;

fn ground(stiffness: f64, height: f64) -> Bodies {
    let material =
        Material { stiffness, static_friction: 0.4, dynamic_friction: 0.3, ..smooth() };
    body(half_space([0.0, 1.0, 0.0], height), Surface::new(&material).unwrap())
}

/// What holds the device.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Held {
    Point,
    /// A ball on a device without rotation.
    Tool,
    /// A ball on a device that gives torques.
    Turning,
}

const ALL: [Held; 3] = [Held::Point, Held::Tool, Held::Turning];

fn servo(held: Held, stiffness: f64, recovery: Recovery) -> Servo {
    let options = ServoOptions {
        probe: Probe::new(0.002).unwrap(),
        max_force: f64::INFINITY,
        ..ServoOptions::default()
    };
    let profile = match held {
        Held::Turning => profile_named("sigma7").unwrap(),
        Held::Point | Held::Tool => profile_named("omega").unwrap(),
    };
    let plain = match held {
        Held::Point => Servo::new(ground(stiffness, 0.0), 1, options),
        Held::Tool | Held::Turning => {
            let coupling = ToolOptions {
                stiffness,
                damping: 0.0,
                rise_time: 1e-9,
                ..ToolOptions::default()
            };
            let tool = Tool::new(Shell::ball(0.002).unwrap(), coupling).unwrap();
            Servo::with_tool(ground(stiffness, 0.0), tool, options)
        }
    };
    let protection = Protection::new(profile).with(|s| s.recovery = recovery);
    let mut servo = plain.unwrap().protected(&protection).unwrap();
    if held == Held::Turning {
        let orientation = Pose::identity().rotation;
        servo.set_turn(Some(TurnState { orientation, angular_velocity: Vector::ZERO }));
    }
    servo
}

/// The motion of a hand that is in the ground.
#[derive(Clone, Copy, Debug)]
struct Motion {
    /// Into the ground [m/s].
    deeper: f64,
    /// Along it [m/s].
    along: f64,
}

const HOLDS: Motion = Motion { deeper: 0.0, along: 0.0 };
const DEEPER: Motion = Motion { deeper: 0.01, along: 0.0 };
const SLOWLY: Motion = Motion { deeper: 1e-3, along: 0.0 };
const STROKES: Motion = Motion { deeper: 0.0, along: 0.05 };

/// A hand in the ground, on a virtual clock.
struct Press {
    servo: Servo,
    /// The part of the stiffness that the device renders [N/m].
    stiffness: f64,
    along: f64,
    depth: f64,
}

/// The written force and the wanted one [N].
#[derive(Clone, Copy, Debug)]
struct Forces {
    written: f64,
    wanted: f64,
}

impl Press {
    /// A hand that comes in from outside until the ground gives 2.2 N.
    fn new(held: Held, stiffness: f64, recovery: Recovery) -> Self {
        let mut press = Self::at(servo(held, stiffness, recovery), -0.02);
        for _ in 0..200 {
            press.go(HOLDS, PERIOD);
        }
        while press.go(DEEPER, PERIOD).wanted < 2.2 {}
        press.stiffness = press.go(HOLDS, PERIOD).wanted / press.depth;
        for _ in 0..500 {
            press.go(HOLDS, PERIOD);
        }
        let forces = press.go(HOLDS, PERIOD);
        assert!((forces.written - forces.wanted).abs() < 1e-9, "{held:?}: {forces:?}");
        assert!(forces.wanted > 2.0, "{held:?}: {forces:?}");
        press
    }

    fn at(servo: Servo, depth: f64) -> Self {
        Self { servo, stiffness: 0.0, along: 0.0, depth }
    }

    fn states(&self) -> [PointState; 1] {
        // The centre of a ball of 2 mm.
        [PointState::at_rest(Vector([self.along, 0.002 - self.depth, 0.0]))]
    }

    fn forces(&self) -> Forces {
        Forces {
            written: self.servo.forces()[0].norm(),
            wanted: self.servo.touches()[0].wanted.norm(),
        }
    }

    /// A tick after the hand moved for a time [s].
    fn go(&mut self, motion: Motion, time: f64) -> Forces {
        self.depth += motion.deeper * time;
        self.along += motion.along * time;
        self.servo.step(&self.states());
        self.forces()
    }

    /// A tick that is late by so much [s].
    fn late(&mut self, motion: Motion, late: f64) -> Forces {
        self.servo.set_late(late);
        let forces = self.go(motion, PERIOD + late);
        self.servo.set_late(0.0);
        forces
    }

    /// The written force rises by 20 N/s to the wanted one, and stays there; within `most` [s].
    fn rises(&mut self, motion: Motion, most: f64, told: &str) {
        let mut last = self.forces();
        let (ticks, mut back) = ((most / PERIOD) as u32, 0);
        for tick in 0.. {
            let now = self.go(motion, PERIOD);
            let told = format!("{told}, {motion:?}: {now:?} after {last:?} in tick {tick}");
            let missing = now.wanted - now.written;
            assert!(missing > -1e-9, "{told}");
            if missing < 1e-9 {
                back += 1;
            } else {
                let rise = now.written - last.written;
                assert!(back == 0 && (rise - RISE * PERIOD).abs() < 1e-9, "{told}");
            }
            assert!(back > 0 || tick < ticks, "{told}");
            if back == 100 {
                return;
            }
            last = now;
        }
    }

    /// The written force stays zero as long as the hand is in, and is the wanted one after it was out.
    fn waits(&mut self, motion: Motion, told: &str) {
        for tick in 0..500 {
            let now = self.go(motion, PERIOD);
            assert!(now.written == 0.0 && now.wanted > 0.0, "{told}: {now:?} in tick {tick}");
        }
        let depth = std::mem::replace(&mut self.depth, -0.01);
        self.go(HOLDS, PERIOD);
        while self.depth < depth {
            self.go(DEEPER, PERIOD);
        }
        let now = self.go(HOLDS, PERIOD);
        assert!((now.written - now.wanted).abs() < 1e-9, "{told}: {now:?}");
    }
}

/// Once the force stayed at 2.21 N down to 28.7 mm, after one tick that was late by 7 ms.
#[test]
fn after_a_late_tick_the_force_rises_to_that_of_the_wall_whatever_the_hand_does() {
    for held in ALL {
        for recovery in [Recovery::Rise, Recovery::OnceOut] {
            for stiffness in [300.0, 900.0, 1400.0] {
                for late in [0.007_05, 0.015] {
                    for motion in [HOLDS, DEEPER, STROKES] {
                        let mut press = Press::new(held, stiffness, recovery);
                        let told = format!("{held:?}, {recovery:?}, {stiffness}, {late}");
                        let mut now = press.late(motion, late);
                        let mut least = now.written;
                        // The watchdog lowers the force by a twentieth a tick, for three ticks.
                        for _ in 0..3 {
                            now = press.go(motion, PERIOD);
                            least = least.min(now.written);
                        }
                        assert!(least < 0.9 * 2.2 && least > 0.7 * 2.2, "{told}: {least}");
                        // The rise catches up with a wall that the hand presses on.
                        let speed = press.stiffness * motion.deeper;
                        let most = (now.wanted - now.written) / (RISE - speed) + 0.01;
                        press.rises(motion, most, &told);
                    }
                }
            }
        }
    }
}

#[test]
fn late_ticks_a_second_apart_soften_nothing_for_good() {
    for held in ALL {
        for motion in [HOLDS, STROKES, Motion { deeper: 1e-4, along: 0.0 }] {
            let mut press = Press::new(held, 900.0, Recovery::OnceOut);
            for turn in 0..5 {
                press.late(motion, 0.015);
                (0..3).for_each(|_| _ = press.go(motion, PERIOD));
                press.rises(motion, 0.11, &format!("{held:?}, {turn}"));
                (0..700).for_each(|_| _ = press.go(motion, PERIOD));
            }
        }
    }
}

#[test]
fn late_ticks_while_the_force_rises_do_not_stop_the_rise() {
    let mut press = Press::new(Held::Point, 900.0, Recovery::OnceOut);
    for _ in 0..10 {
        press.late(DEEPER, 0.015);
        (0..20).for_each(|_| _ = press.go(DEEPER, PERIOD));
    }
    press.rises(HOLDS, 1.0, "late ticks in a rise");
}

#[test]
fn missed_readings_and_readings_that_are_no_number_let_the_force_rise_at_once() {
    for held in ALL {
        for motion in [HOLDS, DEEPER] {
            let mut press = Press::new(held, 900.0, Recovery::OnceOut);
            for _ in 0..8 {
                press.servo.set_reading(Reading::Stale);
                press.go(HOLDS, PERIOD);
            }
            while press.go(HOLDS, PERIOD).written < press.forces().wanted * 0.5 {}
            (0..5).for_each(|_| _ = press.go(HOLDS, PERIOD));
            press.rises(motion, 0.4, &format!("{held:?}, stale"));

            let mut press = Press::new(held, 900.0, Recovery::OnceOut);
            press.servo.step(&[PointState::at_rest(Vector([f64::NAN; 3]))]);
            assert_eq!(press.servo.forces()[0], Vector::ZERO);
            press.rises(motion, 0.4, &format!("{held:?}, no number"));
        }
    }
}

#[test]
fn a_body_that_an_edit_or_a_motion_places_over_the_hand_lets_the_force_rise_at_once() {
    for motion in [HOLDS, DEEPER] {
        // 10 mm are more than an edit carries.
        let mut press = Press::new(Held::Point, 300.0, Recovery::OnceOut);
        let mut bodies = press.servo.accept(ground(300.0, 0.01)).unwrap();
        press.servo.replace_bodies(&mut bodies).unwrap();
        assert!((press.go(HOLDS, PERIOD).written - RISE * PERIOD).abs() < 1e-9);
        press.rises(motion, 1.0, "edit");
        // A stiffer material rises from the old force.
        let mut press = Press::new(Held::Point, 300.0, Recovery::OnceOut);
        let mut bodies = press.servo.accept(ground(900.0, 0.0)).unwrap();
        press.servo.replace_bodies(&mut bodies).unwrap();
        press.rises(motion, 1.0, "stiffer");
    }
    for (held, motion) in [(Held::Point, HOLDS), (Held::Point, DEEPER)] {
        let ball = crate::common::ball::<3>(0.05);
        let surface = Surface::smooth(300.0, 0.0).unwrap();
        let mut press = Press::new(held, 300.0, Recovery::OnceOut);
        let mut bodies = press.servo.accept(body(&ball, surface)).unwrap();
        press.servo.replace_bodies(&mut bodies).unwrap();
        // The ball is far below, and comes up under the hand, which is then out of the ground.
        press.servo.set_pose(0, Pose::translation(Vector([0.0, -1.0, 0.0])));
        press.go(HOLDS, PERIOD);
        assert_eq!(press.forces().written, 0.0);
        press.servo.set_pose(0, Pose::translation(Vector([0.0, -0.05, 0.0])));
        press.rises(motion, 1.0, "motion");
    }
}

#[test]
fn a_stop_and_all_that_begins_wait_until_the_hand_is_out() {
    for held in ALL {
        for motion in [HOLDS, SLOWLY] {
            let pressed = || Press::new(held, 900.0, Recovery::OnceOut);
            let told = |what: &str| format!("{held:?}: {what}");
            let stopped = || {
                let mut press = pressed();
                press.servo.stop(true);
                press.go(HOLDS, PERIOD);
                press.servo.stop(false);
                press
            };
            stopped().waits(motion, &told("stop"));
            // What else zeroes a force does not end the wait.
            let mut press = stopped();
            press.late(HOLDS, 0.007_05);
            press.waits(motion, &told("stop and late tick"));
            let mut press = stopped();
            press.servo.step(&[PointState::at_rest(Vector([f64::NAN; 3]))]);
            press.waits(motion, &told("stop and no number"));
            let mut press = stopped();
            let mut bodies = press.servo.accept(ground(900.0, 0.0005)).unwrap();
            press.servo.replace_bodies(&mut bodies).unwrap();
            press.waits(motion, &told("stop and edit"));

            let mut press = pressed();
            for _ in 0..10 {
                press.servo.set_reading(Reading::NotReady);
                press.go(HOLDS, PERIOD);
            }
            press.waits(motion, &told("device that was lost"));

            let mut press = Press::at(servo(held, 900.0, Recovery::OnceOut), 0.001);
            press.go(HOLDS, PERIOD);
            press.waits(motion, &told("start"));

            let mut press = pressed();
            press.servo.lift(true);
            press.go(HOLDS, PERIOD);
            press.servo.lift(false);
            press.waits(motion, &told("set down"));
        }
    }
}

#[test]
fn with_rise_all_that_begins_rises_at_once() {
    for held in ALL {
        let pressed = || Press::new(held, 900.0, Recovery::Rise);
        let mut press = pressed();
        press.servo.stop(true);
        press.go(HOLDS, PERIOD);
        press.servo.stop(false);
        press.rises(SLOWLY, 1.0, &format!("{held:?}: {}", "stop"));

        let mut press = pressed();
        press.servo.set_reading(Reading::NotReady);
        press.go(HOLDS, PERIOD);
        press.rises(SLOWLY, 1.0, &format!("{held:?}: {}", "device that was lost"));

        let mut press = pressed();
        press.servo.lift(true);
        press.go(HOLDS, PERIOD);
        press.servo.lift(false);
        press.rises(SLOWLY, 1.0, &format!("{held:?}: {}", "set down"));
    }
}
