// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The faces of a solid by eights, so that one instruction treats several of them.

use std::array::from_fn;
use std::ops::Range;

use palpate_field::{Point, Vector};

use super::foot::FLAT;
use crate::tree::FAN;

/// One number of each of eight faces.
type Lanes = [f64; FAN];

/// The faces of a solid, in the order of its boxes.
#[derive(Clone, Debug)]
pub(super) struct Faces<const N: usize, const D: usize> {
    /// Of each eight faces, of each corner, along each axis [m]. What completes the last eight is no number.
    groups: Vec<[[Lanes; D]; N]>,
    count: usize,
}

impl<const N: usize, const D: usize> Faces<N, D> {
    pub(super) fn new(faces: &[[Point<D>; N]]) -> Self {
        let groups = faces.chunks(FAN).map(|group| {
            let mut lanes = [[[f64::NAN; FAN]; D]; N];
            for (lane, face) in group.iter().enumerate() {
                for (corner, point) in face.iter().enumerate() {
                    for (axis, x) in point.0.into_iter().enumerate() {
                        lanes[corner][axis][lane] = x;
                    }
                }
            }
            lanes
        });
        Self { groups: groups.collect(), count: faces.len() }
    }

    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// The corners of a face.
    #[inline]
    pub(super) fn corners(&self, face: usize) -> [Point<D>; N] {
        let group = &self.groups[face / FAN];
        from_fn(|corner| Vector(from_fn(|axis| group[corner][axis][face % FAN])))
    }

    /// The numbers of the faces of a group.
    pub(super) fn of_group(&self, group: usize) -> Range<usize> {
        group * FAN..self.count.min(group * FAN + FAN)
    }

    /// The squares of the distances from a point to the faces of a group [m²], those of
    /// [`foot`](super::foot::foot) to the bit; infinite where there is no face.
    #[inline]
    pub(super) fn squared_distances(&self, group: usize, p: Point<D>) -> Lanes {
        const { assert!(N == 2 || N == 3, "segments and triangles") };
        let corners = &self.groups[group];
        let from: [[Lanes; D]; N] =
            from_fn(|i| from_fn(|k| lanes(|l| p[k] - corners[i][k][l])));
        let to_next: [[Lanes; D]; N] = from_fn(|i| {
            let next = (i + 1) % N;
            from_fn(|k| lanes(|l| corners[next][k][l] - corners[i][k][l]))
        });
        let mut squared = [f64::INFINITY; FAN];
        for i in 0..if N == 2 { 1 } else { N } {
            let next = (i + 1) % N;
            let (along, length) = (dot(&from[i], &to_next[i]), dot(&to_next[i], &to_next[i]));
            let share = lanes(|l| along[l] / length[l]);
            let (at_start, at_end) = (dot(&from[i], &from[i]), dot(&from[next], &from[next]));
            let between: [Lanes; D] =
                from_fn(|k| lanes(|l| p[k] - (corners[i][k][l] + to_next[i][k][l] * share[l])));
            let between = dot(&between, &between);
            let edge = lanes(|l| {
                let inner = if along[l] >= length[l] { at_end[l] } else { between[l] };
                if along[l] <= 0.0 { at_start[l] } else { inner }
            });
            squared = lanes(|l| if edge[l] < squared[l] { edge[l] } else { squared[l] });
        }
        if N == 2 {
            return squared;
        }
        let ab = &to_next[0];
        let ac: [Lanes; D] = from_fn(|k| lanes(|l| corners[N - 1][k][l] - corners[0][k][l]));
        let (bb, bc, cc) = (dot(ab, ab), dot(ab, &ac), dot(&ac, &ac));
        let (pb, pc) = (dot(&from[0], ab), dot(&from[0], &ac));
        let area = lanes(|l| bb[l] * cc[l] - bc[l] * bc[l]);
        let v = lanes(|l| cc[l] * pb[l] - bc[l] * pc[l]);
        let w = lanes(|l| bb[l] * pc[l] - bc[l] * pb[l]);
        let shares = [lanes(|l| v[l] / area[l]), lanes(|l| w[l] / area[l])];
        let away: [Lanes; D] = from_fn(|k| {
            lanes(|l| {
                let point =
                    corners[0][k][l] + ab[k][l] * shares[0][l] + ac[k][l] * shares[1][l];
                p[k] - point
            })
        });
        let face = dot(&away, &away);
        lanes(|l| {
            let is_known = area[l] > FLAT * bb[l] * cc[l];
            let is_within = is_known & (v[l] >= 0.0) & (w[l] >= 0.0) & (v[l] + w[l] <= area[l]);
            if is_within { face[l] } else { squared[l] }
        })
    }
}

/// What a function says of each lane.
#[inline(always)]
fn lanes(of: impl Fn(usize) -> f64) -> Lanes {
    from_fn(of)
}

/// The scalar products of two vectors in each lane.
#[inline(always)]
fn dot<const D: usize>(a: &[Lanes; D], b: &[Lanes; D]) -> Lanes {
    let mut sum = lanes(|l| a[0][l] * b[0][l]);
    for k in 1..D {
        sum = lanes(|l| sum[l] + a[k][l] * b[k][l]);
    }
    sum
}

#[cfg(test)]
mod tests {
    use palpate_testkit::cases;

    use super::super::foot::foot;
    use super::*;

    fn lanes_are_feet<const N: usize, const D: usize>() {
        cases::check(2000, |u| {
            let scale = *u.choose(&[1e-9, 1.0, 1e12])?;
            let mut point = || -> arbitrary::Result<Point<D>> {
                let mut p = Vector::ZERO;
                for i in 0..D {
                    // Few numbers, so that corners coincide and triangles are flat.
                    p[i] = scale * f64::from(u.int_in_range(-4..=4)?) / 4.0;
                }
                Ok(p)
            };
            let p = point()?;
            let mut faces = Vec::new();
            for _ in 0..11 {
                let mut face = [Vector::ZERO; N];
                for corner in &mut face {
                    *corner = point()?;
                }
                faces.push(face);
            }
            let lanes = Faces::new(&faces);
            for group in 0..2 {
                let squared = lanes.squared_distances(group, p);
                assert!(squared[lanes.of_group(group).len()..].iter().all(|s| s.is_infinite()));
                for (face, squared) in lanes.of_group(group).zip(squared) {
                    assert_eq!(lanes.corners(face), faces[face]);
                    assert_eq!(squared, foot(&faces[face], p).squared, "{:?}", faces[face]);
                }
            }
            Ok(Ok(()))
        });
    }

    #[test]
    fn the_lanes_of_a_group_have_the_distances_of_feet() {
        lanes_are_feet::<2, 2>();
        lanes_are_feet::<3, 3>();
    }
}
