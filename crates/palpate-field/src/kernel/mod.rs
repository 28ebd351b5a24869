// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Kernels: the closed formulas that leaves evaluate.

mod primitive;

mod ball;
pub(crate) mod between;
mod capsule;
mod cuboid;
mod ellipsoid;
mod exponent;
mod half_space;
mod mark;
pub mod planar;
mod power_ball;
mod power_cuboid;
mod profile;
mod simplex;
pub mod spatial;

use std::fmt::Debug;

pub use ball::Ball;
pub use capsule::{Capsule, Segment};
pub use cuboid::{Cuboid, RoundedCuboid};
pub use ellipsoid::Ellipsoid;
pub use half_space::HalfSpace;
pub use mark::{Mark, MarkKind};
pub use planar::*;
pub use power_ball::PowerBall;
pub use power_cuboid::PowerCuboid;
pub(crate) use primitive::primitive;
pub use primitive::{Argument, NamedKernel, Parameter, ParameterKind};
pub use simplex::Simplex;
pub use spatial::*;

use crate::promise::Promise;
use crate::scalar::{AffineModel, Dual, Float, Scalar};
use crate::vector::{Point, Vector, array};

/// A closed formula for a signed distance.
///
/// A kernel is one branch-free function, [`distance`](Self::distance), with its promise; all
/// else follows. To choose between formulas, use [`Scalar::select_less`]. Mark the methods
/// `#[inline(always)]`, so that the compiler vectorises blocks.
///
/// ```
/// use palpate_field::scalar::Scalar;
/// use palpate_field::{Kernel, Promise, Shape, Vector};
///
/// /// A cylinder without ends about the y axis.
/// #[derive(Clone, Debug)]
/// struct Pole {
///     radius: f64,
/// }
///
/// impl Kernel<3> for Pole {
///     #[inline(always)]
///     fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
///         S::norm([p[0], p[2]]) - S::constant(self.radius)
///     }
///     fn promise(&self) -> Promise<3> {
///         Promise::exact_convex(None, 4.0, self.radius)
///     }
/// }
///
/// let pole = Shape::from_kernel(Pole { radius: 0.5 });
/// let (distance, gradient) = pole.distance_gradient(Vector([3.0, 7.0, 4.0]));
/// assert_eq!(distance, 4.5);
/// assert!((gradient - Vector([0.6, 0.0, 0.8])).norm() < 1e-15);
/// ```
pub trait Kernel<const D: usize>: Clone + Debug + Send + Sync + 'static {
    /// The signed distance at `p` [m]: negative inside.
    fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S;

    /// The signed distance and its gradient. The default evaluates the formula in duals;
    /// override it where a gradient is cheaper by hand or a point is singular.
    ///
    /// The distance must have the same bits as [`distance`](Self::distance).
    #[inline(always)]
    fn distance_gradient<T: Float>(&self, p: Vector<T, D>) -> (T, Vector<T, D>) {
        let result = self.distance(Vector(Dual::variables(p.0)));
        (result.value, Vector(result.gradient))
    }

    /// `true` if [`model`](Self::model) does not evaluate the formula and does not gain from vector
    /// instructions. Such a model is compiled once; a model that evaluates the formula is compiled
    /// for each instruction set.
    const HAS_OWN_MODEL: bool = false;

    /// `Some` if a model may also be bounded by the value at the cell's centre and the Lipschitz
    /// constant 1, where that bound says more than the formula. It tells how distances are rounded.
    #[inline(always)]
    fn bounded_by_steepness(&self) -> Option<Evaluations> {
        None
    }

    /// Bounds over the cell whose coordinates are `cell`. The default evaluates the formula in
    /// models. Override it, and set [`HAS_OWN_MODEL`](Self::HAS_OWN_MODEL) to `true`, where
    /// [`AffineModel`] lacks an operation or another bound is tighter.
    #[inline(always)]
    fn model<const N: usize>(&self, cell: Vector<AffineModel<N>, D>) -> AffineModel<N> {
        let formula = self.distance(cell);
        match self.bounded_by_steepness() {
            Some(evaluations) => evaluations.or_by_steepness(formula, &cell),
            None => formula,
        }
    }

    /// The promise of the distance.
    fn promise(&self) -> Promise<D>;
}

