// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Over a closed path a scene at rest gives no energy, and with friction takes some.

use crate::common::{ball, body, cases, cuboid, half_space, scaled, torus, vector};
use palpate_device::PointState;
use palpate_field::operator::Profile;
use palpate_field::{Point, Shape, Vector};
use palpate_haptics::{
    Bodies, Layer, Magnet, Material, Probe, Servo, ServoOptions, Surface, Texture, TextureKind,
    Unprotected,
};

/// The most that may be gained over a closed path [J].
const MOST: f64 = 1e-9;

/// Ticks of a closed path.
const TICKS: u32 = 40_000;

/// A force that changes faster than this jumps [N/m]: where a proxy no longer has a place to
/// rest. When in the tick it did is not known, so the least is counted that fits.
const STEEPEST: f64 = 1e5;

/// A spring alone.
fn spring() -> Material {
    Material {
        stiffness: 500.0,
        damping: 0.0,
        static_friction: 0.0,
        dynamic_friction: 0.0,
        ..Material::default()
    }
}

fn surface(material: &Material) -> Surface {
    Surface::new(material).unwrap()
}

fn servo(bodies: Bodies, radius: f64) -> Servo<Unprotected> {
    let probe = Probe::new(radius).unwrap();
    let options = ServoOptions { probe, max_force: f64::INFINITY, ..ServoOptions::default() };
    Servo::new(bodies, 1, options).unwrap()
}

/// The work that the force does on the hand in one turn of a closed path [J], by the
/// trapezoidal rule, after one turn that nobody counts: it may begin inside.
///
/// The rule errs by about `K Δ² / 12` wherever the stiffness sets in, for steps of `Δ`.
fn work(servo: &mut Servo<Unprotected>, path: impl Fn(f64) -> Point<3>) -> f64 {
    let mut last = None;
    let mut work = 0.0;
    for tick in 0..=2 * TICKS {
        let device = path(f64::from(tick % TICKS) / f64::from(TICKS));
        let touch = servo.step(&[PointState::at_rest(device)])[0];
        if let Some((force, place)) = last.filter(|_| tick > TICKS) {
            let way = device - place;
            let change: Vector<f64, 3> = touch.force - force;
            work += if change.norm() <= STEEPEST * way.norm() {
                0.5 * (touch.force + force).dot(way)
            } else {
                touch.force.dot(way).min(force.dot(way))
            };
        }
        last = Some((touch.force, device));
    }
    work
}

/// A closed curve of two turns and their overtones about a place, as wide as `width` [m].
fn closed(
    centre: Point<3>,
    width: f64,
    turns: [[Vector<f64, 3>; 2]; 2],
) -> impl Fn(f64) -> Point<3> {
    move |time: f64| {
        let angle = 2.0 * std::f64::consts::PI * time;
        let mut place = centre;
        for (k, [cosine, sine]) in (1..).zip(turns) {
            let (sin, cos) = (f64::from(k) * angle).sin_cos();
            place += (cosine * cos + sine * sin) * (width / f64::from(k * k));
        }
        place
    }
}

fn turns(u: &mut arbitrary::Unstructured<'_>) -> arbitrary::Result<[[Vector<f64, 3>; 2]; 2]> {
    Ok([[vector(u)?, vector(u)?], [vector(u)?, vector(u)?]])
}

/// Plays loops at the surface of some bodies, and checks what they gain.
fn gains_nothing(name: &str, bodies: &Bodies, (radius, width): (f64, f64), loops: u64) {
    cases(2 * loops, |u| {
        let mut servo = servo(bodies.clone(), radius);
        // Down the field to the surface.
        let mut centre: Vector<f64, 3> = crate::common::direction(u)? * 0.1;
        for _ in 0..200 {
            let (distance, gradient) = bodies.everything().look(centre);
            centre -= gradient * (0.3 * (distance - radius));
        }
        let gained = work(&mut servo, closed(centre, width, turns(u)?));
        assert!(gained <= MOST, "{name} gives {gained:e} J");
        Ok(())
    });
}

