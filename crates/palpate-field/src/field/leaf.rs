// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Leaves: a kernel, perhaps in a frame of its own.

use super::{Field, OwnModels, SharedField};
use crate::kernel::Kernel;
use crate::machine::{
    Block, Boxes, Column, Gradients, Job, Lane, PointJob, run, run_point, run_wide,
};
use crate::pose::{Placement, Pose};
use crate::promise::Promise;
use crate::scalar::{AffineModel, Model, Recorded, SpaceTimeModel, TurnedBoxes};
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

/// The distances of a kernel.
struct Values<'a, K>(&'a K);

impl<K: Kernel<D>, const D: usize> Job<Vector<f64, D>, (), f64> for Values<'_, K> {
    #[inline(always)]
    fn lane(&self, p: Vector<f64, D>, (): ()) -> f64 {
        self.0.distance(p)
    }
}

impl<K: Kernel<D>, const D: usize> Job<Vector<f64, D>, (), (f64, Vector<f64, D>)>
    for Values<'_, K>
{
    #[inline(always)]
    fn lane(&self, p: Vector<f64, D>, (): ()) -> (f64, Vector<f64, D>) {
        self.0.distance_gradient(p)
    }
}

/// The models of a kernel.
struct Models<'a, K>(&'a K);

impl<const N: usize, K: Kernel<D>, const D: usize>
    Job<Vector<AffineModel<N>, D>, (), AffineModel<N>> for Models<'_, K>
{
    #[inline(always)]
    fn lane(&self, p: Vector<AffineModel<N>, D>, (): ()) -> AffineModel<N> {
        self.0.model(p)
    }
}

/// The distances of a kernel where it is placed: the motion of the next point fills the latency of the
/// roots of this one.
struct Placed<'a, K, const D: usize>(&'a K, &'a Placement<D>);

impl<K: Kernel<D>, const D: usize> Job<Vector<f64, D>, (), f64> for Placed<'_, K, D> {
    #[inline(always)]
    fn lane(&self, p: Vector<f64, D>, (): ()) -> f64 {
        self.0.distance(self.1.to_body(p))
    }
}

