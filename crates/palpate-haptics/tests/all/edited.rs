// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that are edited under the hand keep the touch, or say that they do not.

use crate::common::nearest::nearest;
use crate::common::tools::smooth;
use crate::common::{AnyServo, ball, body, cases, cuboid, direction, unit};
use arbitrary::Unstructured;
use assert_no_alloc::assert_no_alloc;
use palpate_device::{PointState, profile_named};
use palpate_field::{Point, Pose, Shape, SpaceShape, Vector};
use palpate_haptics::{
    Bodies, Body, Event, EventKind, Layer, Material, PopThrough, Probe, Protection, Servo,
    ServoOptions, Shell, Surface, Tool, ToolOptions,
};
use palpate_safety::Recovery;

/// The most by which a force changes in a tick after an edit [N].
const STEP: f64 = 0.3;

/// By how much a way out of a union may be longer than the shortest: of ways to several faces the
/// nearest may not be found. That is rare: of 10 000 one was longer by more than a hundredth.
const LONGER: f64 = 1.2;

const RECOVERIES: [Recovery; 2] = [Recovery::Rise, Recovery::OnceOut];

fn rough(stiffness: f64) -> Surface {
    let material = Material {
        stiffness,
        damping: 1.0,
        static_friction: 0.4,
        dynamic_friction: 0.3,
        ..smooth()
    };
    Surface::new(&material).unwrap()
}

/// A plate of so many metres, with its lower side at y = −0.02.
fn plate(height: f64) -> Bodies {
    let lower = Pose::translation(Vector([0.0, 0.5 * height - 0.02, 0.0]));
    let shape = cuboid([0.1, height, 0.1]);
    Bodies::new(vec![Body::new(shape, rough(1000.0)).unwrap().at(lower).unwrap()]).unwrap()
}

fn options(radius: f64) -> ServoOptions {
    ServoOptions {
        probe: Probe::new(radius).unwrap(),
        max_force: f64::INFINITY,
        ..ServoOptions::default()
    }
}

fn protection(recovery: Recovery) -> Protection {
    Protection::new(profile_named("omega").unwrap()).with(|s| s.recovery = recovery)
}

fn point(bodies: Bodies, radius: f64, recovery: Recovery) -> Servo {
    let plain = Servo::new(bodies, 1, options(radius)).unwrap();
    plain.protected(&protection(recovery)).unwrap()
}

fn stiffness(servo: &Servo) -> f64 {
    servo.bodies().bodies()[0].surface().stiffness()
}

fn at(place: Point<3>) -> [PointState; 1] {
    [PointState::at_rest(place)]
}

/// Lets a hand come down along y and rest so deep in what is at y = 0 [m].
fn press(servo: &mut Servo, depth: f64, radius: f64) -> Point<3> {
    for tick in 0..=1000 {
        let part = f64::from(tick) / 1000.0;
        let y = 0.03 + (radius - depth - 0.03) * part;
        servo.step(&at(Vector([0.01, y, -0.005])));
    }
    let place = Vector([0.01, radius - depth, -0.005]);
    for _ in 0..500 {
        servo.step(&at(place));
    }
    place
}

fn edit(servo: &mut Servo, bodies: Bodies) {
    let mut bodies = servo.accept(bodies).unwrap();
    assert_no_alloc(|| servo.replace_bodies(&mut bodies)).unwrap();
}

fn kinds(events: &[Event]) -> Vec<EventKind> {
    events.iter().map(|event| event.kind).collect()
}

/// How far the only event says that an edit carried the proxy.
fn carried(events: &[Event]) -> f64 {
    let kinds = kinds(events);
    let [EventKind::Carried { distance }] = kinds[..] else { panic!("{kinds:?}") };
    distance
}

/// Once the force fell to zero in a tick, and stayed there until the hand was out.
#[test]
fn a_plate_that_grows_by_a_step_of_a_slider_keeps_the_touch() {
    for recovery in RECOVERIES {
        for radius in [0.0, 0.002] {
            let mut servo = point(plate(0.02), radius, recovery);
            let place = press(&mut servo, 0.0014, radius);
            let stiffness = stiffness(&servo);
            assert!((servo.forces()[0] - Vector([0.0, 0.0014 * stiffness, 0.0])).norm() < 1e-6);
            edit(&mut servo, plate(0.02001));
            for tick in 0..200 {
                servo.step(&at(place));
                let touch = servo.touches()[0];
                assert!(touch.contact && (touch.depth() - 0.00141).abs() < 1e-9, "{touch:?}");
                let force = servo.forces()[0] - Vector([0.0, 0.00141 * stiffness, 0.0]);
                assert!(force.norm() < 1e-6, "{force:?} in tick {tick}");
                if tick == 0 {
                    assert!((carried(servo.events()) - 1e-5).abs() < 1e-9);
                } else {
                    assert_eq!(servo.events(), []);
                }
            }
        }
    }
}

