// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes of shapes: closed, without faces that cross, near the surface, sharp.
use std::f64::consts::TAU;
use std::ops::ControlFlow;

use palpate_field::operator::Profile;
use palpate_field::{Rotation, Shape, Vector};
use palpate_mesh::{ContourError, ContourOptions, FittedMesh, Format, Solid, TriangleMesh};
use palpate_testkit::arbitrary::tree;
use palpate_testkit::cases;

#[expect(unreachable_pub, reason = "shared with the fuzz target")]
#[path = "../../../../fuzz/contour_answers.rs"]
mod contour_answers;

fn mesh(shape: &Shape<3>, cell: f64) -> TriangleMesh {
    TriangleMesh::of_shape(shape, &ContourOptions::with_cell(cell)).unwrap()
}

fn solids() -> Vec<(&'static str, Shape<3>)> {
    let turn = Rotation::from_axis_angle([1.0, 2.0, 3.0], 0.7).unwrap();
    let cuboid = Shape::cuboid([0.5, 0.3, 0.4]).unwrap();
    let ball = Shape::sphere(0.3).unwrap();
    let torus = Shape::torus(0.3, 0.1).unwrap();
    vec![
        ("ball", ball.clone()),
        ("torus", torus.clone()),
        ("box", cuboid.clone()),
        ("turned box", cuboid.clone().rotated(turn).unwrap()),
        ("plate", Shape::cuboid([0.5, 0.5, 0.08]).unwrap().rotated(turn).unwrap()),
        ("box less ball", cuboid.clone() - ball.clone().translated([0.2, 0.1, 0.1]).unwrap()),
        ("hollow", ball.clone() - Shape::sphere(0.2).unwrap()),
        ("two", ball.translated([1.0, 0.0, 0.0]).unwrap() | cuboid.clone()),
        ("blend", Shape::smooth_union([cuboid, torus], Profile::Quadratic, 0.1).unwrap()),
    ]
}

#[test]
fn a_mesh_of_a_shape_is_a_solid_near_it() {
    for (name, shape) in solids() {
        for cell in [0.037, 0.0211] {
            let mesh = mesh(&shape, cell);
            let report = mesh.report();
            assert!(report.is_watertight(), "{name}, {cell} m: {report}");
            assert!(report.enclosed.unwrap() > 0.0, "{name}");
            let (solid, findings) = Solid::from_mesh(&mesh).unwrap();
            assert_eq!(
                findings.crossings + findings.touching,
                0,
                "{name}, {cell} m: {findings}"
            );
            for vertex in mesh.vertices() {
                let off = shape.distance(*vertex).abs();
                assert!(off < 0.25 * cell, "{name}, {cell} m: {} cells", off / cell);
            }
            // The other way: points of the surface lie near the mesh.
            let solid: Shape<3> = solid.into();
            for vertex in mesh.vertices() {
                let Some(on) = shape.surface_point(*vertex) else { continue };
                assert!(solid.distance(on).abs() < 0.3 * cell, "{name}");
            }
        }
    }
}

#[test]
fn edges_and_corners_stay_sharp() {
    let size = [0.5, 0.3, 0.4];
    let mesh = mesh(&Shape::cuboid(size).unwrap(), 0.037);
    assert!((mesh.report().enclosed.unwrap() - 0.06).abs() < 1e-12);
    for corner in 0..8_usize {
        let place: Vector<f64, 3> =
            Vector(std::array::from_fn(|i| size[i] * (((corner >> i) & 1) as f64 - 0.5)));
        let nearest =
            mesh.vertices().iter().map(|v| (*v - place).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-9, "{nearest}");
    }
}

#[test]
fn a_mesh_of_a_mesh_is_the_same_solid() {
    let turn = Rotation::from_axis_angle([1.0, 2.0, 3.0], 0.7).unwrap();
    let cuboid = Shape::cuboid([0.5, 0.3, 0.4]).unwrap().rotated(turn).unwrap();
    let first = mesh(&cuboid, 0.05);
    let (solid, _) = Solid::from_mesh(&first).unwrap();
    let solid: Shape<3> = solid.into();
    let again = mesh(&solid, 0.021);
    assert!(again.report().is_watertight(), "{}", again.report());
    let enclosed = [&first, &again].map(|mesh| mesh.report().enclosed.unwrap());
    assert!((enclosed[0] - enclosed[1]).abs() < 1e-3 * enclosed[0], "{enclosed:?}");
    for vertex in again.vertices() {
        let off = solid.distance(*vertex).abs();
        assert!(off < 0.25 * 0.021, "{off}");
    }
}

