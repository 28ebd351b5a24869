// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fields that evaluate their child at another point: transforms, mirrors, extrusion.

use std::fmt::Debug;

use super::{Evaluate, Field, SharedField, depth_over};
use crate::error::ShapeError;
use crate::machine::{Block, Column, Gradients, Job, Lane, run_wide};
use crate::pose::Pose;
use crate::promise::Promise;
use crate::scalar::{Dual, Float, Model, Recorded, Scalar};
use crate::vector::{Vector, unrolled};

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
        Ok(SharedField::new(Self { map, child, promise, depth }))
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

impl<M: Warp<D, E>, const D: usize, const E: usize>
    Job<Vector<f64, D>, (f64, Vector<f64, E>), (f64, Vector<f64, D>)> for PulledBack<'_, M>
{
    #[inline(always)]
    fn lane(
        &self,
        p: Vector<f64, D>,
        (child, gradient): (f64, Vector<f64, E>),
    ) -> (f64, Vector<f64, D>) {
        self.0.gradient(p, child, gradient)
    }
}

impl<M: Warp<D, E>, const D: usize, const E: usize> Warped<M, D, E> {
    fn map<S: Evaluate>(&self, p: &Block<S, D>, count: usize, out: &mut Column<S>) {
        let mut q = Block::<S, E>::scratch();
        let mut child = Column::scratch();
        run_wide(&Points(&self.map), p, &(), count, &mut q);
        self.child.evaluate(&q, count, &mut child);
        run_wide(&Values::<M, E>(&self.map), p, &child, count, out);
    }
}

impl<M: Warp<D, E>, const D: usize, const E: usize> Field<D> for Warped<M, D, E> {
    fn distance(&self, x: f64, y: f64, z: f64) -> f64 {
        let p = Vector::of_coordinates(x, y, z);
        let (u, v, w) = self.map.point(p).coordinates();
        self.map.value(p, self.child.distance(u, v, w))
    }

    fn distance_gradient(&self, x: f64, y: f64, z: f64, gradient: &mut Vector<f64, D>) -> f64 {
        let p = Vector::of_coordinates(x, y, z);
        let (u, v, w) = self.map.point(p).coordinates();
        let mut child_gradient = Vector::ZERO;
        let child = self.child.distance_gradient(u, v, w, &mut child_gradient);
        let distance;
        (distance, *gradient) = self.map.gradient(p, child, child_gradient);
        distance
    }

    fn distances(&self, p: &Block<f64, D>, count: usize, out: &mut Column<f64>) {
        self.map(p, count, out);
    }

    fn distances_gradients(
        &self,
        p: &Block<f64, D>,
        count: usize,
        out: &mut Gradients<f64, D>,
    ) {
        let mut q = Block::<f64, E>::scratch();
        let mut child = Gradients::<f64, E>::scratch();
        run_wide(&Points(&self.map), p, &(), count, &mut q);
        self.child.gradients(&q, count, &mut child);
        run_wide(&PulledBack(&self.map), p, &child, count, out);
    }

    fn models(&self, p: &Block<Model, D>, count: usize, out: &mut Column<Model>) {
        self.map(p, count, out);
    }

    fn record(&self, p: Vector<Recorded, D>) -> Option<Recorded> {
        Some(self.map.value(p, self.child.record(self.map.point(p))?))
    }

    fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    fn depth(&self) -> usize {
        self.depth
    }

    fn unplaced(&self) -> usize {
        usize::from(!M::IS_MOTION)
    }

    fn leaves_on_tape(&self) -> usize {
        self.child.leaves_on_tape()
    }

    fn placed(&self, pose: &Pose<D>) -> Option<SharedField<D>> {
        let map = self.map.placed(pose)?;
        let (child, promise) = (self.child.clone(), self.promise.placed(pose));
        Some(SharedField::new(Self { map, child, promise, depth: self.depth }))
    }
}
