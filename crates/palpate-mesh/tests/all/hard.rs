// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Solids of hard meshes: signs by the exact winding number, distances face by face, findings counted, and what was
//! mended needs no mending.
use std::path::Path;

use palpate_field::{CustomField, Point, Quality, Vector};
use palpate_mesh::{
    Findings, Format, Mesh, Outline, Solid, SolidError, TriangleMesh, read, read_file,
};
use palpate_testkit::hard::{self, Hard};
use palpate_testkit::models;
use palpate_testkit::soup::{Soup, points};

fn mesh(soup: &Soup) -> TriangleMesh {
    Mesh::new(soup.vertices.clone(), soup.faces.clone()).unwrap()
}

fn soup(mesh: &TriangleMesh) -> Soup {
    Soup { vertices: mesh.vertices().to_vec(), faces: mesh.elements().to_vec() }
}

/// Real meshes beside the generated ones.
fn all() -> Vec<Hard> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/meshes");
    let real = |name: &'static str| {
        let mesh = soup(&read_file(folder.join(name).with_extension("ply")).unwrap());
        Hard { name, mesh, meant: None }
    };
    let mut all = hard::solids();
    all.extend(["ant", "bunny"].map(real));
    all
}

/// Points around and in a mesh, and some close to its faces; fewer for many faces.
fn probes(mesh: &TriangleMesh) -> Vec<Point<3>> {
    let (middle, half) = (mesh.bounds().centre(), mesh.bounds().half_extents());
    let spread = |p: Point<3>| middle + Vector(std::array::from_fn(|k| 1.4 * half[k] * p[k]));
    let faces = mesh.elements().len();
    let count = if faces > 5000 { 8 } else { 80 };
    let mut probes: Vec<_> = points(count, 1.0).map(spread).collect();
    for (i, shift) in points(count, half.norm()).enumerate() {
        let [a, b, c] = mesh.corners(i * faces / count as usize);
        probes.push(a * 0.5 + b * 0.3 + c * 0.2 + shift * [1e-2, 1e-4][i % 2]);
    }
    probes
}

/// Whether a point is within faces; `None` if rounding may decide. The angle under which a face is seen at a
/// distance d that is L across is rounded by about eight units of the last place, times (L/d)².
fn is_within(soup: &Soup, p: Point<3>) -> Option<bool> {
    let reach = soup.reach() + p.norm();
    let rounding =
        soup.faces.len() as f64 * 8.0 * f64::EPSILON * (reach / soup.distance(p)).powi(2);
    let number = soup.winding(p);
    ((number - 0.5).abs() > rounding).then_some(number > 0.5)
}

#[test]
fn signs_are_those_of_the_winding_number_and_distances_those_of_the_faces() {
    for Hard { name, mesh: given, meant } in all() {
        let given = mesh(&given);
        let (solid, findings) = Solid::from_mesh(&given).unwrap();
        let mended = soup(&solid.mesh().unwrap());
        let promise = *solid.promise();
        let is_all_exact = [promise.outside, promise.inside] == [Quality::Exact; 2];
        let mut decided = 0;
        for (i, p) in probes(&given).into_iter().enumerate() {
            let f = solid.distance(p);
            let what = format!("{name}, {p:?}: {f}; {findings}");
            // That of the field, and that of the faces.
            let rounding = 2.0 * promise.rounding.within(p.norm());
            let Some(is_inside) = is_within(&mended, p) else { continue };
            decided += 1;
            assert_eq!(f < 0.0, is_inside, "{what}");
            if let Some(meant) = &meant {
                assert_eq!(is_within(meant, p), Some(is_inside), "{what}");
            }
            let surface = meant.as_ref().or(is_all_exact.then_some(&mended));
            let quality = if is_inside { promise.inside } else { promise.outside };
            if let Some(surface) = surface {
                let distance = surface.distance(p);
                assert!(f.abs() <= distance + rounding, "{what}, {distance}");
                let is_near = (f.abs() - distance).abs() <= rounding;
                assert!(is_near || quality != Quality::Exact, "{what}, {distance}");
            }
            // Within |f| the sign does not change.
            for way in points(3, 1.0).map(|way| way * (0.999 * f.abs() / way.norm())) {
                let q = p + way * [1.0, -1.0][i % 2];
                let there = is_within(&mended, q);
                assert!(there.is_none_or(|is_in| is_in == is_inside), "{what}, {q:?}");
            }
        }
        let count = probes(&given).len();
        assert!(10 * decided >= 9 * count, "{name}: {decided} of {count}");
    }
}

