// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fields as the searches and the servo evaluate them.
//!
//! A [`Field`] answers for one point, for a block of points with and without gradients, and for a
//! block of cells. Leaves hold a [`Kernel`](crate::kernel::Kernel); operators loop over their
//! children's blocks. After [`prepare`](SharedField::prepare), only a long tape of models
//! allocates.
//!
//! # How a block is evaluated
//!
//! [`SharedField`] chooses:
//!
//! | block of | with AVX2 or AVX-512 | without |
//! |---|---|---|
//! | points, `f64` | compiled loops | a tape |
//! | points with gradients | compiled loops | point by point |
//! | cells of three parameters | compiled loops | a tape |
//! | cells of four parameters | a tape | a tape |
//!
//! The first evaluation that needs a tape records it. No tape has the operations of a
//! [`CustomField`] or of a union of more than 16 members, which skips most of its members. Both
//! evaluate every block themselves. A kernel with the tangent rule bounds cells itself. An answer
//! in single precision is the answer in double precision, rounded once.

mod combine;
mod custom;
mod leaf;
mod nearby;
mod placed;
mod remap;
mod shared;
mod union;
mod warp;

use std::any::Any;
use std::fmt::Debug;

use crate::error::ShapeError;
use crate::machine::{Block, Column, Gradients};
use crate::pose::Pose;
use crate::promise::Promise;
use crate::scalar::{Model, Recorded, SpaceTimeModel};
use crate::vector::{Point, Vector};

pub use crate::pose::Placement;
pub(crate) use combine::{Combine, Combined, Minimum};
pub use custom::CustomField;
pub(crate) use custom::{Custom, FromClosure};
pub(crate) use leaf::Leaf;
pub(crate) use placed::placed;
pub(crate) use remap::{Remap, Remapped};
pub(crate) use shared::Asked;
pub use shared::{Evaluate, SharedField};
pub(crate) use union::Union;
pub(crate) use warp::{Warp, Warped};

/// The deepest nesting of fields: of operators, after nested booleans are flattened.
///
/// Each level of a block's evaluation needs at most 25 kB of stack.
pub const MAX_DEPTH: usize = 64;

/// The depth of an operator over `children`.
///
/// # Errors
///
/// If it is more than [`MAX_DEPTH`].
pub(crate) fn depth_over<'a, const D: usize>(
    children: impl IntoIterator<Item = &'a SharedField<D>>,
) -> Result<usize, ShapeError> {
    let deepest = children.into_iter().map(|child| child.depth()).max().unwrap_or(0);
    let depth = deepest + 1;
    if depth > MAX_DEPTH {
        return Err(ShapeError::TooDeep { depth, limit: MAX_DEPTH });
    }
    Ok(depth)
}

/// A signed distance field as an object.
///
/// Implemented by this crate alone; users write a [`Kernel`](crate::kernel::Kernel) or a
/// [`CustomField`]. Its loops over blocks are compiled only for AVX2 and AVX-512. A [`SharedField`]
/// answers on every machine.
pub trait Field<const D: usize>: Debug + Send + Sync {
    /// The signed distance at a point [m].
    ///
    /// Coordinates are three arguments, in the plane the last one zero: they travel
    /// in registers, where an array would be written and read again at every node,
    /// which doubles the latency of a tree.
    fn distance(&self, x: f64, y: f64, z: f64) -> f64;

    /// The signed distance at a point [m]; puts its gradient into `gradient`.
    fn distance_gradient(&self, x: f64, y: f64, z: f64, gradient: &mut Vector<f64, D>) -> f64;

    /// The signed distances in the first `count` lanes [m].
    ///
    /// The lanes of `out` past `count` are unspecified, here and below.
    fn distances(&self, p: &Block<f64, D>, count: usize, out: &mut Column<f64>);

    /// The signed distances [m] and gradients in the first `count` lanes.
    fn distances_gradients(&self, p: &Block<f64, D>, count: usize, out: &mut Gradients<f64, D>);

    /// Bounds over the cells in the first `count` lanes.
    fn models(&self, p: &Block<Model, D>, count: usize, out: &mut Column<Model>);

    /// The formula of the field at `p`; `None` where a [`CustomField`] is part of it.
    fn record(&self, p: Vector<Recorded, D>) -> Option<Recorded>;

    /// `true` if a tape can evaluate the distances.
    fn has_formula(&self) -> bool {
        true
    }

    /// The field's own models, if a tape cannot evaluate them.
    fn own_models(&self) -> Option<&dyn OwnModels<D>> {
        None
    }

    /// The promise of the values.
    fn promise(&self) -> &Promise<D>;

    /// How many operators are nested in the field, with the leaf; at most
    /// [`MAX_DEPTH`].
    fn depth(&self) -> usize;

    /// The field moved by `pose`, if the motion can go into it at no cost.
    fn placed(&self, pose: &Pose<D>) -> Option<SharedField<D>>;

    /// How many transforms more an evaluation has if a motion is pushed into the field
    /// instead of wrapped around it.
    ///
    /// A wrapper costs one transform on the critical path, so an operator takes the motion if that
    /// adds at most one.
    fn unplaced(&self) -> usize {
        1
    }

    /// How many leaves its tape has. A shared leaf counts each time.
    fn leaves_on_tape(&self) -> usize {
        1
    }

    /// The members, if this is a sharp union: a union of unions has them all.
    fn members(&self) -> Option<&[SharedField<D>]> {
        None
    }

    /// The [`CustomField`] that this is.
    fn custom(&self) -> Option<&dyn Any> {
        None
    }

    /// As [`CustomField::faces`].
    fn faces(&self, _visit: &mut dyn FnMut([Point<D>; D])) -> bool {
        false
    }

    /// Feeds `sink` with all that determines the values of a [`CustomField`]; `false` if that is not known.
    fn content(&self, _sink: &mut dyn FnMut(&[u8])) -> bool {
        false
    }
}

/// The models of a field whose operations are on no tape. They are the same on every machine.
pub trait OwnModels<const D: usize> {
    /// Bounds over boxes in space or in the plane.
    fn models(&self, p: &Block<Model, D>, count: usize, out: &mut Column<Model>);

    /// Bounds over boxes in space and time.
    fn space_time_models(
        &self,
        p: &Block<SpaceTimeModel, D>,
        count: usize,
        out: &mut Column<SpaceTimeModel>,
    );
}
