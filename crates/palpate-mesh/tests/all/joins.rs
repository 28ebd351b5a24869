// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Corners that are equal up to rounding are one.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use palpate_field::{Point, Rotation, Shape, Vector};
use palpate_mesh::{Findings, Solid, SolidError, TriangleMesh};

/// A number from −1 to 1.
fn noise(seed: &mut u64) -> f64 {
    *seed =
        seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// The faces of a unit cube, each side divided into squares: so many a side along x, y, z, and back.
fn cube(divided: [u32; 6]) -> Vec<[Point<3>; 3]> {
    let mut faces = Vec::new();
    for (side, count) in divided.into_iter().enumerate() {
        let (axis, is_far) = (side % 3, side >= 3);
        let at = |i: u32, k: u32| {
            let mut p = Vector([0.0; 3]);
            p[axis] = f64::from(u8::from(is_far));
            p[(axis + 1) % 3] = f64::from(i) / f64::from(count);
            p[(axis + 2) % 3] = f64::from(k) / f64::from(count);
            p
        };
        for i in 0..count {
            for k in 0..count {
                let [a, b, c, d] = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
                let square =
                    if is_far { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
                faces.extend(square);
            }
        }
    }
    faces
}

/// A mesh of faces that share no corner.
fn soup(faces: &[[Point<3>; 3]]) -> TriangleMesh {
    let corners: Vec<u32> = (0..3 * faces.len() as u32).collect();
    TriangleMesh::new(faces.concat(), corners.as_chunks::<3>().0.to_vec()).unwrap()
}

fn moved(
    faces: &[[Point<3>; 3]],
    mut by: impl FnMut(Point<3>) -> Point<3>,
) -> Vec<[Point<3>; 3]> {
    faces.iter().map(|face| face.map(&mut by)).collect()
}

fn solid(faces: &[[Point<3>; 3]]) -> (Shape<3>, Findings<3>) {
    let (solid, found) = Solid::from_mesh(&soup(faces)).unwrap();
    (solid.into(), found)
}

fn turn() -> Rotation<3> {
    Rotation::from_axis_angle(Vector([0.3, -0.5, 0.7]), 1.234).unwrap()
}

#[test]
fn corners_of_a_cube_that_differ_by_a_rounding_are_one() {
    let mut seed = 1;
    for size in [1e-12, 1e-9, 1e-7] {
        let faces =
            moved(&cube([1; 6]), |p| p + Vector([0; 3].map(|_| noise(&mut seed))) * size);
        let (shape, found) = solid(&faces);
        assert_eq!((found.joined, found.openings.len()), (28, 0), "{size}: {found}");
        assert!(found.moved > 0.0 && found.moved < 4.0 * size, "{size}: {found:?}");
        assert!((shape.distance([0.5; 3]) + 0.5).abs() < 2.0 * size);
        let deviation = shape.promise().deviation.unwrap();
        assert_eq!((deviation.value, deviation.within), (found.moved, f64::INFINITY));
    }
}

/// As programs write binary STL: each face is turned in single precision.
#[test]
fn a_ball_of_single_precision_closes() {
    let stacks = 6;
    let at = |i: u32, k: u32| {
        let (polar, around) = (
            std::f64::consts::PI * f64::from(i) / f64::from(stacks),
            std::f64::consts::TAU * f64::from(k % 8) / 8.0,
        );
        Vector([polar.sin() * around.cos(), polar.sin() * around.sin(), polar.cos()]) * 30.0
    };
    let mut faces = Vec::new();
    for i in 0..stacks {
        for k in 0..8 {
            let [a, b, c, d] = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
            if i + 1 < stacks {
                faces.push([a, b, c]);
            }
            if i > 0 {
                faces.push([a, c, d]);
            }
        }
    }
    let exact = Solid::from_mesh(&soup(&faces)).unwrap().0;
    let single = |p: Point<3>| Vector(p.0.map(|x| f64::from(x as f32)));
    // About its own centroid or about the origin.
    let mut of_file = Vec::new();
    for (i, face) in faces.iter().enumerate() {
        let centre = single((face[0] + face[1] + face[2]) * (1.0 / 3.0));
        let is_own = i % 2 == 0;
        of_file.push(face.map(|p| {
            let p = if is_own { single(single(p) - centre) } else { single(p) };
            let turned = single(turn().rotate(p));
            if is_own { single(turned + single(turn().rotate(centre))) } else { turned }
        }));
    }
    let mesh = soup(&of_file).scaled(0.001).unwrap();
    let (solid, found) = Solid::from_mesh(&mesh).unwrap();
    assert!(found.joined > 20, "{found}");
    assert_eq!(
        (found.openings.len(), found.degenerate, found.own),
        (0, 0, faces.len()),
        "{found}"
    );
    assert!(found.moved < 2e-8, "{found:?}");
    let (exact, shape): (Shape<3>, Shape<3>) = (exact.into(), solid.into());
    let mut seed = 5;
    for _ in 0..400 {
        let p = Vector([0; 3].map(|_| 40.0 * noise(&mut seed)));
        let [there, here] =
            [exact.distance(p), 1000.0 * shape.distance(turn().rotate(p) * 0.001)];
        assert!((there - here).abs() < 1e-4, "{p:?}: {there} and {here}");
    }
}

#[test]
fn corners_on_edges_up_to_rounding_part_them() {
    for divided in [[1, 2, 3, 4, 5, 7], [2, 3, 2, 3, 2, 3], [1, 1, 1, 1, 1, 6]] {
        let faces = moved(&cube(divided), |p| turn().rotate(p));
        let (shape, found) = solid(&faces);
        assert!(found.openings.is_empty(), "{divided:?}: {found}");
        assert!(found.parted > 0 && found.moved < 1e-14, "{divided:?}: {found:?}");
        let centre = turn().rotate(Vector([0.5; 3]));
        assert!((shape.distance(centre) + 0.5).abs() < 1e-12, "{divided:?}");
        assert_eq!(
            shape.promise().in_words().split(", values").next(),
            Some("exact outside, exact inside")
        );
    }
}

#[test]
fn texts_of_seven_digits_close() {
    let written = |p: Point<3>| Vector(p.0.map(|x| format!("{x:.6e}").parse::<f64>().unwrap()));
    let mut seed = 3;
    let faces = moved(&cube([2; 6]), |p| {
        let noise = Vector([0; 3].map(|_| noise(&mut seed))) * 3e-6;
        written(turn().rotate(p * 70.0) + noise)
    });
    let (_, found) = solid(&faces);
    assert!(found.openings.is_empty() && found.joined > 0, "{found}");
}

#[test]
fn wide_cracks_are_called_cracks_and_join_when_asked() {
    let mut seed = 7;
    let faces = moved(&cube([1; 6]), |p| p + Vector([0; 3].map(|_| noise(&mut seed))) * 1e-3);
    let mesh = soup(&faces);
    let Err(SolidError::Cracked { cracks }) = Solid::from_mesh(&mesh) else {
        panic!("the cube has cracks");
    };
    assert!(cracks.width > 5e-4 && cracks.width < 4e-3, "{cracks:?}");
    assert!(cracks.join_within >= cracks.width);
    let (solid, found) = Solid::from_mesh_within(&mesh, cracks.join_within).unwrap();
    assert!(found.openings.is_empty() && found.cracks.is_none(), "{found}");
    let shape: Shape<3> = solid.into();
    assert!((shape.distance([0.5; 3]) + 0.5).abs() < 4e-3);
    assert!(found.moved <= cracks.width && shape.promise().deviation.is_some());
}

#[test]
fn a_length_beyond_half_of_an_edge_is_refused_with_the_edge() {
    let refused = Solid::from_mesh_within(&soup(&cube([4; 6])), 0.2).unwrap_err();
    let SolidError::ShortEdge { within, length, ends } = &refused else { panic!("{refused}") };
    assert_eq!((*within, *length), (0.2, 0.25));
    assert!(ends.contains(" to "), "{ends}");
    for within in [f64::NAN, -1.0] {
        let refused = Solid::from_mesh_within(&soup(&cube([1; 6])), within);
        assert!(matches!(refused, Err(SolidError::JoinWithin { .. })), "{within}");
    }
}

#[test]
fn with_zero_only_equal_corners_are_joined() {
    let mut seed = 1;
    let noisy = moved(&cube([1; 6]), |p| p + Vector([0; 3].map(|_| noise(&mut seed))) * 1e-12);
    assert!(matches!(
        Solid::from_mesh_within(&soup(&noisy), 0.0),
        Err(SolidError::Cracked { .. })
    ));
    let (_, found) = Solid::from_mesh_within(&soup(&cube([1; 6])), 0.0).unwrap();
    assert_eq!((found.welded, found.joined, found.is_clean()), (28, 0, true));
}

/// A slit as narrow as the tolerance stays, as nothing there is open.
#[test]
fn what_is_closed_stays_as_it_is() {
    let mut faces = cube([1; 6]);
    faces.extend(moved(&cube([1; 6]), |p| p + Vector([1.0 + 1e-12, 0.0, 0.0])));
    let (_, found) = solid(&faces);
    assert_eq!((found.joined, found.moved), (0, 0.0), "{found}");
}

#[test]
fn a_sheet_is_still_a_sheet() {
    let sheet: Vec<_> = cube([4; 6]).into_iter().take(32).collect();
    assert!(matches!(Solid::from_mesh(&soup(&sheet)), Err(SolidError::Sheet)));
}

/// An opening is a guess, and the promise says so.
#[test]
fn the_promise_of_a_capped_solid_is_of_no_known_surface() {
    let faces = cube([1; 6]);
    let (shape, found) = solid(&faces[1..]);
    assert_eq!(found.openings.len(), 1);
    let words = shape.promise().in_words();
    assert!(words.ends_with("values off its source's by an unknown amount"), "{words}");
}
