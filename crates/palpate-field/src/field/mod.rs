// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fields as the searches and the servo evaluate them.
//!
//! A [`Field`] answers for one point, for a block of points with and without
//! gradients, and for a block of cells. Leaves hold a
//! [`Kernel`](crate::kernel::Kernel); operators loop over their children's
//! blocks. Nothing here allocates.

mod combine;
mod custom;
mod leaf;
mod nearby;
mod placed;
mod remap;
mod union;
mod union_cells;
mod warp;

use std::fmt::Debug;
use std::sync::Arc;

use crate::error::ShapeError;
use crate::machine::{BLOCK, Block, Column, Gradients, Lane, SHORT};
use crate::pose::Pose;
use crate::promise::Promise;
use crate::scalar::{Float, Model, Recorded, SpaceTimeModel};
use crate::vector::{Point, Vector};

pub use crate::pose::Placement;
pub(crate) use combine::{Combine, Combined, Minimum};
pub use custom::CustomField;
pub(crate) use custom::{Custom, FromClosure};
pub(crate) use leaf::Leaf;
pub(crate) use placed::placed;
pub(crate) use remap::{Remap, Remapped};
pub(crate) use union::Union;
pub(crate) use warp::{Warp, Warped};

/// The deepest nesting of fields: of operators, after nested booleans are flattened.
///
/// Each level of a block's evaluation needs at most 25 kB of stack.
pub const MAX_DEPTH: usize = 64;

/// A field that several shapes and fields may hold.
pub type SharedField<const D: usize> = Arc<dyn Field<D>>;

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

/// Answers for one point.
///
/// Coordinates are three arguments, in the plane the last one zero: they travel
/// in registers, where an array would be written and read again at every node,
/// which doubles the latency of a tree.
pub trait EvaluatePoint<T: Float, const D: usize> {
    /// The signed distance at a point [m].
    fn distance(&self, x: T, y: T, z: T) -> T;

    /// The signed distance at a point [m]; puts its gradient into `gradient`.
    fn distance_gradient(&self, x: T, y: T, z: T, gradient: &mut Vector<T, D>) -> T;
}

/// Answers for a block of points or cells.
pub trait EvaluateBlock<S: Lane, const D: usize, const W: usize> {
    /// The signed distances in the first `count` lanes [m].
    ///
    /// The lanes of `out` past `count` are unspecified.
    fn distances(&self, p: &Block<S, D, W>, count: usize, out: &mut Column<S, W>);
}

/// Answers for a block of points, with gradients.
pub trait DifferentiateBlock<T: Float + Lane, const D: usize, const W: usize> {
    /// The signed distances [m] and gradients in the first `count` lanes.
    ///
    /// The lanes of `out` past `count` are unspecified.
    fn distances_gradients(
        &self,
        p: &Block<T, D, W>,
        count: usize,
        out: &mut Gradients<T, D, W>,
    );
}

/// Gives the formula, for numbers of the precision of `T`.
pub trait RecordFormula<T: Float, const D: usize> {
    /// The formula of the field at `p`; `None` where a [`CustomField`] is part of it.
    fn record(&self, p: Vector<Recorded<T>, D>) -> Option<Recorded<T>>;
}

/// A field after a motion that went into it, or the same field, if it takes none.
pub type Moved<const D: usize> = Result<SharedField<D>, SharedField<D>>;

/// A signed distance field as an object.
///
/// Implemented by this crate alone; users write a
/// [`Kernel`](crate::kernel::Kernel) or a [`CustomField`]. Scalar calls, blocks
/// and instruction sets agree bit for bit within a number type.
pub trait Field<const D: usize>:
    EvaluatePoint<f64, D>
    + EvaluatePoint<f32, D>
    + EvaluateBlock<f64, D, BLOCK>
    + EvaluateBlock<f64, D, SHORT>
    + EvaluateBlock<f32, D, BLOCK>
    + EvaluateBlock<Model, D, BLOCK>
    + EvaluateBlock<SpaceTimeModel, D, BLOCK>
    + DifferentiateBlock<f64, D, BLOCK>
    + DifferentiateBlock<f64, D, SHORT>
    + DifferentiateBlock<f32, D, BLOCK>
    + RecordFormula<f64, D>
    + RecordFormula<f32, D>
    + Debug
    + Send
    + Sync
{
    /// The promise of the values.
    fn promise(&self) -> &Promise<D>;

    /// How many operators are nested in the field, with the leaf; at most
    /// [`MAX_DEPTH`].
    fn depth(&self) -> usize;

    /// The field moved by `pose`, if the motion can go into it at no cost.
    ///
    /// # Errors
    ///
    /// The same field, if it takes no motion.
    fn placed(self: Arc<Self>, pose: &Pose<D>) -> Moved<D>;

    /// How many transforms more an evaluation has if a motion is pushed into the field
    /// instead of wrapped around it.
    ///
    /// A wrapper costs one transform on the critical path, so an operator takes the motion if that
    /// adds at most one.
    fn unplaced(&self) -> usize {
        1
    }

    /// The members, if this is a sharp union: a union of unions has them all.
    fn members(&self) -> Option<&[SharedField<D>]> {
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
