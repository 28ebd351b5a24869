// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes as they are written: primitives, operators, references.

mod assemble;
mod deserialize;
pub(crate) mod operators;
mod primitive;
mod serialize;

use palpate_field::kernel::Argument;
use palpate_field::operator::Smooth;

pub use primitive::Primitive;

use crate::pose::WrittenRotation;

/// A shape as it is written, without a place of its own.
///
/// A node has no dimension: what it is made of decides in which it can be built.
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
    /// What it is for.
    pub description: Option<String>,
    /// What it is.
    pub form: Form,
}

/// What a node is.
///
/// Lengths are in metres; vectors have one number for each dimension.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// The shape of that name in the scene.
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
    /// The union with its creases filled.
    SmoothUnion {
        /// The shapes, blended in their order.
        of: Vec<Node>,
        /// The fill where two distances are equal [m].
        width: f64,
        /// The profile of the fill; quadratic if left out.
        profile: Option<Profile>,
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
        /// How much.
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
        /// The axis whose sign is ignored.
        axis: Axis,
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

/// The profile of the fill of a smooth union.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Profile {
    /// Reaches 4 times its width.
    Quadratic,
    /// Reaches 6 times its width, rounder at its ends.
    Cubic,
}

impl From<Profile> for Smooth {
    fn from(profile: Profile) -> Self {
        match profile {
            Profile::Quadratic => Self::Quadratic,
            Profile::Cubic => Self::Cubic,
        }
    }
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

    /// A primitive; the names of its arguments are those of files, angles in
    /// degrees.
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

impl Form {
    /// The key that carries the operands, and the operands.
    pub(crate) fn operands(&self) -> (&'static str, &[Node]) {
        match self {
            Self::Reference(_) | Self::Primitive(_) => ("", &[]),
            Self::Union(nodes) => (operators::UNION, nodes),
            Self::Intersection(nodes) => (operators::INTERSECTION, nodes),
            Self::Difference(nodes) => (operators::DIFFERENCE, nodes),
            Self::SymmetricDifference(nodes) => (operators::SYMMETRIC_DIFFERENCE, nodes),
            Self::SmoothUnion { of, .. } => (operators::SMOOTH_UNION, of),
            Self::Placed { of, .. }
            | Self::Scaled { of, .. }
            | Self::Offset { of, .. }
            | Self::Shell { of, .. }
            | Self::Elongated { of, .. }
            | Self::Mirrored { of, .. }
            | Self::Extruded { of, .. }
            | Self::Revolved { of } => (operators::OF, std::slice::from_ref(of)),
        }
    }
}
