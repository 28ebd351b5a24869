// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Leaves: a kernel, perhaps in a frame of its own.

use std::sync::Arc;

use super::{DifferentiateBlock, EvaluateBlock, EvaluatePoint, Field, Moved};
use crate::kernel::Kernel;
use crate::machine::{
    Block, Boxes, Column, Gradients, Job, Lane, PointJob, SHORT, run, run_point,
};
use crate::pose::Pose;
use crate::promise::Promise;
use crate::scalar::{Float, Scalar, TurnedBoxes};
use crate::shape::Shape;
use crate::vector::{Vector, array};

/// The change of coordinates from the world to a placed body.
#[derive(Clone, Copy, Debug)]
pub struct Placement<const D: usize> {
    /// The pose it was made from.
    pub world_from_body: Pose<D>,
    /// The same numbers in single precision.
    single: Single<D>,
}

/// A pose in single precision.
#[derive(Clone, Copy, Debug)]
struct Single<const D: usize> {
    translation: [f32; D],
    rows: [[f32; D]; D],
}

/// A column of a matrix, of its rows.
#[inline(always)]
fn column<S: Float, const D: usize>(rows: &[[S; D]; D], k: usize) -> [S; D] {
    array!(i < D => rows[i][k])
}

impl<const D: usize> Placement<D> {
    /// The change of coordinates to a body at `world_from_body`.
    #[must_use]
    pub fn new(world_from_body: Pose<D>) -> Self {
        let mut rows = [[0.0; D]; D];
        for (single, row) in rows.iter_mut().zip(world_from_body.rotation.matrix()) {
            *single = array!(i < D => row[i] as f32);
        }
        let translation = array!(i < D => world_from_body.translation[i] as f32);
        Self { world_from_body, single: Single { translation, rows } }
    }

    /// `Rᵀ(p − t)`: subtracting first keeps points near the body precise.
    #[inline(always)]
    pub fn to_body<S: Scalar>(&self, p: Vector<S, D>) -> Vector<S, D> {
        let Pose { rotation, translation } = &self.world_from_body;
        let single = &self.single;
        let q = array!(i < D => p.0[i].minus_stored(translation[i], single.translation[i]));
        Vector(array!(k < D => {
            S::stored_sum(q, &column(rotation.matrix(), k), &column(&single.rows, k))
        }))
    }

    /// `R·v`: a gradient in the body's frame, back in the world's.
    #[inline(always)]
    pub fn gradient_to_world<T: Float>(&self, v: Vector<T, D>) -> Vector<T, D> {
        let rows = self.world_from_body.rotation.matrix();
        Vector(array!(i < D => T::stored_sum(v.0, &rows[i], &self.single.rows[i])))
    }
}

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

    /// The promise is made and moved in registers: all of it is inlined.
    #[inline(always)]
    pub(crate) fn at(kernel: K, world_from_body: &Pose<D>) -> Self {
        let promise = kernel.promise().placed(world_from_body);
        Self { kernel, placement: Some(Placement::new(*world_from_body)), promise }
    }
}

struct Values<'a, K>(&'a K);

impl<S: Lane, K: Kernel<D>, const D: usize> Job<Vector<S, D>, (), S> for Values<'_, K> {
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

impl<S: Lane, K: Kernel<D>, const D: usize> Job<Vector<S, D>, (), S> for Placed<'_, K, D> {
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

impl<S: Lane, K: Kernel<D>, const D: usize, const W: usize> EvaluateBlock<S, D, W>
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

impl<K: Kernel<D>, const D: usize> Field<D> for Leaf<K, D> {
    fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    fn unplaced(&self) -> usize {
        usize::from(self.placement.is_none())
    }

    fn placed(mut self: Arc<Self>, pose: &Pose<D>) -> Moved<D> {
        let leaf = Arc::make_mut(&mut self);
        let world_from_body = match &leaf.placement {
            None => *pose,
            Some(placement) => {
                // From the kernel's promise, so that boxes do not grow twice.
                leaf.promise = leaf.kernel.promise();
                *pose * placement.world_from_body
            }
        };
        leaf.promise = leaf.promise.placed(&world_from_body);
        leaf.placement = Some(Placement::new(world_from_body));
        Ok(Shape::from_node(self))
    }
}
