// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The first touch of two bodies that move, with its proof.

use palpate_field::{Aabb, Pose};

use super::first_touch::FirstTouch;
use super::moving::Moving;
use super::pair::{SweepWorkspace, swept};
use super::settings::SweepSettings;
use crate::error::QueryError;

/// A box that is free before a time: no point of it is in both bodies, nor within a quarter of the gap
/// of both.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreeBox<const D: usize> {
    /// The box, in the coordinates of a body.
    pub aabb: Aabb<D>,
    /// Before this time it is free; 1 if it is all the time.
    pub until: f64,
}

/// When two bodies touch first, and the boxes that prove it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SweepProof<const D: usize> {
    /// The answer, as [`sweep`](crate::sweep) gives it.
    pub answer: FirstTouch<D>,
    /// The body in whose coordinates the boxes are: 0 or 1.
    pub body: usize,
    /// From the coordinates of that body to the world's, at the answer's upper time.
    pub world_from_boxes: Pose<D>,
    /// Boxes that hold the body but for what its own field proves free. Each is free before its own time.
    /// That is at least the answer's lower one, unless the search went on by conservative advancement:
    /// the answer's lower time is then proven by separations.
    pub boxes: Vec<FreeBox<D>>,
}

/// When two bodies that move touch first, as [`sweep`](crate::sweep), with its proof.
///
/// ```
/// use palpate_field::{Pose, Screw, Shape};
/// use palpate_query::{Moving, SweepSettings, SweepWorkspace, sweep_proof};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let block = Shape::<2>::cuboid([1.0, 1.0])?;
/// let [from, to] = [3.0, 0.0].map(|y| Pose::translation([0.0, y]));
/// let falling = Moving::new(&block, Screw::new(from, to, 0)?);
/// let settings = SweepSettings::of_size(1.0);
/// let proof = sweep_proof(&block, falling, &settings, &mut SweepWorkspace::new())?;
/// let lower = proof.answer.lower;
/// assert!(!proof.boxes.is_empty() && proof.boxes.iter().all(|part| part.until >= lower));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// As of [`sweep`](crate::sweep).
pub fn sweep_proof<'a, const D: usize>(
    a: impl Into<Moving<'a, D>>,
    b: impl Into<Moving<'a, D>>,
    settings: &SweepSettings,
    workspace: &mut SweepWorkspace<D>,
) -> Result<SweepProof<D>, QueryError> {
    let bodies = [a.into(), b.into()];
    let mut boxes = Vec::new();
    let (answer, body) = swept(bodies, settings, workspace, Some(&mut boxes))?;
    let world_from_boxes = bodies[body].motion.pose(answer.upper.min(1.0));
    Ok(SweepProof { answer, body, world_from_boxes, boxes })
}
