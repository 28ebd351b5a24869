// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Solids of meshes, sound and damaged, against every face and the exact winding number.

use std::f64::consts::TAU;
use std::path::Path;

use palpate_field::{CustomField, MassLimits, Quality, Rotation, Shape, Vector};
use palpate_mesh::{
    Findings, Mesh, MeshSheet, Outline, Solid, SolidError, TriangleMesh, read_file,
};
use palpate_testkit::soup::{Soup, points};
use palpate_testkit::{cases, hard, models};

/// The mesh of triangles.
fn mesh(soup: &Soup) -> TriangleMesh {
    Mesh::new(soup.vertices.clone(), soup.faces.clone()).expect("faces")
}

/// The solid of triangles, as a shape.
fn solid(soup: &Soup) -> (Shape<3>, Findings<3>) {
    let (solid, findings) = Solid::from_mesh(&mesh(soup)).expect("a solid");
    (solid.into(), findings)
}

/// Values have the sign of the winding number of `truth`, and the size of the distance to the nearest face of
/// the mesh.
fn agrees(shape: &Shape<3>, soup: &Soup, truth: &Soup, reach: f64) {
    for p in points(600, reach) {
        let found = shape.distance(p);
        let distance = soup.distance(p);
        assert!((found.abs() - distance).abs() < 1e-12, "{p:?}: {found} of {distance}");
        assert_eq!(found < 0.0, truth.winding(p) > 0.5, "{p:?}: {found}");
    }
}

#[test]
fn a_cuboid_of_triangles_is_the_cuboid() {
    let (shape, findings) = solid(&Soup::cuboid([0.0; 3], [1.0, 2.0, 3.0]));
    assert!(findings.is_clean(), "{findings}");
    let exact = Shape::<3>::cuboid([1.0, 2.0, 3.0]).unwrap();
    assert_eq!(
        (shape.promise().outside, shape.promise().inside),
        (Quality::Exact, Quality::Exact)
    );
    for p in points(2000, 3.0) {
        let [(f, slope), (g, other)] = [&shape, &exact].map(|shape| shape.distance_gradient(p));
        assert!((f - g).abs() < 1e-15 && (slope - other).norm() < 1e-12, "{p:?}: {f}, {g}");
    }
}

#[test]
fn solids_that_overlap_nest_or_touch_keep_their_signs() {
    let turn = Rotation::from_axis_angle([0.3, 1.0, 0.2], 0.7).unwrap();
    let (one, two) = (
        Soup::cuboid([0.0; 3], [1.0; 3]),
        Soup::cuboid([0.4, 0.3, 0.2], [1.0, 0.8, 0.9]).turned(&turn),
    );
    let both = one.clone().and(two);
    let (shape, findings) = solid(&both);
    assert!(findings.crossings > 0 && findings.turned == 0, "{findings}");
    assert_eq!(
        (shape.promise().outside, shape.promise().inside),
        (Quality::Exact, Quality::Bound)
    );
    agrees(&shape, &both, &both, 1.5);

    let outer = Soup::ball([0.0; 3], 1.0, 12);
    let inner = Soup::ball([0.1, 0.0, 0.0], 0.5, 9);
    let nested = outer.clone().and(inner.clone());
    let (shape, findings) = solid(&nested);
    assert_eq!((findings.nested, findings.crossings), (1, 0), "{findings}");
    assert_eq!(findings.inner, inner.faces.len(), "{findings}");
    assert_eq!(shape.promise().inside, Quality::Exact);
    agrees(&shape, &outer, &outer, 1.2);

    let hollow =
        Soup::ball([0.0; 3], 1.0, 12).and(Soup::ball([0.1, 0.0, 0.0], 0.5, 9).inside_out());
    let (shape, findings) = solid(&hollow);
    assert_eq!((findings.nested, findings.inside_out), (0, 0), "{findings}");
    assert_eq!(shape.promise().inside, Quality::Exact);
    agrees(&shape, &hollow, &hollow, 1.2);
    // The whole inside out: both are turned.
    let (shape, findings) = solid(&hollow.clone().inside_out());
    assert_eq!(findings.inside_out, 2, "{findings}");
    agrees(&shape, &hollow, &hollow, 1.2);

    // Cubes that share an edge, and a wall that both have.
    let (left, right) =
        (Soup::cuboid([-0.5, 0.0, 0.0], [1.0; 3]), Soup::cuboid([0.5, 1.0, 0.0], [1.0; 3]));
    let edge = left.clone().and(right);
    let (shape, findings) = solid(&edge);
    assert_eq!(findings.crowded_rims, 1, "{findings}");
    agrees(&shape, &edge, &edge, 2.0);
    let stacked = left.clone().and(Soup::cuboid([0.5, 0.0, 0.0], [1.0; 3]));
    let (shape, findings) = solid(&stacked);
    assert_eq!(findings.duplicates, 4, "{findings}");
    let whole = Soup::cuboid([0.0; 3], [2.0, 1.0, 1.0]);
    agrees(&shape, &whole, &whole, 1.5);
}

