// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How far two fields are apart.
//!
//! The search for the separation, as [`separation`] defines it, is best-first over boxes, 64
//! at a time. At its centre a box has `max(g_a, g_b) − radius` as a bound. Smaller boxes are
//! bounded by models: each is an affine function less a remainder, so is every mean of two,
//! and `max ≥ λ·g_a + (1 − λ)·g_b`: of all these means the largest least value is taken.
//! Where the surfaces face each other the gradients cancel, and what remains is of second
//! order. Minimax proximal steps improve the best point: the maximum of the two tangent
//! planes plus a parabola is least at a step along a mean of both gradients.

pub(crate) mod body_pair;
pub(crate) mod cell;
mod common_surface;
pub(crate) mod descent;
pub(crate) mod distance_bound;
pub(crate) mod facing;
mod nearest;
mod proof;
mod rates;
pub(crate) mod search;
mod separating_translation;

use crate::certified::{Certified, Limits};
use crate::error::QueryError;
use crate::goal::Goal;
use crate::placed::Placed;
pub(crate) use body_pair::BodyPair;
pub(crate) use search::PairSearch;

pub use descent::minimax_step;
pub use distance_bound::DistanceBound;
pub use nearest::Nearest;
pub(crate) use proof::prove;
pub use proof::{Proof, ProofBox, proof};
pub(crate) use rates::rates_of;
pub use rates::{PoseDerivative, Rates, rates};
pub use search::PairWorkspace;
pub(crate) use separating_translation::part;
pub use separating_translation::{SeparatingTranslation, separating_translation};

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
///   How far a body must move to leave the other is bounded by [`separating_translation`].
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
