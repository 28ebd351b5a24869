// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The paths made up for shapes.

use crate::common::{ball, cuboid, half_space, torus, without_limits};
use palpate_field::kernel::{Cone, Cylinder, Polygon, RegularStar};
use palpate_field::operator::Profile;
use palpate_field::{Aabb, Rotation, Shape, SpaceShape, Vector};
use palpate_haptics::servo_loop::{Pace, RunOptions, RunReport, run};
use palpate_haptics::{Bodies, Body, Material, Probe, Servo, ServoOptions, Surface};
use palpate_sim::{HandPath, RecordedDevice, SimulationError, Tour};

const DURATION: f64 = 20.0;

/// A tour of a shape, in the plane if it is planar.
fn tour_of(shape: &SpaceShape, duration: f64) -> Tour {
    let tour = match shape.flat() {
        Some(flat) => Tour::new(flat.promise().bounds.unwrap().aabb, duration),
        None => Tour::new(shape.bounds().unwrap().aabb, duration),
    };
    tour.unwrap()
}

fn tour(shape: impl Into<SpaceShape>) -> HandPath {
    let shape = shape.into();
    tour_of(&shape, DURATION).over(shape.shape()).unwrap()
}

fn toured(shape: impl Into<SpaceShape>) -> RunReport {
    toured_as(shape, &Material::default())
}