/// A gear that was good in double precision had 12 pairs of faces that touch in the file.
#[test]
fn rounding_to_single_precision_makes_no_faces_touch() {
    let corner = |i: u32| {
        let angle = TAU * f64::from(i) / 56.0;
        let radius = 0.018 + 0.004 * (7.0 * angle).sin();
        Vector([radius * angle.cos(), radius * angle.sin()])
    };
    let outline: Vec<_> = (0..56).map(corner).collect();
    let gear = Shape::<2>::polygon([outline]).unwrap().extruded(0.01).unwrap();
    let options = ContourOptions::with_cell(4.4e-4);
    let touching = |is_single| {
        let options = ContourOptions { is_single, ..options.clone() };
        let mesh = TriangleMesh::of_shape(&gear, &options).unwrap();
        let (_, findings) = Solid::from_mesh(&mesh.in_format(Format::Stl).unwrap()).unwrap();
        findings.touching + findings.crossings
    };
    assert!(touching(false) > 0);
    assert_eq!(touching(true), 0);
}

/// Random trees have sheets that touch, edges that meet at points and cells with several patches.
#[test]
fn meshes_of_random_trees_are_closed() {
    let mut meshed = 0;
    cases::check(60, |u| {
        let outcome = contour_answers::check(u, 3, 24)?;
        meshed += u64::from(outcome == Ok(true));
        Ok(outcome.map(|_| ()))
    });
    assert!(meshed > cases::count(20), "{meshed}");
}

/// A point that is told to be lost is on the other side of the surface than the mesh says.
#[test]
fn what_is_told_to_be_lost_is_lost() {
    let mut lost = 0;
    cases::check(60, |u| {
        let Ok(shape) = tree::<3>(u, 3)?.shape() else { return Ok(Ok(())) };
        let Some(bounds) = shape.promise().bounds else { return Ok(Ok(())) };
        let longest = bounds.aabb.half_extents().0.into_iter().fold(0.0, f64::max) * 2.0;
        let options = ContourOptions::with_cell(longest / 6.3);
        let made = FittedMesh::by_cells(&shape, &options, &mut |_| ControlFlow::Continue(()));
        let Ok(FittedMesh { mesh, lost: Some(point), .. }) = made else { return Ok(Ok(())) };
        let Ok((solid, _)) = Solid::from_mesh(&mesh) else { return Ok(Ok(())) };
        lost += 1;
        let (said, is) = (Shape::from(solid).distance(point), shape.distance(point));
        let is_lost = said * is < 0.0;
        Ok(if is_lost { Ok(()) } else { Err(format!("{point:?}: {said} m, and {is} m")) })
    });
    assert!(lost >= cases::count(3), "{lost}");
}

#[test]
fn what_has_no_mesh_is_refused() {
    let ball = Shape::sphere(0.3).unwrap();
    let plane = Shape::half_space([0.0, 1.0, 0.0], 0.0).unwrap();
    let of = |shape: &Shape<3>, cell: f64| {
        TriangleMesh::of_shape(shape, &ContourOptions::with_cell(cell)).unwrap_err()
    };
    assert_eq!(of(&plane, 0.1), ContourError::Unbounded);
    assert_eq!(of(&ball, 0.0), ContourError::Cell { cell: 0.0 });
    assert!(matches!(of(&ball, f64::NAN), ContourError::Cell { .. }));
    assert!(matches!(of(&ball, 1e-5), ContourError::TooMany { .. }));
    let empty = ball.clone() & ball.clone().translated([1.0, 0.0, 0.0]).unwrap();
    assert_eq!(of(&empty, 0.1), ContourError::NoSurface { cell: 0.1 });
    let stopped =
        TriangleMesh::of_shape_with(&ball, &ContourOptions::with_cell(0.01), &mut |_| {
            ControlFlow::Break(())
        });
    assert_eq!(stopped.unwrap_err(), ContourError::Stopped);
}

