// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A separation with the boxes that prove it.

use palpate_field::{Aabb, Pose};

use super::body_pair::BodyPair;
use super::search::PairSearch;
use super::{Nearest, PairWorkspace};
use crate::certified::{Certified, Limits};
use crate::engine::Frontier;
use crate::error::QueryError;
use crate::goal::Goal;
use crate::placed::Placed;

/// The separation of two bodies, and the boxes that prove it.
#[derive(Clone, Debug)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Proof<const D: usize> {
    /// The answer, as [`separation`](crate::separation) gives it.
    pub answer: Certified<Nearest<D>>,
    /// From the coordinates of the boxes, which are the first body's, to the world's.
    pub world_from_boxes: Pose<D>,
    /// Boxes that cover the searched region without gaps: in them, as outside, twice the larger
    /// `g` is at least the answer's lower bound.
    pub boxes: Vec<ProofBox<D>>,
}

/// A box and its proven bound.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ProofBox<const D: usize> {
    /// The box, in the first body's coordinates.
    pub aabb: Aabb<D>,
    /// Proven lower bound of twice the larger `g` in the box [m].
    pub lower: f64,
}

/// The [`separation`](crate::separation) of two bodies with its proof: the searched box in
/// parts, each with its own bound. Outside of this box, the larger `g` exceeds that of the
/// best point.
///
/// # Errors
///
/// If neither body is bounded, or a pose or the tolerance is NaN or out of range.
pub fn proof<'a, const D: usize>(
    a: impl Into<Placed<'a, D>>,
    b: impl Into<Placed<'a, D>>,
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Proof<D>, QueryError> {
    prove([a.into(), b.into()], limits, workspace)
}

#[inline(never)]
pub(crate) fn prove<const D: usize>(
    [a, b]: [Placed<'_, D>; 2],
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Proof<D>, QueryError> {
    let pair = BodyPair::new(a, b)?;
    let mut search = PairSearch::new(pair, Goal::separation(limits), limits)?;
    search.keeps_all = true;
    let (answer, _) = search.run_from(None, workspace);
    let Frontier { queue, pending, .. } = &mut workspace.frontier;
    let known = pending.drain(..).chain(queue.cells());
    let boxes = known.map(|cell| ProofBox {
        aabb: Aabb { min: cell.centre - cell.half, max: cell.centre + cell.half },
        lower: 2.0 * cell.lower,
    });
    Ok(Proof { answer, world_from_boxes: pair.world_from_frame, boxes: boxes.collect() })
}
