// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The search for the rest pose of a tool: the free pose closest to the device's pose.
//!
//! The distance of two poses is the energy of the spring between them, `‖v‖² + ℓ²‖ω‖²`, where
//! `ℓ²` is angular over linear stiffness. Each iteration evaluates the points that could touch,
//! replaces the bodies there by their tangent planes, and moves to the closest pose that all
//! planes allow, until the pose no longer changes: the quasi-statics of Ortega, Redon and
//! Coquillart, "A six degree-of-freedom god-object method for haptic display of rigid bodies
//! with surface properties" (2007), with positions instead of accelerations. During a motion no
//! point may dip deeper than a skin, which evaluations prove as for a [`Proxy`](crate::Proxy);
//! at rest no point may be inside.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::cell::Cell;

use palpate_field::{Point, Pose, Vector};

use super::closest::{Closest, FREEDOMS, Row, closest};
use super::coupling::Twist;
use super::friction::{Cone, Hold, MOST_AROUND};
use super::scan::{Evaluation, FixedList, Path, Scan, Surroundings};
use super::shell::Shell;
use crate::nearby::{Nearby, Punctured};

/// The most iterations in a tick. Sliding takes three or four; the rest is for impacts and
/// creases.
const MOST_ITERATIONS: usize = 6;

/// In these last iterations, a tool that is not outside moves straight out instead of on: with
/// large rotations, each iteration ends a little inside.
const LAST_ITERATIONS: usize = 3;

/// The part of the budget that the first evaluation of the shell may use; later ones may use
/// the same part of the remainder.
const FIRST_SHARE: f64 = 0.25;
const SHARE: f64 = 0.5;

/// After an iteration that its horizon limited, the next horizon is this many times as far.
const FARTHER: f64 = 4.0;

/// After any other iteration, the next horizon is at most this multiple of the last desired
/// motion, because motions get shorter; one that grows is limited and evaluated farther. A
/// smaller factor would limit more often, a larger one would evaluate points that nothing
/// reaches.
const NEXT: f64 = 1.5;

/// The most tangent planes of second bodies.
const MOST_SECOND: usize = 256;

/// A second body constrains a point if the cosine of the angle between its normal and the normal of
/// the nearest body is below this number. For other pairs, iterations that see only the nearest
/// body converge by this factor or faster. So the edge of a body that continues a level face adds
/// no plane.
const FACING: f64 = -0.1;

/// The accuracy of constraints, as a part of the tolerance.
const SLACK: f64 = 1e-3;

/// A gradient shorter than this part of the Lipschitz constant says nothing about the surface.
const LEAST_SLOPE: f64 = 0.1;

/// The largest rotation of one iteration in contact [rad]: the tangent planes change with the
/// rotation.
const MOST_ANGLE: f64 = 0.3;

/// Lengths of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lengths {
    /// The length that a radian counts as, ℓ [m].
    pub(super) unit: f64,
    /// The largest depth of a point at rest [m].
    pub(super) tolerance: f64,
    /// A tool outside rests when its next motion is shorter than this [m].
    pub(super) still: f64,
    /// The largest depth of a point during a motion [m].
    pub(super) skin: f64,
    /// The expected motion of points in this tick [m]: points farther from the bodies are
    /// evaluated only if the motion is longer.
    pub(super) horizon: f64,
}

impl Lengths {
    /// The largest violation of a constraint [m].
    pub(super) fn slack(&self) -> f64 {
        SLACK * self.tolerance
    }
}

/// A point that pushes the tool. World coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push {
    pub(super) point: u32,
    pub(super) centre: Point<3>,
    /// The unit normal of the body, pointing out.
    pub(super) normal: Vector<f64, 3>,
    /// The distance from the ball to the body, to first order [m].
    pub(super) gap: f64,
    pub(super) body: u32,
    /// The push: force over stiffness [m].
    pub(super) push: f64,
}

