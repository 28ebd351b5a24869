// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Draws bands, isolines, their labels and the scale bar.

use crate::contours::rings;
use crate::drawing::{Drawing, Path, Stroke, TextPaint, TextStyle};
use crate::frame::{Frame, TOLERANCE};
use crate::geometry::{Point, Rect, clip_line, clip_ring, simplify};
use crate::labels::{self, Occupied};
use crate::levels::Levels;
use crate::numbers::{round_down, write, write_length};
use crate::outline::Outline;
use crate::palette::{self, Color, Side};
use crate::sampling::Samples;
use crate::text::Anchor;

/// Rings smaller than this are not drawn [px]: specks where a field just reaches a level. The
/// surface is always drawn.
const SPECK: f64 = 2.5;

/// Width of the line of the surface [px], and of the white rim with it.
const SURFACE: f64 = 2.8;
const CASING: f64 = 5.6;

/// Half the length of a line that is a point [px].
const DOT: f64 = 0.05;

/// The line of the surface.
pub(crate) fn surface_stroke() -> Stroke {
    Stroke::new(Color::INK, SURFACE)
}

/// The other isolines.
pub(crate) fn isoline_stroke(side: Side) -> Stroke {
    Stroke::new(side.line(), 0.9)
}

/// Sampled values, to be drawn into a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Picture<'a> {
    pub(crate) samples: &'a Samples,
    pub(crate) outline: &'a Outline,
    pub(crate) levels: &'a Levels,
    pub(crate) frame: Frame,
}

/// The isolines of a picture [px].
#[derive(Debug, Default)]
pub(crate) struct Lines {
    surface: Vec<Vec<Point>>,
    /// Rings around parts that belong to the surface as a whole.
    solids: Vec<Vec<Point>>,
    /// Level [m] and lines, ascending.
    rest: Vec<(f64, Vec<Vec<Point>>)>,
}

impl Lines {
    /// Marks the room that the surface covers as occupied.
    pub(crate) fn occupy(&self, occupied: &mut Occupied) {
        let surface = self.surface.iter().chain(&self.solids);
        surface.for_each(|line| occupied.add_line(line.clone()));
    }
}

