// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Two bodies in one frame, evaluated a block at a time.

use palpate_field::scalar::Model;
use palpate_field::{Aabb, BLOCK, Block, Column, Gradients, Point, Pose, Vector};

use super::cell::BoxCell;
use super::distance_bound::DistanceBound;
use crate::error::QueryError;
use crate::larger::larger;
use crate::placed::{Placed, check_pose};

/// Roundings of a pose from one body to another, relative to where they are in the world.
const PLACE_ROUNDINGS: f64 = 8.0;

/// Pairs of points of two bodies, each nearest to the last one of the other, from one place.
const APPROACHES: u32 = 16;

/// Memory of questions to two bodies.
#[derive(Debug)]
pub(crate) struct Memory<const D: usize> {
    locals: [[Point<D>; BLOCK]; 2],
    points: Block<f64, D, BLOCK>,
    boxes: Block<Model, D, BLOCK>,
    values: Column<f64, BLOCK>,
    slopes: Gradients<f64, D, BLOCK>,
    models: [Column<Model, BLOCK>; 2],
}

impl<const D: usize> Memory<D> {
    pub(crate) fn new() -> Self {
        Self {
            locals: [[Vector::ZERO; BLOCK]; 2],
            points: Block::zero(),
            boxes: Block::zero(),
            values: Column::zero(),
            slopes: Gradients::zero(),
            models: [Column::zero(), Column::zero()],
        }
    }

    /// The centre of a box, in coordinates of the body that was asked there just before.
    #[inline]
    pub(crate) fn local(&self, body: usize, i: usize) -> Point<D> {
        self.locals[body][i]
    }

    /// Moves the entry of one box to another lane.
    #[inline]
    pub(crate) fn keep(&mut self, body: usize, from: usize, to: usize) {
        self.locals[body][to] = self.locals[body][from];
    }
}

/// Two bodies in the frame of the first: bounds of the first body over boxes stay valid while both move.
#[derive(Clone, Copy)]
pub(crate) struct BodyPair<'a, const D: usize> {
    pub(crate) bodies: [DistanceBound<'a, D>; 2],
    /// Boxes of the frame that hold the bodies; one of them at least is there.
    aabbs: [Option<Aabb<D>>; 2],
    pub(crate) world_from_frame: Pose<D>,
    /// From the frame to the second shape's coordinates.
    pub(crate) second_from_frame: Pose<D>,
    /// The rounding of the second body's pose in the frame where both bodies are far from the
    /// world's origin [m].
    placing: f64,
    /// A gradient counts twice.
    pub(crate) evaluations: u32,
}

impl<'a, const D: usize> BodyPair<'a, D> {
    #[inline(never)]
    pub(crate) fn new(a: Placed<'a, D>, b: Placed<'a, D>) -> Result<Self, QueryError> {
        check_pose(0, &a.world_from_body)?;
        check_pose(1, &b.world_from_body)?;
        let second_from_frame = b.world_from_body.inverse() * a.world_from_body;
        let bodies = [
            DistanceBound::new(a.shape, Pose::identity()),
            DistanceBound::new(b.shape, second_from_frame),
        ];
        let aabbs = bodies.map(|body| body.aabb());
        if aabbs == [None, None] {
            return Err(QueryError::Unbounded);
        }
        let world_from_frame = a.world_from_body;
        let far = a.world_from_body.translation.norm() + b.world_from_body.translation.norm();
        let placing = PLACE_ROUNDINGS * f64::EPSILON * far;
        Ok(Self { bodies, aabbs, world_from_frame, second_from_frame, placing, evaluations: 0 })
    }

    /// The rounding of values within `reach` of the frame's origin [m].
    pub(crate) fn slack(&self, reach: f64) -> f64 {
        self.bodies[0].slack(reach).max(self.bodies[1].slack(reach)) + self.placing
    }

    /// `g` of both at a point of the frame, with gradients.
    #[inline]
    pub(crate) fn slopes(&mut self, p: Point<D>) -> [(f64, Vector<f64, D>); 2] {
        self.evaluations += 4;
        [self.bodies[0].distance_gradient(p), self.bodies[1].distance_gradient(p)]
    }

