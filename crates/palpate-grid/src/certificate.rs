// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How far a grid is from its source, proven.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::atomic::{self, AtomicU64};

use palpate_field::scalar::Model;
use palpate_field::{BLOCK, Block, Column, Shape, Vector};

use crate::bake::{MOST_TAPS, apply, each, gather};
use crate::error::GridError;
use crate::grid::{Lattice, indices, raveled, unravelled};
use crate::samples::{BRICK, Samples, WIDE, strides};
use crate::slopes::{Range, SLOPE_BLOCK};
use crate::spline::{OfTaps, Spline};

/// Blocks of slopes along an axis of a brick.
const PARTS: usize = BRICK / SLOPE_BLOCK;

/// What holds over a brick's cells.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Certificate<const D: usize> {
    /// No gradient is longer.
    pub(crate) steepness: f64,
    /// No value within the band that was asked for differs more from the source's [m], as the models over whole cells
    /// tell; [`Cells::deviation`] tells better.
    pub(crate) deviation: f64,
    /// The ranges of differences of neighbours [m], along each axis, in each part of the brick.
    pub(crate) slopes: Vec<[Range; D]>,
    /// The first and the last of the brick's nodes that are not outside, along each axis.
    pub(crate) inside: Option<[[usize; 2]; D]>,
}

impl<const D: usize> Certificate<D> {
    /// The certificate of a brick without samples.
    pub(crate) fn far(brick: [usize; D], inside: bool) -> Self {
        let first = brick.map(|i| i * BRICK);
        Self {
            steepness: 0.0,
            deviation: 0.0,
            slopes: vec![[Range { least: 0.0, largest: 0.0 }; D]; PARTS.pow(D as u32)],
            inside: inside.then(|| first.map(|first| [first, first + BRICK - 1])),
        }
    }
}

/// The cells of a grid, and what is known of its source.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cells<'a, const D: usize> {
    pub(crate) lattice: &'a Lattice<D>,
    pub(crate) source: Option<&'a Shape<D>>,
    /// Values up to this size are compared with the source [m].
    pub(crate) within: f64,
    /// How far a sample may be from the source's value at a point whose value takes the sample [m].
    pub(crate) reach: f64,
    /// How far a sample may be from the source's value at its node [m].
    pub(crate) stored: f64,
    /// A bound of the deviation that holds whatever the samples are [m].
    pub(crate) worst: f64,
    /// No smaller deviation is looked for [m].
    pub(crate) enough: f64,
}

impl<'a, const D: usize> Cells<'a, D> {
    /// The cells of samples that stand for themselves.
    pub(crate) fn without_source(lattice: &'a Lattice<D>) -> Self {
        Self {
            lattice,
            source: None,
            within: 0.0,
            reach: 0.0,
            stored: 0.0,
            worst: 0.0,
            enough: 0.0,
        }
    }

    /// The certificate of a brick.
    pub(crate) fn of_brick<const K: usize>(
        &self,
        samples: &Samples<D>,
        brick: [usize; D],
    ) -> Certificate<D>
    where
        OfTaps<K>: Spline<K>,
    {
        if let Some(inside) = samples.far_brick(brick) {
            return Certificate::far(brick, inside);
        }
        let mut own = Vec::new();
        samples.brick(brick, self.lattice.counts, &mut own);
        self.certify::<K>(brick, &own)
    }

    /// The certificate of a brick, from the samples that its cells take.
    fn certify<const K: usize>(&self, brick: [usize; D], samples: &[f64]) -> Certificate<D>
    where
        OfTaps<K>: Spline<K>,
    {
        let mut steepness = 0.0_f64;
        self.each_cell::<K>(brick, samples, |_, _, taps| {
            steepness = steepness.max(steepest::<K, D>(taps, steepness));
        });
        Certificate {
            steepness: (steepness * (1.0 + 1e-12) + slack(samples)) / self.lattice.cell,
            deviation: self.deviation_of_whole_cells::<K>(brick, samples),
            slopes: slopes(samples),
            inside: self.inside(brick, samples),
        }
    }

