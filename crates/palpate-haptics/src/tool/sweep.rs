// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How far a motion is proven free.
//!
//! A value `g` at a point proves that nothing within `(g + s) / L` of it is as deep as the skin
//! `s`, before it and behind. Where that does not cover the way of a point, it is asked further
//! on, and halfway where two answers leave a hole: conservative advancement (Mirtich 1996) from
//! both sides, for all points at once. Xu and Barbič, "6-DoF haptic rendering using continuous
//! collision detection between points and signed distance fields" (2017), follow points likewise.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Pose;

use super::scan::Scan;
use super::shell::Shell;
use super::twist::Twist;
use crate::nearby::Nearby;

/// A motion that values at its start prove for this part of it needs no evaluations on the way.
/// Less ends turns early, and a turn costs more than the few points in its way.
const WORTH_GOING: f64 = 0.75;

/// Poses on a way at most.
const MOST_STEPS: u32 = 64;

/// On the way of a point, values prove that it does not dip deeper than this part of a skin.
const DIPS: f64 = 0.75;

/// A way whose steps would be below this part of a skin is not free.
const MET: f64 = 0.125;

/// A point on its way.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct March {
    number: u32,
    /// The length of its way [m].
    way: f64,
    /// The part of it that is proven.
    covered: f64,
}

impl<const D: usize> Scan<D> {
    /// The part of a motion, `most` at most, on which no point dips deeper than the skin.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; at most 64 evaluations a point,
    /// and what the budget has left.
    pub(super) fn sweep(
        &mut self,
        (shell, nearby): (&Shell<D>, &Nearby<'_, D>),
        (pose, twist): (&Pose<D>, &Twist<D>),
        skin: f64,
        most: f64,
    ) -> f64 {
        let lipschitz = nearby.lipschitz().max(f64::MIN_POSITIVE);
        let whole = self.free_part(shell, twist).min(most);
        let (linear, angle) = (twist.linear.norm(), twist.angular.norm());
        let (mut proven, mut marches) = (whole, std::mem::take(&mut self.marches));
        marches.clear();
        for (number, seen) in self.seen() {
            // Points that are deeper than a skin already are on their way out.
            if seen.gap <= -skin {
                continue;
            }
            // To half a skin; from below, half of the way to a whole one.
            let room = (seen.gap + 0.5 * skin).max(0.5 * (seen.gap + skin)) / lipschitz;
            let way = linear + angle * (seen.centre - pose.translation).norm();
            if way * whole > room && marches.len() < marches.capacity() {
                let covered = room / way;
                proven = proven.min(covered);
                marches.push(March { number, way, covered });
            }
        }
        if proven < WORTH_GOING * whole {
            let lengths = (DIPS * skin, MET * skin, lipschitz);
            proven = self.follow((shell, nearby), (pose, twist, whole), &mut marches, lengths);
        }
        self.marches = marches;
        proven
    }

    /// Follows points on their way until the `whole` part of it is proven; the part that is. They
    /// may dip by the first of the lengths, and the second is too little to go on [m].
    fn follow(
        &mut self,
        (shell, nearby): (&Shell<D>, &Nearby<'_, D>),
        (pose, twist, whole): (&Pose<D>, &Twist<D>, f64),
        marches: &mut [March],
        (dips, least, lipschitz): (f64, f64, f64),
    ) -> f64 {
        let proven = |marches: &[March]| {
            marches.iter().fold(whole, |least, march| least.min(march.covered))
        };
        let mut step = proven(marches);
        for _ in 0..MOST_STEPS {
            let covered = proven(marches);
            // Written so that NaN ends.
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
