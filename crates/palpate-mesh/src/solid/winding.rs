// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Winding numbers: how often the elements of a mesh go around a point.
//!
//! The share of an element is the angle under which the point sees it, over a whole turn, exactly by
//! Van Oosterom and Strackee (1983) for triangles. Seen from afar, a group of elements has the share
//!
//! ```text
//! space: (S·R/|R|³ + tr M/|R|³ − 3 R·M·R/|R|⁵)/4π,  plane: (S·R/|R|² + tr M/|R|² − 2 R·M·R/|R|⁴)/2π
//! ```
//!
//! with `R` from the point to the group's centroid, `S = ∫ n dA` and `M = ∫ (x − c) ⊗ n dA`. The rest of the
//! series is bounded in closed form: the kernel's term of degree `k` is at most `k·ρᵏ⁻¹/|R|²` in space and
//! `ρᵏ⁻¹/|R|` in the plane, with `ρ` the radius of the group over `|R|`.

use std::f64::consts::{PI, TAU};

use palpate_field::{Point, Vector};

use super::foot::across;
use crate::tree::{BallTree, FAN};

/// Error bounds of a group, tried in this order until the sign is certain; with 0 every element is summed.
const ERRORS: [f64; 4] = [1e-2, 1e-3, 1e-4, 0.0];

/// The rounding of the share of a group, and of an element in units of how much its terms cancel.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A group of elements as seen from afar.
#[derive(Clone, Copy, Debug)]
struct Moments<const D: usize> {
    centroid: Point<D>,
    /// From the centroid to the farthest corner [m].
    radius: f64,
    /// Of all elements [m²], in the plane [m].
    area: f64,
    /// `∫ n dA`.
    normals: Vector<f64, D>,
    /// `∫ (x − c) ⊗ n dA`, by rows.
    first: [Vector<f64, D>; D],
}

/// The winding number of a point, and how far it may be from the true one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Winding {
    pub(crate) number: f64,
    pub(crate) error: f64,
}

impl Winding {
    /// Whether the point is within; `None` if that is not certain.
    pub(crate) fn is_inside(self) -> Option<bool> {
        ((self.number - 0.5).abs() > self.error).then_some(self.number > 0.5)
    }
}

/// What winding numbers of a mesh are made of.
#[derive(Clone, Debug)]
pub(crate) struct WindingTree<const N: usize, const D: usize> {
    /// As [`Boxes`](super::boxes::Boxes): of eight elements each, of eight of those, and so on.
    levels: Vec<Vec<Moments<D>>>,
}

impl<const N: usize, const D: usize> WindingTree<N, D> {
    /// Of elements in the order of the tree.
    pub(crate) fn new(elements: &[[Point<D>; N]]) -> Self {
        let mut levels = Vec::new();
        let mut size = FAN;
        loop {
            let level: Vec<_> = elements.chunks(size).map(Moments::of).collect();
            let is_last = level.len() <= FAN;
            levels.push(level);
            if is_last {
                return Self { levels };
            }
            size *= FAN;
        }
    }

    /// Whether a point is within the solid of winding numbers above one half.
    pub(crate) fn is_inside(&self, elements: &[[Point<D>; N]], p: Point<D>) -> bool {
        self.settled(elements, p, |w| w.is_inside().is_some()).number > 0.5
    }

    /// The winding number of a point, as exact as it takes to settle a question, or as it can be.
    pub(crate) fn settled(
        &self,
        elements: &[[Point<D>; N]],
        p: Point<D>,
        is_settled: impl Fn(Winding) -> bool,
    ) -> Winding {
        let mut last = Winding::default();
        for error in ERRORS {
            last = self.at(elements, p, error);
            if is_settled(last) {
                break;
            }
        }
        last
    }

    /// The winding number of a point, with an error of at most `error` from each group of elements.
    pub(crate) fn at(&self, elements: &[[Point<D>; N]], p: Point<D>, error: f64) -> Winding {
        let top = self.levels.len() - 1;
        let sum = Winding::default();
        let mut walk = Walk { levels: &self.levels, elements, p, error, sum };
        for node in 0..self.levels[top].len() {
            walk.add(top, node);
        }
        walk.sum
    }
}

/// Elements with their tree.
#[derive(Debug)]
pub(crate) struct Groups<const N: usize, const D: usize> {
    elements: Vec<[Point<D>; N]>,
    tree: WindingTree<N, D>,
}

