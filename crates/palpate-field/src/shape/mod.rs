// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes: built from kernels, closures and operators, evaluated at points.

mod boolean;
mod domain;
mod in_space;
mod short;
mod slices;
mod surface;
mod transform;

pub use in_space::SpaceShape;

use std::sync::Arc;

use crate::error::ShapeError;
use crate::field::{Custom, CustomField, Evaluate, FromClosure, Leaf, SharedField};
use crate::kernel::Kernel;
use crate::machine::{BLOCK, Block, Column, Gradients};
use crate::node::{self, Node, Opaque, Primitive};
use crate::pose::Pose;
use crate::promise::Promise;
use crate::scalar::{Dual, Expression, Purpose};
use crate::vector::{Point, Vector};

/// A signed distance field in `D` dimensions, cheap to clone.
///
/// A shape can be looked into: [`node`](Self::node) is the operator or primitive that it
/// is, [`from_node`](Self::from_node) builds it again to the bit. `==` compares that
/// structure, and a shape prints as what builds it.
///
/// ```
/// use palpate_field::Shape;
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let ball = Shape::ball(0.05)?.translated([0.0, 0.06, 0.0])?;
/// let plate = Shape::cuboid([0.2, 0.02, 0.2])?;
/// let cup = &plate - &ball;
/// assert_eq!(
///     cup.to_string(),
///     "cuboid([0.2, 0.02, 0.2]) - ball(0.05).translated([0.0, 0.06, 0.0])",
/// );
/// assert_eq!(cup, Shape::from_node(cup.node().clone())?);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Shape<const D: usize> {
    field: SharedField<D>,
    node: Arc<Node<D>>,
}

impl<const D: usize> Shape<D> {
    /// A closed formula as a shape.
    ///
    /// Its node is a primitive with the arguments of the kernel, or opaque if the kernel is
    /// not of this crate.
    pub fn from_kernel(kernel: impl Kernel<D>) -> Self {
        let primitive = Primitive::of_kernel(&kernel);
        let kind = std::any::type_name_of_val(&kernel);
        let field = SharedField::new(Leaf::new(kernel));
        let opaque = || Node::Opaque(Opaque::new(kind, field.clone()));
        let node = primitive.map_or_else(opaque, Node::Primitive);
        Self::of_parts(field, node)
    }

    /// A closed formula, moved by `world_from_body`: the same as
    /// [`placed`](Self::placed) makes of [`from_kernel`](Self::from_kernel).
    ///
    /// ```
    /// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let world_from_body = Pose::translation(Vector([1.0, 2.0]));
    /// let ball = Shape::from_kernel_at(Ball::new(0.5)?, &world_from_body)?;
    /// assert_eq!(ball.distance(Vector([1.0, 4.0])), 1.5);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If a number of the pose is not finite.
    pub fn from_kernel_at(
        kernel: impl Kernel<D>,
        world_from_body: &Pose<D>,
    ) -> Result<Self, ShapeError> {
        Self::from_kernel(kernel).placed(world_from_body)
    }

    /// A [`CustomField`] as a shape.
    pub fn custom(field: impl CustomField<D>) -> Self {
        let kind = std::any::type_name_of_val(&field);
        let field = SharedField::new(Custom(field));
        let node = Node::Opaque(Opaque::new(kind, field.clone()));
        Self::of_parts(field, node)
    }

    /// A closure as a shape, with what it promises.
    ///
    /// The closure computes with [`Dual`] numbers, which give the gradient. For
    /// speed write a [`Kernel`]: its blocks vectorise, and it bounds cells better
    /// than by its Lipschitz constant.
    ///
    /// ```
    /// use palpate_field::scalar::{Dual, Scalar};
    /// use palpate_field::{Promise, Shape, Vector};
    ///
    /// // A wavy floor, at most √(1 + 0.2²) steep.
    /// let promise = Promise::lipschitz(None, 1.02);
    /// let floor = Shape::from_fn(promise, |Vector([x, y])| {
    ///     y - x.scale(20.0).sin().scale(0.01)
    /// });
    /// let (distance, gradient) = floor.distance_gradient(Vector([0.0, 0.5]));
    /// assert_eq!(distance, 0.5);
    /// assert_eq!(gradient, Vector([-0.2, 1.0]));
    /// ```
    pub fn from_fn(
        promise: Promise<D>,
        closure: impl Fn(Vector<Dual<f64, D>, D>) -> Dual<f64, D> + Send + Sync + 'static,
    ) -> Self {
        let kind = std::any::type_name_of_val(&closure);
        let field = SharedField::new(Custom(FromClosure { closure, promise }));
        let node = Node::Opaque(Opaque::new(kind, field.clone()));
        Self::of_parts(field, node)
    }