fn toured_as(shape: impl Into<SpaceShape>, material: &Material) -> RunReport {
    let shape: SpaceShape = shape.into();
    let mut device = RecordedDevice::new(vec![tour(shape.clone())]).unwrap();
    let options = ServoOptions { max_force: f64::INFINITY, ..ServoOptions::default() };
    let body = Body::new(shape, Surface::new(material).unwrap()).unwrap();
    let bodies = Bodies::new(vec![body]).unwrap();
    let mut servo = without_limits(Servo::new(bodies, 1, options).unwrap());
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

/// A star of 12 branches with notches as deep as its tips, grown together with a ball.
fn star() -> Shape<2> {
    let star = Shape::from_kernel(RegularStar::new(12, 0.3, 0.212).unwrap());
    let disc = ball(0.2).translated([-0.25, 0.15]).unwrap();
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
    fn check(shape: impl Into<SpaceShape>) {
        let report = toured(shape);
        let share = report.contact_time / report.duration;
        assert!((0.4..0.9).contains(&share), "{share}");
        // The default probe is 2 mm wide and pressed to 1.5 mm; at edges a little more.
        assert!(report.largest_depth < 0.0025, "{} m deep", report.largest_depth);
        assert_eq!(report.evaluations.budget_spent, 0);
    }
    check(ball::<3>(0.05));
    check(cuboid([0.1, 0.1, 0.1]));
    check(torus(0.05, 0.02));
    check(row_of_bodies());
    check(ball::<2>(0.05));
    check(cuboid([0.1, 0.06]));
}

/// Friction held the proxy on a side of a cube when the hand had gone round the edge: 0.3 m deep.
#[test]
fn friction_leaves_no_proxy_behind_at_edges() {
    fn check(shape: impl Into<SpaceShape>) {
        let material =
            Material { static_friction: 0.6, dynamic_friction: 0.5, ..Material::default() };
        let report = toured_as(shape, &material);
        assert!(report.largest_depth < 0.005, "{} m deep", report.largest_depth);
        assert!(report.contact_time > 0.2 * DURATION, "{} s", report.contact_time);
    }
    let cone = Shape::from_kernel(Cone::new(0.035, 0.09).unwrap());
    let cube = cuboid([0.05; 3]);
    check(cuboid([0.1, 0.1, 0.1]));
    check(Shape::union([cone.clone(), cube.clone()]).unwrap());
    check(cube.difference([cone]).unwrap());
    check(row_of_bodies());
    check(cuboid([0.1, 0.06]));
}

#[test]
fn the_hand_of_a_tour_is_nowhere_much_deeper_than_asked() {
    fn check(name: &str, shape: impl Into<SpaceShape>) {
        let shape: SpaceShape = shape.into();
        let bounds = shape.bounds().unwrap().aabb;
        let size = bounds.half_extents().0.into_iter().fold(0.0, f64::max) * 2.0;
        for radius in [0.002, 0.003] {
            let depth = f64::min(0.01 * size, 0.75 * radius);
            let tour = tour_of(&shape, DURATION).with_probe_radius(radius).unwrap();
            let path = tour.over(shape.shape()).unwrap();
            assert_eq!(path, tour.over(shape.shape()).unwrap());
            for tick in 0..200_000 {
                let state = path.state_at(f64::from(tick) * 1e-4);
                let deep = radius - shape.shape().distance(state.position);
                assert!(deep <= 1.5 * depth, "{name}: {deep} m deep at {tick}e-4 s");
                let speed = state.velocity.norm() / (0.3 * size.sqrt());
                assert!(speed < 2.5, "{name}: {speed} times the speed at {tick}e-4 s");
            }
        }
        let report = toured(shape);
        let share = report.contact_time / report.duration;
        assert!((0.35..0.9).contains(&share), "{name}: {share} of the time in contact");
        assert!(report.largest_depth < 0.00225, "{name}: {} m", report.largest_depth);
    }
    check("star", star());
    check("angle", angle());
    check("bored cube", bored_cube());
    check("row", row_of_bodies());
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

/// A tour pressed a probe of 1e-7 m to 3/4 of its radius, and felt nothing. A point and a probe
/// smaller than 1e-5 of the shape feel the same but for that radius: within 1 % of a depth of 1 % of
/// the shape's size.
#[test]
fn a_tour_presses_a_tiny_probe_as_deep_as_a_point() {
    let largest = |shape: &Shape<3>, radius: f64| {
        let bounds = shape.promise().bounds.unwrap().aabb;
        let tour = Tour::new(bounds, 5.0).unwrap().with_probe_radius(radius).unwrap();
        let mut device = RecordedDevice::new(vec![tour.over(shape).unwrap()]).unwrap();
        let probe = Probe::new(radius).unwrap();
        let options =
            ServoOptions { max_force: f64::INFINITY, probe, ..ServoOptions::default() };
        let mut servo = without_limits(Servo::new(shape.clone(), 1, options).unwrap());
        let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(5.0) };
        let report = run(&mut servo, &mut device, options).unwrap();
        assert_eq!(report.evaluations.budget_spent, 0, "{radius}");
        (report.largest_force, report.contact_time)
    };
    for shape in [ball(0.5), ball(0.05), cuboid([0.2, 0.01, 0.2])] {
        let (force, time) = largest(&shape, 0.0);
        assert!(force > 0.2, "{force}");
        let size = shape.promise().bounds.unwrap().aabb.half_extents().norm();
        for radius in [1e-7, 1e-6, 1e-5].map(|part| part * size) {
            let (its, its_time) = largest(&shape, radius);
            assert!((its - force).abs() < 0.01 * force, "{radius}: {its} N, a point {force} N");
            assert!((its_time - time).abs() < 0.01 * time, "{radius}: {its_time} s, {time} s");
        }
    }
}

/// A table of 1 m with its top at y = 0.
fn table() -> Shape<3> {
    cuboid([1.0, 0.04, 1.0]).translated(Vector([0.0, -0.02, 0.0])).unwrap()
}

fn at(shape: Shape<3>, place: [f64; 3]) -> Shape<3> {
    shape.translated(Vector(place)).unwrap()
}

/// Which of the bodies a tour touches that visits each.
fn visited<const D: usize>(shapes: &[Shape<D>], duration: f64) -> Vec<bool> {
    let space = SpaceShape::from(Shape::union(shapes.iter().cloned()).unwrap());
    let (bodies, whole) = (each(shapes), space.shape());
    let Aabb { min, max } = bounds(&bodies);
    let bounds = Aabb { min: min.truncated::<D>(), max: max.truncated() };
    let tour = Tour::new(bounds, duration).unwrap();
    let path = tour.over_each(whole, &bodies).unwrap();
    assert_eq!((path.start(), path.duration()), (0.0, duration));
    // Pressed to 1.5 mm of the probe's 2 mm, and between two points a little more.
    for tick in 0..=(duration * 1e3) as u32 {
        let hand = path.state_at(f64::from(tick) * 1e-3).position;
        assert!(whole.distance(hand) > 0.002 - 1.5 * 0.0015, "deep at {tick} ms: {hand:?}");
    }
    // No proxy is left behind in a visit, on the other side of an edge.
    let parts = bodies.iter().map(|shape| {
        Body::new(shape.clone(), Surface::new(&Material::default()).unwrap()).unwrap()
    });
    let scene = Bodies::new(parts.collect()).unwrap();
    let servo = Servo::new(scene, 1, ServoOptions::default()).unwrap();
    let mut device = RecordedDevice::new(vec![path.clone()]).unwrap();
    let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(duration) };
    let report = run(&mut without_limits(servo), &mut device, options).unwrap();
    let is_visit = tour.over(whole).as_ref() != Ok(&path);
    let deep = report.largest_depth;
    assert!(deep < 0.003 || !is_visit, "{deep} m deep in {duration} s");
    let touches =
        |body: &SpaceShape| path.positions().iter().any(|p| body.shape().distance(*p) < 0.0019);
    bodies.iter().map(touches).collect()
}

