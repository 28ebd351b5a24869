// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The sharp union of any number of members, with members out of reach skipped.
//!
//! A member is skipped only where its value is sure to be larger than the
//! smallest, rounding included, so skipping changes no bit of the result.

use std::sync::Arc;

use super::combine::{GradientFold, ValueFold, placed_children};
use super::{DifferentiateBlock, EvaluateBlock, EvaluatePoint, Field, Moved};
use crate::machine::{BLOCK, Block, Column, Gradients, Job, Lane, run};
use crate::operator::boolean::Smaller;
use crate::pose::Pose;
use crate::promise::{Promise, Quality};
use crate::scalar::{Float, Scalar};
use crate::shape::Shape;
use crate::vector::{Point, Vector};

/// Below this many members, asking all is faster than choosing.
const WORTH_CHOOSING: usize = 6;

/// Members looked at together.
const GROUP: usize = BLOCK;

/// Beyond this distance from the origin [m], squares of lengths near the limits
/// of single precision: every member is asked.
const FAR: f64 = 1e15;

/// The union of at least one member.
#[derive(Debug)]
pub(crate) struct Union<const D: usize> {
    members: Vec<Shape<D>>,
    /// Empty where choosing is not worth it.
    groups: Vec<Group<D>>,
    slack: Slack,
    promise: Promise<D>,
}

/// The balls around up to [`GROUP`] members.
///
/// Single precision is enough: what it rounds is part of the [`Slack`].
#[derive(Debug)]
struct Group<const D: usize> {
    centres: Block<f32, D, GROUP>,
    /// Infinite for a member that may not be skipped; minus infinity past the
    /// last member.
    radii: Column<f32, GROUP>,
}

/// How far each member of a group is from a query at least.
type Gaps = Column<f32, GROUP>;

/// How much smaller than its ball's distance a member's value may come out: the
/// rounding of the balls, and of the members themselves in single precision.
#[derive(Clone, Copy, Debug)]
struct Slack {
    constant: f64,
    per_metre: f64,
}

/// A ball that holds the points asked for.
#[derive(Clone, Copy, Debug)]
struct Query<const D: usize> {
    centre: Point<D>,
    radius: f64,
}

impl<const D: usize> Group<D> {
    fn new(members: &[Shape<D>]) -> Self {
        let mut group = Self { centres: Block::zero(), radii: Column::zero() };
        for i in 0..GROUP {
            let (centre, radius) = match members.get(i).map(Shape::promise) {
                None => (Vector::ZERO, f64::NEG_INFINITY),
                Some(promise) => match promise.bounds {
                    Some(bounds) if may_be_skipped(promise) => {
                        (bounds.ball.centre, bounds.ball.radius)
                    }
                    _ => (Vector::ZERO, f64::INFINITY),
                },
            };
            group.centres.set(i, Vector::of(&centre.0));
            group.radii.set(i, radius as f32);
        }
        group
    }
}

/// `true` if the values are nowhere below the signed distance to the ball.
fn may_be_skipped<const D: usize>(promise: &Promise<D>) -> bool {
    promise.above_bounds && promise.inside != Quality::Lipschitz
}

/// The distance of a point from balls.
struct ToBalls<const D: usize>(Vector<f32, D>);

impl<const D: usize> Job<Vector<f32, D>, f32, f32> for ToBalls<D> {
    #[inline(always)]
    fn lane(&self, centre: Vector<f32, D>, radius: f32) -> f32 {
        (centre - self.0).norm() - radius
    }
}

/// Gaps looked at together: a cache line of them.
const LINE: usize = 16;

/// The smallest gap of a line, halving it without a branch.
#[inline(always)]
fn smallest_of(line: &[f32; LINE]) -> f32 {
    let mut least = *line;
    let mut width = LINE / 2;
    while width > 0 {
        for i in 0..width {
            least[i] = Scalar::min(least[i], least[i + width]);
        }
        width /= 2;
    }
    least[0]
}

/// The gaps of a line that are at most `limit`, one bit each.
#[inline(always)]
fn at_most(line: &[f32; LINE], limit: f32) -> u32 {
    let mut bits = 0;
    for (i, gap) in line.iter().enumerate() {
        bits |= u32::from(*gap <= limit) << i;
    }
    bits
}

