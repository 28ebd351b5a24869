// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fields that fold an operation over their children's answers.

use std::fmt::Debug;

use super::{Evaluate, Field, SharedField, depth_over, placed};
use crate::error::ShapeError;
use crate::machine::{Block, Column, Gradients, Job, Lane, run, run_wide};
use crate::pose::Pose;
use crate::promise::Promise;
use crate::scalar::{Dual, Model, Recorded, Scalar};
use crate::vector::Vector;

/// An operation on two answers.
pub(crate) trait Combine: Debug + Send + Sync + 'static {
    /// `true` if its loops are also compiled for machines without AVX2.
    const IS_EVERYWHERE: bool = false;

    /// The answer for `a` and `b`.
    fn combine<S: Scalar>(&self, a: S, b: S) -> S;
}

/// Union: `min(a, b)`.
#[derive(Clone, Debug)]
pub(crate) struct Minimum;

impl Combine for Minimum {
    // A union of many members has no tape, so its loops must run on every machine.
    const IS_EVERYWHERE: bool = true;

    #[inline(always)]
    fn combine<S: Scalar>(&self, a: S, b: S) -> S {
        a.min(b)
    }
}

/// `((c₀ ∘ c₁) ∘ c₂) ∘ …` over at least one child.
#[derive(Debug)]
pub(crate) struct Combined<O, const D: usize> {
    operation: O,
    children: Vec<SharedField<D>>,
    promise: Promise<D>,
    depth: usize,
    leaves_on_tape: usize,
}

impl<O: Combine + Clone, const D: usize> Combined<O, D> {
    /// The operation over at least one child.
    ///
    /// # Errors
    ///
    /// If the children are nested too deeply.
    pub(crate) fn shared(
        operation: O,
        children: Vec<SharedField<D>>,
        promise: Promise<D>,
    ) -> Result<SharedField<D>, ShapeError> {
        let depth = depth_over(&children)?;
        let leaves_on_tape = leaves_on_tape(&children);
        Ok(SharedField::new(Self { operation, children, promise, depth, leaves_on_tape }))
    }
}

#[inline(always)]
fn differentiate<O: Combine, const D: usize>(
    operation: &O,
    (a, by_a): (f64, Vector<f64, D>),
    (b, by_b): (f64, Vector<f64, D>),
) -> (f64, Vector<f64, D>) {
    let a = Dual { value: a, gradient: by_a.0 };
    let b = Dual { value: b, gradient: by_b.0 };
    let result = operation.combine(a, b);
    (result.value, Vector(result.gradient))
}

struct Values<'a, O>(&'a O);

impl<S: Lane, O: Combine> Job<S, S, S> for Values<'_, O> {
    #[inline(always)]
    fn lane(&self, a: S, b: S) -> S {
        self.0.combine(a, b)
    }
}

struct ValuesAndGradients<'a, O>(&'a O);

impl<O: Combine, const D: usize>
    Job<(f64, Vector<f64, D>), (f64, Vector<f64, D>), (f64, Vector<f64, D>)>
    for ValuesAndGradients<'_, O>
{
    #[inline(always)]
    fn lane(
        &self,
        a: (f64, Vector<f64, D>),
        b: (f64, Vector<f64, D>),
    ) -> (f64, Vector<f64, D>) {
        differentiate(self.0, a, b)
    }
}

/// Folds an operation over the blocks of children, one after the other.
///
/// The results alternate between the output and a scratch block: a select that
/// writes where it reads becomes a masked store, which is microcoded on some
/// machines.
pub(super) struct ValueFold<'a, S: Lane, O> {
    operation: &'a O,
    out: &'a mut Column<S>,
    scratch: Column<S>,
    next: Column<S>,
    empty: bool,
    /// The result so far is in `out`, else in `scratch`.
    in_out: bool,
}

impl<'a, S: Evaluate, O: Combine> ValueFold<'a, S, O> {
    /// For `expected` children; if there are others, the result may have to be
    /// copied.
    #[inline(always)]
    pub(super) fn new(operation: &'a O, expected: usize, out: &'a mut Column<S>) -> Self {
        let in_out = expected % 2 == 1;
        let (scratch, next) = (Column::scratch(), Column::scratch());
        Self { operation, out, scratch, next, empty: true, in_out }
    }

    pub(super) fn push<const D: usize>(
        &mut self,
        child: &SharedField<D>,
        p: &Block<S, D>,
        count: usize,
    ) {
        if self.empty {
            let first = if self.in_out { &mut *self.out } else { &mut self.scratch };
            child.evaluate(p, count, first);
            self.empty = false;
            return;
        }
        child.evaluate(p, count, &mut self.next);
        let (from, to) = if self.in_out {
            (&*self.out, &mut self.scratch)
        } else {
            (&self.scratch, &mut *self.out)
        };
        let job = Values(self.operation);
        if const { O::IS_EVERYWHERE } {
            run(&job, from, &self.next, count, to);
        } else {
            run_wide(&job, from, &self.next, count, to);
        }
        self.in_out = !self.in_out;
    }

