// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Leaves: a kernel, perhaps in a frame of its own.

use std::sync::Arc;

use super::{DifferentiateBlock, EvaluateBlock, EvaluatePoint, Field, Moved, RecordFormula};
use crate::kernel::Kernel;
use crate::machine::{
    Block, Boxes, Column, Gradients, Job, Lane, PointJob, SHORT, run, run_point,
};
use crate::pose::{Placement, Pose};
use crate::promise::Promise;
use crate::scalar::{Float, Model, Recorded, SpaceTimeModel, TurnedBoxes};
use crate::vector::Vector;

/// A kernel as a field.
#[derive(Clone, Debug)]
pub(crate) struct Leaf<K, const D: usize> {
    kernel: K,
    placement: Option<Placement<D>>,
    promise: Promise<D>,
}

impl<K: Kernel<D>, const D: usize> Leaf<K, D> {
    pub(crate) fn new(kernel: K) -> Self {
        let promise = kernel.promise();
        Self { kernel, placement: None, promise }
    }
}

/// A number with which leaves are evaluated, by the best rule that a kernel has for it.
trait Evaluate: Lane {
    /// `kernel` at `p`.
    fn evaluate<K: Kernel<D>, const D: usize>(kernel: &K, p: Vector<Self, D>) -> Self;
}

macro_rules! evaluate {
    ($($number:ty, $rule:ident;)*) => {
        $(impl Evaluate for $number {
            #[inline(always)]
            fn evaluate<K: Kernel<D>, const D: usize>(kernel: &K, p: Vector<Self, D>) -> Self {
                kernel.$rule(p)
            }
        })*
    };
}

evaluate! {
    f64, distance;
    f32, distance;
    Model, model;
    SpaceTimeModel, model;
}

struct Values<'a, K>(&'a K);

impl<S: Evaluate, K: Kernel<D>, const D: usize> Job<Vector<S, D>, (), S> for Values<'_, K> {
    #[inline(always)]
    fn lane(&self, p: Vector<S, D>, (): ()) -> S {
        S::evaluate(self.0, p)
    }
}

struct ValuesAndGradients<'a, K>(&'a K);

impl<T: Float, K: Kernel<D>, const D: usize> Job<Vector<T, D>, (), (T, Vector<T, D>)>
    for ValuesAndGradients<'_, K>
{
    #[inline(always)]
    fn lane(&self, p: Vector<T, D>, (): ()) -> (T, Vector<T, D>) {
        self.0.distance_gradient(p)
    }
}

/// A kernel where it is placed.
struct Placed<'a, K, const D: usize>(&'a K, &'a Placement<D>);

impl<S: Evaluate, K: Kernel<D>, const D: usize> Job<Vector<S, D>, (), S> for Placed<'_, K, D> {
    #[inline(always)]
    fn lane(&self, p: Vector<S, D>, (): ()) -> S {
        S::evaluate(self.0, self.1.to_body(p))
    }
}

impl<T: Float, K: Kernel<D>, const D: usize> Job<Vector<T, D>, (), (T, Vector<T, D>)>
    for Placed<'_, K, D>
{
    #[inline(always)]
    fn lane(&self, p: Vector<T, D>, (): ()) -> (T, Vector<T, D>) {
        let (distance, gradient) = self.0.distance_gradient(self.1.to_body(p));
        (distance, self.1.gradient_to_world(gradient))
    }
}

/// Moves points into the body's frame.
struct ToBody<'a, const D: usize>(&'a Placement<D>);

impl<S: Lane, const D: usize> Job<Vector<S, D>, (), Vector<S, D>> for ToBody<'_, D> {
    #[inline(always)]
    fn lane(&self, p: Vector<S, D>, (): ()) -> Vector<S, D> {
        self.0.to_body(p)
    }
}

/// Moves boxes along the axes into the body's frame.
struct BoxesToBody<'a, const D: usize>(&'a Placement<D>);

impl<S: Lane, const D: usize> Job<Vector<S, D>, (), Vector<S, D>> for BoxesToBody<'_, D> {
    #[inline(always)]
    fn lane(&self, p: Vector<S, D>, (): ()) -> Vector<S, D> {
        Vector(S::box_to_body(p.0, self.0))
    }
}

/// Moves boxes that are all turned alike into the body's frame.
struct TurnedToBody<'a, const D: usize>(&'a Placement<D>, TurnedBoxes<D>);

