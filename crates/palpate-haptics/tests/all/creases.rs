// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Creases of bodies of several materials: each gives the force of its own, and the sum is smooth.

use palpate_device::PointState;
use palpate_field::kernel::{Cuboid, HalfSpace};
use palpate_field::{Pose, Shape, Vector};
use palpate_haptics::{
    Bodies, Body, Event, EventKind, Material, Probe, Servo, ServoOptions, Surface, Unprotected,
};
use palpate_testkit::arbitrary as draw;
use palpate_testkit::cases;

const RADIUS: f64 = 0.002;

/// Walls through the origin for the probe's centre, with these inner normals, stiffnesses [N/m] and
/// frictions.
#[expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]
fn walls<const D: usize>(walls: &[([f64; D], f64, f64)]) -> Bodies {
    let bodies = walls.iter().map(|(normal, stiffness, friction)| {
        let normal = Vector(*normal).normalized().unwrap();
        let shape = Shape::from_kernel(HalfSpace::new(normal, -RADIUS).unwrap());
        let material = Material {
            stiffness: *stiffness,
            damping: 0.0,
            static_friction: *friction,
            dynamic_friction: *friction,
            ..Material::default()
        };
        Body::new(shape, Surface::new(&material).unwrap()).unwrap()
    });
    Bodies::new(bodies.collect()).unwrap()
}

#[expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]
fn servo(bodies: Bodies) -> Servo<Unprotected> {
    let options = ServoOptions {
        probe: Probe::new(RADIUS).unwrap(),
        max_force: f64::INFINITY,
        rise_time: 1e-9,
        ..ServoOptions::default()
    };
    Servo::new(bodies, 1, options).unwrap()
}

/// The largest change of the wanted force in a tick [N], and all events, of a device point on a path.
fn felt(
    servo: &mut Servo<Unprotected>,
    ticks: u32,
    path: impl Fn(f64) -> Vector<f64, 3>,
    mut motion: impl FnMut(&mut Servo<Unprotected>, f64),
) -> (f64, Vec<Event>) {
    let (mut last, mut step, mut events) = (None::<Vector<f64, 3>>, 0.0_f64, Vec::new());
    for tick in 0..ticks {
        let time = 1e-3 * f64::from(tick);
        motion(servo, time);
        let touch = servo.step(&[PointState::at_rest(path(time))])[0];
        events.extend_from_slice(servo.events());
        if let Some(last) = last.filter(|_| touch.contact) {
            step = step.max((touch.wanted - last).norm());
        }
        last = Some(touch.wanted);
    }
    (step, events)
}

fn touches(events: &[Event]) -> Vec<u32> {
    let touched = |event: &&Event| matches!(event.kind, EventKind::Touch { .. });
    events.iter().filter(touched).map(|event| event.body).collect()
}

#[test]
fn each_body_pushes_with_its_own_stiffness() {
    let both = [([0.0, 1.0, 0.0], 1000.0, 0.0), ([1.0, 0.0, 0.0], 200.0, 0.0)];
    let mut servo = servo(walls(&both));
    servo.step(&[PointState::at_rest(Vector([0.01, 0.01, 0.0]))]);
    for _ in 0..3 {
        servo.step(&[PointState::at_rest(Vector([-0.003, -0.002, 0.0]))]);
    }
    let touch = servo.touches()[0];
    assert!((touch.wanted - Vector([0.6, 2.0, 0.0])).norm() < 1e-8, "{touch:?}");
    assert_eq!(touch.body, 1, "the deeper one");
    let reactions = servo.reactions();
    assert!((reactions[0].force - Vector([0.0, -2.0, 0.0])).norm() < 1e-8);
    assert!((reactions[1].force - Vector([-0.6, 0.0, 0.0])).norm() < 1e-8);
}

#[test]
fn the_force_is_the_sum_over_oblique_walls() {
    // λ₁ = 3 mm and λ₂ = 1 mm.
    let second = Vector([0.6, 0.8, 0.0]);
    let mut servo = servo(walls(&[([0.0, 1.0], 500.0, 0.0), ([0.6, 0.8], 300.0, 0.0)]));
    servo.step(&[PointState::at_rest(Vector([0.01, 0.01, 0.0]))]);
    let device = -(Vector([0.0, 1.0, 0.0]) * 0.003 + second * 0.001);
    for _ in 0..3 {
        servo.step(&[PointState::at_rest(device)]);
    }
    let wanted = Vector([0.0, 1.0, 0.0]) * 1.5 + second * 0.3;
    assert!((servo.touches()[0].wanted - wanted).norm() < 1e-8, "{:?}", servo.touches());
}

