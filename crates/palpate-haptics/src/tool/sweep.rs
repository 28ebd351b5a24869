// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sweeping: the part of a motion that is proven free.
//!
//! A value `g` at a point proves that no point within `(g + s) / L` of it is deeper than the
//! skin `s`. If this does not cover the path of a point, the field is evaluated further along
//! the path, and halfway between two evaluations that leave a gap: conservative advancement
//! (Mirtich 1996) from both ends, for all points at once. Xu and Barbič, "6-DoF haptic
//! rendering using continuous collision detection between points and signed distance fields"
//! (2017), also sweep points.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use super::scan::{Path, Scan, Surroundings};

/// If the evaluations at the start prove this part of a motion, the motion stops there and no
/// point is swept. A smaller part would end iterations early, and an iteration costs more than
/// sweeping a few points.
const WORTH_GOING: f64 = 0.75;

/// The most poses on a path.
const MOST_STEPS: u32 = 64;

/// The depth that swept points may reach, as a part of a skin.
const DIPS: f64 = 0.75;

/// A path whose steps fall below this part of a skin counts as blocked.
const MET: f64 = 0.125;

/// A point that is being swept.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SweptPoint {
    number: u32,
    /// The length of its path [m].
    way: f64,
    /// The proven part of the path.
    covered: f64,
}

/// What ends a sweep.
#[derive(Clone, Copy)]
struct Limits {
    /// The part of the motion to prove.
    whole: f64,
    /// How deep points may dip [m].
    dips: f64,
    /// Shorter steps end the sweep [m].
    least: f64,
    /// The Lipschitz constant of the field.
    lipschitz: f64,
}

impl Scan {
    /// The part of a motion, at most `most`, in which no point dips deeper than the skin.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; at most 64 evaluations a point,
    /// and what the budget has left.
    pub(super) fn sweep(
        &mut self,
        surroundings: Surroundings<'_>,
        path: Path<'_>,
        skin: f64,
        most: f64,
    ) -> f64 {
        let Surroundings { shell, nearby } = surroundings;
        let Path { pose, twist } = path;
        let lipschitz = nearby.lipschitz().max(f64::MIN_POSITIVE);
        let whole = self.free_part(shell, twist).min(most);
        let (linear, angle) = (twist.linear.norm(), twist.angular.norm());
        let (mut proven, mut swept_points) = (whole, std::mem::take(&mut self.swept_points));
        swept_points.clear();
        for (number, seen) in self.seen() {
            // Points deeper than a skin are not swept: they are moving out. Nor are points half as
            // deep that move out: they would stop deeper ones.
            let arm = seen.centre - pose.translation;
            let goes_out = || twist.of_point(arm).dot(seen.gradient) > 0.0;
            if seen.gap <= -skin || seen.gap < -0.5 * skin && goes_out() {
                continue;
            }
            // A point may go down to half a skin; from below that, half of the way to a whole
            // skin.
            let room = (seen.gap + 0.5 * skin).max(0.5 * (seen.gap + skin)) / lipschitz;
            let way = linear + angle * arm.norm();
            if way * whole > room && swept_points.len() < swept_points.capacity() {
                let covered = room / way;
                proven = proven.min(covered);
                swept_points.push(SweptPoint { number, way, covered });
            }
        }
        if proven < WORTH_GOING * whole {
            let limits = Limits { whole, dips: DIPS * skin, least: MET * skin, lipschitz };
            proven = self.follow(surroundings, path, &mut swept_points, limits);
        }
        self.swept_points = swept_points;
        proven
    }

    /// Sweeps points until `limits` end it, and returns the proven part of the motion.
    fn follow(
        &mut self,
        surroundings: Surroundings<'_>,
        path: Path<'_>,
        swept_points: &mut [SweptPoint],
        limits: Limits,
    ) -> f64 {
        let Surroundings { shell, nearby } = surroundings;
        let Path { pose, twist } = path;
        let Limits { whole, dips, least, lipschitz } = limits;
        let proven = |swept_points: &[SweptPoint]| {
            swept_points.iter().fold(whole, |least, swept| least.min(swept.covered))
        };
        let mut step = proven(swept_points);
        for _ in 0..MOST_STEPS {
            let covered = proven(swept_points);
            // Written so that NaN ends the sweep.
            if covered.is_nan() || covered >= whole {
                break;
            }
            let at = (covered + step).min(whole);
            let behind = |swept: &SweptPoint| swept.covered < at;
            let count = swept_points.iter().filter(|swept| behind(swept)).count() as u32;
            if count > self.left() {
                break;
            }
            self.spend(count);
            let there = twist.part(at).moved(pose);
            let batch = &mut *self.batch;
            let (mut next, mut has_hole, mut is_met) = (f64::INFINITY, false, false);
            let mut done = 0;
            while let Some(rest) = swept_points.get_mut(done..) {
                let mut last = 0;
                let numbers = rest.iter().filter(|swept| behind(swept));
                batch.gather(shell, &there, &mut numbers.map(|swept| swept.number));
                if batch.count == 0 {
                    break;
                }
                batch.evaluate_gaps(nearby);
                let asked = rest.iter_mut().enumerate().filter(|(_, swept)| behind(swept));
                for ((place, swept), (_, seen)) in asked.zip(batch.results()) {
                    last = place + 1;
                    let proves = (seen.gap + dips) / (lipschitz * swept.way);
                    if at - proves <= swept.covered {
                        swept.covered = at + proves;
                        next = next.min(proves);
                    } else {
                        has_hole = true;
                        is_met |= step * lipschitz * swept.way <= least;
                    }
                }
                done += last;
            }
            if is_met {
                break;
            }
            step = if has_hole { 0.5 * step } else { next };
        }
        proven(swept_points).max(0.0)
    }
}