impl<S: Lane, const D: usize> Job<Vector<S, D>, (), Vector<S, D>> for TurnedToBody<'_, D> {
    #[inline(always)]
    fn lane(&self, p: Vector<S, D>, (): ()) -> Vector<S, D> {
        Vector(S::turned_to_body(p.0, self.0, &self.1))
    }
}

impl<T: Float, K: Kernel<D>, const D: usize> EvaluatePoint<T, D> for Leaf<K, D> {
    fn distance(&self, x: T, y: T, z: T) -> T {
        let p = Vector::of_coordinates(x, y, z);
        match &self.placement {
            None => self.kernel.distance(p),
            Some(placement) => self.kernel.distance(placement.to_body(p)),
        }
    }

    fn distance_gradient(&self, x: T, y: T, z: T, gradient: &mut Vector<T, D>) -> T {
        run_point(self, (x, y, z), gradient)
    }
}

impl<T: Float, K: Kernel<D>, const D: usize> PointJob<T, Vector<T, D>> for Leaf<K, D> {
    #[inline(always)]
    fn at(&self, x: T, y: T, z: T, gradient: &mut Vector<T, D>) -> T {
        let p = Vector::of_coordinates(x, y, z);
        let distance;
        match &self.placement {
            None => (distance, *gradient) = self.kernel.distance_gradient(p),
            Some(placement) => {
                let in_body;
                (distance, in_body) = self.kernel.distance_gradient(placement.to_body(p));
                *gradient = placement.gradient_to_world(in_body);
            }
        }
        distance
    }
}

impl<S: Evaluate, K: Kernel<D>, const D: usize, const W: usize> EvaluateBlock<S, D, W>
    for Leaf<K, D>
{
    fn distances(&self, p: &Block<S, D, W>, count: usize, out: &mut Column<S, W>) {
        match &self.placement {
            None => run(&Values(&self.kernel), p, &(), count, out),
            // In short blocks a second call takes as long as the numbers.
            Some(placement) if S::MOVED_IN_LOOP || W == SHORT => {
                run(&Placed(&self.kernel, placement), p, &(), count, out);
            }
            Some(placement) => {
                let mut q = Block::<S, D, W>::scratch();
                match p.boxes() {
                    Boxes::No => run(&ToBody(placement), p, &(), count, &mut q),
                    Boxes::Straight => run(&BoxesToBody(placement), p, &(), count, &mut q),
                    Boxes::Turned(rows) => {
                        let body = placement.world_from_body.rotation.matrix();
                        let job = TurnedToBody(placement, TurnedBoxes::new(rows, body));
                        run(&job, p, &(), count, &mut q);
                    }
                }
                run(&Values(&self.kernel), &q, &(), count, out);
            }
        }
    }
}

impl<T: Float + Lane, K: Kernel<D>, const D: usize, const W: usize> DifferentiateBlock<T, D, W>
    for Leaf<K, D>
{
    fn distances_gradients(
        &self,
        p: &Block<T, D, W>,
        count: usize,
        out: &mut Gradients<T, D, W>,
    ) {
        match &self.placement {
            None => run(&ValuesAndGradients(&self.kernel), p, &(), count, out),
            Some(placement) => run(&Placed(&self.kernel, placement), p, &(), count, out),
        }
    }
}

impl<T: Float, K: Kernel<D>, const D: usize> RecordFormula<T, D> for Leaf<K, D> {
    fn record(&self, p: Vector<Recorded<T>, D>) -> Option<Recorded<T>> {
        let p = self.placement.as_ref().map_or(p, |placement| placement.to_body(p));
        Some(self.kernel.distance(p))
    }
}

impl<K: Kernel<D>, const D: usize> Field<D> for Leaf<K, D> {
    fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    fn depth(&self) -> usize {
        1
    }

    fn unplaced(&self) -> usize {
        usize::from(self.placement.is_none())
    }

    fn placed(self: Arc<Self>, pose: &Pose<D>) -> Moved<D> {
        let world_from_body = match &self.placement {
            None => *pose,
            Some(placement) => *pose * placement.world_from_body,
        };
        let kernel = self.kernel.clone();
        // From the kernel's promise, so that boxes do not grow twice.
        let promise = kernel.promise().placed(&world_from_body);
        let placement = Some(Placement::new(world_from_body));
        Ok(Arc::new(Self { kernel, placement, promise }))
    }
}