/// Once the stretch belonged to one body or the other in turn: steps of 4.8 N, and over a thousand
/// touches in four seconds.
#[test]
fn a_trembling_hand_in_a_corner_of_two_materials_feels_smooth() {
    let tremble = |time: f64| {
        let swing = 1e-4 * (40.0 * time).sin();
        Vector([-0.003 + swing, -0.003 - swing, 2e-4 * (70.0 * time).cos()])
            * (50.0 * time).min(1.0)
            + Vector([0.001, 0.001, 0.0]) * (1.0 - 50.0 * time).max(0.0)
    };
    let still = |_: &mut Servo<Unprotected>, _| {};
    let pairs = [(1000.0, 200.0), (800.0, 300.0), (2000.0, 100.0)];
    for (a, b) in pairs {
        for friction in [0.0, 0.4] {
            let corner = |a, b| {
                walls(&[([0.0, 1.0, 0.0], a, friction), ([1.0, 0.0, 0.0], b, 0.7 * friction)])
            };
            let (single, _) = felt(&mut servo(corner(a, a)), 4000, tremble, still);
            let (step, events) = felt(&mut servo(corner(a, b)), 4000, tremble, still);
            assert!(step <= 2.0 * single, "{a} and {b} N/m: {step} N, alone {single} N");
            let mut touched = touches(&events);
            touched.sort_unstable();
            assert_eq!(touched, [0, 1], "{a} and {b} N/m with friction {friction}");
        }
    }
}

/// A hand that pushes with a box along a table, as people do: presets, with friction, dampers and
/// rings.
#[test]
fn a_box_on_a_table_of_other_material_is_felt_as_smoothly() {
    let slide = |time: f64| {
        let gone = (5.0 * time).min(1.0);
        let swing = 2e-4 * (30.0 * time).sin();
        Vector([0.004 - 0.007 * gone + swing, 0.004 - 0.006 * gone, 3e-4 * (50.0 * time).sin()])
    };
    let still = |_: &mut Servo<Unprotected>, _| {};
    let pairs = [
        (Material::rubber(), Material::glass()),
        (Material::skin(), Material::glass()),
        (Material::foam(), Material::steel()),
    ];
    for (a, b) in pairs {
        let corner = |a: &Material, b: &Material| {
            let wall = |normal: [f64; 3], material: &Material| {
                let shape = HalfSpace::new(Vector(normal), -RADIUS).unwrap();
                Body::new(Shape::from_kernel(shape), Surface::new(material).unwrap()).unwrap()
            };
            let (table, box_) = (wall([0.0, 1.0, 0.0], a), wall([1.0, 0.0, 0.0], b));
            servo(Bodies::new(vec![table, box_]).unwrap())
        };
        let alone = [&a, &b].map(|one| felt(&mut corner(one, one), 4000, slide, still).0);
        let (step, events) = felt(&mut corner(&a, &b), 4000, slide, still);
        let alone = f64::max(alone[0], alone[1]);
        println!("{step} N, alone {alone} N");
        assert!(step <= 2.0 * alone, "{step} N, alone {alone} N: {a:?} {b:?}");
        let mut touched = touches(&events);
        touched.sort_unstable();
        assert_eq!(touched, [0, 1], "{a:?} {b:?}");
    }
}

/// The force behind two walls is `N K G⁻¹ Nᵀ s`, with their normals as the columns of `N` and
/// `G = Nᵀ N`. So it is at most `√((1 + |c|) / (1 − |c|))` times as steep as the hardest wall, with
/// the cosine `c` between the normals: the ratio of the singular values of `N`.
fn steepness(cosine: f64) -> f64 {
    ((1.0 + cosine.abs()) / (1.0 - cosine.abs())).sqrt()
}

