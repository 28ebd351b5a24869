// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Conservative advancement (Mirtich 1996): bodies that are apart by a distance stay apart until their
//! motion has closed it.
//!
//! It goes on where boxes of space and time end early: bodies that pass at a small distance over large
//! parts of their surfaces need more boxes than memory holds, but few steps of time.

use super::moving::Moving;
use super::path::WayBounds;
use super::settings::{FREE, SweepSettings};
use crate::certified::Limits;
use crate::error::QueryError;
use crate::pair::{PairWorkspace, separation};

/// The separation is known well enough for a step if its lower bound is at least this share of the
/// upper one.
const KNOWN: f64 = 0.5;

/// The tolerance of the separation begins at `COARSEST` of the size, and is multiplied by `FINER` until the
/// separation is known well enough, down to `FINEST` of the gap.
const FINER: f64 = 0.25;
const COARSEST: f64 = 1e-2;
const FINEST: f64 = 0.25;

/// Two bodies that advance.
pub(super) struct Advancement<'a, const D: usize> {
    pub(super) bodies: [Moving<'a, D>; 2],
    /// The way of one as the other sees it.
    pub(super) way: WayBounds,
    /// Half the diagonal of the smaller body's box [m].
    pub(super) size: f64,
    pub(super) settings: &'a SweepSettings,
    /// How often fields may be evaluated.
    pub(super) budget: u32,
}

/// How far bodies have advanced: until `lower` they are apart, and at `upper` they touch; infinite if no
/// touch was found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Advanced {
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) evaluations: u32,
}

impl<const D: usize> Advancement<'_, D> {
    /// From a time until which they are apart.
    pub(super) fn run(
        &self,
        from: f64,
        workspace: &mut PairWorkspace<D>,
    ) -> Result<Advanced, QueryError> {
        let gap = self.settings.gap;
        let finest = FINEST * gap;
        let mut tolerance = finest.max(COARSEST * self.size);
        let mut advanced = Advanced { lower: from, upper: f64::INFINITY, evaluations: 0 };
        while advanced.lower < 1.0 && advanced.evaluations < self.budget {
            let [a, b] = self.bodies.map(|body| body.at(advanced.lower));
            let limits = Limits::new(tolerance).with_budget(self.budget - advanced.evaluations);
            let near = separation(a, b, &limits, workspace)?;
            advanced.evaluations = advanced.evaluations.saturating_add(near.evaluations.max(1));
            if near.upper <= gap {
                advanced.upper = advanced.lower;
                break;
            }
            let free = near.lower - FREE * gap - self.way.rounding;
            let is_finest = tolerance <= finest;
            if free > 0.0 && (is_finest || near.lower >= KNOWN * near.upper) {
                let next =
                    advanced.lower + free / (self.way.speed * (1.0 + 4.0 * f64::EPSILON));
                if next <= advanced.lower {
                    break;
                }
                advanced.lower = next.min(1.0);
            } else if is_finest {
                break;
            } else {
                tolerance = finest.max(FINER * tolerance);
            }
        }
        Ok(advanced)
    }
}
