// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The sharp union of any number of members, with members out of reach skipped.
//! `union_cells` has its models.
//!
//! A member is skipped only where its value is sure to be larger than the
//! smallest, rounding included, so skipping changes no bit of the result.

use super::combine::{
    Combine, GradientFold, Minimum, ValueFold, leaves_on_tape, placed_children,
};
use super::nearby::Nearby;
use super::{Field, OwnModels, SharedField, depth_over};
use crate::bounds::BoundingBall;
use crate::error::ShapeError;
use crate::machine::{Block, Column, Gradients, Lane};
use crate::pose::Pose;
use crate::promise::Promise;
use crate::scalar::{Model, Recorded, Scalar, SpaceTimeModel};
use crate::vector::Vector;

/// The most members of a union on a tape. A tape evaluates all members; a larger union skips most
/// of them, so it is evaluated without a tape.
pub(crate) const FEW: usize = 16;

/// The most leaves below a union on a tape: unions of few members within unions may have very many.
const MOST_LEAVES: usize = 256;

/// Beyond this distance from the origin [m], squares of lengths near the limits of single
/// precision: every member is asked, as at a place that is no number.
pub(super) const FAR: f64 = 1e15;

/// The union of at least one member.
#[derive(Debug)]
pub(crate) struct Union<const D: usize> {
    pub(super) members: Vec<SharedField<D>>,
    /// `None` where evaluating all members is faster than searching.
    pub(super) nearby: Option<Nearby<D>>,
    slack: Slack,
    promise: Promise<D>,
    depth: usize,
    /// How many leaves its tape has; `None` if it is evaluated without a tape.
    leaves_on_tape: Option<usize>,
}

/// How far rounding may bring a member's value below the distance to its ball: that of
/// the balls, and of the members in single precision.
#[derive(Clone, Copy, Debug)]
struct Slack {
    constant: f64,
    per_metre: f64,
}

impl<const D: usize> Union<D> {
    /// The union of at least one member.
    ///
    /// # Errors
    ///
    /// If the members are nested too deeply.
    pub(crate) fn shared(
        mut members: Vec<SharedField<D>>,
        promise: Promise<D>,
    ) -> Result<SharedField<D>, ShapeError> {
        let depth = depth_over(&members)?;
        let nearby = Nearby::new(&mut members);
        let extent = members
            .iter()
            .filter_map(|m| m.promise().bounds.as_ref())
            .fold(0.0_f64, |far, bounds| Scalar::max(far, bounds.radius_about_origin()));
        // Rounding is given in double precision; single is 2²⁹ times coarser.
        let coarser = f64::from(f32::EPSILON) / f64::EPSILON;
        let rounding = promise.rounding.times(2.0 * coarser);
        let balls = 16.0 * f64::from(f32::EPSILON);
        let slack = Slack {
            constant: rounding.constant + balls * extent,
            per_metre: rounding.per_metre + balls,
        };
        let leaves = leaves_on_tape(&members);
        let is_on_tape = members.len() <= FEW && leaves <= MOST_LEAVES;
        let leaves_on_tape = is_on_tape.then_some(leaves);
        Ok(SharedField::new(Self { members, nearby, slack, promise, depth, leaves_on_tape }))
    }

    /// How far rounding may bring a value below the distance to its ball, so far from the
    /// origin [m].
    #[inline(always)]
    pub(super) fn slack(&self, from_origin: f64) -> f64 {
        self.slack.constant + self.slack.per_metre * from_origin
    }

    /// The number of members that a block is likely to evaluate.
    fn expected(&self) -> usize {
        if self.nearby.is_none() { self.members.len() } else { 1 }
    }

    /// Calls `near` with every member that may be the smallest somewhere in the
    /// ball, in their order.
    ///
    /// `value` gives an upper bound of a member's values in the ball; `near` may
    /// return a smaller bound.
    #[inline(always)]
    fn for_each_near(
        &self,
        nearby: &Nearby<D>,
        query: BoundingBall<D>,
        value: impl FnMut(usize) -> f64,
        near: impl FnMut(usize) -> f64,
    ) {
        let from_origin = query.centre.norm() + query.radius;
        if from_origin < FAR {
            let slack = self.slack(from_origin) + query.radius;
            nearby.for_each(Vector::of(&query.centre.0), slack, value, near);
        } else {
            self.each_of_all(near);
        }
    }

    /// Calls `near` for every member: of a place that is far or no number, nothing is known.
    #[cold]
    fn each_of_all(&self, mut near: impl FnMut(usize) -> f64) {
        for i in 0..self.members.len() {
            near(i);
        }
    }