    /// A field and the node that says what it is.
    pub(crate) fn of_parts(field: SharedField<D>, node: Node<D>) -> Self {
        Self { field, node: Arc::new(node) }
    }

    /// Builds the shape that a node describes, after its parameters are checked.
    ///
    /// Operators and constructors build by this function. [`Node`] says which nodes are
    /// rewritten to a normal form.
    ///
    /// # Errors
    ///
    /// If a parameter breaks its rule, an operator needs what its shape does not have, or
    /// shapes are nested too deeply.
    pub fn from_node(node: Node<D>) -> Result<Self, ShapeError> {
        node::shape(node)
    }

    /// The operator with its parameters and shapes, or the primitive with its arguments.
    #[must_use]
    pub fn node(&self) -> &Node<D> {
        &self.node
    }

    /// The node, which another shape may hold.
    pub(crate) fn shared_node(&self) -> &Arc<Node<D>> {
        &self.node
    }

    /// The field that answers.
    pub(crate) fn field(&self) -> &SharedField<D> {
        &self.field
    }

    /// The formula of the distance, recorded through every operator and kernel; `None`
    /// where a [`CustomField`] or a closure is part of the shape.
    ///
    /// ```
    /// use palpate_field::Shape;
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let ring = Shape::circle(0.5)? - Shape::circle(0.25)?;
    /// let formula = ring.formula().unwrap();
    /// assert_eq!(formula.to_string(), "let v0 = norm(x, y)\nmax(v0 - 0.5, -(v0 - 0.25))");
    /// assert_eq!(formula.evaluate(&[3.0, 4.0]), ring.distance([3.0, 4.0]));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn formula(&self) -> Option<Expression> {
        Expression::record(|p| self.field.record(p))
    }

    /// The formula for a shader: as [`formula`](Self::formula), with thresholds of rounding of single
    /// precision, and with each number of the shape as a step of its own.
    ///
    /// So the formulas of shapes that differ in a size or a place alone differ in numbers alone: a
    /// shader whose numbers are uniforms need not be compiled again. Equal numbers can be merged
    /// by whoever writes the shader.
    ///
    /// ```
    /// use palpate_field::Shape;
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let formula = |width: f64| Shape::rectangle([width, 0.5]).map(|shape| shape.shader_formula());
    /// let (square, other) = (formula(0.5)?.unwrap(), formula(0.25)?.unwrap());
    /// assert_eq!(square.steps().len(), other.steps().len());
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn shader_formula(&self) -> Option<Expression> {
        Expression::record_for(Purpose::Shader, |p| self.field.record(p))
    }

    /// How many operators are nested in the shape, with the leaf; at most
    /// [`MAX_DEPTH`].
    #[must_use]
    pub fn depth(&self) -> usize {
        self.field.depth()
    }

    /// The promise of the distances.
    #[must_use]
    pub fn promise(&self) -> &Promise<D> {
        self.field.promise()
    }

    /// The signed distance at `p` [m]: negative inside, zero on the surface.
    #[inline]
    #[must_use]
    pub fn distance(&self, p: impl Into<Point<D>>) -> f64 {
        let (x, y, z) = p.into().coordinates();
        self.field.distance(x, y, z)
    }

    /// The signed distance at `p` [m] and its gradient.
    #[inline]
    #[must_use]
    pub fn distance_gradient(&self, p: impl Into<Point<D>>) -> (f64, Vector<f64, D>) {
        let mut gradient = Vector::ZERO;
        let (x, y, z) = p.into().coordinates();
        let distance = self.field.distance_gradient(x, y, z, &mut gradient);
        (distance, gradient)
    }

    /// The distances [m], or bounds of them, in the first `count` lanes of a block; the other lanes
    /// of `out` are unspecified.
    ///
    /// Blocks hold points in `f64`, or cells as [`Model`](crate::scalar::Model) or
    /// [`SpaceTimeModel`](crate::scalar::SpaceTimeModel).
    ///
    /// # Panics
    ///
    /// If a block has not so many lanes, or `points` has not so many that are written.
    #[inline]
    pub fn block_distances<S: Evaluate>(
        &self,
        points: &Block<S, D>,
        count: usize,
        out: &mut Column<S>,
    ) {
        assert!(count <= BLOCK, "{count} points in {BLOCK} lanes");
        self.field.evaluate(points, count, out);
    }

    /// The distances and gradients in the first `count` lanes of a block; the
    /// other lanes of `out` are unspecified.
    ///
    /// # Panics
    ///
    /// As [`block_distances`](Self::block_distances).
    #[inline]
    pub fn block_gradients(
        &self,
        points: &Block<f64, D>,
        count: usize,
        out: &mut Gradients<f64, D>,
    ) {
        assert!(count <= BLOCK, "{count} points in {BLOCK} lanes");
        self.field.gradients(points, count, out);
    }

    /// Records the tapes that the first evaluations of blocks would record, for which they would
    /// allocate. A servo may not allocate, so its bodies call this. On machines with AVX2 only
    /// blocks in space and time use tapes; these are not prepared.
    pub fn prepare(&self) {
        self.field.prepare();
    }

    /// The [`distance`](Self::distance) at a point in single precision, rounded once.
    #[inline]
    #[must_use]
    pub fn distance_f32(&self, p: impl Into<Vector<f32, D>>) -> f32 {
        self.distance(Vector(p.into().0.map(f64::from))) as f32
    }

    /// The [`distance_gradient`](Self::distance_gradient) at a point in single precision, each number
    /// rounded once.
    #[inline]
    #[must_use]
    pub fn distance_gradient_f32(&self, p: impl Into<Vector<f32, D>>) -> (f32, Vector<f32, D>) {
        let (distance, gradient) = self.distance_gradient(Vector(p.into().0.map(f64::from)));
        (distance as f32, Vector(gradient.0.map(|slope| slope as f32)))
    }

    /// The radius of a ball about `p` that is sure to hold no surface [m],
    /// rounding included; zero close to the surface.
    #[must_use]
    pub fn safe_radius(&self, p: impl Into<Point<D>>) -> f64 {
        let p = p.into();
        let promise = self.promise();
        (promise.safe_radius(p, self.distance(p)) - promise.rounding.within(p.norm())).max(0.0)
    }

    /// A place near `p` where the field is zero [m]: where the promise is exact the nearest point
    /// of the surface, else one close by.
    ///
    /// Newton's method along the gradient, which need not be of length one:
    /// `p − f·∇f/|∇f|²`, until the distance is rounding. `None` if the gradient
    /// vanishes on the way, it takes more than 64 steps, or the zero that is found has the inside on both
    /// sides, as bounds have at the wall where members of a union touch.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector, kernel::Ball};
    ///
    /// # fn main() -> Result<(), palpate_field::ShapeError> {
    /// let ball = Shape::from_kernel(Ball::new(0.5)?);
    /// assert_eq!(ball.surface_point(Vector([0.0, 2.0])), Some(Vector([0.0, 0.5])));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn surface_point(&self, p: impl Into<Point<D>>) -> Option<Point<D>> {
        const MOST_STEPS: usize = 64;
        const SMALLEST_SLOPE: f64 = 1e-6;
        /// In roundings.
        const FAR: f64 = 16.0;
        let mut p = p.into();
        for _ in 0..MOST_STEPS {
            let (distance, gradient) = self.distance_gradient(p);
            let rounding = self.promise().rounding.within(p.norm());
            if distance.abs() <= rounding {
                let aside = gradient * (FAR * rounding);
                let is_inside = |p| self.distance(p) < -rounding;
                let is_wall = is_inside(p + aside) && is_inside(p - aside);
                return (!is_wall).then_some(p);
            }
            let steepness = gradient.dot(gradient);
            if steepness.is_nan() || steepness < SMALLEST_SLOPE * SMALLEST_SLOPE {
                return None;
            }
            p -= gradient * (distance / steepness);
        }
        None
    }
}