#[test]
fn faces_that_are_turned_doubled_or_gone_are_mended() {
    let ball = Soup::ball([0.0; 3], 1.0, 12);
    let every = |n: usize| move |i: &usize| i.is_multiple_of(n);
    let mut turned = ball.clone();
    (0..turned.faces.len()).filter(every(10)).for_each(|i| turned.faces[i].swap(0, 1));
    let (shape, findings) = solid(&turned);
    assert_eq!(findings.turned, turned.faces.len().div_ceil(10), "{findings}");
    agrees(&shape, &ball, &ball, 1.2);

    let mut doubled = ball.clone();
    for i in (0..ball.faces.len()).filter(every(5)) {
        let [a, b, c] = ball.faces[i];
        doubled.faces.push([b, a, c]);
    }
    let (shape, findings) = solid(&doubled);
    assert_eq!(findings.duplicates, ball.faces.len().div_ceil(5), "{findings}");
    agrees(&shape, &ball, &ball, 1.2);

    let mut open = ball.clone();
    open.faces.retain(|face| face.iter().any(|index| ball.vertices[*index as usize][1] < 0.8));
    let (shape, findings) = solid(&open);
    assert_eq!(findings.openings.len(), 1, "{findings}");
    let words = findings.to_string();
    assert!(
        words.contains("1 opening, ") && words.contains(" was closed by a flat cap: within 0."),
        "{words}"
    );
    assert!(shape.distance([0.0, 0.5, 0.0]) < 0.0 && shape.distance([0.0, 0.95, 0.0]) > 0.0);
}

/// A tube without ends, of more corners than are cut one by one.
#[test]
fn long_openings_are_closed() {
    let tube = Soup::tube(1500);
    let (shape, findings) = solid(&tube);
    assert_eq!((findings.openings.len(), findings.crossings), (2, 0), "{findings}");
    let cylinder = Shape::<3>::cylinder(1.0, 2.0).unwrap();
    for p in points(500, 2.0) {
        let [f, g] = [&shape, &cylinder].map(|shape| shape.distance(p));
        assert!((f - g).abs() < 1e-5, "{p:?}: {f}, {g}");
    }
}

#[test]
fn what_bounds_no_solid_is_refused() {
    // A Möbius strip of triangles.
    let mut strip = Soup::default();
    for i in 0..20 {
        let angle = TAU * f64::from(i) / 20.0;
        let ring = Vector([angle.cos(), 0.0, angle.sin()]);
        let across =
            ring * (0.5 * angle).cos() * 0.2 + Vector([0.0, 0.2 * (0.5 * angle).sin(), 0.0]);
        strip.vertices.extend([ring - across, ring + across]);
    }
    for i in 0..20_u32 {
        let [a, b] = [2 * i, 2 * i + 1];
        let [c, d] = if i == 19 { [1, 0] } else { [2 * i + 2, 2 * i + 3] };
        strip.faces.extend([[a, b, c], [b, d, c]]);
    }
    let error = Solid::from_mesh(&mesh(&strip)).unwrap_err();
    assert_eq!(error, SolidError::OneSided { pieces: 1 });
    let flat = Soup { vertices: vec![Vector::ZERO; 3], faces: vec![[0, 0, 1]] };
    let error = Solid::from_mesh(&mesh(&flat)).unwrap_err();
    assert_eq!(error, SolidError::NoFaces { given: 1 });
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]
        .map(Vector)
        .to_vec();
    let sheet = Soup { vertices: square, faces: vec![[0, 1, 2], [0, 2, 3]] };
    let error = Solid::from_mesh(&mesh(&sheet)).unwrap_err();
    assert_eq!(error, SolidError::Sheet);
}

