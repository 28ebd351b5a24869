//! What a user builds.

use std::sync::Arc;

use crate::error::ShapeError;
use crate::field::{Custom, CustomField, DifferentiateBlock, EvaluateBlock, Field, Leaf};
use crate::kernel::Kernel;
use crate::machine::{BLOCK, Block, Column, Gradients, Lane};
use crate::promise::Promise;
use crate::scalar::Float;
use crate::vector::{Point, Vector};

/// The deepest nesting of operators, after nested unions are flattened.
///
/// Each level of a block's evaluation needs at most 25 kB of stack.
pub const MAX_DEPTH: usize = 64;

/// A signed distance field in `D` dimensions, cheap to clone.
#[derive(Clone, Debug)]
pub struct Shape<const D: usize> {
    field: Arc<dyn Field<D>>,
    depth: usize,
}

impl<const D: usize> Shape<D> {
    /// A closed formula as a shape.
    pub fn from_kernel(kernel: impl Kernel<D>) -> Self {
        Self::from_node(Arc::new(Leaf::new(kernel)))
    }

    /// A field that is no formula as a shape.
    pub fn custom(field: impl CustomField<D>) -> Self {
        Self::from_node(Arc::new(Custom(field)))
    }

    pub(crate) fn from_node(field: Arc<dyn Field<D>>) -> Self {
        Self { field, depth: 1 }
    }

    /// An operator over shapes, `depth` levels deep.
    pub(crate) fn from_operator(
        field: Arc<dyn Field<D>>,
        depth: usize,
    ) -> Result<Self, ShapeError> {
        if depth > MAX_DEPTH {
            return Err(ShapeError::TooDeep { depth, limit: MAX_DEPTH });
        }
        Ok(Self { field, depth })
    }

    /// The depth of the deepest of `shapes`.
    pub(crate) fn deepest(shapes: &[Self]) -> usize {
        shapes.iter().map(|shape| shape.depth).max().unwrap_or(0)
    }

    /// How many operators are nested in the shape, with the leaf; at most
    /// [`MAX_DEPTH`].
    #[must_use]
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// The node that answers.
    #[inline(always)]
    pub(crate) fn field(&self) -> &(dyn Field<D> + 'static) {
        &*self.field
    }

    /// What the distances promise.
    #[must_use]
    pub fn promise(&self) -> &Promise<D> {
        self.field.promise()
    }

    /// The signed distance at `p` [m]: negative inside, zero on the surface.
    #[inline]
    #[must_use]
    pub fn distance(&self, p: Point<D>) -> f64 {
        let (x, y, z) = p.coordinates();
        self.field.distance(x, y, z)
    }

    /// The signed distance at `p` [m] and its gradient.
    #[inline]
    #[must_use]
    pub fn distance_gradient(&self, p: Point<D>) -> (f64, Vector<f64, D>) {
        let mut gradient = Vector::ZERO;
        let (x, y, z) = p.coordinates();
        let distance = self.field.distance_gradient(x, y, z, &mut gradient);
        (distance, gradient)
    }

    /// The signed distances at `points` [m], with their gradients if `gradients`
    /// has room for them.
    ///
    /// Points are evaluated in blocks; the bits are those of
    /// [`distance`](Self::distance) and
    /// [`distance_gradient`](Self::distance_gradient).
    ///
    /// # Panics
    ///
    /// If `distances` is not as long as `points`.
    pub fn distances(&self, points: &[Point<D>], distances: &mut [f64]) {
        assert_eq!(points.len(), distances.len(), "one distance for each point");
        let mut block = Block::<f64, D, BLOCK>::zero();
        let mut column = Column::<f64, BLOCK>::zero();
        for (points, distances) in points.chunks(BLOCK).zip(distances.chunks_mut(BLOCK)) {
            for (i, p) in points.iter().enumerate() {
                block.set(i, *p);
            }
            self.block_distances(&block, points.len(), &mut column);
            for (i, distance) in distances.iter_mut().enumerate() {
                *distance = column.get(i);
            }
        }
    }

    /// The distances in the first `count` lanes of a block [m]; the other lanes
    /// of `out` are unspecified.
    ///
    /// Blocks hold [`BLOCK`] or [`SHORT`](crate::SHORT) points of `f64`, [`BLOCK`] of `f32`,
    /// and [`BLOCK`] cells of [`Model`](crate::scalar::Model).
    #[inline]
    pub fn block_distances<S: Lane, const W: usize>(
        &self,
        points: &Block<S, D, W>,
        count: usize,
        out: &mut Column<S, W>,
    ) where
        dyn Field<D>: EvaluateBlock<S, D, W>,
    {
        self.field.distances(points, count, out);
    }

    /// The distances and gradients in the first `count` lanes of a block; the
    /// other lanes of `out` are unspecified.
    #[inline]
    pub fn block_gradients<T: Float + Lane, const W: usize>(
        &self,
        points: &Block<T, D, W>,
        count: usize,
        out: &mut Gradients<T, D, W>,
    ) where
        dyn Field<D>: DifferentiateBlock<T, D, W>,
    {
        self.field.distances_gradients(points, count, out);
    }

    /// The distance in single precision at a point in single precision.
    #[inline]
    #[must_use]
    pub fn distance_f32(&self, p: Vector<f32, D>) -> f32 {
        let (x, y, z) = p.coordinates();
        self.field.distance(x, y, z)
    }

    /// The distance and its gradient in single precision.
    #[inline]
    #[must_use]
    pub fn distance_gradient_f32(&self, p: Vector<f32, D>) -> (f32, Vector<f32, D>) {
        let mut gradient = Vector([0.0; D]);
        let (x, y, z) = p.coordinates();
        let distance = self.field.distance_gradient(x, y, z, &mut gradient);
        (distance, gradient)
    }

    /// The radius of a ball about `p` that is sure to hold no surface [m],
    /// rounding included; zero close to the surface.
    #[must_use]
    pub fn safe_radius(&self, p: Point<D>) -> f64 {
        let promise = self.promise();
        let radius = promise.safe_radius(self.distance(p));
        (radius - promise.rounding.within(p.norm())).max(0.0)
    }
}