/// A word with its lowest `count` bits set, all of a line at most.
#[inline(always)]
fn first_bits(count: usize) -> u32 {
    if count >= LINE { (1 << LINE) - 1 } else { (1 << count) - 1 }
}

impl<const D: usize> Union<D> {
    pub(crate) fn new(members: Vec<Shape<D>>, promise: Promise<D>) -> Self {
        let choosing = members.len() >= WORTH_CHOOSING;
        let groups: Vec<_> =
            if choosing { members.chunks(GROUP).map(Group::new).collect() } else { Vec::new() };
        let extent = members
            .iter()
            .filter_map(|m| m.promise().bounds)
            .fold(0.0_f64, |far, bounds| far.max(bounds.radius_about_origin()));
        // Rounding is given in double precision; single is 2²⁹ times coarser.
        let coarser = f64::from(f32::EPSILON) / f64::EPSILON;
        let rounding = promise.rounding.times(2.0 * coarser);
        let balls = 16.0 * f64::from(f32::EPSILON);
        let slack = Slack {
            constant: rounding.constant + balls * extent,
            per_metre: rounding.per_metre + balls,
        };
        Self { members, groups, slack, promise }
    }

    /// How many members a block is likely to need.
    fn expected(&self) -> usize {
        if self.groups.is_empty() { self.members.len() } else { 1 }
    }

    /// Calls `near` with every member that may be the smallest somewhere in the
    /// ball, in their order.
    ///
    /// `value` gives an upper bound of a member's values in the ball; `near` may
    /// return a smaller bound.
    #[inline(always)]
    fn for_each_near(
        &self,
        query: Query<D>,
        mut value: impl FnMut(usize) -> f64,
        mut near: impl FnMut(usize) -> f64,
    ) {
        let centre = Vector::<f32, D>::of(&query.centre.0);
        let from_origin = query.centre.norm() + query.radius;
        let slack = if from_origin < FAR {
            self.slack.constant + self.slack.per_metre * from_origin + query.radius
        } else {
            f64::INFINITY
        };
        let mut gaps = Gaps::scratch();
        let mut bound = f64::INFINITY;
        for (g, group) in self.groups.iter().enumerate() {
            run(&ToBalls(centre), &group.centres, &group.radii, GROUP, &mut gaps);
            let (lines, _) = gaps.as_slice().as_chunks::<LINE>();
            // The member whose ball is nearest gives the first bound.
            let mut nearest = (0, f32::INFINITY);
            for (k, line) in lines.iter().enumerate() {
                let gap = smallest_of(line);
                nearest = if gap < nearest.1 { (k, gap) } else { nearest };
            }
            let (k, gap) = nearest;
            if f64::from(gap) <= bound + slack {
                let first = at_most(&lines[k], gap).trailing_zeros() as usize;
                bound = bound.min(value(g * GROUP + k * LINE + first));
            }
            for (k, line) in lines.iter().enumerate() {
                // The lanes past the last member are infinitely far, but so may the
                // limit be.
                let members =
                    self.members.len() - (g * GROUP + k * LINE).min(self.members.len());
                let mut bits = at_most(line, (bound + slack) as f32) & first_bits(members);
                while bits != 0 {
                    let i = bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    // The bound may have fallen since the bits were found.
                    if f64::from(line[i]) <= bound + slack {
                        bound = bound.min(near(g * GROUP + k * LINE + i));
                    }
                }
            }
        }
    }

    /// The smallest value at a point, and which member has it.
    #[inline(always)]
    fn winner<T: Float>(&self, x: T, y: T, z: T) -> (T, usize)
    where
        dyn Field<D>: EvaluatePoint<T, D>,
    {
        let ask = |i: usize| self.members[i].field().distance(x, y, z);
        if self.groups.is_empty() {
            // Selects, since which of two members is nearer is hard to predict.
            let (mut smallest, mut winner) = (ask(0), 0);
            for i in 1..self.members.len() {
                let value = ask(i);
                winner = if value < smallest { i } else { winner };
                smallest = smallest.min(value);
            }
            return (smallest, winner);
        }
        let mut best: Option<(T, usize)> = None;
        let centre = Vector::of_coordinates(x.to_f64(), y.to_f64(), z.to_f64());
        let query = Query { centre, radius: 0.0 };
        let first = std::cell::Cell::new((usize::MAX, T::default()));
        let bound = |i| {
            let value = ask(i);
            first.set((i, value));
            value.to_f64()
        };
        self.for_each_near(query, bound, |i| {
            let known = first.get();
            let value = if known.0 == i { known.1 } else { ask(i) };
            if best.is_none_or(|(smallest, _)| value < smallest) {
                best = Some((value, i));
            }
            value.to_f64()
        });
        best.unwrap_or((T::constant(f64::INFINITY), 0))
    }

