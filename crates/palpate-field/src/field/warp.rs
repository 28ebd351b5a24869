// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fields that evaluate their child at another point: transforms, mirrors, extrusion.

use super::{
    DifferentiateBlock, EvaluateBlock, EvaluatePoint, Field, Moved, RecordFormula, SharedField,
    depth_over,
};
use crate::error::ShapeError;
use crate::machine::{Block, Column, Gradients, Job, Lane, run};
use crate::pose::Pose;
use crate::promise::Promise;
use crate::scalar::{Dual, Float, Recorded, Scalar};
use crate::vector::{Vector, unrolled};
use std::fmt::Debug;
use std::sync::Arc;

/// A map from the node's `D` coordinates to its child's `E`.
pub(crate) trait Warp<const D: usize, const E: usize>:
    Debug + Send + Sync + 'static
{
    /// `true` for rigid motions, which take another motion into themselves.
    const IS_MOTION: bool = false;

    /// The point at which the child is evaluated.
    fn point<S: Scalar>(&self, p: Vector<S, D>) -> Vector<S, E>;

    /// The node's answer from the child's.
    #[inline(always)]
    fn value<S: Scalar>(&self, _p: Vector<S, D>, child: S) -> S {
        child
    }

    /// The same map for a node moved by `pose`, if it is a motion itself.
    fn placed(&self, _pose: &Pose<D>) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }

    /// The node's answer and gradient from the child's: by duals, unless the map has
    /// something cheaper.
    #[inline(always)]
    fn gradient<T: Float>(
        &self,
        p: Vector<T, D>,
        child: T,
        child_gradient: Vector<T, E>,
    ) -> (T, Vector<T, D>) {
        let variables = Vector(Dual::variables(p.0));
        let moved = self.point(variables);
        let mut gradient = [T::constant(0.0); D];
        for (slope, coordinate) in child_gradient.0.iter().zip(moved.0) {
            unrolled!(k < D => gradient[k] = gradient[k] + *slope * coordinate.gradient[k]);
        }
        let result = self.value(variables, Dual { value: child, gradient });
        (result.value, Vector(result.gradient))
    }
}

/// A child seen through a [`Warp`].
#[derive(Debug)]
pub(crate) struct Warped<M, const D: usize, const E: usize> {
    map: M,
    child: SharedField<E>,
    promise: Promise<D>,
    depth: usize,
}

impl<M: Warp<D, E>, const D: usize, const E: usize> Warped<M, D, E> {
    /// The `child` seen through `map`.
    ///
    /// # Errors
    ///
    /// If the child is nested too deeply.
    pub(crate) fn shared(
        map: M,
        child: SharedField<E>,
        promise: Promise<D>,
    ) -> Result<SharedField<D>, ShapeError> {
        let depth = depth_over([&child])?;
        Ok(Arc::new(Self { map, child, promise, depth }))
    }
}

struct Points<'a, M>(&'a M);

impl<S: Lane, M: Warp<D, E>, const D: usize, const E: usize> Job<Vector<S, D>, (), Vector<S, E>>
    for Points<'_, M>
{
    #[inline(always)]
    fn lane(&self, p: Vector<S, D>, (): ()) -> Vector<S, E> {
        self.0.point(p)
    }
}

struct Values<'a, M, const E: usize>(&'a M);

impl<S: Lane, M: Warp<D, E>, const D: usize, const E: usize> Job<Vector<S, D>, S, S>
    for Values<'_, M, E>
{
    #[inline(always)]
    fn lane(&self, p: Vector<S, D>, child: S) -> S {
        self.0.value(p, child)
    }
}

struct PulledBack<'a, M>(&'a M);

impl<T, M, const D: usize, const E: usize>
    Job<Vector<T, D>, (T, Vector<T, E>), (T, Vector<T, D>)> for PulledBack<'_, M>
where
    T: Float + Lane,
    M: Warp<D, E>,
{
    #[inline(always)]
    fn lane(&self, p: Vector<T, D>, (child, gradient): (T, Vector<T, E>)) -> (T, Vector<T, D>) {
        self.0.gradient(p, child, gradient)
    }
}

impl<T, M, const D: usize, const E: usize> EvaluatePoint<T, D> for Warped<M, D, E>
where
    T: Float,
    M: Warp<D, E>,
    dyn Field<E>: EvaluatePoint<T, E>,
{
    fn distance(&self, x: T, y: T, z: T) -> T {
        let p = Vector::of_coordinates(x, y, z);
        let (u, v, w) = self.map.point(p).coordinates();
        self.map.value(p, self.child.distance(u, v, w))
    }

    fn distance_gradient(&self, x: T, y: T, z: T, gradient: &mut Vector<T, D>) -> T {
        let p = Vector::of_coordinates(x, y, z);
        let (u, v, w) = self.map.point(p).coordinates();
        let mut child_gradient = Vector([T::constant(0.0); E]);
        let child = self.child.distance_gradient(u, v, w, &mut child_gradient);
        let distance;
        (distance, *gradient) = self.map.gradient(p, child, child_gradient);
        distance
    }
}

impl<S, M, const D: usize, const E: usize, const W: usize> EvaluateBlock<S, D, W>
    for Warped<M, D, E>
where
    S: Lane,
    M: Warp<D, E>,
    dyn Field<E>: EvaluateBlock<S, E, W>,
{
    fn distances(&self, p: &Block<S, D, W>, count: usize, out: &mut Column<S, W>) {
        let mut q = Block::<S, E, W>::scratch();
        let mut child = Column::scratch();
        run(&Points(&self.map), p, &(), count, &mut q);
        self.child.distances(&q, count, &mut child);
        run(&Values::<M, E>(&self.map), p, &child, count, out);
    }
}

impl<T, M, const D: usize, const E: usize, const W: usize> DifferentiateBlock<T, D, W>
    for Warped<M, D, E>
where
    T: Float + Lane,
    M: Warp<D, E>,
    dyn Field<E>: DifferentiateBlock<T, E, W>,
{
    fn distances_gradients(
        &self,
        p: &Block<T, D, W>,
        count: usize,
        out: &mut Gradients<T, D, W>,
    ) {
        let mut q = Block::<T, E, W>::scratch();
        let mut child = Gradients::<T, E, W>::scratch();
        run(&Points(&self.map), p, &(), count, &mut q);
        self.child.distances_gradients(&q, count, &mut child);
        run(&PulledBack(&self.map), p, &child, count, out);
    }
}

impl<T: Float, M: Warp<D, E>, const D: usize, const E: usize> RecordFormula<T, D>
    for Warped<M, D, E>
where
    dyn Field<E>: RecordFormula<T, E>,
{
    fn record(&self, p: Vector<Recorded<T>, D>) -> Option<Recorded<T>> {
        Some(self.map.value(p, self.child.record(self.map.point(p))?))
    }
}

impl<M: Warp<D, E>, const D: usize, const E: usize> Field<D> for Warped<M, D, E> {
    fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    fn depth(&self) -> usize {
        self.depth
    }

    fn unplaced(&self) -> usize {
        usize::from(!M::IS_MOTION)
    }

    fn placed(self: Arc<Self>, pose: &Pose<D>) -> Moved<D> {
        let Some(map) = self.map.placed(pose) else { return Err(self) };
        let (child, promise) = (Arc::clone(&self.child), self.promise.placed(pose));
        Ok(Arc::new(Self { map, child, promise, depth: self.depth }))
    }
}