#[test]
fn the_longest_way_is_the_radius_or_five_millimetres_for_a_point() {
    for recovery in RECOVERIES {
        for (radius, longest) in [(0.0, 0.005), (0.002, 0.002), (0.003, 0.003)] {
            for part in [0.3, 0.999, 1.001, 1.5] {
                let mut servo = point(plate(0.02), radius, recovery);
                let place = press(&mut servo, 0.001, radius);
                let (stiffness, mut last) = (stiffness(&servo), servo.forces()[0]);
                edit(&mut servo, plate(0.02 + part * longest));
                let whole = (0.001 + part * longest) * stiffness;
                for tick in 0..600 {
                    servo.step(&at(place));
                    let (force, wanted) = (servo.forces()[0], servo.touches()[0].wanted);
                    let told = format!("{recovery:?}, {radius}, {part}: {force:?} in {tick}");
                    assert!((wanted[1] - whole).abs() < 1e-6, "{told}, {wanted:?}");
                    let expected = if part < 1.0 {
                        (last[1] + STEP).min(whole)
                    } else {
                        0.02 * f64::from(tick + 1)
                    };
                    assert!(
                        (force[1] - expected.min(whole)).abs() < 1e-6,
                        "{told}, {expected}"
                    );
                    let told = kinds(servo.events());
                    match (tick, part < 1.0) {
                        (0, true) => {
                            let way = carried(servo.events());
                            assert!((way - part * longest).abs() < 1e-9, "{way}");
                        }
                        (0, false) => assert_eq!(told, [EventKind::Placed]),
                        _ => assert_eq!(told, []),
                    }
                    last = force;
                }
            }
        }
    }
}

/// An edit that covers nothing says nothing, and one that takes the body away takes the force.
#[test]
fn an_edit_beside_the_hand_is_not_told() {
    let mut servo = point(plate(0.02), 0.002, Recovery::OnceOut);
    let place = press(&mut servo, 0.001, 0.002);
    let before = servo.forces()[0];
    edit(&mut servo, plate(0.02));
    servo.step(&at(place));
    assert_eq!((servo.forces()[0], kinds(servo.events())), (before, vec![]));
    edit(&mut servo, plate(0.0198));
    servo.step(&at(place));
    let less = 0.0008 * stiffness(&servo);
    assert!((servo.forces()[0][1] - less).abs() < 1e-6 && servo.events().is_empty());
    edit(&mut servo, plate(0.01));
    servo.step(&at(place));
    assert_eq!(servo.forces()[0], Vector::ZERO);
    assert_eq!(kinds(servo.events()), [EventKind::Leave]);
}

#[test]
fn a_slider_that_is_drawn_keeps_the_touch_at_each_step() {
    for recovery in RECOVERIES {
        let mut servo = point(plate(0.02), 0.0, recovery);
        let place = press(&mut servo, 0.001, 0.0);
        let (stiffness, mut height) = (stiffness(&servo), 0.02);
        for step in 0..200 {
            // Up by 4 mm and down again; twice before each tenth tick.
            for _ in 0..if step % 10 == 0 { 2 } else { 1 } {
                height += if step < 100 { 4e-5 } else { -4e-5 };
                edit(&mut servo, plate(height));
            }
            for _ in 0..3 {
                servo.step(&at(place));
                let force = servo.forces()[0][1];
                let full = (0.001 + height - 0.02) * stiffness;
                assert!((force - full).abs() < 1e-6, "{force} of {full} N in step {step}");
            }
        }
    }
}