/// Implements [`Kernel`] for a type by the kernel in its field; only their parameters differ.
macro_rules! answered_by_inner {
    ($kernel:ident.$field:tt, $inner:ty, $dimension:literal) => {
        impl Kernel<$dimension> for $kernel {
            #[inline(always)]
            fn distance<S: Scalar>(&self, p: Vector<S, $dimension>) -> S {
                self.$field.distance(p)
            }

            const HAS_OWN_MODEL: bool = <$inner as Kernel<$dimension>>::HAS_OWN_MODEL;

            #[inline(always)]
            fn bounded_by_steepness(&self) -> Option<$crate::kernel::Evaluations> {
                Kernel::<$dimension>::bounded_by_steepness(&self.$field)
            }

            #[inline(always)]
            fn model<const N: usize>(
                &self,
                cell: Vector<AffineModel<N>, $dimension>,
            ) -> AffineModel<N> {
                self.$field.model(cell)
            }

            fn promise(&self) -> Promise<$dimension> {
                self.$field.promise()
            }
        }
    };
}
pub(crate) use answered_by_inner;

/// `outside`, but on the surface of a convex shape `face`, the distance to the nearest face's
/// plane.
///
/// On an edge or corner, the direction from the nearest point is only rounding, and may be no
/// normal of the shape. The gradient of `face` is a normal, and a face's plane is a lower bound
/// everywhere. A point counts as on the surface within a few roundings of `size`, that of the
/// shape.
#[inline(always)]
pub(crate) fn face_if_on_it<S: Scalar>(outside: S, face: S, size: f64) -> S {
    S::select_less(outside, S::constant(4.0 * S::epsilon() * size), face, outside)
}

/// A kernel at single points: what all kernels share is compiled once.
trait AtPoint<const D: usize> {
    fn distance_at(&self, p: Point<D>) -> f64;

    fn gradient_at(&self, p: Point<D>) -> (f64, Vector<f64, D>);
}

impl<K: Kernel<D>, const D: usize> AtPoint<D> for K {
    fn distance_at(&self, p: Point<D>) -> f64 {
        self.distance(p)
    }

    fn gradient_at(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        self.distance_gradient(p)
    }
}

/// Directions that differ by less count as equal: over a length `t`, distances along them
/// differ by `t·NEARLY²/2`, which is less than a rounding.
const NEARLY: f64 = 1e-8;

/// How far out a normal is evaluated [m].
struct Steps {
    /// The rounding of a point.
    unit: f64,
    /// The farthest step.
    far: f64,
}

/// A normal of a convex exact kernel next to `centre`, and by how much its plane through
/// the `centre` may be too high [m].
///
/// At a distance d from an edge, the direction from the nearest point is off by the rounding
/// over d, so it may be no normal of the shape. Over a large cell its plane is then too high by
/// far more than a rounding.
///
/// Along a normal, outwards from the nearest point, the gradient is constant. So the gradient
/// is evaluated again a step t out along `direction`, where a rounding matters little. If
/// `direction` is off by τ from a normal, the nearest point moves along a face, and the
/// gradient is the normal of this face. Its plane is a bound everywhere, and at the centre too
/// low by at most `t·τ²/2`. The first step goes far out; if it confirms `direction`, this loss
/// is less than a rounding. If not, steps grow from t to `t²/ρ`, with ρ the `unit` of rounding:
/// after a step t the error τ is `ρ/t`, so each step loses about `ρ/2`, and few are needed. The
/// distances at the steps give the whole loss.
fn sure_normal<const D: usize>(
    kernel: &dyn AtPoint<D>,
    centre: Point<D>,
    distance: f64,
    direction: Vector<f64, D>,
    Steps { unit, far }: Steps,
) -> (Vector<f64, D>, f64) {
    // The normal a step out, and how far its plane is below the distance at the centre.
    let out = |step: f64, direction: Vector<f64, D>| {
        let (f, normal) = kernel.gradient_at(centre + direction * step);
        (normal, distance + step * normal.dot(direction) - f)
    };
    let (normal, lost) = out(far, direction);
    if (normal - direction).norm() < NEARLY && lost < NEARLY * far {
        return (normal, 0.5 * far * NEARLY * NEARLY);
    }
    let (mut normal, mut lost) = (direction, 0.0_f64);
    let mut step = 4.0 * unit;
    while step < far {
        let (next, below) = out(step, normal);
        (normal, lost) = (next, lost.max(below));
        step *= step / unit;
    }
    (out(far, normal).0, lost)
}

