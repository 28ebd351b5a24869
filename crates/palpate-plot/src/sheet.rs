// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Many small pictures in a grid, with their names and one legend.

use crate::drawing::{Drawing, Path, Stroke, TextStyle};
use crate::geometry::Rect;
use crate::isolines::{ABOVE_LEGEND, Isolines};
use crate::legend::{self, Entry, Key};
use crate::palette::Color;
use crate::scale::{round_down, write_length};
use crate::text::{Anchor, CAP_HEIGHT, shorten};

/// Above the first names [px].
const ABOVE: f64 = 6.0;
/// Between two tiles [px].
const BETWEEN: f64 = 14.0;
/// Height of a tile's name, and of the scale bar below its picture [px].
const NAME: f64 = 17.0;
const SCALE: f64 = 18.0;
/// The most of a tile's width that its scale bar takes.
const BAR: f64 = 0.5;

/// Pictures in rows of some columns.
#[derive(Debug, Clone)]
pub(crate) struct Sheet {
    tiles: Vec<Isolines>,
    columns: usize,
}

impl Sheet {
    pub(crate) fn new(tiles: Vec<Isolines>, columns: usize) -> Self {
        Self { tiles, columns: columns.clamp(1, 8) }
    }

    /// Draws the sheet into `area` from its top; returns the height used [px].
    pub(crate) fn draw(&self, drawing: &mut Drawing, area: &Rect) -> f64 {
        let columns = self.columns as f64;
        let width = (area.width() - (columns - 1.0) * BETWEEN) / columns;
        let mut entries: Vec<Entry> = Vec::new();
        let mut top = area.min[1] + ABOVE;
        for row in self.tiles.chunks(self.columns) {
            for (column, tile) in row.iter().enumerate() {
                let left = area.min[0] + column as f64 * (width + BETWEEN);
                let seen = draw_tile(drawing, tile, &Rect::new(left, top, width, width));
                seen.into_iter().for_each(|entry| merge(&mut entries, entry));
            }
            top += NAME + width + SCALE + BETWEEN;
        }
        top += ABOVE_LEGEND - BETWEEN;
        top + legend::draw(drawing, &entries, [area.min[0], top], area.width()) - area.min[1]
    }
}

/// Adds what is not there yet; of two scales the one with the larger end stays.
fn merge(entries: &mut Vec<Entry>, entry: Entry) {
    match entries.iter_mut().find(|known| known.is_same(&entry)) {
        None => entries.push(entry),
        Some(known) => {
            if let (Key::Scale(_, [_, end]), Key::Scale(_, [_, other])) =
                (&known.key, &entry.key)
                && other > end
            {
                *known = entry;
            }
        }
    }
}

/// Draws name, picture and scale bar from the top left corner of `place`; returns the entries of
/// the legend.
fn draw_tile(drawing: &mut Drawing, tile: &Isolines, place: &Rect) -> Vec<Entry> {
    let [left, top] = place.min;
    let style = TextStyle::TILE;
    let name = shorten(tile.title(), style.size, style.weight, place.width());
    drawing.label(&name, [left, top + CAP_HEIGHT * style.size], Anchor::Start, style);
    let [width, height] = tile.extent();
    let scale = place.width() / width.max(height);
    let (width, height) = (scale * width, scale * height);
    let margin = [(place.width() - width) / 2.0, (place.height() - height) / 2.0];
    let plot = Rect::new(left + margin[0], top + NAME + margin[1], width, height);
    let entries = tile.draw_tile(drawing, plot);
    let length = round_down(BAR * place.width() / scale);
    let (right, base) = (place.max[0], top + NAME + place.height() + SCALE - 6.0);
    let start = right - length * scale;
    let bar = [[start, base - 5.0], [start, base], [right, base], [right, base - 5.0]];
    drawing.stroke(Path::line(&bar), Stroke::new(Color::INK, 1.2));
    let style = TextStyle::TICK;
    drawing.label(&write_length(length), [start - 6.0, base + 0.5], Anchor::End, style);
    entries
}
