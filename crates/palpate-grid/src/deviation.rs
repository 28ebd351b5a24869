// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How far interpolated values may be from the source's.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::atomic::{self, AtomicU64};

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Block, Column, Shape, Vector};

use crate::certificate::{Cells, Certificate};
use crate::control::{MOST_TAPS, apply, gather};
use crate::error::GridError;
use crate::lattice::{Lattice, indices, unravelled};
use crate::samples::{BRICK, Samples};
use crate::spline::{OfTaps, Spline};
use crate::threads::each;

/// Rounded operations on samples that a bound takes at most.
const ROUNDED: f64 = 64.0;

/// How often a cell is halved at most: at edges of a mesh, four halvings take a bound from 0.87 to 0.57 of a cell, two to
/// 0.82.
const DEEPEST: u32 = 4;

/// Bricks of which the threads take one after another, before the largest bound is looked at again.
const AT_ONCE: usize = 64;

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
    /// How far the values over it may be from the source's [m].
    bound: f64,
}

impl<const D: usize> Part<D> {
    pub(crate) fn whole(key: [usize; D], place: usize, bound: f64) -> Self {
        Self { key, place, level: 0, number: [0; D], bound }
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

/// Parts are in the order of their bounds.
impl<const D: usize> Ord for Part<D> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl<const D: usize> PartialOrd for Part<D> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<const D: usize> PartialEq for Part<D> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<const D: usize> Eq for Part<D> {}

/// A block of parts and their models.
type Work<const D: usize> = (Block<Model, D, BLOCK>, Column<Model, BLOCK>);

impl<const D: usize> Cells<'_, D> {
    /// How far the interpolated values of a brick may be from the source's [m], by the models over whole cells.
    ///
    /// Over a part of a cell the source lies within `[−lower, upper]` of an affine function a, and the spline
    /// reproduces a. So the spline less the source is the spline of the samples less a, and the remainders; control
    /// values bound that spline.
    pub(crate) fn deviation_of_whole_cells<const K: usize>(
        &self,
        brick: [usize; D],
        samples: &[f64],
    ) -> f64
    where
        OfTaps<K>: Spline<K>,
    {
        let Some(source) = self.source else { return 0.0 };
        let mut near = self.compared::<K>(brick, samples);
        let mut work = (Block::zero(), Column::zero());
        for parts in near.chunks_mut(BLOCK) {
            self.bound_parts::<K>((source, brick, samples), parts, &mut work);
        }
        near.iter().fold(0.0, |largest, part| part.bound.max(largest))
    }

    /// How far the interpolated values may be from the source's [m].
    ///
    /// Cells are halved where their bound is largest and more than [`enough`](Cells::enough), until none that can be
    /// halved has a larger bound than one that cannot. Bounds never grow when a cell is split, so the result does not
    /// depend on the order of splitting. `step` is called for each brick with such cells.
    pub(crate) fn deviation<const K: usize>(
        &self,
        samples: &Samples<D>,
        certificates: &[Certificate<D>],
        step: &(impl Fn() -> Result<(), GridError> + Sync),
    ) -> Result<f64, GridError>
    where
        OfTaps<K>: Spline<K>,
    {
        let Some(source) = self.source else { return Ok(0.0) };
        let bound = |number: usize| certificates[number].deviation;
        let mut order: Vec<usize> = (0..certificates.len()).collect();
        order.sort_by(|a, b| bound(*b).total_cmp(&bound(*a)));
        // The bits of numbers that are not negative are in the order of the numbers.
        let largest = AtomicU64::new(0);
        for numbers in order.chunks(AT_ONCE) {
            each(numbers.len(), |i| {
                let known = f64::from_bits(largest.load(atomic::Ordering::Relaxed));
                if bound(numbers[i]) <= known {
                    return Ok(());
                }
                step()?;
                let brick = unravelled(numbers[i], samples.bricks);
                let mut own = Vec::new();
                samples.brick(brick, self.lattice.counts, &mut own);
                let found = self.deviation_beyond::<K>((source, brick, &own), known);
                largest.fetch_max(found.to_bits(), atomic::Ordering::Relaxed);
                Ok(())
            })?;
        }
        Ok(f64::from_bits(largest.into_inner()))
    }

    /// The same in a brick, or what is known if that is larger.
    fn deviation_beyond<const K: usize>(
        &self,
        (source, brick, samples): (&Shape<D>, [usize; D], &[f64]),
        known: f64,
    ) -> f64
    where
        OfTaps<K>: Spline<K>,
    {
        let mut largest = known;
        let mut work = (Block::zero(), Column::zero());
        let mut waiting = BinaryHeap::new();
        let mut parts = self.compared::<K>(brick, samples);
        loop {
            for parts in parts.chunks_mut(BLOCK) {
                self.bound_parts::<K>((source, brick, samples), parts, &mut work);
            }
            for part in parts.drain(..) {
                if part.level < DEEPEST {
                    waiting.push(part);
                } else {
                    largest = largest.max(part.bound);
                }
            }
            while parts.len() + (1 << D) <= BLOCK
                && let Some(part) = waiting.pop()
            {
                if part.bound > largest.max(self.enough) {
                    parts.extend(part.halves());
                } else {
                    largest = largest.max(part.bound);
                    waiting.clear();
                }
            }
            if parts.is_empty() {
                return largest;
            }
        }
    }

    /// Gives each part, at most a block of them, its bound.
    fn bound_parts<const K: usize>(
        &self,
        (source, brick, samples): (&Shape<D>, [usize; D], &[f64]),
        parts: &mut [Part<D>],
        (boxes, models): &mut Work<D>,
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
        for (i, part) in parts.iter_mut().enumerate() {
            part.bound = part.bound.min(self.bound::<K>(samples, part, &models.get(i)));
        }
    }

    /// How far the values over a part may be from the source's [m], by the source's model.
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
        // The model is about the middle as it is rounded, the samples about the middle itself.
        let slopes: f64 = model.gradient.iter().map(|slope| slope.abs()).sum();
        let moved = slopes * (self.misplaced() / self.half(part.level));
        (above.max(below) + moved + ROUNDED * f64::EPSILON * largest) * (1.0 + 1e-12)
    }

    /// Half the side of a part, with room for the rounding of its middle [m].
    fn half(&self, level: u32) -> f64 {
        0.5 * self.lattice.cell / f64::from(1 << level) * (1.0 + 1e-12) + self.misplaced()
    }

    /// How far rounding may move the middle of a part [m].
    fn misplaced(&self) -> f64 {
        let Lattice { origin, cell, counts } = self.lattice;
        let far = (0..D).map(|i| origin[i].abs() + counts[i] as f64 * cell).fold(0.0, f64::max);
        8.0 * f64::EPSILON * far
    }
}