/// A point of the shell near a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub(super) point: u32,
    pub(super) seen: Evaluation,
}

impl Near {
    /// The push of the body on the point.
    pub(super) fn push(&self, push: f64) -> Push {
        let Self { point, seen: Evaluation { centre, body, gap, gradient } } = *self;
        let slope = gradient.norm();
        Push { point, centre, normal: gradient * (1.0 / slope), gap: gap / slope, body, push }
    }

    /// Whether the point is between two faces: this one, and the one that was seen there.
    fn faces(&self, seen: &Evaluation) -> bool {
        let (here, there) = (self.seen.gradient, seen.gradient);
        here.dot(there) < FACING * (here.norm() * there.norm())
    }

    /// Whether it is the contact of a push.
    pub(super) fn is_of(&self, push: &Push) -> bool {
        (self.point, self.seen.body) == (push.point, push.body)
    }
}

/// A rest pose of a tool.
#[derive(Clone, Debug)]
pub(super) struct Rest {
    pub(super) pose: Pose<3>,
    /// The points that push the tool there.
    pub(super) pushes: FixedList<Push>,
    /// The points that touch there, where bodies have different springs.
    pub(super) touching: FixedList<Push>,
    /// The number of points proven outside.
    pub(super) known: u32,
    /// `true` if every evaluated point is outside.
    pub(super) is_outside: bool,
    /// The squared distance from the goal [m²].
    energy: f64,
}

impl Rest {
    /// The rest pose of a tool with so many contacts at most.
    pub(super) fn new(contacts: usize) -> Self {
        Self {
            pose: Pose::identity(),
            pushes: FixedList::with_capacity(FREEDOMS),
            touching: FixedList::with_capacity(contacts),
            known: 0,
            is_outside: false,
            energy: f64::INFINITY,
        }
    }
}

/// The ends of a motion.
#[derive(Clone, Copy)]
pub(super) struct Ends {
    /// The pose from which the tool starts.
    pub(super) start: Pose<3>,
    /// The pose towards which the tool moves.
    pub(super) goal: Pose<3>,
    /// Whether it moves out of the bodies alone, and not on towards the goal.
    pub(super) is_out: bool,
}

/// A free pose that may become the rest pose.
#[derive(Clone, Copy)]
struct Candidate<'a> {
    pose: &'a Pose<3>,
    /// The squared distance from the goal [m²].
    energy: f64,
    /// The number of points proven outside.
    known: u32,
}

/// The search, with memory for a tick.
#[derive(Clone, Debug)]
pub(super) struct RestSearch {
    pub(super) rows: FixedList<Row>,
    /// The contacts of the first rows; the later rows belong to friction cones.
    pub(super) near: FixedList<Near>,
    /// The number of rows before those of friction.
    pub(super) plain: usize,
    /// The pushes that stopped the last motion of this tick.
    stopped: FixedList<Push>,
    /// The contacts that pushed in this tick or at the end of the last, as they were seen then.
    pushed: FixedList<Near>,
    /// The pushes of the last tick.
    pub(super) held: FixedList<Push>,
    /// The friction cones of contacts.
    pub(super) cones: FixedList<Cone>,
    /// `true` if the tool moved against friction.
    pub(super) is_slipping: bool,
    /// `true` if the tool stays in the plane z = 0.
    pub(super) is_flat: bool,
    /// Whether the bodies near the tool have different springs.
    has_springs: bool,
    pub(super) rest: Rest,
}

impl RestSearch {
    pub(super) fn new(shell: &Shell) -> Self {
        let points = shell.points().len();
        Self {
            rows: FixedList::with_capacity(points + MOST_SECOND + FREEDOMS * MOST_AROUND),
            near: FixedList::with_capacity(points + MOST_SECOND),
            plain: 0,
            pushed: FixedList::with_capacity(FREEDOMS * MOST_ITERATIONS),
            stopped: FixedList::with_capacity(FREEDOMS),
            held: FixedList::with_capacity(FREEDOMS),
            cones: FixedList::with_capacity(FREEDOMS),
            is_slipping: false,
            is_flat: shell.is_flat,
            has_springs: false,
            rest: Rest::new(points + MOST_SECOND),
        }
    }