impl<const N: usize, const D: usize> Groups<N, D> {
    /// Of elements in any order.
    pub(crate) fn new(elements: &[[Point<D>; N]]) -> Self {
        let vertices: Vec<_> = elements.iter().flatten().copied().collect();
        let named: Vec<[u32; N]> =
            (0..elements.len()).map(|i| std::array::from_fn(|k| (N * i + k) as u32)).collect();
        let order = BallTree::new(&vertices, &named);
        let elements: Vec<_> = order.order().iter().map(|i| elements[*i as usize]).collect();
        let tree = WindingTree::new(&elements);
        Self { elements, tree }
    }

    /// Whether the winding number about a point is above one half or below minus one half.
    pub(crate) fn goes_around(&self, p: Point<D>) -> bool {
        let is_settled = |w: Winding| (w.number.abs() - 0.5).abs() > w.error;
        self.tree.settled(&self.elements, p, is_settled).number.abs() > 0.5
    }
}

/// A sum over the groups of a tree, as seen from a point.
struct Walk<'a, const N: usize, const D: usize> {
    levels: &'a [Vec<Moments<D>>],
    elements: &'a [[Point<D>; N]],
    p: Point<D>,
    error: f64,
    sum: Winding,
}

impl<const N: usize, const D: usize> Walk<'_, N, D> {
    /// Adds a group: as a whole, if that is exact enough, else its parts.
    fn add(&mut self, level: usize, node: usize) {
        let group = &self.levels[level][node];
        let towards = group.centroid - self.p;
        let remainder = group.remainder(towards);
        if remainder <= self.error {
            self.sum.number += group.share(towards);
            self.sum.error += remainder + ROUNDING;
            return;
        }
        let first = node * FAN;
        if level == 0 {
            let end = self.elements.len().min(first + FAN);
            for corners in &self.elements[first..end] {
                let Winding { number, error } = known_share(corners, self.p);
                self.sum.number += number;
                self.sum.error += error;
            }
            return;
        }
        for child in first..self.levels[level - 1].len().min(first + FAN) {
            self.add(level - 1, child);
        }
    }
}

impl<const D: usize> Moments<D> {
    fn of<const N: usize>(group: &[[Point<D>; N]]) -> Self {
        let halved = if N == 3 { 0.5 } else { 1.0 };
        let part = |corners: &[Point<D>; N]| {
            let mut middle = Vector::ZERO;
            for corner in corners {
                middle += *corner * (1.0 / N as f64);
            }
            let normal = across(corners) * halved;
            (middle, normal, normal.norm())
        };
        let (mut area, mut weighted, mut plain) = (0.0, Vector::ZERO, Vector::ZERO);
        for corners in group {
            let (middle, _, size) = part(corners);
            area += size;
            weighted += middle * size;
            plain += middle * (1.0 / group.len() as f64);
        }
        let centroid = if area > 0.0 { weighted * (1.0 / area) } else { plain };
        let (mut normals, mut first) = (Vector::ZERO, [Vector::ZERO; D]);
        for corners in group {
            let (middle, normal, _) = part(corners);
            normals += normal;
            for (k, row) in first.iter_mut().enumerate() {
                *row += normal * (middle - centroid)[k];
            }
        }
        let far = group.iter().flatten().map(|corner| (*corner - centroid).norm());
        let radius = far.fold(0.0, f64::max) * (1.0 + 8.0 * f64::EPSILON);
        Self { centroid, radius, area, normals, first }
    }

    /// A bound on the error of [`share`](Self::share); infinite in the group's own ball.
    fn remainder(&self, towards: Vector<f64, D>) -> f64 {
        let squared = towards.dot(towards);
        let distance = squared.sqrt();
        let rho = self.radius / distance;
        // Written so that NaN, at the centroid of a point, is not accepted.
        if rho.is_nan() || rho >= 1.0 {
            return f64::INFINITY;
        }
        let left = 1.0 - rho;
        if D == 3 {
            self.area / (4.0 * PI * squared) * rho * rho * (3.0 - 2.0 * rho) / (left * left)
        } else {
            self.area / (TAU * distance) * rho * rho / left
        }
    }

    /// The share of the group, to terms of the second degree.
    fn share(&self, towards: Vector<f64, D>) -> f64 {
        let squared = towards.dot(towards);
        let (mut trace, mut along) = (0.0, 0.0);
        for (k, row) in self.first.iter().enumerate() {
            trace += row[k];
            along += towards[k] * row.dot(towards);
        }
        let flux = self.normals.dot(towards) + trace;
        if D == 3 {
            (flux - 3.0 * along / squared) / (4.0 * PI * squared * squared.sqrt())
        } else {
            (flux - 2.0 * along / squared) / (TAU * squared)
        }
    }
}

