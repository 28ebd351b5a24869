// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Normals of faces, edges and corners: the nearest of them tells on which side a point is (Baerentzen and
//! Aanaes 2005).

use palpate_field::{Point, Vector};

use super::foot::{Part, across};
use super::repair::{by_rim, sides};

/// The normals of a mesh, out of the solid.
#[derive(Clone, Debug)]
pub(super) struct Normals<const N: usize, const D: usize> {
    /// Of each face: of its own, of its edges, and the numbers of its corners.
    faces: Vec<FaceNormals<N, D>>,
    /// Of each vertex: the sum of the normals of its faces, each times the angle that it has there.
    corners: Vec<Vector<f64, D>>,
}

#[derive(Clone, Copy, Debug)]
struct FaceNormals<const N: usize, const D: usize> {
    face: Vector<f64, D>,
    /// A bound of the error of the face's own; 2 if it has no area, and no direction is known.
    error: f64,
    edges: [Vector<f64, D>; N],
    corners: [u32; N],
}

impl<const N: usize, const D: usize> Normals<N, D> {
    pub(super) fn new(vertices: usize, elements: &[[u32; N]], faces: &[[Point<D>; N]]) -> Self {
        let own: Vec<_> = faces
            .iter()
            .map(|corners| across(corners).normalized().unwrap_or(Vector::ZERO))
            .collect();
        let errors = faces.iter().map(error);
        let mut normals = Self {
            faces: elements
                .iter()
                .zip(&own)
                .zip(errors)
                .map(|((element, face), error)| FaceNormals {
                    face: *face,
                    error,
                    edges: [*face; N],
                    corners: *element,
                })
                .collect(),
            corners: vec![Vector::ZERO; vertices],
        };
        for ((element, corners), normal) in elements.iter().zip(faces).zip(&own) {
            for (i, vertex) in element.iter().enumerate() {
                normals.corners[*vertex as usize] += *normal * angle(corners, i);
            }
        }
        for corner in &mut normals.corners {
            *corner = corner.normalized().unwrap_or(Vector::ZERO);
        }
        if N == 3 {
            for at_rim in by_rim(&sides(elements)) {
                let sum = at_rim
                    .iter()
                    .fold(Vector::ZERO, |sum, side| sum + own[side.element as usize]);
                let edge = sum.normalized().unwrap_or(Vector::ZERO);
                for side in at_rim {
                    normals.faces[side.element as usize].edges[side.number as usize] = edge;
                }
            }
        }
        normals
    }

    /// The normal of a face, and a bound of its error.
    #[inline]
    pub(super) fn of_face(&self, face: usize) -> (Vector<f64, D>, f64) {
        let FaceNormals { face, error, .. } = &self.faces[face];
        (*face, *error)
    }

    /// The normal at a part of a face.
    pub(super) fn at(&self, face: usize, part: Part) -> Vector<f64, D> {
        let normals = &self.faces[face];
        match part {
            Part::Face => normals.face,
            Part::Edge(i) => normals.edges[i],
            Part::Corner(i) => self.corners[normals.corners[i] as usize],
        }
    }
}

/// A bound of the error of a unit normal.
fn error<const N: usize, const D: usize>(corners: &[Point<D>; N]) -> f64 {
    let longest = corners.iter().fold(0.0_f64, |longest, corner| {
        longest.max((*corner - corners[0]).norm()).max((*corner - corners[N - 1]).norm())
    });
    // Each component of a product of two sides is rounded thrice; the product of one side is exact.
    let error = 16.0 * f64::EPSILON * longest.powi(N as i32 - 1) / across(corners).norm();
    if error < 1.0 { error } else { 2.0 }
}

/// The angle of a triangle at a corner [rad]; 1 at the end of a segment.
fn angle<const N: usize, const D: usize>(corners: &[Point<D>; N], i: usize) -> f64 {
    if N == 2 {
        return 1.0;
    }
    let [to, from] = [1, 2].map(|step| corners[(i + step) % N] - corners[i]);
    to.in_space().cross(from.in_space()).norm().atan2(to.dot(from))
}
