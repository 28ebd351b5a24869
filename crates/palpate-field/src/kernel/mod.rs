//! Closed formulas: what a leaf evaluates.

mod primitive;

mod ball;

use std::fmt::Debug;

pub use ball::Ball;
pub(crate) use primitive::primitive;
pub use primitive::{Argument, Entry, ModelRule, Parameter, ParameterKind, Primitive};

use crate::promise::Promise;
use crate::scalar::{Dual, Float, Model, Scalar};
use crate::vector::Vector;

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
/// assert_eq!((distance, gradient), (4.5, Vector([0.6, 0.0, 0.8])));
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

impl Entry<2> {
    /// All primitives of the plane.
    pub const ALL: &[Self] = &[Self::of::<Ball>()];
}

impl Entry<3> {
    /// All primitives of space.
    pub const ALL: &[Self] = &[Self::of::<Ball>()];
}