/// Bounds a convex exact kernel over a cell by its tangent plane, and by its values at
/// the corners of the cell; `operations` and `size` as for
/// [`Rounding::of_operations`](crate::Rounding::of_operations).
#[inline(always)]
pub(crate) fn tangent_model<const D: usize, const N: usize>(
    kernel: &impl Kernel<D>,
    cell: Vector<AffineModel<N>, D>,
    operations: f64,
    size: f64,
) -> AffineModel<N> {
    tangent_model_of(kernel, &cell, operations, size)
}

/// [`tangent_model`], compiled once for all kernels.
#[inline(never)]
fn tangent_model_of<const D: usize, const N: usize>(
    kernel: &dyn AtPoint<D>,
    cell: &Vector<AffineModel<N>, D>,
    operations: f64,
    size: f64,
) -> AffineModel<N> {
    let centre = Vector(array!(i < D => cell.0[i].value));
    let (distance, mut normal) = kernel.gradient_at(centre);
    let mut rounding = operations * f64::EPSILON * (size + centre.norm());
    let radius = AffineModel::radius(&cell.0);
    // Otherwise the nearest point is so far away that its direction is precise over the cell.
    if distance < radius {
        let far = 4.0 * (size + centre.norm() + radius);
        let unit = rounding.max(f64::EPSILON * far);
        let lost;
        (normal, lost) = sure_normal(kernel, centre, distance, normal, Steps { unit, far });
        // The normal is evaluated at least four sizes out. There the `operations` of the
        // nearest point turn it by a quarter of their roundings, and its own by two more; the
        // plane moves accordingly at the ends of the cell.
        rounding += lost + (0.25 * operations + 2.0) * f64::EPSILON * radius;
    }
    let distance_at = |corner: [f64; D]| kernel.distance_at(Vector(corner));
    AffineModel::tangent(distance, normal.0, distance_at, &cell.0, rounding)
}

/// How the distances of a kernel are rounded: `operations` and `size` as for
/// [`Rounding::of_operations`](crate::Rounding::of_operations).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluations {
    /// How many roundings, of numbers as large as the kernel and its point.
    pub operations: f64,
    /// The size of the kernel [m].
    pub size: f64,
}

impl Evaluations {
    /// A cell's bound by the `value` at its centre and the Lipschitz constant 1.
    #[inline(always)]
    fn by_steepness<const D: usize, const N: usize>(
        self,
        value: f64,
        cell: &Vector<AffineModel<N>, D>,
    ) -> AffineModel<N> {
        let centre = Vector(array!(i < D => cell.0[i].value));
        let far = self.size + centre.norm() + AffineModel::radius(&cell.0);
        AffineModel::lipschitz(value, 1.0, &cell.0, self.operations * f64::EPSILON * far)
    }

    /// The model of a `formula`, or the cell's bound by the steepness where that says more: over cells
    /// that are large or hold parts of the medial axis, a choice between distant values has wide
    /// remainders.
    #[inline(always)]
    pub(crate) fn or_by_steepness<const D: usize, const N: usize>(
        self,
        formula: AffineModel<N>,
        cell: &Vector<AffineModel<N>, D>,
    ) -> AffineModel<N> {
        let constant = self.by_steepness(formula.value, cell);
        if says_more(&formula, &constant) { formula } else { constant }
    }
}

/// A model with a slope says more than a constant that is as wide, and more than one that is
/// narrower by less than this share: near the surface, bounds get better with the square of a
/// cell's size only where models have a slope. A larger share leaves wider models.
const SLIGHTLY: f64 = 0.125;

/// `true` if a `model` says more than the `constant` by the steepness, which may be narrower: over
/// cells that are large or hold parts of the medial axis, a choice between distant values has
/// wide remainders.
#[inline(always)]
pub(crate) fn says_more<const N: usize>(
    model: &AffineModel<N>,
    constant: &AffineModel<N>,
) -> bool {
    let width = |model: &AffineModel<N>| model.maximum() - model.minimum();
    let remainders = |model: &AffineModel<N>| model.lower + model.upper;
    let is_nearly_a_plane = remainders(model) <= SLIGHTLY * remainders(constant);
    is_nearly_a_plane || width(model) <= width(constant)
}
