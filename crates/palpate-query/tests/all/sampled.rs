// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Pairs of bodies of data, a nut and a bolt as meshes and as grids: nothing is missed, nothing is found where nothing
//! is, and separations are within the bounds of a plain search.

use std::path::Path;

use palpate_field::{Pose, Rotation, Shape, Vector};
use palpate_grid::{Grid, GridOptions};
use palpate_mesh::{ContourOptions, Solid, TriangleMesh, read_file};
use palpate_query::{Limits, PairWorkspace, Placed, overlap, separation};
use palpate_testkit::separation::{Interval, separation as plain_separation};
use palpate_testkit::soup::points;

/// Poses of each pair.
const POSES: u32 = 8;

/// Cells of the plain search.
const CELLS: usize = 200_000;

/// Gaps of the poses, negative where bodies overlap [m].
const GAPS: [f64; 4] = [-0.02, 0.01, -0.05, 0.04];

/// A nut that was scanned, 1 m across.
fn nut() -> TriangleMesh {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/meshes/nut.ply");
    let mesh = read_file(file).expect("the nut");
    let (middle, half) = (mesh.bounds().centre(), mesh.bounds().half_extents());
    let scale = 0.5 / half.0.into_iter().fold(0.0, f64::max);
    let vertices = mesh.vertices().iter().map(|p| (*p - middle) * scale).collect();
    TriangleMesh::new(vertices, mesh.elements().to_vec()).expect("the nut")
}

/// A bolt 0.8 m long: a thread, and a hexagonal head.
fn bolt() -> TriangleMesh {
    let thread =
        Shape::screw_thread(0.15, 0.6, 0.08, 1, [0.01, 0.02, 0.043]).expect("a thread");
    let head = Shape::hexagonal_prism(0.25, 0.2).expect("a head");
    let head = head.translated([0.0, 0.4, 0.0]).expect("a place");
    let bolt = thread | head;
    TriangleMesh::of_shape(&bolt, &ContourOptions::with_cell(0.02)).expect("a bolt")
}

/// The second body on its way from afar to a point about the first, where a gap is about as wide as asked for.
fn pose(bodies: &[Shape<3>; 2], draw: Vector<f64, 3>, gap: f64) -> Option<Pose<3>> {
    let mut workspace = PairWorkspace::new();
    let way = draw.normalized()?;
    let turned = Rotation::from_axis_angle([draw[2], draw[0], draw[1]], 7.0 * draw[0]).ok()?;
    let at = |far: f64| Pose::new(turned, draw * 0.2 + way * far);
    let limits = Limits::new(2e-3);
    let (mut near, mut far) = (0.0, 2.0);
    for _ in 0..10 {
        let middle = 0.5 * (near + far);
        let there = Placed::new(&bodies[1], at(middle));
        let answer = separation(&bodies[0], there, &limits, &mut workspace).ok()?;
        if 0.5 * (answer.lower + answer.upper) > gap { far = middle } else { near = middle }
    }
    Some(at(far))
}

fn nothing_is_missed(what: &str, bodies: &[Shape<3>; 2]) {
    let (limits, mut workspace) = (Limits::new(1e-3), PairWorkspace::new());
    let mut decided = 0;
    for (draw, gap) in points(POSES, 1.0).zip(GAPS.into_iter().cycle()) {
        let Some(pose) = pose(bodies, draw, gap) else { continue };
        let [a, b] = bodies;
        let is_enough = |truth: &Interval| truth.is_within(0.2);
        let truth = plain_separation([(a, Pose::identity()), (b, pose)], CELLS, is_enough);
        let there = Placed::new(b, pose);
        let found = separation(a, there, &limits, &mut workspace).expect("an answer");
        let what = format!("{what}, {gap} m: {found:?}, {truth:?}");
        assert!(truth.lower <= found.upper && found.lower <= truth.upper, "{what}");
        assert!(!found.stop.is_early() && found.upper - found.lower <= 1e-3, "{what}");
        let hit = overlap(a, there, &limits, &mut workspace).expect("an answer");
        if truth.has_sign() {
            decided += 1;
            assert_eq!(hit.is_hit(), Some(truth.upper < 0.0), "{what}");
        }
    }
    assert!(4 * decided >= 3 * POSES, "{what}: {decided} of {POSES}");
}

#[test]
fn a_nut_and_a_bolt_of_triangles_are_not_missed() {
    let solid = |mesh: &TriangleMesh| Shape::from(Solid::from_mesh(mesh).expect("a solid").0);
    nothing_is_missed("meshes", &[solid(&nut()), solid(&bolt())]);
}

#[test]
#[ignore = "slow: cargo xtask test --thorough"]
fn a_nut_and_a_bolt_on_grids_are_not_missed() {
    let grid = |mesh: &TriangleMesh, band: Option<f64>| {
        let solid = Shape::from(Solid::from_mesh(mesh).expect("a solid").0);
        let mut options = GridOptions::with_cell(1.0 / 40.0);
        options.band = band;
        Shape::from(Grid::bake(&solid, &options).expect("a grid"))
    };
    nothing_is_missed("grids", &[grid(&nut(), None), grid(&bolt(), Some(5.0))]);
}
