// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The paths made up for shapes.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "tests compare exact numbers")]

mod common;

use common::{ball, cuboid, torus};
use palpate_field::{Aabb, Shape, Vector};
use palpate_haptics::{
    HandPath, HapticsError, Pace, RunOptions, RunReport, Servo, ServoOptions, SimulatedDevice,
    Tour, run,
};

const DURATION: f64 = 20.0;

fn tour<const D: usize>(shape: &Shape<D>) -> HandPath<D> {
    let bounds = shape.promise().bounds.unwrap().aabb;
    Tour::new(bounds, DURATION).unwrap().over(shape).unwrap()
}

fn toured<const D: usize>(shape: &Shape<D>) -> RunReport {
    let mut device = SimulatedDevice::new(vec![tour(shape)]).unwrap();
    let options = ServoOptions { max_force: f64::INFINITY, ..ServoOptions::default() };
    let mut servo = Servo::new(shape.clone(), 1, options).unwrap();
    let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(DURATION) };
    run(&mut servo, &mut device, options).unwrap()
}

fn row_of_bodies() -> Shape<3> {
    let at = |shape: Shape<3>, x: f64| shape.translated(Vector([x, 0.0, 0.0])).unwrap();
    let dice = cuboid([0.08; 3]).difference([ball(0.045)]).unwrap();
    let bodies = [ball(0.05), cuboid([0.08, 0.1, 0.06]), torus(0.04, 0.015), dice];
    let placed = (0..).zip(bodies).map(|(i, body)| at(body, 0.12 * f64::from(i)));
    Shape::union(placed).unwrap()
}

#[test]
fn a_tour_is_in_contact_for_a_good_part_of_the_time() {
    fn check<const D: usize>(shape: &Shape<D>) {
        let report = toured(shape);
        let share = report.contact_time / report.duration;
        assert!((0.25..0.9).contains(&share), "{share}");
        // The default probe is 2 mm wide and pressed to 1.5 mm; at edges a little more.
        assert!(report.largest_depth < 0.0025, "{} m deep", report.largest_depth);
        assert_eq!(report.evaluations.budget_spent, 0);
    }
    check(&ball::<3>(0.05));
    check(&cuboid([0.1, 0.1, 0.1]));
    check(&torus(0.05, 0.02));
    check(&row_of_bodies());
    check(&ball::<2>(0.05));
    check(&cuboid([0.1, 0.06]));
}

#[test]
fn a_tour_touches_every_body() {
    let shape = row_of_bodies();
    let path = tour(&shape);
    let mut touched = [false; 4];
    for sample in path.positions() {
        if shape.distance(*sample) < 0.002 {
            let body = (sample[0] / 0.12).round().clamp(0.0, 3.0);
            touched[body as usize] = true;
        }
    }
    assert_eq!(touched, [true; 4]);
}

#[test]
fn the_hand_of_a_tour_goes_at_a_steady_speed() {
    for shape in [ball::<3>(0.05), cuboid([0.4, 0.1, 0.2]), row_of_bodies()] {
        let bounds = shape.promise().bounds.unwrap().aabb;
        let size = bounds.half_extents().0.into_iter().fold(0.0, f64::max) * 2.0;
        let speed = 0.3 * size.sqrt();
        let path = tour(&shape);
        let mut last = path.state_at(0.0).velocity;
        for tick in 0..200_000 {
            let velocity = path.state_at(f64::from(tick) * 1e-4).velocity;
            assert!(velocity.norm() < 2.5 * speed, "{} m/s of {speed}", velocity.norm());
            let change = (velocity - last).norm() / speed;
            assert!(change < 0.05, "a jerk of {change} at {tick}e-4 s");
            last = velocity;
        }
    }
}

#[test]
fn a_tour_is_made_the_same_twice() {
    assert_eq!(tour(&row_of_bodies()), tour(&row_of_bodies()));
}

#[test]
fn nothing_to_touch_is_an_error() {
    let far = Aabb::centred(Vector([0.1; 3]));
    let shape = ball::<3>(0.05).translated(Vector([10.0, 0.0, 0.0])).unwrap();
    let tour = Tour::new(far, 1.0).unwrap();
    assert_eq!(tour.over(&shape), Err(HapticsError::NothingToTouch));
    assert!(Tour::new(far, 0.0).is_err());
    assert!(Tour::new(Aabb::centred(Vector([0.0; 3])), 1.0).is_err());
}
