// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes that move touch when the first of their elements does.
//!
//! Solids of meshes that pass each other at a small distance are decided about as soon as analytic bodies are.
#![expect(clippy::unwrap_used, reason = "these are tests")]

use std::error::Error;
use std::f64::consts::{FRAC_PI_4, PI, SQRT_2};

use palpate_field::{Point, Pose, Rotation, Screw, Shape, Vector};
use palpate_mesh::{Mesh, Outline, TriangleMesh};
use palpate_query::{
    Element, ElementSweep, FirstTouch, Moving, Query, Stop, SweepSettings, SweepWorkspace,
    sweep, sweep_element, sweep_mesh,
};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::soup::Soup;
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

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// The solid of triangles.
fn solid(soup: &Soup) -> Result<Shape<3>> {
    let mesh = TriangleMesh::new(soup.vertices.clone(), soup.faces.clone())?;
    let (solid, _) = palpate_mesh::Solid::from_mesh(&mesh)?;
    Ok(solid.into())
}

/// The first touch of a body at rest and one that goes from pose to pose, all placed in the world by `world`.
fn swept(
    [rests, moves]: [&Shape<3>; 2],
    [from, to]: [Pose<3>; 2],
    world: Pose<3>,
) -> Result<FirstTouch<3>> {
    let rests = Moving::new(rests, world);
    let moves = Moving::new(moves, Screw::new(world * from, world * to, 0)?);
    let settings = SweepSettings::of_size(draw::size(rests.shape).min(draw::size(moves.shape)));
    Ok(sweep(rests, moves, &settings, &mut SweepWorkspace::new())?)
}

fn at(p: [f64; 3]) -> Pose<3> {
    Pose::translation(p)
}

/// Turned about the axis y.
fn about_y(angle: f64) -> Result<Pose<3>> {
    Ok(Pose::new(Rotation::from_axis_angle([0.0, 1.0, 0.0], angle)?, Vector::ZERO))
}

/// Somewhere, turned about no axis of its own.
fn aside() -> Result<Pose<3>> {
    let turn = Rotation::from_axis_angle([0.3, 1.0, 0.2], 0.7)?;
    Ok(Pose::new(turn, Vector([0.3, -0.2, 0.9])))
}

/// Apart all the time, by at most `share` times the evaluations of another sweep.
fn is_apart(found: &FirstTouch<3>, share: f64, other: &FirstTouch<3>) -> bool {
    found.touches() == Some(false)
        && other.touches() == Some(false)
        && f64::from(found.evaluations) <= share * f64::from(other.evaluations)
}

#[test]
fn mesh_cubes_that_pass_each_other_take_about_as_long_as_cuboids() {
    let cuboid = Shape::<3>::cuboid([1.0; 3]).unwrap();
    let mesh = solid(&Soup::cuboid([0.0; 3], [1.0; 3])).unwrap();
    let fine = solid(&Soup::fine_cuboid([1.0; 3], 8)).unwrap();
    let way = |gap: f64| [-4.0, 4.0].map(|x| at([x, 1.0 + gap, 0.0]));
    for world in [Pose::identity(), aside().unwrap()] {
        let other = swept([&cuboid, &cuboid], way(1e-2), world).unwrap();
        let found = swept([&mesh, &cuboid], way(1e-2), world).unwrap();
        assert!(is_apart(&found, 10.0, &other), "{found:?}, {other:?}");
        // The smaller the gap, the more boxes it takes between cuboids.
        for gap in [1e-2, 1e-3, 1e-4] {
            for pair in [[&mesh, &mesh], [&cuboid, &mesh], [&fine, &fine]] {
                let found = swept(pair, way(gap), world).unwrap();
                assert!(is_apart(&found, 10.0, &other), "{gap}: {found:?}, {other:?}");
            }
        }
    }
}

/// The sides of the meshes are square to no axis of theirs.
#[test]
fn turned_mesh_cubes_that_pass_each_other_are_apart() {
    let turn = aside().unwrap().rotation;
    let mesh = solid(&Soup::cuboid([0.0; 3], [1.0; 3]).turned(&turn)).unwrap();
    let cuboid = Shape::<3>::cuboid([1.0; 3]).unwrap();
    let turned = Pose::new(turn, Vector::ZERO);
    let way = [-4.0, 4.0].map(|x| turned * at([x, 1.001, 0.0]) * turned.inverse());
    let found = swept([&mesh, &mesh], way, Pose::identity()).unwrap();
    let straight = [-4.0, 4.0].map(|x| at([x, 1.001, 0.0]));
    let other = swept([&cuboid, &cuboid], straight, Pose::identity()).unwrap();
    assert!(is_apart(&found, 10.0, &other), "{found:?}, {other:?}");
}

