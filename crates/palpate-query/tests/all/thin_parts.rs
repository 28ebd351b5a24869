// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Regions of contact that are thinner than the spacing, or have parts that are: boards, discs, rods, legs.

use std::error::Error;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use palpate_field::{Point, Pose, Rotation, Shape, ShapeError, Vector};
use palpate_mesh::TriangleMesh;
use palpate_query::{Limits, Manifold, ManifoldSettings, PairWorkspace, Placed, manifold};
use palpate_testkit::soup::Soup;

type Tested<T> = Result<T, Box<dyn Error>>;

/// The contacts of a body with a half-space below zero, for bodies of about 1 m.
fn on_ground(shape: &Shape<3>, pose: Pose<3>) -> Tested<Manifold<3>> {
    on_floor(&ground()?, shape, pose, 1.0)
}

fn ground() -> Result<Shape<3>, ShapeError> {
    Shape::<3>::half_space([0.0, 1.0, 0.0], 0.0)
}

/// The contacts of a body with a floor, for bodies of about `size` [m]. In the world both are somewhere
/// else, turned; the contacts are where the floor is.
fn on_floor(
    floor: &Shape<3>,
    shape: &Shape<3>,
    pose: Pose<3>,
    size: f64,
) -> Tested<Manifold<3>> {
    let settings = ManifoldSettings::of_size(size);
    let limits = Limits::new(settings.usual_tolerance());
    let turn = Rotation::from_axis_angle(Vector([0.3, 1.0, -0.5]), 0.7)?;
    let world = Pose::new(turn, Vector([0.3, -0.2, 0.9]));
    let [a, b] = [Placed::new(floor, world), Placed::new(shape, world * pose)];
    let mut found = manifold(a, b, &settings, &limits, &mut PairWorkspace::new())?;
    let back = world.inverse();
    for contact in &mut found.contacts {
        contact.point_a = back.transform_point(contact.point_a);
        contact.point_b = back.transform_point(contact.point_b);
        contact.normal = back.transform_vector(contact.normal);
    }
    Ok(found)
}

/// Whether the contacts reach each of these places but for two spacings, with a gap near `gap`.
fn reaches(found: &Manifold<3>, places: &[Point<3>], gap: f64) {
    reaches_by(found, places, gap, 1.0);
}