    /// Forgets the contacts, because the bodies changed.
    pub(super) fn forget(&mut self) {
        self.pushed.clear();
    }

    /// Begins a tick: keeps the contacts that push the tool at rest, and moves them with their bodies.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn begin(&mut self, nearby: &Nearby<'_>) {
        self.has_springs = have_different_springs(nearby);
        let pushes = &self.rest.pushes;
        self.pushed.retain(|near| pushes.iter().any(|push| near.is_of(push)));
        for Near { seen, .. } in self.pushed.iter_mut() {
            if let Some(motion) = nearby.body(seen.body).and_then(|body| body.motion()) {
                seen.centre = motion.transform_point(seen.centre);
                seen.gradient = motion.transform_vector(seen.gradient);
            }
        }
    }

    /// Moves the tool from `start` towards `goal`; [`rest`](Self::rest) then holds the rest
    /// pose.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; at most [`MOST_ITERATIONS`]
    /// iterations, and the evaluations that `scan` has left.
    pub(super) fn settle(
        &mut self,
        scan: &mut Scan,
        surroundings: Surroundings<'_>,
        ends: Ends,
        mut lengths: Lengths,
    ) {
        let Surroundings { shell, nearby } = surroundings;
        let Ends { start: mut pose, mut goal, is_out } = ends;
        self.held.clear();
        self.held.extend_from_slice(&self.rest.pushes);
        self.rest.pushes.clear();
        self.rest.touching.clear();
        self.stopped.clear();
        self.rest.energy = f64::INFINITY;
        self.rest.is_outside = false;
        let mut has_held = false;
        for iteration in 0..MOST_ITERATIONS {
            let mut wish = Twist::between(&pose, &goal);
            let share = if iteration == 0 { FIRST_SHARE } else { SHARE };
            let path = Path { pose: &pose, twist: &wish };
            if !scan.look(surroundings, path, lengths.horizon, share) {
                break;
            }
            let is_outside = scan.least_gap() >= -lengths.tolerance;
            self.make_rows(scan, surroundings, path, lengths);
            // Friction holds back a tool that is outside. A body that moved onto it first pushes it out.
            let may_hold = !has_held && !is_out && (iteration == 0 || nearby.has_moved());
            if may_hold && is_outside {
                has_held = true;
                match self.hold_back(scan, nearby, path, lengths) {
                    Hold::None => self.is_slipping = false,
                    Hold::Stick => {
                        self.is_slipping = false;
                        (self.rest.pose, self.rest.is_outside) = (pose, true);
                        self.rest.known = scan.known(shell);
                        return;
                    }
                    Hold::Slip(held_back) => {
                        self.is_slipping = true;
                        goal = held_back;
                        wish = Twist::between(&pose, &goal);
                        let path = Path { pose: &pose, twist: &wish };
                        if !scan.look(surroundings, path, lengths.horizon, SHARE) {
                            break;
                        }
                        self.make_rows(scan, surroundings, path, lengths);
                    }
                }
                self.rows.truncate(self.plain);
            }
            let is_pushed = nearby.has_moved() && !has_held && !self.held.is_empty();
            let is_last = iteration + LAST_ITERATIONS >= MOST_ITERATIONS;
            let goes_out = !is_outside && (is_last || is_pushed || is_out);
            let target = if goes_out { [0.0; FREEDOMS] } else { wish.stacked(lengths.unit) };
            let found = closest(target, &self.rows, lengths.slack());
            self.remember(&found);
            if found.held().next().is_some() {
                list(&mut self.stopped, &self.near, &found);
            }
            if is_outside {
                let (energy, known) = (wish.squared(lengths.unit), scan.known(shell));
                self.keep(&found, Candidate { pose: &pose, energy, known });
            }
            let is_free = !goes_out && found.held().next().is_none();
            let twist =
                if is_free { wish } else { Twist::unstacked(found.motion, lengths.unit) };
            // A tool inside goes on, however short the way out is.
            let may_rest = is_outside && !is_free;
            // Written so that NaN rests.
            let goes_on = twist.way(shell.reach) > if may_rest { lengths.still } else { 0.0 };
            if !goes_on || iteration + 1 == MOST_ITERATIONS || is_out && is_outside {
                break;
            }
            let is_all = lengths.horizon >= wish.way(shell.reach);
            // Planes that face each other and are nearly parallel meet far away.
            let farthest = wish.way(shell.reach) + shell.reach;
            let near = farthest / twist.way(shell.reach).max(farthest);
            let most = if is_free { 1.0 } else { twist.part_up_to(MOST_ANGLE).min(near) };
            let path = Path { pose: &pose, twist: &twist };
            let part = scan.sweep(surroundings, path, lengths.skin, most);
            scan.moved(&twist.part(part));
            if is_free && part >= 1.0 {
                pose = goal;
                if is_all && self.rows.is_empty() {
                    // No point could touch: the goal is proven free without further evaluation.
                    let energy = Twist::between(&pose, &goal).squared(1.0);
                    let known = scan.known(shell);
                    self.keep(&found, Candidate { pose: &pose, energy, known });
                    break;
                }
            } else {
                pose = twist.part(part).moved(&pose);
            }
            let way = twist.way(shell.reach);
            if part < 1.0 && part * way > 0.5 * lengths.horizon {
                lengths.horizon *= FARTHER;
            } else {
                lengths.horizon = lengths.horizon.min((NEXT * way).max(lengths.still));
            }
        }
        if self.rest.is_outside {
            if self.rest.pushes.is_empty() && self.rest.pose != goal {
                self.rest.pushes.extend_from_slice(&self.stopped);
            }
            if self.rest.pose != pose {
                scan.moved(&Twist::between(&pose, &self.rest.pose));
            }
        } else {
            self.rest.pose = pose;
            self.rest.known = 0;
        }
    }

    /// The tangent planes of all points that the desired motion could bring to the surface: of the
    /// nearest body, and of each body in reach that faces it.
    fn make_rows(
        &mut self,
        scan: &mut Scan,
        surroundings: Surroundings<'_>,
        path: Path<'_>,
        lengths: Lengths,
    ) {
        let Surroundings { shell, nearby } = surroundings;
        let Path { pose, twist: wish } = path;
        self.rows.clear();
        self.near.clear();
        let lipschitz = nearby.lipschitz();
        let (linear, angular) = (wish.linear.norm(), wish.angular.norm());
        let (evaluations, left) = (Cell::new(0), scan.left());
        for (point, seen) in scan.seen() {
            let arm = seen.centre - pose.translation;
            let reach = lipschitz * (linear + angular * arm.norm()).min(lengths.horizon);
            if seen.gap > reach {
                continue;
            }
            self.add_row(Near { point, seen: *seen }, arm, lipschitz, lengths);
            let radius = shell.points().get(point as usize).map_or(0.0, |point| point.radius);
            let most = reach + radius;
            let other = |body| (body != seen.body && evaluations.get() < left).then_some(most);
            for value in nearby.each_within(seen.centre, &Punctured::default(), other) {
                evaluations.set(evaluations.get() + 1);
                let (gap, gradient) = (value.distance - radius, value.gradient);
                let other = Evaluation { gap, gradient, body: value.body, ..*seen };
                let near = Near { point, seen: other };
                if gap <= reach && near.faces(seen) {
                    self.add_row(near, arm, lipschitz, lengths);
                }
            }
        }
        scan.spend(evaluations.get());
        self.add_pushed(scan, path, lipschitz, lengths);
        self.plain = self.rows.len();
    }

    /// Adds the tangent planes that pushed earlier in this tick, of points that now see a face on
    /// the other side of them: in a groove, a point sees one of its two sides at a time.
    fn add_pushed(&mut self, scan: &Scan, path: Path<'_>, lipschitz: f64, lengths: Lengths) {
        for index in 0..self.pushed.len() {
            let Some(near) = self.pushed.get(index).copied() else { continue };
            let Some(seen) = scan.point(near.point) else { continue };
            let gap = near.seen.gap + near.seen.gradient.dot(seen.centre - near.seen.centre);
            if near.faces(seen) && gap >= -lengths.tolerance {
                let near =
                    Near { seen: Evaluation { gap, centre: seen.centre, ..near.seen }, ..near };
                self.add_row(near, seen.centre - path.pose.translation, lipschitz, lengths);
            }
        }
    }

    /// Remembers the contacts that push.
    fn remember(&mut self, found: &Closest) {
        for held in found.held().filter(|held| held.push > 0.0) {
            let Some(near) = self.near.get(held.row) else { continue };
            let same = |it: &&mut Near| it.point == near.point && !it.faces(&near.seen);
            if let Some(known) = self.pushed.iter_mut().find(same) {
                *known = *near;
            } else if self.pushed.len() < self.pushed.capacity() {
                self.pushed.push(*near);
            }
        }
    }

    /// Adds the tangent plane of a body at a point.
    fn add_row(&mut self, near: Near, arm: Vector<f64, 3>, lipschitz: f64, lengths: Lengths) {
        let slope = near.seen.gradient.norm();
        // Written so that NaN is left out.
        if slope > LEAST_SLOPE * lipschitz && self.near.len() < self.near.capacity() {
            let normal = near.seen.gradient * (1.0 / slope);
            let along = stacked_along(arm, normal, lengths.unit);
            self.rows.push(Row { along, least: -near.seen.gap / slope });
            self.near.push(near);
        }
    }

    /// Keeps a free pose if it is the closest so far.
    fn keep(&mut self, found: &Closest, candidate: Candidate<'_>) {
        let Candidate { pose, energy, known } = candidate;
        if energy.is_nan() || energy >= self.rest.energy {
            return;
        }
        (self.rest.pose, self.rest.energy) = (*pose, energy);
        (self.rest.known, self.rest.is_outside) = (known, true);
        list(&mut self.rest.pushes, &self.near, found);
        self.list_touching(energy.sqrt());
    }

    /// Lists the points that touch the bodies at the present pose, `depth` from the goal [m].
    pub(super) fn list_touching(&mut self, depth: f64) {
        self.rest.touching.clear();
        if self.has_springs {
            let all = self.near.iter().map(|near| near.push(0.0));
            self.rest.touching.extend(all.filter(|push| push.touches(depth) > 0.0));
        }
    }
}

/// Whether bodies have different springs.
fn have_different_springs(nearby: &Nearby<'_>) -> bool {
    let mut all = nearby.all().map(|(_, body)| &body.surface().strata);
    let first = all.next();
    first.is_some_and(|first| all.any(|strata| !strata.has_springs_of(first)))
}

/// Lists the pushes of a solution.
fn list(pushes: &mut FixedList<Push>, near: &[Near], found: &Closest) {
    pushes.clear();
    for held in found.held().filter(|held| held.push > 0.0) {
        let Some(near) = near.get(held.row) else { continue };
        if pushes.len() < pushes.capacity() {
            pushes.push(near.push(held.push));
        }
    }
}

/// The row that gives the motion along `normal` of a point at `arm` from the tool's origin.
pub(super) fn stacked_along(
    arm: Point<3>,
    normal: Vector<f64, 3>,
    unit: f64,
) -> [f64; FREEDOMS] {
    let [x, y, z] = normal.0;
    let [a, b, c] = (arm.cross(normal) * (1.0 / unit)).0;
    [x, y, z, a, b, c]
}
