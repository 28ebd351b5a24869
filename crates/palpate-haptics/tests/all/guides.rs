// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Guides: laws of their forces, exact forces, and wrong numbers.

use arbitrary::Unstructured;
use palpate_device::PointState;
use palpate_field::{Aabb, Point, Shape, Vector, kernel::Ball};
use palpate_haptics::{Curve, Guide, GuideOptions, Servo, ServoOptions, Slope};
use palpate_testkit::cases::each as cases;

type Random<'a, 'b> = &'a mut Unstructured<'b>;

fn number(u: Random, most: f64) -> arbitrary::Result<f64> {
    u.int_in_range(-1000..=1000).map(|i: i32| f64::from(i) * 1e-3 * most)
}

fn vector(u: Random, most: f64) -> arbitrary::Result<Vector<f64, 3>> {
    Ok(Vector([number(u, most)?, number(u, most)?, number(u, most)?]))
}

/// A guide of any kind without a snap distance, with the given damping.
fn any_guide(u: Random, damping: f64) -> arbitrary::Result<Guide> {
    let options = GuideOptions { stiffness: 200.0, damping, ..GuideOptions::default() };
    let ball = || Shape::from_kernel(Ball::new(0.02).unwrap());
    let (a, b) = (vector(u, 0.05)?, vector(u, 0.05)? + Vector([0.1, 0.0, 0.0]));
    let guide = match u.int_in_range(0..=7)? {
        0 => Guide::to_point(a, options),
        1 => Guide::along_line(a, b, options),
        2 => Guide::along_segment(a, b, options),
        3 => Guide::on_plane(a, b, options),
        4 => Guide::along_curve(Curve::smooth(&[a, b, vector(u, 0.1)?]).unwrap(), options),
        5 => Guide::along_curve(Curve::polyline(&[b, a, vector(u, 0.1)?]).unwrap(), options),
        6 => Guide::well(a, 0.04, options),
        _ => Guide::down(Slope::new(ball(), 1.2, [-0.01, 0.05]).unwrap(), options),
    };
    Ok(guide.unwrap())
}

#[test]
fn the_force_is_never_more_than_the_largest() {
    cases(3000, |u| {
        let mut guide = any_guide(u, 5.0)?;
        let scale = *u.choose(&[0.1, 1.0, 1e6])?;
        let force = guide.force(vector(u, scale)?, vector(u, 10.0 * scale)?);
        // Limiting rounds.
        assert!(force.norm() <= guide.options().max_force * (1.0 + 1e-15), "{guide:?}");
        Ok(())
    });
}

#[test]
fn damping_only_takes() {
    cases(3000, |u| {
        let mut guide = any_guide(u, 5.0)?;
        let (position, velocity) = (vector(u, 0.1)?, vector(u, 1.0)?);
        let still = guide.force(position, Vector::ZERO);
        let moving = guide.force(position, velocity);
        assert!((moving - still).dot(velocity) <= 1e-12, "{guide:?}");
        Ok(())
    });
}

#[test]
fn a_closed_path_costs_nothing() {
    cases(40, |u| {
        let mut guide = any_guide(u, 0.0)?;
        let (centre, a, b) = (vector(u, 0.05)?, vector(u, 0.02)?, vector(u, 0.02)?);
        // Where two parts of a curve are equally far, the potential is continuous but has a
        // kink, and the trapezoidal rule errs.
        let steps = 20_000;
        let mut work = 0.0;
        let at = |step: i32| {
            let angle = std::f64::consts::TAU * f64::from(step % steps) / f64::from(steps);
            centre + a * angle.cos() + b * (2.0 * angle).sin()
        };
        let mut before = guide.force(at(0), Vector::ZERO);
        for step in 0..steps {
            let now = guide.force(at(step + 1), Vector::ZERO);
            work += 0.5 * (before + now).dot(at(step + 1) - at(step));
            before = now;
        }
        // A few jumps of at most 4 N over steps of at most 2e-5 m; smooth parts err as the
        // square of the step.
        assert!(work.abs() < 1e-4, "{work} J: {guide:?}");
        Ok(())
    });
}

