// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that close on a tool and leave it no room: those that moved yield, as for a
//! [proxy](crate::Proxy).

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Pose, Vector};

use super::Tool;
use super::coupling::Twist;
use super::scan::{Path, Surroundings};
use super::settle::{Ends, Lengths};
use crate::event::{Event, EventKind};
use crate::nearby::{Nearby, Yielding};

/// The part of the remaining budget of each look at the bodies.
const SHARE: f64 = 0.25;

impl Tool {
    /// Ends all yielding once a tool at `pose` is outside of all bodies, `nearby`.
    pub(super) fn look_for_room(
        &mut self,
        nearby: &Nearby<'_>,
        pose: &Pose<3>,
        lengths: Lengths,
    ) {
        if self.yielding.is_empty() {
            return;
        }
        self.scan.forget();
        let path = Path { pose, twist: &Twist::NONE };
        let surroundings = Surroundings { shell: &self.shell, nearby };
        let is_known = self.scan.look(surroundings, path, lengths.skin, SHARE);
        if is_known && self.scan.least_gap() >= -lengths.tolerance {
            self.yielding = Yielding::default();
            self.hands_over = true;
        }
        self.scan.forget();
    }

    /// Moves a tool that the bodies of `nearby` cover straight out of them. If that fails and a
    /// body that stood still is near, settles the tool among those that stood still. Moved bodies
    /// that cover it there yield.
    #[cold]
    #[inline(never)]
    pub(super) fn make_room(&mut self, nearby: &Nearby<'_>, ends: Ends, lengths: Lengths) {
        let surroundings = Surroundings { shell: &self.shell, nearby };
        self.scan.forget();
        let out = Ends { is_out: true, ..ends };
        self.rest_search.settle(&mut self.scan, surroundings, out, lengths);
        let rest = &self.rest_search.rest;
        if rest.is_outside {
            if rest.pushes.is_empty() && rest.pose != ends.goal {
                // No body covers the tool there: it goes on, and finds what keeps it.
                self.scan.forget();
                self.rest_search.settle(&mut self.scan, surroundings, ends, lengths);
            }
            return;
        }
        if let Some(lifted) = self.lifted(nearby, &ends.start, lengths) {
            let ends = Ends { start: lifted, ..ends };
            let surroundings = Surroundings { shell: &self.shell, nearby };
            self.rest_search.settle(&mut self.scan, surroundings, ends, lengths);
            if self.rest_search.rest.is_outside {
                return;
            }
        }
        self.hands_over = true;
        let still = nearby.without(self.yielding.and_all_moved());
        let surroundings = Surroundings { shell: &self.shell, nearby: &still };
        let path = Path { pose: &ends.start, twist: &Twist::NONE };
        self.scan.forget();
        let is_known = self.scan.look(surroundings, path, lengths.skin, SHARE);
        if is_known && self.scan.least_gap() <= lengths.skin {
            self.rest_search.settle(&mut self.scan, surroundings, ends, lengths);
            self.scan.forget();
            let rest = &self.rest_search.rest;
            let path = Path { pose: &rest.pose, twist: &Twist::NONE };
            let surroundings = Surroundings { shell: &self.shell, nearby };
            if rest.is_outside && self.scan.look(surroundings, path, lengths.skin, SHARE) {
                for (_, seen) in self.scan.seen() {
                    let has_moved = nearby.body(seen.body).is_some_and(|it| it.has_moved());
                    if has_moved && seen.gap < -lengths.tolerance {
                        self.yielding.add(seen.body);
                    }
                }
            }
        }
        self.scan.forget();
    }

    /// The nearest place outside all bodies to which a tool at `start` comes along the force of the last
    /// tick, by as much as its reach at most. At the seam of two bodies that move, their sides would
    /// push a point against each other.
    fn lifted(
        &mut self,
        nearby: &Nearby<'_>,
        start: &Pose<3>,
        lengths: Lengths,
    ) -> Option<Pose<3>> {
        let away = self.touch.contacts.iter().fold(Vector::ZERO, |sum, it| sum - it.normal);
        let up = away.normalized()?;
        let mut height = lengths.skin;
        while height <= self.shell.reach() {
            let linear = up * height;
            let pose = Pose::new(start.rotation, start.translation + linear);
            self.scan.forget();
            let path = Path { pose: &pose, twist: &Twist::NONE };
            let surroundings = Surroundings { shell: &self.shell, nearby };
            if !self.scan.look(surroundings, path, lengths.skin, SHARE) {
                return None;
            }
            if self.scan.least_gap() >= -lengths.tolerance {
                return Some(pose);
            }
            height *= 2.0;
        }
        None
    }

    /// Tells that a body leaves the tool no room.
    pub(super) fn tell_squeezed(&mut self, was: Yielding) {
        if let (true, Some(body)) = (was.is_empty(), self.yielding.bodies().next()) {
            let (tick, kind) = (self.tick, EventKind::Squeezed);
            self.events.push(Event { tick, point: 0, body, kind });
        }
    }
}
