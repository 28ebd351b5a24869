// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The force of a servo on shapes whose force is known.

use crate::common::{ball, body, cuboid, half_space};
use palpate_device::{DeviceError, DeviceProfile, PointState};
use palpate_field::{Point, Pose, SpaceShape, Vector};
use palpate_haptics::{
    HapticsError, Layer, Material, Probe, Protection, Servo, ServoOptions, Surface, Touch,
    Unprotected,
};
use palpate_safety::{Acceptance, WorkspaceMap};

const STIFFNESS: f64 = 1000.0;

/// A servo of one body that is a spring alone.
fn servo(
    shape: impl Into<SpaceShape>,
    radius: f64,
    (stiffness, options): (f64, ServoOptions),
) -> Servo<Unprotected> {
    let shape: SpaceShape = shape.into();
    let options = ServoOptions { probe: Probe::new(radius).unwrap(), ..options };
    let surface = Surface::smooth(stiffness, 0.0).unwrap();
    Servo::new(body(shape, surface), 1, options).unwrap()
}

fn spring_alone(stiffness: f64) -> (f64, ServoOptions) {
    (stiffness, ServoOptions { max_force: f64::INFINITY, ..ServoOptions::default() })
}

fn touch(servo: &mut Servo<Unprotected>, device: Point<3>) -> Touch {
    servo.step(&[PointState::at_rest(device)])[0]
}

#[test]
fn a_flat_wall_gives_stiffness_times_depth_exactly() {
    let floor = half_space([0.0, 1.0, 0.0], 0.0);
    for radius in [0.0, 0.0078125] {
        let mut servo = servo(&floor, radius, spring_alone(512.0));
        assert_eq!(touch(&mut servo, Vector([0.25, 0.5, -0.125])).force, Vector::ZERO);
        for depth in [0.001953125, 0.0078125, 0.03125] {
            let touch = touch(&mut servo, Vector([0.25, radius - depth, -0.125]));
            assert_eq!(touch.force, Vector([0.0, 512.0 * depth, 0.0]));
            assert_eq!(touch.proxy, Vector([0.25, radius, -0.125]));
            assert_eq!(touch.normal, Vector([0.0, 1.0, 0.0]));
            assert_eq!(touch.depth(), depth);
        }
        assert_eq!(touch(&mut servo, Vector([0.25, 0.5, -0.125])).force, Vector::ZERO);
    }
}

/// The latitude and longitude orbit: at most 0.1 m/s at 1 kHz.
fn orbit(tick: i32, radius: f64) -> Point<3> {
    let time = f64::from(tick) * 1e-3;
    let (colatitude, longitude) = (0.7 + 0.6 * (1.1 * time).sin(), 1.3 * time);
    let across = colatitude.sin();
    Vector([across * longitude.cos(), across * longitude.sin(), colatitude.cos()]) * radius
}

#[test]
fn on_a_sphere_the_force_is_radial_and_steady() {
    const RADIUS: f64 = 0.05;
    const DEPTH: f64 = 0.003;
    // The force turns with the hand: at most 0.066 rad/s of latitude and 1.3 rad/s of longitude
    // turn 3 N by 0.0039 N a tick.
    const STEADIEST: f64 = 0.0039;
    for probe in [0.0, 0.002] {
        let mut servo = servo(ball::<3>(RADIUS), probe, spring_alone(STIFFNESS));
        touch(&mut servo, orbit(0, 2.0 * RADIUS));
        let mut last: Option<Vector<f64, 3>> = None;
        for tick in 0..20_000 {
            let device = orbit(tick, RADIUS + probe - DEPTH);
            let touch = touch(&mut servo, device);
            assert!(touch.contact);
            let radial = device.normalized().unwrap();
            let angle = (touch.force.normalized().unwrap() - radial).norm().to_degrees();
            assert!(angle < 0.002, "{angle} degrees off at tick {tick}");
            assert!((touch.force.norm() - STIFFNESS * DEPTH).abs() < 1e-4);
            if let Some(last) = last {
                assert!((touch.force - last).norm() < STEADIEST);
            }
            last = Some(touch.force);
        }
    }
}