    /// The smallest value at a point, and which member has it.
    #[inline(always)]
    pub(super) fn winner(&self, x: f64, y: f64, z: f64) -> (f64, usize) {
        let ask = |i: usize| self.members[i].distance(x, y, z);
        let Some(nearby) = &self.nearby else {
            // Selects, since which of two members is nearer is hard to predict.
            let (mut smallest, mut winner) = (ask(0), 0);
            for i in 1..self.members.len() {
                let value = ask(i);
                winner = if value < smallest { i } else { winner };
                smallest = Scalar::min(smallest, value);
            }
            return (smallest, winner);
        };
        let mut best: Option<(f64, usize)> = None;
        let centre = Vector::of_coordinates(x, y, z);
        let query = BoundingBall { centre, radius: 0.0 };
        let first = std::cell::Cell::new((usize::MAX, 0.0));
        let bound = |i| {
            let value = ask(i);
            first.set((i, value));
            value
        };
        self.for_each_near(nearby, query, bound, |i| {
            let known = first.get();
            let value = if known.0 == i { known.1 } else { ask(i) };
            if best.is_none_or(|(smallest, _)| value < smallest) {
                best = Some((value, i));
            }
            value
        });
        best.unwrap_or((f64::INFINITY, 0))
    }

    /// Calls `near` with the numbers of the members that matter in a block.
    pub(super) fn near_block<S: Lane>(
        &self,
        p: &Block<S, D>,
        count: usize,
        mut near: impl FnMut(usize),
    ) {
        let Some(nearby) = &self.nearby else {
            (0..self.members.len()).for_each(near);
            return;
        };
        let query = p.ball_around(count);
        self.for_each_near(
            nearby,
            query,
            |i| {
                let member = &self.members[i];
                let promise = member.promise();
                match promise.region {
                    None => {
                        let (x, y, z) = query.centre.coordinates();
                        member.distance(x, y, z) + promise.lipschitz * query.radius
                    }
                    Some(_) => f64::INFINITY,
                }
            },
            |i| {
                near(i);
                f64::INFINITY
            },
        );
    }
}

impl<const D: usize> Field<D> for Union<D> {
    fn distance(&self, x: f64, y: f64, z: f64) -> f64 {
        self.winner(x, y, z).0
    }

    /// All values first, then the gradient of the one member that is smallest.
    fn distance_gradient(&self, x: f64, y: f64, z: f64, gradient: &mut Vector<f64, D>) -> f64 {
        let (_, winner) = self.winner(x, y, z);
        self.members[winner].distance_gradient(x, y, z, gradient)
    }

    fn distances(&self, p: &Block<f64, D>, count: usize, out: &mut Column<f64>) {
        let mut fold = ValueFold::new(&Minimum, self.expected(), out);
        self.near_block(p, count, |i| fold.push(&self.members[i], p, count));
        fold.finish();
    }

    fn distances_gradients(
        &self,
        p: &Block<f64, D>,
        count: usize,
        out: &mut Gradients<f64, D>,
    ) {
        let mut fold = GradientFold::new(&Minimum, self.expected(), out);
        self.near_block(p, count, |i| fold.push(&self.members[i], p, count));
        fold.finish();
    }

    fn models(&self, p: &Block<Model, D>, count: usize, out: &mut Column<Model>) {
        self.bound(p, count, out);
    }

    fn record(&self, p: Vector<Recorded, D>) -> Option<Recorded> {
        let (first, others) = self.members.split_first()?;
        others.iter().try_fold(first.record(p)?, |least, member| {
            Some(Minimum.combine(least, member.record(p)?))
        })
    }

    fn has_formula(&self) -> bool {
        self.leaves_on_tape.is_some()
    }

    fn leaves_on_tape(&self) -> usize {
        self.leaves_on_tape.unwrap_or(1)
    }

    fn own_models(&self) -> Option<&dyn OwnModels<D>> {
        if self.leaves_on_tape.is_none() { Some(self) } else { None }
    }

    fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    fn depth(&self) -> usize {
        self.depth
    }

    fn unplaced(&self) -> usize {
        self.members.iter().map(|member| member.unplaced()).sum()
    }

    fn placed(&self, pose: &Pose<D>) -> Option<SharedField<D>> {
        let members = placed_children(&self.members, pose)?;
        Self::shared(members, self.promise.placed(pose)).ok()
    }

    fn members(&self) -> Option<&[SharedField<D>]> {
        Some(&self.members)
    }
}

impl<const D: usize> OwnModels<D> for Union<D> {
    fn models(&self, p: &Block<Model, D>, count: usize, out: &mut Column<Model>) {
        self.bound(p, count, out);
    }

    fn space_time_models(
        &self,
        p: &Block<SpaceTimeModel, D>,
        count: usize,
        out: &mut Column<SpaceTimeModel>,
    ) {
        self.bound(p, count, out);
    }
}
