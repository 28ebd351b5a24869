// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The separation of two bodies, with its proof.
//!
//! How far two fields are apart.
//!
//! The search for the separation, as [`separation`] defines it, is best-first over boxes, 64
//! at a time. At its centre a box has `max(g_a, g_b) − radius` as a bound. Smaller boxes are
//! bounded by models: each is an affine function less a remainder, so is every mean of two,
//! and `max ≥ λ·g_a + (1 − λ)·g_b`: of all these means the largest least value is taken.
//! Where the surfaces face each other the gradients cancel, and what remains is of second
//! order. Minimax proximal steps improve the best point: the maximum of the two tangent
//! planes plus a parabola is least at a step along a mean of both gradients.

use palpate_field::{Aabb, Point, Pose, Vector};

use crate::certified::{Certified, Goal, Limits};
use crate::contact::Contact;
use crate::engine::Frontier;
use crate::error::QueryError;
use crate::sampler::Placed;

pub(crate) use body_pair::BodyPair;
pub use distance_bound::{DistanceBound, minimax_step};
pub use penetration::{Penetration, penetration};
pub(crate) use penetration::{penetration_of, way_out};
pub(crate) use rates::rates_of;
pub use rates::{PoseDerivative, Rates, rates};
pub(crate) use search::PairSearch;
pub use search::PairWorkspace;

pub(crate) mod body_pair;
pub(crate) mod distance_bound;
mod penetration;
mod rates;
pub(crate) mod search;

/// The separation of two bodies [m], between bounds, to `limits.tolerance`.
///
/// With `g` of each body a lower bound of the distance to it that is nowhere steeper than
/// one, `g = max(f/L, distance to its box)`,
///
/// ```text
/// separation = 2·min over p of max(g_a(p), g_b(p)).
/// ```
///
/// - **Apart**, the separation is at most the distance of the bodies: `lower` is a proven
///   lower bound of that distance. Where both fields are exact outside, the separation is
///   the distance: in the middle of the shortest segment between them both `g` are half of
///   its length.
/// - **Overlapping**, it is minus the width of the widest ball in the overlap, where both
///   fields are exact inside; else it is between that and zero. It has the right sign and is
///   continuous as the bodies move. It is never below minus the width of the smaller body.
///   How far a body must move to leave the other is their [`penetration`].
///
/// The answer's point is where the larger `g` is least: between the bodies, or in both.
/// [`Nearest::contact`] finds the points of both surfaces next to it.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_query::{Limits, PairWorkspace, separation};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let a = Shape::from_kernel(Ball::new(1.0)?);
/// let b = Shape::from_kernel(Ball::new(0.5)?).translated(Vector([1.2, 1.6]))?;
/// let answer = separation(&a, &b, &Limits::new(1e-4), &mut PairWorkspace::new())?;
/// assert!(answer.lower <= 0.5 && 0.5 <= answer.upper);
/// assert!(answer.upper - answer.lower <= 1e-4);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If neither body is bounded, or a pose or the tolerance is NaN or out of range.
pub fn separation<'a, const D: usize>(
    a: impl Into<Placed<'a, D>>,
    b: impl Into<Placed<'a, D>>,
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Certified<Nearest<D>>, QueryError> {
    let goal = Goal::separation(limits);
    Ok(PairSearch::new(BodyPair::new(a.into(), b.into())?, goal, limits)?.run(workspace))
}

/// Whether two bodies overlap, in [`Certified::is_hit`]: whether some point is in both.
///
/// Stops as soon as that is known, or known to lie within `limits.tolerance` of a touch.
/// Bodies whose boxes are apart are decided without evaluating a field.
///
/// # Errors
///
/// If neither body is bounded, or a pose or the tolerance is NaN or out of range.
pub fn overlap<'a, const D: usize>(
    a: impl Into<Placed<'a, D>>,
    b: impl Into<Placed<'a, D>>,
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Certified<Nearest<D>>, QueryError> {
    let goal = Goal::overlap(limits);
    Ok(PairSearch::new(BodyPair::new(a.into(), b.into())?, goal, limits)?.run(workspace))
}

/// Where two bodies are nearest, or overlap most, in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Nearest<const D: usize> {
    /// The point between the bodies, or in both [m].
    pub point: Point<D>,
    /// The unit vector from the first body to the second; `None` where the gradients of both
    /// are equal or vanish.
    pub normal: Option<Vector<f64, D>>,
}

impl<const D: usize> Nearest<D> {
    /// The answer at a point of the pair's frame.
    fn at(pair: &mut BodyPair<'_, D>, p: Point<D>) -> Self {
        let (normal, _) = pair.normal(p);
        let pose = &pair.world_from_frame;
        Self {
            point: pose.transform_point(p),
            normal: normal.map(|normal| pose.transform_vector(normal)),
        }
    }

    /// The points of both surfaces next to [`Nearest::point`], found along the gradients.
    ///
    /// Where the bodies are apart, the distance of these points is an upper bound of the
    /// bodies' distance, and the separation a lower bound. `None` if there is no normal, or
    /// no surface was found.
    #[must_use]
    pub fn contact<'a>(
        &self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
    ) -> Option<Contact<D>> {
        let normal = self.normal?;
        let surface = |placed: Placed<'_, D>| {
            let pose = placed.world_from_body;
            let local = pose.inverse().transform_point(self.point);
            Some(pose.transform_point(placed.shape.surface_point(local)?))
        };
        let (point_a, point_b) = (surface(a.into())?, surface(b.into())?);
        Some(Contact::new(point_a, point_b, normal))
    }
}

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
    /// Boxes that cover the searched region without gaps. In each box the separation bound
    /// `2·max(g_a, g_b)` is at least the lower bound of the answer, with `g = max(f/L, distance
    /// to the body's box)`. The same holds outside of all boxes.
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
    /// Proven lower bound of `2·max(g_a, g_b)` in the box [m].
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