#[test]
fn a_hand_that_hovers_is_carried_too() {
    for radius in [0.0, 0.002] {
        let mut servo = point(plate(0.02), radius, Recovery::OnceOut);
        let place = press(&mut servo, -0.0005, radius);
        edit(&mut servo, plate(0.0215));
        servo.step(&at(place));
        assert!((servo.touches()[0].depth() - 0.001).abs() < 1e-9);
        let kinds = kinds(servo.events());
        assert!(matches!(kinds[..], [EventKind::Carried { .. }, EventKind::Touch { .. }]));
        (0..10).for_each(|_| _ = servo.step(&at(place)));
        assert!((servo.forces()[0][1] - 0.001 * stiffness(&servo)).abs() < 1e-6);
    }
}

#[test]
fn a_thin_plate_carries_a_point_out_on_the_side_where_the_hand_was() {
    let thin = |height: f64, at: f64| {
        let shape = cuboid([0.1, height, 0.1]);
        let at = Pose::translation(Vector([0.0, at - 0.5 * height, 0.0]));
        Bodies::new(vec![Body::new(shape, rough(300.0)).unwrap().at(at).unwrap()]).unwrap()
    };
    for recovery in RECOVERIES {
        // Thickness before and after, and where the upper side is after.
        for (before, after, top) in [
            (3e-4, 3e-4, 1e-4),
            (3e-4, 3e-4, 2e-4),
            (3e-4, 3e-4, 2.9e-4),
            // It passes over the proxy.
            (3e-4, 3e-4, 4e-4),
            (3e-4, 3e-4, 2e-3),
            (3e-4, 3e-4, 4.9e-3),
            (3e-4, 2e-3, 1.9e-3),
            (1e-3, 5e-5, 6e-5),
        ] {
            let mut servo = point(thin(before, 0.0), 0.0, recovery);
            let place = press(&mut servo, 0.003, 0.0);
            edit(&mut servo, thin(after, top));
            servo.step(&at(place));
            let touch = servo.touches()[0];
            assert!((carried(servo.events()) - top).abs() < 1e-8, "{top}: {touch:?}");
            assert!((touch.proxy - Vector([0.01, top, -0.005])).norm() < 1e-8, "{touch:?}");
            (0..100).for_each(|_| _ = servo.step(&at(place)));
            let full = (0.003 + top) * stiffness(&servo);
            assert!((servo.forces()[0][1] - full).abs() < 1e-5, "{:?}", servo.forces());
        }
        // Where the old side is too far, it is placed anew, by the nearest way.
        let mut servo = point(thin(3e-4, 0.0), 0.0, recovery);
        let place = press(&mut servo, 0.003, 0.0);
        edit(&mut servo, thin(6e-3, 5.9e-3));
        servo.step(&at(place));
        assert_eq!(kinds(servo.events())[0], EventKind::Placed);
    }
}

#[test]
fn a_slot_that_is_filled_lets_no_hand_through_its_lid() {
    let scene = |floor: f64| {
        let block = |shape: Shape<3>, y: f64| {
            let at = Pose::translation(Vector([0.0, y, 0.0]));
            Body::new(shape, rough(300.0)).unwrap().at(at).unwrap()
        };
        let lid = block(cuboid([0.1, 5e-4, 0.1]), 1e-3 + 2.5e-4);
        vec![block(cuboid([0.1, 0.02 + floor, 0.1]), 0.5 * floor - 0.01), lid]
    };
    let far = |x: f64| Vector([x, 5e-4, 0.0]);
    for (floor, is_carried) in [(5e-4, true), (9e-4, true), (1.2e-3, false), (2e-3, false)] {
        let mut servo = point(Bodies::new(scene(0.0)).unwrap(), 0.0, Recovery::OnceOut);
        // Into the slot from the side, and down.
        for tick in 0..=1000 {
            servo.step(&at(far(0.06 - 6e-5 * f64::from(tick))));
        }
        let place = Vector([0.0, -0.002, 0.0]);
        for tick in 0..=500 {
            servo.step(&at(far(0.0) + (place - far(0.0)) * (f64::from(tick) / 500.0)));
        }
        assert!(servo.touches()[0].proxy[1].abs() < 1e-9);
        let mut bodies = scene(floor);
        if floor > 7e-4 {
            bodies.reverse();
        }
        edit(&mut servo, Bodies::new(bodies).unwrap());
        servo.step(&at(place));
        let kinds = kinds(servo.events());
        if is_carried {
            assert!((servo.touches()[0].proxy[1] - floor).abs() < 1e-9);
            assert!(matches!(kinds[0], EventKind::Carried { .. }), "{kinds:?}");
        } else {
            assert_eq!(kinds[0], EventKind::Placed, "{floor}");
        }
    }
}