    /// The ball around the first `count` points or cells of a block.
    fn ball_around<S: Lane, const W: usize>(p: &Block<S, D, W>, count: usize) -> Query<D> {
        let mut low = Vector::<f64, D>::constant(f64::INFINITY);
        let mut high = Vector::<f64, D>::constant(f64::NEG_INFINITY);
        for i in 0..count.min(W) {
            for (k, x) in p.get(i).0.iter().enumerate() {
                let (least, most) = x.range();
                low[k] = Scalar::min(low[k], least);
                high[k] = Scalar::max(high[k], most);
            }
        }
        let centre = (low + high) * 0.5;
        Query { centre, radius: (high - centre).norm() * (1.0 + 4.0 * f64::EPSILON) }
    }

    /// The members that matter in a block.
    fn near_block<S: Lane, const W: usize>(
        &self,
        p: &Block<S, D, W>,
        count: usize,
        mut near: impl FnMut(&Shape<D>),
    ) {
        if self.groups.is_empty() {
            self.members.iter().for_each(near);
            return;
        }
        let query = Self::ball_around(p, count);
        self.for_each_near(
            query,
            |i| {
                let member = &self.members[i];
                let promise = member.promise();
                match promise.region {
                    None => {
                        let (x, y, z) = query.centre.coordinates();
                        let value: f64 = member.field().distance(x, y, z);
                        value + promise.lipschitz * query.radius
                    }
                    Some(_) => f64::INFINITY,
                }
            },
            |i| {
                near(&self.members[i]);
                f64::INFINITY
            },
        );
    }
}

impl<T: Float, const D: usize> EvaluatePoint<T, D> for Union<D>
where
    dyn Field<D>: EvaluatePoint<T, D>,
{
    fn distance(&self, x: T, y: T, z: T) -> T {
        self.winner(x, y, z).0
    }

    /// All values first, then the gradient of the one member that is smallest.
    fn distance_gradient(&self, x: T, y: T, z: T, gradient: &mut Vector<T, D>) -> T {
        let (_, winner) = self.winner(x, y, z);
        self.members[winner].field().distance_gradient(x, y, z, gradient)
    }
}

impl<S: Lane, const D: usize, const W: usize> EvaluateBlock<S, D, W> for Union<D>
where
    dyn Field<D>: EvaluateBlock<S, D, W>,
{
    fn distances(&self, p: &Block<S, D, W>, count: usize, out: &mut Column<S, W>) {
        let mut fold = ValueFold::new(&Smaller, self.expected(), out);
        self.near_block(p, count, |member| fold.push(member, p, count));
        fold.finish();
    }
}

impl<T: Float + Lane, const D: usize, const W: usize> DifferentiateBlock<T, D, W> for Union<D>
where
    dyn Field<D>: DifferentiateBlock<T, D, W>,
{
    fn distances_gradients(
        &self,
        p: &Block<T, D, W>,
        count: usize,
        out: &mut Gradients<T, D, W>,
    ) {
        let mut fold = GradientFold::new(&Smaller, self.expected(), out);
        self.near_block(p, count, |member| fold.push(member, p, count));
        fold.finish();
    }
}

impl<const D: usize> Field<D> for Union<D> {
    fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    fn unplaced(&self) -> usize {
        self.members.iter().map(|member| member.field().unplaced()).sum()
    }

    fn placed(self: Arc<Self>, pose: &Pose<D>) -> Moved<D> {
        let Some(members) = placed_children(&self.members, pose) else { return Err(self) };
        let depth = Shape::deepest(&members) + 1;
        Shape::from_operator(Self::new(members, self.promise.placed(pose)), depth)
            .map_err(|_| self as _)
    }

    fn members(&self) -> Option<&[Shape<D>]> {
        Some(&self.members)
    }
}
