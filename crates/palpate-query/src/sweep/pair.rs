// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The first touch of two bodies that move.

use super::first_touch::{FirstTouch, Start};
use super::moving::Moving;
use super::settings::{FREE, SweepSettings};
use crate::certified::{Limits, Stop};
use crate::error::QueryError;
use crate::pair::{PairWorkspace, separation};

/// A separation is searched to this share of the last one, and of the gap in the end.
const SHARE: f64 = 0.25;

/// When two bodies that move touch first: the first time at which their [`separation`] is at most
/// `settings.gap`.
///
/// Conservative advancement (Mirtich 1996): bodies whose separation is s and whose points near each
/// other by at most v are apart for the time s/v. So no motion is too fast and no body too thin.
/// What passes at a small distance takes many steps; a budget that is spent says until when the
/// bodies are proven apart.
///
/// ```
/// use palpate_field::{Pose, Screw, Shape};
/// use palpate_query::{Moving, PairWorkspace, SweepSettings, sweep};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // 10 m in one step, at a plate of 0.1 mm.
/// let plate = Shape::<3>::cuboid([1.0, 1e-4, 1.0])?;
/// let cube = Shape::<3>::cuboid([0.1, 0.1, 0.1])?;
/// let [from, to] = [5.0, -5.0].map(|y| Pose::translation([0.0, y, 0.0]));
/// let falling = Moving::new(&cube, Screw::new(from, to, 0)?);
/// let settings = SweepSettings::of_size(0.1);
/// let touch = sweep(&plate, falling, &settings, &mut PairWorkspace::new())?;
/// assert_eq!(touch.touches(), Some(true));
/// let truth = 0.494_995; // 4.949 95 m of 10 m
/// assert!(touch.lower <= truth && touch.upper >= truth - 1e-8 && touch.upper <= truth + 1e-4);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If neither body is bounded, a pose is NaN or out of range, or a setting is not positive.
pub fn sweep<'a, const D: usize>(
    a: impl Into<Moving<'a, D>>,
    b: impl Into<Moving<'a, D>>,
    settings: &SweepSettings,
    workspace: &mut PairWorkspace<D>,
) -> Result<FirstTouch<D>, QueryError> {
    settings.check()?;
    let (a, b) = (a.into(), b.into());
    a.check(0)?;
    b.check(1)?;
    let speed = a.closing_speed(&b);
    let rounding = a.rounding() + b.rounding();
    let mut search = PairSweep { a, b, settings, workspace, evaluations: 0 };
    let (mut free, mut last) = (0.0, f64::INFINITY);
    loop {
        let apart = search.separation(free, last)?;
        if apart.upper <= settings.gap {
            return Ok(search.touch(free, free));
        }
        if free >= 1.0 {
            return Ok(search.free());
        }
        let clear = apart.lower - rounding - FREE * settings.gap;
        let ahead = free + (clear / speed).max(0.0);
        // A touch within the tolerance ends the search.
        let soon = (free + settings.time_tolerance).min(1.0);
        if ahead < soon && search.separation(soon, clear)?.upper <= settings.gap {
            return Ok(search.touch(ahead, soon));
        }
        let is_stuck = ahead <= free;
        if search.evaluations >= settings.budget || is_stuck {
            let stop = if is_stuck { Stop::RoundingReached } else { Stop::BudgetSpent };
            return Ok(search.answer(free, f64::INFINITY, stop));
        }
        (free, last) = (ahead.min(1.0), clear);
    }
}

/// Two bodies on their ways.
struct PairSweep<'s, 'a, const D: usize> {
    a: Moving<'a, D>,
    b: Moving<'a, D>,
    settings: &'s SweepSettings,
    workspace: &'s mut PairWorkspace<D>,
    evaluations: u32,
}

/// Bounds of a separation [m].
struct Apart {
    lower: f64,
    upper: f64,
}

impl<const D: usize> PairSweep<'_, '_, D> {
    /// The separation at a time, as exactly as it matters after one of `last` [m].
    fn separation(&mut self, time: f64, last: f64) -> Result<Apart, QueryError> {
        let gap = self.settings.gap;
        let mut tolerance = SHARE * if last.is_finite() { gap.max(last) } else { gap };
        loop {
            let limits = Limits::new(tolerance);
            let found = separation(self.a.at(time), self.b.at(time), &limits, self.workspace)?;
            self.evaluations = self.evaluations.saturating_add(found.evaluations);
            let is_decided = found.upper <= gap || found.lower > gap;
            if is_decided || tolerance <= SHARE * gap || found.stop.is_early() {
                return Ok(Apart { lower: found.lower, upper: found.upper });
            }
            tolerance = SHARE * gap;
        }
    }

    fn free(&self) -> FirstTouch<D> {
        self.answer(1.0, 1.0, Stop::SignKnown)
    }

    fn answer(&self, lower: f64, upper: f64, stop: Stop) -> FirstTouch<D> {
        let Self { evaluations, .. } = *self;
        FirstTouch { lower, upper, contact: None, start: None, stop, evaluations }
    }

    /// The touch at `upper`.
    fn touch(&mut self, lower: f64, upper: f64) -> FirstTouch<D> {
        let (a, b) = (self.a.at(upper), self.b.at(upper));
        let limits = Limits::new(SHARE * self.settings.gap);
        let mut touch = self.answer(lower, upper, Stop::Converged);
        // The same question was answered before.
        if let Ok(found) = separation(a, b, &limits, self.workspace) {
            touch.evaluations += found.evaluations;
            touch.contact = found.best.contact(a, b);
            let normal = found.best.normal.filter(|_| upper == 0.0);
            touch.start = normal.map(|normal| {
                let point = found.best.point;
                let relative = self.b.velocity(0.0, point) - self.a.velocity(0.0, point);
                Start::of(relative, normal)
            });
        }
        touch
    }
}
