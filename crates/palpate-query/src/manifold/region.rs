// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The region in which two bodies touch, box by box.

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Point, Vector};

use super::fill::Middle;
use super::{ManifoldSettings, Touch};
use crate::certified::Stop;
use crate::contact::NormalSource;
use crate::engine::{self, End, Frontier, Heap, Problem};
use crate::pair::PairWorkspace;
use crate::pair::body_pair::{BodyPair, Memory};
use crate::pair::cell::{BoxCell, least_of_larger};
use crate::pair::search::ROOM;

/// Steps to the surface between at most.
const STEPS: usize = 4;

/// A point counts as on the surface between the bodies within this share of
/// [`ManifoldSettings::precision_length`].
const ON: f64 = 1e-3;

/// Boxes in which the gap varies by no more than this share of the same beyond an affine
/// function are flat.
const FLAT: f64 = 0.05;

/// Flat boxes with half a side above this many spacings are halved: points are laid in the others, one
/// for each few spacings.
const WIDE: f64 = 4.0;

/// The region in which two bodies touch, in candidates and flat boxes.
#[derive(Debug)]
pub(super) struct Region<const D: usize> {
    /// Points on the surface between the bodies.
    pub(super) candidates: Vec<Touch<D>>,
    /// Flat boxes in the middle of the region.
    pub(super) middles: Vec<Middle<D>>,
    /// Why the search ended: [`Stop::Converged`] if the region is whole.
    pub(super) stop: Stop,
}

/// Finds the region in which two bodies touch; `first` is the first candidate.
pub(super) fn find<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    settings: &ManifoldSettings,
    budget: u32,
    workspace: &mut PairWorkspace<D>,
    first: Touch<D>,
) -> Region<D> {
    let root = pair.root(0.5 * settings.margin);
    let slack = pair.slack(root.radius_about_origin());
    let PairWorkspace { frontier, open, memory, .. } = workspace;
    frontier.queue.clear();
    BoxCell::unknown(&root).grid(&mut frontier.pending);
    let mut search = RegionSearch {
        pair,
        settings,
        budget,
        slack,
        open,
        memory,
        small: vec![],
        candidates: vec![first],
        middles: vec![],
    };
    let stop = match engine::search(&mut search, frontier) {
        // No box is left to be halved.
        End::Exhausted => Stop::Converged,
        end => end.stop(),
    };
    let RegionSearch { pair, small, mut candidates, middles, memory, .. } = search;
    for cells in small.chunks(BLOCK) {
        settle(pair, cells, settings, memory, &mut candidates);
    }
    Region { candidates, middles, stop }
}

/// A search for all boxes down to the spacing that the surface between the bodies crosses.
/// It bounds no least value: no box comes before another, and all are searched.
struct RegionSearch<'s, 'a, const D: usize> {
    pair: &'s mut BodyPair<'a, D>,
    settings: &'s ManifoldSettings,
    budget: u32,
    slack: f64,
    open: &'s mut Vec<usize>,
    memory: &'s mut Memory<D>,
    /// Boxes no larger than the spacing that the surface may cross.
    small: Vec<BoxCell<D>>,
    candidates: Vec<Touch<D>>,
    middles: Vec<Middle<D>>,
}

impl<const D: usize> RegionSearch<'_, '_, D> {
    /// Which boxes of a round the surface between may cross, within the margin, as far as
    /// the values at their centres tell.
    fn is_near(&mut self, round: &[BoxCell<D>]) -> [bool; BLOCK] {
        let limit = 0.5 * self.settings.margin + self.slack;
        let mut values = [[0.0; BLOCK]; 2];
        for (body, values) in values.iter_mut().enumerate() {
            self.pair.values(body, round, self.memory, values);
        }
        let mut is_near = [false; BLOCK];
        for (i, part) in round.iter().enumerate() {
            let ([a, b], radius) = ([values[0][i], values[1][i]], part.radius());
            is_near[i] =
                a.max(b) - radius <= limit && (a - b).abs() <= 2.0 * (radius + self.slack);
        }
        is_near
    }
}

impl<const D: usize> Problem for RegionSearch<'_, '_, D> {
    type Queue = Heap<BoxCell<D>>;

    fn round_and_parts(&self) -> (usize, usize) {
        (BLOCK, 1 << D)
    }

    fn decided(&self, _lower: f64) -> Option<Stop> {
        None
    }

    fn has_room(&self, frontier: &Frontier<Self::Queue>) -> bool {
        frontier.pending.len() + (BLOCK << D) <= ROOM
    }

    fn is_spent(&self) -> bool {
        self.pair.evaluations >= self.budget
    }

    /// Boxes are halved once they are bounded, and their halves are pending.
    fn can_split(&self, _queue: &Self::Queue) -> bool {
        false
    }

    fn split(&mut self, cell: &BoxCell<D>, round: &mut Vec<BoxCell<D>>) {
        cell.halve(round);
    }