/// The largest change of force in a tick while a hand crosses the edge of a cube, 3 mm below
/// the offset surface of both faces, at 0.05 m/s.
fn largest_jump_over_an_edge(probe: f64) -> f64 {
    const HALF: f64 = 0.03;
    const DEPTH: f64 = 0.003;
    let level = HALF + probe - DEPTH;
    let mut servo = servo(cuboid([2.0 * HALF; 3]), probe, spring_alone(STIFFNESS));
    for tick in 0..400 {
        let height = 0.045 + (level - 0.045) * f64::from(tick) / 400.0;
        touch(&mut servo, Vector([-0.02, height, 0.0]));
    }
    let mut last = touch(&mut servo, Vector([-0.02, level, 0.0])).force;
    let mut largest = 0.0_f64;
    for tick in 1..1200 {
        let force =
            touch(&mut servo, Vector([-0.02 + 5e-5 * f64::from(tick), level, 0.0])).force;
        largest = largest.max((force - last).norm());
        last = force;
    }
    largest
}

#[test]
fn over_a_convex_edge_the_force_is_continuous_if_the_probe_is_wider_than_the_depth() {
    // 0.05 mm a tick turn a force of 3 N about an axis 2 mm below the hand: 0.076 N.
    assert!(largest_jump_over_an_edge(0.005) < 0.08);
    assert!(largest_jump_over_an_edge(0.0035) < 0.4);
    // Nothing holds the proxy of a point, or of a narrow ball, when the hand comes out.
    assert!(largest_jump_over_an_edge(0.0) > 2.5);
    assert!(largest_jump_over_an_edge(0.002) > 2.5);
}

#[test]
fn the_damper_resists_the_approach_alone() {
    let floor = half_space([0.0, 1.0, 0.0], 0.0);
    let surface = Surface::smooth(512.0, 4.0).unwrap();
    let options = ServoOptions { probe: Probe::new(0.0).unwrap(), ..ServoOptions::default() };
    let mut servo = Servo::new(body(&floor, surface), 1, options).unwrap();
    let position = Vector([0.0, -0.001953125, 0.0]);
    touch(&mut servo, Vector([0.0, 0.5, 0.0]));
    let mut force_at = |velocity| servo.step(&[PointState { position, velocity }])[0].force;
    assert_eq!(force_at(Vector([1.0, 0.0, 0.0])), Vector([0.0, 1.0, 0.0]));
    assert_eq!(force_at(Vector([1.0, -0.25, 0.0])), Vector([0.0, 2.0, 0.0]));
    assert_eq!(force_at(Vector([1.0, 0.25, 0.0])), Vector([0.0, 1.0, 0.0]));
}

#[test]
fn the_largest_force_bounds_the_force_and_keeps_its_direction() {
    let floor = half_space([0.0, 1.0, 0.0], 0.0);
    let options = ServoOptions { max_force: 2.0, ..ServoOptions::default() };
    let mut servo = servo(&floor, 0.0, (512.0, options));
    touch(&mut servo, Vector([0.0, 0.5, 0.0]));
    assert_eq!(touch(&mut servo, Vector([0.0, -0.5, 0.0])).force, Vector([0.0, 2.0, 0.0]));
    servo.limit_force(0.5);
    assert_eq!(touch(&mut servo, Vector([0.0, -0.5, 0.0])).force, Vector([0.0, 0.5, 0.0]));
    servo.limit_force(f64::NAN);
    assert_eq!(servo.options().max_force, 0.5);
}

#[test]
fn a_hand_that_starts_inside_is_led_out_gently() {
    // 8 ticks of 1/8 each.
    let options = ServoOptions { rate: 64.0, rise_time: 0.125, ..spring_alone(512.0).1 };
    let mut servo = servo(cuboid([0.5, 0.5, 0.5]), 0.0, (512.0, options));
    let device = Vector([0.0, 0.2421875, 0.125]);
    for tick in 0..12 {
        let touch = touch(&mut servo, device);
        assert!(touch.contact);
        assert_eq!(touch.proxy, Vector([0.0, 0.25, 0.125]));
        let part = f64::min(f64::from(tick) * 0.125, 1.0);
        assert_eq!(touch.force, Vector([0.0, 4.0 * part, 0.0]), "tick {tick}");
    }
}

#[test]
fn a_hand_at_a_centre_without_gradient_is_led_out_too() {
    let mut servo = servo(ball::<3>(0.05), 0.002, (500.0, ServoOptions::default()));
    let touch = touch(&mut servo, Vector::ZERO);
    assert!(touch.contact);
    assert!((touch.proxy.norm() - 0.052).abs() < 1e-9);
}

