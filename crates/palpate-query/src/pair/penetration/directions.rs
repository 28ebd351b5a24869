// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The penetration of two convex bodies, by branch and bound over directions.
//!
//! # Derivation
//!
//! Let `h(u)` be the sum of how far the first body reaches along the unit vector u and the second
//! one along −u. After a translation of the second body by `h(u)·u` a plane across u lies between
//! both bodies. Two convex bodies without a common interior always have such a plane. So the least
//! `h` is the penetration.
//!
//! A ball about c within the first body and one about d within the second, with radii whose sum is
//! ρ, prove `h(v) ≥ (c − d)·v + ρ` for every v. Over a cap of directions within the angle θ of u the
//! least of this is reached at the cap's border. With `c − d` split into its part a along u and its
//! length b across u it is `a·cos θ − b·sin θ + ρ`. A mean of such balls proves as much, and the
//! search takes that mean which proves most. For balls the bound holds with equality, for flat faces
//! the means are exact, and elsewhere the loss is of second order in θ.
//!
//! The cells are squares on the faces of a cube about the origin, seen from there.

use std::collections::BinaryHeap;

use palpate_field::Vector;

use super::least_first::LeastFirst;
use super::overlap_ball::OverlapBall;
use super::support::Support;
use crate::certified::{Limits, Stop};
use crate::engine::Bounded;

/// How many overlap balls a cell passes on to its parts: a mean and those that may be next to it.
const KEPT: usize = 4;

/// Steps of a search for the best mean of two balls, each of which cuts the range to 0.62.
const GOLDEN_STEPS: u32 = 16;

/// Directions in a row that follow from the last one.
const FOLLOWED: u32 = 4;

/// Half the side of a square from which on rounding hides what a smaller one would show.
const SMALLEST: f64 = 1e-9;

/// The share of the tolerance to which a reach is computed.
const FINE: f64 = 1.0 / 64.0;

/// What a search over directions found; without the rounding of `slack`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found<const D: usize> {
    pub(super) lower: f64,
    pub(super) upper: f64,
    /// In the frame.
    pub(super) direction: Vector<f64, D>,
    pub(super) stop: Stop,
}

/// Directions through a square on a face of the cube.
#[derive(Clone, Copy, Debug)]
struct Cell<const D: usize> {
    /// The axis of the face; the coordinate of `middle` along it is 1 or −1.
    axis: usize,
    middle: Vector<f64, D>,
    half: f64,
    /// Less than this `h` is nowhere in the cell [m].
    lower: f64,
    known: [OverlapBall<D>; KEPT],
}

impl<const D: usize> Cell<D> {
    /// A whole face.
    fn face(axis: usize, side: f64, all: OverlapBall<D>) -> Self {
        let middle = Vector::unit(axis) * side;
        Self { axis, middle, half: 1.0, lower: f64::NEG_INFINITY, known: [all; KEPT] }
    }

    /// The corner or part `i` of the square.
    fn corner(&self, i: usize, half: f64) -> Vector<f64, D> {
        let mut corner = self.middle;
        for (bit, k) in (0..D).filter(|&k| k != self.axis).enumerate() {
            corner[k] += if i >> bit & 1 == 1 { half } else { -half };
        }
        corner
    }

    /// Squares of half the side.
    fn parts(self) -> impl Iterator<Item = Self> {
        let half = 0.5 * self.half;
        (0..1_usize << (D - 1)).map(move |i| Self {
            middle: self.corner(i, half),
            half,
            ..self
        })
    }

    /// The cap of directions around the cell. A cap is convex, so it holds the cell if it holds the
    /// corners.
    fn cap(&self) -> Cap<D> {
        let axis = direction(self.middle);
        let chords = (0..1_usize << (D - 1))
            .map(|i| (direction(self.corner(i, self.half)) - axis).norm());
        let chord = chords.fold(0.0_f64, f64::max) + 4.0 * f64::EPSILON;
        let cosine = 1.0 - 0.5 * chord * chord;
        Cap { axis, cosine, sine: chord * (1.0 - 0.25 * chord * chord).max(0.0).sqrt() }
    }
}

