// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The closest point in the intersection of a few half-spaces.
//!
//! The god-object of Zilles and Salisbury (1995), section 4, is the point closest to the device
//! point under at most three plane constraints. With inequalities instead of equations, the
//! active constraints must be found as well; they are so few that all subsets are tried.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

/// The most constraints that a proxy keeps: three make a corner, and a fourth lets the proxy leave one of
/// them.
pub const CAPACITY: usize = 4;

/// How far a point may lie outside a half-space and still count as in it, as a part of the
/// largest distance involved. Far below what a contact tolerates: corners of nearly parallel planes
/// whose rounding exceeds it count as no common point.
const FEASIBLE: f64 = 1e-10;

/// Planes whose normals span a squared volume below this count as parallel: their intersection
/// would be known to fewer than four digits.
const LEAST_DETERMINANT: f64 = 1e-12;

/// A half-space that a point is to stay in: all points `q` with `normal·(q − point) ≥ 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneConstraint<const D: usize> {
    /// A point of the boundary [m].
    pub point: Point<D>,
    /// The unit normal, pointing in.
    pub normal: Vector<f64, D>,
}

impl<const D: usize> PlaneConstraint<D> {
    /// The signed distance of `q` from the boundary [m]: positive in the half-space.
    #[must_use]
    #[inline]
    pub fn height(&self, q: Point<D>) -> f64 {
        self.normal.dot(q - self.point)
    }

    /// The point of the half-space closest to `x`.
    #[must_use]
    #[inline]
    pub fn closest(&self, x: Point<D>) -> Point<D> {
        let depth = -self.height(x);
        if depth > 0.0 { x + self.normal * depth } else { x }
    }
}

/// The point closest to `x` that lies in all of `half_spaces`; `None` if no common point can be
/// computed.
///
/// # Derivation
///
/// With `y = q − x` and the depth `bᵢ = nᵢ·(pᵢ − x)` of `x` below plane `i`, minimise `‖y‖²`
/// under `nᵢ·y ≥ bᵢ`. If the planes of a set `A` are active, `y = Σ λᵢ nᵢ` with
/// `Σⱼ (nᵢ·nⱼ) λⱼ = bᵢ` for `i` in `A`. The problem is convex, so the first set whose `λ ≥ 0`
/// and whose `y` satisfies all planes is the answer (Karush, Kuhn and Tucker). No set has more
/// than three planes in space or two in the plane.
///
/// ```
/// use palpate_field::Vector;
/// use palpate_query::constraints::{PlaneConstraint, closest_point};
///
/// let floor = PlaneConstraint { point: Vector([0.0, 0.0]), normal: Vector([0.0, 1.0]) };
/// let wall = PlaneConstraint { point: Vector([1.0, 0.0]), normal: Vector([1.0, 0.0]) };
/// assert_eq!(closest_point(Vector([3.0, -2.0]), &[floor, wall]), Some(Vector([3.0, 0.0])));
/// assert_eq!(closest_point(Vector([0.0, -2.0]), &[floor, wall]), Some(Vector([1.0, 0.0])));
/// ```
///
/// Real-time: allocates nothing, takes no lock, cannot panic; at most 14 sets for
/// [`CAPACITY`] half-spaces.
#[must_use]
pub fn closest_point<const D: usize>(
    x: Point<D>,
    half_spaces: &[PlaneConstraint<D>],
) -> Option<Point<D>> {
    let depth = |h: &PlaneConstraint<D>| -h.height(x);
    // Written so that NaN is in no half-space.
    if half_spaces.iter().all(|h| depth(h) <= 0.0) {
        return Some(x);
    }
    let highest = half_spaces.iter().map(|h| depth(h).abs()).fold(0.0, f64::max);
    let slack = FEASIBLE * highest;
    let feasible = |y: Vector<f64, D>| {
        let q = x + y;
        half_spaces.iter().all(|h| h.normal.dot(y) >= depth(h) - slack).then_some(q)
    };

    for a in half_spaces {
        if let Some(q) = one(a.normal, depth(a)).and_then(feasible) {
            return Some(q);
        }
    }
    for (i, a) in half_spaces.iter().enumerate() {
        for b in half_spaces.iter().skip(i + 1) {
            let y = two([a.normal, b.normal], [depth(a), depth(b)]);
            if let Some(q) = y.and_then(feasible) {
                return Some(q);
            }
        }
    }
    if D < 3 {
        return None;
    }
    for (i, a) in half_spaces.iter().enumerate() {
        for (k, b) in half_spaces.iter().enumerate().skip(i + 1) {
            for c in half_spaces.iter().skip(k + 1) {
                let normals = [a.normal, b.normal, c.normal];
                let y = three(normals, [depth(a), depth(b), depth(c)]);
                if let Some(q) = y.and_then(feasible) {
                    return Some(q);
                }
            }
        }
    }
    None
}