#[test]
fn outlines_are_solids_of_the_plane() {
    let corners = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let sides = |count: u32| (0..count).map(|i| [i, (i + 1) % 6]).collect::<Vec<_>>();
    let polygon = Shape::<2>::polygon(vec![corners.to_vec()]).unwrap();
    // Closed, and without its last side.
    for count in [6, 5] {
        let outline = Outline::new(corners.map(Vector).to_vec(), sides(count)).unwrap();
        let (solid, findings) = Solid::from_mesh(&outline).unwrap();
        assert_eq!(findings.openings.len() as u32, 6 - count, "{findings}");
        let shape: Shape<2> = solid.into();
        for p in points(1000, 4.0) {
            let p = Vector([p[0], p[1]]);
            assert!((shape.distance(p) - polygon.distance(p)).abs() < 1e-14, "{p:?}");
        }
    }
}

#[test]
fn a_point_that_is_nowhere_has_no_distance() {
    // Once the padding of the boxes was looked up, beyond their end.
    let (shape, _) = solid(&Soup::ball([0.0; 3], 1.0, 12));
    for x in [f64::NAN, f64::INFINITY] {
        assert!(shape.distance([x, 0.0, 0.0]).is_nan());
    }
    assert!((shape.distance([1e12, 0.0, 0.0]) - 1e12).abs() < 2.0);
}

/// Of the airplane, caps cross faces.
/// The search of a point begins with what is known of the one before; that may be on the surface, or far off.
#[test]
fn values_of_many_points_are_those_of_each() {
    let slivers =
        Soup::cuboid([0.0; 3], [1e3, 1.0, 1e-6]).and(Soup::cuboid([9.0; 3], [1.0; 3]));
    let bunny = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/meshes/bunny.ply");
    let meshes = [mesh(&slivers), read_file(bunny).expect("a file")];
    for mesh in meshes {
        let (solid, _) = Solid::from_mesh(&mesh).expect("a solid");
        let size = mesh.bounds().half_extents().norm();
        let mut asked = Vec::new();
        for (i, p) in points(400, 1.5 * size).enumerate() {
            let p = mesh.bounds().centre() + p;
            let (distance, gradient) = solid.distance_gradient(p);
            let foot = p - gradient * distance;
            asked.extend([p, foot, foot, foot + gradient * (1e-12 * size)]);
            asked.push(mesh.vertices()[i % mesh.vertices().len()]);
            if i % 50 == 0 {
                // The nearest point to the last is no point, and was once known to the next.
                asked.extend([
                    Vector([f64::NAN, 0.0, 0.0]),
                    Vector([1e200, 0.0, 0.0]),
                    p,
                    Vector([1e308, -1e308, 0.0]),
                ]);
            }
        }
        let (mut alone, mut values) = (vec![0.0; asked.len()], vec![0.0; asked.len()]);
        let mut gradients = vec![Vector::ZERO; asked.len()];
        solid.distances(&asked, &mut alone);
        solid.distances_gradients(&asked, &mut values, &mut gradients);
        for (i, p) in asked.into_iter().enumerate() {
            let (value, gradient) = solid.distance_gradient(p);
            for found in [alone[i], values[i]] {
                assert_eq!(found.to_bits(), value.to_bits(), "{p:?}: {found} {value}");
            }
            assert_eq!(gradients[i], gradient, "{p:?}");
        }
    }
}

