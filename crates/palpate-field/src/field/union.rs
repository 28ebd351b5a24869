// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Unions of many members, found by cells.
//!
//! The sharp union of any number of members, with members out of reach skipped.
//! `union_cells` has its models.
//!
//! A member is skipped only where its value is sure to be larger than the
//! smallest, rounding included, so skipping changes no bit of the result.
//!
//! Models of a union: each cell asks only the members that may be the smallest in it.
//!
//! A block whose cells are close together asks the members near all of them, as a block of
//! points does. Cells far apart, or large ones, ask each for itself.
//!
//! # Which members a cell asks
//!
//! First the member that is smallest at the cell's centre: of its model, the union's keeps
//! value, slope and upper remainder, whatever the others are. Another member only lowers the
//! lower plane, and only if it is somewhere below. It is sure not to be if the signed distance
//! to its ball is not: that is convex, so its tangent plane at the centre is a lower bound. Such
//! a member is skipped, so that the model encloses the union all the same, and is not wider than
//! if it had been asked.
//!
//! In a large cell many members are below the lower plane of the first. The one that is
//! farthest below is asked next, for once it has lowered the plane, most others are above.

use super::combine::{
    Combine, GradientFold, Minimum, ValueFold, leaves_on_tape, placed_children,
};
use super::nearby::{Balls, Floor, Foremost, LINE, Nearby};
use super::{Evaluate, Field, OwnModels, SharedField, depth_over};
use crate::bounds::BoundingBall;
use crate::error::ShapeError;
use crate::machine::{BLOCK, Block, Column, Gradients, Lane};
use crate::pose::Pose;
use crate::promise::Promise;
use crate::scalar::{AffineModel, Model, Recorded, Scalar, SpaceTimeModel};
use crate::vector::{Vector, array};

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

/// Roundings in single precision of the clearance of a ball, relative to the largest number
/// in it.
const ROUNDINGS: f64 = 64.0;

/// What the union's slack is multiplied with for the clearance: more operations than those of
/// the distance to a ball.
const SLACKS: f64 = 4.0;

impl<const D: usize> Union<D> {
    /// Models of the union.
    pub(super) fn bound<const N: usize>(
        &self,
        p: &Block<AffineModel<N>, D>,
        count: usize,
        out: &mut Column<AffineModel<N>>,
    ) where
        AffineModel<N>: Evaluate,
    {
        // With few members, asking all takes less time than finding out which cell needs which.
        let (mut near, mut many) = ([0; FEW], 0);
        self.near_block(p, count, |i| {
            if let Some(place) = near.get_mut(many) {
                *place = i;
            }
            many += 1;
        });
        match &self.nearby {
            Some(nearby) if many > FEW => {
                let first = [[0; 2]; BLOCK];
                Cells { union: self, nearby, p, count, out, first }.bound();
            }
            _ => self.ask_all(&near[..many], p, count, out),
        }
    }

    /// All cells ask the same members. Not inlined, so that the other branch does not reserve its
    /// stack memory.
    #[inline(never)]
    fn ask_all<const N: usize>(
        &self,
        members: &[usize],
        p: &Block<AffineModel<N>, D>,
        count: usize,
        out: &mut Column<AffineModel<N>>,
    ) where
        AffineModel<N>: Evaluate,
    {
        let mut fold = ValueFold::new(&Minimum, members.len(), out);
        for i in members {
            fold.push(&self.members[*i], p, count);
        }
        fold.finish();
    }
}

/// Cells that ask each for itself.
struct Cells<'a, const N: usize, const D: usize> {
    union: &'a Union<D>,
    nearby: &'a Nearby<D>,
    p: &'a Block<AffineModel<N>, D>,
    count: usize,
    out: &'a mut Column<AffineModel<N>>,
    /// The members that each cell asks first; twice the same if it is one.
    first: [[usize; 2]; BLOCK],
}

/// The places of the bits that are set.
fn ones(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let next = (bits != 0).then(|| bits.trailing_zeros() as usize)?;
        bits &= bits - 1;
        Some(next)
    })
}