impl<K: Kernel<D>, const D: usize> Job<Vector<f64, D>, (), (f64, Vector<f64, D>)>
    for Placed<'_, K, D>
{
    #[inline(always)]
    fn lane(&self, p: Vector<f64, D>, (): ()) -> (f64, Vector<f64, D>) {
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

impl<K: Kernel<D>, const D: usize> PointJob<f64, Vector<f64, D>> for Leaf<K, D> {
    #[inline(always)]
    fn at(&self, x: f64, y: f64, z: f64, gradient: &mut Vector<f64, D>) -> f64 {
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

/// Puts the cells of a block into `q`, in the body's frame.
fn cells_to_body<const N: usize, const D: usize>(
    placement: &Placement<D>,
    p: &Block<AffineModel<N>, D>,
    count: usize,
    q: &mut Block<AffineModel<N>, D>,
) {
    match p.boxes() {
        Boxes::No => run(&ToBody(placement), p, &(), count, q),
        Boxes::Straight => run(&BoxesToBody(placement), p, &(), count, q),
        Boxes::Turned(rows) => {
            let body = placement.world_from_body.rotation.matrix();
            let job = TurnedToBody(placement, TurnedBoxes::new(rows, body));
            run(&job, p, &(), count, q);
        }
    }
}

impl<K: Kernel<D>, const D: usize> Leaf<K, D> {
    /// Models by a loop that no vector instructions speed up.
    fn each_model<const N: usize>(
        &self,
        p: &Block<AffineModel<N>, D>,
        count: usize,
        out: &mut Column<AffineModel<N>>,
    ) {
        let model = |cell| self.kernel.model(cell);
        match &self.placement {
            None => one_by_one(&model, p, count, out),
            Some(placement) => {
                let mut q = Block::scratch();
                cells_to_body(placement, p, count, &mut q);
                one_by_one(&model, &q, count, out);
            }
        }
    }
}

/// The models of cells, one by one: one function for all kernels.
fn one_by_one<const N: usize, const D: usize>(
    model: &dyn Fn(Vector<AffineModel<N>, D>) -> AffineModel<N>,
    p: &Block<AffineModel<N>, D>,
    count: usize,
    out: &mut Column<AffineModel<N>>,
) {
    out.fill(count, |i| model(p.get(i)));
}

impl<K: Kernel<D>, const D: usize> OwnModels<D> for Leaf<K, D> {
    fn models(&self, p: &Block<Model, D>, count: usize, out: &mut Column<Model>) {
        self.each_model(p, count, out);
    }

    fn space_time_models(
        &self,
        p: &Block<SpaceTimeModel, D>,
        count: usize,
        out: &mut Column<SpaceTimeModel>,
    ) {
        self.each_model(p, count, out);
    }
}

impl<K: Kernel<D>, const D: usize> Field<D> for Leaf<K, D> {
    fn distance(&self, x: f64, y: f64, z: f64) -> f64 {
        let p = Vector::of_coordinates(x, y, z);
        match &self.placement {
            None => self.kernel.distance(p),
            Some(placement) => self.kernel.distance(placement.to_body(p)),
        }
    }

    fn distance_gradient(&self, x: f64, y: f64, z: f64, gradient: &mut Vector<f64, D>) -> f64 {
        run_point(self, (x, y, z), gradient)
    }

    fn distances(&self, p: &Block<f64, D>, count: usize, out: &mut Column<f64>) {
        match &self.placement {
            None => run_wide(&Values(&self.kernel), p, &(), count, out),
            Some(placement) => run_wide(&Placed(&self.kernel, placement), p, &(), count, out),
        }
    }

    fn distances_gradients(
        &self,
        p: &Block<f64, D>,
        count: usize,
        out: &mut Gradients<f64, D>,
    ) {
        match &self.placement {
            None => run_wide(&Values(&self.kernel), p, &(), count, out),
            Some(placement) => run_wide(&Placed(&self.kernel, placement), p, &(), count, out),
        }
    }

    fn models(&self, p: &Block<Model, D>, count: usize, out: &mut Column<Model>) {
        if const { K::HAS_OWN_MODEL } {
            self.each_model(p, count, out);
        } else {
            match &self.placement {
                None => run_wide(&Models(&self.kernel), p, &(), count, out),
                Some(placement) => {
                    let mut q = Block::scratch();
                    cells_to_body(placement, p, count, &mut q);
                    run_wide(&Models(&self.kernel), &q, &(), count, out);
                }
            }
        }
    }

    fn record(&self, p: Vector<Recorded, D>) -> Option<Recorded> {
        let p = self.placement.as_ref().map_or(p, |placement| placement.to_body(p));
        let formula = self.kernel.distance(p);
        Some(match self.kernel.bounded_by_steepness() {
            Some(evaluations) => formula.or_by_steepness(p, evaluations),
            None => formula,
        })
    }

    fn own_models(&self) -> Option<&dyn OwnModels<D>> {
        if const { K::HAS_OWN_MODEL } { Some(self) } else { None }
    }

    fn promise(&self) -> &Promise<D> {
        &self.promise
    }

    fn depth(&self) -> usize {
        1
    }

    fn unplaced(&self) -> usize {
        usize::from(self.placement.is_none())
    }

    fn placed(&self, pose: &Pose<D>) -> Option<SharedField<D>> {
        let world_from_body = match &self.placement {
            None => *pose,
            Some(placement) => *pose * placement.world_from_body,
        };
        let kernel = self.kernel.clone();
        // From the kernel's promise, so that boxes do not grow twice.
        let promise = kernel.promise().placed(&world_from_body);
        let placement = Some(Placement::new(world_from_body));
        Some(SharedField::new(Self { kernel, placement, promise }))
    }
}
