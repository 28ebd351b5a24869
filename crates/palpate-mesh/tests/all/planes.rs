// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Models of meshes with flat sides, edges and corners.

use palpate_field::scalar::{AffineModel, Model};
use palpate_field::{CustomField, Point, Pose, Rotation, Vector};
use palpate_mesh::{Mesh, MeshSheet, Solid, SolidError};
use palpate_testkit::arbitrary as draw;
use palpate_testkit::kernels::Space;
use palpate_testkit::models::bounding_image;
use palpate_testkit::soup::Soup;
use palpate_testkit::{arbitrary::Turn, cases};

type Mesh3 = Mesh<3, 3>;

/// Bodies with flat sides, and whether they are convex.
fn bodies() -> Vec<(Soup, bool)> {
    let step = Soup::cuboid([0.0; 3], [1.0, 0.4, 1.0]);
    vec![
        (Soup::cuboid([0.0; 3], [1.0, 0.7, 1.2]), true),
        (Soup::fine_cuboid([1.0; 3], 4), true),
        (Soup::fine_cuboid([2.0, 0.01, 2.0], 3), true),
        (Soup::prism(4, 0.8, 1.0), true),
        (Soup::prism(24, 0.6, 1.0), true),
        (Soup::pierced_prism(4, [1.0, 0.6], 0.8), false),
        (Soup::pierced_prism(16, [1.0, 0.7], 0.8), false),
        // Two that overlap: signs by winding numbers, and faces within the solid.
        (step.clone().and(Soup::cuboid([0.2, 0.3, 0.0], [0.4, 0.5, 0.4])), false),
        // Two apart by a slit, and a cavity.
        (step.clone().and(Soup::cuboid([0.0, 0.45, 0.0], [1.0, 0.4, 1.0])), false),
        (step.and(Soup::cuboid([0.0; 3], [0.5, 0.2, 0.5]).inside_out()), false),
        (Soup::ball([0.0; 3], 0.7, 6), true),
    ]
}

fn mesh(soup: &Soup) -> Result<Mesh3, arbitrary::Error> {
    Mesh::new(soup.vertices.clone(), soup.faces.clone())
        .map_err(|_| arbitrary::Error::IncorrectFormat)
}

/// A place on or near a face, often on an edge or at a corner of it.
fn near_face(u: &mut arbitrary::Unstructured<'_>, mesh: &Mesh3) -> arbitrary::Result<Point<3>> {
    let face = u.choose_index(mesh.elements().len())?;
    let corners = mesh.corners(face);
    let mut place = corners[u.choose_index(3)?];
    for corner in corners {
        let share = if u.ratio(1, 2)? { draw::unit(u)? } else { 0.0 };
        place += (corner - place) * share;
    }
    Ok(place)
}

/// A box that is turned and moves along as time goes by, and parameters in it: its coordinates in `M` parameters, the
/// first three along its sides.
fn image<const M: usize>(
    u: &mut arbitrary::Unstructured<'_>,
    centre: Point<3>,
    half: f64,
) -> arbitrary::Result<([AffineModel<M>; 3], Vec<[f64; M]>)> {
    let is_turned = u.ratio(1, 2)?;
    let turn: Rotation<3> = if is_turned { Space::rotation(u)? } else { Rotation::identity() };
    let mut sides = [Vector::<f64, 3>::ZERO; M];
    for (k, side) in sides.iter_mut().enumerate() {
        let length = half * if u.ratio(1, 3)? { 1.0 } else { draw::unit(u)? };
        let along =
            if k < 3 { turn.rotate(Vector::<f64, 3>::unit(k)) } else { draw::direction(u)? };
        *side = along * length;
    }
    let remainder = if u.ratio(1, 2)? { 0.05 * half * draw::unit(u)? } else { 0.0 };
    let cell = std::array::from_fn(|i| AffineModel {
        value: centre[i],
        gradient: sides.map(|side| side[i]),
        lower: remainder,
        upper: remainder,
    });
    let mut parameters = Vec::new();
    for _ in 0..48 {
        let mut sample = [0.0; M];
        for x in &mut sample {
            let end = *u.choose(&[-1.0, 1.0])?;
            *x = if u.ratio(1, 2)? { end } else { draw::within(u, -1.0, 1.0)? };
        }
        parameters.push(sample);
    }
    Ok((cell, parameters))
}

