// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Points spread over surfaces: samples of meshes and fields, ordered so that every prefix
//! covers the whole surface.

use palpate_field::{Aabb, Point, Shape, Vector};
use palpate_mesh::Mesh;

/// Samples per chosen point.
const CHOICE: f64 = 4.0;

/// The most parts of an element's edge.
const MOST_PARTS: f64 = 512.0;

/// A sample counts as farther only by this factor, so that rounding does not decide the order
/// and tools of all sizes have the same points.
const MORE: f64 = 1.0 + 1e-9;

/// The largest distance of a point of a triangle from its nearest corner, in longest edges:
/// 1/√3, in an equilateral triangle.
const FROM_CORNERS: f64 = 0.577_350_27;

/// Samples of a surface.
#[derive(Debug)]
pub(super) struct Samples {
    /// The samples [m].
    pub(super) points: Vec<Point<3>>,
    /// Every point of the surface is within this distance of a sample [m].
    pub(super) spacing: f64,
}

/// Samples of all elements of a mesh, corners included, enough to choose `count` points.
pub(super) fn of_mesh<const N: usize, const D: usize>(
    mesh: &Mesh<N, D>,
    count: usize,
) -> Samples {
    let corners = (0..mesh.elements().len())
        .map(|element| mesh.corners(element).map(|corner| corner.in_space()));
    let extent: f64 = corners.clone().map(|corners| extent(&corners)).sum();
    let wanted = CHOICE * count as f64;
    let edge = if N == 2 { extent / wanted } else { (extent / wanted).sqrt() };
    let (mut points, mut longest) = (Vec::new(), 0.0_f64);
    for corners in corners {
        let [first, others @ ..] = corners.as_slice() else { continue };
        let length = longest_edge(&corners);
        // Written so that a degenerate element still gives its corners.
        let parts = (length / edge).ceil().clamp(1.0, MOST_PARTS);
        longest = longest.max(length / parts);
        let steps = parts as u32;
        match *others {
            [second] => {
                for i in 0..=steps {
                    points.push(*first + (second - *first) * (f64::from(i) / parts));
                }
            }
            [second, third] => {
                for i in 0..=steps {
                    for k in 0..=steps - i {
                        let (along, up) = (f64::from(i) / parts, f64::from(k) / parts);
                        points.push(*first + (second - *first) * along + (third - *first) * up);
                    }
                }
            }
            _ => points.extend(corners),
        }
    }
    let spacing = longest * if N == 2 { 0.5 } else { FROM_CORNERS };
    Samples { points, spacing }
}

/// The length of a segment or the area of a triangle.
fn extent<const N: usize>(corners: &[Point<3>; N]) -> f64 {
    match *corners.as_slice() {
        [a, b] => (b - a).norm(),
        [a, b, c] => {
            let (u, v) = (b - a, c - a);
            let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
            0.5 * (uu * vv - uv * uv).max(0.0).sqrt()
        }
        _ => 0.0,
    }
}

fn longest_edge<const N: usize>(corners: &[Point<3>; N]) -> f64 {
    let ends = corners.iter().flat_map(|a| corners.iter().map(move |b| (*a - *b).norm()));
    ends.fold(0.0, f64::max)
}