    pub(super) fn finish(&mut self) {
        if !self.in_out {
            self.out.copy_from(&self.scratch);
        }
    }
}

/// The same with gradients.
pub(super) struct GradientFold<'a, O, const D: usize> {
    operation: &'a O,
    out: &'a mut Gradients<f64, D>,
    scratch: Gradients<f64, D>,
    next: Gradients<f64, D>,
    empty: bool,
    /// The result so far is in `out`, else in `scratch`.
    in_out: bool,
}

impl<'a, O: Combine, const D: usize> GradientFold<'a, O, D> {
    #[inline(always)]
    pub(super) fn new(
        operation: &'a O,
        expected: usize,
        out: &'a mut Gradients<f64, D>,
    ) -> Self {
        let in_out = expected % 2 == 1;
        let (scratch, next) = (Gradients::scratch(), Gradients::scratch());
        Self { operation, out, scratch, next, empty: true, in_out }
    }

    pub(super) fn push(&mut self, child: &SharedField<D>, p: &Block<f64, D>, count: usize) {
        if self.empty {
            let first = if self.in_out { &mut *self.out } else { &mut self.scratch };
            child.gradients(p, count, first);
            self.empty = false;
            return;
        }
        child.gradients(p, count, &mut self.next);
        let (from, to) = if self.in_out {
            (&*self.out, &mut self.scratch)
        } else {
            (&self.scratch, &mut *self.out)
        };
        let job = ValuesAndGradients(self.operation);
        if const { O::IS_EVERYWHERE } {
            run(&job, from, &self.next, count, to);
        } else {
            run_wide(&job, from, &self.next, count, to);
        }
        self.in_out = !self.in_out;
    }

    pub(super) fn finish(&mut self) {
        if !self.in_out {
            self.out.copy_from(&self.scratch);
        }
    }
}

/// How many leaves the tapes of these have together.
pub(super) fn leaves_on_tape<const D: usize>(children: &[SharedField<D>]) -> usize {
    children.iter().fold(0, |sum, child| sum.saturating_add(child.leaves_on_tape()))
}

/// The children moved by `pose`, if a motion may go into their operator.
pub(super) fn placed_children<const D: usize>(
    children: &[SharedField<D>],
    pose: &Pose<D>,
) -> Option<Vec<SharedField<D>>> {
    let unplaced: usize = children.iter().map(|child| child.unplaced()).sum();
    if unplaced > 1 {
        return None;
    }
    children.iter().map(|child| placed(child, pose).ok()).collect()
}

impl<O: Combine + Clone, const D: usize> Combined<O, D> {
    fn fold<S: Evaluate>(&self, p: &Block<S, D>, count: usize, out: &mut Column<S>) {
        let mut fold = ValueFold::new(&self.operation, self.children.len(), out);
        self.children.iter().for_each(|child| fold.push(child, p, count));
        fold.finish();
    }
}

impl<O: Combine + Clone, const D: usize> Field<D> for Combined<O, D> {
    fn distance(&self, x: f64, y: f64, z: f64) -> f64 {
        let mut distance = self.children[0].distance(x, y, z);
        for child in &self.children[1..] {
            distance = self.operation.combine(distance, child.distance(x, y, z));
        }
        distance
    }

    fn distance_gradient(&self, x: f64, y: f64, z: f64, gradient: &mut Vector<f64, D>) -> f64 {
        let mut distance = self.children[0].distance_gradient(x, y, z, gradient);
        let mut other = Vector::ZERO;
        for child in &self.children[1..] {
            let value = child.distance_gradient(x, y, z, &mut other);
            (distance, *gradient) =
                differentiate(&self.operation, (distance, *gradient), (value, other));
        }
        distance
    }

    fn distances(&self, p: &Block<f64, D>, count: usize, out: &mut Column<f64>) {
        self.fold(p, count, out);
    }

    fn distances_gradients(
        &self,
        p: &Block<f64, D>,
        count: usize,
        out: &mut Gradients<f64, D>,
    ) {
        let mut fold = GradientFold::new(&self.operation, self.children.len(), out);
        self.children.iter().for_each(|child| fold.push(child, p, count));
        fold.finish();
    }

    fn models(&self, p: &Block<Model, D>, count: usize, out: &mut Column<Model>) {
        self.fold(p, count, out);
    }

    fn record(&self, p: Vector<Recorded, D>) -> Option<Recorded> {
        let (first, others) = self.children.split_first()?;
        let mut distance = first.record(p)?;
        for child in others {
            distance = self.operation.combine(distance, child.record(p)?);
        }
        Some(distance)
    }

    fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    fn depth(&self) -> usize {
        self.depth
    }

    fn unplaced(&self) -> usize {
        self.children.iter().map(|child| child.unplaced()).sum()
    }

    fn leaves_on_tape(&self) -> usize {
        self.leaves_on_tape
    }

    fn placed(&self, pose: &Pose<D>) -> Option<SharedField<D>> {
        let children = placed_children(&self.children, pose)?;
        Self::shared(self.operation.clone(), children, self.promise.placed(pose)).ok()
    }
}
