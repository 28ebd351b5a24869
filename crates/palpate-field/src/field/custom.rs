// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fields of users that are not kernels.

use std::any::Any;

use super::{Field, OwnModels, SharedField};
use crate::machine::{BLOCK, Block, Column, Gradients};
use crate::pose::Pose;
use crate::promise::Promise;
use crate::scalar::{AffineModel, Dual, Model, Recorded, SpaceTimeModel};
use crate::vector::{Point, Vector};

/// A field of a user, evaluated in double precision.
///
/// A closed formula is faster as a [`Kernel`](crate::kernel::Kernel): its blocks
/// vectorise, and gradient and model follow from the formula. A `CustomField` is for
/// data and algorithms. Its Lipschitz constant bounds it over cells, unless it has a
/// [`model`](Self::model) of its own.
///
/// ```
/// use palpate_field::{CustomField, Point, Promise, Shape, Vector};
///
/// /// Waves of 1 cm on a floor; nothing is known of it but its steepness.
/// #[derive(Debug)]
/// struct Waves(Promise<3>);
///
/// impl CustomField<3> for Waves {
///     fn distance(&self, p: Point<3>) -> f64 {
///         p[1] - 0.01 * (20.0 * p[0]).sin()
///     }
///     fn distance_gradient(&self, p: Point<3>) -> (f64, Vector<f64, 3>) {
///         (self.distance(p), Vector([-0.2 * (20.0 * p[0]).cos(), 1.0, 0.0]))
///     }
///     fn promise(&self) -> &Promise<3> {
///         &self.0
///     }
/// }
///
/// let steepness = 1.0_f64.hypot(0.2);
/// let waves = Shape::custom(Waves(Promise::lipschitz(None, steepness)));
/// assert_eq!(waves.distance(Vector([0.0, 0.5, 0.0])), 0.5);
/// assert!(waves.safe_radius(Vector([0.0, 0.5, 0.0])) < 0.5);
/// ```
pub trait CustomField<const D: usize>: std::fmt::Debug + Send + Sync + 'static {
    /// The signed distance at `p` [m]: negative inside.
    fn distance(&self, p: Point<D>) -> f64;

    /// The signed distance at `p` [m] and its gradient, never NaN.
    fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>);

    /// The signed distances at points [m], into as many `distances`: those of
    /// [`distance`](Self::distance), to the bit. By default a loop; searches and pictures ask for up to 64.
    fn distances(&self, points: &[Point<D>], distances: &mut [f64]) {
        for (distance, p) in distances.iter_mut().zip(points) {
            *distance = self.distance(*p);
        }
    }

    /// The signed distances at points [m] and their gradients, those of
    /// [`distance_gradient`](Self::distance_gradient), to the bit. By default a loop.
    fn distances_gradients(
        &self,
        points: &[Point<D>],
        distances: &mut [f64],
        gradients: &mut [Vector<f64, D>],
    ) {
        let out = distances.iter_mut().zip(gradients);
        for ((distance, gradient), p) in out.zip(points) {
            (*distance, *gradient) = self.distance_gradient(*p);
        }
    }

    /// The promise of the values.
    fn promise(&self) -> &Promise<D>;

    /// Bounds of the values over a cell, rounding included, with which certified searches go on. By
    /// default those of the Lipschitz constant, with which they halve cells down to what they look for.
    ///
    /// It may bound no less than the field does: a model that some value leaves makes proofs false.
    fn model<const N: usize>(&self, cell: &[AffineModel<N>; D]) -> AffineModel<N> {
        let promise = self.promise();
        let centre = Vector(cell.map(|x| x.value));
        let rounding = promise.rounding.within(centre.norm() + AffineModel::radius(cell));
        AffineModel::lipschitz(self.distance(centre), promise.lipschitz, cell, rounding)
    }

    /// Feeds `sink` with all that determines the values, as bytes; `false`, the default, if that is not
    /// known. What is made of a field, as a grid, can be kept in a file under the sum of these bytes: see
    /// [`Shape::content`](crate::Shape::content).
    ///
    /// Two fields of one Rust type that feed the same bytes must have the same values.
    fn content(&self, _sink: &mut dyn FnMut(&[u8])) -> bool {
        false
    }

    /// Calls `visit` with each face of the surface if the field is that of a polyhedron or polygon: triangles
    /// counter-clockwise seen from outside, segments with the inside on their left. `false`, the default, if it is
    /// not.
    ///
    /// The faces must close: around each point inside they turn once, around each point outside not at all.
    /// [`Shape::mass`](crate::Shape::mass) follows from them.
    fn faces(&self, _visit: &mut dyn FnMut([Point<D>; D])) -> bool {
        false
    }
}