/// The pushes `λᵢ ≥ 0` of the first `count` of the unit `normals` that come closest to
/// `stretch = Σ λᵢ nᵢ`.
///
/// The rest `t = stretch − Σ λᵢ nᵢ` has `nᵢ·t ≤ 0` (Karush, Kuhn and Tucker), so the pushes are those
/// of walls through the proxy, `stretch` from the device point; all sets of walls are tried, as in
/// [`closest_point`], and three that all push are taken as they are. Zeros if no set pushes, or the
/// stretch is NaN.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
#[must_use]
pub fn pushes<const D: usize>(
    stretch: Vector<f64, D>,
    normals: [Vector<f64, D>; CAPACITY],
    count: usize,
) -> [f64; CAPACITY] {
    let known = || normals.iter().enumerate().take(count);
    let slack = FEASIBLE * stretch.norm();
    let is_rest = |rest: Vector<f64, D>| known().all(|(_, n)| n.dot(rest) <= slack);
    let mut found = [0.0; CAPACITY];
    let mut set = |pushes: &[(usize, f64)]| {
        for (i, push) in pushes {
            if let Some(place) = found.get_mut(*i) {
                *place = *push;
            }
        }
        found
    };
    for (i, a) in known() {
        let push = a.dot(stretch);
        if push > 0.0 && is_rest(stretch - *a * push) {
            return set(&[(i, push)]);
        }
    }
    for (i, a) in known() {
        for (k, b) in known().skip(i + 1) {
            let solved = two_pushes([*a, *b], [a.dot(stretch), b.dot(stretch)]);
            if let Some([x, y]) = solved.filter(|[x, y]| is_rest(stretch - *a * *x - *b * *y)) {
                return set(&[(i, x), (k, y)]);
            }
        }
    }
    for (i, a) in known() {
        for (k, b) in known().skip(i + 1) {
            for (m, c) in known().skip(k + 1) {
                let depths = [a, b, c].map(|n| n.dot(stretch));
                if let Some([x, y, z]) = three_pushes([*a, *b, *c], depths) {
                    return set(&[(i, x), (k, y), (m, z)]);
                }
            }
        }
    }
    found
}

/// The step to one plane, if it pushes.
fn one<const D: usize>(normal: Vector<f64, D>, depth: f64) -> Option<Vector<f64, D>> {
    (depth > 0.0).then(|| normal * depth)
}

/// The step to the intersection of two planes, if both push.
fn two<const D: usize>(
    [a, b]: [Vector<f64, D>; 2],
    depths: [f64; 2],
) -> Option<Vector<f64, D>> {
    two_pushes([a, b], depths).map(|[push_a, push_b]| a * push_a + b * push_b)
}

/// The pushes of two planes to their intersection, if both push.
fn two_pushes<const D: usize>(
    [a, b]: [Vector<f64, D>; 2],
    [depth_a, depth_b]: [f64; 2],
) -> Option<[f64; 2]> {
    let cosine = a.dot(b);
    let determinant = 1.0 - cosine * cosine;
    let push_a = depth_a - cosine * depth_b;
    let push_b = depth_b - cosine * depth_a;
    // Written so that NaN fails.
    if determinant > LEAST_DETERMINANT && push_a >= 0.0 && push_b >= 0.0 {
        Some([push_a / determinant, push_b / determinant])
    } else {
        None
    }
}

/// The step to the intersection of three planes, if all push.
fn three<const D: usize>(
    [a, b, c]: [Vector<f64, D>; 3],
    depths: [f64; 3],
) -> Option<Vector<f64, D>> {
    three_pushes([a, b, c], depths).map(|[x, y, z]| a * x + b * y + c * z)
}

