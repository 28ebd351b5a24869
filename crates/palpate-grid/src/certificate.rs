// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What holds over the cells of a brick: steepness, deviation from the source, ranges of slopes.

use palpate_field::Shape;

use crate::control::{MOST_TAPS, apply, gather};
use crate::deviation::Part;
use crate::lattice::{Lattice, indices, raveled};
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
    /// A bound of the deviation that holds whatever the samples are [m].
    pub(crate) worst: f64,
    /// No smaller deviation is looked for [m].
    pub(crate) enough: f64,
}

impl<'a, const D: usize> Cells<'a, D> {
    /// The cells of samples that stand for themselves.
    pub(crate) fn without_source(lattice: &'a Lattice<D>) -> Self {
        Self { lattice, source: None, within: 0.0, reach: 0.0, worst: 0.0, enough: 0.0 }
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
