// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The paths made up for shapes.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use crate::common::{ball, cuboid, half_space, torus, without_limits};
use palpate_devices::{DeviceError, HandPath, RecordedDevice, Tour};
use palpate_field::kernel::{Cylinder, Polygon, RegularStar};
use palpate_field::operator::Profile;
use palpate_field::{Aabb, Rotation, Shape, Vector};
use palpate_haptics::{ServoOptions, UnprotectedServo};
use palpate_loop::{Pace, RunOptions, RunReport, run};

const DURATION: f64 = 20.0;

fn tour<const D: usize>(shape: &Shape<D>) -> HandPath<D> {
    let bounds = shape.promise().bounds.unwrap().aabb;
    Tour::new(bounds, DURATION).unwrap().over(shape).unwrap()
}

fn toured<const D: usize>(shape: &Shape<D>) -> RunReport {
    let mut device = RecordedDevice::new(vec![tour(shape)]).unwrap();
    let options = ServoOptions::default().with_max_force(f64::INFINITY);
    let servo = UnprotectedServo::new(shape.clone(), 1, options).unwrap();
    let mut servo = without_limits(servo);
    let options = RunOptions::new(DURATION).with_pace(Pace::AsFastAsPossible);
    run(&mut servo, &mut device, options).unwrap()
}

fn row_of_bodies() -> Shape<3> {
    let at = |shape: Shape<3>, x: f64| shape.translated(Vector([x, 0.0, 0.0])).unwrap();
    let dice = cuboid([0.08; 3]).difference([ball(0.045)]).unwrap();
    let bodies = [ball(0.05), cuboid([0.08, 0.1, 0.06]), torus(0.04, 0.015), dice];
    let placed = (0..).zip(bodies).map(|(i, body)| at(body, 0.12 * f64::from(i)));
    Shape::union(placed).unwrap()
}

/// A star of 12 branches with notches as deep as its tips, grown together with a ball.
fn star() -> Shape<2> {
    let star = Shape::from_kernel(RegularStar::new(12, 0.3, 0.212).unwrap());
    let disc = ball(0.2).translated(Vector([-0.25, 0.15])).unwrap();
    Shape::smooth_union([star, disc], Profile::Quadratic, 0.00025).unwrap()
}

fn angle() -> Shape<2> {
    let corners = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.05], [0.05, 0.05], [0.05, 0.2], [0.0, 0.2]];
    Shape::from_kernel(Polygon::new(vec![corners.map(Vector).to_vec()]).unwrap())
}

/// A cube with a hole through it along two axes.
fn bored_cube() -> Shape<3> {
    let hole = || Shape::from_kernel(Cylinder::new(0.025, 0.2).unwrap());
    let axis = Vector([0.0, 0.0, 1.0]);
    let across = Rotation::from_axis_angle(axis, 0.25 * std::f64::consts::TAU).unwrap();
    let across = hole().rotated(across).unwrap();
    cuboid([0.1; 3]).difference([hole(), across]).unwrap()
}

#[test]
fn a_tour_is_in_contact_for_a_good_part_of_the_time() {
    fn check<const D: usize>(shape: &Shape<D>) {
        let report = toured(shape);
        let share = report.contact_time / report.duration;
        assert!((0.4..0.9).contains(&share), "{share}");
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
fn the_hand_of_a_tour_is_nowhere_much_deeper_than_asked() {
    fn check<const D: usize>(name: &str, shape: &Shape<D>) {
        let bounds = shape.promise().bounds.unwrap().aabb;
        let size = bounds.half_extents().0.into_iter().fold(0.0, f64::max) * 2.0;
        for radius in [0.002, 0.003] {
            let depth = f64::min(0.01 * size, 0.75 * radius);
            let tour = Tour::new(bounds, DURATION).unwrap().with_probe_radius(radius).unwrap();
            let path = tour.over(shape).unwrap();
            assert_eq!(path, tour.over(shape).unwrap());
            for tick in 0..200_000 {
                let state = path.state_at(f64::from(tick) * 1e-4);
                let deep = radius - shape.distance(state.position);
                assert!(deep <= 1.5 * depth, "{name}: {deep} m deep at {tick}e-4 s");
                let speed = state.velocity.norm() / (0.3 * size.sqrt());
                assert!(speed < 2.5, "{name}: {speed} times the speed at {tick}e-4 s");
            }
        }
        let report = toured(shape);
        let share = report.contact_time / report.duration;
        assert!((0.4..0.9).contains(&share), "{name}: {share} of the time in contact");
        assert!(report.largest_depth < 0.00225, "{name}: {} m", report.largest_depth);
    }
    check("star", &star());
    check("angle", &angle());
    check("bored cube", &bored_cube());
    check("row", &row_of_bodies());
}

#[test]
fn a_tour_of_what_stands_on_a_table_stays_above_it() {
    let table = half_space([0.0, 1.0, 0.0], -0.05);
    let bodies = row_of_bodies();
    let bounds = bodies.promise().bounds.unwrap().aabb;
    let scene = Shape::union([bodies, table]).unwrap();
    let path = Tour::new(bounds, DURATION).unwrap().over(&scene).unwrap();
    assert!(path.positions().iter().all(|p| scene.distance(*p) >= 0.002 - 1.5 * 0.0015));
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
    for shape in [ball::<3>(0.05), cuboid([0.4, 0.1, 0.2]), row_of_bodies(), bored_cube()] {
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
fn a_short_tour_comes_to_sides_and_top() {
    for (shape, top) in [(cuboid([0.08, 0.1, 0.06]), 0.05), (row_of_bodies(), 0.05)] {
        let bounds = shape.promise().bounds.unwrap().aabb;
        for duration in [5.0, 10.0, 30.0] {
            let path = Tour::new(bounds, duration).unwrap().over(&shape).unwrap();
            let touching: Vec<_> =
                path.positions().iter().filter(|p| shape.distance(**p) < 0.002).collect();
            assert!(touching.iter().any(|p| p[1] > top - 0.001), "no top in {duration} s");
            assert!(touching.iter().any(|p| p[1] < 0.0), "no foot in {duration} s");
            for z in [-1.0, 1.0] {
                let is_side = |p: &&Vector<f64, 3>| z * p[2] > 0.02 && p[1] < 0.03;
                assert!(touching.iter().copied().any(|p| is_side(&p)), "{duration} s: {z}");
            }
        }
    }
}

#[test]
fn nothing_to_touch_is_an_error() {
    let far = Aabb::centred(Vector([0.1; 3]));
    let shape = ball::<3>(0.05).translated(Vector([10.0, 0.0, 0.0])).unwrap();
    let tour = Tour::new(far, 1.0).unwrap();
    assert_eq!(tour.over(&shape), Err(DeviceError::NothingToTouch));
    assert!(Tour::new(far, 0.0).is_err());
    assert!(Tour::new(Aabb::centred(Vector([0.0; 3])), 1.0).is_err());
}