#[test]
fn real_meshes_become_solids() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/meshes");
    for (file, crossings, openings) in
        [("nut", 0, 0), ("ant", 99, 0), ("bunny", 0, 0), ("airplane", 75, 14)]
    {
        let mesh = read_file(folder.join(file).with_extension("ply")).unwrap();
        let (solid, findings) = Solid::from_mesh(&mesh).unwrap();
        assert_eq!(findings.crossings, crossings, "{file}: {findings}");
        assert_eq!(findings.openings.len(), openings, "{file}: {findings}");
        let truth =
            Soup { vertices: mesh.vertices().to_vec(), faces: mesh.elements().to_vec() };
        let shape: Shape<3> = solid.into();
        let (middle, reach) = (mesh.bounds().centre(), mesh.bounds().half_extents().norm());
        for p in points(300, reach).map(|p| p + middle) {
            let number = truth.winding(p);
            // Near openings, caps decide.
            let is_clear = openings == 0 || (number - 0.5).abs() > 0.45;
            assert!(!is_clear || (shape.distance(p) < 0.0) == (number > 0.5), "{file}, {p:?}");
        }
    }
}

/// No value over a cell leaves its model, and the models of small cells off the surface are much closer than
/// those of the Lipschitz constant.
#[test]
fn models_bound_what_is_in_their_cells() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/meshes");
    let nut = read_file(folder.join("nut.ply")).unwrap();
    let ball =
        mesh(&Soup::ball([0.0; 3], 1.0, 12).and(Soup::cuboid([0.9, 0.2, 0.1], [0.5; 3])));
    for mesh in [nut, ball] {
        let (middle, size) = (mesh.bounds().centre(), mesh.bounds().half_extents().norm());
        let (solid, _) = Solid::from_mesh(&mesh).unwrap();
        let (mut closer, mut count) = (0.0, 0.0);
        for (i, p) in points(400, 1.3 * size).enumerate() {
            let centre = p + middle;
            let half = [0.2, 0.05, 0.01, 0.002][i % 4] * size;
            let sides = [half, 0.7 * half, 0.4 * half];
            let model = models::bounding(&solid, centre, sides, 60).unwrap();
            if i % 4 == 3 {
                closer += (model.lower + model.upper) / (2.0 * Vector(sides).norm());
                count += 1.0;
            }
        }
        assert!(closer / count < 0.1, "{}", closer / count);
    }
}

/// A model of a cell that the surface passes once was that of the Lipschitz constant alone. The cuboids overlap.
#[test]
fn models_across_the_surface_know_its_direction() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/meshes");
    let turn = Rotation::from_axis_angle([0.3, 1.0, 0.2], 0.7).unwrap();
    let cuboids = Soup::cuboid([0.0; 3], [1.0; 3])
        .and(Soup::cuboid([0.4, 0.3, 0.2], [1.0, 0.8, 0.9]).turned(&turn));
    let real = |name| (name, read_file(folder.join(name)).unwrap());
    for (name, mesh) in [real("nut.ply"), real("bunny.ply"), ("cuboids", mesh(&cuboids))] {
        let most = if name == "cuboids" { 0.7 } else { 0.55 };
        let size = mesh.bounds().half_extents().norm();
        let (solid, _) = Solid::from_mesh(&mesh).unwrap();
        let (mut share, mut count) = (0.0, 0.0);
        for (face, u) in (0..mesh.elements().len() * 9).step_by(7).zip(points(4000, 1.0)) {
            let [a, b, c] = mesh.corners(face % mesh.elements().len());
            // Near the surface, at places that are edges and corners too.
            let near = a + (b - a) * u[0].abs() * 0.5 + (c - a) * u[1].abs() * 0.5;
            let half = [0.03, 0.01, 0.003][face % 3] * size;
            let centre = near + u * (0.5 * half);
            let model = models::bounding(&solid, centre, [half; 3], 80).unwrap();
            share += (model.lower + model.upper) / (2.0 * 3.0_f64.sqrt() * half);
            count += 1.0;
        }
        assert!(share / count < most, "{name}: {}", share / count);
    }
}

