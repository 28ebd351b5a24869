// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A short translation after which two bodies are proven to be apart, by separations along many
//! directions.
//!
//! The search tries the normal of the overlap, directions all around, and ever closer ones about
//! the best of them, with the normals at its end. Along a direction the body advances by as much
//! as it overlaps, which cannot overstep the first place without overlap. After 30 steps the strides
//! double. Up to there the length is within the tolerance of the shortest along its direction.

use palpate_field::Vector;
use palpate_field::scalar::Scalar;

use super::super::{Nearest, PairWorkspace, overlap, separation};
use crate::certified::{Certified, Limits};
use crate::error::QueryError;
use crate::sampler::Placed;

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

/// The share of the budget that one separation may take.
const SHARE: u32 = 16;

/// The evaluations after which a separation tells nearly how far the bodies overlap.
const ROUGH: u32 = 1000;

/// The share of the tolerance to which a sign is decided. Where a way out is narrow, the gap beside
/// the body is small against the tolerance.
const FINER: f64 = 1.0 / 16.0;

/// A question about two bodies.
type Question<'a, const D: usize> = fn(
    Placed<'a, D>,
    Placed<'a, D>,
    &Limits,
    &mut PairWorkspace<D>,
) -> Result<Certified<Nearest<D>>, QueryError>;

/// A search under way.
pub(super) struct WayOut<'a, 'w, const D: usize> {
    bodies: [Placed<'a, D>; 2],
    limits: Limits,
    workspace: &'w mut PairWorkspace<D>,
    /// The direction in world coordinates and the length of the shortest translation so far.
    pub(super) best: Option<(Vector<f64, D>, f64)>,
    longest: f64,
    /// No shorter translation separates the bodies.
    pub(super) shortest: f64,
    pub(super) evaluations: u32,
    /// No separation is begun after so many evaluations.
    pub(super) budget: u32,
}

impl<'a, 'w, const D: usize> WayOut<'a, 'w, D> {
    pub(super) fn new(
        bodies: [Placed<'a, D>; 2],
        limits: &Limits,
        workspace: &'w mut PairWorkspace<D>,
    ) -> Self {
        let size = |body: &Placed<'_, D>| {
            let bounds = body.shape.promise().bounds;
            bounds.map_or(0.0, |bounds| 2.0 * bounds.aabb.half_extents().norm())
        };
        Self {
            bodies,
            limits: limits.with_tolerance(0.5 * limits.tolerance),
            workspace,
            best: None,
            longest: FAR * (size(&bodies[0]) + size(&bodies[1])),
            shortest: 0.0,
            evaluations: 0,
            budget: limits.budget,
        }
    }

    fn is_spent(&self) -> bool {
        self.evaluations >= self.budget
    }

    /// The separation after the second body has moved.
    pub(super) fn at(
        &mut self,
        direction: Vector<f64, D>,
        length: f64,
    ) -> Result<Certified<Nearest<D>>, QueryError> {
        self.ask(direction, length, (separation, self.limits))
    }

    /// An upper bound of it that is not far from it, and perhaps a lower one.
    fn roughly_at(
        &mut self,
        direction: Vector<f64, D>,
        length: f64,
    ) -> Result<Certified<Nearest<D>>, QueryError> {
        let limits = self.limits.with_budget(ROUGH.min(self.limits.budget));
        self.ask(direction, length, (separation, limits))
    }

    /// The same, but only until its sign is known.
    fn sign_at(
        &mut self,
        direction: Vector<f64, D>,
        length: f64,
    ) -> Result<Certified<Nearest<D>>, QueryError> {
        let limits = self.limits.with_tolerance(FINER * self.limits.tolerance);
        self.ask(direction, length, (overlap, limits))
    }

    fn ask(
        &mut self,
        direction: Vector<f64, D>,
        length: f64,
        (question, limits): (Question<'a, D>, Limits),
    ) -> Result<Certified<Nearest<D>>, QueryError> {
        let [a, mut b] = self.bodies;
        b.world_from_body.translation += direction * length;
        let left = self.budget.saturating_sub(self.evaluations);
        let most = limits.budget.min(self.limits.budget / SHARE).min(left);
        let answer = question(a, b, &limits.with_budget(most), self.workspace)?;
        self.evaluations = self.evaluations.saturating_add(answer.evaluations);
        Ok(answer)
    }

    /// Tries `normal` and directions all around.
    pub(super) fn look_around(&mut self, normal: Vector<f64, D>) -> Result<(), QueryError> {
        self.follow(normal)?;
        for direction in directions::<D>() {
            self.attempt_beyond_best(direction)?;
        }
        let mut spread = WIDEST;
        while spread > NARROWEST && !self.is_spent() {
            let Some((best, length)) = self.best else { return Ok(()) };
            self.follow(best)?;
            for axis in 0..D {
                for sign in [-1.0, 1.0] {
                    let other = best + Vector::unit(axis) * (sign * spread);
                    self.attempt_beyond_best(other * (1.0 / other.norm()))?;
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
    pub(super) fn attempt(
        &mut self,
        direction: Vector<f64, D>,
    ) -> Result<Option<Vector<f64, D>>, QueryError> {
        self.advance(direction, false)
    }

    /// The same, but only if it is out at a length that is a little less than the best, as most
    /// directions are that are better.
    fn attempt_beyond_best(&mut self, direction: Vector<f64, D>) -> Result<(), QueryError> {
        let Some((_, length)) = self.best else { return self.attempt(direction).map(drop) };
        let end = length - 2.0 * self.limits.tolerance;
        if self.is_spent() || end < 0.0 || self.sign_at(direction, end)?.lower < 0.0 {
            return Ok(());
        }
        self.advance(direction, true).map(drop)
    }

    /// Advances along a direction to the first place without overlap. `is_out` says whether the body
    /// is out next to the best length.
    fn advance(
        &mut self,
        direction: Vector<f64, D>,
        mut is_out: bool,
    ) -> Result<Option<Vector<f64, D>>, QueryError> {
        if self.is_spent() {
            return Ok(None);
        }
        let limit = self.best.map_or(self.longest, |(_, length)| length);
        let tolerance = 2.0 * self.limits.tolerance;
        let mut end = limit - tolerance;
        let (mut inside, mut start) = (self.shortest, self.shortest);
        let mut normal = None;
        for step in 0..STEPS {
            if self.is_spent() || is_out && end - start <= tolerance {
                break;
            }
            let mut here = self.roughly_at(direction, start)?;
            if here.lower < 0.0 && -here.upper < tolerance {
                here = self.sign_at(direction, start)?;
            }
            if here.lower >= 0.0 {
                (end, normal, is_out) = (start, here.best.normal, true);
                break;
            }
            let stride = (-here.upper).max(self.limits.tolerance);
            let grown = f64::from(1_u32 << step.saturating_sub(PATIENCE));
            let next = start + stride * grown;
            if next >= end {
                // A way out next to the best length may be less than a stride away.
                if !is_out && end > start {
                    let there = self.sign_at(direction, end)?;
                    is_out = there.lower >= 0.0;
                    (inside, start, normal) = (start, end, there.best.normal);
                }
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
                if self.is_spent() {
                    break;
                }
                let middle = 0.5 * (inside + end);
                let here = self.sign_at(direction, middle)?;
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
