// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Legends and frames.

use crate::body_picture;
use crate::drawing::{Drawing, Path, Stroke, TextStyle};
use crate::geometry::{Point, Rect, clip_line, clip_ring, distance, simplify};
use crate::palette::Color;
use crate::scale::{self, Ramp};
use crate::slice::PlaneView;
use crate::text::{Anchor, CAP_HEIGHT, shorten};
use crate::trust::{self, Promised};
use crate::wheel::{self, AxisArrow};

/// Width of a key [px].
const KEY: f64 = 30.0;
/// Between key and text [px].
const GAP: f64 = 8.0;
/// Between entries [px].
const BETWEEN: f64 = 22.0;
/// Height of a row [px].
const ROW: f64 = 22.0;

/// The symbol of an entry in the legend.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Key {
    /// Bands, from the surface outwards.
    Bands(Vec<Color>),
    /// A line, over a white one.
    Line(Stroke),
    /// An arrow of this length [px].
    Arrow(Color, f64),
    /// A point.
    Point(Symbol, Color),
    /// The disc of directions, with the names of the two axes.
    Wheel([AxisArrow; 2]),
    /// A colour.
    Swatch(Color),
    /// The tint and hatching of a promise.
    Promised(Promised),
    /// The colours of a measurement, between two numbers.
    Scale(Promised, [f64; 2]),
    /// The outline and the tint of a body.
    DrawnBody(Stroke, Color),
    /// The hatching of what bodies share.
    Shared,
    /// The colours of other numbers.
    Values(Ramp),
    /// Words only.
    None,
}

/// An entry of a legend.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    pub(crate) key: Key,
    pub(crate) text: String,
}

impl Entry {
    pub(crate) fn new(key: Key, text: impl Into<String>) -> Self {
        Self { key, text: text.into() }
    }

    /// Whether one of both entries is enough: they have the same words, and do not show two
    /// scales.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let are_scales = matches!((&self.key, &other.key), (Key::Values(_), Key::Values(_)));
        self.text == other.text && (!are_scales || self.key == other.key)
    }
}

impl Key {
    /// Height of a row that holds the key [px].
    fn height(&self) -> f64 {
        match self {
            Self::Wheel(_) => wheel::SIZE,
            Self::Scale(..) => trust::SCALE[1],
            Self::Values(_) => scale::SIZE[1],
            _ => ROW,
        }
    }

    fn width(&self) -> f64 {
        match self {
            Self::Wheel(_) => wheel::SIZE,
            Self::Scale(..) => trust::SCALE[0],
            Self::Values(_) => scale::SIZE[0],
            Self::Bands(_)
            | Self::Line(_)
            | Self::Swatch(_)
            | Self::Promised(_)
            | Self::DrawnBody(..)
            | Self::Shared => KEY,
            Self::Arrow(_, length) => length.max(12.0),
            Self::Point(..) => 12.0,
            Self::None => -GAP,
        }
    }

    /// Draws the key with its left end at `x`, centred on `y` [px].
    fn draw(&self, drawing: &mut Drawing, x: f64, y: f64) {
        match self {
            Self::Bands(colors) => {
                let width = KEY / colors.len() as f64;
                for (i, &color) in colors.iter().enumerate() {
                    let rect = Rect::new(x + i as f64 * width, y - 6.0, width, 12.0);
                    drawing.fill(Path::rect(&rect), color);
                }
                let frame = Rect::new(x, y - 6.0, KEY, 12.0);
                drawing.stroke(Path::rect(&frame), Stroke::new(Color::MUTED, 0.75));
            }
            Self::Line(stroke) => {
                let line = [[x + 2.0, y], [x + KEY - 2.0, y]];
                drawing.stroke(Path::line(&line), stroke.clone());
            }
            Self::Arrow(color, length) => {
                draw_arrow(drawing, [x, y], [x + length, y], *color);
            }
            Self::Point(symbol, color) => symbol.draw(drawing, [x + 6.0, y], *color),
            Self::Wheel(axes) => wheel::draw(drawing, [x + wheel::SIZE / 2.0, y], axes),
            Self::Swatch(color) => draw_swatch(drawing, x, y, *color, |_, _| {}),
            Self::Promised(promised) => {
                let hatch = |drawing: &mut Drawing, rect: &Rect| {
                    promised.hatch(drawing, rect, &[], |_| true);
                };
                draw_swatch(drawing, x, y, promised.tint(), hatch);
            }
            Self::Scale(promised, ends) => {
                trust::draw_scale(drawing, [x, y], *promised, *ends);
            }
            Self::DrawnBody(stroke, tint) => {
                let rect = Rect::new(x + 1.0, y - 6.0, KEY - 2.0, 12.0);
                drawing.fill(Path::rect(&rect), *tint);
                drawing.stroke(Path::rect(&rect), stroke.clone());
            }
            Self::Shared => {
                let hatch = |drawing: &mut Drawing, rect: &Rect| {
                    let lines = body_picture::SHARED.over(rect, &[], |_| true);
                    drawing.stroke(lines, body_picture::shared_stroke());
                };
                draw_swatch(drawing, x, y, Color::WHITE, hatch);
            }
            Self::Values(ramp) => ramp.draw(drawing, [x, y]),
            Self::None => {}
        }
    }
}