/// The share of one element: the angle under which a point sees it, in turns. Half a turn on the element
/// itself, at most.
pub(crate) fn share<const N: usize, const D: usize>(
    corners: &[Point<D>; N],
    p: Point<D>,
) -> f64 {
    known_share(corners, p).number
}

/// The share of one element with its rounding: near an edge, sine and cosine of the angle are what is left of terms
/// as large as the product of the distances to the corners.
fn known_share<const N: usize, const D: usize>(
    corners: &[Point<D>; N],
    p: Point<D>,
) -> Winding {
    let a = corners[0] - p;
    let b = corners[1] - p;
    match (N, D) {
        (2, 2) => {
            let cross = a[0] * b[1] - a[1] * b[0];
            Winding { number: cross.atan2(a.dot(b)) / TAU, error: ROUNDING }
        }
        (3, 3) => {
            let c = corners[2] - p;
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let volume = a.in_space().dot(b.in_space().cross(c.in_space()));
            let product = la * lb * lc;
            let denominator = product + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
            let left = (volume * volume + denominator * denominator).sqrt();
            // The whole angle may be wrong on an edge itself.
            let error = if left > ROUNDING * product { ROUNDING * product / left } else { 1.0 };
            Winding { number: volume.atan2(denominator) / TAU, error }
        }
        _ => Winding::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball of radius 1 of random triangles that lie on it, of which no number is a whole one.
    fn scales() -> Vec<[Point<3>; 3]> {
        let turn = |i: u32, step: f64| (f64::from(i) * step).fract() * TAU;
        (1..=600)
            .map(|i| {
                let (a, b) = (turn(i, 0.754_877_666), 0.5 * turn(i, 0.569_840_291));
                let out = Vector([a.cos() * b.sin(), b.cos(), a.sin() * b.sin()]);
                let aside = Vector([-a.sin(), 0.0, a.cos()]);
                let along = out.cross(aside);
                [out, out + aside * 0.1, out + along * 0.1]
            })
            .collect()
    }

    #[test]
    fn the_error_of_groups_is_within_its_bound() {
        let elements = scales();
        let tree = WindingTree::new(&elements);
        for i in 1..200_u32 {
            let far = 0.02 * f64::from(i);
            let p = Vector([far, 0.3 * far, -0.7 * far]);
            let exact: f64 = elements.iter().map(|corners| share(corners, p)).sum();
            for error in ERRORS {
                let Winding { number, error: bound } = tree.at(&elements, p, error);
                assert!((number - exact).abs() <= bound, "{p:?}: {number}, {exact} ± {bound}");
            }
        }
        let outline: Vec<[Point<2>; 2]> = (0..300)
            .map(|i| [i, i + 1].map(|i| TAU * f64::from(i) / 320.0))
            .map(|ends| ends.map(|angle| Vector([angle.cos(), angle.sin()])))
            .collect();
        let tree = WindingTree::new(&outline);
        for i in 1..200_u32 {
            let p = Vector([0.02 * f64::from(i), 0.01 * f64::from(i)]);
            let exact: f64 = outline.iter().map(|corners| share(corners, p)).sum();
            let Winding { number, error: bound } = tree.at(&outline, p, 1e-2);
            assert!((number - exact).abs() <= bound, "{p:?}: {number}, {exact} ± {bound}");
        }
    }

    /// The rounding was taken for that of a face seen from afar, which is less than what is lost beside an edge.
    #[test]
    fn the_rounding_of_a_share_grows_towards_an_edge() {
        let corners = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 2.0, 0.0]].map(Vector);
        for i in 0..40 {
            let off = 0.5_f64.powi(i);
            // Beside the middle of an edge, a face is seen under the angle of a half plane: off 45°, 3/8 of a turn
            // of two, but for what is beyond its corners, which is a few times the distance.
            let Winding { number, error } = known_share(&corners, Vector([1.5, off, off]));
            assert!(
                (number.abs() - 0.375).abs() < error + 2.0 * off,
                "{off}: {number} {error}"
            );
            assert!(error < 1e3 * ROUNDING / off, "{off}: {error}");
        }
        assert_eq!(known_share(&corners, Vector([1.5, 0.0, 0.0])).error, 1.0);
    }

    #[test]
    fn an_octant_is_an_eighth_of_a_turn() {
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector);
        assert!((share(&corners, Vector::ZERO) - 0.125).abs() < 1e-15);
        let quarter = [[1.0, 0.0], [0.0, 1.0]].map(Vector);
        assert!((share(&quarter, Vector::ZERO) - 0.25).abs() < 1e-15);
    }
}