/// Of a polyhedron no cells are cut; of faces that cross they are.
#[test]
fn the_mass_of_a_mesh_is_that_of_its_faces() {
    let (shape, _) = solid(&Soup::cuboid([0.3, 0.1, -0.2], [1.0, 2.0, 3.0]));
    let turn = Rotation::from_axis_angle([0.3, 1.0, 0.2], 0.7).unwrap();
    let moved = shape.clone().rotated(turn).unwrap().scaled(2.0).unwrap();
    let moved = moved.translated([5.0, 0.0, 0.0]).unwrap();
    let middle = turn.rotate(Vector([0.3, 0.1, -0.2])) * 2.0 + Vector([5.0, 0.0, 0.0]);
    for (shape, scale, middle) in
        [(shape, 1.0_f64, Vector([0.3, 0.1, -0.2])), (moved, 2.0, middle)]
    {
        let mass = shape.mass(500.0, MassLimits::default()).unwrap();
        let volume = 6.0 * scale.powi(3);
        assert_eq!(mass.cells, 0);
        assert!((mass.volume - volume).abs() <= mass.volume_error, "{mass:?}");
        assert!((mass.centroid - middle).norm() <= 2.0 * mass.centroid_error, "{mass:?}");
        // (a² + b² + c²)/12 of the mass, whichever way it is turned.
        let inertia = 500.0 * volume * 14.0 * scale.powi(2) / 12.0;
        let off = (mass.polar_inertia() - inertia).abs();
        assert!(off <= 3.0 * mass.second_moments_error, "{off}, {mass:?}");
        let relative = [
            mass.volume_error / volume,
            mass.centroid_error / scale,
            mass.second_moments_error / inertia,
        ];
        assert!(relative.iter().all(|error| *error < 1e-10), "{relative:?}");
    }
    let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]].map(Vector).to_vec();
    let outline = Outline::new(square, (0..4).map(|i| [i, (i + 1) % 4]).collect()).unwrap();
    let flat: Shape<2> = Solid::from_mesh(&outline).unwrap().0.into();
    let mass = flat.mass(1.0, MassLimits::default()).unwrap();
    assert!((mass.volume - 2.0).abs() <= mass.volume_error && mass.volume_error < 1e-12);
    assert!((mass.centroid - Vector([1.0, 0.5])).norm() < 1e-12);
    // Two cubes that share a half: 1.5 m³, though their faces enclose 2.
    let [one, two] = [0.0, 0.5].map(|x| Soup::cuboid([x, 0.01 * x, 0.0], [1.0; 3]));
    let (both, findings) = solid(&one.and(two));
    assert!(findings.crossings > 0);
    let mass = both.mass(1.0, MassLimits { tolerance: 1e-2, ..MassLimits::default() }).unwrap();
    let volume = 2.0 - 0.5 * 0.995;
    assert!(mass.cells > 0 && (mass.volume - volume).abs() <= mass.volume_error, "{mass:?}");
}

/// Walls within overlapping solids were once named as surface.
#[test]
fn a_wall_within_is_no_surface() {
    let [one, two] = [0.0, 0.5].map(|x| Soup::cuboid([x, 0.01 * x, 0.0], [1.0; 3]));
    let (both, _) = solid(&one.and(two));
    assert_eq!(both.surface_point([0.45, 0.0, 0.0]), None);
    let on_surface = both.surface_point([-0.3, 0.0, 0.1]);
    assert!(on_surface.is_some_and(|p| (p - Vector([-0.5, 0.0, 0.1])).norm() < 1e-12));
}

/// A plate is as far as its faces, whatever they are, less half its thickness.
#[test]
fn faces_without_an_inside_are_a_plate() {
    let turn = Rotation::from_axis_angle([0.3, 1.0, 0.2], 0.7).unwrap();
    let crossing = Soup::cuboid([0.1, 0.2, 0.0], [0.5, 0.6, 0.7]).turned(&turn);
    let soup = hard::sheet(6, 1.0).and(crossing.without(|face| face % 3 == 0));
    let sheet = MeshSheet::from_mesh(&mesh(&soup), 0.02).unwrap();
    let size = soup.reach();
    for (i, p) in points(300, 1.5 * size).enumerate() {
        let (f, gradient) = CustomField::distance_gradient(&sheet, p);
        assert!((f + 0.01 - soup.distance(p)).abs() < 1e-14, "{p:?}: {f}");
        assert!((gradient.norm() - 1.0).abs() < 1e-12, "{p:?}: {gradient:?}");
        let half = [0.2, 0.02, 0.003][i % 3] * size;
        models::bounding(&sheet, p, [half, 0.5 * half, half], 40).unwrap();
    }
    for thickness in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(MeshSheet::from_mesh(&mesh(&soup), thickness).is_err());
    }
}