    fn bound(&mut self, frontier: &mut Frontier<Self::Queue>) {
        let Frontier { pending, round, .. } = frontier;
        let mut is_open = self.is_near(round);
        self.open.clear();
        self.open.extend((0..round.len()).filter(|&i| is_open[i]));
        self.pair.keep_known(round, self.open, self.memory);
        for body in 0..2 {
            self.pair.models(body, round, self.open, self.memory);
        }
        for (lane, &i) in self.open.iter().enumerate() {
            let models = [0, 1].map(|body| self.pair.model(body, self.memory, lane));
            let mut found = look::<D>(&models, self.settings, self.slack);
            if longest_half(&round[i]) > WIDE * self.settings.spacing && found == Look::Middle {
                found = Look::Open;
            }
            is_open[i] = found == Look::Open;
            if let (Look::Middle, Some(middle)) = (found, Middle::of(&round[i], &models)) {
                middle.lay(&round[i], self.settings, &mut self.candidates);
                self.middles.push(middle);
            }
        }
        let mut lanes = is_open.iter();
        round.retain(|_| lanes.next() == Some(&true));
        for part in round.drain(..) {
            if longest_half(&part) <= 0.5 * self.settings.spacing {
                self.small.push(part);
            } else {
                self.split(&part, pending);
            }
        }
    }

    fn is_open(&self, _cell: &BoxCell<D>) -> bool {
        false
    }

    fn close(&mut self, _cell: &BoxCell<D>, _queue: &mut Self::Queue) {}

    fn closed(&self) -> f64 {
        f64::NEG_INFINITY
    }
}

/// Half of the longest side of a box [m].
fn longest_half<const D: usize>(part: &BoxCell<D>) -> f64 {
    (0..D).fold(0.0_f64, |longest, k| longest.max(part.half[k]))
}

/// What models prove of the surface between the bodies in a box.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Look {
    /// The box may hold a part of it.
    Open,
    /// It holds the middle of a flat patch, which its rim spans, where there is one.
    Middle,
    /// It holds none, or none within the margin.
    Nothing,
}

fn look<const D: usize>([a, b]: &[Model; 2], settings: &ManifoldSettings, slack: f64) -> Look {
    let (mut across, mut along) = (0.0, 0.0);
    for (a, b) in a.gradient.iter().zip(b.gradient) {
        across += (a - b).abs();
        along += (a + b).abs();
    }
    let half_margin = 0.5 * settings.margin;
    let between = across + (a.lower + b.upper).max(a.upper + b.lower);
    let is_flat =
        a.lower.max(a.upper) + b.lower.max(b.upper) <= FLAT * settings.precision_length();
    // On the surface between, both values are their mean, which varies less than either.
    let is_inside = 0.5 * (a.value + b.value + along + a.upper + b.upper) < half_margin;
    if (a.value - b.value).abs() > between + 2.0 * slack
        || least_of_larger::<D>(a, b, f64::INFINITY).0 > half_margin + slack
    {
        Look::Nothing
    } else if is_flat && is_inside {
        Look::Middle
    } else {
        Look::Open
    }
}

/// Moves the centres of boxes to the surface between, along the gradient of `g_a − g_b`,
/// and appends those that get there and where the bodies face each other.
fn settle<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    cells: &[BoxCell<D>],
    settings: &ManifoldSettings,
    memory: &mut Memory<D>,
    candidates: &mut Vec<Touch<D>>,
) {
    let mut points = [Vector::ZERO; BLOCK];
    let mut from = [0; BLOCK];
    for (i, cell) in cells.iter().enumerate() {
        (points[i], from[i]) = (cell.centre, i);
    }
    let mut count = cells.len();
    let mut slopes = [[(0.0, Vector::ZERO); BLOCK]; 2];
    for step in 0..STEPS {
        pair.block_slopes(&points[..count], memory, &mut slopes);
        let mut left = 0;
        for i in 0..count {
            let cell = &cells[from[i]];
            match towards(points[i], [slopes[0][i], slopes[1][i]], settings) {
                Towards::Nothing => {}
                Towards::There(touch) if touch.gap > settings.margin => {}
                Towards::There(touch) => candidates.push(touch),
                Towards::Next(next) => {
                    if step + 1 < STEPS && (next - cell.centre).norm() <= 1.5 * cell.radius() {
                        (points[left], from[left]) = (next, from[i]);
                        left += 1;
                    }
                }
            }
        }
        count = left;
        if count == 0 {
            break;
        }
    }
}

/// Where the surface between the bodies is, as seen from a point with its slopes.
pub(super) enum Towards<const D: usize> {
    /// It is here.
    There(Touch<D>),
    /// It may be here.
    Next(Point<D>),
    /// The bodies do not face each other.
    Nothing,
}

/// One step of Newton's method to where both values are equal.
pub(super) fn towards<const D: usize>(
    p: Point<D>,
    [(a, slope_a), (b, slope_b)]: [(f64, Vector<f64, D>); 2],
    settings: &ManifoldSettings,
) -> Towards<D> {
    let between = slope_a - slope_b;
    let squared = between.dot(between);
    if slope_a.dot(slope_b) >= 0.0 || squared == 0.0 {
        return Towards::Nothing;
    }
    let apart = a - b;
    if apart.abs() > ON * settings.precision_length() {
        return Towards::Next(p - between * (apart / squared));
    }
    let (gap, normal) = (2.0 * a.max(b), between * (1.0 / squared.sqrt()));
    Towards::There(Touch { point: p, normal, gap, source: NormalSource::Gradients })
}
