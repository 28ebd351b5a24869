// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that are deep in each other when they are first seen: a short translation that separates them
//! decides in which direction their contacts push.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use std::f64::consts::TAU;

use palpate_field::kernel::{CoolS, RegularStar};
use palpate_field::{Pose, Shape, Vector};
use palpate_query::{Limits, ManifoldSettings, PairWorkspace, Track};
use palpate_testkit::arbitrary as draw;
use palpate_testkit::cases;

use crate::integrator::{Body, Solver};

/// Steps in a second, and seconds until the bodies are apart.
const RATE: f64 = 240.0;
const SECONDS: f64 = 3.0;

/// Penetration that may be left beyond the slop [m].
const LEFT: f64 = 2e-4;

fn come_apart(
    shape: &Shape<2>,
    u: &mut arbitrary::Unstructured<'_>,
) -> arbitrary::Result<Result<(), String>> {
    let mut at = |low, high| draw::within(u, low, high);
    let (x, other) = ([at(-0.1, 0.1)?, at(0.3, 0.4)?], [at(-0.1, 0.1)?, at(0.3, 0.4)?]);
    let turns = [at(0.0, TAU)?, at(0.0, TAU)?];
    let floor = Shape::half_space([0.0, 1.0], 0.0).unwrap();
    let bodies = vec![
        Body::fixed(floor),
        Body::moving(shape.clone(), x, turns[0]),
        Body::moving(shape.clone(), other, turns[1]),
    ];
    let mut solver = Solver::new(bodies, RATE);
    for _ in 0..(RATE * SECONDS) as u32 {
        solver.step();
    }
    let (deepest, bodies) = solver.deepest();
    let slop = solver.slop(bodies);
    Ok(if deepest < -slop - LEFT {
        let [one, other] = bodies;
        Err(format!("bodies {one} and {other} overlap by {deepest} m"))
    } else {
        Ok(())
    })
}

#[test]
fn stars_that_begin_in_stars_come_apart() {
    let star = Shape::from_kernel(RegularStar::new(5, 0.12, 0.06).unwrap());
    cases::check(500, |u| come_apart(&star, u));
}

#[test]
fn cool_s_that_begin_in_cool_s_come_apart() {
    let cool = Shape::from_kernel(CoolS::new(0.3).unwrap());
    cases::check(500, |u| come_apart(&cool, u));
}

/// The second body begins `depth` deep in the first one, and leaves it upwards by 1 mm a step.
fn leaves_upwards<const D: usize>(a: &Shape<D>, b: &Shape<D>, at: Vector<f64, D>, depth: f64) {
    let mut track = Track::new(a.clone(), b.clone());
    let settings = ManifoldSettings::for_solver(track.size());
    let limits = Limits::new(settings.usual_tolerance());
    let mut workspace = PairWorkspace::new();
    for step in 0..20 {
        let gone = 1e-3 * f64::from(step);
        let poses = [Pose::identity(), Pose::translation(at + Vector::unit(1) * gone)];
        let found = track.contacts(poses, &settings, &limits, &mut workspace).unwrap();
        assert!(!found.contacts.is_empty());
        for contact in &found.contacts {
            assert!(contact.normal[1] > 0.9999, "step {step}: {contact}");
            assert!((contact.gap + depth - gone).abs() < 1e-4, "step {step}: {contact}");
        }
    }
}

/// The gradients of both lead sideways, where the rod is 0.1 m thick.
#[test]
fn a_rod_through_a_plate_is_pushed_along_itself() {
    let plate = Shape::<2>::rectangle([2.0, 0.1]).unwrap();
    let rod = Shape::<2>::rectangle([0.1, 0.6]).unwrap();
    leaves_upwards(&plate, &rod, Vector([0.1, 0.07]), 0.28);
    let plate = Shape::<3>::cuboid([2.0, 0.1, 2.0]).unwrap();
    let rod = Shape::<3>::cuboid([0.1, 0.6, 0.1]).unwrap();
    leaves_upwards(&plate, &rod, Vector([0.1, 0.07, -0.2]), 0.28);
}

#[test]
fn a_cube_in_a_beam_is_pushed_to_the_nearest_side() {
    let beam = Shape::<3>::cuboid([4.0, 1.0, 1.0]).unwrap();
    let cube = Shape::<3>::cuboid([1.0; 3]).unwrap();
    leaves_upwards(&beam, &cube, Vector([0.3, 0.6, 0.0]), 0.4);
}