#[test]
fn faces_that_are_all_doubled_are_a_surface_that_is_there_twice() {
    let ball = Soup::ball([0.0; 3], 1.0, 12);
    for other in [ball.clone(), ball.clone().inside_out()] {
        let (shape, findings) = solid(&ball.clone().and(other));
        assert_eq!(findings.duplicates, ball.faces.len(), "{findings}");
        assert_eq!(shape.promise().inside, Quality::Exact);
        agrees(&shape, &ball, &ball, 1.2);
    }
}

/// A part that was mirrored has its inside outside; it was told to be a cavity of a part that it overlaps, and of 9 m³
/// 7.02 were left.
#[test]
fn parts_inside_out_that_overlap_or_share_a_face_are_solids() {
    let cube = Soup::cuboid([1.0; 3], [2.0; 3]);
    let overlapping = Soup::cuboid([2.0, 1.0, 1.0], [2.0, 1.0, 1.0]);
    let beside = Soup::cuboid([3.0, 1.0, 1.0], [2.0; 3]);
    for other in [overlapping, beside] {
        let truth = cube.clone().and(other.clone());
        for parts in [
            cube.clone().inside_out().and(other.clone()),
            cube.clone().and(other.clone().inside_out()),
            truth.clone().inside_out(),
        ] {
            let (shape, findings) = solid(&parts);
            assert!(findings.openings.is_empty(), "{findings}");
            for p in points(600, 4.0) {
                assert_eq!(
                    shape.distance(p) < 0.0,
                    truth.winding(p) > 0.5,
                    "{p:?}: {findings}"
                );
            }
        }
    }
}

/// Needles through one point all cross each other: the time grew with the square of their number.
/// Of a cavity all of whose faces touch the outer ones, samples were taken on walls of both: it was turned, and filled.
#[test]
fn a_cavity_whose_walls_lie_in_several_outer_walls_stays_one() {
    let outer = || Soup::cuboid([0.5; 3], [1.0; 3]);
    for (centre, size) in [
        ([0.25, 0.25, 0.5], [0.5; 3]),
        ([0.25; 3], [0.5; 3]),
        ([0.5, 0.5, 0.25], [1.0, 0.5, 0.5]),
    ] {
        let soup = outer().and(Soup::cuboid(centre, size).inside_out());
        let (shape, findings) = solid(&soup);
        assert_eq!(findings.inside_out, 0, "{findings}");
        assert!(shape.distance(centre) > 0.0, "{centre:?}: {}", shape.distance(centre));
        for p in points(400, 0.8).map(|p| p + Vector([0.5; 3])) {
            assert_eq!(shape.distance(p) < 0.0, soup.winding(p) > 0.5, "{p:?}");
        }
    }
}

