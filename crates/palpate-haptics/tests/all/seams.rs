// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Seams of bodies of several stiffnesses: the force is the slope of one potential.

use palpate_device::PointState;
use palpate_field::{Point, Pose, Vector};
use palpate_haptics::{
    Bodies, Body, Material, Probe, Servo, ServoOptions, Surface, Touch, Unprotected,
};

use crate::common::cuboid;

const RADIUS: f64 = 0.002;
const SOFT: f64 = 120.0;
const STIFF: f64 = 1000.0;

fn block(edges: [f64; 3], centre: [f64; 3], material: &Material) -> Body {
    let surface = Surface::new(material).unwrap();
    let at = Pose::translation(Vector(centre));
    Body::new(cuboid::<3>(edges), surface).unwrap().at(at).unwrap()
}

fn spring(stiffness: f64) -> Material {
    Material {
        stiffness,
        damping: 0.0,
        static_friction: 0.0,
        dynamic_friction: 0.0,
        ..Material::default()
    }
}

/// Steel for x < 0 and foam for x > 0, whose level tops are at y = 0.
fn plates(seam: Option<f64>) -> Bodies {
    let plate = |x, stiffness| {
        let material = Material { seam, ..spring(stiffness) };
        block([0.05, 0.02, 0.05], [x, -0.01, 0.0], &material)
    };
    Bodies::new(vec![plate(-0.025, STIFF), plate(0.025, SOFT)]).unwrap()
}

fn servo(bodies: Bodies, radius: f64, max_force: f64) -> Servo<Unprotected> {
    let probe = Probe::new(radius).unwrap();
    let options = ServoOptions { probe, max_force, rise_time: 1e-9, ..ServoOptions::default() };
    Servo::new(bodies, 1, options).unwrap()
}

fn touch(servo: &mut Servo<Unprotected>, device: Point<3>) -> Touch {
    servo.step(&[PointState::at_rest(device)])[0]
}

/// The work of the wanted force over a path through these places, at 20 mm/s [J], and its largest
/// change in a tick [N].
fn felt(servo: &mut Servo<Unprotected>, places: &[Point<3>]) -> (f64, f64) {
    let (mut work, mut step, mut last) = (0.0, 0.0_f64, None::<Touch>);
    for way in places.windows(2) {
        let way = [way[0], way[1]];
        let ticks = ((way[1] - way[0]).norm() / 2e-5).ceil();
        for tick in 0..ticks as u32 {
            let at = way[0] + (way[1] - way[0]) * (f64::from(tick) / ticks);
            let touch = touch(servo, at);
            if let Some(last) = last {
                work += 0.5 * (touch.wanted + last.wanted).dot(touch.device - last.device);
                step = step.max((touch.wanted - last.wanted).norm());
            }
            last = Some(touch);
        }
    }
    (work, step)
}

/// Presses on foam, slides to steel and lifts, three times.
fn loops(radius: f64, z: f64) -> Vec<Point<3>> {
    let at = |x: f64, y: f64, z: f64| Vector([x, radius + y, z]);
    let path = [
        at(0.012, 0.004, 0.0),
        at(0.012, -0.007, 0.0),
        at(-0.012, -0.007, z),
        at(-0.012, 0.004, z),
        at(0.012, 0.004, 0.0),
    ];
    path.repeat(3)
}

/// Once the force stepped by 6 N in a tick, and three loops gave out 65 mJ.
#[test]
fn a_path_over_a_seam_gives_no_energy_and_does_not_step() {
    for (radius, max_force) in
        [(RADIUS, 20.0), (RADIUS, 7.9), (RADIUS, f64::INFINITY), (0.0, 20.0)]
    {
        for z in [0.0, 0.0123] {
            let mut servo = servo(plates(None), radius, max_force);
            let (work, step) = felt(&mut servo, &loops(radius, z));
            assert!(work.abs() < 1e-6, "{radius} m, {max_force} N: {work} J");
            assert!(step < 0.1, "{radius} m, {max_force} N: {step} N");
        }
    }
}