/// A ball of 3 mm beside one of 1 m, or as a cavity in it, was left out without a word: every triangle of the rest was
/// near the surface.
#[test]
fn a_part_between_the_nodes_is_told_and_found_by_a_tolerance() {
    let large = Shape::sphere(1.0).unwrap();
    let small = Shape::sphere(0.003).unwrap();
    let beside = large.clone() | small.clone().translated([2.0, 0.0, 0.0]).unwrap();
    let cavity = large.clone() - small.translated([0.2, 0.1, -0.3]).unwrap();
    let plate = large.clone()
        | Shape::cuboid([0.5, 0.004, 0.5]).unwrap().translated([0.0, 1.5, 0.0]).unwrap();
    let go_on = &mut |_| ControlFlow::Continue(());
    for shape in [beside, cavity, plate] {
        let coarse =
            FittedMesh::by_cells(&shape, &ContourOptions::with_cell(0.04), go_on).unwrap();
        let Vector(point) = coarse.lost.unwrap();
        // It is on the other side of the surface than the mesh says.
        let (solid, _) = Solid::from_mesh(&coarse.mesh).unwrap();
        let said = Shape::from(solid).distance(point);
        assert!(said * shape.distance(point) < 0.0, "{point:?}: {said}");
        assert_eq!(coarse.within(1.0).unwrap_err(), ContourError::Lost { point, cell: 0.04 });
    }
    let all = large | Shape::sphere(0.02).unwrap().translated([1.5, 0.0, 0.0]).unwrap();
    let options = ContourOptions::with_cell(1.0);
    let fine = FittedMesh::by_tolerance(&all, 2e-3, &options, go_on).unwrap();
    assert_eq!(fine.lost, None);
    assert!(fine.mesh.bounds().max[0] > 1.51, "{:?}", fine.mesh.bounds());
    assert!(fine.within(2e-3).is_ok());
}

#[test]
fn what_is_whole_is_not_told_to_lack_a_part() {
    let go_on = &mut |_| ControlFlow::Continue(());
    for (name, shape) in solids() {
        for cell in [0.037, 0.0211] {
            let fitted = FittedMesh::by_cells(&shape, &ContourOptions::with_cell(cell), go_on);
            assert_eq!(fitted.unwrap().lost, None, "{name}, {cell} m");
        }
    }
}

/// Cells that would see a thin plate are too many: the advice was to choose larger ones, though none had been chosen.
#[test]
fn a_plate_that_is_too_thin_for_its_size_is_told_so() {
    let plate = Shape::cuboid([1.0, 1.0, 1e-7]).unwrap();
    let mut options = ContourOptions::with_cell(1.0);
    options.most_cells = 1 << 20;
    let go_on = &mut |_| ControlFlow::Continue(());
    let error = FittedMesh::by_tolerance(&plate, 1e-3, &options, go_on).unwrap_err();
    assert!(matches!(error, ContourError::TooThin { .. }), "{error}");
}

/// Two cubes that share an edge: rounded to single precision their faces touch there. Vertices were moved half of the way to
/// the middles of their patches, and no cells were small enough for a tolerance.
#[test]
fn faces_that_touch_by_rounding_are_moved_apart_by_little() {
    let cube = Shape::cuboid([1.0; 3]).unwrap();
    let both = cube.clone() | cube.translated([1.0, 1.0, 0.0]).unwrap();
    let options = ContourOptions { is_single: true, ..ContourOptions::with_cell(1.0) };
    let mut least = f64::INFINITY;
    let fitted = FittedMesh::by_tolerance(&both, 1e-3, &options, &mut |progress| {
        least = least.min(progress.cell);
        ControlFlow::Continue(())
    });
    let mesh = fitted.unwrap().within(1e-3).unwrap();
    assert!(least > 0.02, "cells of {least} m");
    let (_, findings) = Solid::from_mesh(&mesh).unwrap();
    assert_eq!(findings.crossings + findings.touching, 0, "{findings}");
}

fn tolerance_shapes() -> Vec<(&'static str, Shape<3>)> {
    let cube = Shape::cuboid([1.5; 3]).unwrap();
    let cylinder = Shape::cylinder(0.4, 2.0).unwrap();
    let axis = |axis| {
        let turn = Rotation::from_axis_angle(axis, TAU / 4.0).unwrap();
        Shape::cylinder(0.5, 3.0).unwrap().rotated(turn).unwrap()
    };
    let tutorial = (Shape::sphere(1.0).unwrap() & cube.clone())
        - (Shape::cylinder(0.5, 3.0).unwrap() | axis([1.0, 0.0, 0.0]) | axis([0.0, 0.0, 1.0]));
    vec![("drilled", cube - cylinder), ("tutorial", tutorial)]
}

