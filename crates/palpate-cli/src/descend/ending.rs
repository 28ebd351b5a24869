// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where a search over an element ended, beside the proven minimum.

use palpate::field::{Point, Shape};
use palpate::local::Descent;
use palpate::query::Certified;
use serde::Serialize;

/// Values nearer than this share of the size of element and scene count as equal: the tolerance of the
/// proven bounds ten times.
const NEAR: f64 = 10.0 * super::TOLERANCE;

/// The end of a path.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct EndOfPath<const D: usize> {
    /// What the last point is.
    at: Place,
    /// The last point [m].
    point: Point<D>,
    /// The value there [m].
    value: f64,
    /// How far the value is above the least that is proven to be taken, at least zero [m].
    above_minimum: f64,
    /// The peak-to-peak amplitude of an oscillation at the end of the path [m].
    oscillation: Option<f64>,
}

/// What the last point of a path is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(test, derive(schemars::JsonSchema))]
enum Place {
    /// The minimum.
    Minimum,
    /// On the surface; the minimum lies inside.
    Surface,
    /// Neither.
    Elsewhere,
}

impl<const D: usize> EndOfPath<D> {
    /// The end of `found` over an element of this size [m].
    pub(super) fn of(
        shape: &Shape<D>,
        found: &Descent<D>,
        certified: &Certified<Point<D>>,
        size: f64,
    ) -> Self {
        let point = found.path.last().copied().unwrap_or(found.best);
        let value = shape.distance(point);
        let (near, above) = (NEAR * size, (value - certified.upper).max(0.0));
        let at = if above <= near {
            Place::Minimum
        } else if value.abs() <= near {
            // Lower values by more than that are inside.
            Place::Surface
        } else {
            Place::Elsewhere
        };
        Self { at, point, value, above_minimum: above, oscillation: found.oscillation() }
    }

    /// In words, with lengths as `length` writes them.
    pub(super) fn in_words(&self, length: impl Fn(f64) -> String) -> String {
        let above = length(self.above_minimum);
        let place = match self.at {
            Place::Minimum => "at the minimum".to_owned(),
            Place::Surface => {
                format!("at the surface, {above} above the minimum, which is inside")
            }
            Place::Elsewhere => format!("{above} above the minimum"),
        };
        match self.oscillation {
            Some(amplitude) => format!("{place}, oscillating by {}", length(amplitude)),
            None => place,
        }
    }
}