#[test]
fn friction_holds_on_while_the_plate_grows() {
    let mut servo = point(plate(0.02), 0.002, Recovery::OnceOut);
    let place = press(&mut servo, 0.002, 0.002) + Vector([0.0004, 0.0, 0.0]);
    (0..10).for_each(|_| _ = servo.step(&at(place)));
    let before = servo.touches()[0];
    assert!(!before.is_slipping && before.wanted[0].abs() > 0.1, "{before:?}");
    edit(&mut servo, plate(0.0201));
    servo.step(&at(place));
    let after = servo.touches()[0];
    assert!(!after.is_slipping);
    assert!((after.proxy - before.proxy - Vector([0.0, 1e-4, 0.0])).norm() < 1e-9);
    assert!((after.wanted[0] - before.wanted[0]).abs() < 1e-6, "{after:?}");
}

#[test]
fn a_layer_that_gave_way_stays_so_in_an_edit() {
    let layered = |height: f64, friction: f64| {
        let pop_through = Some(PopThrough { description: None, force: 0.8, distance: 0.002 });
        let deeper = Layer { depth: 0.004, stiffness: Some(1000.0), ..Layer::default() };
        let material = Material {
            stiffness: 500.0,
            dynamic_friction: friction,
            static_friction: friction,
            pop_through,
            layers: vec![deeper],
            ..smooth()
        };
        body(cuboid([0.1, 2.0 * height, 0.1]), Surface::new(&material).unwrap())
    };
    let mut servo = point(layered(0.02, 0.1), 0.002, Recovery::OnceOut);
    let place = Vector([0.01, 0.02 + 0.002 - 0.005, -0.005]);
    for tick in 0..=1000 {
        let part = f64::from(tick) / 1000.0;
        servo.step(&at(place + Vector([0.0, 0.02 * (1.0 - part), 0.0])));
    }
    (0..500).for_each(|_| _ = servo.step(&at(place)));
    let before = servo.touches()[0];
    assert!((before.depth() - 0.001).abs() < 1e-6, "{before:?}");
    edit(&mut servo, layered(0.02, 0.2));
    servo.step(&at(place));
    assert!((servo.touches()[0].depth() - 0.001).abs() < 1e-6);
    assert_eq!(servo.events(), []);
    edit(&mut servo, layered(0.0203, 0.2));
    servo.step(&at(place));
    assert!((servo.touches()[0].depth() - 0.0013).abs() < 1e-6);
    assert!((carried(servo.events()) - 3e-4).abs() < 1e-9);
}

/// A shape of a few sorts that is grown by so much.
fn grown<const D: usize>(sort: u8, size: f64, growth: f64) -> Shape<D> {
    let block = |edges: [f64; D]| cuboid(edges.map(|edge| edge + 2.0 * growth));
    let mut edges = [2.0 * size; D];
    match sort {
        0 => ball(size + growth),
        1 => block(edges),
        2 => {
            edges[1] = 0.4 * size;
            block(edges)
        }
        3 => Shape::union([block([1.6 * size; D]), ball(size + growth)]).unwrap(),
        _ => {
            edges[0] = 0.5 * size;
            let mut across = [2.0 * size; D];
            across[1] = 0.5 * size;
            Shape::union([block(edges), block(across)]).unwrap()
        }
    }
}

fn bodies_of(shape: impl Into<SpaceShape>, place: Point<3>) -> Bodies {
    let shape: SpaceShape = shape.into();
    let surface = Surface::smooth(500.0, 0.0).unwrap();
    let body = Body::new(shape, surface).unwrap().at(Pose::translation(place)).unwrap();
    Bodies::new(vec![body]).unwrap()
}

