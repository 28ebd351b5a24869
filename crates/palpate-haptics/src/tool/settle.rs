// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where a tool comes to rest: as close to the device as the bodies let it.
//!
//! The *closeness* of two poses is the energy of the spring between them, `‖v‖² + ℓ²‖ω‖²` with
//! the length `ℓ` whose square is angular over linear stiffness. Each turn looks at the points
//! that could touch, replaces the bodies there by their tangent planes, and goes to the closest
//! pose that all planes allow: the quasi-statics of Ortega, Redon and Coquillart, "A six
//! degree-of-freedom god-object method for haptic display of rigid bodies with surface
//! properties" (2007), with positions for accelerations, until it stays. On the way no point may
//! dip deeper than a skin, which evaluations prove as for a [`Proxy`](crate::Proxy); at rest
//! none may be inside.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Pose, Vector};

use super::batch::Seen;
use super::closest::{Closest, FREEDOMS, Row, closest};
use super::friction::{Cone, Hold, MOST_AROUND};
use super::room::Room;
use super::scan::Scan;
use super::shell::Shell;
use super::twist::Twist;
use crate::nearby::Nearby;
use palpate_safety::{cross, in_space};

/// Turns of a tick. Sliding takes three or four; the rest is for strikes and creases.
const MOST_TURNS: usize = 6;

/// In these last turns, a tool that is not outside goes straight out instead of on: where it
/// turns much, each turn ends a little inside.
const LAST_TURNS: usize = 3;

/// What the first look may take of the budget, and each further one of what is left.
const FIRST_SHARE: f64 = 0.25;
const SHARE: f64 = 0.5;

/// After a turn that was cut short by its horizon, the next looks this many times as far.
const FARTHER: f64 = 4.0;

/// After any other turn, the next looks at most this many times as far as that one would have
/// gone: motions get shorter, and where one grows, it is cut short and looks farther. Less
/// would cut short more often, more looks at what nothing comes to.
const NEXT: f64 = 1.5;

/// Constraints are satisfied up to this part of the tolerance.
const SLACK: f64 = 1e-3;

/// Below this part of the Lipschitz constant a gradient says nothing about the surface.
const LEAST_SLOPE: f64 = 0.1;

/// The most that one turn turns the tool among contacts [rad]: their planes turn with it.
const MOST_ANGLE: f64 = 0.3;

/// What a tool lives with in a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lengths {
    /// How long one radian is [m]: ℓ.
    pub(super) unit: f64,
    /// How deep a point may rest [m].
    pub(super) tolerance: f64,
    /// The tool rests where the next motion is less [m].
    pub(super) still: f64,
    /// How deep a point may dip on its way [m].
    pub(super) skin: f64,
    /// How far points are likely to move in this tick [m]: what is farther from the bodies is
    /// looked at only if they do.
    pub(super) horizon: f64,
}

impl Lengths {
    /// How much a constraint may be violated by [m].
    pub(super) fn slack(&self) -> f64 {
        SLACK * self.tolerance
    }
}

/// A point that pushes the tool. World coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push<const D: usize> {
    pub(super) point: u32,
    pub(super) centre: Point<D>,
    /// The unit normal of the body, pointing out.
    pub(super) normal: Vector<f64, D>,
    /// The distance from the ball to the body, to first order [m].
    pub(super) gap: f64,
    pub(super) body: u32,
    /// Its force over the stiffness [m].
    pub(super) push: f64,
}

/// Where a tool rests.
#[derive(Clone, Debug)]
pub(super) struct Rest<const D: usize> {
    pub(super) pose: Pose<D>,
    /// What pushes it there.
    pub(super) pushes: Room<Push<D>>,
    /// Points known to be outside.
    pub(super) known: u32,
    /// `true` if every point that was looked at is outside.
    pub(super) is_outside: bool,
    /// How far from the goal, squared [m²].
    energy: f64,
}

impl<const D: usize> Rest<D> {
    pub(super) fn new() -> Self {
        Self {
            pose: Pose::identity(),
            pushes: Room::with_capacity(FREEDOMS),
            known: 0,
            is_outside: false,
            energy: f64::INFINITY,
        }
    }
}

/// Room for a tick.
#[derive(Clone, Debug)]
pub(super) struct Settler<const D: usize> {
    pub(super) rows: Room<Row>,
    /// Of which point each of the first rows is; those after them are of cones of friction.
    numbers: Room<u32>,
    /// How many rows there are without those of friction.
    pub(super) plain: usize,
    /// Points that pushed in the tick before.
    pub(super) held: Room<u32>,
    /// Contacts with friction.
    pub(super) cones: Room<Cone<D>>,
    /// `true` if the tool moved against friction.
    pub(super) is_slipping: bool,
    pub(super) rest: Rest<D>,
}

impl<const D: usize> Settler<D> {
    pub(super) fn new(points: usize) -> Self {
        Self {
            rows: Room::with_capacity(points + FREEDOMS * MOST_AROUND),
            numbers: Room::with_capacity(points),
            plain: 0,
            held: Room::with_capacity(FREEDOMS),
            cones: Room::with_capacity(FREEDOMS),
            is_slipping: false,
            rest: Rest::new(),
        }
    }