/// The same of bodies of about `size` [m].
fn reaches_by(found: &Manifold<3>, places: &[Point<3>], gap: f64, size: f64) {
    let spacing = ManifoldSettings::of_size(size).spacing;
    for place in places {
        let near = found.contacts.iter().filter(|contact| {
            let middle = (contact.point_a + contact.point_b) * 0.5;
            (middle - *place).norm() <= 2.0 * spacing
                && (contact.gap - gap).abs() <= 2e-4 * size
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

/// The solid of triangles.
fn solid(soup: &Soup) -> Tested<Shape<3>> {
    let mesh = TriangleMesh::new(soup.vertices.clone(), soup.faces.clone())?;
    Ok(palpate_mesh::Solid::from_mesh(&mesh)?.0.into())
}

/// Floors with a flat top at zero, 24 m long.
fn floors() -> Tested<Vec<Shape<3>>> {
    let (centre, size) = ([0.0, -0.5, 0.0], [24.0, 1.0, 24.0]);
    Ok(vec![
        ground()?,
        Shape::<3>::cuboid(size)?.translated(centre)?,
        solid(&Soup::cuboid(centre, size))?,
    ])
}

fn turned(axis: usize, angle: f64, height: f64) -> Tested<Pose<3>> {
    let turn = Rotation::from_axis_angle(Vector::unit(axis), angle)?;
    Ok(Pose::new(turn, Vector([0.0, height, 0.0])))
}

/// Once, a box on its edge had one contact, in the middle, with the separation as gap.
#[test]
fn a_box_on_its_edge_touches_along_the_edge() -> Tested<()> {
    for [side, length] in [[1.0, 2.0], [0.05, 1.0], [0.4, 0.3]] {
        let size = [side, side, length];
        let boxes = [Shape::<3>::cuboid(size)?, solid(&Soup::cuboid([0.0; 3], size))?];
        for depth in [0.0, 1e-5, 1e-4, 1e-3, 3e-3] {
            let pose = turned(2, FRAC_PI_4, side * 0.5_f64.sqrt() - depth)?;
            for floor in floors()? {
                for shape in &boxes {
                    let found = on_floor(&floor, shape, pose, 1.0)?;
                    let ends = [0.5, -0.5].map(|z| Vector([0.0, -0.5 * depth, z * length]));
                    reaches(&found, &ends, -depth);
                    for contact in &found.contacts {
                        assert!((contact.gap + depth).abs() < 1e-5, "{depth}: {contact:?}");
                        assert!((contact.normal - Vector::unit(1)).norm() < 1e-6);
                    }
                }
            }
        }
    }
    Ok(())
}

/// Once, a rod of 10 m had no contact at one end, and one of 2 m a single one.
#[test]
fn long_rods_lie_on_both_ends_on_any_floor() -> Tested<()> {
    for (radius, length) in [(0.1, 10.0), (0.1, 2.0), (0.02, 10.0), (0.002, 0.2)] {
        let size: f64 = length;
        let rod = Shape::<3>::capsule(radius, length)?;
        let bar = solid(&Soup::prism(24, radius, length))?;
        let bar = bar.rotated(Rotation::from_axis_angle(Vector::unit(1), PI / 24.0)?)?;
        let bar = bar.translated([0.0, -0.5 * length, 0.0])?;
        for share in [0.0, 1e-5, 1e-4, 1e-3] {
            let depth = share * size.min(1.0);
            for floor in floors()? {
                // The mesh lies on one of its sides.
                let flat = radius * (PI / 24.0).cos();
                for (shape, height, end) in
                    [(&rod, radius, 0.5 * length - radius), (&bar, flat, 0.5 * length)]
                {
                    let pose = turned(2, FRAC_PI_2, height - depth)?;
                    let found = on_floor(&floor, shape, pose, size)?;
                    let ends = [end, -end].map(|x| Vector([x, -0.5 * depth, 0.0]));
                    reaches_by(&found, &ends, -depth, size);
                }
            }
        }
    }
    Ok(())
}

/// A plate on legs that are square or round, as primitives or as one mesh.
fn tables(half: f64) -> Tested<Vec<Shape<3>>> {
    let places = [[0.45, 0.45], [0.45, -0.45], [-0.45, 0.45], [-0.45, -0.45]];
    let (plate, mut soup) = ([1.0, 0.02, 1.0], Soup::cuboid([0.0; 3], [1.0, 0.02, 1.0]));
    let [mut round, mut square] = [Vec::new(), Vec::new()];
    for [x, z] in places {
        let [centre, size] = [[x, -0.25, z], [2.0 * half, 0.5, 2.0 * half]];
        round.push(Shape::<3>::cylinder(half, 0.5)?.translated(centre)?);
        square.push(Shape::<3>::cuboid(size)?.translated(centre)?);
        soup = soup.and(Soup::cuboid(centre, size));
    }
    let union = |legs: Vec<Shape<3>>| {
        Shape::union(legs.into_iter().chain([Shape::<3>::cuboid(plate)?]))
    };
    Ok(vec![union(round)?, union(square)?, solid(&soup)?])
}

#[test]
fn tables_of_any_make_stand_on_all_legs_on_any_floor() -> Tested<()> {
    for half in [0.04, 0.005, 0.003] {
        for (i, table) in tables(half)?.iter().enumerate() {
            for depth in [0.0, 1e-4, 1e-3] {
                for floor in floors()? {
                    let pose = turned(1, 0.4, 0.5 - depth)?;
                    let found = on_floor(&floor, table, pose, 1.0)?;
                    assert!(found.is_whole, "{i}, {half}, {depth}: {found:?}");
                    let places = [[0.45, 0.45], [0.45, -0.45], [-0.45, 0.45], [-0.45, -0.45]];
                    let places = places
                        .map(|[x, z]| pose.transform_point(Vector([x, -0.5 + 0.5 * depth, z])));
                    reaches(&found, &places, -depth);
                }
            }
        }
    }
    Ok(())
}

#[test]
fn thin_boards_of_any_make_lie_on_four_corners_on_any_floor() -> Tested<()> {
    for size in [[1.0, 0.01, 0.5], [2.0, 0.002, 0.1], [0.3, 0.001, 0.3]] {
        for board in [Shape::<3>::cuboid(size)?, solid(&Soup::cuboid([0.0; 3], size))?] {
            for share in [-1e-3, 0.0, 1e-5, 1e-3] {
                let largest = size[0];
                let depth = share * largest;
                for floor in floors()? {
                    let pose = turned(1, 0.4, 0.5 * size[1] - depth)?;
                    let found = on_floor(&floor, &board, pose, largest)?;
                    assert!(found.is_whole, "{size:?}, {depth}: {found:?}");
                    let [x, y, z] = size.map(|length| 0.5 * length);
                    let corners = [[x, z], [x, -z], [-x, z], [-x, -z]]
                        .map(|[x, z]| pose.transform_point(Vector([x, 0.5 * depth - y, z])));
                    reaches_by(&found, &corners, -depth, largest);
                }
            }
        }
    }
    Ok(())
}
