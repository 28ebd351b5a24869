// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The region in which two bodies touch, box by box.

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Point, Vector};

use super::fill::Middle;
use super::{ManifoldSettings, Touch};
use crate::pair::PairWorkspace;
use crate::pair::cell::{Cell, least_of_larger, reach};
use crate::pair::couple::{Couple, Memory};
use crate::pair::search::ROOM;

/// Steps to the surface between at most.
const STEPS: usize = 4;

/// How close to it is on it, as a share of [`ManifoldSettings::depth`].
const ON: f64 = 1e-3;

/// Boxes in which the gap varies by no more than this share of the same beyond an affine
/// function are flat.
const FLAT: f64 = 0.05;

/// Appends candidates on the surface between, and the flat boxes in the middle of the
/// region; `false` if the budget ended first.
pub(super) fn find<const D: usize>(
    couple: &mut Couple<'_, D>,
    settings: &ManifoldSettings,
    budget: u32,
    workspace: &mut PairWorkspace<D>,
    (candidates, middles): (&mut Vec<Touch<D>>, &mut Vec<Middle<D>>),
) -> bool {
    let half_margin = 0.5 * settings.margin;
    let root = couple.root(half_margin);
    let slack = couple.slack(reach(&root));
    let limit = half_margin + slack;
    let PairWorkspace { pending, open, memory, .. } = workspace;
    let mut small = Vec::new();
    let mut parts = [Cell::NOTHING; BLOCK];
    let mut values = [[0.0; BLOCK]; 2];
    Cell::unknown(&root).grid(pending);
    let mut is_whole = true;
    while !pending.is_empty() {
        is_whole = couple.evaluations < budget && pending.len() + (BLOCK << D) <= ROOM;
        if !is_whole {
            break;
        }
        let first = pending.len().saturating_sub(BLOCK);
        let count = pending.len() - first;
        parts[..count].copy_from_slice(&pending[first..]);
        pending.truncate(first);
        for (body, values) in values.iter_mut().enumerate() {
            couple.values(body, &parts[..count], memory, values);
        }
        let mut is_open = [false; BLOCK];
        for (i, part) in parts[..count].iter().enumerate() {
            let ([a, b], radius) = ([values[0][i], values[1][i]], part.radius());
            is_open[i] = a.max(b) - radius <= limit && (a - b).abs() <= 2.0 * (radius + slack);
        }
        open.clear();
        open.extend((0..count).filter(|&i| is_open[i]));
        couple.keep_known(&parts[..count], open, memory);
        for body in 0..2 {
            couple.models(body, &parts[..count], open, memory);
        }
        for (lane, &i) in open.iter().enumerate() {
            let models = [0, 1].map(|body| couple.model(body, memory, lane));
            let found = look::<D>(&models, settings, slack);
            is_open[i] = found == Look::Open;
            if found == Look::Middle {
                middles.extend(Middle::of(&parts[i], &models));
            }
        }
        for part in (0..count).filter(|&i| is_open[i]).map(|i| &parts[i]) {
            let longest = (0..D).fold(0.0_f64, |longest, k| longest.max(part.half[k]));
            if longest <= 0.5 * settings.spacing {
                small.push(*part);
            } else {
                let mut halves = [Cell::NOTHING; 8];
                let count = part.halve(&mut halves, 0);
                pending.extend_from_slice(&halves[..count]);
            }
        }
    }
    for cells in small.chunks(BLOCK) {
        settle(couple, cells, settings, memory, candidates);
    }
    is_whole
}

/// What the models of a box say of the surface between.
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
    let (mut across, mut along) = (0.0, [0.0; 2]);
    for (a, b) in a.gradient.iter().zip(b.gradient) {
        across += (a - b).abs();
        along = [along[0] + a.abs(), along[1] + b.abs()];
    }
    let half_margin = 0.5 * settings.margin;
    let between = across + (a.lower + b.upper).max(a.upper + b.lower);
    let is_flat = a.lower.max(a.upper) + b.lower.max(b.upper) <= FLAT * settings.depth();
    let is_inside = a.value + along[0] + a.upper < half_margin
        && b.value + along[1] + b.upper < half_margin;
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
    couple: &mut Couple<'_, D>,
    cells: &[Cell<D>],
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
        couple.block_slopes(&points[..count], memory, &mut slopes);
        let mut left = 0;
        for i in 0..count {
            let cell = &cells[from[i]];
            match towards(points[i], [slopes[0][i], slopes[1][i]], settings) {
                Towards::Nothing => {}
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

/// What a point and its slopes say of the surface between.
pub(super) enum Towards<const D: usize> {
    /// It is here, and within the margin.
    There(Touch<D>),
    /// It may be here.
    Next(Point<D>),
    /// The bodies do not face each other, or are farther apart.
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
    if apart.abs() > ON * settings.depth() {
        return Towards::Next(p - between * (apart / squared));
    }
    let gap = 2.0 * a.max(b);
    if gap > settings.margin {
        return Towards::Nothing;
    }
    Towards::There(Touch { point: p, normal: between * (1.0 / squared.sqrt()), gap })
}
