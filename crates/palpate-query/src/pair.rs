// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How far two fields are apart.
//!
//! With `g` of each body a lower bound of the distance to it, at most as steep as one,
//!
//! ```text
//! separation = 2·min over p of max(g_a(p), g_b(p)).
//! ```
//!
//! Apart, that is at most the distance of the bodies, and equal to it where both are
//! exact outside: in the middle of the shortest way both are half of it. Overlapping, it
//! is minus the width of the widest ball in the overlap: of the right sign, continuous,
//! and not the way that parts them.
//!
//! The search is best-first over boxes, 64 at a time. At its centre a box has
//! `max(g_a, g_b) − radius` as a bound. Smaller boxes are bounded by models: each is an
//! affine function less a remainder, so is every mean of two, and
//! `max ≥ λ·g_a + (1 − λ)·g_b`: of all these means the largest least value is taken.
//! Where the surfaces face each other the gradients cancel, and what remains is of
//! second order. Points are improved by minimax proximal steps: the maximum of the two
//! tangent planes plus a parabola is least at a step along a mean of both gradients.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use palpate_field::field::{EvaluateBlock, Field};
use palpate_field::scalar::Model;
use palpate_field::{Aabb, BLOCK, Block, Column, Point, Shape, Vector};

use crate::body::Body;
use crate::certified::{Certified, Limits, Stop};
use crate::error::QueryError;
use crate::goal::Goal;

/// Boxes are bounded by models below this radius, as a share of the first box's: above,
/// remainders are larger than radii.
const SMALL: f64 = 0.25;

/// Sides that are halved, as a share of the longest.
const LONG_SIDE: f64 = 0.6;

/// Steps of a descent at most.
const STEPS: u32 = 40;

/// A gain that is less than this share of the value is slow.
const SLOW: f64 = 0.2;

/// Boxes that a workspace holds.
const ROOM: usize = 1 << 16;

/// The last bits of a sum of models.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// Where two bodies are nearest, or overlap most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest<const D: usize> {
    /// The point between the bodies, or in both [m].
    pub point: Point<D>,
    /// From the first body to the second; `None` where neither's gradient says.
    pub normal: Option<Vector<f64, D>>,
}

/// A box, and what is known of it.
#[derive(Clone, Copy, Debug)]
struct Cell<const D: usize> {
    lower: f64,
    centre: Point<D>,
    half: Vector<f64, D>,
}

/// The box of which least is known comes first.
impl<const D: usize> Ord for Cell<D> {
    fn cmp(&self, other: &Self) -> Ordering {
        other.lower.total_cmp(&self.lower)
    }
}

impl<const D: usize> PartialOrd for Cell<D> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<const D: usize> PartialEq for Cell<D> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<const D: usize> Eq for Cell<D> {}

/// Memory of searches between bodies, to be kept between them.
#[derive(Debug)]
pub struct PairWorkspace<const D: usize> {
    cells: BinaryHeap<Cell<D>>,
    points: Block<f64, D, BLOCK>,
    boxes: Block<Model, D, BLOCK>,
    values: [Column<f64, BLOCK>; 2],
    models: [Column<Model, BLOCK>; 2],
}

impl<const D: usize> PairWorkspace<D> {
    /// Room for searches in `D` dimensions.
    #[must_use]
    pub fn new() -> Self {
        Self {
            cells: BinaryHeap::with_capacity(ROOM),
            points: Block::zero(),
            boxes: Block::zero(),
            values: [Column::zero(), Column::zero()],
            models: [Column::zero(), Column::zero()],
        }
    }
}

impl<const D: usize> Default for PairWorkspace<D> {
    fn default() -> Self {
        Self::new()
    }
}

