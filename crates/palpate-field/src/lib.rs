//! Signed distance fields.
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod block;
mod bounds;
mod dispatch;
mod error;
pub mod field;
pub mod kernel;
pub mod operator;
mod pose;
mod promise;
pub mod scalar;
mod shape;
mod vector;

pub use block::{BLOCK, Block, Column, Gradients, Lane, LaneArray, Lanes, ModelLanes, SHORT};
pub use bounds::{Aabb, BoundingBall, Bounds};
pub use dispatch::InstructionSet;
pub use error::{LARGEST_LENGTH, Quantity, ShapeError, Unit};
pub use field::CustomField;
pub use kernel::Kernel;
pub use pose::{Pose, Rotation};
pub use promise::{Promise, Quality, Rounding};
pub use shape::{MAX_DEPTH, Shape};
pub use vector::{Point, Vector};