    /// Moves the tool from `start` towards `goal`; [`rest`](Self::rest) says where it came to.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; at most [`MOST_TURNS`] turns,
    /// and the evaluations that `scan` has left.
    pub(super) fn settle(
        &mut self,
        (shell, scan, nearby): (&Shell<D>, &mut Scan<D>, &Nearby<'_, D>),
        (start, goal): (Pose<D>, Pose<D>),
        lengths: Lengths,
    ) {
        let mut horizon = lengths.horizon;
        let (mut pose, mut goal) = (start, goal);
        self.held.clear();
        self.held.extend(self.rest.pushes.iter().map(|push| push.point));
        self.rest.pushes.clear();
        self.rest.energy = f64::INFINITY;
        self.rest.is_outside = false;
        for turn in 0..MOST_TURNS {
            let mut wish = Twist::between(&pose, &goal);
            let share = if turn == 0 { FIRST_SHARE } else { SHARE };
            if !scan.look(shell, nearby, &pose, (&wish, horizon, share)) {
                break;
            }
            let is_outside = scan.least_gap() >= -lengths.tolerance;
            self.make_rows((scan, nearby), (&pose, &wish, horizon, lengths));
            if turn == 0 && is_outside {
                match self.hold_back((scan, nearby), (&pose, &wish), lengths) {
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
                        if !scan.look(shell, nearby, &pose, (&wish, horizon, SHARE)) {
                            break;
                        }
                        self.make_rows((scan, nearby), (&pose, &wish, horizon, lengths));
                    }
                }
                self.rows.truncate(self.plain);
            }
            let goes_out = !is_outside && turn + LAST_TURNS >= MOST_TURNS;
            let target = if goes_out { [0.0; FREEDOMS] } else { wish.stacked(lengths.unit) };
            let found = closest(target, &self.rows, lengths.slack());
            if is_outside {
                self.keep(scan, (&pose, &wish, lengths.unit), &found, scan.known(shell));
            }
            let is_free = !goes_out && found.held().next().is_none();
            let twist =
                if is_free { wish } else { Twist::unstacked(found.motion, lengths.unit) };
            // Written so that NaN rests.
            let goes_on = twist.way(shell.reach) > if is_free { 0.0 } else { lengths.still };
            if !goes_on || turn + 1 == MOST_TURNS {
                break;
            }
            let is_all = horizon >= wish.way(shell.reach);
            let most = if is_free { 1.0 } else { twist.part_up_to(MOST_ANGLE) };
            let way = (&pose, &twist);
            let part = scan.sweep((shell, nearby), way, lengths.skin, most);
            scan.moved(&twist.part(part));
            if is_free && part >= 1.0 {
                pose = goal;
                if is_all && self.rows.is_empty() {
                    // Nothing that could touch: proven free, without another look.
                    self.keep(
                        scan,
                        (&pose, &Twist::between(&pose, &goal), 1.0),
                        &found,
                        scan.known(shell),
                    );
                    break;
                }
            } else {
                pose = twist.part(part).moved(&pose);
            }
            let way = twist.way(shell.reach);
            if part < 1.0 && part * way > 0.5 * horizon {
                horizon *= FARTHER;
            } else {
                horizon = horizon.min((NEXT * way).max(lengths.still));
            }
        }
        if self.rest.is_outside {
            if self.rest.pose != pose {
                scan.moved(&Twist::between(&pose, &self.rest.pose));
            }
        } else {
            self.rest.pose = pose;
            self.rest.known = 0;
        }
    }

    /// The tangent planes of all points that the wish could bring to the surface.
    fn make_rows(
        &mut self,
        (scan, nearby): (&Scan<D>, &Nearby<'_, D>),
        (pose, wish, horizon, lengths): (&Pose<D>, &Twist<D>, f64, Lengths),
    ) {
        self.rows.clear();
        self.numbers.clear();
        let lipschitz = nearby.lipschitz();
        let (linear, angular) = (wish.linear.norm(), wish.angular.norm());
        for (number, seen) in scan.seen() {
            let arm = seen.centre - pose.translation;
            if seen.gap > lipschitz * (linear + angular * arm.norm()).min(horizon) {
                continue;
            }
            let slope = seen.gradient.norm();
            // Written so that NaN is left out.
            if slope > LEAST_SLOPE * lipschitz && self.numbers.len() < self.numbers.capacity() {
                let normal = seen.gradient * (1.0 / slope);
                let along = stacked_along(arm, normal, lengths.unit);
                self.rows.push(Row { along, least: -seen.gap / slope });
                self.numbers.push(number);
            }
        }
        self.plain = self.rows.len();
    }

    /// Keeps a pose that is outside if it is the closest so far.
    fn keep(
        &mut self,
        scan: &Scan<D>,
        (pose, wish, unit): (&Pose<D>, &Twist<D>, f64),
        found: &Closest,
        known: u32,
    ) {
        let energy: f64 = wish.stacked(unit).iter().map(|x| x * x).sum();
        if energy.is_nan() || energy >= self.rest.energy {
            return;
        }
        (self.rest.pose, self.rest.energy) = (*pose, energy);
        (self.rest.known, self.rest.is_outside) = (known, true);
        self.rest.pushes.clear();
        for held in found.held() {
            let number = self.numbers.get(held.row).copied();
            let Some((point, seen)) = number.and_then(|n| Some((n, scan.point(n)?))) else {
                continue;
            };
            if held.push <= 0.0 || self.rest.pushes.len() == self.rest.pushes.capacity() {
                continue;
            }
            let Seen { centre, body, .. } = *seen;
            let slope = seen.gradient.norm();
            let (normal, gap) = (seen.gradient * (1.0 / slope), seen.gap / slope);
            let push = held.push;
            self.rest.pushes.push(Push { point, centre, normal, gap, body, push });
        }
    }
}

/// How a motion of the tool moves a point `arm` from its origin along `normal`, as a row.
pub(super) fn stacked_along<const D: usize>(
    arm: Point<D>,
    normal: Vector<f64, D>,
    unit: f64,
) -> [f64; FREEDOMS] {
    let [x, y, z] = in_space(normal).0;
    let [a, b, c] = (cross(in_space(arm), in_space(normal)) * (1.0 / unit)).0;
    [x, y, z, a, b, c]
}