fn shapes_of_space() -> Vec<(&'static str, Shape<3>)> {
    let cup = cuboid([0.08; 3])
        .difference([cuboid([0.06; 3]).translated(Vector([0.0, 0.02, 0.0])).unwrap()])
        .unwrap();
    let beside = ball(0.03).translated(Vector([0.03, 0.0, 0.01])).unwrap();
    let walls = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.0, 1.0]];
    vec![
        ("a ball", ball(0.05)),
        ("a box", cuboid([0.06, 0.08, 0.05])),
        ("a ring", torus(0.04, 0.012)),
        ("a cup", cup),
        ("a shell", ball(0.05).shell(0.002).unwrap()),
        ("two balls", Shape::union([ball(0.04), beside.clone()]).unwrap()),
        (
            "two balls that flow together",
            Shape::smooth_union([ball(0.04), beside], Profile::Cubic, 0.004).unwrap(),
        ),
        ("a lens", ball(0.05).stretched([1.0, 0.4, 0.8]).unwrap()),
        ("a screw", cuboid([0.03, 0.1, 0.05]).twisted(8.0).unwrap()),
        ("a corner", Shape::union(walls.map(|n| half_space(n, 0.0))).unwrap()),
        ("a timid ball", scaled(&ball(0.05), 0.5, 1.0)),
    ]
}

fn shapes_of_the_plane() -> Vec<(&'static str, Shape<2>)> {
    let bite = ball(0.02).translated([0.03, 0.03]).unwrap();
    vec![
        ("a disc", ball(0.05)),
        ("a rectangle", cuboid([0.06, 0.08])),
        ("a bitten rectangle", cuboid([0.08, 0.06]).difference([bite]).unwrap()),
        ("a bow", cuboid([0.12, 0.02]).bent(8.0).unwrap()),
        (
            "a corner",
            Shape::union([half_space([1.0, 0.2], 0.0), half_space([0.1, 1.0], 0.0)]).unwrap(),
        ),
    ]
}

#[test]
fn without_friction_nothing_is_gained_in_space() {
    for (name, shape) in shapes_of_space() {
        for radius in [0.002, 0.006] {
            gains_nothing(name, &body(&shape, surface(&spring())), (radius, 0.008), 2);
        }
    }
}

#[test]
fn without_friction_nothing_is_gained_in_the_plane() {
    for (name, shape) in shapes_of_the_plane() {
        for radius in [0.002, 0.006] {
            gains_nothing(name, &body(&shape, surface(&spring())), (radius, 0.008), 3);
        }
    }
}

#[test]
fn friction_of_any_strength_takes_and_never_gives() {
    for (fixed, slipping) in [(0.5, 0.3), (0.05, 0.05), (1.5, 0.2), (10.0, 10.0)] {
        let material =
            Material { static_friction: fixed, dynamic_friction: slipping, ..spring() };
        for (name, shape) in shapes_of_space() {
            let bodies = body(&shape, surface(&material));
            gains_nothing(name, &bodies, (0.006, 0.008), 1);
        }
        for (name, shape) in shapes_of_the_plane() {
            let bodies = body(&shape, surface(&material));
            gains_nothing(name, &bodies, (0.006, 0.008), 2);
        }
    }
}

fn layered() -> Material {
    let layer =
        |depth, stiffness| Layer { depth, stiffness: Some(stiffness), ..Layer::default() };
    let layers = vec![layer(0.001, 1500.0), layer(0.003, 50.0), layer(0.003_000_001, 800.0)];
    Material { layers, ..spring() }
}

#[test]
fn layers_give_back_what_they_took() {
    for (name, shape) in shapes_of_space() {
        gains_nothing(name, &body(&shape, surface(&layered())), (0.006, 0.006), 1);
    }
}

fn grooved(direction: Option<Vec<f64>>) -> Material {
    let (amplitude, wavelength) = (2e-4, 0.003);
    let kind = TextureKind::Height;
    let texture = Texture { description: None, kind, amplitude, wavelength, direction };
    Material { texture: Some(texture), ..spring() }
}

#[test]
fn a_grooved_wall_gives_back_what_it_took() {
    let along = || Some(vec![1.0, 0.0, 0.0]);
    let floor = half_space([0.0, 1.0, 0.0], 0.003);
    let slope = half_space([1.0, 1.0, 0.5], 0.003);
    for (name, wall) in [("a floor", floor), ("a slope", slope)] {
        for direction in [along(), None] {
            let bodies = body(&wall, surface(&grooved(direction)));
            gains_nothing(name, &bodies, (0.002, 0.006), 4);
        }
    }
    let bodies = body(half_space([0.0, 1.0], 0.003), surface(&grooved(Some(vec![1.0, 0.2]))));
    gains_nothing("a line", &bodies, (0.002, 0.006), 4);
}

