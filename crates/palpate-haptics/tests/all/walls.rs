// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Nothing is crossed, at any speed.

use crate::common::{
    FollowShape as _, Scaled, cases, cuboid, direction, proxy, rotation, scaled, stroke, unit,
    vector,
};
use arbitrary::Unstructured;
use palpate_field::{BoundingBall, Point, Pose, Promise, Shape, Vector};
use palpate_haptics::{Probe, Proxy};

#[test]
fn a_thin_plate_holds_a_strike_of_five_metres_a_second() {
    let plate = cuboid([0.2, 0.002, 0.2]);
    let mut proxy = proxy(0.0);
    for tick in 0..40 {
        let height = 0.02 - 0.005 * f64::from(tick);
        let following = proxy.follow_shape(&plate, Vector([0.01, height, 0.01]));
        let held = height.max(0.001);
        assert!((following.proxy - Vector([0.01, held, 0.01])).norm() < 1e-9);
        assert_eq!(following.contact, height < 0.001);
    }
}

#[test]
fn a_wall_beyond_the_region_of_a_promise_is_not_crossed() {
    // Known to be no steeper than 1 within 0.1 m of the origin; the plate is at x = 0.3.
    let plate = cuboid([0.02, 1.0, 1.0]).translated(Vector([0.3, 0.0, 0.0])).unwrap();
    let region = BoundingBall { centre: Vector::ZERO, radius: 0.1 };
    let promise = Promise::lipschitz(plate.promise().bounds, 1.0).with_region(region);
    let shape = Shape::custom(Scaled { shape: plate, factor: 1.0, promise });
    for radius in [0.0, 0.002] {
        let mut proxy = proxy(radius);
        proxy.follow_shape(&shape, Vector::ZERO);
        for tick in 0..100 {
            let device = Vector([0.01 * f64::from(tick), 0.0, 0.0]);
            let following = proxy.follow_shape(&shape, device);
            let closest = Vector([device[0].min(0.1), 0.0, 0.0]);
            assert!((following.proxy - closest).norm() < 1e-9, "{following:?}");
            assert!(!following.contact);
        }
        let back = Vector([0.0, 0.05, 0.0]);
        assert_eq!(proxy.follow_shape(&shape, back).proxy, back);
    }
}

#[test]
fn a_hand_that_starts_beyond_the_region_of_a_promise_touches_nothing_until_it_enters() {
    let region = BoundingBall { centre: Vector::ZERO, radius: 0.1 };
    let cube = cuboid([0.05; 3]);
    let promise = Promise::lipschitz(cube.promise().bounds, 1.0).with_region(region);
    let shape = Shape::custom(Scaled { shape: cube, factor: 1.0, promise });
    let mut proxy = proxy(0.002);
    let far = Vector([0.0, 0.5, 0.0]);
    let following = proxy.follow_shape(&shape, far);
    assert_eq!((following.proxy, following.contact), (far, false));
    let last = stroke(&mut proxy, &shape, (far, Vector([0.0, 0.026, 0.0])), 300);
    assert!(last.contact);
    assert!((last.proxy - Vector([0.0, 0.027, 0.0])).norm() < 1e-8, "{last:?}");
}

/// A hand that flies about in or around a hollow box with walls of 0.1 mm to 2.1 mm, at up to
/// 10 m/s at 1 kHz and through the walls: its proxy must stay on the side where it began.
fn random_strike(
    u: &mut Unstructured<'_>,
    wrap: impl Fn(Shape<3>) -> Shape<3>,
) -> arbitrary::Result<()> {
    let thickness = 1e-4 * (1.0 + 20.0 * unit(u)?.abs());
    let (edge, inner) = (0.2, 0.2 - 2.0 * thickness);
    let hollow = cuboid([edge; 3]).difference([cuboid([inner; 3])]).unwrap();
    let pose = Pose::new(rotation(u)?, vector(u)? * 0.1);
    let shape = wrap(hollow.placed(&pose).unwrap());
    let radius = [0.0, 0.0005, 0.002, 0.005][u.choose_index(4)?];
    let mut proxy = proxy(radius);

    let starts_inside = u.ratio(1, 2)?;
    let start = if starts_inside { vector(u)? * 0.05 } else { direction(u)? * 0.25 };
    let mut device = pose.transform_point(start);
    proxy.follow_shape(&shape, device);
    for _ in 0..20 {
        device += direction(u)? * (0.01 * unit(u)?.abs());
        let target = pose.transform_point(vector(u)? * 0.1);
        device += (target - device) * 0.1;
        let following = proxy.follow_shape(&shape, device);
        let in_body = pose.inverse().transform_point(following.proxy);
        let reach = in_body.0.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        assert_eq!(reach < 0.5 * inner + 1e-9, starts_inside, "{in_body:?} radius {radius}");
        assert!(following.evaluations <= proxy.probe().budget());
    }
    Ok(())
}