/// What became of a hand in a random shape that was edited: whether it was carried.
fn a_random_edit<const D: usize>(u: &mut Unstructured<'_>) -> arbitrary::Result<Option<bool>> {
    let sort = u.int_in_range(0..=4)?;
    let radius = *u.choose(&[0.0, 0.001, 0.003])?;
    let longest: f64 = if radius > 0.0 { radius } else { 0.005 };
    let size = 0.02 + 0.01 * unit(u)?;
    let before = || bodies_of(grown::<D>(sort, size, 0.0), Vector::ZERO);
    // Up to 1.3 of the longest way, of growth or of motion.
    let way = 1.3 * longest * unit(u)?;
    let (growth, motion) = match u.arbitrary()? {
        true => (way.abs(), Vector::ZERO),
        false => (0.0, direction::<D>(u)?.in_space() * way),
    };
    let after = || bodies_of(grown::<D>(sort, size, growth), motion);
    let depth = 0.0015 + 0.001 * unit(u)?;
    let (inwards, aim) =
        (-direction::<D>(u)?.in_space(), direction::<D>(u)?.in_space() * (0.5 * size));
    let servo = Servo::new(before(), 1, ServoOptions { rate: 1000.0, ..options(radius) });
    let mut plain = servo.unwrap();
    let (mut place, mut pressed) = (aim - inwards * 0.08, false);
    for _ in 0..160 {
        plain.step(&at(place));
        if plain.touches()[0].depth() >= depth {
            pressed = true;
            break;
        }
        place += inwards * 0.0005;
    }
    (0..20).for_each(|_| _ = plain.step(&at(place)));
    if !pressed || !plain.touches()[0].contact {
        return Ok(None);
    }
    let proxy = plain.touches()[0].proxy;
    let gap = |p| after().everything().look(p).0 - radius;
    let wanted = plain.touches()[0].wanted;
    plain.swap_bodies(after());
    plain.step(&at(place));
    let (touch, kinds) = (plain.touches()[0], kinds(plain.events()));
    let told = || {
        format!(
            "sort {sort}, radius {radius}, grown {growth}, moved {motion:?}, {proxy:?}, {touch:?}"
        )
    };
    let most = nearest::<D>([&before(), &after()], (proxy, radius), 1.5 * longest);
    if gap(proxy) >= -1e-9 {
        let is_over = kinds.iter().any(|kind| matches!(kind, EventKind::Carried { .. }));
        // Only a point can be passed over.
        assert!(!is_over, "{kinds:?}, {}", told());
        return Ok(None);
    }
    let distance = kinds.iter().find_map(|kind| match kind {
        EventKind::Carried { distance } => Some(*distance),
        _ => None,
    });
    assert!(gap(touch.proxy) >= -1e-9, "{}", told());
    let Some(distance) = distance else {
        assert!(kinds.contains(&EventKind::Placed), "{kinds:?}, {}", told());
        assert!(touch.force == Vector::ZERO, "{}", told());
        // No way out was short enough.
        let near = if sort < 3 { 1.001 } else { LONGER };
        assert!(most.is_none_or(|most| most > longest / near), "{most:?}, {}", told());
        return Ok(Some(false));
    };
    assert!(distance <= longest + 1e-9 && distance >= -gap(proxy) - 1e-9, "{}", told());
    // The directions of the oracle are less than three degrees apart; inside a union the distance
    // is a bound, and the nearest of several faces may not be found.
    let near = if sort < 3 { 1.001 } else { LONGER };
    let is_near = most.is_none_or(|most| distance <= most * near + 1e-7);
    assert!(is_near, "{distance} m, but {most:?} m: {}", told());
    // The hand is deep: contact is kept, and forces follow by a step a tick.
    let (mut last, mut reached) = (wanted, false);
    for tick in 0..60 {
        let touch = plain.touches()[0];
        assert!(touch.contact == (gap(place) < 1e-9) || touch.contact, "{tick}, {}", told());
        let change = (touch.force - last).norm();
        let settled = reached || touch.wanted == Vector::ZERO;
        assert!(change <= STEP + 1e-9 || settled, "{change} N in tick {tick}, {}", told());
        reached |= (touch.force - touch.wanted).norm() < 1e-9;
        last = touch.force;
        plain.step(&at(place));
    }
    assert!(reached, "{}", told());
    Ok(Some(true))
}

fn random_edits<const D: usize>(count: u64) {
    let mut seen = [0, 0];
    cases(count, |u| {
        if let Some(is_carried) = a_random_edit::<D>(u)? {
            seen[usize::from(is_carried)] += 1;
        }
        Ok(())
    });
    assert!(seen.iter().all(|count| *count >= palpate_testkit::cases::count(6)), "{seen:?}");
}

#[test]
fn in_the_plane_random_edits_carry_the_shortest_way() {
    random_edits::<2>(300);
}

#[test]
fn in_space_random_edits_carry_the_shortest_way() {
    random_edits::<3>(60);
}

