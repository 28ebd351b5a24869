// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A slide knows how the surface bends, and needs few evaluations.

use crate::common::{ball, cuboid, half_space, proxy, scaled, torus};
use palpate_field::operator::{Copies, Profile};
use palpate_field::{Point, Shape, SpaceShape, Vector};
use palpate_haptics::{Bodies, Following, Probe, Proxy};

/// Evaluations of a tick on average and at most, once the hand has landed, and how far the
/// proxy then is from the closest point, at most.
struct Seen {
    mean: f64,
    most: u32,
    off: f64,
}

/// Follows a hand over a shape at 0.1 mm a tick; `closest` is where the proxy should be.
fn slides(
    shape: impl Into<SpaceShape>,
    mut proxy: Proxy,
    hand: impl Fn(f64) -> Point<3>,
    closest: impl Fn(Point<3>) -> Point<3>,
) -> Seen {
    let shape: SpaceShape = shape.into();
    const LANDING: u32 = 20;
    const TICKS: u32 = 500;
    let bodies = Bodies::from(shape.clone());
    let mut seen = Seen { mean: 0.0, most: 0, off: 0.0 };
    for tick in 0..LANDING + TICKS {
        let device = hand(1e-4 * f64::from(tick));
        let Following { proxy, evaluations, contact, .. } =
            proxy.follow(&bodies.everything(), device);
        if tick >= LANDING {
            assert!(contact, "{device:?}");
            seen.mean += f64::from(evaluations) / f64::from(TICKS);
            seen.most = seen.most.max(evaluations);
            seen.off = seen.off.max((proxy - closest(device)).norm());
        }
    }
    seen
}

/// A hand that comes down and goes round the third axis at `radius`.
fn round(radius: f64, from: f64) -> impl Fn(f64) -> Point<3> {
    move |way| {
        let radius = radius + (from - radius) * (1.0 - way / 1e-3).max(0.0);
        let (sin, cos) = (way / radius).sin_cos();
        Vector([radius * cos, radius * sin, 0.01])
    }
}

#[test]
fn one_evaluation_is_enough_on_a_ball() {
    let closest = |device: Point<3>| device.normalized().unwrap() * 0.052;
    let seen = slides(ball::<3>(0.05), proxy(0.002), round(0.048, 0.055), closest);
    assert!(seen.mean <= 1.01 && seen.most <= 2, "{} {}", seen.mean, seen.most);
    assert!(seen.off < 1e-7, "{}", seen.off);
}

#[test]
fn two_bends_at_once_are_learnt() {
    // Across the ring a tube of 12 mm, along it 44 mm: neither is the way of the hand.
    let hand = |way: f64| {
        let (ring, tube) = (way / 0.05, 0.5 + way / 0.03);
        let deep = 0.012 + 0.001 * (1.0 - way / 1e-3).max(-1.0);
        let off = 0.04 + deep * tube.cos();
        Vector([off * ring.cos(), deep * tube.sin(), off * ring.sin()])
    };
    let closest = |device: Point<3>| {
        let Vector([x, y, z]) = device;
        let off = x.hypot(z);
        let centre = Vector([x * 0.04 / off, 0.0, z * 0.04 / off]);
        let out = Vector([x, y, z]) - centre;
        centre + out * (0.014 / out.norm())
    };
    let seen = slides(torus(0.04, 0.012), proxy(0.002), hand, closest);
    assert!(seen.mean <= 2.0 && seen.most <= 4, "{} {}", seen.mean, seen.most);
    assert!(seen.off < 3e-7, "{}", seen.off);
}

#[test]
fn a_hollow_much_sharper_than_the_probe_is_followed() {
    // A gutter of 2.25 mm, in which the probe of 2 mm has 0.25 mm of room. Once its bend was
    // taken for a crease, whose planes left no room: all the budget, and no way out.
    let gutter = || {
        let block = cuboid([0.02, 0.02]);
        block.difference([ball(0.00225).translated([0.0, 0.01]).unwrap()]).unwrap()
    };
    let hand = |way: f64| {
        Vector([0.002 * (40.0 * way).sin(), 0.0095 - 0.003 * (way / 1e-3).min(1.0), 0.0])
    };
    let closest = |device: Point<3>| {
        let centre = Vector([0.0, 0.01, 0.0]);
        centre + (device - centre).normalized().unwrap() * 0.00025
    };
    let seen = slides(gutter(), proxy(0.002), hand, closest);
    assert!(seen.mean <= 3.0 && seen.most <= 12, "{} {}", seen.mean, seen.most);
    assert!(seen.off < 1e-7, "{}", seen.off);
}

#[test]
fn a_field_that_hardly_rises_is_followed_as_fast() {
    // Blends can rise by a twelfth of their promise. Once a proxy that had slid below their
    // surface came back by a twelfth of the way a step, at the cost of all its budget.
    let timid = scaled(&ball::<3>(0.05), 0.08, 1.0);
    let closest = |device: Point<3>| device.normalized().unwrap() * (0.05 + 1e-4 / 0.08);
    let seen = slides(&timid, proxy(1e-4), round(0.048, 0.055), closest);
    assert!(seen.most <= 12, "{} {}", seen.mean, seen.most);
    assert!(seen.off < 1e-6, "{}", seen.off);
}

#[test]
fn a_blend_is_followed() {
    let beside = ball(0.03).translated(Vector([0.04, 0.0, 0.0])).unwrap();
    let blend = Shape::smooth_union([ball(0.03), beside], Profile::Quadratic, 0.01).unwrap();
    let bodies = Bodies::from(blend.clone());
    let closest = |device: Point<3>| {
        // Where a hand that waits is led to.
        let mut here = proxy(0.002);
        here.follow(&bodies.everything(), device + Vector([0.0, 0.05, 0.0]));
        (0..50).fold(device, |_, _| here.follow(&bodies.everything(), device).proxy)
    };
    let hand = |way: f64| Vector([way - 0.01, 0.024 + 0.01 * (1.0 - way / 1e-3).max(0.0), 0.0]);
    let seen = slides(&blend, proxy(0.002), hand, closest);
    assert!(seen.mean <= 2.5 && seen.most <= 10, "{} {}", seen.mean, seen.most);
    assert!(seen.off < 1e-6, "{}", seen.off);
}

#[test]
fn a_hand_that_spends_its_budget_in_a_body_stays_in_contact() {
    // A floor with a relief far finer than the hand is deep. The tangent plane of a slope may
    // lie below the hand where the budget ends; once that was taken for free space, and the
    // force went out for a tick.
    let floor = half_space([0.0, 1.0], 0.0);
    let wave = ball(3e-5).repeated([Copies::Endless { spacing: 1e-4 }, Copies::One]).unwrap();
    let rough = Shape::union([floor, wave]).unwrap();
    let bodies = Bodies::from(rough);
    let mut proxy = Proxy::new(Probe::new(0.0).unwrap().with_budget(8).unwrap());
    proxy.follow(&bodies.everything(), Vector([0.0, 0.01, 0.0]));
    for tick in 0..300 {
        let device = Vector([3e-4 * f64::from(tick), -0.002, 0.0]);
        assert!(proxy.follow(&bodies.everything(), device).contact, "{tick}");
    }
}