    /// The cells of a brick whose values are compared with the source's.
    pub(crate) fn compared<const K: usize>(
        &self,
        brick: [usize; D],
        samples: &[f64],
    ) -> Vec<Part<D>> {
        let mut near = Vec::new();
        self.each_cell::<K>(brick, samples, |key, place, taps| {
            let none = [f64::INFINITY, f64::NEG_INFINITY];
            let [least, largest] = taps.iter().fold(none, |[least, largest], sample| {
                [least.min(*sample), largest.max(*sample)]
            });
            // Where the values and the source's are all beyond on one side, both are clamped alike.
            let [value, source] = [self.within, self.within + self.reach];
            let is_outside = least > value && largest > source;
            let is_inside = largest < -value && least < -source;
            if !is_outside && !is_inside {
                near.push(Part::whole(key, place, self.worst));
            }
        });
        near
    }

    /// Calls `visit` with each cell of a brick: its middle node in the brick, or the lower of two, the place of its
    /// first sample, and its samples.
    fn each_cell<const K: usize>(
        &self,
        brick: [usize; D],
        samples: &[f64],
        mut visit: impl FnMut([usize; D], usize, &[f64]),
    ) {
        let first = |axis: usize| (K - 2).saturating_sub(brick[axis] * BRICK);
        let end = |axis: usize| {
            (self.lattice.counts[axis] - 1).saturating_sub(brick[axis] * BRICK).min(BRICK)
        };
        let ways = strides([WIDE; D]);
        let mut taps = [0.0; MOST_TAPS];
        let taps = &mut taps[..K.pow(D as u32)];
        for key in indices::<D>(std::array::from_fn(first), std::array::from_fn(end)) {
            let place: usize = (0..D).map(|i| (key[i] + 3 - K) * ways[i]).sum();
            gather::<K, D>(samples, place, taps);
            visit(key, place, taps);
        }
    }

    /// The span of the brick's nodes that are not outside.
    fn inside(&self, brick: [usize; D], samples: &[f64]) -> Option<[[usize; 2]; D]> {
        let mut span: Option<[[usize; 2]; D]> = None;
        for own in indices([0; D], [BRICK; D]) {
            let node: [usize; D] = std::array::from_fn(|i| brick[i] * BRICK + own[i]);
            let exists = (0..D).all(|i| node[i] < self.lattice.counts[i]);
            if exists && samples[raveled(own.map(|i| i + 1), [WIDE; D])] <= 0.0 {
                let span = span.get_or_insert(node.map(|i| [i, i]));
                for i in 0..D {
                    span[i] = [span[i][0].min(node[i]), span[i][1].max(node[i])];
                }
            }
        }
        span
    }
}

/// The largest length of a cell's gradient, from one side of the cell to the other [m], at least where it is
/// more than `known`.
fn steepest<const K: usize, const D: usize>(taps: &[f64], known: f64) -> f64
where
    OfTaps<K>: Spline<K>,
{
    // No derivative is longer than the largest difference of neighbours along its axis.
    let mut bound = 0.0;
    for axis in 0..D {
        let way = K.pow(axis as u32);
        let mut largest = 0.0_f64;
        for line in 0..K.pow(D as u32 - 1) {
            let first = line % way + (line / way) * way * K;
            for tap in 1..K {
                largest = largest
                    .max((taps[first + tap * way] - taps[first + (tap - 1) * way]).abs());
            }
        }
        bound += largest * largest;
    }
    if bound <= known * known {
        return bound.sqrt();
    }
    let mut squares = [0.0; MOST_TAPS];
    for slope in 0..D {
        let mut control = [0.0; MOST_TAPS];
        let control = &mut control[..taps.len()];
        control.copy_from_slice(taps);
        for axis in 0..D {
            let shares =
                if axis == slope { &OfTaps::<K>::SLOPES } else { &OfTaps::<K>::VALUES };
            apply::<K, D>(control, axis, shares);
        }
        for (square, control) in squares.iter_mut().zip(control) {
            *square += *control * *control;
        }
    }
    squares.iter().copied().fold(0.0, f64::max).sqrt()
}

/// How far the difference of two samples may be off by their rounding [m]: each is a code times a scale.
fn slack(samples: &[f64]) -> f64 {
    4.0 * f64::EPSILON * samples.iter().fold(0.0, |largest, sample| sample.abs().max(largest))
}