    /// The separation that the values at a point of the frame show: twice the larger `g` [m].
    pub(crate) fn gap_at(&mut self, p: Point<D>) -> f64 {
        self.evaluations += 2;
        let [a, b] = [0, 1].map(|i| {
            let body = &self.bodies[i];
            let local = body.local(p);
            body.value(local, body.shape.distance(local))
        });
        2.0 * larger(a, b)
    }

    /// A point of a body's surface near a point of the frame, in the frame.
    pub(crate) fn surface_point(&self, body: usize, p: Point<D>) -> Option<Point<D>> {
        let body = &self.bodies[body];
        Some(body.in_frame(body.shape.surface_point(body.local(p))?))
    }

    /// An upper bound of the bodies' distance [m]: that of their separation, where it bounds the distance, else
    /// the distance of two points of the bodies found near `places` of the frame. Ends at the first of at
    /// most `enough`; infinite if none is found.
    pub(crate) fn distance_at_most(
        &self,
        upper: f64,
        places: impl IntoIterator<Item = Point<D>>,
        enough: f64,
    ) -> f64 {
        if upper <= 0.0 {
            return 0.0;
        }
        if self.bodies.iter().all(DistanceBound::is_exact_outside) {
            return upper;
        }
        let mut least = f64::INFINITY;
        for place in places {
            let points = [0, 1].map(|body| self.bodies[body].point_within(place));
            let [Some(mut a), Some(mut b)] = points else { continue };
            let mut last = f64::INFINITY;
            for _ in 0..APPROACHES {
                // Each of the points is within two roundings of its body.
                let distance = (a - b).norm() + 4.0 * self.slack(a.norm().max(b.norm()));
                least = least.min(distance);
                if least <= enough {
                    return least;
                }
                let is_nearer = distance < last;
                let (Some(to_b), true) = (self.bodies[0].point_within(b), is_nearer) else {
                    break;
                };
                last = distance;
                let Some(to_a) = self.bodies[1].point_within(to_b) else { break };
                (a, b) = (to_b, to_a);
            }
        }
        least
    }

    /// The longest side of the smaller of the bodies' boxes [m].
    pub(crate) fn smaller_size(&self) -> f64 {
        let size = |aabb: &Aabb<D>| {
            (0..D).fold(0.0_f64, |longest, k| longest.max(aabb.max[k] - aabb.min[k]))
        };
        self.aabbs.iter().flatten().map(size).fold(f64::INFINITY, f64::min)
    }

    /// From the middle of the first body's box to that of the second's; zero if one has
    /// none.
    pub(crate) fn between_centres(&self) -> Vector<f64, D> {
        match self.aabbs {
            [Some(a), Some(b)] => b.centre() - a.centre(),
            _ => Vector::ZERO,
        }
    }

    /// `g` of one body at the centres of cells.
    pub(crate) fn values(
        &mut self,
        body: usize,
        cells: &[BoxCell<D>],
        memory: &mut Memory<D>,
        values: &mut [f64; BLOCK],
    ) {
        self.evaluations += cells.len() as u32;
        let (body, locals) = (&self.bodies[body], &mut memory.locals[body]);
        for (cell, local) in cells.iter().zip(&mut *locals) {
            *local = body.local(cell.centre);
        }
        memory.points.fill(cells.len(), |i| locals[i]);
        body.shape.block_distances(&memory.points, cells.len(), &mut memory.values);
        let found = locals[..cells.len()].iter().zip(memory.values.as_slice());
        for ((local, f), value) in found.zip(values) {
            *value = body.value(*local, *f);
        }
    }