#[test]
fn a_shape_that_moves_over_the_hand_pushes_gently() {
    let mut servo = servo(half_space([0.0, 1.0], 0.0), 0.0, spring_alone(512.0));
    let device = Vector([0.0, 0.0625, 0.0]);
    assert!(!touch(&mut servo, device).contact);
    let surface = Surface::smooth(512.0, 0.0).unwrap();
    let old = servo.replace_bodies(body(half_space([0.0, 1.0], 0.125), surface));
    assert_eq!(old.everything().look(device).0, 0.0625);
    let first = touch(&mut servo, device);
    assert_eq!((first.proxy, first.force), (Vector([0.0, 0.125, 0.0]), Vector::ZERO));
    for _ in 0..100 {
        touch(&mut servo, device);
    }
    assert_eq!(touch(&mut servo, device).force, Vector([0.0, 32.0, 0.0]));
}

/// A skin of 1e-7 m allowed only tiny steps: a probe that slid at 1 m/s over a ball spent its budget
/// and was left behind.
#[test]
fn a_tiny_probe_is_felt_as_a_point() {
    fn forces(
        shape: impl Into<SpaceShape>,
        radius: f64,
        hand: impl Fn(f64) -> Point<3>,
    ) -> Vec<f64> {
        let shape: SpaceShape = shape.into();
        let mut servo = servo(shape, radius, spring_alone(512.0));
        let force = |tick: i32| {
            let touch = touch(&mut servo, hand(0.001 * f64::from(tick)));
            assert!(touch.evaluations < 63, "{radius}: {} in {tick}", touch.evaluations);
            touch.force.norm()
        };
        (0..150).map(force).collect()
    }
    fn check(shape: impl Into<SpaceShape>, hand: impl Fn(f64) -> Point<3> + Copy) {
        let shape: SpaceShape = shape.into();
        let points = forces(shape.clone(), 0.0, hand);
        assert!(points.iter().fold(0.0_f64, |most, force| most.max(*force)) > 0.4);
        for radius in [1e-7, 1e-6, 5e-6] {
            for (force, point) in forces(shape.clone(), radius, hand).into_iter().zip(&points) {
                // Besides 1 %, the radius, by which the probe touches before the point.
                let most = 0.01 * point + 1.01 * 512.0 * radius;
                assert!(
                    (force - point).abs() <= most,
                    "{radius}: {force} N, a point {point} N"
                );
            }
        }
    }
    for speed in [0.1, 1.0] {
        let around = |time: f64| {
            let (sin, cos) = (speed * time / 0.049).sin_cos();
            let radius = if time < 0.01 { 0.06 - 1.1 * time } else { 0.049 };
            Vector([sin * radius, cos * radius, 0.0])
        };
        check(ball::<3>(0.05), around);
        let along = |time: f64| Vector([speed * time - 0.07, 0.006 - time.min(0.002), 0.01]);
        check(cuboid([0.2, 0.01, 0.2]), along);
    }
}

#[test]
fn numbers_that_are_not_finite_give_no_force_and_are_survived() {
    let floor = half_space([0.0, 1.0, 0.0], 0.0);
    let mut servo = servo(&floor, 0.0, spring_alone(512.0));
    let (above, below) = (Vector([0.0, 0.5, 0.0]), Vector([0.0, -0.00390625, 0.0]));
    touch(&mut servo, above);
    let pressed = Vector([0.0, 2.0, 0.0]);
    assert_eq!(touch(&mut servo, below).force, pressed);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e16] {
        for axis in 0..3 {
            let mut device = below;
            device[axis] = bad;
            let lost = touch(&mut servo, device);
            assert_eq!((lost.force, lost.contact), (Vector::ZERO, false), "{bad}");
            assert!(lost.proxy.is_finite());
            let state = PointState { position: below, velocity: device };
            let force = servo.step(&[state])[0].force;
            assert!(force.is_finite());
            assert_eq!(touch(&mut servo, below).force, pressed);
        }
    }
    assert_eq!(servo.step(&[])[0].force, Vector::ZERO);
}

#[test]
fn every_point_of_a_servo_is_its_own() {
    let options = ServoOptions { probe: Probe::new(0.0).unwrap(), ..spring_alone(500.0).1 };
    let mut servo = Servo::new(half_space([0.0, 1.0], 0.0), 3, options).unwrap();
    let at = |y: f64| PointState::at_rest(Vector([0.0, y, 0.0]));
    servo.step(&[at(1.0), at(1.0), at(1.0)]);
    let touches = servo.step(&[at(-0.5), at(1.0), at(-0.25)]);
    let forces: Vec<_> = touches.iter().map(|t| t.force[1]).collect();
    assert_eq!(forces, [250.0, 0.0, 125.0]);
}

