// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts that span where bodies touch.

use palpate_field::kernel::{Ball, Cuboid, Cylinder, Torus};
use palpate_field::{Pose, Rotation, Shape, ShapeError, Vector};
use palpate_query::{Limits, Manifold, ManifoldSettings, PairWorkspace, Placed, manifold};

const LIMITS: Limits = Limits { tolerance: 1e-3, budget: 200_000 };

fn cuboid(sides: [f64; 3]) -> Result<Shape<3>, ShapeError> {
    Ok(Shape::from_kernel(Cuboid::new(Vector(sides))?))
}

fn touching<const D: usize>(
    a: &Shape<D>,
    b: &Shape<D>,
    pose: Pose<D>,
    settings: &ManifoldSettings,
) -> Manifold<D> {
    let mut workspace = PairWorkspace::new();
    let b = Placed::new(b, pose);
    manifold(a, b, settings, &LIMITS, &mut workspace).expect("bounded")
}

#[test]
fn show() -> Result<(), ShapeError> {
    let plate = cuboid([0.6, 0.4, 0.6])?
        .difference([Shape::from_kernel(Cylinder::new(0.1005, 1.0)?)])?;
    let peg = Shape::from_kernel(Cylinder::new(0.1, 0.6)?);
    let torus = Shape::from_kernel(Torus::new(0.35, 0.15)?);
    let ball = Shape::from_kernel(Ball::new(0.3)?);
    let turn = Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), 0.5236)?;
    for (name, a, b, pose, margin) in [
        (
            "boxes",
            cuboid([1.2, 0.8, 0.6])?,
            cuboid([0.6, 0.5, 0.4])?,
            Pose::translation(Vector([0.45, 0.3, 0.499])),
            2e-3,
        ),
        (
            "turned",
            cuboid([1.2, 0.8, 0.6])?,
            cuboid([0.6, 0.5, 0.4])?,
            Pose::new(turn, Vector([0.1, 0.0, 0.499])),
            2e-3,
        ),
        ("peg", plate.clone(), peg.clone(), Pose::translation(Vector([0.0, 0.1, 0.0])), 1e-3),
        ("peg aside", plate, peg, Pose::translation(Vector([0.00025, 0.1, 0.0])), 1e-3),
        (
            "bar",
            torus.clone(),
            cuboid([1.2, 0.08, 0.08])?,
            Pose::translation(Vector([0.0, 0.189, 0.0])),
            2e-3,
        ),
        (
            "slab",
            torus,
            cuboid([1.2, 0.2, 1.2])?,
            Pose::translation(Vector([0.0, 0.2495, 0.0])),
            2e-3,
        ),
        (
            "ball",
            cuboid([1.2, 1.2, 0.2])?,
            ball,
            Pose::translation(Vector([0.1, 0.05, 0.399])),
            2e-3,
        ),
    ] {
        let settings = ManifoldSettings { margin, spacing: 0.04, most: 64 };
        let found = touching(&a, &b, pose, &settings);
        println!(
            "{name}: {} contacts, groups {:?}, {} evaluations",
            found.contacts.len(),
            found.groups,
            found.separation.evaluations
        );
        for c in &found.contacts {
            println!(
                "   {:?} {:?} {:.3} mm",
                c.point_a.0.map(|x| (x * 1e4).round() / 1e4),
                c.normal.0.map(|x| (x * 1e3).round() / 1e3),
                c.gap * 1e3
            );
        }
    }
    Ok(())
}