    /// `g` of both at points, with gradients.
    pub(crate) fn block_slopes(
        &mut self,
        points: &[Point<D>],
        memory: &mut Memory<D>,
        slopes: &mut [[(f64, Vector<f64, D>); BLOCK]; 2],
    ) {
        self.evaluations += 4 * points.len() as u32;
        for (body, slopes) in self.bodies.iter().zip(slopes) {
            memory.points.fill(points.len(), |i| body.local(points[i]));
            body.shape.block_gradients(&memory.points, points.len(), &mut memory.slopes);
            for (i, slope) in slopes[..points.len()].iter_mut().enumerate() {
                let local = memory.points.get(i);
                let (f, gradient) =
                    (memory.slopes.distance.get(i), memory.slopes.gradient.get(i));
                *slope = body.slope_of(local, f, gradient);
            }
        }
    }

    /// What `g` of one body is at least within `radius` of a point in its coordinates, where it
    /// is `value`.
    #[inline]
    pub(crate) fn floor(&self, body: usize, local: Point<D>, value: f64, radius: f64) -> f64 {
        self.bodies[body].floor(local, value, radius)
    }

    /// Keeps of the cells, asked for their values just before, those that `open` names in
    /// which both fields are known to be as steep as promised.
    pub(crate) fn keep_known(
        &self,
        cells: &[BoxCell<D>],
        open: &mut Vec<usize>,
        memory: &Memory<D>,
    ) {
        for (body, locals) in self.bodies.iter().zip(&memory.locals) {
            if !body.is_known_everywhere() {
                open.retain(|&i| body.is_known(locals[i], cells[i].radius()));
            }
        }
    }

    /// Models of one body over those of the cells, asked for their values just before,
    /// that `open` names.
    pub(crate) fn models(
        &mut self,
        body: usize,
        cells: &[BoxCell<D>],
        open: &[usize],
        memory: &mut Memory<D>,
    ) {
        if open.is_empty() {
            return;
        }
        self.evaluations += open.len() as u32;
        let (locals, models) = (&memory.locals[body], &mut memory.models[body]);
        let body = &self.bodies[body];
        memory.boxes.fill_boxes(open.len(), body.turn(), |lane| {
            let i = open[lane];
            (locals[i], cells[i].half)
        });
        body.shape.block_distances(&memory.boxes, open.len(), models);
    }

    /// The model of `f/L` of one body in a lane.
    #[inline]
    pub(crate) fn model(&self, body: usize, memory: &Memory<D>, lane: usize) -> Model {
        self.bodies[body].scaled(memory.models[body].get(lane))
    }

    /// A box of the frame that holds all points at which both `g` are at most `least`.
    pub(crate) fn root(&self, least: f64) -> Aabb<D> {
        let grown = self.aabbs.iter().flatten().map(|aabb| aabb.grown(least));
        let nowhere = Aabb { min: Vector::ZERO, max: Vector::ZERO };
        grown.reduce(|a, b| common(&a, &b)).unwrap_or(nowhere)
    }

    /// The part of a box of the frame in which the second body's own box, grown by `least`,
    /// leaves room for such points.
    pub(crate) fn tightened(&self, root: &Aabb<D>, least: f64) -> Aabb<D> {
        self.bodies[1].tightened(root, least).unwrap_or(*root)
    }

    /// How far the boxes of both bodies are apart along a side of either, if they are [m].
    pub(crate) fn gap_of_boxes(&self) -> Option<f64> {
        let inside_out = |both: Aabb<D>| {
            (0..D).fold(f64::NEG_INFINITY, |gap, k| gap.max(both.min[k] - both.max[k]))
        };
        let [Some(a), Some(b)] = self.aabbs else { return None };
        let mut gap = inside_out(common(&a, &b));
        if let Some(second) = self.bodies[1].own_box() {
            gap = gap.max(inside_out(common(&a.placed(&self.second_from_frame), &second)));
        }
        (gap > 0.0).then_some(gap)
    }
}

/// The intersection of two boxes; its corners are swapped along sides where they are apart.
fn common<const D: usize>(a: &Aabb<D>, b: &Aabb<D>) -> Aabb<D> {
    let mut both = *a;
    for k in 0..D {
        both.min[k] = a.min[k].max(b.min[k]);
        both.max[k] = a.max[k].min(b.max[k]);
    }
    both
}