/// Samples of the surface of a field in a box: a lattice, projected.
///
/// The spacing holds for exact fields: the nearest lattice point is within half a cell's
/// diagonal, and its projection is no farther from it.
pub(super) fn of_field<const D: usize>(
    shape: &Shape<D>,
    bounds: &Aabb<D>,
    count: usize,
) -> Samples {
    let half = bounds.half_extents();
    let faces: f64 = (0..D)
        .map(|axis| {
            let others = half.0.iter().enumerate().filter(|(k, _)| *k != axis);
            2.0 * others.map(|(_, half)| 2.0 * half).product::<f64>()
        })
        .sum();
    let cell = libm::pow(faces / (CHOICE * count as f64), 1.0 / (D as f64 - 1.0));
    // The box of a curve may have no faces.
    let longest = half.0.iter().fold(0.0_f64, |longest, half| longest.max(2.0 * half));
    let cell = cell.max(longest / (CHOICE * count as f64));
    let cells: [usize; D] = half.0.map(|half| (2.0 * half / cell).ceil().max(1.0) as usize);
    let diagonal = cell * (D as f64).sqrt();
    let near = 0.5 * diagonal * shape.promise().lipschitz;
    let nodes: usize = cells.iter().map(|cells| cells + 1).product();
    let mut points = Vec::new();
    for node in 0..nodes {
        let (mut place, mut rest) = (bounds.min, node);
        for ((x, cells), half) in place.0.iter_mut().zip(cells).zip(half.0) {
            *x += 2.0 * half * (rest % (cells + 1)) as f64 / cells as f64;
            rest /= cells + 1;
        }
        if shape.distance(place).abs() > near {
            continue;
        }
        let on_surface = shape.surface_point(place);
        let on_surface = on_surface.filter(|q| (*q - place).norm() <= diagonal);
        points.extend(on_surface.map(Vector::in_space));
    }
    Samples { points, spacing: diagonal }
}

/// Points in farthest-first order: the first is the farthest from the middle, each other the
/// farthest from all before. With each point, the largest distance of a sample from the points
/// before it and from the points up to it [m]. At most `count` points, without repetition.
///
/// Gonzalez, "Clustering to minimize the maximum intercluster distance" (1985): the first `k`
/// points cover the samples within twice the smallest radius that any `k` points achieve.
pub(super) fn farthest_first(samples: &[Point<3>], count: usize) -> Vec<(Point<3>, f64)> {
    let middle = Aabb::around(samples.iter().copied()).map_or(Vector::ZERO, |all| all.centre());
    let mut away: Vec<f64> = samples.iter().map(|p| (*p - middle).norm()).collect();
    let mut chosen: Vec<(Point<3>, f64)> = Vec::with_capacity(count);
    for round in 0..=count {
        let mut farthest = (0.0, None);
        for (p, away) in samples.iter().zip(&away) {
            if *away > farthest.0 * MORE || farthest.1.is_none() {
                farthest = (*away, Some(*p));
            }
        }
        if round > 0
            && let Some(last) = chosen.last_mut()
        {
            last.1 = farthest.0 * MORE;
        }
        let Some(point) = farthest.1.filter(|_| round == 0 || farthest.0 > 0.0) else { break };
        if round == count {
            break;
        }
        chosen.push((point, 0.0));
        for (p, away) in samples.iter().zip(&mut away) {
            let here = (*p - point).norm();
            *away = if round == 0 { here } else { away.min(here) };
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_farthest_come_first() {
        let samples: Vec<_> = (0..=8).map(|i| Vector([f64::from(i), 0.0, 0.0])).collect();
        let order = farthest_first(&samples, 5);
        let expected = [(0.0, 8.0), (8.0, 4.0), (4.0, 2.0), (2.0, 2.0), (6.0, 1.0)];
        assert_eq!(order, expected.map(|(x, away)| (Vector([x, 0.0, 0.0]), away * MORE)));
        assert_eq!(farthest_first(&samples, 100).len(), 9);
    }

    #[test]
    fn a_field_is_sampled_on_its_surface() {
        let ball = Shape::<3>::from_kernel(palpate_field::kernel::Ball::new(0.5).unwrap());
        let bounds = ball.promise().bounds.unwrap().aabb;
        let samples = of_field(&ball, &bounds, 200);
        assert!(samples.points.len() > 200, "{}", samples.points.len());
        assert!(samples.points.iter().all(|p| (p.norm() - 0.5).abs() < 1e-15));
        for i in 0..1000 {
            let (z, turn) = (f64::from(i) / 500.0 - 0.999, f64::from(i) * 2.4);
            let flat = (1.0 - z * z).sqrt();
            let q = Vector([flat * turn.cos(), flat * turn.sin(), z]) * 0.5;
            let away = samples.points.iter().map(|p| (*p - q).norm()).fold(9.0, f64::min);
            assert!(away <= samples.spacing);
        }
    }
}