#[test]
fn a_ball_over_a_mesh_floor_takes_about_as_long_as_over_a_cuboid() {
    let ball = Shape::<3>::ball(0.1).unwrap();
    let cuboid = Shape::<3>::cuboid([4.0, 0.2, 4.0]).unwrap();
    let mesh = solid(&Soup::cuboid([0.0; 3], [4.0, 0.2, 4.0])).unwrap();
    for gap in [1e-2, 1e-3, 1e-4] {
        let way = [at([-3.0, 0.2 + gap, 0.3]), at([3.0, 0.2 + gap, 0.1])];
        let [found, other] =
            [&mesh, &cuboid].map(|floor| swept([floor, &ball], way, aside().unwrap()).unwrap());
        assert!(is_apart(&found, 5.0, &other), "{gap}: {found:?}, {other:?}");
    }
}

/// A peg of 50 mm over a hole as deep, straight down to the bottom.
fn down(turned: Pose<3>) -> [Pose<3>; 2] {
    [0.06, 0.0].map(|y| at([0.0, y, 0.0]) * turned)
}

/// Half the width of the hole [m].
const HOLE: f64 = 0.011;

/// A block of 40 mm with a square hole, the first corner at x > 0.
fn square_hole() -> Result<Shape<3>> {
    solid(&Soup::pierced_prism(4, [0.02 * SQRT_2, HOLE * SQRT_2], 0.05))
}

#[test]
fn a_square_peg_goes_into_a_square_hole() {
    let hole = square_hole().unwrap();
    let turned = about_y(FRAC_PI_4).unwrap();
    for clearance in [1e-3, 1e-2, 3e-2] {
        let half = HOLE * (1.0 - clearance);
        let mesh = solid(&Soup::prism(4, half * SQRT_2, 0.05)).unwrap();
        let found = swept([&hole, &mesh], down(Pose::identity()), Pose::identity()).unwrap();
        assert_eq!(found.touches(), Some(false), "{clearance}: {found:?}");
        let found = swept([&hole, &mesh], down(Pose::identity()), aside().unwrap()).unwrap();
        assert_eq!(found.touches(), Some(false), "aside, {clearance}: {found:?}");
        let bar = Soup::cuboid([0.0, 0.025, 0.0], [2.0 * half, 0.05, 2.0 * half]);
        let found =
            swept([&hole, &solid(&bar).unwrap()], down(turned), Pose::identity()).unwrap();
        assert_eq!(found.touches(), Some(false), "turned, {clearance}: {found:?}");
        let cuboid = Shape::<3>::cuboid([2.0 * half, 0.05, 2.0 * half]).unwrap();
        let up = turned * at([0.0, 0.025, 0.0]);
        let found = swept([&hole, &cuboid], down(up), Pose::identity()).unwrap();
        assert_eq!(found.touches(), Some(false), "analytic, {clearance}: {found:?}");
    }
}

/// The peg is within the circle that touches the sides of the hole.
#[test]
fn a_peg_of_many_sides_goes_into_such_a_hole() {
    for (corners, clearance) in [(16, 1e-2), (24, 3e-2)] {
        let flat = HOLE * (PI / f64::from(corners)).cos();
        let hole = solid(&Soup::pierced_prism(corners, [0.02, HOLE], 0.05)).unwrap();
        let peg = solid(&Soup::prism(corners, flat * (1.0 - clearance), 0.05)).unwrap();
        let found = swept([&hole, &peg], down(Pose::identity()), Pose::identity()).unwrap();
        assert_eq!(found.touches(), Some(false), "{corners}, {clearance}: {found:?}");
    }
}

/// The time of a touch that is known, to the tolerance; bodies that come near each other slowly are within the gap so
/// much earlier.
fn touches_at(found: &FirstTouch<3>, truth: f64, earlier: f64) -> bool {
    found.touches() == Some(true)
        && found.lower <= truth
        && found.upper >= truth - earlier
        && found.upper <= truth + 1e-4
}

#[test]
fn meshes_that_touch_touch_at_their_time() {
    let mesh = solid(&Soup::cuboid([0.0; 3], [1.0; 3])).unwrap();
    let fine = solid(&Soup::fine_cuboid([1.0; 3], 8)).unwrap();
    for world in [Pose::identity(), aside().unwrap()] {
        // The lower side falls from 1.5 m to −0.5 m, on a side at 0.5 m.
        let falls = [at([0.2, 2.0, 0.1]), at([0.2, 0.0, 0.1])];
        for pair in [[&mesh, &mesh], [&mesh, &fine], [&fine, &fine]] {
            let found = swept(pair, falls, world).unwrap();
            assert!(touches_at(&found, 0.5, 1e-6), "{found:?}");
        }
        // It comes down by 2 mm from a gap of 1 mm as it goes by.
        let sinks = [at([-0.5, 1.001, 0.0]), at([0.5, 0.999, 0.0])];
        let found = swept([&mesh, &mesh], sinks, world).unwrap();
        assert!(touches_at(&found, 0.5, 5e-4), "{found:?}");
    }
    // A peg 1 % too wide goes down by 10 of 60 mm to the rim.
    let hole = square_hole().unwrap();
    let wide = solid(&Soup::prism(4, 1.01 * HOLE * SQRT_2, 0.05)).unwrap();
    let found = swept([&hole, &wide], down(Pose::identity()), Pose::identity()).unwrap();
    assert!(touches_at(&found, 1.0 / 6.0, 1e-6), "{found:?}");
    // One with a clearance of 0.11 mm goes aside by 0.22 mm on its way: at half of it, it is at the wall.
    let peg = solid(&Soup::prism(4, 0.99 * HOLE * SQRT_2, 0.05)).unwrap();
    let [from, to] = [0.04, 0.0].map(|y| at([0.0, y, 0.0]));
    let along = Vector([SQRT_2, 0.0, SQRT_2]) * (0.5 * 0.02 * HOLE);
    let way = [from, to * Pose::translation(along)];
    let found = swept([&hole, &peg], way, Pose::identity()).unwrap();
    assert!(touches_at(&found, 0.5, 5e-4), "{found:?}");
}