impl<const N: usize, const D: usize> Cells<'_, N, D>
where
    AffineModel<N>: Evaluate,
{
    fn bound(mut self) {
        const { assert!(BLOCK <= u64::BITS as usize, "a bit for each cell") };
        for i in 0..self.count {
            let (x, y, z) = self.centre(i).coordinates();
            self.first[i] = [self.union.winner(x, y, z).1; 2];
        }
        self.out.fill(self.count, |_| AffineModel::constant(0.0));
        self.ask_first(self.all(), 0, |_, model| model);
        // The cells that are not done.
        let mut left = self.all();
        let mut found = 0;
        for i in 0..self.count {
            match self.nearby.foremost(&self.floor(i), self.first[i][0]) {
                Foremost::Member(member) => {
                    self.first[i][1] = member;
                    found |= 1 << i;
                }
                Foremost::AllClear => left &= !(1 << i),
                Foremost::Unknown => {}
            }
        }
        self.ask_first(found, 1, Scalar::min);
        self.ask_others(left);
    }

    /// All cells, one bit each.
    fn all(&self) -> u64 {
        u64::MAX.checked_shr(u64::BITS - self.count as u32).unwrap_or(0)
    }

    #[inline(always)]
    fn centre(&self, i: usize) -> Vector<f64, D> {
        let cell = self.p.get(i);
        Vector(array!(k < D => cell.0[k].value))
    }

    /// What balls are compared with in cell `i`.
    fn floor(&self, i: usize) -> Floor<D, N> {
        let (cell, model) = (self.p.get(i), self.out.get(i));
        let from_origin = self.centre(i).norm() + AffineModel::radius(&cell.0);
        let largest = from_origin + model.value.abs() + model.deviation();
        // By as much a point may be off the affine image of its parameters.
        let off = cell.0.iter().fold(0.0, |sum, x| sum + Scalar::max(x.lower, x.upper));
        let slack = SLACKS * self.union.slack(from_origin)
            + ROUNDINGS * f64::from(f32::EPSILON) * largest
            + off;
        // Of a place that is far or no number, nothing is known.
        let slack = if from_origin < FAR { slack } else { f64::INFINITY };
        Floor {
            centre: Vector::of(&self.centre(i).0),
            sides: std::array::from_fn(|k| {
                Vector(array!(j < D => cell.0[j].gradient[k] as f32))
            }),
            value: model.value as f32,
            gradient: model.gradient.map(|side| side as f32),
            lower: model.lower as f32,
            slack: slack as f32,
        }
    }

    /// Asks the first members of the cells `left`, or the second.
    fn ask_first(
        &mut self,
        mut left: u64,
        which: usize,
        join: fn(AffineModel<N>, AffineModel<N>) -> AffineModel<N>,
    ) {
        while left != 0 {
            let member = self.first[left.trailing_zeros() as usize][which];
            let alike = ones(left).filter(|i| self.first[*i][which] == member);
            let lanes = alike.fold(0, |lanes, i| lanes | 1 << i);
            left &= !lanes;
            self.ask(member, lanes, join);
        }
    }

    /// Asks all members that are in the way of the cells `left`.
    fn ask_others(&mut self, left: u64) {
        match self.nearby {
            Nearby::Flat(balls) => self.ask_those_of(balls, left, 0),
            Nearby::Lines { around, lines } => {
                let blocks = around.iter().zip(lines.chunks(BLOCK)).enumerate();
                for (block, (around, lines)) in blocks {
                    let cells = self.needing(around, left);
                    for (i, line) in lines.iter().enumerate().filter(|(i, _)| cells[*i] != 0) {
                        self.ask_those_of(line, cells[i], (block * BLOCK + i) * LINE);
                    }
                }
            }
        }
    }

    /// Of the `cells`, those that each ball is in the way of.
    fn needing<const B: usize>(&self, balls: &Balls<D, B>, cells: u64) -> [u64; B] {
        let mut of_ball = [0; B];
        for i in ones(cells) {
            for ball in ones(balls.in_the_way_of(&self.floor(i))) {
                of_ball[ball] |= 1 << i;
            }
        }
        of_ball
    }

    /// Asks the members from number `first` on, whose `balls` are in the way.
    fn ask_those_of<const B: usize>(&mut self, balls: &Balls<D, B>, cells: u64, first: usize) {
        for (i, cells) in self.needing(balls, cells).into_iter().enumerate() {
            let member = first + i;
            let unasked = ones(cells).filter(|cell| !self.first[*cell].contains(&member));
            let cells = unasked.fold(0, |cells, cell| cells | 1 << cell);
            if cells != 0 {
                self.ask(member, cells, Scalar::min);
            }
        }
    }

    /// Joins the model of a member with those of some cells.
    #[inline(never)]
    fn ask(
        &mut self,
        member: usize,
        cells: u64,
        join: fn(AffineModel<N>, AffineModel<N>) -> AffineModel<N>,
    ) {
        let member = &self.union.members[member];
        let (mut lanes, mut count) = ([0_u8; BLOCK], 0);
        for cell in ones(cells) {
            lanes[count] = cell as u8;
            count += 1;
        }
        let mut models = Column::scratch();
        if count == self.count {
            member.evaluate(self.p, count, &mut models);
        } else {
            let mut cells = Block::scratch();
            cells.gather(self.p, &lanes[..count]);
            member.evaluate(&cells, count, &mut models);
        }
        self.out.join(&lanes[..count], &models, join);
    }
}
