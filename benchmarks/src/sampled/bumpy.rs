// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A sphere with bumps, of 20 480 triangles.

use std::collections::HashMap;
use std::error::Error;

use palpate::field::{Point, Vector};
use palpate::mesh::TriangleMesh;

/// How often the triangles of an icosahedron are parted in four.
const PARTED: u32 = 5;

/// The radius without bumps, and their height as a share of it.
const RADIUS: f64 = 0.5;
const HEIGHT: f64 = 0.06;

pub(super) fn mesh() -> Result<TriangleMesh, Box<dyn Error>> {
    let (mut directions, mut faces) = icosahedron();
    for _ in 0..PARTED {
        faces = parted(&mut directions, &faces);
    }
    Ok(TriangleMesh::new(directions.into_iter().map(on_surface).collect(), faces)?)
}

/// The mesh with an icosahedron that crosses it: signs take winding numbers.
pub(super) fn with_a_crossing_piece(
    mesh: &TriangleMesh,
) -> Result<TriangleMesh, Box<dyn Error>> {
    let (mut vertices, mut faces) = (mesh.vertices().to_vec(), mesh.elements().to_vec());
    let (corners, small) = icosahedron();
    let first = vertices.len() as u32;
    vertices.extend(corners.into_iter().map(|p| p * 0.05 + Vector::unit(0) * RADIUS));
    faces.extend(small.into_iter().map(|face| face.map(|corner| first + corner)));
    Ok(TriangleMesh::new(vertices, faces)?)
}

fn on_surface(direction: Point<3>) -> Point<3> {
    let bump = direction.0.map(|x| (9.0 * x).sin()).iter().product::<f64>();
    direction * (RADIUS * (1.0 + HEIGHT * bump))
}

fn icosahedron() -> (Vec<Point<3>>, Vec<[u32; 3]>) {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::with_capacity(12);
    for axis in 0..3 {
        for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
            let mut corner = Vector::ZERO;
            corner[axis] = signs[0];
            corner[(axis + 1) % 3] = signs[1] * golden;
            corners.push(corner * (1.0 / golden.hypot(1.0)));
        }
    }
    // Corners of a face are an edge apart.
    let edge = 2.0 / golden.hypot(1.0);
    let is_edge = |a: usize, b: usize| (corners[a] - corners[b]).norm() < 1.01 * edge;
    let mut faces = Vec::with_capacity(20);
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if !(is_edge(a, b) && is_edge(b, c) && is_edge(c, a)) {
                    continue;
                }
                let across = (corners[b] - corners[a]).cross(corners[c] - corners[a]);
                let is_outward = across.dot(corners[a]) > 0.0;
                let face = if is_outward { [a, b, c] } else { [a, c, b] };
                faces.push(face.map(|corner| corner as u32));
            }
        }
    }
    (corners, faces)
}

/// Each triangle in four, with new corners on the sphere.
fn parted(corners: &mut Vec<Point<3>>, faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            let sum = corners[a as usize] + corners[b as usize];
            corners.push(sum * (1.0 / sum.norm()));
            corners.len() as u32 - 1
        })
    };
    let mut parts = Vec::with_capacity(4 * faces.len());
    for &[a, b, c] in faces {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        parts.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_closed_and_faces_outwards() {
        let report = mesh().unwrap().report();
        assert!(report.is_watertight() && report.elements == 20_480);
        let ball = 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3);
        assert!((report.enclosed.unwrap() / ball - 1.0).abs() < 0.05);
    }
}
