// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How far interpolated values may be from the source's.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Block, Column, Shape, Vector};

use crate::certificate::Cells;
use crate::control::{MOST_TAPS, apply, gather};
use crate::lattice::{Lattice, indices, unravelled};
use crate::samples::BRICK;
use crate::spline::{OfTaps, Spline};

/// A cell is halved where its bound is more than this share of a cell.
const COARSE: f64 = 0.05;

/// Rounded operations on samples that a bound takes at most.
const ROUNDED: f64 = 64.0;

/// How often a cell is halved at most: at an edge of the source, two halvings take a bound from 0.87 to half a cell.
const DEEPEST: u32 = 2;

/// A cell of a brick, or a part of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part<const D: usize> {
    /// The cell's middle node in the brick, or the lower of two.
    key: [usize; D],
    /// The place of the cell's first sample.
    place: usize,
    /// How often the cell was halved along each axis.
    level: u32,
    /// Which of the parts it is.
    number: [usize; D],
}

impl<const D: usize> Part<D> {
    pub(crate) fn whole(key: [usize; D], place: usize) -> Self {
        Self { key, place, level: 0, number: [0; D] }
    }

    fn halves(self) -> impl Iterator<Item = Self> {
        indices([0; D], [2; D]).map(move |side| Self {
            level: self.level + 1,
            number: std::array::from_fn(|i| 2 * self.number[i] + side[i]),
            ..self
        })
    }

    /// The middle of the part from the cell's own middle, along each axis [cells].
    fn middle(&self) -> [f64; D] {
        let parts = f64::from(1 << self.level);
        self.number.map(|number| (number as f64 + 0.5) / parts - 0.5)
    }
}

/// A part that may be halved, with the bound over it [m].
struct Waiting<const D: usize> {
    bound: f64,
    part: Part<D>,
}

impl<const D: usize> PartialEq for Waiting<D> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<const D: usize> Eq for Waiting<D> {}

impl<const D: usize> PartialOrd for Waiting<D> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<const D: usize> Ord for Waiting<D> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl<const D: usize> Cells<'_, D> {
    /// How far the interpolated values of cells may be from the source's [m].
    ///
    /// Over a part of a cell the source lies within `[−lower, upper]` of an affine function a, and the spline
    /// reproduces a. So the spline less the source is the spline of the samples less a, and the remainders; control
    /// values bound that spline.
    pub(crate) fn deviation<const K: usize>(
        &self,
        brick: [usize; D],
        samples: &[f64],
        near: Vec<Part<D>>,
    ) -> f64
    where
        OfTaps<K>: Spline<K>,
    {
        let Some(source) = self.source else { return 0.0 };
        let cell = self.lattice.cell;
        let mut largest = 0.0_f64;
        let mut work = (Block::<Model, D, BLOCK>::zero(), Column::zero());
        // Those with the largest bounds are halved first, so that others need not be.
        let mut waiting = BinaryHeap::new();
        let mut parts = near;
        loop {
            for parts in parts.chunks(BLOCK) {
                self.bounds::<K>((source, brick, samples), parts, &mut work, |part, bound| {
                    if part.level < DEEPEST {
                        waiting.push(Waiting { bound, part });
                    } else {
                        largest = largest.max(bound);
                    }
                });
            }
            parts = Vec::new();
            while parts.len() + (1 << D) <= BLOCK
                && let Some(Waiting { bound, part }) = waiting.pop()
            {
                if bound > largest.max(COARSE * cell) {
                    parts.extend(part.halves());
                } else {
                    largest = largest.max(bound);
                    waiting.clear();
                }
            }
            if parts.is_empty() {
                return largest * (1.0 + 1e-12);
            }
        }
    }

    /// Calls `found` with each part, at most a block of them, and the bound over it [m].
    fn bounds<const K: usize>(
        &self,
        (source, brick, samples): (&Shape<D>, [usize; D], &[f64]),
        parts: &[Part<D>],
        (boxes, models): &mut (Block<Model, D, BLOCK>, Column<Model, BLOCK>),
        mut found: impl FnMut(Part<D>, f64),
    ) where
        OfTaps<K>: Spline<K>,
    {
        boxes.fill_boxes(parts.len(), None, |i| {
            let part: &Part<D> = &parts[i];
            let (key, middle) = (part.key, part.middle());
            let along = |axis: usize| {
                (brick[axis] * BRICK + key[axis]) as f64 + 1.5 - 0.5 * K as f64 + middle[axis]
            };
            let centre = self.lattice.at(Vector(std::array::from_fn(along)));
            (centre, Vector([self.half(part.level); D]))
        });
        source.block_distances(boxes, parts.len(), models);
        for (i, part) in parts.iter().enumerate() {
            found(*part, self.bound::<K>(samples, part, &models.get(i)).min(self.worst));
        }
    }

    /// The same over a part, from the source's model.
    fn bound<const K: usize>(&self, samples: &[f64], part: &Part<D>, model: &Model) -> f64
    where
        OfTaps<K>: Spline<K>,
    {
        let mut taps = [0.0; MOST_TAPS];
        let taps = &mut taps[..K.pow(D as u32)];
        gather::<K, D>(samples, part.place, taps);
        let middle = part.middle();
        let largest = taps.iter().fold(model.value.abs(), |most, tap| tap.abs().max(most));
        let steps = self.lattice.cell / self.half(part.level);
        for (number, tap) in taps.iter_mut().enumerate() {
            let index: [usize; D] = unravelled(number, [K; D]);
            let along = |axis: usize| {
                let offset = index[axis] as f64 - 0.5 * (K - 1) as f64 - middle[axis];
                model.gradient[axis] * (offset * steps)
            };
            *tap -= model.value + (0..D).map(along).sum::<f64>();
        }
        for axis in 0..D {
            apply::<K, D>(taps, axis, &OfTaps::<K>::VALUES);
            for level in (0..part.level).rev() {
                let side = (part.number[axis] >> level) & 1;
                apply::<K, D>(taps, axis, &OfTaps::<K>::HALVES[side]);
            }
        }
        let above = taps.iter().copied().fold(f64::NEG_INFINITY, f64::max) + model.lower;
        let below = model.upper - taps.iter().copied().fold(f64::INFINITY, f64::min);
        above.max(below) + ROUNDED * f64::EPSILON * largest
    }

    /// Half the side of a part, with room for the rounding of its middle [m].
    fn half(&self, level: u32) -> f64 {
        let Lattice { origin, cell, counts } = self.lattice;
        let far = (0..D).map(|i| origin[i].abs() + counts[i] as f64 * cell).fold(0.0, f64::max);
        0.5 * cell / f64::from(1 << level) * (1.0 + 1e-12) + 8.0 * f64::EPSILON * far
    }
}
