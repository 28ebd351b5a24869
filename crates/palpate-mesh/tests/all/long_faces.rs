// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A gear of 9600 long triangles, many of which lie askew on its caps.

use palpate_field::{CustomField, Point, Vector};
use palpate_mesh::{Solid, TriangleMesh};
use palpate_testkit::hard::gear;
use palpate_testkit::soup::Soup;
use palpate_testkit::{cases, models};

fn mesh() -> TriangleMesh {
    let Soup { vertices, faces } = gear(2400);
    TriangleMesh::new(vertices, faces).unwrap()
}

/// The distance to a triangle, from its definition: the nearest point by the regions of its barycentric coordinates
/// (Ericson, Real-Time Collision Detection, 5.1.5).
fn distance_to([a, b, c]: [Point<3>; 3], p: Point<3>) -> f64 {
    let on = |from: Point<3>, to: Point<3>| {
        let (side, away) = (to - from, p - from);
        let share = (away.dot(side) / side.dot(side)).clamp(0.0, 1.0);
        (p - from - side * share).norm()
    };
    let normal = (b - a).cross(c - a);
    let height = (p - a).dot(normal) / normal.norm();
    let is_above = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|(from, to)| (*to - *from).cross(p - *from).dot(normal) >= 0.0);
    if is_above { height.abs() } else { on(a, b).min(on(b, c)).min(on(c, a)) }
}

#[test]
fn distances_are_those_to_all_triangles() {
    let mesh = mesh();
    assert_eq!(mesh.elements().len(), 9600);
    let (solid, findings) = Solid::from_mesh(&mesh).unwrap();
    assert!(findings.is_clean(), "{findings}");
    cases::check(300, |u| {
        let mut p = Vector::ZERO;
        for (i, far) in [0.05, 0.05, 0.03].into_iter().enumerate() {
            p[i] = far * (f64::from(u.int_in_range(-1000..=1000)?) / 1000.0);
        }
        let all = (0..mesh.elements().len()).map(|face| distance_to(mesh.corners(face), p));
        let nearest = all.fold(f64::INFINITY, f64::min);
        let found = solid.distance(p);
        Ok(if (found.abs() - nearest).abs() < 1e-15 {
            Ok(())
        } else {
            Err(format!("{found} at {p:?}, and {nearest} to the nearest triangle"))
        })
    });
}

#[test]
fn models_over_cells_at_the_caps_enclose_the_field() {
    let (solid, _) = Solid::from_mesh(&mesh()).unwrap();
    cases::check(300, |u| {
        let share = |u: &mut arbitrary::Unstructured<'_>| -> arbitrary::Result<f64> {
            Ok(f64::from(u.int_in_range(-1000..=1000)?) / 1000.0)
        };
        let centre = Vector([0.05 * share(u)?, 0.05 * share(u)?, 0.01 + 2e-3 * share(u)?]);
        let half = *u.choose(&[1e-5, 1e-4, 1e-3])?;
        let model = models::bounding(&solid, centre, [half; 3], 30);
        Ok(model.map(|_| ()).map_err(|error| format!("{centre:?}, {half}: {error:?}")))
    });
}
