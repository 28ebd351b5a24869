// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes as they are written: primitives, operators, references.

mod assemble;
mod deserialize;
pub(crate) mod operators;
mod primitive;
pub(crate) mod profile;
mod serialize;

use palpate_field::kernel::Argument;
use palpate_field::operator::{Boolean, Profile};

pub use primitive::Primitive;

use crate::angle::Angle;
use crate::pose::WrittenRotation;

/// A shape as a file gives it: an operator, a primitive or a reference, with a description.
///
/// A node has no dimension. Its primitives and operators decide in which it can be built.
///
/// ```
/// use palpate_scene::{Form, Node};
///
/// # fn main() -> Result<(), serde_json::Error> {
/// let text = r#"{ "offset": 0.01, "of": "cup", "description": "the cup with its glaze" }"#;
/// let node: Node = serde_json::from_str(text)?;
/// assert_eq!(node.description.as_deref(), Some("the cup with its glaze"));
/// assert_eq!(node.form, Form::Offset { distance: 0.01, of: Box::new(Node::reference("cup")) });
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// A note for readers of the file.
    pub description: Option<String>,
    /// The operator, primitive or reference.
    pub form: Form,
}

/// The operator, primitive or reference of a node.
///
/// Lengths are in metres; vectors have one number for each dimension.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// A reference to the named shape of the scene.
    Reference(String),
    /// A primitive with its parameters.
    Primitive(Primitive),
    /// What is in any of the shapes.
    Union(Vec<Node>),
    /// What is in all of the shapes.
    Intersection(Vec<Node>),
    /// What is in the first shape and none of the others.
    Difference(Vec<Node>),
    /// What is in an odd number of the shapes.
    SymmetricDifference(Vec<Node>),
    /// A boolean with its creases filled, or its edges rounded off.
    Smooth {
        /// Which boolean.
        boolean: Boolean,
        /// The shapes, blended in their order.
        of: Vec<Node>,
        /// How far the surface moves where two distances are equal [m].
        width: f64,
        /// The profile of the crease; quadratic if left out.
        profile: Option<Profile>,
    },
    /// The first shape with its surface moved by the second field.
    Displaced {
        /// The shape, and the field.
        of: Vec<Node>,
        /// How far the surface moves at most [m].
        height: f64,
    },
    /// A shape between the first and the second.
    Morphed {
        /// The two shapes.
        of: Vec<Node>,
        /// How far from the first to the second, from 0 to 1.
        progress: f64,
    },
    /// The shape turned, then moved.
    Placed {
        /// The translation [m].
        translate: Option<Vec<f64>>,
        /// The rotation.
        rotation: Option<WrittenRotation>,
        /// The shape.
        of: Box<Node>,
    },
    /// The shape scaled about the origin.
    Scaled {
        /// The factor.
        factor: Factor,
        /// The shape.
        of: Box<Node>,
    },
    /// The shape grown, or shrunk if negative.
    Offset {
        /// How far its surface moves [m].
        distance: f64,
        /// The shape.
        of: Box<Node>,
    },
    /// A wall on the surface of the shape.
    Shell {
        /// Its thickness, half on each side [m].
        thickness: f64,
        /// The shape.
        of: Box<Node>,
    },
    /// The shape cut at the coordinate planes and pulled apart.
    Elongated {
        /// How far along each axis [m].
        lengths: Vec<f64>,
        /// The shape.
        of: Box<Node>,
    },
    /// The positive side of the shape and its mirror image.
    Mirrored {
        /// The axis along which it is mirrored.
        axis: Axis,
        /// The shape.
        of: Box<Node>,
    },
    /// Copies of the shape along axes.
    Repeated {
        /// The rows of copies.
        rows: Rows,
        /// The shape.
        of: Box<Node>,
    },
    /// The shape turned in the plane of x and y, more and more along x.
    Bent {
        /// The angle for each metre.
        rate: Angle,
        /// The shape.
        of: Box<Node>,
    },
    /// The shape turned about y, more and more along y; in space alone.
    Twisted {
        /// The angle for each metre.
        rate: Angle,
        /// The shape.
        of: Box<Node>,
    },
    /// A flat shape, drawn in x and z, given a height along y.
    Extruded {
        /// The height [m].
        height: f64,
        /// The shape, in two dimensions.
        of: Box<Node>,
    },
    /// A flat shape turned about y.
    Revolved {
        /// The shape, in two dimensions, its x the distance from the axis.
        of: Box<Node>,
    },
}

