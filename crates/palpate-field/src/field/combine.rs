// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fields that fold an operation over their children's answers.

use std::fmt::Debug;
use std::sync::Arc;

use super::{
    DifferentiateBlock, EvaluateBlock, EvaluatePoint, Field, Moved, RecordFormula, SharedField,
    depth_over, placed,
};
use crate::error::ShapeError;
use crate::machine::{Block, Column, Gradients, Job, Lane, run};
use crate::pose::Pose;
use crate::promise::Promise;
use crate::scalar::{Dual, Float, Recorded, Scalar};
use crate::vector::Vector;

/// An operation on two answers.
pub(crate) trait Combine: Debug + Send + Sync + 'static {
    /// The answer for `a` and `b`.
    fn combine<S: Scalar>(&self, a: S, b: S) -> S;
}

/// Union: `min(a, b)`.
#[derive(Clone, Debug)]
pub(crate) struct Minimum;

impl Combine for Minimum {
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
        Ok(Arc::new(Self { operation, children, promise, depth }))
    }
}

#[inline(always)]
fn differentiate<T: Float, O: Combine, const D: usize>(
    operation: &O,
    a: Dual<T, D>,
    b: Dual<T, D>,
) -> (T, Vector<T, D>) {
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

impl<T: Float, O: Combine, const D: usize>
    Job<(T, Vector<T, D>), (T, Vector<T, D>), (T, Vector<T, D>)> for ValuesAndGradients<'_, O>
{
    #[inline(always)]
    fn lane(&self, a: (T, Vector<T, D>), b: (T, Vector<T, D>)) -> (T, Vector<T, D>) {
        let dual = |(value, gradient): (T, Vector<T, D>)| Dual { value, gradient: gradient.0 };
        differentiate(self.0, dual(a), dual(b))
    }
}

impl<T: Float, O: Combine, const D: usize> EvaluatePoint<T, D> for Combined<O, D>
where
    dyn Field<D>: EvaluatePoint<T, D>,
{
    fn distance(&self, x: T, y: T, z: T) -> T {
        let mut distance = self.children[0].distance(x, y, z);
        for child in &self.children[1..] {
            distance = self.operation.combine(distance, child.distance(x, y, z));
        }
        distance
    }

    fn distance_gradient(&self, x: T, y: T, z: T, gradient: &mut Vector<T, D>) -> T {
        let mut distance = self.children[0].distance_gradient(x, y, z, gradient);
        let mut other = Vector([T::constant(0.0); D]);
        for child in &self.children[1..] {
            let value = child.distance_gradient(x, y, z, &mut other);
            (distance, *gradient) = differentiate(
                &self.operation,
                Dual { value: distance, gradient: gradient.0 },
                Dual { value, gradient: other.0 },
            );
        }
        distance
    }
}

/// Folds an operation over the blocks of children, one after the other.
///
/// The results alternate between the output and a scratch block: a select that
/// writes where it reads becomes a masked store, which is microcoded on some
/// machines.
pub(super) struct ValueFold<'a, S: Lane, O, const W: usize> {
    operation: &'a O,
    out: &'a mut Column<S, W>,
    scratch: Column<S, W>,
    next: Column<S, W>,
    empty: bool,
    /// The result so far is in `out`, else in `scratch`.
    in_out: bool,
}

impl<'a, S: Lane, O: Combine, const W: usize> ValueFold<'a, S, O, W> {
    /// For `expected` children; if there are others, the result may have to be
    /// copied.
    pub(super) fn new(operation: &'a O, expected: usize, out: &'a mut Column<S, W>) -> Self {
        let in_out = expected % 2 == 1;
        let (scratch, next) = (Column::scratch(), Column::scratch());
        Self { operation, out, scratch, next, empty: true, in_out }
    }

    pub(super) fn push<const D: usize>(
        &mut self,
        child: &SharedField<D>,
        p: &Block<S, D, W>,
        count: usize,
    ) where
        dyn Field<D>: EvaluateBlock<S, D, W>,
    {
        if self.empty {
            let first = if self.in_out { &mut *self.out } else { &mut self.scratch };
            child.distances(p, count, first);
            self.empty = false;
        } else {
            child.distances(p, count, &mut self.next);
            let job = Values(self.operation);
            if self.in_out {
                run(&job, &*self.out, &self.next, count, &mut self.scratch);
            } else {
                run(&job, &self.scratch, &self.next, count, self.out);
            }
            self.in_out = !self.in_out;
        }
    }

