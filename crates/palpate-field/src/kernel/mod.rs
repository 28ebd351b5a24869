//! Closed formulas: what a leaf evaluates.

mod primitive;

mod ball;
mod capsule;
mod cuboid;
mod ellipsoid;
mod half_space;
pub mod planar;
mod simplex;
pub mod spatial;

use std::fmt::Debug;

pub use ball::Ball;
pub use capsule::{Capsule, Segment};
pub use cuboid::{Cuboid, RoundedCuboid};
pub use ellipsoid::Ellipsoid;
pub use half_space::HalfSpace;
pub use planar::*;
pub(crate) use primitive::primitive;
pub use primitive::{Argument, Entry, ModelRule, Parameter, ParameterKind, Primitive};
pub use simplex::Simplex;
pub use spatial::*;

use crate::promise::Promise;
use crate::scalar::{Dual, Float, Model, Scalar};
use crate::vector::{Vector, array};

/// A closed formula for a signed distance.
///
/// One branch-free function; everything else follows from it. Mark its methods
/// `#[inline(always)]`, so that blocks of it vectorise.
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

    /// The signed distance and its gradient: by duals, unless the formula has
    /// something cheaper or must treat a singular point.
    ///
    /// The distance must have the same bits as [`distance`](Self::distance).
    #[inline(always)]
    fn distance_gradient<T: Float>(&self, p: Vector<T, D>) -> (T, Vector<T, D>) {
        let result = self.distance(Vector(Dual::variables(p.0)));
        (result.value, Vector(result.gradient))
    }

    /// Bounds over the cell whose coordinates are `cell`: by the formula, unless
    /// it is not closed in the operations of [`Model`] or a bound is tighter.
    #[inline(always)]
    fn model(&self, cell: Vector<Model, D>) -> Model {
        self.distance(cell)
    }

    /// What the distance promises.
    fn promise(&self) -> Promise<D>;
}

/// Bounds a convex exact kernel over a cell by its tangent plane; `operations`
/// and `size` as for [`Rounding::of_operations`](crate::Rounding::of_operations).
#[inline(always)]
pub(crate) fn tangent_model<K: Kernel<D>, const D: usize>(
    kernel: &K,
    cell: Vector<Model, D>,
    operations: f64,
    size: f64,
) -> Model {
    let centre = Vector(array!(i < D => cell.0[i].value));
    let (distance, normal) = kernel.distance_gradient(centre);
    let rounding = operations * f64::EPSILON * (size + centre.norm());
    Model::tangent(distance, normal.0, &cell.0, rounding)
}

impl Entry<2> {
    /// All primitives of the plane.
    pub const ALL: &[Self] = &[
        Self::of::<Ball>(),
        Self::of::<Cuboid<2>>(),
        Self::of::<RoundedCuboid<2>>(),
        Self::of::<Capsule>(),
        Self::of::<Segment<2>>(),
        Self::of::<HalfSpace<2>>(),
        Self::of::<Simplex<2>>(),
        Self::of::<Ellipsoid<2>>(),
        Self::of::<Ring>(),
        Self::of::<Arc>(),
        Self::of::<RegularPolygon>(),
        Self::of::<RegularStar>(),
        Self::of::<Polygon>(),
        Self::of::<CoolS>(),
    ];
}

impl Entry<3> {
    /// All primitives of space.
    pub const ALL: &[Self] = &[
        Self::of::<Ball>(),
        Self::of::<Cuboid<3>>(),
        Self::of::<RoundedCuboid<3>>(),
        Self::of::<Capsule>(),
        Self::of::<Segment<3>>(),
        Self::of::<HalfSpace<3>>(),
        Self::of::<Simplex<3>>(),
        Self::of::<Ellipsoid<3>>(),
        Self::of::<Cylinder>(),
        Self::of::<RoundedCylinder>(),
        Self::of::<InfiniteCylinder>(),
        Self::of::<CappedCone>(),
        Self::of::<Cone>(),
        Self::of::<Pyramid>(),
        Self::of::<Torus>(),
        Self::of::<HexagonalPrism>(),
        Self::of::<TriangularPrism>(),
        Self::of::<Octahedron>(),
        Self::of::<CubeApproximation>(),
        Self::of::<CylinderApproximation>(),
        Self::of::<ConeApproximation>(),
        Self::of::<PyramidApproximation>(),
    ];
}