/// A closure over duals, which give its gradient without differences.
pub(crate) struct FromClosure<F, const D: usize> {
    pub(crate) closure: F,
    pub(crate) promise: Promise<D>,
}

impl<F, const D: usize> std::fmt::Debug for FromClosure<F, D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FromClosure").field("promise", &self.promise).finish_non_exhaustive()
    }
}

impl<F, const D: usize> CustomField<D> for FromClosure<F, D>
where
    F: Fn(Vector<Dual<f64, D>, D>) -> Dual<f64, D> + Send + Sync + 'static,
{
    fn distance(&self, p: Point<D>) -> f64 {
        (self.closure)(Vector(Dual::variables(p.0))).value
    }

    fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        let result = (self.closure)(Vector(Dual::variables(p.0)));
        (result.value, Vector(result.gradient))
    }

    fn promise(&self) -> &Promise<D> {
        &self.promise
    }
}

/// A [`CustomField`] as a node.
#[derive(Debug)]
pub(crate) struct Custom<F>(pub(crate) F);

/// The first `count` points of a block.
#[inline(always)]
fn listed<const D: usize>(p: &Block<f64, D>, count: usize) -> [Point<D>; BLOCK] {
    let mut points = [Vector::ZERO; BLOCK];
    for (i, point) in points[..count].iter_mut().enumerate() {
        *point = p.get(i);
    }
    points
}

/// The models of a custom field, one by one.
fn each_model<const N: usize, const D: usize>(
    field: &impl CustomField<D>,
    p: &Block<AffineModel<N>, D>,
    count: usize,
    out: &mut Column<AffineModel<N>>,
) {
    out.fill(count, |i| field.model(&p.get(i).0));
}

impl<F: CustomField<D>, const D: usize> OwnModels<D> for Custom<F> {
    fn models(&self, p: &Block<Model, D>, count: usize, out: &mut Column<Model>) {
        each_model(&self.0, p, count, out);
    }

    fn space_time_models(
        &self,
        p: &Block<SpaceTimeModel, D>,
        count: usize,
        out: &mut Column<SpaceTimeModel>,
    ) {
        each_model(&self.0, p, count, out);
    }
}

impl<F: CustomField<D>, const D: usize> Field<D> for Custom<F> {
    fn distance(&self, x: f64, y: f64, z: f64) -> f64 {
        self.0.distance(Vector::of_coordinates(x, y, z))
    }

    fn distance_gradient(&self, x: f64, y: f64, z: f64, gradient: &mut Vector<f64, D>) -> f64 {
        let distance;
        (distance, *gradient) = self.0.distance_gradient(Vector::of_coordinates(x, y, z));
        distance
    }

    fn distances(&self, p: &Block<f64, D>, count: usize, out: &mut Column<f64>) {
        let (points, mut distances) = (listed(p, count), [0.0; BLOCK]);
        self.0.distances(&points[..count], &mut distances[..count]);
        out.fill(count, |i| distances[i]);
    }

    fn distances_gradients(
        &self,
        p: &Block<f64, D>,
        count: usize,
        out: &mut Gradients<f64, D>,
    ) {
        let (points, mut distances) = (listed(p, count), [0.0; BLOCK]);
        let mut gradients = [Vector::ZERO; BLOCK];
        let (distances, gradients) = (&mut distances[..count], &mut gradients[..count]);
        self.0.distances_gradients(&points[..count], distances, gradients);
        out.fill(count, |i| (distances[i], gradients[i]));
    }

    fn models(&self, p: &Block<Model, D>, count: usize, out: &mut Column<Model>) {
        each_model(&self.0, p, count, out);
    }

    fn record(&self, _p: Vector<Recorded, D>) -> Option<Recorded> {
        None
    }

    fn has_formula(&self) -> bool {
        false
    }

    fn own_models(&self) -> Option<&dyn OwnModels<D>> {
        Some(self)
    }

    fn promise(&self) -> &Promise<D> {
        self.0.promise()
    }

    fn depth(&self) -> usize {
        1
    }

    fn placed(&self, _pose: &Pose<D>) -> Option<SharedField<D>> {
        None
    }

    fn custom(&self) -> Option<&dyn Any> {
        Some(&self.0)
    }

    fn content(&self, sink: &mut dyn FnMut(&[u8])) -> bool {
        self.0.content(sink)
    }

    fn faces(&self, visit: &mut dyn FnMut([Point<D>; D])) -> bool {
        self.0.faces(visit)
    }
}