/// Wedges of two and three bodies that open by 20 to 160°, at rest or moving with the hand in them:
/// the force never jumps.
#[test]
fn wedges_of_several_materials_are_smooth() {
    cases::numbered(160, |seed, u| {
        let opening = draw::within(u, 20.0, 160.0)?.to_radians();
        let half = 0.5 * opening;
        let mut normals = vec![[half.cos(), half.sin(), 0.0], [-half.cos(), half.sin(), 0.0]];
        if seed % 2 == 1 {
            normals.push([0.0, 0.0, 1.0]);
        }
        let mut of = Vec::new();
        for normal in normals {
            of.push((normal, 10.0_f64.powf(draw::within(u, 2.0, 3.3)?), 0.0));
        }
        let hardest = of.iter().map(|wall| wall.1).fold(0.0, f64::max);
        let swing: Vec<f64> =
            (0..6).map(|_| draw::within(u, 1.0, 10.0)).collect::<Result<_, _>>()?;
        let moves = if seed % 4 > 1 { 0.02 } else { 0.0 };
        let carry =
            |time: f64| Vector([moves * (3.0 * time).sin(), moves * (2.0 * time).sin(), 0.0]);
        let in_wedge = |time: f64| {
            let sway = [0, 1, 2].map(|k| 0.0015 * (3.0 * swing[k] * time + swing[3 + k]).sin());
            let gone = (10.0 * time).min(1.0);
            Vector([0.0, -0.004, -0.002]) * gone
                + Vector([0.0, 0.02, 0.02]) * (1.0 - gone)
                + Vector(sway)
        };
        let motion = |servo: &mut Servo<Unprotected>, time: f64| {
            if moves > 0.0 {
                let pose = Pose::translation(carry(time));
                (0..of.len()).for_each(|body| servo.set_pose(body, pose));
            }
        };
        let way = |tick: i32| {
            let at = |tick: i32| in_wedge(1e-3 * f64::from(tick));
            (at(tick + 1) - at(tick)).norm()
        };
        let fastest = (0..1500).map(way).fold(0.0, f64::max);
        let path = |time: f64| in_wedge(time) + carry(time);
        let (step, _) = felt(&mut servo(walls(&of)), 1500, path, motion);
        let most = hardest * fastest * steepness(opening.cos());
        if step > most * (1.0 + 1e-6) {
            let degrees = opening.to_degrees();
            return Ok(Err(format!("{step} N, at most {most} N in {degrees:.0}° of {of:?}")));
        }
        Ok(Ok(()))
    });
}

/// A box that stands exactly on a table once pulled the hand under it with 30 N.
#[test]
fn a_point_finds_no_crack_between_bodies_that_touch() {
    let table = Shape::from_kernel(HalfSpace::new(Vector([0.0, 1.0, 0.0]), 0.0).unwrap());
    let size = Vector([0.1, 0.1, 0.1]);
    let boxed = Shape::from_kernel(Cuboid::new(size).unwrap());
    let surface = || Surface::smooth(500.0, 0.0).unwrap();
    let boxed = Body::new(boxed, surface()).unwrap();
    let boxed = boxed.at(Pose::translation(Vector([0.0, 0.05, 0.0]))).unwrap();
    let bodies = vec![Body::new(table, surface()).unwrap(), boxed];
    let options = ServoOptions {
        probe: Probe::new(0.0).unwrap(),
        max_force: f64::INFINITY,
        rise_time: 1e-9,
        ..ServoOptions::default()
    };
    for below in [1e-5, 1e-3, 5e-3] {
        let bodies = Bodies::new(bodies.clone()).unwrap();
        let mut servo = Servo::new(bodies, 1, options).unwrap();
        for tick in 0..2000 {
            let gone = f64::from(tick) / 2000.0;
            let device = Vector([0.06 - 0.04 * gone, 0.002 - (0.002 + below) * gone, 0.01]);
            let touch = servo.step(&[PointState::at_rest(device)])[0];
            let proxy = touch.proxy;
            assert!(proxy[0] > 0.05 - 1e-6 && proxy[1] > -1e-6, "{tick}: {touch:?}");
        }
        let wanted = servo.touches()[0].wanted;
        let deep = Vector([500.0 * 0.03, 500.0 * below, 0.0]);
        assert!((wanted - deep).norm() < 1e-3 * deep.norm(), "{wanted:?}, not {deep:?}");
    }
}
