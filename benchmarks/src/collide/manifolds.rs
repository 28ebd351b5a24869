// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts that span where two bodies touch.

use std::error::Error;
use std::hint::black_box;

use palpate::field::kernel::{Cuboid, Cylinder, Ring, Torus};
use palpate::field::{Pose, Shape, ShapeError, Vector};
use palpate::query::{Limits, ManifoldSettings, PairWorkspace, Placed, manifold};

use super::{TimedRows, fastest};

/// Two bodies, where the second is, and up to which gap they touch [m].
type Case<const D: usize> = (&'static str, Shape<D>, Shape<D>, [f64; D], f64);

/// Two boxes face to face, 1 mm deep; a peg in a hole, 0.5 mm away all round; a bar
/// across a torus, 1 mm deep.
fn in_space() -> Result<[Case<3>; 3], ShapeError> {
    let cuboid = |sides| Cuboid::new(Vector(sides)).map(Shape::from_kernel);
    let cylinder = |radius, height| Cylinder::new(radius, height).map(Shape::from_kernel);
    let plate = cuboid([0.6, 0.4, 0.6])?.difference([cylinder(0.1005, 1.0)?])?;
    let torus = Shape::from_kernel(Torus::new(0.35, 0.15)?);
    let (large, small) = (cuboid([1.2, 0.8, 0.6])?, cuboid([0.6, 0.5, 0.4])?);
    let (peg, bar) = (cylinder(0.1, 0.6)?, cuboid([1.2, 0.08, 0.08])?);
    Ok([
        ("boxes", large, small, [0.45, 0.3, 0.499], 2e-3),
        ("peg", plate, peg, [0.0, 0.1, 0.0], 1e-3),
        ("bar_torus", torus, bar, [0.0, 0.189, 0.0], 2e-3),
    ])
}

/// The same in the plane.
fn in_the_plane() -> Result<[Case<2>; 3], ShapeError> {
    let cuboid = |sides| Cuboid::new(Vector(sides)).map(Shape::from_kernel);
    let slotted = cuboid([0.6, 0.4])?.difference([cuboid([0.201, 1.0])?])?;
    let ring = Shape::from_kernel(Ring::new(0.2, 0.5)?);
    let (large, small) = (cuboid([1.2, 0.6])?, cuboid([0.6, 0.4])?);
    let (tongue, bar) = (cuboid([0.2, 0.6])?, cuboid([1.2, 0.08])?);
    Ok([
        ("rectangles", large, small, [0.45, 0.499], 2e-3),
        ("tongue", slotted, tongue, [0.0, 0.1], 1e-3),
        ("bar_ring", ring, bar, [0.0, 0.539], 2e-3),
    ])
}

/// Adds the rows of manifolds.
pub(super) fn measure(rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    ask(&in_space()?, rows)?;
    ask(&in_the_plane()?, rows)
}

fn ask<const D: usize>(cases: &[Case<D>], rows: &mut TimedRows) -> Result<(), Box<dyn Error>> {
    let limits = Limits::new(1e-3);
    let mut workspace = PairWorkspace::new();
    for (name, a, b, place, margin) in cases {
        let settings = ManifoldSettings { margin: *margin, ..ManifoldSettings::of_size(1.0) };
        let there = Placed::new(b, Pose::translation(Vector(*place)));
        let found = manifold(a, there, &settings, &limits, &mut workspace)?;
        let time = fastest(|| {
            // That it is no error was seen above.
            let _ =
                black_box(manifold(a, black_box(there), &settings, &limits, &mut workspace));
        });
        let key = format!("manifold.{name}");
        rows.add_times(&key, vec![time]);
        let evaluations = f64::from(found.separation.evaluations);
        rows.insert(format!("{key}.evaluations"), evaluations);
        rows.insert(format!("{key}.contacts"), found.contacts.len() as f64);
        rows.insert(format!("{key}.undecided"), f64::from(u8::from(!found.is_whole)));
    }
    Ok(())
}
