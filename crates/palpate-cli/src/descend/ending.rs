// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where a search over an element ended, beside the proven minimum.

use palpate::field::{Point, Shape};
use palpate::local::Descent;
use palpate::query::Certified;
use serde_json::{Value, json};

/// Values nearer than this share of the size of element and scene count as equal: the tolerance of the
/// proven bounds ten times.
const NEAR: f64 = 10.0 * super::TOLERANCE;

/// The end of a path.
#[derive(Debug)]
pub(super) struct Ending<const D: usize> {
    /// The last point [m].
    point: Point<D>,
    /// The value there [m].
    value: f64,
    /// How far the value is above the least that is proven to be taken, at least zero [m].
    above: f64,
    kind: Kind,
    /// The amplitude of an oscillation [m].
    oscillation: Option<f64>,
}

/// What the last point is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Minimum,
    /// The minimum lies inside.
    Surface,
    Elsewhere,
}

impl<const D: usize> Ending<D> {
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
        let kind = if above <= near {
            Kind::Minimum
        } else if value.abs() <= near {
            // Lower values by more than that are inside.
            Kind::Surface
        } else {
            Kind::Elsewhere
        };
        Self { point, value, above, kind, oscillation: found.oscillation() }
    }

    /// As JSON.
    pub(super) fn described(&self) -> Value {
        let kind = match self.kind {
            Kind::Minimum => "minimum",
            Kind::Surface => "surface",
            Kind::Elsewhere => "elsewhere",
        };
        json!({
            "at": kind,
            "point_m": self.point.0.to_vec(),
            "value_m": self.value,
            "above_minimum_m": self.above,
            "oscillation_m": self.oscillation,
        })
    }

    /// In words, with lengths as `length` writes them.
    pub(super) fn in_words(&self, length: impl Fn(f64) -> String) -> String {
        let above = length(self.above);
        let place = match self.kind {
            Kind::Minimum => "at the minimum".to_owned(),
            Kind::Surface => {
                format!("at the surface, {above} above the minimum, which is inside")
            }
            Kind::Elsewhere => format!("{above} above the minimum"),
        };
        match self.oscillation {
            Some(amplitude) => format!("{place}, oscillating by {}", length(amplitude)),
            None => place,
        }
    }
}
