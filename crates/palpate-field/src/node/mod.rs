// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a shape is made of: its operator with its parameters, or its primitive.

mod build;
mod content;
mod faces;
mod primitive;
mod text;

use std::fmt;
use std::sync::Arc;

use crate::field::{CustomField, SharedField};
use crate::kernel::Argument;
use crate::operator::catalogue::Declared;
use crate::operator::{Copies, Operator};
use crate::pose::Pose;
use crate::shape::Shape;

pub use crate::operator::{Boolean, Profile};
pub(crate) use build::shape;
pub use primitive::Primitive;

/// One node of a shape: an operator with its parameters as they were given and the shapes
/// that it works on, or a primitive.
///
/// [`Shape::node`] gives the node of a shape, [`Shape::from_node`] builds a shape from one.
/// A shape that is built from its own node has the same bits.
///
/// # Normal form
///
/// `Shape::from_node` rewrites what can be said in several ways, so that loops over
/// operators do not nest without end:
///
/// - A union in a union becomes part of it, and likewise an intersection in an
///   intersection and a symmetric difference in a symmetric difference.
/// - A difference of a difference is one: `(a − b) − c` has the shapes `a, b, c`, as
///   `a − (b ∪ c)` has. A union, intersection or difference of one shape is that shape.
/// - A shape that is moved twice has one pose, the product, and a shape that is not moved
///   has none.
///
/// ```
/// use palpate_field::{Node, Shape};
///
/// # fn main() -> Result<(), palpate_field::ShapeError> {
/// let mut plate = Shape::cuboid([1.0, 0.1, 1.0])?;
/// let drill = Shape::cylinder(0.02, 0.2)?;
/// for i in 0..9 {
///     plate = plate - drill.clone().translated([0.1 * f64::from(i) - 0.4, 0.0, 0.0])?;
/// }
/// let Node::Difference(of) = plate.node() else { unreachable!() };
/// assert_eq!((of.len(), plate.depth()), (10, 3));
/// let Node::Primitive(cuboid) = of[0].node() else { unreachable!() };
/// assert_eq!(cuboid.name(), "cuboid");
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Node<const D: usize> {
    /// A primitive of the catalogue.
    Primitive(Primitive<D>),
    /// What is in any of the shapes.
    Union(Vec<Shape<D>>),
    /// What is in all of the shapes.
    Intersection(Vec<Shape<D>>),
    /// The first shape without the others.
    Difference(Vec<Shape<D>>),
    /// What is in an odd number of the shapes.
    SymmetricDifference(Vec<Shape<D>>),
    /// A boolean with its creases filled or cut off.
    Smooth {
        /// Which boolean.
        boolean: Boolean,
        /// The form of the fill.
        profile: Profile,
        /// The fill where two distances are equal [m].
        width: f64,
        /// The shapes.
        of: Vec<Shape<D>>,
    },
    /// A shape with its surface moved by another field.
    Displaced {
        /// The shape.
        of: Shape<D>,
        /// The field that moves its surface, outwards where it is positive.
        by: Shape<D>,
        /// The largest displacement [m].
        height: f64,
    },
    /// A shape between two others.
    Morphed {
        /// The shape at a progress of 0.
        from: Shape<D>,
        /// The shape at a progress of 1.
        into: Shape<D>,
        /// How far from the one to the other, from 0 to 1.
        progress: f64,
    },
    /// A shape moved.
    Placed {
        /// The motion, world from body.
        pose: Pose<D>,
        /// The shape in its own frame.
        of: Shape<D>,
    },
    /// A shape scaled about the origin.
    Scaled {
        /// The factor.
        factor: f64,
        /// The shape.
        of: Shape<D>,
    },
    /// A shape scaled along each axis.
    Stretched {
        /// One factor an axis.
        factors: [f64; D],
        /// The shape.
        of: Shape<D>,
    },
    /// A shape grown, or shrunk if the distance is negative.
    Offset {
        /// How far its surface moves outwards [m].
        distance: f64,
        /// The shape.
        of: Shape<D>,
    },
    /// A shape under an operator of the catalogue.
    Operated {
        /// The operator.
        operator: Operator,
        /// A number, or a vector where the operator has one for each axis.
        argument: Argument,
        /// The shape.
        of: Shape<D>,
    },
    /// The part of a shape at positive coordinates of an axis, and its mirror image.
    Mirrored {
        /// The number of the axis.
        axis: usize,
        /// The shape.
        of: Shape<D>,
    },
    /// Copies of a shape on a grid.
    Repeated {
        /// The copies along each axis.
        copies: [Copies; D],
        /// The shape.
        of: Shape<D>,
    },
    /// A shape turned in the plane of x and y by an angle that grows with x.
    Bent {
        /// The angle for each metre [rad/m].
        rate: f64,
        /// The shape.
        of: Shape<D>,
    },
    /// In space: a shape turned about y by an angle that grows with y.
    Twisted {
        /// The angle for each metre [rad/m].
        rate: f64,
        /// The shape.
        of: Shape<D>,
    },
    /// In space: a profile in x and z as a solid along y.
    Extruded {
        /// The full height [m].
        height: f64,
        /// The profile.
        of: Shape<2>,
    },
    /// In space: a profile in x and y turned about the y axis.
    Revolved {
        /// The profile.
        of: Shape<2>,
    },
    /// A kernel, field or closure of a user: it can be evaluated, not looked into.
    Opaque(Opaque<D>),
}

