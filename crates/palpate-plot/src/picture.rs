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
use crate::palette::{self, Color, Side};
use crate::sampling::Samples;
use crate::text::Anchor;

/// Rings smaller than this are not drawn [px]: specks where a field just reaches a level. The
/// surface is always drawn.
const SPECK: f64 = 2.5;

/// Width of the line of the surface [px], and of the white rim with it.
const SURFACE: f64 = 2.8;
const CASING: f64 = 5.6;

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
    pub(crate) levels: &'a Levels,
    pub(crate) frame: Frame,
}

/// The isolines of a picture [px].
#[derive(Debug, Default)]
pub(crate) struct Lines {
    surface: Vec<Vec<Point>>,
    /// Rings around a surface without interior.
    thin: Vec<Vec<Point>>,
    /// Level [m] and lines, ascending.
    rest: Vec<(f64, Vec<Vec<Point>>)>,
}

impl Lines {
    /// Marks the room that the surface covers as occupied.
    pub(crate) fn occupy(&self, occupied: &mut Occupied) {
        let surface = self.surface.iter().chain(&self.thin);
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
            let mut path = Path::default();
            for ring in self.rings(self.samples, level) {
                let ring = simplify(&clip_ring(&ring, &self.frame.plot), TOLERANCE);
                if ring.len() > 2 {
                    path.add_ring(&ring);
                }
            }
            drawing.fill_rings(path, self.band(level + 0.5 * step));
        }
    }

    /// Finds the isolines.
    pub(crate) fn lines(&self) -> Lines {
        let mut lines = Lines { thin: self.thin_surface(), ..Lines::default() };
        for &level in &self.levels.values {
            let found = self.rings(self.samples, level);
            let found = found
                .iter()
                .flat_map(|ring| clip_line(ring, &self.frame.plot))
                .map(|line| simplify(&line, TOLERANCE))
                .filter(|line| line.len() > 1);
            if level == 0.0 {
                lines.surface = found.collect();
            } else {
                lines.rest.push((level, found.collect()));
            }
        }
        lines
    }

    /// Draws the isolines, the surface over the others.
    pub(crate) fn draw_lines(&self, drawing: &mut Drawing, lines: &Lines) {
        for (level, lines) in &lines.rest {
            drawing.stroke(path_of(lines), isoline_stroke(side_of(*level)));
        }
        drawing.stroke(path_of(&lines.surface), surface_stroke());
        let mut thin = Path::default();
        lines.thin.iter().for_each(|ring| thin.add_ring(ring));
        drawing.fill_rings(thin, Color::INK);
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
        drawing.stroke(path_of(&lines.thin), Stroke::new(Color::WHITE, CASING - SURFACE));
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

    /// Rings around the samples at or above `level` [m], in pixels.
    fn rings(&self, samples: &Samples, level: f64) -> Vec<Vec<Point>> {
        let mut rings = rings(samples, level);
        rings.iter_mut().for_each(|ring| *ring = self.frame.pixels(ring));
        if level != 0.0 {
            rings.retain(|ring| extent(ring) > SPECK);
        }
        rings
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

    /// Rings around the points within a cell of a surface without interior; empty for other
    /// fields.
    fn thin_surface(&self) -> Vec<Vec<Point>> {
        if !self.samples.has_thin_surface() {
            return Vec::new();
        }
        let mut negated = self.samples.clone();
        negated.values.iter_mut().for_each(|value| *value = -*value);
        let rings = self.rings(&negated, -negated.cell);
        rings
            .iter()
            .map(|ring| simplify(&clip_ring(ring, &self.frame.plot), TOLERANCE))
            .filter(|ring| ring.len() > 2)
            .collect()
    }
}

fn side_of(value: f64) -> Side {
    if value < 0.0 { Side::Inside } else { Side::Outside }
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