impl<const D: usize> Bounded for Cell<D> {
    fn lower(&self) -> f64 {
        self.lower
    }
}

fn direction<const D: usize>(v: Vector<f64, D>) -> Vector<f64, D> {
    v * (1.0 / v.norm())
}

/// Directions around one.
#[derive(Clone, Copy, Debug)]
struct Cap<const D: usize> {
    axis: Vector<f64, D>,
    cosine: f64,
    sine: f64,
}

impl<const D: usize> Cap<D> {
    /// What `h` is at least in the cap, by an overlap ball [m].
    fn bound(&self, ball: &OverlapBall<D>) -> f64 {
        let along = ball.centre.dot(self.axis);
        let across = (ball.centre - self.axis * along).norm();
        // The angle from the centre to the far border is more than a half turn.
        let is_opposite = along * self.sine + across * self.cosine < 0.0;
        let least = if is_opposite {
            -ball.centre.norm()
        } else {
            along * self.cosine - across * self.sine
        };
        least + ball.radius
    }

    /// The mean of two balls that proves most, which is a concave function of the share.
    fn best_mean(&self, a: &OverlapBall<D>, b: &OverlapBall<D>) -> OverlapBall<D> {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let bound = |share: f64| self.bound(&a.between(b, share));
        let (mut low, mut high) = (0.0, 1.0);
        let (mut left, mut right) = (1.0 - GOLDEN, GOLDEN);
        let (mut at_left, mut at_right) = (bound(left), bound(right));
        for _ in 0..GOLDEN_STEPS {
            if at_left > at_right {
                (high, right, at_right) = (right, left, at_left);
                left = high - GOLDEN * (high - low);
                at_left = bound(left);
            } else {
                (low, left, at_left) = (left, right, at_right);
                right = low + GOLDEN * (high - low);
                at_right = bound(right);
            }
        }
        let mean = a.between(b, 0.5 * (low + high));
        let all = [a, b, &mean];
        *all.into_iter().max_by(|x, y| self.bound(x).total_cmp(&self.bound(y))).unwrap_or(a)
    }
}

/// A search under way.
pub(super) struct DirectionTree<'a, const D: usize> {
    bodies: [Support<'a, D>; 2],
    /// Where each body reached last.
    last: [Vector<f64, D>; 2],
    tolerance: f64,
    budget: u32,
    room: usize,
    upper: f64,
    direction: Vector<f64, D>,
    /// An overlap ball that every cell knows.
    common: Option<OverlapBall<D>>,
}

