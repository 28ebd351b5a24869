// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fields that change their child's answer at the same point: offset, shell, guard.

use std::fmt::Debug;
use std::sync::Arc;

use super::{
    DifferentiateBlock, EvaluateBlock, EvaluatePoint, Field, Moved, RecordFormula, SharedField,
    depth_over,
};
use crate::error::ShapeError;
use crate::machine::{Block, Column, Gradients, Job, Lane, run};
use crate::pose::Pose;
use crate::promise::Promise;
use crate::scalar::{Dual, Float, Recorded, Scalar};
use crate::vector::Vector;

/// A function of the point and the child's answer there.
pub(crate) trait Remap<const D: usize>: Debug + Send + Sync + 'static {
    /// The node's answer from the child's.
    fn value<S: Scalar>(&self, p: Vector<S, D>, child: S) -> S;
}

/// A child whose answers go through a [`Remap`].
#[derive(Debug)]
pub(crate) struct Remapped<M, const D: usize> {
    map: M,
    child: SharedField<D>,
    promise: Promise<D>,
    depth: usize,
}

impl<M: Remap<D>, const D: usize> Remapped<M, D> {
    /// The `child` with its answers mapped.
    ///
    /// # Errors
    ///
    /// If the child is nested too deeply.
    pub(crate) fn shared(
        map: M,
        child: SharedField<D>,
        promise: Promise<D>,
    ) -> Result<SharedField<D>, ShapeError> {
        let depth = depth_over([&child])?;
        Ok(Arc::new(Self { map, child, promise, depth }))
    }
}

#[inline(always)]
fn differentiate<T: Float, M: Remap<D>, const D: usize>(
    map: &M,
    p: Vector<T, D>,
    child: T,
    gradient: Vector<T, D>,
) -> (T, Vector<T, D>) {
    let child = Dual { value: child, gradient: gradient.0 };
    let result = map.value(Vector(Dual::variables(p.0)), child);
    (result.value, Vector(result.gradient))
}

struct Values<'a, M>(&'a M);

impl<S: Lane, M: Remap<D>, const D: usize> Job<Vector<S, D>, S, S> for Values<'_, M> {
    #[inline(always)]
    fn lane(&self, p: Vector<S, D>, child: S) -> S {
        self.0.value(p, child)
    }
}

struct ValuesAndGradients<'a, M>(&'a M);

impl<T: Float, M: Remap<D>, const D: usize>
    Job<Vector<T, D>, (T, Vector<T, D>), (T, Vector<T, D>)> for ValuesAndGradients<'_, M>
{
    #[inline(always)]
    fn lane(&self, p: Vector<T, D>, (child, gradient): (T, Vector<T, D>)) -> (T, Vector<T, D>) {
        differentiate(self.0, p, child, gradient)
    }
}

impl<T: Float, M: Remap<D>, const D: usize> EvaluatePoint<T, D> for Remapped<M, D>
where
    dyn Field<D>: EvaluatePoint<T, D>,
{
    fn distance(&self, x: T, y: T, z: T) -> T {
        let p = Vector::of_coordinates(x, y, z);
        self.map.value(p, self.child.distance(x, y, z))
    }

    fn distance_gradient(&self, x: T, y: T, z: T, gradient: &mut Vector<T, D>) -> T {
        let p = Vector::of_coordinates(x, y, z);
        let child = self.child.distance_gradient(x, y, z, gradient);
        let distance;
        (distance, *gradient) = differentiate(&self.map, p, child, *gradient);
        distance
    }
}

impl<S: Lane, M: Remap<D>, const D: usize, const W: usize> EvaluateBlock<S, D, W>
    for Remapped<M, D>
where
    dyn Field<D>: EvaluateBlock<S, D, W>,
{
    fn distances(&self, p: &Block<S, D, W>, count: usize, out: &mut Column<S, W>) {
        let mut child = Column::scratch();
        self.child.distances(p, count, &mut child);
        run(&Values(&self.map), p, &child, count, out);
    }
}

impl<T: Float + Lane, M: Remap<D>, const D: usize, const W: usize> DifferentiateBlock<T, D, W>
    for Remapped<M, D>
where
    dyn Field<D>: DifferentiateBlock<T, D, W>,
{
    fn distances_gradients(
        &self,
        p: &Block<T, D, W>,
        count: usize,
        out: &mut Gradients<T, D, W>,
    ) {
        let mut child = Gradients::scratch();
        self.child.distances_gradients(p, count, &mut child);
        run(&ValuesAndGradients(&self.map), p, &child, count, out);
    }
}

impl<T: Float, M: Remap<D>, const D: usize> RecordFormula<T, D> for Remapped<M, D>
where
    dyn Field<D>: RecordFormula<T, D>,
{
    fn record(&self, p: Vector<Recorded<T>, D>) -> Option<Recorded<T>> {
        Some(self.map.value(p, self.child.record(p)?))
    }
}

impl<M: Remap<D>, const D: usize> Field<D> for Remapped<M, D> {
    fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    fn depth(&self) -> usize {
        self.depth
    }

    fn placed(self: Arc<Self>, _pose: &Pose<D>) -> Moved<D> {
        Err(self)
    }
}
