// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Signed distance fields in the plane and in space, which say what their distances promise.
//!
//! - **Shapes.** A [`Shape`] is a field to build and to ask: a constructor for each primitive
//!   ([`catalogue`]), [`distance`](Shape::distance), [`distance_gradient`](Shape::distance_gradient),
//!   [`surface_point`](Shape::surface_point), [`mass`](Shape::mass).
//! - **Operators.** `|`, `&`, `^` and `-`; methods that blend, offset, move, repeat, bend and
//!   twist; [`operator`] has their formulas.
//! - **Promises.** A [`Promise`] says on each side whether values are exact distances or bounds,
//!   how steep the field is, where the shape lies, and how large roundings are.
//! - **Nodes.** [`Shape::node`] gives what a shape was made of, [`Shape::from_node`] builds it
//!   again to the bit.
//! - **Custom fields.** A [`Kernel`] is one formula, generic in its number ([`scalar`]): distances,
//!   gradients, bounds over cells and recorded formulas are evaluations of it. A closure goes
//!   through `Shape::from_fn`, what is no formula through [`CustomField`].
//! - **Blocks.** [`Shape::distances`] takes slices, [`Shape::distances_strided`] arrays with
//!   strides; a [`Block`] holds up to 64 points. A point, a block and every
//!   [`InstructionSet`] give the same bits.
//!
//! ```
//! use palpate_field::{Quality, Shape, ShapeError};
//!
//! # fn main() -> Result<(), ShapeError> {
//! let bowl = Shape::sphere(0.5)?.shell(0.25)? & Shape::half_space([0.0, 1.0, 0.0], 0.0)?;
//! assert_eq!(bowl.distance([0.0, -1.0, 0.0]), 0.375); // below the bottom [m]
//! assert_eq!(bowl.promise().outside, Quality::Bound); // as of any intersection
//! let moved = bowl.translated([0.0, 1.0, 0.0])?;
//! assert_eq!(moved.distance_gradient([0.0, 0.0, 0.0]), (0.375, [0.0, -1.0, 0.0].into()));
//! # Ok(())
//! # }
//! ```

mod bounds;
pub mod catalogue;
mod compile;
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
#[cfg(feature = "oracle")]
#[doc(hidden)]
pub mod oracle;
mod pose;
mod promise;
pub mod scalar;
mod shape;
mod strided;
mod unknown_name;
mod vector;

pub use bounds::{Aabb, BoundingBall, Bounds};
pub use error::{LARGEST_LENGTH, Quantity, SMALLEST_LENGTH, ShapeError, ShapeErrorKind, Unit};
pub use field::{CustomField, MAX_DEPTH};
pub use kernel::Kernel;
pub use machine::{
    BLOCK, Block, Column, Gradients, InstructionSet, Lane, LaneArray, Lanes, ModelLanes, Wide,
    wide,
};
pub use mass::{Mass, MassLimits};
pub use node::Node;
pub use pose::{Pose, Rotation, Screw};
pub use promise::{Deviation, Promise, Quality, Rounding};
pub use shape::{Shape, SpaceShape};
pub use strided::{Layout, Strided, StridedMut};
pub use unknown_name::UnknownName;
pub use vector::{Point, Vector};