/// How much a shape is scaled.
#[derive(Clone, Debug, PartialEq)]
pub enum Factor {
    /// In every direction alike.
    Uniform(f64),
    /// Along each axis on its own.
    Axes(Vec<f64>),
}

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// The first.
    X,
    /// The second, up in pictures.
    Y,
    /// The third, in space alone.
    Z,
}

/// Rows of copies, along the axes that have one.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    serde::Serialize,
    serde::Deserialize,
    schemars::JsonSchema,
)]
#[serde(deny_unknown_fields)]
pub struct Rows {
    /// Along x.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x: Option<Row>,
    /// Along y.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y: Option<Row>,
    /// Along z, in space alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z: Option<Row>,
}

/// A row of copies: between two numbers, or without end. A row from 0 to 0 without a spacing is
/// the shape alone, as along an axis without a row.
#[derive(
    Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// From one copy to the next [m]; needed if there is more than the shape itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spacing: Option<f64>,
    /// The lowest number of a copy, the shape itself being number 0; goes with `last`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first: Option<i32>,
    /// The highest number of a copy; goes with `first`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last: Option<i32>,
}

impl Node {
    /// A node without a description.
    #[must_use]
    pub fn new(form: Form) -> Self {
        Self { description: None, form }
    }

    /// The shape called `name`.
    pub fn reference(name: impl Into<String>) -> Self {
        Self::new(Form::Reference(name.into()))
    }

    /// A primitive; the names of its arguments are the keys of files: `angle_degrees` for an
    /// angle in degrees, `angle` for one in radians.
    pub fn primitive(
        name: impl Into<String>,
        arguments: impl IntoIterator<Item = (String, Argument)>,
    ) -> Self {
        let arguments = arguments.into_iter().collect();
        Self::new(Form::Primitive(Primitive {
            name: name.into(),
            description: None,
            arguments,
        }))
    }
}

/// The key of a smooth boolean.
pub(crate) fn smooth_key(boolean: Boolean) -> &'static str {
    match boolean {
        Boolean::Union => operators::SMOOTH_UNION,
        Boolean::Intersection => operators::SMOOTH_INTERSECTION,
        Boolean::Difference => operators::SMOOTH_DIFFERENCE,
    }
}

impl Form {
    /// The key that carries the operands, and the operands.
    pub(crate) fn operands(&self) -> (&'static str, &[Node]) {
        match self {
            Self::Reference(_) | Self::Primitive(_) => ("", &[]),
            Self::Union(nodes) => (operators::UNION, nodes),
            Self::Intersection(nodes) => (operators::INTERSECTION, nodes),
            Self::Difference(nodes) => (operators::DIFFERENCE, nodes),
            Self::SymmetricDifference(nodes) => (operators::SYMMETRIC_DIFFERENCE, nodes),
            Self::Smooth { boolean, of, .. } => (smooth_key(*boolean), of),
            Self::Displaced { of, .. } => (operators::DISPLACE, of),
            Self::Morphed { of, .. } => (operators::MORPH, of),
            Self::Placed { of, .. }
            | Self::Scaled { of, .. }
            | Self::Offset { of, .. }
            | Self::Shell { of, .. }
            | Self::Elongated { of, .. }
            | Self::Mirrored { of, .. }
            | Self::Repeated { of, .. }
            | Self::Bent { of, .. }
            | Self::Twisted { of, .. }
            | Self::Extruded { of, .. }
            | Self::Revolved { of } => (operators::OF, std::slice::from_ref(of)),
        }
    }
}
