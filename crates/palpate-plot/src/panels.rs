// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Small charts beside each other, with shared axes.

use crate::chart::{Axis, BELOW, Chart, axis_of};
use crate::drawing::{Drawing, TextPaint, TextStyle};
use crate::geometry::{Point, Rect};
use crate::legend::{self, Entry, Key};
use crate::palette::Color;
use crate::text::{Anchor, Text, Weight, shorten};

/// Panels in a row.
const COLUMNS: usize = 2;
/// Height of a panel, and the room between panels, across and up [px]: titles stand there.
const HEIGHT: f64 = 84.0;
const BETWEEN: [f64; 2] = [18.0, 24.0];
/// The desired distance of ticks, across and up [px].
const TICK_SPACING: [f64; 2] = [95.0, 40.0];
/// From a title to its panel [px].
const BELOW_TITLE: f64 = 6.0;

/// Charts of one quantity each, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Panels {
    charts: Vec<Chart>,
}

impl Panels {
    pub(crate) fn new(charts: Vec<Chart>) -> Self {
        Self { charts }
    }

    /// The axes that all panels share, for panels of this width [px].
    fn axes(&self, width: f64) -> [Axis; 2] {
        let charts: Vec<&Chart> = self.charts.iter().collect();
        [(0, width), (1, HEIGHT)]
            .map(|(index, length)| axis_of(&charts, index, length, TICK_SPACING[index]))
    }

    /// Room for the left axis [px].
    pub(crate) fn gutter(&self) -> f64 {
        self.axes(HEIGHT)[1].gutter()
    }

    /// Draws the panels into `area` from its top, the first `gutter` right of its left edge.
    /// Returns the height used. All [px].
    pub(crate) fn draw(&self, drawing: &mut Drawing, area: &Rect, gutter: f64) -> f64 {
        let columns = COLUMNS.min(self.charts.len());
        if columns == 0 {
            return 0.0;
        }
        let gaps = (columns - 1) as f64 * BETWEEN[0];
        let width = (area.width() - gutter - gaps) / columns as f64;
        let [x, y] = self.axes(width);
        let rows = self.charts.len().div_ceil(columns);
        let top = area.min[1] + BETWEEN[1];
        let mut entries: Vec<Entry> = Vec::new();
        for (number, chart) in self.charts.iter().enumerate() {
            let (column, row) = (number % columns, number / columns);
            let plot = Rect::new(
                area.min[0] + gutter + column as f64 * (width + BETWEEN[0]),
                top + row as f64 * (HEIGHT + BETWEEN[1]),
                width,
                HEIGHT,
            );
            let explained = chart.draw_lines(drawing, &plot, &[&x, &y]);
            explained.into_iter().for_each(|entry| merge(&mut entries, entry));
            draw_title(drawing, &plot, chart.title());
            if column == 0 {
                // The name stands once, in the middle.
                let name = if row == rows / 2 { &y.name } else { "" };
                y.named(name).draw_left(drawing, &plot, area.min[0]);
            }
            if number + columns >= self.charts.len() {
                x.draw_below(drawing, &plot);
            }
        }
        let bottom = top + rows as f64 * (HEIGHT + BETWEEN[1]) - BETWEEN[1] + BELOW;
        let origin: Point = [area.min[0] + gutter, bottom + 10.0];
        let height = legend::draw(drawing, &entries, origin, area.max[0] - origin[0]);
        origin[1] + height - area.min[1]
    }
}

/// Adds what is not there yet. A line that has another colour in each panel is explained in ink.
fn merge(entries: &mut Vec<Entry>, entry: Entry) {
    match entries.iter_mut().find(|known| known.text == entry.text) {
        None => entries.push(entry),
        Some(known) if *known != entry => {
            if let Key::Line(stroke) = &mut known.key {
                stroke.color = Color::INK;
            }
        }
        Some(_) => {}
    }
}

/// Writes a title above a panel.
fn draw_title(drawing: &mut Drawing, plot: &Rect, title: &str) {
    let TextStyle { size, color, .. } = TextStyle::TICK;
    let weight = Weight::SemiBold;
    let title = shorten(title, size, weight, plot.width());
    let at = [plot.min[0], plot.min[1] - BELOW_TITLE];
    let text = Text { text: &title, at, size, weight, anchor: Anchor::Start, angle: 0.0 };
    drawing.text(&text, TextPaint { color, halo: None });
}