impl<'a, const D: usize> DirectionTree<'a, D> {
    pub(super) fn new(bodies: [Support<'a, D>; 2], limits: &Limits, room: usize) -> Self {
        let last = [bodies[0].middle(), bodies[1].middle()];
        let slack = bodies[0].slack() + bodies[1].slack();
        let finest = bodies[0].finest() + bodies[1].finest();
        Self {
            bodies,
            last,
            // The bounds of the answer are farther apart by the slack on both sides.
            tolerance: (limits.tolerance - 2.0 * slack).max(slack + finest),
            budget: limits.budget,
            room,
            upper: f64::INFINITY,
            direction: Vector::unit(0),
            common: None,
        }
    }

    /// Every cell will know this ball. A large one about no translation proves at once that around
    /// an axis of both bodies all directions are alike.
    pub(super) fn know(&mut self, common: OverlapBall<D>) {
        self.common = Some(common);
    }

    pub(super) fn evaluations(&self) -> u32 {
        self.bodies[0].evaluations.saturating_add(self.bodies[1].evaluations)
    }

    /// The least `h`, or that it is not positive.
    pub(super) fn search(&mut self) -> Found<D> {
        let mut heap = BinaryHeap::new();
        for axis in 0..D {
            for side in [-1.0, 1.0] {
                let (all, _) = self.look(Vector::unit(axis) * side);
                let cell = self.bounded(Cell::face(axis, side, all));
                heap.push(LeastFirst(cell));
            }
        }
        // The least bound of the cells that are closed.
        let mut closed = f64::INFINITY;
        let mut is_full = false;
        let (stop, open) = loop {
            let Some(LeastFirst(cell)) = heap.pop() else {
                break (
                    if is_full { Stop::MemoryFull } else { Stop::Converged },
                    f64::INFINITY,
                );
            };
            if self.upper <= 0.0 {
                break (Stop::SignKnown, cell.lower);
            }
            if cell.lower >= self.upper - self.tolerance {
                break (Stop::Converged, cell.lower);
            }
            if self.evaluations() >= self.budget {
                break (Stop::BudgetSpent, cell.lower);
            }
            if cell.half < SMALLEST {
                break (Stop::RoundingReached, cell.lower);
            }
            for part in cell.parts() {
                let part = self.bounded(part);
                if part.lower >= self.upper - self.tolerance {
                    closed = closed.min(part.lower);
                } else if heap.len() < self.room {
                    heap.push(LeastFirst(part));
                } else {
                    closed = closed.min(part.lower);
                    is_full = true;
                }
            }
        };
        let lower = open.min(closed).min(self.upper);
        Found { lower, upper: self.upper, direction: self.direction, stop }
    }

    /// A cell with its bound, for which the bodies are asked only if what is known does not close it.
    fn bounded(&mut self, mut cell: Cell<D>) -> Cell<D> {
        let cap = cell.cap();
        let known = cell.known;
        let others = known[1..].iter().chain(&self.common);
        let inherited = others.fold(known[0], |a, b| cap.best_mean(&a, b));
        cell.lower = cell.lower.max(cap.bound(&inherited));
        if cell.lower >= self.upper - self.tolerance {
            return cell;
        }
        let (own, is_best) = self.look(cap.axis);
        let mut mean = cap.best_mean(&inherited, &own);
        for ball in known.iter().chain(&self.common) {
            mean = cap.best_mean(&mean, ball);
        }
        cell.lower = cell.lower.max(cap.bound(&mean));
        cell.known = [mean, own, known[1], known[2]];
        if is_best {
            self.follow(mean);
        }
        cell
    }

    /// Tries the directions that lead from the origin to what is known of the border of all overlaps.
    fn follow(&mut self, from: OverlapBall<D>) {
        let mut mean = from;
        for _ in 0..FOLLOWED {
            let Some(u) = mean.centre.normalized() else { break };
            let (own, is_best) = self.look(u);
            if !is_best {
                break;
            }
            let here = Cap { axis: u, cosine: 1.0, sine: 1e-3 };
            mean = here.best_mean(&mean, &own);
        }
    }

    /// Asks the bodies about a direction. Returns an overlap ball that is farthest along it, and
    /// whether `h` is the least so far.
    fn look(&mut self, u: Vector<f64, D>) -> (OverlapBall<D>, bool) {
        let fine = FINE * self.tolerance;
        let [a, b] = &mut self.bodies;
        let slacks = [a.slack(), b.slack()];
        let reach = [
            a.along(u, self.last[0], fine.max(slacks[0])),
            b.along(-u, self.last[1], fine.max(slacks[1])),
        ];
        self.last = reach.map(|reach| reach.point);
        let balls = [a.ball_behind(reach[0].point, u), b.ball_behind(reach[1].point, -u)];
        let between = (reach[0].point - reach[1].point).dot(u);
        let height = between + reach[0].excess + reach[1].excess;
        let is_best = height < self.upper;
        if is_best {
            (self.upper, self.direction) = (height, u);
        }
        (OverlapBall::of(balls), is_best)
    }
}