#[test]
fn random_edits_change_the_written_force_by_a_step_a_tick() {
    let mut seen = 0;
    cases(60, |u| {
        let recovery = *u.choose(&RECOVERIES)?;
        let radius = *u.choose(&[0.0, 0.002, 0.004])?;
        let longest = if radius > 0.0 { radius } else { 0.005 };
        let mut servo = point(plate(0.02), radius, recovery);
        let place = press(&mut servo, 0.001 + 0.0009 * unit(u)?, radius);
        let mut last = servo.forces()[0];
        for _ in 0..8 {
            let (x, tilt) = (0.01 * unit(u)?, 0.02 * unit(u)?);
            let height = 0.02 + 0.4 * longest * unit(u)?.abs();
            let turned =
                palpate_field::Rotation::from_axis_angle(Vector([0.3, 0.0, 1.0]), tilt);
            let pose = Pose::new(turned.unwrap(), Vector([x, 0.5 * height - 0.02, 0.0]));
            let shape = Body::new(cuboid([0.1, height, 0.1]), rough(1000.0)).unwrap();
            edit(&mut servo, Bodies::new(vec![shape.at(pose).unwrap()]).unwrap());
            servo.step(&at(place));
            let kinds = kinds(servo.events());
            let is_carried = kinds.iter().any(|kind| matches!(kind, EventKind::Carried { .. }));
            assert!(!kinds.contains(&EventKind::Placed), "{kinds:?}");
            for tick in 0..60 {
                let (force, wanted) = (servo.forces()[0], servo.touches()[0].wanted);
                let change = (force - last).norm();
                if is_carried {
                    assert!(change <= STEP + 1e-9, "{change} N in tick {tick}");
                    seen += 1;
                }
                if tick == 59 && is_carried {
                    assert!((force - wanted).norm() < 1e-9, "{force:?} of {wanted:?}");
                }
                last = force;
                servo.step(&at(place));
            }
            (0..600).for_each(|_| _ = servo.step(&at(place)));
            last = servo.forces()[0];
        }
        Ok(())
    });
    assert!(seen > 1000, "{seen}");
}

#[test]
fn a_tool_is_carried_likewise() {
    let end = Vector([0.02, 0.0, 0.0]);
    let shells =
        || [Shell::ball(0.002).unwrap(), Shell::capsule([-end, end], 0.002, 21).unwrap()];
    for recovery in RECOVERIES {
        for shell in shells() {
            for part in [0.005, 0.5, 0.99, 1.2] {
                let coupling =
                    ToolOptions { stiffness: 1000.0, damping: 0.0, ..ToolOptions::default() };
                let tool = Tool::new(shell.clone(), coupling).unwrap();
                let plain = Servo::with_tool(plate(0.02), tool, options(0.002));
                let mut servo = plain.unwrap().protected(&protection(recovery)).unwrap();
                let place = press(&mut servo, 0.0014, 0.002);
                let mut last = servo.forces()[0];
                assert!(last[1] > 1.0, "{last:?}");
                edit(&mut servo, plate(0.02 + part * 0.002));
                for tick in 0..600 {
                    servo.step(&at(place));
                    let (force, wanted) = (servo.forces()[0], servo.touches()[0].wanted);
                    let told =
                        format!("{recovery:?}, {part}: {force:?} of {wanted:?} in {tick}");
                    let rise = force[1] - last[1];
                    if part < 1.0 {
                        assert!(servo.touches()[0].contact, "{told}");
                        assert!((-1e-9..STEP + 1e-9).contains(&rise), "{told}, {last:?}");
                        assert!(tick < 10 || (force - wanted).norm() < 1e-9, "{told}");
                    } else {
                        assert!(tick == 0 || rise <= 0.020_001, "{told}");
                        assert!(tick > 0 || force[1] <= 0.020_001, "{told}");
                    }
                    if tick == 0 && part < 1.0 {
                        let way = carried(servo.events());
                        assert!((way - part * 0.002).abs() < 1e-6, "{way}, {told}");
                    } else if tick == 0 {
                        assert!(kinds(servo.events()).contains(&EventKind::Placed), "{told}");
                    } else {
                        assert_eq!(servo.events(), [], "{told}");
                    }
                    last = force;
                }
                let full = servo.touches()[0].wanted;
                assert!((last - full).norm() < 1e-9 && full[1] > 1.4, "{last:?} of {full:?}");
            }
        }
    }
}
