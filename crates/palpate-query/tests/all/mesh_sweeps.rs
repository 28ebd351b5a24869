// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes that move touch when the first of their elements does.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use palpate_field::{Point, Pose, Screw, Shape, Vector};
use palpate_mesh::{Mesh, Outline, TriangleMesh};
use palpate_query::{
    Element, ElementSweep, Moving, Query, Stop, SweepSettings, sweep_element, sweep_mesh,
};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

/// A sheet of `2 n²` triangles over a square of a metre, bent to a saddle.
fn saddle(n: u32) -> TriangleMesh {
    let place = |i: u32| f64::from(i) / f64::from(n) - 0.5;
    let corners = (0..=n).flat_map(|i| (0..=n).map(move |k| (i, k)));
    let corners = corners.map(|(i, k)| {
        let (x, z) = (place(i), place(k));
        Vector([x, x * x - z * z, z])
    });
    let name = |i: u32, k: u32| i * (n + 1) + k;
    let faces = (0..n).flat_map(|i| (0..n).map(move |k| (i, k))).flat_map(|(i, k)| {
        let [a, b, c, d] = [name(i, k), name(i + 1, k), name(i + 1, k + 1), name(i, k + 1)];
        [[a, b, c], [a, c, d]]
    });
    TriangleMesh::new(corners.collect(), faces.collect()).unwrap()
}

/// A wave of segments over a metre.
fn wave(n: u32) -> Outline {
    let corners = (0..=n).map(|i| {
        let x = f64::from(i) / f64::from(n) - 0.5;
        Vector([x, 0.1 * (9.0 * x).sin()])
    });
    Outline::new(corners.collect(), (0..n).map(|i| [i, i + 1]).collect()).unwrap()
}

fn as_its_first_element<const N: usize, const D: usize>(
    mesh: &Mesh<N, D>,
    count: u64,
    is_carried: bool,
) where
    Space: Solid<D> + Turn<D>,
{
    let mut workspace = ElementSweep::new();
    let (mut touched, mut ran) = (0, 0);
    cases::on_trees(count, 3, |u, _, shape| {
        let size = draw::size(shape);
        let screw = draw::screw(u, size + 1.0, 0)?;
        let field = if is_carried { Some(draw::screw(u, 0.3 * size, 0)?) } else { None };
        let moving = field.map_or(Moving::from(shape), |screw| Moving::new(shape, screw));
        let settings = SweepSettings { gap: 1e-4 * size, ..SweepSettings::of_size(size) };
        let all = sweep_mesh(moving, mesh, screw, &settings, &mut workspace).unwrap();
        // Free is more than half of the gap, and a touch is at most the gap.
        let [nearer, farther] =
            [0.5, 2.0].map(|share| SweepSettings { gap: share * settings.gap, ..settings });
        let (mut lower, mut upper) = (1.0_f64, f64::INFINITY);
        for name in 0..mesh.elements().len() {
            let element = Element::new(mesh.corners(name)).unwrap();
            let mut one = |settings: &SweepSettings| {
                sweep_element(moving, &element, screw, settings, &mut workspace).unwrap()
            };
            upper = upper.min(one(&nearer).upper);
            lower = lower.min(one(&farther).lower);
        }
        ran += 1;
        if all.stop.is_early() {
            return Ok(Ok(()));
        }
        let is_touch = all.touches() == Some(true);
        touched += u64::from(is_touch);
        let is_right = all.lower <= upper
            && (!is_touch || lower <= all.upper)
            && (!is_touch || all.stop == Stop::Converged && all.upper - all.lower <= 1.01e-4);
        Ok(if is_right { Ok(()) } else { Err(format!("{all:?}, {lower}, {upper}")) })
    });
    assert!(touched * 10 > ran, "{touched} of {ran} touched");
}

#[test]
fn meshes_in_space_touch_when_their_first_element_does() {
    as_its_first_element(&saddle(6), 60, false);
    as_its_first_element(&saddle(3), 40, true);
}

#[test]
fn outlines_touch_when_their_first_element_does() {
    as_its_first_element(&wave(40), 100, false);
}

/// A cube of 10 cm falls by 3 m on a plate, and the plate, carried along, changes nothing.
#[test]
fn a_cube_falls_on_a_plate_that_moves_too() {
    let corners: Vec<Point<3>> = (0..8_u32)
        .map(|i| Vector([0, 1, 2].map(|k| if i >> k & 1 == 0 { -0.05 } else { 0.05 })))
        .collect();
    let faces = vec![
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    let cube = TriangleMesh::new(corners, faces).unwrap();
    let plate = Shape::<3>::cuboid([1.0, 1e-4, 1.0]).unwrap();
    let at = |y: f64| Pose::<3>::translation([0.0, y, 0.0]);
    let settings = SweepSettings::of_size(0.1);
    let mut workspace = ElementSweep::new();
    let falls = Screw::new(at(2.0), at(-1.0), 0).unwrap();
    // 2 − 0.05 − 0.000 05 m of 3 m.
    let truth = 1.94995 / 3.0;
    let still = sweep_mesh(&plate, &cube, falls, &settings, &mut workspace).unwrap();
    assert!(still.lower <= truth && (still.upper - truth).abs() <= 1e-4, "{still:?}");
    // The plate rises by 1 m, the cube falls by 2 m.
    let rises = Moving::new(&plate, Screw::new(at(0.0), at(1.0), 0).unwrap());
    let falls = Screw::new(at(2.0), at(0.0), 0).unwrap();
    let both = sweep_mesh(rises, &cube, falls, &settings, &mut workspace).unwrap();
    assert!(both.lower <= truth && (both.upper - truth).abs() <= 1e-4, "{both:?}");
    let asked = Query::new().cast_mesh(rises, &cube, falls).unwrap();
    assert!(asked.lower <= truth && (asked.upper - truth).abs() <= 2e-4, "{asked:?}");
    let lowest = Element::new(cube.corners(0)).unwrap();
    let asked = Query::new().cast_element(rises, &lowest, falls).unwrap();
    assert!(asked.touches() == Some(true), "{asked:?}");
    let contact = both.contact.unwrap();
    assert!((contact.normal - Vector([0.0, 1.0, 0.0])).norm() < 1e-9);
}