impl Picture<'_> {
    /// Paints the lowest band everywhere, then each higher one over it, which leaves no seams.
    pub(crate) fn draw_bands(&self, drawing: &mut Drawing) {
        let step = self.levels.step;
        let lowest = match self.levels.values.first() {
            Some(first) => first - 0.5 * step,
            None => self.samples.range().0,
        };
        drawing.fill(Path::rect(&self.frame.plot), self.band(lowest));
        for &level in &self.levels.values {
            let rings = if level == 0.0 { self.outside() } else { self.rings(level) };
            let path = self.region(&rings);
            drawing.fill_rings(path, self.band(level + 0.5 * step));
        }
    }

    /// Finds the isolines.
    pub(crate) fn lines(&self) -> Lines {
        let lines = |rings: &[Vec<Point>]| -> Vec<Vec<Point>> {
            let pieces = rings.iter().flat_map(|ring| clip_line(ring, &self.frame.plot));
            let simple = pieces.map(|line| simplify(&line, TOLERANCE));
            simple.filter(|line| line.len() > 1).collect()
        };
        let levels = self.levels.values.iter().filter(|level| **level != 0.0);
        let Outline { lines: surface, solids, .. } = self.outline;
        Lines {
            surface: lines(&self.pixels(surface)).into_iter().map(visible).collect(),
            solids: self.pixels(solids),
            rest: levels.map(|&level| (level, lines(&self.rings(level)))).collect(),
        }
    }

    /// Draws the isolines, the surface over the others.
    pub(crate) fn draw_lines(&self, drawing: &mut Drawing, lines: &Lines) {
        for (level, lines) in &lines.rest {
            drawing.stroke(path_of(lines), isoline_stroke(side_of(*level)));
        }
        drawing.stroke(path_of(&lines.surface), surface_stroke());
        drawing.fill_rings(self.region(&lines.solids), Color::INK);
    }

    /// Draws the labels of the isolines where there is room.
    pub(crate) fn draw_labels(
        &self,
        drawing: &mut Drawing,
        lines: &Lines,
        occupied: &mut Occupied,
    ) {
        // From the surface outwards on each side, so that labels line up.
        let (inside, outside): (Vec<_>, Vec<_>) =
            lines.rest.iter().partition(|(level, _)| *level < 0.0);
        for side in [outside, inside.into_iter().rev().collect()] {
            let mut neighbours = Vec::new();
            for (level, lines) in side {
                let label = write(*level, self.levels.step);
                let plot = &self.frame.plot;
                let spots = labels::place_on_lines(lines, &label, plot, &neighbours, occupied);
                for spot in &spots {
                    let text = spot.text(&label);
                    let (around, width) = (self.around(*level), 4.5);
                    // Covers the line, which would show between letters and above a decimal
                    // point.
                    drawing.stroke(text.middle(), Stroke::new(around, width));
                    let color = side_of(*level).label();
                    drawing.text(&text, TextPaint { color, halo: Some((around, width)) });
                }
                if !spots.is_empty() {
                    neighbours = spots;
                }
            }
        }
    }

    /// Draws a white rim under the surface, which sets it off from dark colours.
    pub(crate) fn draw_casing(&self, drawing: &mut Drawing, lines: &Lines) {
        drawing.stroke(path_of(&lines.surface), Stroke::new(Color::WHITE, CASING));
        drawing.stroke(self.region(&lines.solids), Stroke::new(Color::WHITE, CASING - SURFACE));
    }

    /// Draws the scale bar at the right of the row of the axis name whose baseline is `y`, or
    /// below it if the plot is narrow. Returns the extra height.
    pub(crate) fn draw_scale_bar(&self, drawing: &mut Drawing, y: f64) -> f64 {
        let Rect { min, max } = self.frame.plot;
        let length = round_down(0.22 * self.frame.plot.width() / self.frame.scale());
        let style = TextStyle::AXIS;
        let text = write_length(length);
        let (left, right) = (max[0] - length * self.frame.scale(), max[0]);
        let has_room = left - style.width(&text) - 60.0 > (min[0] + max[0]) / 2.0;
        let extra = if has_room { 0.0 } else { 22.0 };
        let base = y + extra - 0.5;
        drawing.label(&text, [left - 8.0, base + 0.5], Anchor::End, style);
        let bar = [[left, base - 7.0], [left, base], [right, base], [right, base - 7.0]];
        drawing.stroke(Path::line(&bar), Stroke::new(Color::INK, 1.8));
        extra
    }

    /// Rings around the samples at or above `level` [m], which is not the surface, in pixels.
    fn rings(&self, level: f64) -> Vec<Vec<Point>> {
        let mut rings = self.pixels(&rings(self.samples, level));
        rings.retain(|ring| extent(ring) > SPECK);
        rings
    }

    /// Rings around the outside: around the inside, and around the plot.
    fn outside(&self) -> Vec<Vec<Point>> {
        let mut rings = self.pixels(&self.outline.rings);
        rings.push(self.frame.plot.corners().to_vec());
        rings
    }

    fn pixels(&self, lines: &[Vec<Point>]) -> Vec<Vec<Point>> {
        lines.iter().map(|line| self.frame.pixels(line)).collect()
    }

    /// The part of the plot within `rings` [px].
    fn region(&self, rings: &[Vec<Point>]) -> Path {
        let mut path = Path::default();
        for ring in rings {
            let ring = simplify(&clip_ring(ring, &self.frame.plot), TOLERANCE);
            if ring.len() > 2 {
                path.add_ring(&ring);
            }
        }
        path
    }

    /// Colour of the band that holds `value` [m].
    fn band(&self, value: f64) -> Color {
        let (inside, outside) = self.levels.bands();
        let index = (value.abs() / self.levels.step) as usize;
        match side_of(value) {
            Side::Inside => palette::band(Side::Inside, index.min(inside - 1), inside),
            Side::Outside => palette::band(Side::Outside, index.min(outside - 1), outside),
        }
    }

    /// The colour between the two bands that meet at `level` [m].
    fn around(&self, level: f64) -> Color {
        let half = 0.5 * self.levels.step;
        self.band(level - half).mix(self.band(level + half), 0.5)
    }
}

fn side_of(value: f64) -> Side {
    if value < 0.0 { Side::Inside } else { Side::Outside }
}

/// A line that is a point, as one with ends that differ: writers leave out lines without length.
fn visible(line: Vec<Point>) -> Vec<Point> {
    match line[..] {
        [[x, y], end] if [x, y] == end => vec![[x - DOT, y], [x + DOT, y]],
        _ => line,
    }
}

fn path_of(lines: &[Vec<Point>]) -> Path {
    let mut path = Path::default();
    lines.iter().for_each(|line| path.add_line(line));
    path
}

/// The longer side of the box around `points`.
fn extent(points: &[Point]) -> f64 {
    let span = |i: usize| {
        let (low, high) = points
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p[i]), h.max(p[i])));
        high - low
    };
    span(0).max(span(1))
}
