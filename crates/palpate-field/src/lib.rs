// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Signed distance fields.

mod bounds;
pub mod catalogue;
mod convert;
mod error;
pub mod field;
#[doc(hidden)]
pub mod internal;
pub mod kernel;
mod machine;
mod mass;
pub mod node;
pub mod operator;
mod pose;
mod promise;
mod rotation_vector;
pub mod scalar;
mod screw;
mod shape;
mod strided;
mod vector;

pub use bounds::{Aabb, BoundingBall, Bounds};
pub use error::{LARGEST_LENGTH, Quantity, SMALLEST_LENGTH, ShapeError, ShapeErrorKind, Unit};
pub use field::CustomField;
pub use field::MAX_DEPTH;
pub use kernel::Kernel;
pub use machine::{
    BLOCK, Block, Column, Gradients, InstructionSet, Lane, LaneArray, Lanes, ModelLanes, SHORT,
};
pub use mass::{Mass, MassLimits};
pub use node::Node;
pub use pose::{Pose, Rotation};
pub use promise::{Promise, Quality, Rounding};
pub use screw::Screw;
pub use shape::Shape;
pub use strided::{Layout, Strided, StridedMut};
pub use vector::{Point, Vector};