/// No value over a cell leaves its model, at faces that cross, touch, double each other or have no area either.
#[test]
fn models_bound_what_is_in_their_cells() {
    for Hard { name, mesh: given, .. } in all() {
        let given = mesh(&given);
        let (solid, findings) = Solid::from_mesh(&given).unwrap();
        let size = given.bounds().half_extents().norm();
        let faces = given.elements().len();
        for (i, u) in points(if faces > 5000 { 6 } else { 60 }, 1.0).enumerate() {
            let [a, b, c] = given.corners(i * 7 % faces);
            let near = a + (b - a) * (u[0].abs() * 0.5) + (c - a) * (u[1].abs() * 0.5);
            let half = [0.1, 0.02, 0.004][i % 3] * size;
            let centre = near + u * (0.6 * half);
            let model = models::bounding(&solid, centre, [half; 3], 30);
            assert!(model.is_ok(), "{name}: {model:?}; {findings}");
        }
    }
}

#[test]
fn what_was_mended_needs_no_mending() {
    for Hard { name, mesh: given, .. } in all() {
        let (solid, findings) = Solid::from_mesh(&mesh(&given)).unwrap();
        let mended = solid.mesh().unwrap();
        let (again, found) = Solid::from_mesh(&mended).unwrap();
        let twice = again.mesh().unwrap();
        assert!(mended.vertices() == twice.vertices(), "{name}: {found}");
        assert!(mended.elements() == twice.elements(), "{name}: {found}");
        let mends = [
            found.welded,
            found.degenerate,
            found.duplicates,
            found.turned,
            found.inside_out,
            found.openings.len(),
        ];
        assert_eq!(mends, [0; 6], "{name}: {found}");
        assert_eq!(
            (found.crossings, found.touching),
            (findings.crossings, findings.touching),
            "{name}: {found}"
        );
        for p in probes(&mended).into_iter().step_by(5) {
            assert_eq!(solid.distance_gradient(p), again.distance_gradient(p), "{name}");
        }
    }
}

/// What was found, but what is zero.
fn counts(findings: &Findings<3>) -> Vec<(&'static str, usize)> {
    let all = [
        ("welded", findings.welded),
        ("degenerate", findings.degenerate),
        ("duplicates", findings.duplicates),
        ("turned", findings.turned),
        ("parted", findings.parted),
        ("inside out", findings.inside_out),
        ("nested", findings.nested),
        ("inner", findings.inner),
        ("openings", findings.openings.len()),
        ("flat", findings.flat),
        ("crowded", findings.crowded_rims),
        ("crossings", findings.crossings),
        ("touching", findings.touching),
    ];
    all.into_iter().filter(|(_, count)| *count > 0).collect()
}

/// What is found of each mesh, and on which sides the distance is a bound; on the others it is exact.
const FOUND: &[(&str, &[(&str, usize)])] = &[
    ("ball", &[]),
    ("cavity", &[]),
    ("plate of 1 mm", &[]),
    ("needle of 3 degrees", &[]),
    ("fan of 10000 faces at one vertex", &[("openings", 1)]),
    ("boxes that overlap", &[("crossings", 18), ("bound inside", 1)]),
    ("ball in a ball, both outward", &[("nested", 1), ("inner", 288)]),
    ("membrane inside a cube", &[("inner", 32)]),
    ("cubes that share an edge", &[("welded", 2), ("crowded", 1)]),
    // Each of the two triangles of the wall comes twice.
    ("cubes that share a face", &[("welded", 4), ("duplicates", 4)]),
    ("halves with one wall between them", &[("welded", 4), ("inner", 2)]),
    ("boxes whose faces lie on each other", &[("touching", 14), ("bound inside", 1)]),
    // 3 corners of 960 faces, of 482 vertices.
    ("not welded", &[("welded", 2398)]),
    ("cut off", &[("openings", 1)]),
    ("10 % of the faces gone", &[("openings", 96)]),
    // Each loose face is closed by its mirror image, and the opening that is left by another.
    ("cracks", &[("inner", 24), ("openings", 24)]),
    ("copies", &[("duplicates", 138)]),
    ("10 % flipped", &[("turned", 96)]),
    ("half flipped", &[("turned", 475)]),
    ("inverted", &[("inside out", 1)]),
    ("20 % doubled, opposite", &[("duplicates", 192)]),
    ("T-junctions", &[("parted", 1)]),
    ("slivers of 1e-12", &[]),
    ("sheets that coincide", &[("welded", 4), ("inner", 50)]),
    ("1e15 m", &[]),
    ("1e-9 m", &[("inside out", 1)]),
    ("ant", &[("crossings", 99), ("touching", 23), ("bound inside", 1)]),
    ("bunny", &[]),
];