/// Draws a framed rectangle of `color` with its left end at `x`, centred on `y` [px].
fn draw_swatch(
    drawing: &mut Drawing,
    x: f64,
    y: f64,
    color: Color,
    inner: impl FnOnce(&mut Drawing, &Rect),
) {
    let rect = Rect::new(x, y - 6.0, KEY, 12.0);
    drawing.fill(Path::rect(&rect), color);
    inner(drawing, &rect);
    drawing.stroke(Path::rect(&rect), Stroke::new(Color::MUTED, 0.75));
}

/// Draws entries in rows of at most `width` from `[x, y]` down, all [px]; returns the height.
pub(crate) fn draw(drawing: &mut Drawing, entries: &[Entry], [x, y]: Point, width: f64) -> f64 {
    let style = TextStyle::LEGEND;
    let mut top = y;
    for row in rows(entries, width) {
        let height = row.iter().map(|(entry, _)| entry.key.height()).fold(ROW, f64::max);
        let (mut left, middle) = (x, top + height / 2.0);
        for (entry, text) in row {
            entry.key.draw(drawing, left, middle);
            left += entry.key.width() + GAP;
            let at = [left, middle + CAP_HEIGHT * style.size / 2.0];
            drawing.label(&text, at, Anchor::Start, style);
            left += style.width(&text) + BETWEEN;
        }
        top += height;
    }
    top - y
}

/// The entries of each row of `width` [px], with their texts, shortened to it.
fn rows(entries: &[Entry], width: f64) -> Vec<Vec<(&Entry, String)>> {
    let style = TextStyle::LEGEND;
    let mut rows: Vec<Vec<_>> = Vec::new();
    let mut left = 0.0;
    for entry in entries {
        let before = entry.key.width() + GAP;
        let text = shorten(&entry.text, style.size, style.weight, width - before);
        let needed = before + style.width(&text);
        match rows.last_mut() {
            Some(row) if left + needed <= width => row.push((entry, text)),
            _ => {
                left = 0.0;
                rows.push(vec![(entry, text)]);
            }
        }
        left += needed + BETWEEN;
    }
    rows
}

/// The shape of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Symbol {
    /// A disc of half the size.
    Dot,
    Disc,
    Diamond,
    Square,
    Triangle,
}

impl Symbol {
    /// Half the size of a symbol [px].
    pub(crate) const RADIUS: f64 = 5.0;

    pub(crate) fn of_series(index: usize) -> Self {
        [Self::Disc, Self::Diamond, Self::Square, Self::Triangle][index % 4]
    }

    /// Draws the symbol at `center` [px] with a white rim.
    pub(crate) fn draw(self, drawing: &mut Drawing, center: Point, color: Color) {
        let r = Self::RADIUS;
        let ring = |corners: &[Point]| {
            Path::ring(&Vec::from_iter(
                corners.iter().map(|p| [center[0] + p[0], center[1] + p[1]]),
            ))
        };
        let path = match self {
            Self::Dot => Path::circle(center, 0.5 * r),
            Self::Disc => Path::circle(center, r),
            Self::Diamond => {
                ring(&[[0.0, -1.25 * r], [1.25 * r, 0.0], [0.0, 1.25 * r], [-1.25 * r, 0.0]])
            }
            Self::Square => {
                let h = 0.9 * r;
                ring(&[[-h, -h], [h, -h], [h, h], [-h, h]])
            }
            Self::Triangle => ring(&[[0.0, -1.2 * r], [1.1 * r, 0.8 * r], [-1.1 * r, 0.8 * r]]),
        };
        let rim = if self == Self::Dot { 1.0 } else { 3.0 };
        drawing.fill_with_rim(path, color, Stroke::new(Color::WHITE, rim));
    }
}

/// Shorter arrows are not drawn: they have no direction to see [px].
const SHORTEST: f64 = 0.5;
/// Length of an arrow's head [px].
const HEAD: f64 = 10.0;

/// Draws an arrow with a white rim between two points [px]; its head shrinks with short ones.
pub(crate) fn draw_arrow(drawing: &mut Drawing, tail: Point, tip: Point, color: Color) {
    let length = distance(tail, tip);
    if length < SHORTEST {
        return;
    }
    let along = [(tip[0] - tail[0]) / length, (tip[1] - tail[1]) / length];
    let head = HEAD.min(0.6 * length);
    let (half_head, half_shaft) = (0.42 * head, 1.1_f64.min(0.1 * length));
    let at = |s: f64, side: f64| {
        [tail[0] + s * along[0] - side * along[1], tail[1] + s * along[1] + side * along[0]]
    };
    let neck = length - head;
    let ring = [
        at(0.0, -half_shaft),
        at(neck, -half_shaft),
        at(neck, -half_head),
        at(length, 0.0),
        at(neck, half_head),
        at(neck, half_shaft),
        at(0.0, half_shaft),
    ];
    drawing.fill_with_rim(
        Path::ring(&ring),
        color,
        Stroke::new(Color::WHITE, 2.4).with_opacity(0.9),
    );
}

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