/// The separation of two bodies [m], between bounds, to `limits.tolerance`.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_query::{Limits, PairWorkspace, separation};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let a = Shape::from_kernel(Ball::new(1.0)?);
/// let b = Shape::from_kernel(Ball::new(0.5)?).translated(Vector([1.2, 1.6]))?;
/// let answer = separation(&a, &b, &Limits::default(), &mut PairWorkspace::new())?;
/// assert!(answer.lower <= 0.5 && 0.5 <= answer.upper);
/// assert!(answer.upper - answer.lower <= 1e-4);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If neither body is bounded.
pub fn separation<const D: usize>(
    a: &Shape<D>,
    b: &Shape<D>,
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Certified<Nearest<D>>, QueryError>
where
    dyn Field<D>: EvaluateBlock<f64, D, BLOCK> + EvaluateBlock<Model, D, BLOCK>,
{
    let goal = Goal::Least { tolerance: 0.5 * limits.tolerance };
    search([a, b], goal, limits.budget, workspace)
}

/// Whether two bodies overlap, in [`Certified::is_hit`]: whether some point is in both.
///
/// Stops as soon as that is known, or known to lie within `limits.tolerance` of a touch.
/// Bodies whose boxes are apart are told apart without asking them.
///
/// # Errors
///
/// If neither body is bounded.
pub fn overlap<const D: usize>(
    a: &Shape<D>,
    b: &Shape<D>,
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Certified<Nearest<D>>, QueryError>
where
    dyn Field<D>: EvaluateBlock<f64, D, BLOCK> + EvaluateBlock<Model, D, BLOCK>,
{
    let goal = Goal::Sign { tolerance: 0.5 * limits.tolerance };
    search([a, b], goal, limits.budget, workspace)
}

fn search<const D: usize>(
    [a, b]: [&Shape<D>; 2],
    goal: Goal,
    budget: u32,
    workspace: &mut PairWorkspace<D>,
) -> Result<Certified<Nearest<D>>, QueryError>
where
    dyn Field<D>: EvaluateBlock<f64, D, BLOCK> + EvaluateBlock<Model, D, BLOCK>,
{
    let bodies = [Body::new(a), Body::new(b)];
    let start = match (bodies[0].aabb, bodies[1].aabb) {
        (None, None) => return Err(QueryError::Unbounded),
        (Some(a), Some(b)) => {
            Aabb { min: larger(a.min, b.min), max: smaller(a.max, b.max) }.centre()
        }
        (Some(one), None) | (None, Some(one)) => one.centre(),
    };
    let mut search = Search {
        bodies,
        goal,
        budget,
        upper: f64::INFINITY,
        best: start,
        dropped: f64::INFINITY,
        evaluations: 0,
        slack: 0.0,
    };
    Ok(search.run(workspace))
}

fn larger<const D: usize>(a: Point<D>, b: Point<D>) -> Point<D> {
    let mut c = a;
    for k in 0..D {
        c[k] = a[k].max(b[k]);
    }
    c
}

fn smaller<const D: usize>(a: Point<D>, b: Point<D>) -> Point<D> {
    -larger(-a, -b)
}

/// A search under way; its bounds are of `max(g_a, g_b)`, half the separation.
struct Search<'a, const D: usize> {
    bodies: [Body<'a, D>; 2],
    goal: Goal,
    budget: u32,
    upper: f64,
    best: Point<D>,
    /// Nothing in the boxes that were dropped is less.
    dropped: f64,
    evaluations: u32,
    /// What values may be off by [m].
    slack: f64,
}

impl<const D: usize> Search<'_, D>
where
    dyn Field<D>: EvaluateBlock<f64, D, BLOCK> + EvaluateBlock<Model, D, BLOCK>,
{
    fn run(&mut self, workspace: &mut PairWorkspace<D>) -> Certified<Nearest<D>> {
        if let (Goal::Sign { .. }, Some(gap)) = (self.goal, self.gap_of_boxes()) {
            // Half of it is what both values are at least, somewhere between.
            let reach = self.best.norm() + gap;
            self.slack = self.bodies[0].slack(reach).max(self.bodies[1].slack(reach));
            if 0.5 * gap > self.slack {
                self.upper = f64::INFINITY;
                return self.answer(Stop::SignKnown, 0.5 * gap - self.slack);
            }
        }
        self.descend(self.best);
        let Some(root) = self.root() else { return self.answer(Stop::BudgetSpent, self.upper) };
        let reach = root.centre().norm() + root.half_extents().norm();
        self.slack = self.bodies[0].slack(reach).max(self.bodies[1].slack(reach));
        let largest = SMALL * root.half_extents().norm();
        workspace.cells.clear();
        workspace.cells.push(Cell {
            lower: f64::NEG_INFINITY,
            centre: root.centre(),
            half: root.half_extents(),
        });
        loop {
            let lowest = workspace.cells.peek().map_or(f64::INFINITY, |cell| cell.lower);
            let lower = lowest.min(self.dropped);
            if let Some(stop) = self.goal.reached(lower, self.upper + self.slack) {
                return self.answer(stop, lower);
            }
            let is_full = workspace.cells.len() + BLOCK > ROOM;
            if lowest.is_infinite() && lowest > 0.0
                || is_full
                || self.evaluations >= self.budget
            {
                return self.answer(Stop::BudgetSpent, lower);
            }
            self.round(workspace, largest);
        }
    }

    fn answer(&self, stop: Stop, lower: f64) -> Certified<Nearest<D>> {
        let upper = self.upper + self.slack;
        let (_, a) = self.bodies[0].slope(self.best);
        let (_, b) = self.bodies[1].slope(self.best);
        let between = a - b;
        let length = between.norm();
        let normal = (length > 1e-6).then(|| between * (1.0 / length));
        Certified {
            best: Nearest { point: self.best, normal },
            lower: 2.0 * lower.min(upper),
            upper: 2.0 * upper,
            stop,
            evaluations: self.evaluations,
        }
    }

    /// Boxes with nothing below this need no more looking at.
    fn threshold(&self) -> f64 {
        self.goal.threshold(self.upper + self.slack)
    }

    /// How far the boxes of both bodies are apart, if they are [m].
    fn gap_of_boxes(&self) -> Option<f64> {
        let [a, b] = [self.bodies[0].aabb?, self.bodies[1].aabb?];
        let (low, high) = (larger(a.min, b.min), smaller(a.max, b.max));
        let mut gap = 0.0_f64;
        for k in 0..D {
            gap = gap.max(low[k] - high[k]);
        }
        (gap > 0.0).then_some(gap)
    }

    /// A box that holds all points that matter: where neither `g` is more than the best so
    /// far, or, if the sign is all that is asked for, than the tolerance. Elsewhere one is.
    fn root(&mut self) -> Option<Aabb<D>> {
        let reach = self.best.norm() + self.upper.abs();
        let slack = self.bodies[0].slack(reach).max(self.bodies[1].slack(reach));
        let least = match self.goal {
            Goal::Least { .. } => self.upper.max(0.0),
            Goal::Sign { tolerance } => self.upper.clamp(0.0, tolerance.max(0.0)),
        };
        self.dropped = least + slack;
        let margin = (least + 2.0 * slack) * (1.0 + 1e-12);
        let grown = self.bodies.map(|body| body.aabb.map(|aabb| aabb.grown(margin)));
        match grown {
            [Some(a), Some(b)] => {
                Some(Aabb { min: larger(a.min, b.min), max: smaller(a.max, b.max) })
            }
            [one, other] => one.or(other),
        }
    }

    /// Halves the boxes of which least is known, a block of parts, and bounds them.
    fn round(&mut self, workspace: &mut PairWorkspace<D>, largest: f64) {
        let mut parts = [Cell { lower: 0.0, centre: Vector::ZERO, half: Vector::ZERO }; BLOCK];
        let mut count = 0;
        while count + (1 << D) <= BLOCK {
            let Some(parent) = workspace.cells.pop() else { break };
            if parent.lower >= self.threshold() {
                self.dropped = self.dropped.min(parent.lower);
                continue;
            }
            count = halve(&parent, &mut parts, count);
        }
        let parts = &mut parts[..count];
        for (i, part) in parts.iter().enumerate() {
            workspace.points.set(i, part.centre);
        }
        let mut least = (f64::INFINITY, self.best);
        let mut radii = [0.0; BLOCK];
        for (body, values) in self.bodies.iter().zip(&mut workspace.values) {
            body.shape.block_distances(&workspace.points, count, values);
        }
        self.evaluations += 2 * count as u32;
        for (i, part) in parts.iter_mut().enumerate() {
            let values =
                [0, 1].map(|k| self.bodies[k].value(part.centre, workspace.values[k].get(i)));
            let value = values[0].max(values[1]);
            radii[i] = part.half.norm() * (1.0 + ROUNDINGS);
            part.lower = part.lower.max(value - radii[i] - self.slack);
            if value < least.0 {
                least = (value, part.centre);
            }
        }
        if least.0 < self.upper - 0.25 * self.goal.tolerance() {
            self.descend(least.1);
        }
        self.refine(parts, &radii, workspace, largest);
        for part in &*parts {
            if part.lower < self.threshold() {
                workspace.cells.push(*part);
            } else {
                self.dropped = self.dropped.min(part.lower);
            }
        }
    }

    /// Bounds those parts by models that are small and not yet done with.
    fn refine(
        &mut self,
        parts: &mut [Cell<D>],
        radii: &[f64; BLOCK],
        workspace: &mut PairWorkspace<D>,
        largest: f64,
    ) {
        let mut open = [0; BLOCK];
        let mut count = 0;
        for (i, part) in parts.iter().enumerate() {
            let is_known = self.bodies.iter().all(|body| body.is_known(part.centre, radii[i]));
            if radii[i] <= largest && is_known && part.lower < self.threshold() {
                let cell = Model::cell(part.centre.0, part.half.0);
                workspace.boxes.set(count, Vector(cell));
                open[count] = i;
                count += 1;
            }
        }
        if count == 0 {
            return;
        }
        for (body, models) in self.bodies.iter().zip(&mut workspace.models) {
            body.shape.block_distances(&workspace.boxes, count, models);
        }
        self.evaluations += 2 * count as u32;
        for (lane, &i) in open[..count].iter().enumerate() {
            let [a, b] = &workspace.models;
            let scales = self.bodies.map(|body| body.scale);
            let lower = least_of_larger([a.get(lane), b.get(lane)], scales);
            // Boxes are off by a rounding where they meet.
            parts[i].lower = parts[i].lower.max(lower - self.slack);
        }
    }

    /// Improves a point by minimax proximal steps.
    fn descend(&mut self, start: Point<D>) {
        let slopes = |search: &mut Self, p: Point<D>| {
            search.evaluations += 4;
            search.bodies.map(|body| body.slope(p))
        };
        let mut p = start;
        let mut here = slopes(self, p);
        let mut value = here[0].0.max(here[1].0);
        let mut step = value.abs().max(self.goal.tolerance());
        let mut small_gains = 0;
        for _ in 0..STEPS {
            let [(a, slope_a), (b, slope_b)] = here;
            let between = slope_a - slope_b;
            let squared = between.dot(between);
            let share = if squared > 0.0 {
                (((a - b) / step - slope_b.dot(between)) / squared).clamp(0.0, 1.0)
            } else {
                0.5
            };
            let next = p - (slope_b + between * share) * step;
            let there = slopes(self, next);
            let next_value = there[0].0.max(there[1].0);
            if next_value < value {
                let gain = value - next_value;
                // Whether bodies that are far apart overlap, boxes tell sooner.
                let is_slow =
                    matches!(self.goal, Goal::Sign { .. }) && gain < SLOW * next_value;
                (p, here, value) = (next, there, next_value);
                if is_slow {
                    break;
                }
                step *= 2.5;
                small_gains =
                    if gain < 0.05 * self.goal.tolerance() { small_gains + 1 } else { 0 };
            } else {
                step *= 0.25;
            }
            let is_enough = self.goal.is_hit(value + self.slack);
            if is_enough || small_gains == 2 || step < 0.05 * self.goal.tolerance() {
                break;
            }
        }
        if value < self.upper {
            (self.upper, self.best) = (value, p);
        }
    }
}

/// The parts of a box, halved along its long sides, after the first `count` of `parts`;
/// how many there are then.
fn halve<const D: usize>(parent: &Cell<D>, parts: &mut [Cell<D>], count: usize) -> usize {
    let longest = (0..D).fold(0.0_f64, |longest, k| longest.max(parent.half[k]));
    parts[count] = *parent;
    let mut end = count + 1;
    for k in 0..D {
        if parent.half[k] > LONG_SIDE * longest || longest == 0.0 {
            for i in count..end {
                let mut other = parts[i];
                let half = 0.5 * other.half[k];
                other.half[k] = half;
                parts[i].half[k] = half;
                parts[i].centre[k] -= half;
                other.centre[k] += half;
                parts[end + i - count] = other;
            }
            end += end - count;
        }
    }
    end
}

/// A lower bound of the larger of two fields over a box, from their models: the largest
/// least value of their means, which is at the end of a range or where a component of
/// the mean's slope changes its sign.
fn least_of_larger(models: [Model; 2], scales: [f64; 2]) -> f64 {
    let [a, b] = models;
    let [scale_a, scale_b] = scales;
    let mut best = f64::NEG_INFINITY;
    let mut attempt = |share: f64| {
        let (of_a, of_b) = (share * scale_a, (1.0 - share) * scale_b);
        let value = of_a * a.value + of_b * b.value;
        let (mut slope, mut size) = (0.0, (of_a * a.value).abs() + (of_b * b.value).abs());
        for (a, b) in a.gradient.iter().zip(b.gradient) {
            slope += (of_a * a + of_b * b).abs();
            size += (of_a * a).abs() + (of_b * b).abs();
        }
        let remainder = of_a * a.lower + of_b * b.lower;
        let least = value - slope - remainder * (1.0 + ROUNDINGS) - ROUNDINGS * size;
        best = best.max(least);
    };
    attempt(0.0);
    attempt(1.0);
    for k in 0..3 {
        let (of_a, of_b) = (scale_a * a.gradient[k], scale_b * b.gradient[k]);
        let share = of_b / (of_b - of_a);
        if share > 0.0 && share < 1.0 {
            attempt(share);
        }
    }
    best
}
