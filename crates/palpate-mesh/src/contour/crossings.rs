// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where the surface crosses the edges of cells.

use palpate_field::{Point, Shape, Vector};

use super::ContourError;

/// Steps towards a crossing at most: halvings alone would reach rounding.
const MOST_STEPS: usize = 60;

/// A crossing is found to this share of its edge.
const PRECISE: f64 = 1e-12;

/// A place where an edge crosses the surface, and the direction out of the shape there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub(super) place: Point<3>,
    pub(super) normal: Vector<f64, 3>,
}

impl Crossing {
    /// Between two points on different sides of the surface, by false position with halved weights (Illinois).
    pub(super) fn on(shape: &Shape<3>, ends: [Point<3>; 2]) -> Result<Self, ContourError> {
        let at = |share: f64| ends[0] + (ends[1] - ends[0]) * share;
        let ([mut low, mut high], [mut f, mut g]) =
            ([0.0, 1.0], ends.map(|end| shape.distance(end)));
        let mut place = 0.5;
        for _ in 0..MOST_STEPS {
            place = (low * g - high * f) / (g - f);
            // Flat fields, and such that end in rounding, are halved.
            if !(place > low && place < high) {
                place = 0.5 * (low + high);
            }
            let value = shape.distance(at(place));
            if value == 0.0 || high - low < PRECISE {
                break;
            }
            if (value < 0.0) == (g < 0.0) {
                (high, g) = (place, value);
                f *= 0.5;
            } else {
                (low, f) = (place, value);
                g *= 0.5;
            }
        }
        let place = at(place);
        let (_, gradient) = shape.distance_gradient(place);
        let along = (ends[1] - ends[0]) * if f < 0.0 { 1.0 } else { -1.0 };
        // Where the gradient vanishes, the edge tells the direction.
        let normal = gradient.normalized().or_else(|| along.normalized());
        if !place.is_finite() {
            return Err(ContourError::NotFinite { point: place.0 });
        }
        Ok(Self { place, normal: normal.unwrap_or(Vector([1.0, 0.0, 0.0])) })
    }
}
