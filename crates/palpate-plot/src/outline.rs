// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The surface of a field in a window.

use crate::contours::rings;
use crate::geometry::{Point, Rect, clip_ring};
use crate::slice::Samples;

/// The surface of a field in a window, as lines in plane coordinates.
///
/// [`follow`](Self::follow) finds the surface of a field that bounds its values;
/// [`Isolines::sample`](crate::Isolines::sample) finds that of any field as far as its samples
/// show it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SurfaceLines {
    /// Closed lines around the inside, which the even-odd rule fills. They run along the edge of
    /// what was searched, which lies outside the window [m].
    pub(crate) rings: Vec<Vec<Point>>,
    /// The lines of the surface [m]; a point is a line to itself.
    pub(crate) lines: Vec<Vec<Point>>,
    /// Rings around parts that belong to the surface as a whole [m].
    pub(crate) solids: Vec<Vec<Point>>,
}

impl SurfaceLines {
    /// The zero isolines of `samples`. Where the field is nowhere negative, the points within a
    /// cell of zero belong to the surface.
    pub(crate) fn of_samples(samples: &Samples) -> Self {
        let lines = rings(samples, 0.0);
        let negated = samples.negated();
        let is_thin = samples.has_thin_surface();
        let solids = if is_thin { rings(&negated, -negated.cell) } else { Vec::new() };
        Self { rings: rings(&negated, 0.0), lines, solids }
    }

    /// The lines of the surface, in plane coordinates \[m\]; the first and the last point of a
    /// closed line are the same, and a single point is there twice.
    #[must_use]
    pub fn lines(&self) -> &[Vec<[f64; 2]>] {
        &self.lines
    }

    /// Closed lines around the parts that belong to the surface as a whole, in plane coordinates
    /// \[m\].
    #[must_use]
    pub fn solids(&self) -> &[Vec<[f64; 2]>] {
        &self.solids
    }

    /// The box around the surface within `window` [m]; `None` if there is none.
    pub(crate) fn bounds(&self, window: &Rect) -> Option<Rect> {
        let seen = self.lines.iter().flatten().copied().filter(|p| window.contains(*p));
        let solids = self.solids.iter().flat_map(|ring| clip_ring(ring, window));
        seen.chain(solids).map(|p| Rect { min: p, max: p }).reduce(|a, b| a.union(&b))
    }
}
