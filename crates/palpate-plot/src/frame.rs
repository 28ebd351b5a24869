// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where the points of a window lie in a picture.

use crate::drawing::Path;
use crate::geometry::{Point, Rect, clip_line, clip_ring, simplify};
use crate::view::PlaneView;

/// The largest error of a drawn line [px]: invisible, and straight lines keep every grey level
/// of a PNG.
pub(crate) const TOLERANCE: f64 = 0.02;

/// Half the length of a line that is a point [px].
const DOT: f64 = 0.05;

/// A window drawn into a rectangle of the same shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    view: PlaneView,
    /// [px].
    pub(crate) plot: Rect,
}

impl Frame {
    /// Draws `view` into `plot`.
    pub(crate) fn new(view: PlaneView, plot: Rect) -> Self {
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

    /// Where the points of a line [m] lie [px].
    pub(crate) fn pixels(&self, line: &[Point]) -> Vec<Point> {
        line.iter().map(|&p| self.pixel(p)).collect()
    }

    /// The rectangle that the plot shows [m].
    pub(crate) fn window(&self) -> Rect {
        Rect { min: self.view.min(), max: self.view.max() }
    }

    /// Where a rectangle [m] lies [px].
    pub(crate) fn rect(&self, rect: &Rect) -> Rect {
        let [low, high] = [rect.min, rect.max].map(|p| self.pixel(p));
        Rect { min: [low[0], high[1]], max: [high[0], low[1]] }
    }

    /// The parts of `lines` [px] in the plot.
    pub(crate) fn shown(&self, lines: &[Vec<Point>]) -> Vec<Vec<Point>> {
        let pieces = lines.iter().flat_map(|line| clip_line(line, &self.plot));
        let simple = pieces.map(|line| simplify(&line, TOLERANCE));
        simple.filter(|line| line.len() > 1).map(visible).collect()
    }

    /// The part of the plot within `rings` [px].
    pub(crate) fn region(&self, rings: &[Vec<Point>]) -> Path {
        let mut path = Path::default();
        for ring in rings {
            let ring = simplify(&clip_ring(ring, &self.plot), TOLERANCE);
            if ring.len() > 2 {
                path.add_ring(&ring);
            }
        }
        path
    }
}

/// A line that is a point, as one with ends that differ: writers leave out lines without length.
fn visible(line: Vec<Point>) -> Vec<Point> {
    match line[..] {
        [[x, y], end] if [x, y] == end => vec![[x - DOT, y], [x + DOT, y]],
        _ => line,
    }
}