/// Smaller cells all over took 2.5 million triangles, or failed.
#[test]
fn a_tolerance_takes_few_triangles() {
    let go_on = &mut |_| ControlFlow::Continue(());
    for (name, shape) in tolerance_shapes() {
        let size = longest(&shape);
        let tolerance = 1e-3 * size;
        for is_single in [false, true] {
            let options = ContourOptions { is_single, ..ContourOptions::with_cell(size) };
            let fitted = FittedMesh::by_tolerance(&shape, tolerance, &options, go_on).unwrap();
            let mesh = fitted.within(tolerance).unwrap();
            let count = mesh.elements().len();
            assert!(count < 6000, "{name}: {count} triangles");
            let report = mesh.report();
            assert!(report.is_watertight() && report.degenerate == 0, "{name}: {report}");
            let (solid, findings) = Solid::from_mesh(&mesh).unwrap();
            assert_eq!(findings.crossings + findings.touching, 0, "{name}: {findings}");
            // The surface is as near to the mesh: nothing of it was cut off.
            let solid: Shape<3> = solid.into();
            let fine =
                TriangleMesh::of_shape(&shape, &ContourOptions::with_cell(0.03)).unwrap();
            for vertex in fine.vertices() {
                let Some(on) = shape.surface_point(*vertex) else { continue };
                let off = solid.distance(on).abs();
                assert!(off < 2.0 * tolerance, "{name}: {on:?} is {off} m away");
            }
        }
    }
}

/// Cells give a box thousands of triangles; a tolerance gives it a few dozen.
#[test]
fn flat_faces_get_large_triangles() {
    let turn = Rotation::from_axis_angle([1.0, 2.0, 3.0], 0.7).unwrap();
    let cuboid = Shape::cuboid([0.5, 0.3, 0.4]).unwrap();
    let frame = cuboid.clone() - Shape::cuboid([0.3, 0.1, 0.5]).unwrap();
    for (shape, most) in [(cuboid, 60), (frame, 120)] {
        for shape in [shape.clone(), shape.rotated(turn).unwrap()] {
            let options = ContourOptions::with_cell(1.0);
            let go_on = &mut |_| ControlFlow::Continue(());
            let mesh = FittedMesh::by_tolerance(&shape, 5e-4, &options, go_on).unwrap();
            let mesh = mesh.within(5e-4).unwrap();
            assert!(mesh.elements().len() <= most, "{} triangles", mesh.elements().len());
        }
    }
}

#[test]
fn random_trees_are_fitted_or_refused() {
    let mut fitted = 0;
    cases::check(40, |u| {
        let Ok(shape) = tree::<3>(u, 3)?.shape() else { return Ok(Ok(())) };
        if shape.promise().bounds.is_none() {
            return Ok(Ok(()));
        }
        let size = longest(&shape);
        let mut options = ContourOptions::with_cell(size);
        options.most_triangles = 100_000;
        options.most_cells = 1 << 18;
        let go_on = &mut |_| ControlFlow::Continue(());
        let made = FittedMesh::by_tolerance(&shape, 1e-2 * size, &options, go_on);
        let Ok(made) = made else { return Ok(Ok(())) };
        let Ok(mesh) = made.within(1e-2 * size) else { return Ok(Ok(())) };
        fitted += 1;
        let [found, _] = mesh.largest_distance(&shape);
        if found > 1e-2 * size {
            return Ok(Err(format!("{found} m of {size} m")));
        }
        Ok(match Solid::from_mesh(&mesh) {
            Ok((_, findings)) if findings.crossings + findings.touching == 0 => Ok(()),
            Ok((_, findings)) => Err(findings.to_string()),
            Err(error) => Err(error.to_string()),
        })
    });
    assert!(fitted >= cases::count(10), "{fitted}");
}

#[test]
fn too_many_triangles_are_refused_with_advice() {
    let ball = Shape::sphere(0.5).unwrap();
    let options = ContourOptions { most_triangles: 20_000, ..ContourOptions::with_cell(1.0) };
    let go_on = &mut |_| ControlFlow::Continue(());
    let error = FittedMesh::by_tolerance(&ball, 1e-6, &options, go_on).unwrap_err();
    assert_eq!(error, ContourError::TooManyTriangles { limit: 20_000 });
    assert!(error.to_string().contains("take a larger tolerance or larger cells"), "{error}");
    let cells = ContourOptions { cell: 0.005, ..options };
    assert_eq!(TriangleMesh::of_shape(&ball, &cells).unwrap_err(), error);
}

fn longest(shape: &Shape<3>) -> f64 {
    let bounds = shape.promise().bounds.unwrap().aabb;
    bounds.half_extents().0.into_iter().fold(0.0, f64::max) * 2.0
}
