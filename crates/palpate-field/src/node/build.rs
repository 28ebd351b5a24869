// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! From a node to a shape: the one place where operators become fields.
//!
//! A generic function is compiled in every crate that calls it, and an operator
//! drags its loops for every number type and instruction set along. So that those
//! are compiled in this crate alone, the last step goes through two functions that are
//! not generic, one for the plane and one for space.

use std::any::Any;

use super::Node;
use crate::error::ShapeError;
use crate::field::{SharedField, placed};
use crate::operator::{
    boolean, catalogue, distortion, domain, mixture, repetition, smooth, surface, transform,
};
use crate::pose::Pose;
use crate::shape::Shape;

/// A node that waits to be built, and what was built from it.
struct Task<const D: usize> {
    node: Option<Node<D>>,
    shape: Option<Result<Shape<D>, ShapeError>>,
}

/// Builds a node: the step from any dimension to the two that there are.
pub(crate) fn shape<const D: usize>(node: Node<D>) -> Result<Shape<D>, ShapeError> {
    let mut task = Task { node: Some(node), shape: None };
    let any: &mut dyn Any = &mut task;
    if let Some(task) = any.downcast_mut::<Task<2>>() {
        task.shape = task.node.take().map(planar);
    } else if let Some(task) = any.downcast_mut::<Task<3>>() {
        task.shape = task.node.take().map(spatial);
    }
    let needs = "two or three dimensions".into();
    task.shape.unwrap_or(Err(ShapeError::Unsuitable { operator: "shape", needs }))
}

/// Builds a node of the plane.
#[inline(never)]
fn planar(node: Node<2>) -> Result<Shape<2>, ShapeError> {
    built::<Planar, 2>(node)
}

/// Builds a node of space.
#[inline(never)]
fn spatial(node: Node<3>) -> Result<Shape<3>, ShapeError> {
    built::<Spatial, 3>(node)
}

/// The operators that one dimension has.
trait Dimension<const D: usize> {
    fn twisted(of: SharedField<D>, rate: f64) -> Result<SharedField<D>, ShapeError>;

    fn extruded(of: SharedField<2>, height: f64) -> Result<SharedField<D>, ShapeError>;

    fn revolved(of: SharedField<2>) -> Result<SharedField<D>, ShapeError>;
}

struct Planar;

struct Spatial;

fn needs_space<T>(operator: &'static str) -> Result<T, ShapeError> {
    Err(ShapeError::Unsuitable { operator, needs: "space".into() })
}

impl Dimension<2> for Planar {
    fn twisted(_: SharedField<2>, _: f64) -> Result<SharedField<2>, ShapeError> {
        needs_space("twist")
    }

    fn extruded(_: SharedField<2>, _: f64) -> Result<SharedField<2>, ShapeError> {
        needs_space("extrude")
    }

    fn revolved(_: SharedField<2>) -> Result<SharedField<2>, ShapeError> {
        needs_space("revolve")
    }
}

impl Dimension<3> for Spatial {
    fn twisted(of: SharedField<3>, rate: f64) -> Result<SharedField<3>, ShapeError> {
        distortion::twisted(of, rate)
    }

    fn extruded(of: SharedField<2>, height: f64) -> Result<SharedField<3>, ShapeError> {
        domain::extruded(of, height)
    }

    fn revolved(of: SharedField<2>) -> Result<SharedField<3>, ShapeError> {
        domain::revolved(of)
    }
}

fn built<S: Dimension<D>, const D: usize>(node: Node<D>) -> Result<Shape<D>, ShapeError> {
    let node = match normal(node)? {
        Normal::Shape(shape) => return Ok(shape),
        Normal::Node(node) => node,
    };
    let field = field::<S, D>(&node)?;
    Ok(Shape::of_parts(field, node))
}

/// A node in normal form, or a shape that already is what the node says.
enum Normal<const D: usize> {
    Node(Node<D>),
    Shape(Shape<D>),
}

/// Rewrites a node to its normal form.
fn normal<const D: usize>(node: Node<D>) -> Result<Normal<D>, ShapeError> {
    match node {
        Node::Union(of) => list("union", flat(of, members_of_union), Node::Union),
        Node::Intersection(of) => {
            list("intersection", flat(of, members_of_intersection), Node::Intersection)
        }
        Node::SymmetricDifference(of) => {
            let of = flat(of, members_of_symmetric_difference);
            list("symmetric_difference", of, Node::SymmetricDifference)
        }
        Node::Difference(mut of) => {
            let others = flat(of.split_off(of.len().min(1)), members_of_union);
            let mut of = flat(of, members_of_difference);
            of.extend(others);
            list("difference", of, Node::Difference)
        }
        Node::Placed { pose, of } => moved(pose, of),
        node => Ok(Normal::Node(node)),
    }
}

