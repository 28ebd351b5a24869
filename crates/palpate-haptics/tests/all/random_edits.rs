// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Random edits under the hand: the way out is the shortest, and the force changes by small steps.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use crate::common::{AnyServo, ball, cases, cuboid, direction, unit};
use crate::edited::{RECOVERIES, STEP, at, edit, kinds, options, plate, point, press, rough};
use arbitrary::Unstructured;
use palpate_field::{Point, Pose, Shape, Vector};
use palpate_haptics::{Bodies, Body, EventKind, Surface, UnprotectedServo};

/// By how much a way out of a union may be longer than the shortest: of ways to several faces the
/// nearest may not be found. That is rare: of 10 000 one was longer by more than a hundredth.
const LONGER: f64 = 1.2;

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

fn bodies_of<const D: usize>(shape: Shape<D>, place: Point<D>) -> Bodies<D> {
    let surface = Surface::smooth(500.0, 0.0).unwrap();
    let body = Body::new(shape, surface).unwrap().at(Pose::translation(place)).unwrap();
    Bodies::new(vec![body]).unwrap()
}

/// The nearest of many points outside to which the straight way was free before, in many
/// directions; `None` within `most`.
fn nearest<const D: usize>(
    [before, after]: [&Bodies<D>; 2],
    (from, radius): (Point<D>, f64),
    most: f64,
) -> Option<f64> {
    let gap = |bodies: &Bodies<D>, p| bodies.everything().look(p).0 - radius;
    let mut best = None;
    for way in directions::<D>() {
        let mut length = 0.0;
        loop {
            let here = gap(after, from + way * length);
            if here >= 0.0 {
                break;
            }
            length += (-here).max(1e-7);
            if length > best.unwrap_or(most) {
                break;
            }
        }
        let was_free =
            |k: u32| gap(before, from + way * (length * f64::from(k) / 32.0)) > -1e-7;
        if length <= best.unwrap_or(most) && (0..=32).all(was_free) {
            best = Some(length);
        }
    }
    best
}

/// Directions all around.
fn directions<const D: usize>() -> Vec<Vector<f64, D>> {
    let spiral = |k: u32, of: f64| {
        let y = 1.0 - 2.0 * (f64::from(k) + 0.5) / of;
        let (turn, around) = (2.399_963_229_728_653 * f64::from(k), (1.0 - y * y).sqrt());
        [around * turn.cos(), y, around * turn.sin()]
    };
    let circle = |k: u32, of: f64| {
        let turn = std::f64::consts::TAU * f64::from(k) / of;
        [turn.cos(), turn.sin(), 0.0]
    };
    let count = if D == 2 { 720 } else { 2000 };
    let all = (0..count).map(|k| {
        let of = f64::from(count);
        let way = if D == 2 { circle(k, of) } else { spiral(k, of) };
        Vector(std::array::from_fn(|axis| way[axis]))
    });
    all.chain((0..D).flat_map(|axis| [Vector::unit(axis), -Vector::unit(axis)])).collect()
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
        false => (0.0, direction::<D>(u)? * way),
    };
    let after = || bodies_of(grown::<D>(sort, size, growth), motion);
    let depth = 0.0015 + 0.001 * unit(u)?;
    let (inwards, aim) = (-direction::<D>(u)?, direction::<D>(u)? * (0.5 * size));
    let servo = UnprotectedServo::new(before(), 1, options(radius).with_rate(1000.0));
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
    let most = nearest([&before(), &after()], (proxy, radius), 1.5 * longest);
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
    assert!(seen.iter().all(|count| *count > 5), "{seen:?}");
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
