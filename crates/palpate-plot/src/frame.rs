// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where the points of a window lie in a picture.

use crate::geometry::{Point, Rect};
use crate::view::View;

/// The largest error of a drawn line [px]: invisible, and straight lines keep every grey level
/// of a PNG.
pub(crate) const TOLERANCE: f64 = 0.02;

/// A window drawn into a rectangle of the same shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    view: View,
    /// [px].
    pub(crate) plot: Rect,
}

impl Frame {
    /// Draws `view` into `plot`.
    pub(crate) fn new(view: View, plot: Rect) -> Self {
        Self { view, plot }
    }

    /// Pixels per metre.
    pub(crate) fn scale(&self) -> f64 {
        self.plot.width() / self.view.width()
    }

    /// Where the plane coordinates `p` [m] lie [px].
    pub(crate) fn pixel(&self, p: Point) -> Point {
        let min = self.view.min();
        [
            self.plot.min[0] + (p[0] - min[0]) * self.scale(),
            self.plot.max[1] - (p[1] - min[1]) * self.scale(),
        ]
    }

    /// The plane coordinates [m] of a place [px].
    pub(crate) fn point(&self, pixel: Point) -> Point {
        let min = self.view.min();
        [
            min[0] + (pixel[0] - self.plot.min[0]) / self.scale(),
            min[1] + (self.plot.max[1] - pixel[1]) / self.scale(),
        ]
    }

    /// Where the points of a line [m] lie [px].
    pub(crate) fn pixels(&self, line: &[Point]) -> Vec<Point> {
        line.iter().map(|&p| self.pixel(p)).collect()
    }
}