#[test]
fn wrong_options_are_refused_with_their_numbers() {
    let shape = ball::<2>(1.0);
    let with = |options| Servo::new(shape.clone(), 1, options).map(|_| ());
    let none = Servo::new(shape.clone(), 0, ServoOptions::default()).map(|_| ());
    assert_eq!(none, Err(HapticsError::Device(DeviceError::NoContactPoint)));
    let error = with(ServoOptions { rate: 0.0, ..ServoOptions::default() }).unwrap_err();
    assert_eq!(error.to_string(), "rate must be from 1e-6 to 1e9, got 0 Hz");
    assert!(with(ServoOptions { max_force: f64::NAN, ..ServoOptions::default() }).is_err());
    assert!(with(ServoOptions { rise_time: -1.0, ..ServoOptions::default() }).is_err());
    assert!(Probe::new(-0.1).is_err() && Probe::new(f64::NAN).is_err());
    assert!(Probe::new(0.1).and_then(|p| p.with_budget(3)).is_err());
}

#[test]
fn every_preset_can_be_felt() {
    for name in Material::preset_names() {
        Surface::new(&Material::preset(name).unwrap()).unwrap();
        Surface::new(&Material::preset(name).unwrap()).unwrap();
    }
}

/// Half of what a device renders, at any rate and scale; layers keep their proportions.
#[test]
fn a_relative_stiffness_is_a_part_of_what_the_device_renders() {
    let layer = Layer { depth: 0.005, stiffness: Some(900.0), ..Layer::default() };
    let half = Material {
        stiffness: 300.0,
        damping: 0.0,
        relative_stiffness: Some(0.5),
        layers: vec![layer],
        ..Material::default()
    };
    let accepted = |device: DeviceProfile, rate: f64, scale: f64| {
        let bodies = body(ball::<3>(0.05), Surface::new(&half).unwrap());
        let options = ServoOptions { rate, ..ServoOptions::default() };
        let servo = Servo::new(bodies, 1, options).unwrap();
        let map = WorkspaceMap::new(Pose::identity(), scale).unwrap();
        let servo = servo.protected(&Protection::new(device).with_map(map)).unwrap();
        (servo.accepted()[0].clone(), servo.bodies().bodies()[0].surface().stiffness())
    };
    let device = DeviceProfile { max_stiffness: 1800.0, ..DeviceProfile::unlimited("example") };
    for (rate, scale) in [(1000.0, 1.0), (4000.0, 1.0), (1000.0, 3.0)] {
        let (accepted, outermost) = accepted(device.clone(), rate, scale);
        assert!((accepted.device_stiffness - 0.9 * rate).abs() < 1e-9, "{accepted:?}");
        assert_eq!(accepted.stiffness_rule, None);
        assert!((outermost - 0.3 * rate / scale).abs() < 1e-9, "{outermost}");
    }
    // Nothing limits an ideal device, and the numbers of the material count.
    let (accepted, outermost) = accepted(DeviceProfile::unlimited("ideal"), 1000.0, 1.0);
    assert_eq!((accepted.device_stiffness, outermost), (900.0, 300.0));
    for part in [0.0, -0.5, 1.5, f64::NAN] {
        let wrong = Material { relative_stiffness: Some(part), ..Material::default() };
        let said = Surface::new(&wrong).unwrap_err().to_string();
        let expected =
            format!("relative_stiffness must be more than 0 and at most 1, got {part}");
        assert_eq!(said, expected);
    }
}

/// Once the largest stiffness was asked of every device, also where nothing depended on it.
#[test]
fn a_device_without_damping_takes_a_material_as_it_is() {
    let device = DeviceProfile { least_damping: 0.0, ..DeviceProfile::unlimited("bare") };
    let accepted = |relative_stiffness, acceptance| {
        let material = Material { relative_stiffness, ..Material::default() };
        let bodies = body(ball::<3>(0.05), Surface::new(&material).unwrap());
        let servo = Servo::new(bodies, 1, ServoOptions::default()).unwrap();
        let protection = Protection::new(device.clone()).with(|s| s.acceptance = acceptance);
        servo.protected(&protection).map(|servo| servo.accepted()[0].stiffness_factor)
    };
    assert_eq!(accepted(None, Acceptance::AsIs).unwrap(), 1.0);
    for (part, acceptance) in [(Some(0.5), Acceptance::AsIs), (None, Acceptance::Device)] {
        let said = accepted(part, acceptance).unwrap_err().to_string();
        assert!(said.starts_with("least_damping must be positive where no"), "{said}");
    }
}
