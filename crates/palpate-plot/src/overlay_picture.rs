// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Draws paths, arrows and points over isolines.

use crate::dimension::DimensionLine;
use crate::drawing::{Drawing, Path, Stroke, TextPaint};
use crate::geometry::{Point, clip_line, clip_segment, distance, simplify};
use crate::labels::{Occupied, place_at_point};
use crate::legend::{Entry, Frame, Key, Symbol, TOLERANCE, draw_arrow};
use crate::overlay::{Arrows, Dash, Markers, Overlay, Polyline};
use crate::palette::Color;
use crate::scale::{round_down, write};
use crate::text::Text;

/// Longest arrow of a figure [px].
const LONGEST_ARROW: f64 = 78.0;
/// Length of arrows that show directions only [px].
const DIRECTION: f64 = 34.0;
/// Width of lines [px].
const LINE: f64 = 2.4;
/// Width of faint lines [px], and their opacity.
const FAINT: (f64, f64) = (1.1, 0.8);

/// The overlays of a picture, each with its colour, dash and symbol.
#[derive(Debug)]
pub(crate) struct Overlays<'a> {
    frame: Frame,
    lines: Vec<(&'a Polyline, Stroke)>,
    arrows: Vec<(&'a Arrows, Color)>,
    markers: Vec<(&'a Markers, Symbol, Color)>,
    dimensions: Vec<(&'a DimensionLine, Color)>,
    /// Legend, in the order in which the overlays were added; overlays of one name have one entry.
    pub(crate) entries: Vec<Entry>,
}

impl<'a> Overlays<'a> {
    pub(crate) fn new(frame: Frame, overlays: &'a [Overlay]) -> Self {
        let mut all = Self {
            frame,
            lines: Vec::new(),
            arrows: Vec::new(),
            markers: Vec::new(),
            dimensions: Vec::new(),
            entries: Vec::new(),
        };
        // Faint lines take no colour and no dash from the others.
        let (mut index, mut bold, mut symbols) = (0, 0, 0);
        for overlay in overlays {
            let next = Color::of_series(index);
            index += 1;
            match overlay {
                Overlay::Polyline(line) if line.is_faint => {
                    index -= 1;
                    let (width, opacity) = FAINT;
                    let dash = line.dash.unwrap_or(Dash::Solid).lengths(width);
                    let stroke = Stroke::new(line.color.unwrap_or(Color::MUTED), width)
                        .with_opacity(opacity)
                        .with_dash(dash);
                    all.explain(Entry::new(Key::Line(stroke.clone()), &*line.name));
                    all.lines.push((line, stroke));
                }
                Overlay::Polyline(line) => {
                    let dash = line.dash.unwrap_or(Dash::of_series(bold));
                    bold += 1;
                    let stroke = Stroke::new(line.color.unwrap_or(next), LINE)
                        .with_dash(dash.lengths(LINE));
                    all.explain(Entry::new(Key::Line(stroke.clone()), &*line.name));
                    all.lines.push((line, stroke));
                }
                Overlay::Arrows(arrows) => {
                    let color = arrows.color.unwrap_or(next);
                    all.explain(arrow_entry(arrows, color));
                    all.arrows.push((arrows, color));
                }
                Overlay::Markers(markers) => {
                    let symbol = if markers.is_small {
                        Symbol::Dot
                    } else {
                        symbols += 1;
                        Symbol::of_series(symbols - 1)
                    };
                    let color = markers.color.unwrap_or(next);
                    all.explain(Entry::new(Key::Point(symbol, color), &*markers.name));
                    all.markers.push((markers, symbol, color));
                }
                Overlay::Dimension(line) => {
                    let color = line.color.unwrap_or(next);
                    let key = Key::Line(DimensionLine::stroke(color));
                    all.explain(Entry::new(key, &*line.name));
                    all.dimensions.push((line, color));
                }
            }
        }
        all
    }

    /// Adds an entry to the legend, unless one says the same.
    fn explain(&mut self, entry: Entry) {
        if self.entries.iter().all(|known| known.text != entry.text) {
            self.entries.push(entry);
        }
    }

    /// Marks the room that the overlays cover as occupied.
    pub(crate) fn occupy(&self, occupied: &mut Occupied) {
        for (line, _) in self.lines.iter().filter(|(line, _)| !line.is_faint) {
            self.pieces(line).into_iter().for_each(|piece| occupied.add_line(piece));
        }
        for (arrows, _) in &self.arrows {
            self.ends(arrows).into_iter().for_each(|(a, b)| occupied.add_line(vec![a, b]));
        }
        for (markers, ..) in &self.markers {
            self.shown(markers).for_each(|(_, p)| occupied.add_disc(p, Symbol::RADIUS));
        }
        for (line, _) in &self.dimensions {
            line.occupy(&self.frame, occupied);
        }
    }

    /// Finds places for the labels of points and dimension lines.
    pub(crate) fn place_labels(&self, occupied: &mut Occupied) -> Vec<(Text<'a>, Color)> {
        let mut placed = Vec::new();
        for (markers, _, color) in &self.markers {
            for (index, p) in self.shown(markers) {
                if let Some(label) = markers.labels.get(index) {
                    let text = place_at_point(p, label, &self.frame.plot, occupied);
                    placed.extend(text.map(|text| (text, *color)));
                }
            }
        }
        for (line, color) in &self.dimensions {
            let text = line.place_label(&self.frame, occupied);
            placed.extend(text.map(|text| (text, *color)));
        }
        placed
    }

    /// Draws lines below arrows below points below labels.
    pub(crate) fn draw(&self, drawing: &mut Drawing, labels: &[(Text<'_>, Color)]) {
        let mut paths = Vec::new();
        for (line, stroke) in &self.lines {
            let mut path = Path::default();
            self.pieces(line).iter().for_each(|piece| path.add_line(piece));
            if line.is_faint {
                drawing.stroke(path, stroke.clone());
                continue;
            }
            let rim = Stroke::new(Color::WHITE, LINE + 2.4).with_opacity(0.8);
            drawing.stroke(path.clone(), rim);
            paths.push((path, stroke));
        }
        // Drawn over all rims, so that no rim cuts another line.
        for (path, stroke) in paths {
            drawing.stroke(path, stroke.clone());
        }
        for (arrows, color) in &self.arrows {
            for (tail, tip) in self.ends(arrows) {
                draw_arrow(drawing, tail, tip, *color);
            }
        }
        for (markers, symbol, color) in &self.markers {
            self.shown(markers).for_each(|(_, p)| symbol.draw(drawing, p, *color));
        }
        for (line, color) in &self.dimensions {
            line.draw(drawing, &self.frame, *color);
        }
        let halo = Some((Color::WHITE, 4.0));
        for (text, color) in labels {
            drawing.text(text, TextPaint { color: *color, halo });
        }
    }

    /// The parts of a line in the window [px].
    fn pieces(&self, line: &Polyline) -> Vec<Vec<Point>> {
        let seen = line.pieces.iter().flat_map(|piece| {
            let mut thinned: Vec<Point> = Vec::new();
            for p in self.frame.pixels(piece) {
                // Thousands of samples at one place become one point.
                if thinned.last().is_none_or(|&last| distance(last, p) > 5.0 * TOLERANCE) {
                    thinned.push(p);
                }
            }
            clip_line(&thinned, &self.frame.plot)
        });
        seen.map(|piece| simplify(&piece, TOLERANCE)).collect()
    }

    /// Tail and tip of each arrow that starts in the window, cut at its border [px].
    fn ends(&self, arrows: &Arrows) -> Vec<(Point, Point)> {
        let longest = arrows.longest();
        let ends = arrows.arrows.iter().filter_map(|arrow| {
            let tail = self.frame.pixel(arrow.tail);
            let length = arrow.vector[0].hypot(arrow.vector[1]);
            if !self.frame.plot.contains(tail) || length == 0.0 {
                return None;
            }
            let (unit, pixels) = match arrows.unit {
                Some(_) => (longest, LONGEST_ARROW),
                None => (length, DIRECTION),
            };
            let [right, up] = arrow.vector.map(|x| pixels * (x / unit));
            clip_segment(tail, [tail[0] + right, tail[1] - up], &self.frame.plot)
        });
        ends.collect()
    }

    /// Index and place [px] of each point in the window.
    fn shown(&self, markers: &'a Markers) -> impl Iterator<Item = (usize, Point)> {
        let points = markers.points.iter().map(|&p| self.frame.pixel(p)).enumerate();
        points.filter(|(_, p)| self.frame.plot.contains(*p))
    }
}

/// Arrows with a unit show a round length of it, to scale.
fn arrow_entry(arrows: &Arrows, color: Color) -> Entry {
    let longest = arrows.longest();
    match &arrows.unit {
        Some(unit) if longest > 0.0 => {
            let shown = round_down(0.75 * longest);
            let text = format!("{} (arrow: {} {unit})", arrows.name, write(shown, shown));
            Entry::new(Key::Arrow(color, LONGEST_ARROW * (shown / longest)), text)
        }
        _ => Entry::new(Key::Arrow(color, DIRECTION), &*arrows.name),
    }
}
