// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes are asked again without allocating.

use assert_no_alloc::assert_no_alloc;
use palpate_field::kernel::Ball;
use palpate_field::{Pose, Shape, Vector};
use palpate_mesh::read_file;
use palpate_query::{Limits, MeshWorkspace, PlacedMesh, mesh_contacts};

#[test]
fn after_the_first_time_nothing_is_allocated() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/meshes");
    let nut = read_file(format!("{folder}/nut.ply")).unwrap().scaled(0.001).unwrap();
    let size = nut.bounds().half_extents().norm();
    let bumps = (-2..=2).map(|i| {
        let place = Vector([0.0, 0.4 * size * f64::from(i), 0.7 * size]);
        Shape::from_kernel(Ball::new(0.3 * size).unwrap()).translated(place).unwrap()
    });
    let bumps = Shape::union(bumps).unwrap();
    let limits = Limits::new(1e-6 * size);
    let mut workspace = MeshWorkspace::new();
    let start = nut.bounds().centre();
    let at = |step: f64| Pose::translation(Vector([1e-3 * step * size, 0.0, 0.0]) - start);
    let mut ask = |step: f64| {
        let placed = PlacedMesh::new(&nut, at(step));
        let answer =
            mesh_contacts(&bumps, placed, 0.1 * size, &limits, &mut workspace).unwrap();
        assert!(answer.undecided.is_empty());
        answer.contacts.len()
    };
    let first = ask(0.0);
    assert!(first > 50, "{first} contacts");
    assert_eq!(assert_no_alloc(|| ask(0.0)), first);
}
