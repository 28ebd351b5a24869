// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Translations that separate two bodies, and bounds of the minimum translation.

use palpate_field::Vector;
use palpate_field::scalar::Scalar;

use super::{Nearest, PairWorkspace, separation};
use crate::certified::{Certified, Limits};
use crate::error::QueryError;
use crate::sampler::{Placed, arbitrary};

/// Directions that are tried all around.
const AROUND: usize = 48;

/// How far directions about the best one are from it, at first and at last.
const WIDEST: f64 = 0.3;
const NARROWEST: f64 = 0.01;

/// A round of directions is repeated at the same spread only if it cut the way to less than this
/// share: without a tolerance the search would not end.
const WORTH: f64 = 0.99;

/// Steps along a direction at most.
const STEPS: u32 = 60;

/// After so many steps they double: what is small in what is large overlaps by little and
/// has far to go.
const PATIENCE: u32 = 30;

/// The longest translation that is tried, in sizes of the bounded bodies.
const FAR: f64 = 100.0;

/// A translation of the second body after which the bodies are proven not to overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SeparatingTranslation<const D: usize> {
    /// The direction, a unit vector in world coordinates.
    pub direction: Vector<f64, D>,
    /// How far the second body moves [m]. The separation after that is proven to be at least
    /// zero; another direction may be shorter.
    pub length: f64,
    /// Proven lower bound of the length in any direction [m]: a translation changes the
    /// separation by no more than its length.
    pub at_least: f64,
    /// How often fields were evaluated; a gradient counts twice.
    pub evaluations: u32,
}

/// A short translation of the second body that parts the bodies: an upper bound of the
/// minimum translation, which physics engines call penetration depth. Its length is zero if
/// the bodies are apart; `None` if no translation was found.
///
/// That the bodies are apart at the end is proven, and so is [`SeparatingTranslation::at_least`], a lower
/// bound of the minimum translation. That no other direction is shorter is not.
///
/// The search tries the normal of the overlap, directions all around, and ever closer ones
/// about the best of them, with the normals at its end. Along a direction the body advances
/// by as much as it overlaps, which cannot overstep the first place without overlap; after 30 steps the
/// strides double. Up to there the length is within `limits.tolerance` of the shortest along
/// its direction. The budget holds for each separation on the way.
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Cuboid};
/// use palpate_query::{Limits, PairWorkspace, separating_translation};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let long = Shape::from_kernel(Cuboid::new(Vector([4.0, 1.0, 1.0]))?);
/// let cube = Shape::from_kernel(Cuboid::new(Vector([1.0, 1.0, 1.0]))?)
///     .translated(Vector([0.3, 0.6, 0.0]))?;
/// let mut workspace = PairWorkspace::new();
/// let way = separating_translation(&long, &cube, &Limits::new(1e-4), &mut workspace)?;
/// let way = way.expect("both are bounded");
/// assert!((way.direction - Vector([0.0, 1.0, 0.0])).norm() < 0.1);
/// assert!(0.4 < way.length && way.length < 0.402);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If neither body is bounded, or a pose or the tolerance is NaN or out of range.
pub fn separating_translation<'a, const D: usize>(
    a: impl Into<Placed<'a, D>>,
    b: impl Into<Placed<'a, D>>,
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Option<SeparatingTranslation<D>>, QueryError> {
    part([a.into(), b.into()], limits, workspace)
}

#[inline(never)]
pub(crate) fn part<const D: usize>(
    [a, b]: [Placed<'_, D>; 2],
    limits: &Limits,
    workspace: &mut PairWorkspace<D>,
) -> Result<Option<SeparatingTranslation<D>>, QueryError> {
    let size = |body: &Placed<'_, D>| {
        let bounds = body.shape.promise().bounds;
        bounds.map_or(0.0, |bounds| 2.0 * bounds.aabb.half_extents().norm())
    };
    let mut search = DirectionSearch {
        bodies: [a, b],
        limits: limits.with_tolerance(0.5 * limits.tolerance),
        workspace,
        best: None,
        longest: FAR * (size(&a) + size(&b)),
        evaluations: 0,
    };
    let here = search.at(Vector::ZERO, 0.0)?;
    let at_least = (-here.upper).max(0.0);
    let normal = here.best.normal.unwrap_or_else(arbitrary);
    if here.lower >= 0.0 {
        search.best = Some((normal, 0.0));
    } else {
        search.look_around(normal)?;
    }
    let evaluations = search.evaluations;
    Ok(search.best.map(|(direction, length)| SeparatingTranslation {
        direction,
        length,
        at_least,
        evaluations,
    }))
}

