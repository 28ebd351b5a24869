// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Regions of contact that are thinner than the spacing, or have parts that are: boards, discs, rods, legs.

use std::error::Error;

use palpate_field::{Point, Pose, Rotation, Shape, Vector};
use palpate_query::{Limits, Manifold, ManifoldSettings, PairWorkspace, Placed, manifold};

/// The contacts of a body with a half-space below zero, for bodies of about 1 m.
fn on_ground(shape: &Shape<3>, pose: Pose<3>) -> Result<Manifold<3>, Box<dyn Error>> {
    let ground = Shape::<3>::half_space([0.0, 1.0, 0.0], 0.0)?;
    let settings = ManifoldSettings::of_size(1.0);
    let limits = Limits::new(settings.usual_tolerance());
    let placed = Placed::new(shape, pose);
    Ok(manifold(&ground, placed, &settings, &limits, &mut PairWorkspace::new())?)
}

/// Whether the contacts reach each of these places but for two spacings, with a gap near `gap`.
fn reaches(found: &Manifold<3>, places: &[Point<3>], gap: f64) {
    let spacing = ManifoldSettings::of_size(1.0).spacing;
    for place in places {
        let near = found.contacts.iter().filter(|contact| {
            let middle = (contact.point_a + contact.point_b) * 0.5;
            (middle - *place).norm() <= 2.0 * spacing && (contact.gap - gap).abs() <= 2e-4
        });
        assert!(
            near.count() > 0,
            "{place:?} of {:?}, whole: {}",
            found.contacts,
            found.is_whole
        );
    }
}

fn at(height: f64) -> Pose<3> {
    Pose::translation(Vector([0.0, height, 0.0]))
}

/// Once, a board thinner than 3 % of its size had one contact.
#[test]
fn a_thin_board_lies_on_four_corners() -> Result<(), Box<dyn Error>> {
    for thickness in [0.05, 0.03, 0.01, 0.002, 0.0005, 0.0001] {
        for depth in [-1e-3, 0.0, 1e-5, 1e-4, 1e-3, 3e-3] {
            let board = Shape::<3>::cuboid([1.0, thickness, 0.5])?;
            let found = on_ground(&board, at(0.5 * thickness - depth))?;
            let corners = [[0.5, 0.25], [0.5, -0.25], [-0.5, 0.25], [-0.5, -0.25]];
            reaches(&found, &corners.map(|[x, z]| Vector([x, -0.5 * depth, z])), -depth);
            assert!(found.is_whole);
        }
    }
    Ok(())
}

#[test]
fn a_rod_lies_on_both_ends() -> Result<(), Box<dyn Error>> {
    for (radius, half) in [(0.1, 0.9), (0.02, 0.5), (0.01, 0.5), (0.005, 0.5)] {
        for depth in [1e-4, 1e-3] {
            let rod = Shape::<3>::capsule(radius, 2.0 * half)?;
            let turn =
                Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), std::f64::consts::FRAC_PI_2);
            let pose = Pose::new(turn?, Vector([0.0, radius - depth, 0.0]));
            let found = on_ground(&rod, pose)?;
            let end = half - radius;
            reaches(&found, &[end, -end].map(|x| Vector([x, -0.5 * depth, 0.0])), -depth);
        }
    }
    Ok(())
}

#[test]
fn a_table_stands_on_its_legs() -> Result<(), Box<dyn Error>> {
    let leg = |x: f64, z: f64| {
        let leg = Shape::<3>::cylinder(0.005, 0.5)?;
        leg.translated([x, -0.25, z])
    };
    let places = [[0.45, 0.45], [0.45, -0.45], [-0.45, 0.45], [-0.45, -0.45]];
    let parts =
        places.iter().map(|[x, z]| leg(*x, *z)).chain([Shape::<3>::cuboid([1.0, 0.02, 1.0])]);
    let table = Shape::union(parts.collect::<Result<Vec<_>, _>>()?)?;
    let found = on_ground(&table, at(0.4999))?;
    reaches(&found, &places.map(|[x, z]| Vector([x, -5e-5, z])), -1e-4);
    Ok(())
}