/// The lid of a box, of which each edge is one of the box and two of the lid: both were closed by caps.
#[test]
fn a_fine_lid_on_a_coarse_box_is_a_solid() {
    let cuboid = Soup::cuboid([0.0; 3], [2.0; 3]);
    let is_lid = |face: &[u32; 3]| face.iter().all(|i| cuboid.vertices[*i as usize][1] > 0.0);
    let is_of_lid: Vec<bool> = cuboid.faces.iter().map(is_lid).collect();
    let mut soup = cuboid.without(|i| is_of_lid[i]);
    // A pyramid above the box, counter-clockwise seen from above.
    let rim = [[-1, -1], [-1, 0], [-1, 1], [0, 1], [1, 1], [1, 0], [1, -1], [0, -1]];
    let first = soup.vertices.len() as u32;
    soup.vertices.extend(rim.map(|[x, z]| Vector([f64::from(x), 1.0, f64::from(z)])));
    soup.vertices.push(Vector([0.0, 2.0, 0.0]));
    soup.faces.extend((0..8).map(|i| [first + i, first + (i + 1) % 8, first + 8]));
    let (shape, findings) = solid(&soup);
    assert_eq!((findings.parted, findings.openings.len()), (4, 0), "{findings}");
    assert_eq!(shape.promise().in_words(), "exact outside, exact inside");
    let mass = shape.mass(1.0, MassLimits::default()).unwrap();
    assert!((mass.volume - (8.0 + 4.0 / 3.0)).abs() < 1e-12, "{mass:?}");
}

#[test]
fn the_search_for_faces_that_meet_ends() {
    let mut needles = Soup { vertices: Vec::new(), faces: Vec::new() };
    for p in points(700, 1.0) {
        let (one, two) =
            (p.cross(Vector([0.3, 0.2, 0.9])) * 0.1, p.cross(Vector([0.9, 0.3, 0.2])) * 0.1);
        let first = needles.vertices.len() as u32;
        needles.vertices.extend([p, one - p, two - p, -(one + two) - p]);
        let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        needles.faces.extend(faces.map(|face| face.map(|i| first + i)));
    }
    let (_, findings) = solid(&needles);
    assert!(findings.are_more, "{findings}");
    assert_eq!(findings.crossings + findings.touching, 1_000_000);
    assert!(findings.to_string().contains("after these no more pairs were sought"));
}

/// Random boxes on a lattice, some inside out, that overlap, touch, share faces, edges and corners. Those inside out
/// neither lie in others or hold them, as cavities do, nor share a whole face with one.
#[test]
fn unions_of_boxes_are_what_is_in_one_of_them() {
    cases::check(300, |u| {
        let mut boxes: Vec<[[f64; 3]; 2]> = Vec::new();
        for _ in 0..u.int_in_range(2..=3)? {
            let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
            for (low, high) in low.iter_mut().zip(&mut high) {
                let from = u.int_in_range(0..=3_u8)?;
                (*low, *high) = (from.into(), (from + u.int_in_range(1..=3_u8)?).into());
            }
            boxes.push([low, high]);
        }
        let lies_in = |a: &[[f64; 3]; 2], b: &[[f64; 3]; 2]| {
            (0..3).all(|k| b[0][k] <= a[0][k] && a[1][k] <= b[1][k])
        };
        let share_a_face = |a: &[[f64; 3]; 2], b: &[[f64; 3]; 2]| {
            let is_same = |k: usize| a[0][k] == b[0][k] && a[1][k] == b[1][k];
            (0..3).filter(|k| is_same(*k)).count() >= 2
        };
        let mut soup: Option<Soup> = None;
        for (i, [low, high]) in boxes.iter().enumerate() {
            let [middle, size] = [
                [0, 1, 2].map(|k| 0.5 * (low[k] + high[k])),
                [0, 1, 2].map(|k| high[k] - low[k]),
            ];
            let mut part = Soup::cuboid(middle, size);
            let is_alone = boxes.iter().enumerate().all(|(k, other)| {
                let own = &boxes[i];
                k == i
                    || !lies_in(own, other) && !lies_in(other, own) && !share_a_face(own, other)
            });
            if is_alone && u.arbitrary()? {
                part = part.inside_out();
            }
            soup = Some(soup.map_or(part.clone(), |all| all.and(part)));
        }
        let (shape, findings) = solid(&soup.expect("boxes"));
        for p in points(100, 3.5).map(|p| p + Vector([3.0; 3])) {
            let is_inside =
                boxes.iter().any(|b| (0..3).all(|k| b[0][k] < p[k] && p[k] < b[1][k]));
            let value = shape.distance(p);
            if (value < 0.0) != is_inside {
                return Ok(Err(format!("{value} at {p:?} of {boxes:?}: {findings}")));
            }
        }
        Ok(Ok(()))
    });
}