/// The pushes of three planes to their intersection, if all push: Cramer's rule.
fn three_pushes<const D: usize>(
    [a, b, c]: [Vector<f64, D>; 3],
    [depth_a, depth_b, depth_c]: [f64; 3],
) -> Option<[f64; 3]> {
    let (ab, bc, ca) = (a.dot(b), b.dot(c), c.dot(a));
    let determinant = 1.0 + 2.0 * ab * bc * ca - ab * ab - bc * bc - ca * ca;
    let push = |own: f64, left: (f64, f64), right: (f64, f64), opposite: f64| {
        own * (1.0 - opposite * opposite)
            + left.0 * (right.1 * opposite - left.1)
            + right.0 * (left.1 * opposite - right.1)
    };
    let push_a = push(depth_a, (depth_b, ab), (depth_c, ca), bc);
    let push_b = push(depth_b, (depth_c, bc), (depth_a, ab), ca);
    let push_c = push(depth_c, (depth_a, ca), (depth_b, bc), ab);
    if determinant > LEAST_DETERMINANT && push_a >= 0.0 && push_b >= 0.0 && push_c >= 0.0 {
        Some([push_a, push_b, push_c].map(|push| push * (1.0 / determinant)))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_testkit::cases::each as cases;

    fn half_space<const D: usize>(point: [f64; D], normal: [f64; D]) -> PlaneConstraint<D> {
        PlaneConstraint { point: Vector(point), normal: Vector(normal).normalized().unwrap() }
    }

    #[test]
    fn one_plane_projects() {
        let floor = half_space([0.0, 0.25], [0.0, 1.0]);
        assert_eq!(closest_point(Vector([3.0, -1.0]), &[floor]), Some(Vector([3.0, 0.25])));
        assert_eq!(closest_point(Vector([3.0, 1.0]), &[floor]), Some(Vector([3.0, 1.0])));
    }

    #[test]
    fn three_walls_meet_in_their_corner() {
        let walls = [
            half_space([0.5, 0.0, 0.0], [1.0, 0.0, 0.0]),
            half_space([0.0, 0.25, 0.0], [0.0, 1.0, 0.0]),
            half_space([0.0, 0.0, 0.125], [0.0, 0.0, 1.0]),
        ];
        let corner = closest_point(Vector([-1.0, -2.0, -3.0]), &walls);
        assert_eq!(corner, Some(Vector([0.5, 0.25, 0.125])));
        let edge = closest_point(Vector([-1.0, -2.0, 3.0]), &walls);
        assert_eq!(edge, Some(Vector([0.5, 0.25, 3.0])));
    }

    #[test]
    fn facing_planes_have_no_point() {
        let slot = [half_space([0.0, 1.0], [0.0, 1.0]), half_space([0.0, -1.0], [0.0, -1.0])];
        assert_eq!(closest_point(Vector([0.0, 0.0]), &slot), None);
    }

    /// Dykstra's alternating projection converges to the same point, slowly.
    fn dykstra<const D: usize>(x: Point<D>, half_spaces: &[PlaneConstraint<D>]) -> Point<D> {
        let mut q = x;
        let mut corrections = vec![Vector::<f64, D>::ZERO; half_spaces.len()];
        for _ in 0..20_000 {
            for (h, correction) in half_spaces.iter().zip(&mut corrections) {
                let y = q + *correction;
                q = y + h.normal * (-h.height(y)).max(0.0);
                *correction = y - q;
            }
        }
        q
    }

    fn agrees_with_dykstra<const D: usize>() {
        cases(200, |u| {
            let mut unit = || u.int_in_range(-1000..=1000).map(|i: i32| f64::from(i) * 1e-3);
            let mut vector = || {
                let mut v = [0.0; D];
                for component in &mut v {
                    *component = unit()?;
                }
                Ok(Vector(v))
            };
            let x = vector()? * 2.0;
            let mut half_spaces = Vec::new();
            for _ in 0..CAPACITY {
                let upwards = vector()? + Vector::unit(0) * 1.5;
                let normal = upwards.normalized().ok_or(arbitrary::Error::IncorrectFormat)?;
                half_spaces.push(PlaneConstraint { point: vector()?, normal });
            }
            let slow = dykstra(x, &half_spaces);
            if half_spaces.iter().all(|h| h.height(slow) > -1e-9) {
                let q = closest_point(x, &half_spaces).unwrap();
                assert!(half_spaces.iter().all(|h| h.height(q) > -1e-8));
                assert!((q - x).norm() <= (slow - x).norm() + 1e-7, "{q:?} {slow:?}");
            }
            Ok(())
        });
    }

    #[test]
    fn no_feasible_point_is_closer_in_the_plane() {
        agrees_with_dykstra::<2>();
    }

    #[test]
    fn no_feasible_point_is_closer_in_space() {
        agrees_with_dykstra::<3>();
    }
}
