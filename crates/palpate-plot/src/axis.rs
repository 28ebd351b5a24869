// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Axes: chooses ticks, and draws axes around a plot.

use crate::drawing::{Drawing, Path, Stroke, TextPaint, TextStyle};
use crate::geometry::Rect;
use crate::numbers::{multiples, round_up, write};
use crate::palette::Color;
use crate::text::{Anchor, CAP_HEIGHT, Text, Weight};

/// Length of a tick [px].
const TICK: f64 = 4.0;
/// The least distance of labels from the edge of the picture [px]; closer ones are left out.
const EDGE: f64 = 4.0;
/// Space between tick, label and axis name [px].
const GAP: f64 = 6.0;
/// Height below a plot taken by ticks, tick labels and the axis name [px].
pub(crate) const BELOW: f64 = TICK + GAP + 12.0 + 6.0 + 13.0;

/// An axis of a plot: a range of numbers along one side of a rectangle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Axis {
    pub(crate) name: String,
    /// Number at the left or lower end.
    pub(crate) start: f64,
    /// Number at the right or upper end; below `start` if the axis runs backwards.
    pub(crate) end: f64,
    step: f64,
    /// Ticks, within the range.
    pub(crate) ticks: Vec<f64>,
}

impl Axis {
    /// An axis with round ticks about `spacing` apart on a side of `length`, both [px].
    pub(crate) fn new(name: &str, [start, end]: [f64; 2], length: f64, spacing: f64) -> Self {
        let (low, high) = (start.min(end), start.max(end));
        let step = round_up((high - low) / (length / spacing).max(1.5));
        let ticks = multiples(low, high, step, 100);
        Self { name: name.to_owned(), start, end, step, ticks }
    }

    /// The same axis with another name.
    pub(crate) fn named(&self, name: &str) -> Self {
        Self { name: name.to_owned(), ..self.clone() }
    }

    /// The place of `value` between start (0) and end (1).
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        (value - self.start) / (self.end - self.start)
    }

    fn label(&self, tick: f64) -> String {
        write(tick, self.step)
    }

    fn widest_label(&self) -> f64 {
        let widths = self.ticks.iter().map(|&t| TextStyle::TICK.width(&self.label(t)));
        widths.fold(0.0, f64::max)
    }

    /// Room that the axis needs at the left of a plot [px].
    pub(crate) fn gutter(&self) -> f64 {
        TextStyle::AXIS.size + GAP + self.widest_label() + GAP + TICK
    }

    /// Draws ticks, labels and name below `plot`.
    pub(crate) fn draw_below(&self, drawing: &mut Drawing, plot: &Rect) {
        let mut ticks = Path::default();
        let style = TextStyle::TICK;
        let baseline = plot.max[1] + TICK + GAP + CAP_HEIGHT * style.size;
        let room = plot.width() / (self.ticks.len().max(2) - 1) as f64;
        // Labels that would touch are thinned, keeping the first.
        let every = ((self.widest_label() + 8.0) / room).ceil().max(1.0) as usize;
        for (i, &tick) in self.ticks.iter().enumerate() {
            let x = plot.min[0] + self.fraction(tick) * plot.width();
            ticks.add_line(&[[x, plot.max[1]], [x, plot.max[1] + TICK]]);
            let label = self.label(tick);
            let half = style.width(&label) / 2.0 + EDGE;
            let is_inside = half <= x && x <= drawing.width - half;
            if i % every == 0 && is_inside {
                drawing.label(&label, [x, baseline], Anchor::Middle, style);
            }
        }
        drawing.stroke(ticks, Stroke::new(Color::MUTED, 1.0));
        let at = [(plot.min[0] + plot.max[0]) / 2.0, plot.max[1] + BELOW];
        drawing.label(&self.name, at, Anchor::Middle, TextStyle::AXIS);
    }

    /// Draws ticks, labels and name at the left of `plot`, the name at `left` [px].
    pub(crate) fn draw_left(&self, drawing: &mut Drawing, plot: &Rect, left: f64) {
        let mut ticks = Path::default();
        let style = TextStyle::TICK;
        for &tick in &self.ticks {
            let y = plot.max[1] - self.fraction(tick) * plot.height();
            ticks.add_line(&[[plot.min[0] - TICK, y], [plot.min[0], y]]);
            let at = [plot.min[0] - TICK - GAP, y + CAP_HEIGHT * style.size / 2.0];
            drawing.label(&self.label(tick), at, Anchor::End, style);
        }
        drawing.stroke(ticks, Stroke::new(Color::MUTED, 1.0));
        let TextStyle { size, color, .. } = TextStyle::AXIS;
        let text = Text {
            text: &self.name,
            at: [left + CAP_HEIGHT * size, (plot.min[1] + plot.max[1]) / 2.0],
            size,
            weight: Weight::Regular,
            anchor: Anchor::Middle,
            angle: -std::f64::consts::FRAC_PI_2,
        };
        drawing.text(&text, TextPaint { color, halo: None });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within_the_range() {
        let axis = Axis::new("x [m]", [-0.13, 0.21], 700.0, 90.0);
        assert_eq!(axis.ticks, [-0.1, -0.05, 0.0, 0.05, 0.1, 0.15, 0.2]);
        let backwards = Axis::new("z [m]", [1.0, -1.0], 300.0, 90.0);
        assert_eq!(backwards.ticks, [-1.0, 0.0, 1.0]);
        assert_eq!(backwards.fraction(1.0), 0.0);
    }
}