#[test]
fn findings_are_counted() {
    let all = all();
    assert_eq!(all.len(), FOUND.len());
    for (Hard { name, mesh: given, .. }, (found_name, found)) in all.into_iter().zip(FOUND) {
        assert_eq!(name, *found_name);
        let (solid, findings) = Solid::from_mesh(&mesh(&given)).unwrap();
        let mut counted = counts(&findings);
        let promise = solid.promise();
        for (side, quality) in
            [("bound outside", promise.outside), ("bound inside", promise.inside)]
        {
            counted.extend((quality != Quality::Exact).then_some((side, 1)));
        }
        assert_eq!(counted, *found, "{name}: {findings}");
        assert_eq!(findings.is_clean(), counted.iter().all(|(what, _)| *what == "welded"));
    }
}

#[test]
fn what_bounds_no_solid_is_refused() {
    for (name, soup) in hard::refused() {
        let error = Solid::from_mesh(&mesh(&soup)).unwrap_err();
        if let SolidError::Cracked { cracks } = error {
            assert_eq!(name, "cracks all over");
            // Each corner is up to 1e-4 off along each axis.
            assert!(cracks.width > 1e-4 && cracks.width < 4e-4, "{cracks:?}");
            continue;
        }
        let expected = match name {
            "Klein bottle" => SolidError::OneSided { pieces: 1 },
            _ => SolidError::Sheet,
        };
        assert_eq!(error, expected, "{name}");
    }
}

/// An STL of faces that are clockwise seen from outside, with normals that point inwards.
#[test]
fn an_stl_written_inside_out_is_turned() {
    let body = Soup::ball([0.1, -0.2, 0.3], 1.0, 8).inside_out();
    let mut bytes = vec![b' '; 80];
    bytes.extend((body.faces.len() as u32).to_le_bytes());
    for [a, b, c] in body.corners() {
        let normal = (b - a).cross(c - a);
        for x in [normal * (1.0 / normal.norm()), a, b, c].iter().flat_map(|p| p.0) {
            bytes.extend((x as f32).to_le_bytes());
        }
        bytes.extend([0; 2]);
    }
    let (solid, findings) = Solid::from_mesh(&read(&bytes, Format::Stl).unwrap()).unwrap();
    assert_eq!(counts(&findings), [("inside out", 1)]);
    assert!(solid.distance(Vector([0.1, -0.2, 0.3])) < -0.9);
}

/// Once each took time by the square of its size: tens of seconds.
#[test]
fn long_rims_and_rows_of_thousands_are_counted() {
    let (_, findings) = Solid::from_mesh(&mesh(&Soup::tube(10_000))).unwrap();
    assert_eq!(counts(&findings), [("openings", 2)]);
    assert!(findings.openings.iter().all(|opening| opening.edges == 10_000));
    let (_, findings) = Solid::from_mesh(&mesh(&Soup::fan(10_000))).unwrap();
    assert_eq!(counts(&findings), [("openings", 1)]);
    // Each box crosses the next in 16 pairs of triangles.
    let (_, findings) = Solid::from_mesh(&mesh(&Soup::row(5000))).unwrap();
    assert_eq!(findings.crossings, 16 * 4999, "{findings}");
}

/// Thousands of chains of the plane, each of which lacks its last side.
#[test]
fn thousands_of_open_outlines_are_closed() {
    let count = 3000_u32;
    let (mut corners, mut sides) = (Vec::new(), Vec::new());
    for i in 0..count {
        let at = Vector([2.0 * f64::from(i % 60), 2.0 * f64::from(i / 60)]);
        corners
            .extend([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|p| at + Vector(p)));
        sides.extend((0..3).map(|k| [4 * i + k, 4 * i + k + 1]));
    }
    let (solid, findings) = Solid::from_mesh(&Outline::new(corners, sides).unwrap()).unwrap();
    assert_eq!(findings.openings.len(), 3000);
    assert_eq!(solid.distance(Vector([20.5, 30.25])), -0.25);
}
