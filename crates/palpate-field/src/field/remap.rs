// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fields that change their child's answer at the same point: offset, shell, guard.

use std::fmt::Debug;

use super::{Evaluate, Field, SharedField, depth_over};
use crate::error::ShapeError;
use crate::machine::{Block, Column, Gradients, Job, Lane, run_wide};
use crate::pose::Pose;
use crate::promise::Promise;
use crate::scalar::{Dual, Model, Recorded, Scalar};
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
        Ok(SharedField::new(Self { map, child, promise, depth }))
    }
}

#[inline(always)]
fn differentiate<M: Remap<D>, const D: usize>(
    map: &M,
    p: Vector<f64, D>,
    child: f64,
    gradient: Vector<f64, D>,
) -> (f64, Vector<f64, D>) {
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

impl<M: Remap<D>, const D: usize>
    Job<Vector<f64, D>, (f64, Vector<f64, D>), (f64, Vector<f64, D>)>
    for ValuesAndGradients<'_, M>
{
    #[inline(always)]
    fn lane(
        &self,
        p: Vector<f64, D>,
        (child, gradient): (f64, Vector<f64, D>),
    ) -> (f64, Vector<f64, D>) {
        differentiate(self.0, p, child, gradient)
    }
}

impl<M: Remap<D>, const D: usize> Remapped<M, D> {
    fn map<S: Evaluate>(&self, p: &Block<S, D>, count: usize, out: &mut Column<S>) {
        let mut child = Column::scratch();
        self.child.evaluate(p, count, &mut child);
        run_wide(&Values(&self.map), p, &child, count, out);
    }
}

impl<M: Remap<D>, const D: usize> Field<D> for Remapped<M, D> {
    fn distance(&self, x: f64, y: f64, z: f64) -> f64 {
        let p = Vector::of_coordinates(x, y, z);
        self.map.value(p, self.child.distance(x, y, z))
    }

    fn distance_gradient(&self, x: f64, y: f64, z: f64, gradient: &mut Vector<f64, D>) -> f64 {
        let p = Vector::of_coordinates(x, y, z);
        let child = self.child.distance_gradient(x, y, z, gradient);
        let distance;
        (distance, *gradient) = differentiate(&self.map, p, child, *gradient);
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
        let mut child = Gradients::scratch();
        self.child.gradients(p, count, &mut child);
        run_wide(&ValuesAndGradients(&self.map), p, &child, count, out);
    }

    fn models(&self, p: &Block<Model, D>, count: usize, out: &mut Column<Model>) {
        self.map(p, count, out);
    }

    fn record(&self, p: Vector<Recorded, D>) -> Option<Recorded> {
        Some(self.map.value(p, self.child.record(p)?))
    }

    fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    fn depth(&self) -> usize {
        self.depth
    }

    fn leaves_on_tape(&self) -> usize {
        self.child.leaves_on_tape()
    }

    fn placed(&self, _pose: &Pose<D>) -> Option<SharedField<D>> {
        None
    }
}
