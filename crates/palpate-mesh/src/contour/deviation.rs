// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How far a contour is from its surface, and parts that it lost.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::ControlFlow;

use palpate_field::scalar::Model;
use palpate_field::{Aabb, BLOCK, Block, Column, Point, Shape, Vector};

use crate::mesh::TriangleMesh;

/// The bounds are close enough if the upper one is at most this times the lower one.
const CLOSE: f64 = 1.05;

/// Parts of triangles that are looked at at most, for each triangle.
const PARTS: usize = 64;

/// How often the sides of a triangle are halved at most to prove that it is within a tolerance.
const MOST_HALVINGS: u32 = 8;

/// A part of a triangle, with a bound of the field's size on it.
struct Part {
    corners: [Point<3>; 3],
    bound: f64,
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Part {}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Part {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl TriangleMesh {
    /// Bounds of the largest size of a shape's field on the triangles [m]: a value that one has, and a value that
    /// none exceeds. Of an exact field it is the largest distance of a triangle from the surface.
    ///
    /// ```
    /// use palpate_field::Shape;
    /// use palpate_mesh::{ContourOptions, TriangleMesh};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ball = Shape::sphere(0.5)?;
    /// let mesh = TriangleMesh::of_shape(&ball, &ContourOptions::with_cell(0.05))?;
    /// let [least, most] = mesh.largest_distance(&ball);
    /// assert!(least <= most && most < 0.1 * 0.05, "{most}");
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn largest_distance(&self, shape: &Shape<3>) -> [f64; 2] {
        let never = self.largest_distance_with(shape, &mut |_| ControlFlow::Continue(()));
        never.unwrap_or([0.0, f64::INFINITY])
    }

    /// The same; `stop` gets the largest size that was found so far, and can stop the work, which then has no
    /// answer: a tolerance may be missed already.
    #[must_use]
    pub fn largest_distance_with(
        &self,
        shape: &Shape<3>,
        stop: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Option<[f64; 2]> {
        let mut search = Search::new(shape);
        let mut heap = BinaryHeap::new();
        let mut parts = Vec::with_capacity(BLOCK);
        for first in (0..self.elements().len()).step_by(BLOCK) {
            let end = self.elements().len().min(first + BLOCK);
            parts.clear();
            parts.extend((first..end).map(|face| self.corners(face)));
            search.bound(&parts, &mut heap);
            if stop(search.known).is_break() {
                return None;
            }
        }
        let budget = PARTS * self.elements().len();
        while let Some(largest) = heap.peek().map(|part| part.bound) {
            if largest <= CLOSE * search.known || search.parts > budget {
                return Some([search.known, largest]);
            }
            if stop(search.known).is_break() {
                return None;
            }
            parts.clear();
            for _ in 0..BLOCK / 4 {
                let Some(Part { corners: [a, b, c], .. }) = heap.pop() else { break };
                let [ab, bc, ca] = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
                parts.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
            search.bound(&parts, &mut heap);
        }
        Some([search.known; 2])
    }
}

/// Bounds of a field on triangles.
pub(super) struct Search<'a> {
    shape: &'a Shape<3>,
    cells: Block<Model, 3, BLOCK>,
    models: Column<Model, BLOCK>,
    /// The largest size of a value that was found [m].
    known: f64,
    /// The parts that were looked at.
    parts: usize,
}

impl<'a> Search<'a> {
    pub(super) fn new(shape: &'a Shape<3>) -> Self {
        Self { shape, cells: Block::zero(), models: Column::zero(), known: 0.0, parts: 0 }
    }

    /// Adds triangles with their bounds.
    fn bound(&mut self, triangles: &[[Point<3>; 3]], heap: &mut BinaryHeap<Part>) {
        for triangles in triangles.chunks(BLOCK) {
            let mut known = self.known;
            let shape = self.shape;
            self.bounds(triangles, |i, value, bound| {
                let corners = triangles[i];
                known = known.max(shape.distance(corners[0]).abs()).max(value.abs());
                heap.push(Part { corners, bound });
            });
            self.known = known;
        }
    }

    /// Bounds of the field's size on a block of triangles: `each` gets the number of a triangle, the field at the middle of
    /// its last two corners, and the bound. The model is over the parallelogram of two sides, the bound at the corners of
    /// the triangle.
    fn bounds(&mut self, triangles: &[[Point<3>; 3]], mut each: impl FnMut(usize, f64, f64)) {
        self.cells.fill(triangles.len(), |i| {
            let [a, b, c] = triangles[i];
            let (middle, u, v) = ((b + c) * 0.5, (b - a) * 0.5, (c - a) * 0.5);
            Vector(std::array::from_fn(|k| {
                // The middle and the sides are rounded.
                let rounding = 4.0 * f64::EPSILON * (a[k].abs() + b[k].abs() + c[k].abs());
                let gradient = [u[k], v[k], 0.0];
                Model { value: middle[k], gradient, lower: rounding, upper: rounding }
            }))
        });
        self.shape.block_distances(&self.cells, triangles.len(), &mut self.models);
        self.parts += triangles.len();
        for i in 0..triangles.len() {
            let Model { value, gradient: [u, v, _], lower, upper } = self.models.get(i);
            let at = [value - u - v, value + u - v, value - u + v];
            let high = at.into_iter().fold(f64::NEG_INFINITY, f64::max) + upper;
            let low = at.into_iter().fold(f64::INFINITY, f64::min) - lower;
            each(i, value, high.max(-low) * (1.0 + 1e-12));
        }
    }

    /// Whether the field is proven to be at most `tolerance` [m] in size on each of the triangles.
    pub(super) fn are_within(
        &mut self,
        triangles: &[[Point<3>; 3]],
        tolerance: f64,
    ) -> Vec<bool> {
        let mut are_within = vec![true; triangles.len()];
        let whole = triangles.iter().enumerate();
        let mut open: Vec<_> =
            whole.map(|(of, corners)| Piece { of, halvings: 0, corners: *corners }).collect();
        let (mut block, mut corners) = (Vec::with_capacity(BLOCK), Vec::with_capacity(BLOCK));
        while !open.is_empty() {
            block.clear();
            while block.len() < BLOCK
                && let Some(piece) = open.pop()
            {
                if are_within[piece.of] {
                    block.push(piece);
                }
            }
            corners.clear();
            corners.extend(block.iter().map(|piece| piece.corners));
            self.bounds(&corners, |i, value, bound| {
                let Piece { of, halvings, corners: [a, b, c] } = block[i];
                // Written so that NaN is not within.
                let is_within = bound <= tolerance;
                if is_within {
                    return;
                }
                let may_be = value.abs() <= tolerance && halvings < MOST_HALVINGS;
                are_within[of] &= may_be;
                if may_be {
                    let [ab, bc, ca] = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
                    let quarters = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
                    open.extend(quarters.map(|corners| Piece {
                        of,
                        halvings: halvings + 1,
                        corners,
                    }));
                }
            });
        }
        are_within
    }
}

/// A part of a triangle that is not proven to be within a tolerance.
#[derive(Clone, Copy)]
struct Piece {
    /// The number of the triangle.
    of: usize,
    /// How often its sides were halved.
    halvings: u32,
    corners: [Point<3>; 3],
}

/// Steps towards the surface, and beyond it.
const STEPS: usize = 12;

/// A value that counts as the surface, as a share of the side of a cell.
const NEAR: f64 = 1e-6;

/// Looks for a point of a cell that is inside while all its corners are outside, or the reverse, by a few steps along the
/// gradient from its middle.
pub(super) fn beyond(shape: &Shape<3>, around: &Aabb<3>, is_inside: bool) -> Option<Point<3>> {
    let side = around.max[0] - around.min[0];
    let sign = if is_inside { -1.0 } else { 1.0 };
    let mut point = (around.min + around.max) * 0.5;
    // To the surface first: one step, if the field is a distance.
    for _ in 0..STEPS {
        let (value, gradient) = shape.distance_gradient(point);
        let (height, square) = (sign * value, gradient.dot(gradient));
        if height < 0.0 {
            return Some(point);
        }
        let is_slope = square > 0.0 && square.is_finite() && value.is_finite();
        if !is_slope {
            return None;
        }
        if height <= NEAR * side {
            let inwards = gradient * (-sign / square.sqrt());
            // How deep the part is, is not known.
            return (1..=STEPS as i32)
                .map(|step| point + inwards * (side * 0.5_f64.powi(step)))
                .find(|deep| around.contains(*deep) && sign * shape.distance(*deep) < 0.0);
        }
        point -= gradient * (value / square);
        if !around.contains(point) {
            return None;
        }
    }
    None
}