fn each<const D: usize>(shapes: &[Shape<D>]) -> Vec<SpaceShape> {
    shapes.iter().map(|shape| SpaceShape::from(shape.clone())).collect()
}

fn bounds(bodies: &[SpaceShape]) -> Aabb<3> {
    let boxes = bodies.iter().filter_map(SpaceShape::bounds);
    boxes.map(|bounds| bounds.aabb).reduce(|a, b| a.union(&b)).unwrap()
}

/// The hand went over the table alone, past what stands on it.
#[test]
fn a_tour_visits_every_body_on_a_table() {
    let ball_on_table = vec![table(), at(ball(0.02), [0.1, 0.02, 0.05])];
    let cup = cuboid([0.06; 3]).difference([at(cuboid([0.05; 3]), [0.0, 0.01, 0.0])]).unwrap();
    let two = vec![
        at(cuboid([0.03, 0.05, 0.04]), [-0.22, 0.025, 0.13]),
        table(),
        at(cup, [0.31, 0.03, -0.07]),
    ];
    let corner = vec![table(), at(ball(0.01), [0.48, 0.01, -0.48])];
    let row: Vec<_> = (0..6)
        .map(|i| at(ball(0.012), [0.15 * f64::from(i) - 0.4, 0.012, 0.1]))
        .chain([table()])
        .collect();
    for (name, bodies) in
        [("ball", ball_on_table), ("two", two), ("corner", corner), ("row", row)]
    {
        for duration in [5.0, 10.0, 30.0] {
            let visited = visited(&bodies, duration);
            assert!(visited.iter().all(|is| *is), "{name} in {duration} s: {visited:?}");
        }
    }
}

#[test]
fn a_tour_visits_bodies_in_the_plane() {
    let floor = cuboid([1.0, 0.02]).translated([0.0, -0.01]).unwrap();
    let disc = |x: f64| ball::<2>(0.01).translated([x, 0.01]).unwrap();
    let bodies = vec![disc(-0.37), floor, disc(0.21)];
    assert_eq!(visited(&bodies, 10.0), [true; 3]);
    // Between floor and roof, the disc is seen from the side alone.
    let mut bodies = bodies;
    bodies.push(cuboid([1.0, 0.02]).translated([0.0, 0.1]).unwrap());
    assert_eq!(visited(&bodies, 10.0), [true; 4]);
}