fn models_enclose<const M: usize>(count: u64) {
    let bodies = bodies();
    cases::check(count, |u| {
        let (soup, is_convex) = u.choose(&bodies)?;
        let pose = if u.ratio(1, 2)? { draw::pose::<3>(u)? } else { Pose::identity() };
        let turned = soup.clone().turned(&pose.rotation);
        let vertices = turned.vertices.iter().map(|p| *p + pose.translation).collect();
        let mesh = mesh(&Soup { vertices, faces: turned.faces })?;
        let Ok((solid, _)) = Solid::from_mesh(&mesh) else {
            return Ok(Err(format!("{soup:?} is a solid")));
        };
        let half = 10.0_f64.powf(draw::within(u, -4.0, 0.3)?);
        let off = draw::direction::<3>(u)? * (half * draw::within(u, 0.0, 4.0)?);
        let centre = near_face(u, &mesh)? + off;
        let (cell, parameters) = image::<M>(u, centre, half)?;
        let model = match bounding_image(&solid, &cell, &parameters) {
            Ok(model) => model,
            Err(complaint) => return Ok(Err(complaint)),
        };
        // Of a convex body no model says less than the tangent plane, but for what the coordinates' remainders add.
        let (f, slope) = CustomField::distance_gradient(&solid, centre);
        let own: f64 = cell.iter().map(|x| x.lower + x.upper).sum();
        let reach = centre.norm() + 4.0 * half + 2.0;
        // The way to an edge is known to the rounding over the distance, and as much turns the plane.
        let turned = reach / f.abs().max(1e-300);
        let rounding = solid.promise().rounding.within(reach) * (8.0 + turned);
        let along = |k: usize| (0..3).map(|i| slope[i] * cell[i].gradient[k]).sum::<f64>();
        let plane = f - (0..M).map(|k| along(k).abs()).sum::<f64>();
        if *is_convex && turned < 1e6 && model.minimum() < plane - rounding - 2.0 * own {
            return Ok(Err(format!("{model:?} over {cell:?}: {plane}, {rounding} and {own}")));
        }
        let sheet: Result<MeshSheet<3, 3>, SolidError> = MeshSheet::from_mesh(&mesh, 0.05);
        let Ok(sheet) = sheet else { return Ok(Err("a sheet".into())) };
        Ok(bounding_image(&sheet, &cell, &parameters).map(|_| ()))
    });
}

/// No value leaves the model of its cell, turned or not, in space or in space and time. Of a convex body the tangent
/// plane is the lower bound.
#[test]
fn models_of_flat_sides_bound_what_is_in_their_cells() {
    models_enclose::<3>(5000);
}

#[test]
fn models_of_flat_sides_bound_what_is_in_their_cells_over_time() {
    models_enclose::<4>(5000);
}

/// Beside a flat side of any body the model is the half-space's, however many triangles the side has.
#[test]
fn a_flat_side_is_as_a_half_space() {
    let bodies = [
        Soup::fine_cuboid([2.0; 3], 8),
        Soup::cuboid([0.0; 3], [2.0; 3]),
        Soup::pierced_prism(4, [5.0, 2.0_f64.sqrt()], 2.0).turned(
            &Rotation::from_axis_angle([0.0, 1.0, 0.0], 0.25 * std::f64::consts::PI).unwrap(),
        ),
    ];
    let [_, _, hole] = &bodies;
    // Of the cubes, at y = 1; of the hole, its wall, and the body's upper side at y = 2.
    let places = [
        (&bodies[0], Vector([0.1, 1.0, 0.2]), Vector::unit(1)),
        (&bodies[1], Vector([0.1, 1.0, 0.1]), Vector::unit(1)),
        (hole, Vector([1.0, 1.1, 0.1]), -Vector::unit(0)),
        (hole, Vector([2.0, 2.0, 0.1]), Vector::unit(1)),
    ];
    for (soup, place, normal) in places {
        let (solid, _) = Solid::from_mesh(&mesh(soup).unwrap()).unwrap();
        for height in [-0.05, -1e-3, 0.0, 1e-3, 0.05] {
            for half in [0.2, 0.02, 2e-4] {
                let cell = Model::cell((place + normal * height).0, [half, 0.7 * half, half]);
                let model = CustomField::model(&solid, &cell);
                assert!((model.value - height).abs() < 1e-14, "{model:?}");
                let slope =
                    [0, 1, 2].map(|k| model.gradient[k] - normal[k] * cell[k].gradient[k]);
                assert!(Vector(slope).norm() < 1e-14, "{model:?}");
                assert!(model.lower < 1e-12, "{place:?} {height} {half}: {model:?}");
            }
        }
    }
}