/// A list of at least one shape; one alone is itself.
fn list<const D: usize>(
    name: &'static str,
    mut of: Vec<Shape<D>>,
    node: fn(Vec<Shape<D>>) -> Node<D>,
) -> Result<Normal<D>, ShapeError> {
    match of.len() {
        0 => Err(boolean::nothing_in(name)),
        1 => Ok(Normal::Shape(of.swap_remove(0))),
        _ => Ok(Normal::Node(node(of))),
    }
}

/// The shapes, with those that have `members` replaced by them.
fn flat<const D: usize>(
    shapes: Vec<Shape<D>>,
    members: fn(&Node<D>) -> Option<&[Shape<D>]>,
) -> Vec<Shape<D>> {
    if shapes.iter().all(|shape| members(shape.node()).is_none()) {
        return shapes;
    }
    let own = |shape| members(Shape::node(shape)).unwrap_or(std::slice::from_ref(shape));
    shapes.iter().flat_map(own).cloned().collect()
}

fn members_of_union<const D: usize>(node: &Node<D>) -> Option<&[Shape<D>]> {
    if let Node::Union(of) = node { Some(of) } else { None }
}

fn members_of_intersection<const D: usize>(node: &Node<D>) -> Option<&[Shape<D>]> {
    if let Node::Intersection(of) = node { Some(of) } else { None }
}

fn members_of_symmetric_difference<const D: usize>(node: &Node<D>) -> Option<&[Shape<D>]> {
    if let Node::SymmetricDifference(of) = node { Some(of) } else { None }
}

fn members_of_difference<const D: usize>(node: &Node<D>) -> Option<&[Shape<D>]> {
    if let Node::Difference(of) = node { Some(of) } else { None }
}

/// A shape moved by the product of all its motions.
fn moved<const D: usize>(pose: Pose<D>, of: Shape<D>) -> Result<Normal<D>, ShapeError> {
    pose.check()?;
    let (pose, of) = match of.node() {
        Node::Placed { pose: inner, of } => (pose * *inner, of.clone()),
        _ => (pose, of),
    };
    pose.check()?;
    Ok(if pose.is_identity() {
        Normal::Shape(of)
    } else {
        Normal::Node(Node::Placed { pose, of })
    })
}

fn own<const D: usize>(shape: &Shape<D>) -> SharedField<D> {
    shape.field().clone()
}

fn all<const D: usize>(shapes: &[Shape<D>]) -> Vec<SharedField<D>> {
    shapes.iter().map(own).collect()
}

/// The field of a node in normal form.
fn field<S: Dimension<D>, const D: usize>(
    node: &Node<D>,
) -> Result<SharedField<D>, ShapeError> {
    match node {
        Node::Primitive(primitive) => primitive.field(),
        Node::Union(of) => boolean::union(all(of)),
        Node::Intersection(of) => boolean::intersection(all(of)),
        Node::Difference(of) => boolean::difference(all(of)),
        Node::SymmetricDifference(of) => boolean::symmetric_difference(all(of)),
        Node::Smooth { boolean, profile, width, of } => {
            smooth::smooth(*boolean, *profile, *width, all(of))
        }
        Node::Displaced { of, by, height } => mixture::displaced(own(of), own(by), *height),
        Node::Morphed { from, into, progress } => {
            mixture::morphed(own(from), own(into), *progress)
        }
        Node::Placed { pose, of } => placed(of.field(), pose),
        Node::Scaled { factor, of } => transform::scaled(own(of), *factor),
        Node::Stretched { factors, of } => transform::stretched(own(of), *factors),
        Node::Offset { distance, of } => surface::offset(own(of), *distance),
        Node::Operated { operator, argument, of } => {
            catalogue::field(operator, own(of), argument)
        }
        Node::Mirrored { axis, of } => domain::mirrored(own(of), *axis),
        Node::Repeated { copies, of } => repetition::repeated(own(of), *copies),
        Node::Bent { rate, of } => distortion::bent(own(of), *rate),
        Node::Twisted { rate, of } => S::twisted(own(of), *rate),
        Node::Extruded { height, of } => S::extruded(own(of), *height),
        Node::Revolved { of } => S::revolved(own(of)),
        Node::Opaque(opaque) => Ok(opaque.field.clone()),
    }
}