impl<const D: usize> Node<D> {
    /// The node of an operator of the catalogue.
    pub(crate) fn operated<O: Declared>(argument: Argument, of: Shape<D>) -> Self {
        Self::Operated { operator: O::OPERATOR, argument, of }
    }
}

/// A kernel, field or closure of a user.
///
/// It equals its copies, and fields of its type that [feed](crate::CustomField::content) the same bytes.
#[derive(Clone)]
pub struct Opaque<const D: usize> {
    kind: &'static str,
    field: SharedField<D>,
}

impl<const D: usize> Opaque<D> {
    pub(crate) fn new(kind: &'static str, field: SharedField<D>) -> Self {
        Self { kind, field }
    }

    /// The name of the Rust type of the kernel, field or closure.
    #[must_use]
    pub fn type_name(&self) -> &'static str {
        self.kind
    }

    /// The field that [`Shape::custom`] was given, if it has the type `F`.
    ///
    /// ```
    /// use palpate_field::{CustomField, Node, Point, Promise, Shape, Vector};
    ///
    /// #[derive(Debug)]
    /// struct Floor(Promise<2>);
    ///
    /// impl CustomField<2> for Floor {
    ///     fn distance(&self, p: Point<2>) -> f64 {
    ///         p[1]
    ///     }
    ///     fn distance_gradient(&self, p: Point<2>) -> (f64, Vector<f64, 2>) {
    ///         (p[1], Vector([0.0, 1.0]))
    ///     }
    ///     fn promise(&self) -> &Promise<2> {
    ///         &self.0
    ///     }
    /// }
    ///
    /// let floor = Shape::custom(Floor(Promise::lipschitz(None, 1.0)));
    /// let Node::Opaque(opaque) = floor.node() else { unreachable!() };
    /// assert!(opaque.custom::<Floor>().is_some());
    /// ```
    #[must_use]
    pub fn custom<F: CustomField<D>>(&self) -> Option<&F> {
        self.field.custom()?.downcast_ref()
    }

    /// What determines its values, if that is known.
    fn content(&self) -> Option<Vec<u8>> {
        let mut bytes = Vec::new();
        self.field.content(&mut |part| bytes.extend_from_slice(part)).then_some(bytes)
    }
}

impl<const D: usize> PartialEq for Opaque<D> {
    fn eq(&self, other: &Self) -> bool {
        self.field.is_same(&other.field)
            || self.kind == other.kind
                && self.content().is_some_and(|content| Some(content) == other.content())
    }
}

impl<const D: usize> fmt::Debug for Opaque<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "opaque({})", self.kind)
    }
}

impl<const D: usize> PartialEq for Shape<D> {
    /// Compares structure: operators, parameters and primitives, in their order.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(self.shared_node(), other.shared_node()) || self.node() == other.node()
    }
}
