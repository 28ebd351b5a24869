// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts for a solver where a body stands on an edge, a line or a corner of its own.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use std::f64::consts::TAU;

use arbitrary::Unstructured;
use palpate_field::{Pose, Rotation, Shape, Vector};
use palpate_query::{Limits, ManifoldSettings, PairWorkspace, Track, TrackedContacts};
use palpate_testkit::arbitrary::within;
use palpate_testkit::cases;

fn floor() -> Shape<3> {
    Shape::half_space(Vector::unit(1), 0.0).unwrap()
}

fn about(axis: [f64; 3], angle: f64) -> Rotation<3> {
    Rotation::from_axis_angle(Vector(axis), angle).unwrap()
}

/// The contacts of a pair in each of these steps.
fn steps(
    [a, b]: [&Shape<3>; 2],
    poses: &[Pose<3>],
    settings: &ManifoldSettings,
) -> Vec<TrackedContacts<3>> {
    let mut track = Track::new(a.clone(), b.clone());
    let limits = Limits::new(settings.usual_tolerance());
    let mut workspace = PairWorkspace::new();
    let step = |pose: &Pose<3>| {
        let poses = [Pose::identity(), *pose];
        track.contacts(poses, settings, &limits, &mut workspace).unwrap().clone()
    };
    poses.iter().map(step).collect()
}

fn settings(a: &Shape<3>, b: &Shape<3>) -> ManifoldSettings {
    ManifoldSettings::for_solver(Track::new(a.clone(), b.clone()).size())
}

/// That contacts along the body's x axis leave out at most three spacings of a line of this length at each end, and
/// that they have the floor's normal.
fn hold_the_line(
    found: &TrackedContacts<3>,
    pose: &Pose<3>,
    (length, settings): (f64, &ManifoldSettings),
    what: &str,
) -> Result<(), String> {
    let back = pose.inverse();
    let along = found.contacts.iter().map(|contact| back.transform_point(contact.point_b)[0]);
    let (low, high) = along.fold((0.0_f64, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
    let least = 0.5 * length - 3.0 * settings.spacing;
    let is_held = low <= -least && high >= least;
    let is_upright = found.contacts.iter().all(|contact| contact.normal[1] > 0.999);
    if (is_held || !found.is_whole) && is_upright {
        return Ok(());
    }
    Err(format!("{what}: {:?}", found.contacts))
}

/// A box on a straight edge, tilted about it and turned about the vertical.
fn on_an_edge(u: &mut Unstructured<'_>) -> arbitrary::Result<Result<(), String>> {
    let size = *u.choose(&[[0.1, 0.1, 0.1], [0.3, 0.05, 0.2], [0.3, 0.003, 0.2]])?;
    let body = Shape::cuboid(size).unwrap();
    let settings = settings(&floor(), &body);
    let tilt = within(u, 0.005_f64.ln(), 0.5_f64.ln())?.exp();
    let height = *u.choose(&[0.0, -0.1, 0.2])? * settings.margin;
    let turn = about([0.0, 1.0, 0.0], within(u, 0.0, TAU)?) * about([1.0, 0.0, 0.0], -tilt);
    let lowest = turn.rotate(Vector([0.0, -size[1] / 2.0, -size[2] / 2.0]))[1];
    let pose = Pose::new(turn, Vector([0.01, height - lowest, 0.0]));
    let found = &steps([&floor(), &body], &[pose], &settings)[0];
    let what = format!("{size:?} at {height}, by {tilt}");
    Ok(hold_the_line(found, &pose, (size[0], &settings), &what))
}

#[test]
fn bodies_on_an_edge_are_held_at_both_ends() {
    cases::check(1000, on_an_edge);
}

#[test]
fn a_cylinder_that_lies_at_a_slant_is_held_at_both_ends() {
    let lying = Shape::cylinder(0.05, 0.2)
        .unwrap()
        .rotated(about([0.0, 0.0, 1.0], 0.25 * TAU))
        .unwrap();
    let settings = settings(&floor(), &lying);
    for slant in [0.0, 1e-4, 3e-4] {
        for spin in [0.0, 0.1, 0.7, 2.0, 4.0] {
            let turn = about([0.0, 1.0, 0.0], spin) * about([0.0, 0.0, 1.0], slant);
            let low = 0.05 * slant.cos() + 0.1 * slant.sin();
            let pose = Pose::new(turn, Vector([0.01, low - 0.1 * settings.margin, 0.0]));
            let found = &steps([&floor(), &lying], &[pose], &settings)[0];
            let what = format!("slant {slant}, spin {spin}");
            hold_the_line(found, &pose, (0.2, &settings), &what).unwrap();
        }
    }
}

/// A plate on a rod, slanted by so little that both ends are within the margin: the lower end stays.
#[test]
fn a_plate_on_a_rod_keeps_its_lower_end() {
    let rod = Shape::cylinder(0.005, 0.5).unwrap();
    let rod = rod.rotated(about([0.0, 0.0, 1.0], 0.25 * TAU)).unwrap();
    let plate = Shape::cuboid([0.13, 0.007, 0.1]).unwrap();
    let settings = settings(&rod, &plate);
    for (gap, yaw) in [(4e-4, 0.0), (4e-4, 0.37), (0.0, 0.37), (-2e-4, 0.0), (-2e-4, 0.37)] {
        let poses: Vec<_> = (0..25)
            .map(|step| {
                let slant = about([0.0, 0.0, 1.0], 2e-5 * f64::from(step));
                let turn = slant * about([0.0, 1.0, 0.0], yaw);
                Pose::new(turn, Vector([0.0, 0.0085 + gap, 0.0]))
            })
            .collect();
        for found in steps([&rod, &plate], &poses, &settings) {
            let along = found.contacts.iter().map(|contact| contact.point_b[0]);
            let (low, high) = along.fold((0.0_f64, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
            assert!(low < -0.05 && high > 0.05, "{gap}, {yaw}: {:?}", found.contacts);
        }
    }
}

/// A cube with a corner in the floor.
fn on_a_corner(u: &mut Unstructured<'_>) -> arbitrary::Result<Result<(), String>> {
    let cube = Shape::cuboid([0.1; 3]).unwrap();
    let settings = settings(&floor(), &cube);
    let way = within(u, 0.0, TAU)?;
    let turn = about([0.0, 1.0, 0.0], within(u, 0.0, TAU)?)
        * about([way.cos(), 0.0, way.sin()], within(u, 0.0, 0.5)?);
    let up = turn.inverse().rotate(Vector::unit(1));
    let low = 0.05 * (up[0].abs() + up[1].abs() + up[2].abs());
    let depth = within(u, 0.0, 0.9)? * settings.margin;
    let pose = Pose::new(turn, Vector([0.01, low - depth, -0.02]));
    let found = &steps([&floor(), &cube], &[pose], &settings)[0];
    let is_upright = found.contacts.iter().all(|contact| contact.normal[1] > 0.99);
    Ok(is_upright.then_some(()).ok_or(format!("{depth}, {pose:?}: {:?}", found.contacts)))
}

#[test]
fn a_corner_in_a_floor_has_the_normal_of_the_floor() {
    cases::check(1000, on_a_corner);
}