/// A search under way.
struct DirectionSearch<'a, 'w, const D: usize> {
    bodies: [Placed<'a, D>; 2],
    limits: Limits,
    workspace: &'w mut PairWorkspace<D>,
    best: Option<(Vector<f64, D>, f64)>,
    longest: f64,
    evaluations: u32,
}

impl<const D: usize> DirectionSearch<'_, '_, D> {
    /// The separation after the second body has moved.
    fn at(
        &mut self,
        direction: Vector<f64, D>,
        length: f64,
    ) -> Result<Certified<Nearest<D>>, QueryError> {
        let [a, mut b] = self.bodies;
        b.world_from_body.translation += direction * length;
        let answer = separation(a, b, &self.limits, self.workspace)?;
        self.evaluations = self.evaluations.saturating_add(answer.evaluations);
        Ok(answer)
    }

    fn look_around(&mut self, normal: Vector<f64, D>) -> Result<(), QueryError> {
        self.follow(normal)?;
        for direction in directions::<D>() {
            self.attempt(direction)?;
        }
        let mut spread = WIDEST;
        while spread > NARROWEST {
            let Some((best, length)) = self.best else { return Ok(()) };
            self.follow(best)?;
            for axis in 0..D {
                for sign in [-1.0, 1.0] {
                    let other = best + Vector::unit(axis) * (sign * spread);
                    self.attempt(other * (1.0 / other.norm()))?;
                }
            }
            let is_better = self.best.is_some_and(|(_, now)| now < WORTH * length);
            spread *= if is_better { 1.0 } else { 0.5 };
        }
        Ok(())
    }

    /// Tries a direction, and then the normals at its end: a plane between both bodies
    /// there is no farther along its own normal.
    fn follow(&mut self, direction: Vector<f64, D>) -> Result<(), QueryError> {
        let mut direction = direction;
        for _ in 0..8 {
            let Some(normal) = self.attempt(direction)? else { break };
            direction = normal;
        }
        Ok(())
    }

    /// Tries a direction: `None` if it is no better than the best, or else the normal at
    /// its end.
    fn attempt(
        &mut self,
        direction: Vector<f64, D>,
    ) -> Result<Option<Vector<f64, D>>, QueryError> {
        let limit = self.best.map_or(self.longest, |(_, length)| length);
        let tolerance = 2.0 * self.limits.tolerance;
        let mut end = limit - tolerance;
        // Out at a length that is shorter than the best, or not at all.
        if self.best.is_some() && (end < 0.0 || self.at(direction, end)?.lower < 0.0) {
            return Ok(None);
        }
        let (mut inside, mut start) = (0.0, 0.0);
        let mut normal = None;
        let mut is_out = self.best.is_some();
        for step in 0..STEPS {
            if is_out && end - start <= tolerance {
                break;
            }
            let here = self.at(direction, start)?;
            if here.lower >= 0.0 {
                (end, normal, is_out) = (start, here.best.normal, true);
                break;
            }
            let stride = (-here.upper).max(self.limits.tolerance);
            let grown = f64::from(1_u32 << step.saturating_sub(PATIENCE));
            let next = start + stride * grown;
            if next >= end {
                break;
            }
            (inside, start) = (start, next);
        }
        if !is_out {
            return Ok(None);
        }
        if start == end && end - inside > tolerance {
            // The last stride may have been longer than what overlaps.
            for _ in 0..f64::MANTISSA_DIGITS {
                let middle = 0.5 * (inside + end);
                let here = self.at(direction, middle)?;
                if here.lower >= 0.0 {
                    (end, normal) = (middle, here.best.normal);
                } else {
                    inside = middle;
                }
                if end - inside <= tolerance {
                    break;
                }
            }
        }
        self.best = Some((direction, end));
        match normal {
            Some(normal) => Ok(Some(normal)),
            None => Ok(self.at(direction, end)?.best.normal),
        }
    }
}

/// Directions all around: of a Fibonacci lattice in space, evenly spaced in the plane.
fn directions<const D: usize>() -> impl Iterator<Item = Vector<f64, D>> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..AROUND).map(move |i| {
        let share = (i as f64 + 0.5) / AROUND as f64;
        let (height, angle) = match D {
            2 => (0.0, std::f64::consts::TAU * share),
            _ => (1.0 - 2.0 * share, golden * i as f64),
        };
        let radius = (1.0 - height * height).sqrt();
        let place = [radius * Scalar::cos(angle), radius * Scalar::sin(angle), height];
        let mut direction = Vector::ZERO;
        for k in 0..D {
            direction[k] = place[k];
        }
        direction
    })
}