/// Up to 4e-5 J were gained a loop while the slope of the wave was taken as the hand's: below a
/// surface of curvature κ the proxy goes 1 / (1 − κd) times as far, at the depth d.
#[test]
fn grooves_on_what_is_bent_give_back_what_they_took() {
    let along = || Some(vec![1.0, 0.0, 0.0]);
    for (name, shape) in [("a ball", ball(0.05)), ("a ring", torus(0.04, 0.012))] {
        for direction in [along(), None] {
            let bodies = body(&shape, surface(&grooved(direction)));
            gains_nothing(name, &bodies, (0.002, 0.006), 4);
        }
    }
    let hollow = cuboid([0.3; 3]).difference([ball(0.1)]).unwrap();
    gains_nothing("a hollow", &body(&hollow, surface(&grooved(along()))), (0.002, 0.006), 2);
    let disc = body(ball::<2>(0.05), surface(&grooved(Some(vec![1.0, 0.2]))));
    gains_nothing("a disc", &disc, (0.002, 0.006), 4);
}

/// The work of the force on a hand that goes over ten crests of a grooved floor and back, 2 mm deep
/// [J]. `speed(turns, forth)` is the speed that the servo is told, so many crests on, with forth 1
/// on the way there and −1 on the way back.
fn work_over_grooves(speed: impl Fn(f64, f64) -> f64) -> f64 {
    let floor = half_space([0.0, 1.0, 0.0], 0.0);
    let grooved = grooved(Some(vec![1.0, 0.0, 0.0]));
    let mut servo = servo(body(&floor, surface(&grooved)), 0.0);
    let turns = |tick: u32| f64::from(tick.min(2 * TICKS - tick)) * 10.0 / f64::from(TICKS);
    // From outside, so that the force is whole at once.
    servo.step(&[PointState::at_rest(Vector([0.0, 0.001, 0.0]))]);
    let mut last = None;
    let mut work = 0.0;
    for tick in 0..=2 * TICKS {
        let forth = if tick < TICKS { 1.0 } else { -1.0 };
        let position = Vector([0.003 * turns(tick), -0.002, 0.0]);
        let velocity = Vector([forth * speed(turns(tick), forth), 0.0, 0.0]);
        let touch = servo.step(&[PointState { position, velocity }])[0];
        if let Some((force, place)) = last {
            work += 0.5 * (touch.force + force).dot(position - place);
        }
        last = Some((touch.force, position));
    }
    work
}

#[test]
fn a_texture_that_fades_gives_back_what_it_took_at_one_speed() {
    // Crests 3 mm apart at 1 kHz: 0.75 m/s are a quarter of the rate, 1.5 m/s are half of it.
    for speed in [0.3, 0.9, 1.2, 2.0] {
        let gained = work_over_grooves(|_, _| speed);
        assert!(gained.abs() <= MOST, "{gained:e} J at {speed} m/s");
    }
}

#[test]
fn a_texture_gives_2_a_n_for_each_crest_that_is_climbed_fast_and_descended_slowly() {
    // The wave falls from a quarter of a turn to three quarters on the way there, and rises there
    // on the way back.
    let falls = |turns: f64, forth: f64| {
        (0.25..0.75).contains(&(turns - turns.floor())) == (forth > 0.0)
    };
    let gained = work_over_grooves(|x, forth| if falls(x, forth) { 0.0 } else { 3.0 });
    // 500 N/m, 2 mm deep less the amplitude a of 0.2 mm: N = 0.9 N.
    let most = 20.0 * 2.0 * 2e-4 * 0.9;
    assert!((gained / most - 1.0).abs() < 1e-3, "{gained:e} J, not {most:e} J");
    let lost = work_over_grooves(|x, forth| if falls(x, forth) { 3.0 } else { 0.0 });
    assert!((lost / most + 1.0).abs() < 1e-3, "{lost:e} J, not {most:e} J");
}

fn magnetic() -> Material {
    let magnet = Some(Magnet { description: None, force: 1.0, distance: 0.008 });
    Material { magnet, ..spring() }
}

#[test]
fn magnets_give_back_what_they_took() {
    for (name, shape) in [("a ball", ball(0.05)), ("a ring", torus(0.04, 0.012))] {
        gains_nothing(name, &body(&shape, surface(&magnetic())), (0.002, 0.012), 3);
    }
    gains_nothing("a disc", &body(ball::<2>(0.05), surface(&magnetic())), (0.002, 0.012), 3);
}
