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
pub(super) struct March {
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

impl<const D: usize> Scan<D> {
    /// The part of a motion, at most `most`, in which no point dips deeper than the skin.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; at most 64 evaluations a point,
    /// and what the budget has left.
    pub(super) fn sweep(
        &mut self,
        surroundings: Surroundings<'_, D>,
        path: Path<'_, D>,
        skin: f64,
        most: f64,
    ) -> f64 {
        let Surroundings { shell, nearby } = surroundings;
        let Path { pose, twist } = path;
        let lipschitz = nearby.lipschitz().max(f64::MIN_POSITIVE);
        let whole = self.free_part(shell, twist).min(most);
        let (linear, angle) = (twist.linear.norm(), twist.angular.norm());
        let (mut proven, mut marches) = (whole, std::mem::take(&mut self.marches));
        marches.clear();
        for (number, seen) in self.seen() {
            // Points that are already deeper than a skin are moving out.
            if seen.gap <= -skin {
                continue;
            }
            // A point may go down to half a skin; from below that, half of the way to a whole
            // skin.
            let room = (seen.gap + 0.5 * skin).max(0.5 * (seen.gap + skin)) / lipschitz;
            let way = linear + angle * (seen.centre - pose.translation).norm();
            if way * whole > room && marches.len() < marches.capacity() {
                let covered = room / way;
                proven = proven.min(covered);
                marches.push(March { number, way, covered });
            }
        }
        if proven < WORTH_GOING * whole {
            let limits = Limits { whole, dips: DIPS * skin, least: MET * skin, lipschitz };
            proven = self.follow(surroundings, path, &mut marches, limits);
        }
        self.marches = marches;
        proven
    }

    /// Sweeps points until `limits` end it, and returns the proven part of the motion.
    fn follow(
        &mut self,
        surroundings: Surroundings<'_, D>,
        path: Path<'_, D>,
        marches: &mut [March],
        limits: Limits,
    ) -> f64 {
        let Surroundings { shell, nearby } = surroundings;
        let Path { pose, twist } = path;
        let Limits { whole, dips, least, lipschitz } = limits;
        let proven = |marches: &[March]| {
            marches.iter().fold(whole, |least, march| least.min(march.covered))
        };
        let mut step = proven(marches);
        for _ in 0..MOST_STEPS {
            let covered = proven(marches);
            // Written so that NaN ends the sweep.
            if covered.is_nan() || covered >= whole {
                break;
            }
            let at = (covered + step).min(whole);
            let behind = |march: &March| march.covered < at;
            let count = marches.iter().filter(|march| behind(march)).count() as u32;
            if count > self.left() {
                break;
            }
            self.spend(count);
            let there = twist.part(at).moved(pose);
            let batch = &mut *self.batch;
            let (mut next, mut has_hole, mut is_met) = (f64::INFINITY, false, false);
            let mut done = 0;
            while let Some(rest) = marches.get_mut(done..) {
                let mut last = 0;
                let numbers = rest.iter().filter(|march| behind(march));
                batch.gather(shell, &there, &mut numbers.map(|march| march.number));
                if batch.count == 0 {
                    break;
                }
                batch.ask_gaps(nearby);
                let asked = rest.iter_mut().enumerate().filter(|(_, march)| behind(march));
                for ((place, march), (_, seen)) in asked.zip(batch.results()) {
                    last = place + 1;
                    let proves = (seen.gap + dips) / (lipschitz * march.way);
                    if at - proves <= march.covered {
                        march.covered = at + proves;
                        next = next.min(proves);
                    } else {
                        has_hole = true;
                        is_met |= step * lipschitz * march.way <= least;
                    }
                }
                done += last;
            }
            if is_met {
                break;
            }
            step = if has_hole { 0.5 * step } else { next };
        }
        proven(marches).max(0.0)
    }
}
