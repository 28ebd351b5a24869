// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The names of bodies, in one or more lines.

use crate::geometry::{Point, Rect};
use crate::labels::Occupied;
use crate::text::{Anchor, CAP_HEIGHT, Text, Weight, wrap};

/// Size of a name, and of the note below it [px].
const SIZES: [f64; 2] = [12.5, 11.5];
/// From line to line [px].
const LINE: f64 = 15.0;
/// Between a body and its name beside it [px].
const GAP: f64 = 8.0;
/// Names are not broken into lines shorter than this [px].
const NARROWEST: f64 = 66.0;

/// A name and a note with their place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Name {
    /// The words of each line, with their size [px] and weight.
    lines: Vec<(String, f64, Weight)>,
    /// [px].
    middle: Point,
}

impl Name {
    /// The ways to write a name with a note below it, the preferred one first: each in a line,
    /// each broken into lines as wide as `room` [px], the name alone.
    pub(crate) fn ways(name: &str, note: &str, room: f64) -> Vec<Self> {
        let written = |limit: f64, note: &str| {
            let parts = [(name, Weight::SemiBold), (note, Weight::Regular)];
            let lines = parts.into_iter().zip(SIZES).flat_map(|((text, weight), size)| {
                let lines = wrap(text, size, weight, limit).into_iter();
                lines.map(move |line| (line, size, weight))
            });
            Self { lines: lines.collect(), middle: [0.0; 2] }
        };
        let narrow = room.max(NARROWEST);
        let mut ways = vec![
            written(f64::INFINITY, note),
            written(narrow, note),
            written(f64::INFINITY, ""),
            written(narrow, ""),
        ];
        ways.dedup();
        ways
    }

    /// Around this point [px].
    pub(crate) fn at(&self, middle: Point) -> Self {
        Self { middle, ..self.clone() }
    }

    /// Places for the middle beside `bounds` [px]: above, below, right, left.
    pub(crate) fn beside(&self, bounds: &Rect) -> [Point; 4] {
        let [x, y] = bounds.middle();
        let width = self.texts().iter().map(|text| text.bounds().width()).fold(0.0, f64::max);
        let (half, high) = (0.5 * width + GAP, 0.5 * LINE * self.lines.len() as f64 + GAP);
        let Rect { min, max } = *bounds;
        [[x, min[1] - high], [x, max[1] + high], [max[0] + half, y], [min[0] - half, y]]
    }

    /// The lines, as they are drawn.
    pub(crate) fn texts(&self) -> Vec<Text<'_>> {
        let above = 0.5 * (self.lines.len() as f64 - 1.0);
        let lines = self.lines.iter().enumerate().map(|(row, (text, size, weight))| {
            let middle = self.middle[1] + (row as f64 - above) * LINE;
            let at = [self.middle[0], middle + CAP_HEIGHT * size / 2.0];
            let (size, weight, anchor) = (*size, *weight, Anchor::Middle);
            Text { text, at, size, weight, anchor, angle: 0.0 }
        });
        lines.collect()
    }

    /// Whether all lines are within `plot` and clear of what is there.
    pub(crate) fn is_free(&self, plot: &Rect, occupied: &Occupied) -> bool {
        let room = plot.grown(-2.0);
        let texts = self.texts();
        texts.iter().all(|text| room.contains_rect(&text.bounds()))
            && texts.iter().all(|text| occupied.is_free(text, true))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_broken_and_notes_left_out_last() {
        let ways = Name::ways("cone and cube: union", "Wood", 80.0);
        let words =
            |name: &Name| name.lines.iter().map(|line| line.0.clone()).collect::<Vec<_>>();
        let words: Vec<_> = ways.iter().map(words).collect();
        assert_eq!(words[0], ["cone and cube: union", "Wood"]);
        assert_eq!(words[1], ["cone and", "cube: union", "Wood"]);
        assert_eq!(words[2..], [vec!["cone and cube: union"], vec!["cone and", "cube: union"]]);
        assert_eq!(Name::ways("cup", "", 80.0).len(), 1);
    }

    #[test]
    fn names_are_centred() {
        let name = &Name::ways("cup", "glass", 80.0)[0].at([100.0, 50.0]);
        let texts = name.texts();
        let bounds = texts.iter().map(Text::bounds).reduce(|a, b| a.union(&b)).unwrap();
        let [x, y] = bounds.middle();
        assert!((x - 100.0).abs() < 1e-9 && (y - 50.0).abs() < 2.0, "({x}, {y})");
    }
}
