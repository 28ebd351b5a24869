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
use crate::tree::FAN;

/// Error bounds of a group, tried in this order until the sign is certain; with 0 every element is summed.
const ERRORS: [f64; 4] = [1e-2, 1e-3, 1e-4, 0.0];

/// The rounding of the share of an element.
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
        let mut last = Winding::default();
        for error in ERRORS {
            last = self.at(elements, p, error);
            if let Some(is_inside) = last.is_inside() {
                return is_inside;
            }
        }
        last.number > 0.5
    }

    /// The winding number of a point, with an error of at most `error` from each group of elements.
    pub(crate) fn at(&self, elements: &[[Point<D>; N]], p: Point<D>, error: f64) -> Winding {
        let top = self.levels.len() - 1;
        let mut sum = Winding::default();
        for node in 0..self.levels[top].len() {
            self.add(elements, p, error, [top, node], &mut sum);
        }
        sum
    }

    fn add(
        &self,
        elements: &[[Point<D>; N]],
        p: Point<D>,
        error: f64,
        [level, node]: [usize; 2],
        sum: &mut Winding,
    ) {
        let group = &self.levels[level][node];
        let towards = group.centroid - p;
        let remainder = group.remainder(towards);
        if remainder <= error {
            sum.number += group.share(towards);
            sum.error += remainder + ROUNDING;
            return;
        }
        let first = node * FAN;
        if level == 0 {
            for corners in &elements[first..elements.len().min(first + FAN)] {
                sum.number += share(corners, p);
                sum.error += ROUNDING;
            }
            return;
        }
        for child in first..self.levels[level - 1].len().min(first + FAN) {
            self.add(elements, p, error, [level - 1, child], sum);
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
    let a = corners[0] - p;
    let b = corners[1] - p;
    match (N, D) {
        (2, 2) => {
            let cross = a[0] * b[1] - a[1] * b[0];
            cross.atan2(a.dot(b)) / TAU
        }
        (3, 3) => {
            let c = corners[2] - p;
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let volume = a.in_space().dot(b.in_space().cross(c.in_space()));
            let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
            volume.atan2(denominator) / TAU
        }
        _ => 0.0,
    }
}