#[test]
fn wells_and_slopes_are_continuous() {
    cases(500, |u| {
        let options = GuideOptions { stiffness: 200.0, ..GuideOptions::default() };
        let ball = Shape::from_kernel(Ball::new(0.02).unwrap());
        let slope = Slope::new(ball, 1.2, [-0.01, 0.05]).unwrap();
        let guides = [Guide::well(Vector::ZERO, 0.04, options), Guide::down(slope, options)];
        for guide in guides {
            let mut guide = guide.unwrap();
            let here = vector(u, 0.08)?;
            let there = here + vector(u, 1e-7)?;
            let [a, b] = [here, there].map(|x| guide.force(x, Vector::ZERO));
            // The steepest parts: 200 N/m in a well; 3/2 · 1.2 N over an edge of 15 mm in a
            // slope; and the gradient of a ball, which turns on a radius of at least 0.01 m.
            assert!((a - b).norm() <= 400.0 * (here - there).norm() + 1e-12);
        }
        Ok(())
    });
}

#[test]
fn a_guide_that_snaps_lets_go_farther_out() {
    let options = GuideOptions {
        stiffness: 256.0,
        snap_distance: 0.0078125,
        release_distance: Some(0.015625),
        max_force: 3.0,
        ..GuideOptions::default()
    };
    let mut guide = Guide::to_point(Vector::ZERO, options).unwrap();
    let mut at = |x: f64| guide.force(Vector([x, 0.0, 0.0]), Vector::ZERO)[0];
    assert_eq!(at(0.01), 0.0);
    assert_eq!(at(0.0078125), -2.0);
    assert_eq!(at(0.01171875), -3.0);
    assert_eq!(at(0.015625), -3.0);
    assert_eq!(at(0.016), 0.0);
    assert_eq!(at(0.01), 0.0);
}

#[test]
fn numbers_that_are_none_let_go() {
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    cases(200, |u| {
        let mut guide = any_guide(u, 1.0)?;
        let (mut position, mut velocity) = (vector(u, 0.1)?, vector(u, 0.1)?);
        let axis = u.choose_index(3)?;
        if u.arbitrary()? {
            position[axis] = *u.choose(&bad)?;
        } else {
            velocity[axis] = *u.choose(&bad)?;
        }
        assert_eq!(guide.force(position, velocity), Vector::ZERO);
        assert!(!guide.is_engaged());
        let huge = guide.force(Vector([1e300; 3]), Vector([1e300; 3]));
        assert!(huge.is_finite());
        Ok(())
    });
}

#[test]
fn along_a_curve_nothing_is_damped_and_at_its_ends_everything() {
    let options = GuideOptions { damping: 2.0, ..GuideOptions::default() };
    let (from, to) = (Vector([0.0, 0.0, 0.0]), Vector([1.0, 0.0, 0.0]));
    let mut guide = Guide::along_segment(from, to, options).unwrap();
    let speed = Vector([0.25, 0.0, 0.0]);
    assert_eq!(guide.force(Vector([0.5, 0.0, 0.0]), speed), Vector::ZERO);
    assert_eq!(guide.force(Vector([1.0, 0.0, 0.0]), speed), Vector::ZERO);
    let beyond = guide.force(Vector([1.0 + 1.0 / 1024.0, 0.0, 0.0]), speed);
    assert_eq!(beyond, Vector([-300.0 / 1024.0 - 0.5, 0.0, 0.0]));
}

#[test]
fn wrong_numbers_are_named() {
    let at = |change: fn(&mut GuideOptions)| {
        let mut options = GuideOptions { snap_distance: 0.01, ..GuideOptions::default() };
        change(&mut options);
        Guide::to_point(Vector([0.0, 0.0, 0.0]), options).map(|_| ()).map_err(|e| e.to_string())
    };
    assert_eq!(at(|_| ()), Ok(()));
    assert_eq!(
        at(|o| o.stiffness = 0.0),
        Err("stiffness must be positive and finite, got 0 N/m".into())
    );
    assert_eq!(
        at(|o| o.release_distance = Some(0.005)),
        Err("release_distance must be at least the snap distance, got 0.005 m".into())
    );
    assert_eq!(at(|o| o.max_force = -1.0), Err("max_force must be positive, got -1 N".into()));
    assert!(at(|o| o.snap_distance = f64::NAN).is_err());
    let options = GuideOptions::default();
    let error = Guide::well(Vector([0.0, 0.0, 0.0]), 0.005, options).unwrap_err();
    assert_eq!(error.to_string(), "reach must be more than max_force / stiffness, got 0.005 m");
    assert!(Guide::along_line(Vector([0.0, 0.0, 0.0]), Vector::ZERO, options).is_err());
    assert!(Guide::to_point(Vector([f64::NAN, 0.0, 0.0]), options).is_err());
    assert!(Curve::polyline(&[Vector([1.0, 0.0, 0.0]); 3]).is_err());
    assert!(Curve::polyline(&[]).is_err());
    assert!(Curve::smooth(&vec![Vector([1.0, 0.0, 0.0]); 66]).is_err());
    let ball = || Shape::<3>::from_kernel(Ball::new(1.0).unwrap());
    assert!(Slope::new(ball(), 1.0, [1.0, 1.0]).is_err());
    assert!(Slope::new(ball(), f64::NAN, [0.0, 1.0]).is_err());
    assert!(Slope::new(ball(), 1.0, [0.0, 1.0]).unwrap().with_edge(0.6).is_err());
}