#[test]
fn the_force_at_a_seam_is_the_slope_of_the_energy() {
    let (depth, length) = (0.004, 0.01);
    let mut servo = servo(plates(Some(length)), RADIUS, 4.0);
    touch(&mut servo, Vector([0.0, 0.01, 0.0]));
    for (x, part) in [(0.0, 0.5), (0.005, 0.15625), (-0.005, 0.84375), (0.011, 0.0)] {
        let touch = touch(&mut servo, Vector([x, RADIUS - depth, 0.0]));
        // The share b(t) = 1/2 − 3t/4 + t³/4 of steel, and its slope −3/4 (1 − t²).
        let t = (x / length).clamp(-1.0, 1.0);
        let stiffness = SOFT + (STIFF - SOFT) * part;
        let slope = -0.75 * (1.0 - t * t) * (STIFF - SOFT) / length;
        let expected = Vector([-0.5 * slope * depth * depth, stiffness * depth, 0.0]);
        assert!(
            (touch.wanted - expected).norm() < 1e-6,
            "{x}: {:?}, {expected:?}",
            touch.wanted
        );
    }
}

/// Four tiles of four stiffnesses meet in a corner.
#[test]
fn four_tiles_blend_too() {
    let tile = |x: f64, z: f64, stiffness| {
        block([0.03, 0.02, 0.03], [x, -0.01, z], &spring(stiffness))
    };
    let tiles = vec![
        tile(0.015, 0.015, 300.0),
        tile(-0.015, 0.015, 500.0),
        tile(-0.015, -0.015, 800.0),
        tile(0.015, -0.015, 400.0),
    ];
    let mut servo = servo(Bodies::new(tiles).unwrap(), RADIUS, f64::INFINITY);
    let at = |x: f64, y: f64, z: f64| Vector([x, RADIUS + y, z]);
    let path = [
        at(0.006, 0.004, 0.005),
        at(0.006, -0.003, 0.005),
        at(-0.006, -0.003, 0.003),
        at(-0.006, -0.003, -0.006),
        at(0.007, -0.003, -0.004),
        at(0.007, 0.004, -0.004),
        at(0.006, 0.004, 0.005),
    ];
    let (work, step) = felt(&mut servo, &path.repeat(3));
    assert!(work.abs() < 1e-6 && step < 0.1, "{work} J, {step} N");
}

#[test]
fn a_body_on_another_or_beside_a_wall_keeps_its_own_stiffness() {
    let (thin, table, wall) = (spring(200.0), spring(900.0), spring(2000.0));
    let bodies = vec![
        block([0.04, 0.0005, 0.04], [0.0, -0.00025, 0.0], &thin),
        block([0.2, 0.02, 0.2], [0.0, -0.0105, 0.0], &table),
        block([0.02, 0.1, 0.2], [0.032, 0.0, 0.0], &wall),
    ];
    let mut servo = servo(Bodies::new(bodies).unwrap(), RADIUS, 5.0);
    touch(&mut servo, Vector([0.0, 0.01, 0.0]));
    for x in [0.0, 0.01, 0.018] {
        let touch = touch(&mut servo, Vector([x, RADIUS - 0.003, 0.0]));
        assert!((touch.wanted - Vector([0.0, 0.6, 0.0])).norm() < 1e-8, "{x}: {touch:?}");
    }
    assert!(Surface::new(&Material { seam: Some(-1.0), ..thin }).is_err());
}

#[test]
fn bodies_of_one_stiffness_have_no_seam() {
    let one = || {
        let plate = |x| block([0.05, 0.02, 0.05], [x, -0.01, 0.0], &spring(500.0));
        vec![plate(-0.025), plate(0.025)]
    };
    let whole = || vec![block([0.1, 0.02, 0.05], [0.0, -0.01, 0.0], &spring(500.0))];
    let mut parts = servo(Bodies::new(one()).unwrap(), RADIUS, 5.0);
    let mut whole = servo(Bodies::new(whole()).unwrap(), RADIUS, 5.0);
    for place in loops(RADIUS, 0.01) {
        let [parts, whole] = [&mut parts, &mut whole].map(|servo| touch(servo, place).wanted);
        assert!((parts - whole).norm() < 1e-9, "{parts:?} {whole:?}");
    }
}