/// A block with a hole of so many sides, whose corners are `HOLE` from the axis.
fn hole_of(corners: u32) -> Result<Shape<3>> {
    solid(&Soup::pierced_prism(corners, [0.02, HOLE], 0.05))
}

/// A peg of so many sides, whose corners are as far from the axis as a share of those of the hole.
fn peg_of(corners: u32, share: f64) -> Result<Shape<3>> {
    solid(&Soup::prism(corners, HOLE * share, 0.05))
}

/// How far the sides of a regular polygon are from its middle, as a share of how far its corners are.
fn flat(corners: u32) -> f64 {
    (PI / f64::from(corners)).cos()
}

/// Between parallel sides of a hole and a peg in it a box is free however large it is; where two sides of the hole meet,
/// boxes were as small as the gap and as many as the budget.
#[test]
fn a_peg_goes_into_a_hole_of_as_many_sides() {
    for corners in [12, 48] {
        let (hole, peg) = (hole_of(corners).unwrap(), peg_of(corners, 0.99).unwrap());
        let found = swept([&hole, &peg], down(Pose::identity()), Pose::identity()).unwrap();
        let is_soon = found.evaluations < 1_000_000;
        assert_eq!((found.touches(), is_soon), (Some(false), true), "{corners}: {found:?}");
    }
}

/// The peg is within the circle that touches the sides of the hole.
#[test]
fn a_peg_turns_as_it_goes_into_a_hole() {
    for (corners, angle) in [(12, 0.1), (48, 0.03)] {
        let hole = hole_of(corners).unwrap();
        let peg = peg_of(corners, 0.99 * flat(corners)).unwrap();
        let way = [at([0.0, 0.06, 0.0]), about_y(angle).unwrap()];
        let found = swept([&hole, &peg], way, Pose::identity()).unwrap();
        assert_eq!(found.touches(), Some(false), "{corners}: {found:?}");
    }
}

/// At 2 mrad about its middle the ends of a peg of 50 mm are 50 µm aside, of 106 to 110 µm.
#[test]
fn a_peg_goes_into_a_hole_a_little_tilted() {
    for corners in [12, 48] {
        let hole = hole_of(corners).unwrap();
        let peg = peg_of(corners, 0.99 * flat(corners)).unwrap();
        let tilt = Rotation::from_axis_angle([1.0, 0.0, 0.0], 2e-3).unwrap();
        let tilted = at([0.0, 0.025, 0.0]) * Pose::rotation(tilt) * at([0.0, -0.025, 0.0]);
        let found = swept([&hole, &peg], down(tilted), Pose::identity()).unwrap();
        assert_eq!(found.touches(), Some(false), "{corners}: {found:?}");
    }
}

#[test]
fn pegs_that_do_not_fit_touch_at_their_time() {
    for corners in [12, 48] {
        // One 1 % too wide goes down by 10 of 60 mm to the rim.
        let (hole, wide) = (hole_of(corners).unwrap(), peg_of(corners, 1.01).unwrap());
        let found = swept([&hole, &wide], down(Pose::identity()), Pose::identity()).unwrap();
        assert!(touches_at(&found, 1.0 / 6.0, 1e-6), "{corners}: {found:?}");
        // One that fits goes aside by twice the clearance on its way: at half of it, it is at the wall.
        let peg = peg_of(corners, 0.99).unwrap();
        let [from, to] = [0.04, 0.0].map(|y| at([0.0, y, 0.0]));
        let (sine, cosine) = (PI / f64::from(corners)).sin_cos();
        let along = Vector([cosine, 0.0, sine]) * (0.02 * HOLE * flat(corners));
        let way = [from, to * Pose::translation(along)];
        let found = swept([&hole, &peg], way, Pose::identity()).unwrap();
        assert!(touches_at(&found, 0.5, 5e-4), "{corners}: {found:?}");
    }
}