/// The box in which guides are drawn.
fn within() -> Aabb<3> {
    Aabb { min: Vector([-1.0, 0.0, -2.0]), max: Vector([1.0, 3.0, 2.0]) }
}

#[test]
fn a_line_that_misses_the_box_is_not_drawn() {
    let options = GuideOptions::default();
    let missing = Guide::along_line([0.0, 5.0, 0.0], [1.0, 0.0, 0.0], options).unwrap();
    assert!(missing.lines_within(&within()).is_empty());
    let slanted = Guide::along_line([0.0, 1.0, 0.0], [1.0, 1.0, 0.0], options).unwrap();
    let [line] = &slanted.lines_within(&within())[..] else { panic!("one line") };
    let ends = [Vector([-1.0, 0.0, 0.0]), Vector([1.0, 2.0, 0.0])];
    assert!(line.iter().zip(ends).all(|(a, b)| (*a - b).norm() < 1e-15), "{line:?}");
}

#[test]
fn a_plane_is_two_lines_in_it() {
    let normal = Vector([0.3, 1.0, -0.2]);
    let plane = Guide::on_plane([0.1, 1.5, 0.2], normal, GuideOptions::default()).unwrap();
    let lines = plane.lines_within(&within());
    assert_eq!(lines.len(), 2);
    for line in &lines {
        assert!((line[1] - line[0]).dot(normal).abs() < 1e-14);
        assert!((line[0] - Vector([0.1, 1.5, 0.2])).dot(normal).abs() < 1e-14);
    }
    let flat = Guide::on_plane([0.0; 3], [0.0, 1.0, 0.0], GuideOptions::default()).unwrap();
    assert_eq!(flat.lines_within(&Aabb::centred(Vector([1.0, 1.0, 0.0]))).len(), 1);
}

#[test]
fn points_curves_and_wells_are_drawn_where_they_are() {
    let options = GuideOptions::default();
    let point = Guide::to_point([0.5, 1.0, 0.0], options).unwrap();
    let cross = point.lines_within(&within());
    assert_eq!((cross.len(), cross[1][0][0]), (3, 0.5));
    let corners = [[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]].map(Vector);
    let curve = Guide::along_curve(Curve::polyline(&corners).unwrap(), options).unwrap();
    let flat = Aabb::centred(Vector([1.0, 1.0, 0.0]));
    assert_eq!(
        (curve.kind_name(), curve.lines_within(&flat)),
        ("curve", vec![corners.to_vec()])
    );
    let well = Guide::well([0.1, 0.2, 0.3], 0.05, options).unwrap();
    let circles = well.lines_within(&within());
    assert_eq!(circles.len(), 3);
    let centre = Vector([0.1, 0.2, 0.3]);
    let is_on = |p: &Point<3>| ((*p - centre).norm() - 0.05).abs() < 1e-15;
    assert!(circles.iter().flatten().all(is_on));
}

/// A guide of 300 N/m that snaps at 10 mm once gave 3 N in one tick.
#[test]
fn a_guide_that_snaps_rises_over_20_ms() {
    let mut servo =
        Servo::new(Shape::sphere(0.05).unwrap(), 1, ServoOptions::default()).unwrap();
    let options =
        GuideOptions { snap_distance: 0.01, max_force: 5.0, ..GuideOptions::default() };
    servo.guide(&[Guide::to_point([0.0, 0.1, 0.0], options).unwrap()]);
    let mut step = |height| {
        let hand = PointState::at_rest(Vector([0.0, 0.1 + height, 0.0]));
        -servo.step(&[hand])[0].force[1]
    };
    assert_eq!(step(0.02), 0.0);
    // 3 N at 10 mm, in twenty steps; then all of it at once.
    for tick in 1..=25 {
        let expected = 3.0 * (f64::from(tick) / 20.0).min(1.0);
        assert!((step(0.01) - expected).abs() < 1e-12, "tick {tick}");
    }
    assert_eq!(step(0.011), 0.0);
    assert!((step(0.008) - 0.12).abs() < 1e-12);
}