/// Below a table top, and in a box that is open on one side.
#[test]
fn a_tour_reaches_bodies_from_where_they_are_free() {
    let top = at(cuboid([0.6, 0.02, 0.6]), [0.0, 0.3, 0.0]);
    let below = vec![top, at(ball(0.02), [0.05, 0.02, 0.03]), at(ball(0.03), [0.1, 0.34, 0.1])];
    assert_eq!(visited(&below, 10.0), [true; 3]);
    let room = at(cuboid([0.28; 3]), [0.1, 0.0, 0.0]);
    let shelf = cuboid([0.3; 3]).difference([room]).unwrap();
    let inside = vec![shelf, at(ball(0.02), [0.06, -0.1, 0.02])];
    assert_eq!(visited(&inside, 10.0), [true; 2]);
}

#[test]
fn a_tour_visits_what_stands_on_the_ground() {
    let ground = half_space([0.0, 1.0, 0.0], 0.0);
    let bodies = vec![
        ground,
        at(ball(0.02), [0.4, 0.02, 0.3]),
        at(cuboid([0.03; 3]), [-0.4, 0.015, -0.3]),
    ];
    let visited = visited(&bodies, 10.0);
    assert_eq!(visited, [true; 3]);
}

/// A body within another cannot be reached; the others are.
#[test]
fn a_body_that_is_closed_in_is_left_out() {
    let shell = ball::<3>(0.05).shell(0.01).unwrap();
    let bodies = vec![table(), at(shell, [0.2, 0.055, 0.1]), at(ball(0.01), [0.2, 0.055, 0.1])];
    assert_eq!(visited(&bodies, 10.0), [true, true, false]);
}

#[test]
fn a_tour_of_what_is_touched_on_the_way_round_is_that_way() {
    let bodies: Vec<_> =
        (0..3).map(|i| at(ball(0.05), [0.12 * f64::from(i), 0.0, 0.0])).collect();
    let whole = Shape::union(bodies.iter().cloned()).unwrap();
    let tour = Tour::new(bounds(&each(&bodies)), DURATION).unwrap();
    assert_eq!(tour.over_each(&whole, &each(&bodies)), tour.over(&whole));
    // A hundred visits in a second are none.
    let mut many = vec![table()];
    many.extend((0..99).map(|i| at(ball(0.001), [0.009 * f64::from(i) - 0.45, 0.001, 0.0])));
    let whole = Shape::union(many.iter().cloned()).unwrap();
    let tour = Tour::new(bounds(&each(&many)), 1.0).unwrap();
    assert_eq!(tour.over_each(&whole, &each(&many)), tour.over(&whole));
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
    assert_eq!(tour(row_of_bodies()), tour(row_of_bodies()));
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

/// The rays over a nut on its bolt gave up before they reached its thread.
#[test]
fn a_tour_finds_the_surface_of_a_steep_field() {
    let thread = cuboid([0.02, 0.06, 0.02]).twisted(2500.0).unwrap();
    assert!(thread.promise().lipschitz > 30.0);
    let path = tour(&thread);
    let touches = path.positions().iter().filter(|p| thread.distance(**p) < 0.002).count();
    assert!(touches > path.positions().len() / 10, "{touches} of {}", path.positions().len());
}

#[test]
fn nothing_to_touch_is_an_error() {
    let far = Aabb::centred(Vector([0.1; 3]));
    let shape = ball::<3>(0.05).translated(Vector([10.0, 0.0, 0.0])).unwrap();
    let tour = Tour::new(far, 1.0).unwrap();
    assert_eq!(tour.over(&shape), Err(SimulationError::NothingToTouch));
    assert!(Tour::new(far, 0.0).is_err());
    assert!(Tour::new(Aabb::centred(Vector([0.0; 3])), 1.0).is_err());
}

#[test]
fn a_tour_is_made_for_the_default_probe() {
    assert_eq!(Tour::PROBE_RADIUS, palpate_haptics::Probe::default().radius());
}
