// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that close on a proxy and leave it no room.
//!
//! A body that moves pushes the proxy on. Where another body is in the way, the proxy goes to the
//! nearest place outside of both. Where there is none, the body that moved yields: the proxy may lie
//! in it, but never in a body that stood still. It comes out as soon as there is room.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Point;

use super::carry_out::nearest_free;
use super::{Proxy, fly};
use crate::contact::{Goal, LocalSurface, Place, slide};
use crate::contact_point::LARGEST_GAIN;
use crate::nearby::{Nearby, Yielding};
use crate::sampler::{Sample, Sampler};

/// The most evaluations that lead a proxy to a place, so that some are left for its tick.
const MOST_LEADING: u32 = 12;

/// The way on which a body that moved pushes a proxy [m].
#[derive(Clone, Copy)]
pub(super) struct Way {
    pub(super) from: Point<3>,
    pub(super) to: Point<3>,
}

impl Proxy {
    /// Whether the proxy was placed beside the bodies that moved, on a way from `last` on which no
    /// other body is.
    pub(super) fn is_beside(
        &self,
        sampler: &mut Sampler<'_>,
        last: Point<3>,
        is_moved: bool,
    ) -> bool {
        let Some(at) = &self.at else { return false };
        if !is_moved {
            return true;
        }
        let still = sampler.nearby().without(self.yielding.and_all_moved());
        let mut among = sampler.among(&still);
        let sample = among.distance(last);
        sampler.spent_by(&among);
        sample.is_some_and(|sample| (at.point - last).norm() <= sampler.clear_radius(&sample))
    }

    /// Takes a proxy that bodies push along `way` to the nearest place outside all bodies. If there
    /// is none, the bodies that moved and cover the proxy yield, and the proxy stays outside of those
    /// that stood still; then `false`.
    #[inline(never)]
    pub(super) fn make_room(&mut self, sampler: &mut Sampler<'_>, way: Way) -> bool {
        let still = sampler.nearby().without(self.yielding.and_all_moved());
        let mut among = sampler.among(&still);
        let begin = among.gradient(way.from);
        sampler.spent_by(&among);
        let begin = begin.filter(|begin| begin.gap >= -2.0 * among.tolerance());
        let Some(mut here) = begin else {
            self.at = None;
            return true;
        };
        self.lead(&mut among, &mut here, way.to);
        sampler.spent_by(&among);
        // A way that ends where it began leaves the proxy covered by what the body moved.
        let covered = sampler.gradient(here.point).map_or(0.0, |here| (-here.gap).max(0.0));
        let most = LARGEST_GAIN * ((way.to - way.from).norm() + covered);
        if let Some(free) = self.free_near(sampler, &mut among, &mut here, most) {
            self.at = Some(free);
            return true;
        }
        self.yield_to(sampler, here.point);
        self.at = Some(here);
        false
    }

    /// Takes the proxy out of the bodies that yield, if there is room; `rest` are the bodies that do
    /// not yield.
    #[inline(never)]
    pub(super) fn look_for_room(&mut self, rest: &mut Sampler<'_>, everything: &Nearby<'_>) {
        let Some(mut here) = self.at else { return };
        let mut all = rest.among(everything);
        let free = self.free_near(&mut all, rest, &mut here, self.probe.radius);
        rest.spent_by(&all);
        if let Some(free) = free {
            self.contact |= (free.point - self.device).norm() > rest.tolerance();
            (self.at, self.yielding) = (Some(free), Yielding::default());
            self.normal = rest.tangent(&free, self.normal).0;
        }
    }

    /// A sample outside all bodies, to which the proxy `here` can go by at most `most` [m] without
    /// crossing those that stand still; `here` is then there.
    fn free_near(
        &mut self,
        all: &mut Sampler<'_>,
        still: &mut Sampler<'_>,
        here: &mut Sample,
        most: f64,
    ) -> Option<Sample> {
        let is_free = |sample: &Sample, all: &Sampler<'_>| sample.gap >= -all.tolerance();
        let covered = all.gradient(here.point)?;
        if is_free(&covered, all) {
            return Some(covered);
        }
        let near = nearest_free(all, here.point, covered, self.normal)?;
        // Written so that NaN is too far.
        let is_near = (near.point - here.point).norm() <= most + all.tolerance();
        if !is_near {
            return None;
        }
        let mut there = *here;
        still.spent_by(all);
        self.lead(still, &mut there, near.point);
        all.spent_by(still);
        let mut found = all.gradient(there.point)?;
        if !is_free(&found, all) {
            // A slide ends near its goal. No wall is thinner than what is left.
            let is_there = (there.point - near.point).norm() <= all.skin();
            if !is_there || !is_free(&near, all) {
                return None;
            }
            (there, found) = (still.gradient(near.point)?, near);
        }
        *here = there;
        Some(found)
    }

    /// Takes the proxy `here` towards a point, as far as bodies let it.
    fn lead(&self, sampler: &mut Sampler<'_>, here: &mut Sample, to: Point<3>) {
        let motion = (to - here.point).norm();
        sampler.at_most(MOST_LEADING, |sampler| {
            if fly(sampler, here, to).is_stopped {
                let (mut normal, mut local) = (self.normal, LocalSurface::new());
                let place = Place { here, normal: &mut normal };
                slide(sampler, place, Goal { device: to, motion }, &mut local);
            }
        });
    }

    /// Lets the bodies yield that moved in this tick and cover the proxy at a point, or promise
    /// nothing there.
    fn yield_to(&mut self, sampler: &mut Sampler<'_>, at: Point<3>) {
        let most = sampler.radius() - sampler.tolerance();
        let nearby = sampler.nearby();
        for seen in nearby.each_within(at, &self.punctured, |_| Some(most)) {
            sampler.count();
            let body = nearby.body(seen.body).filter(|body| body.has_moved());
            if body.is_some_and(|body| seen.distance < most || !body.is_proven(at)) {
                self.yielding.add(seen.body);
            }
        }
    }
}
