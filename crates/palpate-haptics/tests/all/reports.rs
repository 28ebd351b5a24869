// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the report of a run tells of its beginning and of guides.

use crate::common::{ball, body, half_space, without_limits};
use palpate_field::{CustomField, Point, Promise, Shape, Vector};
use palpate_haptics::servo_loop::{Pace, RunOptions, RunReport, run};
use palpate_haptics::{Bodies, Body, Guide, GuideOptions, Servo, Surface};
use palpate_sim::{HandPath, Interpolation, RecordedDevice};

fn hand(times: &[f64], heights: &[f64]) -> HandPath {
    let positions = heights.iter().map(|y| Vector([0.0, *y, 0.0])).collect();
    HandPath::new(times.to_vec(), positions, Interpolation::Linear).unwrap()
}

fn told(servo: &mut Servo, hands: Vec<HandPath>, duration: f64) -> RunReport {
    let mut device = RecordedDevice::new(hands).unwrap();
    let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(duration) };
    run(servo, &mut device, options).unwrap()
}

/// A ball that is 1 mm deep all over, so that nothing leads out of it.
#[derive(Debug)]
struct Flat {
    ball: Shape<2>,
    promise: Promise<2>,
}

impl CustomField<2> for Flat {
    fn distance(&self, p: Point<2>) -> f64 {
        self.ball.distance(p).max(-0.001)
    }
    fn distance_gradient(&self, p: Point<2>) -> (f64, Vector<f64, 2>) {
        let (distance, gradient) = self.ball.distance_gradient(p);
        if distance < -0.001 { (-0.001, Vector::ZERO) } else { (distance, gradient) }
    }
    fn promise(&self) -> &Promise<2> {
        &self.promise
    }
}

#[test]
fn a_point_that_begins_inside_is_told_with_its_depth_and_its_time_without_force() {
    let ball = ball::<2>(0.5);
    let promise = *ball.promise();
    let flat = Shape::custom(Flat { ball, promise });
    let bodies = vec![
        Body::new(half_space([0.0, 1.0], -3.0), Surface::default()).unwrap(),
        Body::new(flat, Surface::default()).unwrap(),
    ];
    let bodies = Bodies::new(bodies).unwrap();
    let mut servo = without_limits(Servo::new(bodies, 3, Default::default()).unwrap());
    // From the middle out in half a second; one that stays; one that was never inside.
    let leaves = hand(&[0.0, 0.5, 1.0], &[0.0, 0.5, 1.0]);
    let stays = hand(&[0.0, 1.0], &[0.01, 0.01]);
    let outside = hand(&[0.0, 1.0], &[0.7, 0.7]);
    let report = told(&mut servo, vec![leaves, stays, outside], 1.0);
    let [first, second] = &report.starts_inside[..] else { panic!("{report:?}") };
    assert_eq!((first.point, first.body, first.has_left), (0, 1, true));
    assert!((first.depth - 0.001).abs() < 1e-15, "{first:?}");
    // Half the budget, 32 evaluations, leads a proxy up by 3 mm each; near 0.41 m that is enough to
    // come to where the field has a gradient.
    assert!(first.is_felt && (400..=420).contains(&first.ticks_without_force), "{first:?}");
    assert_eq!(first.time_without_force, first.ticks_without_force as f64 / 1000.0);
    assert_eq!((second.point, second.has_left, second.is_felt), (1, false, false));
    assert_eq!(second.ticks_without_force, 1000);
}

#[test]
fn a_point_that_is_led_out_is_felt() {
    let surface = Surface::smooth(500.0, 0.0).unwrap();
    let bodies = body(ball::<2>(0.5), surface);
    let servo = || Servo::new(bodies.clone(), 1, Default::default()).unwrap();
    let still = || vec![hand(&[0.0, 1.0], &[0.4988, 0.4988])];
    let report = told(&mut without_limits(servo()), still(), 0.1);
    let [start] = &report.starts_inside[..] else { panic!("{report:?}") };
    assert!((start.depth - 0.0012).abs() < 1e-12, "{start:?}");
    assert_eq!((start.is_felt, start.has_left, start.body), (true, false, 0));
    // Outside, with the probe's 2 mm alone in the body.
    let beside = vec![hand(&[0.0, 1.0], &[0.5015, 0.5015])];
    let report = told(&mut without_limits(servo()), beside, 0.1);
    assert!(report.starts_inside.is_empty() && report.contact_time > 0.09, "{report:?}");
    let above = vec![hand(&[0.0, 1.0], &[0.503, 0.4])];
    let report = told(&mut without_limits(servo()), above, 1.0);
    assert!(report.starts_inside.is_empty() && report.contact_time > 0.9);
}

#[test]
fn guides_tell_their_time_force_and_work() {
    let options = GuideOptions { stiffness: 100.0, damping: 0.0, ..GuideOptions::default() };
    let guides = [
        Guide::on_plane([0.0, 1.0, 0.0], [0.0, 1.0, 0.0], options).unwrap(),
        Guide::to_point([0.0, -5.0, 0.0], GuideOptions { snap_distance: 0.01, ..options })
            .unwrap(),
    ];
    let ground = half_space([0.0, 1.0], 0.0);
    let mut servo = without_limits(Servo::new(ground, 1, Default::default()).unwrap());
    servo.guide(&guides).unwrap();
    // 10 mm down and back up onto the plane at 0.1 m/s.
    let hand = hand(&[0.0, 0.1, 0.2], &[1.0, 0.99, 1.0]);
    let report = told(&mut servo, vec![hand], 0.3);
    let [plane, point] = &report.guides[..] else { panic!("{report:?}") };
    assert_eq!((point.time, point.largest_force, point.taken), (0.0, 0.0, 0.0));
    assert_eq!(plane.time, 0.3);
    assert!((plane.largest_force - 1.0).abs() < 1e-9, "{plane:?}");
    // ½ K x² = 5 mJ; forces that are held for a tick of 0.1 mm take K x δ / 2 less on the way
    // down, and give as much more on the way up.
    let held = 0.5 * 100.0 * 0.01 * 1e-4;
    assert!((plane.taken - (0.005 - held)).abs() < 1e-9, "{plane:?}");
    assert!((plane.given - (0.005 + held)).abs() < 1e-9, "{plane:?}");
}
