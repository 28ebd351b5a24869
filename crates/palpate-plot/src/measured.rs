// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The extremes of what the colours of a picture show.

use crate::geometry::Point;

/// The extremes of the numbers that the colours of a picture show, with their places in plane
/// coordinates \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The smallest number; of ratios, that of the loosest value.
    pub smallest: f64,
    /// The first place where it was found.
    pub smallest_at: [f64; 2],
    /// The largest number; of ratios, above one where values are too steep.
    pub largest: f64,
    /// The first place where it was found.
    pub largest_at: [f64; 2],
    /// The share of the picture without a number: of ratios, where the bounds of the distance
    /// leave them open.
    pub open: f64,
}

impl Measured {
    /// The extremes of the numbers at some places; `None` if there is no number.
    pub(crate) fn of(
        numbers: impl ExactSizeIterator<Item = (Point, Option<f64>)>,
    ) -> Option<Self> {
        let count = numbers.len();
        let known: Vec<_> = numbers.filter_map(|(at, x)| Some((at, x?))).collect();
        let smallest = known.iter().copied().reduce(|a, b| if b.1 < a.1 { b } else { a })?;
        let largest = known.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a })?;
        Some(Self {
            smallest: smallest.1,
            smallest_at: smallest.0,
            largest: largest.1,
            largest_at: largest.0,
            open: 1.0 - known.len() as f64 / count as f64,
        })
    }
}
