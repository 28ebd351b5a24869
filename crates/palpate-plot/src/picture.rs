// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Draws bands, isolines, their labels and the scale bar.

use crate::body_picture::Bodies;
use crate::contours::rings;
use crate::drawing::{Drawing, Path, Stroke, TextPaint, TextStyle};
use crate::geometry::{Point, Rect};
use crate::labels::{self, Occupied};
use crate::legend::Frame;
use crate::outline::SurfaceLines;
use crate::palette::{self, Color, Side};
use crate::scale::{Levels, round_down, write, write_length};
use crate::slice::Samples;
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
    pub(crate) outline: &'a SurfaceLines,
    /// The colours of the inside.
    pub(crate) inside: Side,
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
    /// Paints the bands outside over one another from the surface on, and over them those inside
    /// `insides`, rings around the inside of each body [px]; that leaves no seams.
    pub(crate) fn draw_bands(&self, drawing: &mut Drawing, insides: &[Vec<Vec<Point>>]) {
        let half = 0.5 * self.levels.step;
        let (low, high) = self.samples.range();
        let (inside, outside): (Vec<f64>, Vec<f64>) =
            self.levels.values.iter().filter(|level| **level != 0.0).partition(|l| **l < 0.0);
        // Where the picture shows one side only, its bands begin far from the surface.
        let first = |levels: Option<&f64>, end: f64| levels.map_or(end, |level| *level);
        let nearest = if low > 0.0 { first(outside.first(), low + half) - half } else { half };
        drawing.fill(Path::rect(&self.frame.plot), self.band(nearest));
        for level in outside {
            let path = self.frame.region(&self.rings(self.samples, level));
            drawing.fill_rings(path, self.band(level + half), 1.0);
        }
        let nearest = if high < 0.0 { first(inside.last(), high - half) + half } else { -half };
        for rings in insides {
            drawing.fill_rings(self.frame.region(rings), self.band(nearest), 1.0);
        }
        let negated = self.samples.negated();
        for level in inside.into_iter().rev() {
            let path = self.frame.region(&self.rings(&negated, -level));
            drawing.fill_rings(path, self.band(level - half), 1.0);
        }
    }

    /// Finds the isolines.
    pub(crate) fn lines(&self) -> Lines {
        let levels = self.levels.values.iter().filter(|level| **level != 0.0);
        let SurfaceLines { lines, solids, .. } = self.outline;
        Lines {
            surface: self.frame.shown(&self.pixels(lines)),
            solids: self.pixels(solids),
            rest: levels
                .map(|&level| (level, self.frame.shown(&self.rings(self.samples, level))))
                .collect(),
        }
    }

    /// Draws the isolines without the surface.
    pub(crate) fn draw_lines(&self, drawing: &mut Drawing, lines: &Lines) {
        for (level, lines) in &lines.rest {
            drawing.stroke(Path::lines(lines), isoline_stroke(self.side(*level)));
        }
    }

    /// Draws the surface.
    pub(crate) fn draw_surface(&self, drawing: &mut Drawing, lines: &Lines) {
        drawing.stroke(Path::lines(&lines.surface), surface_stroke());
        drawing.fill_rings(self.frame.region(&lines.solids), Color::INK, 1.0);
    }

    /// Draws the labels of the isolines where there is room.
    pub(crate) fn draw_labels(
        &self,
        drawing: &mut Drawing,
        lines: &Lines,
        bodies: &Bodies<'_>,
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
                    let (around, width) = (bodies.tinted(self.around(*level), spot.at), 4.5);
                    // Covers the line, which would show between letters and above a decimal
                    // point.
                    drawing.stroke(text.middle(), Stroke::new(around, width));
                    let color = self.side(*level).label();
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
        drawing.stroke(Path::lines(&lines.surface), Stroke::new(Color::WHITE, CASING));
        drawing.stroke(
            self.frame.region(&lines.solids),
            Stroke::new(Color::WHITE, CASING - SURFACE),
        );
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

    /// Rings around the `samples` at or above `level` [m], which is not the surface, in pixels.
    fn rings(&self, samples: &Samples, level: f64) -> Vec<Vec<Point>> {
        let mut rings = self.pixels(&rings(samples, level));
        rings.retain(|ring| extent(ring) > SPECK);
        rings
    }

    fn pixels(&self, lines: &[Vec<Point>]) -> Vec<Vec<Point>> {
        lines.iter().map(|line| self.frame.pixels(line)).collect()
    }

    /// Colour of the band that holds `value` [m].
    fn band(&self, value: f64) -> Color {
        let (inside, outside) = self.levels.bands();
        let index = (value.abs() / self.levels.step) as usize;
        let count = if value < 0.0 { inside } else { outside };
        palette::band(self.side(value), index.min(count - 1), count)
    }

    fn side(&self, value: f64) -> Side {
        if value < 0.0 { self.inside } else { Side::Outside }
    }

    /// The colour between the two bands that meet at `level` [m].
    fn around(&self, level: f64) -> Color {
        let half = 0.5 * self.levels.step;
        self.band(level - half).mix(self.band(level + half), 0.5)
    }
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