#[test]
fn random_strikes_on_thin_walls_never_tunnel() {
    cases(20000, |u| random_strike(u, |shape| shape));
}

#[test]
fn random_strikes_on_steep_fields_never_tunnel() {
    cases(5000, |u| random_strike(u, |shape| scaled(&shape, 2.0, 2.0)));
}

#[test]
fn random_strikes_on_timid_bounds_never_tunnel() {
    cases(5000, |u| random_strike(u, |shape| scaled(&shape, 0.3, 1.0)));
}

#[test]
fn random_strikes_with_few_evaluations_never_tunnel() {
    cases(20000, |u| {
        let plate = cuboid([1.0, 1e-4, 1.0]);
        let budget = u.int_in_range(4..=12)?;
        let probe = Probe::new([0.0, 0.001][u.choose_index(2)?]).unwrap();
        let mut proxy = Proxy::new(probe.with_budget(budget).unwrap());
        let mut device = Vector([0.0, 0.02, 0.0]);
        proxy.follow_shape(&plate, device);
        for _ in 0..40 {
            let mut step: Vector<f64, 3> = vector(u)? * 0.01;
            step[1] -= 0.002;
            device += step;
            // Not around the plate, which is allowed.
            device[0] = device[0].clamp(-0.1, 0.1);
            device[2] = device[2].clamp(-0.1, 0.1);
            let following = proxy.follow_shape(&plate, device);
            assert!(following.proxy[1] >= 0.5e-4 - 1e-9);
            assert!(following.evaluations <= budget);
        }
        Ok(())
    });
}

#[test]
fn a_fast_slide_is_stopped_by_a_thin_wall() {
    // A wall of 0.1 mm stands on a floor; the hand slides under the floor at 10 m/s.
    let floor = cuboid([1.0, 0.02, 1.0]).translated(Vector([0.0, -0.01, 0.0])).unwrap();
    let wall = cuboid([1e-4, 0.1, 1.0]);
    let room = Shape::union([floor, wall]).unwrap();
    for radius in [0.0, 0.0002, 0.001, 0.005] {
        let mut proxy = proxy(radius);
        stroke(&mut proxy, &room, (Vector([-0.1, 0.02, 0.0]), Vector([-0.1, -0.003, 0.0])), 20);
        let slid = (Vector([-0.1, -0.003, 0.0]), Vector([0.05, -0.003, 0.0]));
        let last = stroke(&mut proxy, &room, slid, 15);
        let corner: Point<3> = Vector([-0.5e-4 - radius, radius, 0.0]);
        assert!((last.proxy - corner).norm() < 1e-6, "{:?} radius {radius}", last.proxy);
    }
}

#[test]
fn a_slot_narrower_than_the_probe_stops_it_at_its_mouth() {
    // Two plates 2 mm apart, a probe of 4 mm: it rests on both edges, sqrt(3) mm above.
    let plate = |x: f64| cuboid([0.05, 0.05]).translated([x, -0.025]).unwrap();
    let slot = Shape::union([plate(-0.026), plate(0.026)]).unwrap();
    let bottom = Vector([0.0, 3.0_f64.sqrt() * 1e-3, 0.0]);
    cases(200, |u| {
        let mut part =
            || Ok::<_, arbitrary::Error>(f64::from(u.int_in_range(-1000..=1000)?) * 1e-3);
        let mut proxy = proxy(0.002);
        let from = Vector([0.005 * part()?, 0.01, 0.0]);
        let to = Vector([0.0008 * part()?, -0.011 + 0.01 * part()?, 0.0]);
        let mut last = stroke(&mut proxy, &slot, (from, to), 200);
        for _ in 0..50 {
            last = proxy.follow_shape(&slot, to);
        }
        assert!(last.contact);
        assert!((last.proxy - bottom).norm() < 1e-7, "{last:?}");
        Ok(())
    });
}