/// The ranges of the differences from a brick's own nodes to their next, in each of its parts.
fn slopes<const D: usize>(samples: &[f64]) -> Vec<[Range; D]> {
    let slack = slack(samples);
    let ways = strides([WIDE; D]);
    indices([0; D], [PARTS; D])
        .map(|part| {
            let mut ranges = [Range::EMPTY; D];
            for node in indices([0; D], [SLOPE_BLOCK; D]) {
                let own: [usize; D] =
                    std::array::from_fn(|i| part[i] * SLOPE_BLOCK + node[i] + 1);
                let place = raveled(own, [WIDE; D]);
                for (range, way) in ranges.iter_mut().zip(ways) {
                    range.include(samples[place + way] - samples[place], slack);
                }
            }
            ranges
        })
        .collect()
}

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

/// Replaces the samples of a part's cell by the control values over the part.
fn control<const K: usize, const D: usize>(taps: &mut [f64], part: &Part<D>)
where
    OfTaps<K>: Spline<K>,
{
    for axis in 0..D {
        apply::<K, D>(taps, axis, &OfTaps::<K>::VALUES);
        for level in (0..part.level).rev() {
            let side = (part.number[axis] >> level) & 1;
            apply::<K, D>(taps, axis, &OfTaps::<K>::HALVES[side]);
        }
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
            // Samples alone bound most parts at edges of the source. Models take much longer and bound the rest.
            let wanted = largest.max(self.enough);
            for part in parts.iter_mut().filter(|part| part.level > 0) {
                part.bound = part.bound.min(self.bound_by_samples::<K>(source, samples, part));
            }
            parts.sort_by(|a, b| b.cmp(a));
            let open = parts.partition_point(|part| part.level == 0 || part.bound > wanted);
            for parts in parts[..open].chunks_mut(BLOCK) {
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

    /// How far the values over a part may be from the source's [m], by the samples and the steepness of the source alone:
    /// at the middle of the part, the source is within what each sample and the way to it allow.
    fn bound_by_samples<const K: usize>(
        &self,
        source: &Shape<D>,
        samples: &[f64],
        part: &Part<D>,
    ) -> f64
    where
        OfTaps<K>: Spline<K>,
    {
        let mut taps = [0.0; MOST_TAPS];
        let taps = &mut taps[..K.pow(D as u32)];
        gather::<K, D>(samples, part.place, taps);
        let (middle, lipschitz) = (part.middle(), source.promise().lipschitz);
        let [mut low, mut high] = [f64::NEG_INFINITY, f64::INFINITY];
        let mut size = 0.0_f64;
        for (number, tap) in taps.iter().enumerate() {
            let index: [usize; D] = unravelled(number, [K; D]);
            let away = |axis: usize| index[axis] as f64 - 0.5 * (K - 1) as f64 - middle[axis];
            let away: f64 = (0..D).map(|axis| away(axis) * away(axis)).sum();
            let apart = lipschitz * away.sqrt() * self.lattice.cell;
            (low, high) = (low.max(tap - apart), high.min(tap + apart));
            size = size.max(tap.abs() + apart);
        }
        control::<K, D>(taps, part);
        let above = taps.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low;
        let below = high - taps.iter().copied().fold(f64::INFINITY, f64::min);
        // From the middle to a corner of the part.
        let within = lipschitz * (D as f64).sqrt() * self.half(part.level);
        let within = within + 2.0 * source.promise().rounding.within(self.far());
        (above.max(below) + within + self.stored + ROUNDED * f64::EPSILON * size)
            * (1.0 + 1e-12)
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
        control::<K, D>(taps, part);
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

    /// No point of the lattice is farther from the origin [m].
    fn far(&self) -> f64 {
        let Lattice { origin, cell, counts } = self.lattice;
        (0..D).map(|i| origin[i].abs() + counts[i] as f64 * cell).sum()
    }

    /// How far rounding may move the middle of a part [m].
    fn misplaced(&self) -> f64 {
        8.0 * f64::EPSILON * self.far()
    }
}