    pub(super) fn finish(self) {
        if !self.in_out {
            self.out.clone_from(&self.scratch);
        }
    }
}

/// The same with gradients.
pub(super) struct GradientFold<'a, T: Float + Lane, O, const D: usize, const W: usize> {
    operation: &'a O,
    out: &'a mut Gradients<T, D, W>,
    scratch: Gradients<T, D, W>,
    next: Gradients<T, D, W>,
    empty: bool,
    /// The result so far is in `out`, else in `scratch`.
    in_out: bool,
}

impl<'a, T: Float + Lane, O: Combine, const D: usize, const W: usize>
    GradientFold<'a, T, O, D, W>
where
    dyn Field<D>: DifferentiateBlock<T, D, W>,
{
    pub(super) fn new(
        operation: &'a O,
        expected: usize,
        out: &'a mut Gradients<T, D, W>,
    ) -> Self {
        let in_out = expected % 2 == 1;
        let (scratch, next) = (Gradients::scratch(), Gradients::scratch());
        Self { operation, out, scratch, next, empty: true, in_out }
    }

    pub(super) fn push(&mut self, child: &SharedField<D>, p: &Block<T, D, W>, count: usize) {
        if self.empty {
            let first = if self.in_out { &mut *self.out } else { &mut self.scratch };
            child.distances_gradients(p, count, first);
            self.empty = false;
        } else {
            child.distances_gradients(p, count, &mut self.next);
            let job = ValuesAndGradients(self.operation);
            if self.in_out {
                run(&job, &*self.out, &self.next, count, &mut self.scratch);
            } else {
                run(&job, &self.scratch, &self.next, count, self.out);
            }
            self.in_out = !self.in_out;
        }
    }

    pub(super) fn finish(self) {
        if !self.in_out {
            self.out.clone_from(&self.scratch);
        }
    }
}

impl<S: Lane, O: Combine, const D: usize, const W: usize> EvaluateBlock<S, D, W>
    for Combined<O, D>
where
    dyn Field<D>: EvaluateBlock<S, D, W>,
{
    fn distances(&self, p: &Block<S, D, W>, count: usize, out: &mut Column<S, W>) {
        let mut fold = ValueFold::new(&self.operation, self.children.len(), out);
        self.children.iter().for_each(|child| fold.push(child, p, count));
        fold.finish();
    }
}

impl<T: Float + Lane, O: Combine, const D: usize, const W: usize> DifferentiateBlock<T, D, W>
    for Combined<O, D>
where
    dyn Field<D>: DifferentiateBlock<T, D, W>,
{
    fn distances_gradients(
        &self,
        p: &Block<T, D, W>,
        count: usize,
        out: &mut Gradients<T, D, W>,
    ) {
        let mut fold = GradientFold::new(&self.operation, self.children.len(), out);
        self.children.iter().for_each(|child| fold.push(child, p, count));
        fold.finish();
    }
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

impl<T: Float, O: Combine, const D: usize> RecordFormula<T, D> for Combined<O, D>
where
    dyn Field<D>: RecordFormula<T, D>,
{
    fn record(&self, p: Vector<Recorded<T>, D>) -> Option<Recorded<T>> {
        let (first, others) = self.children.split_first()?;
        let mut distance = first.record(p)?;
        for child in others {
            distance = self.operation.combine(distance, child.record(p)?);
        }
        Some(distance)
    }
}

impl<O: Combine + Clone, const D: usize> Field<D> for Combined<O, D> {
    fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    fn depth(&self) -> usize {
        self.depth
    }

    fn unplaced(&self) -> usize {
        self.children.iter().map(|child| child.unplaced()).sum()
    }

    fn placed(self: Arc<Self>, pose: &Pose<D>) -> Moved<D> {
        let Some(children) = placed_children(&self.children, pose) else { return Err(self) };
        let promise = self.promise.placed(pose);
        Self::shared(self.operation.clone(), children, promise).map_err(|_| self as _)
    }
}
