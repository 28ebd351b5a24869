// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The elements of a picture: filled and stroked paths and images, in order.
//!
//! A [`Drawing`] is made once and written by [`svg`](crate::svg) or [`png`](crate::png), so the
//! two formats show the same picture.

use crate::geometry::{Point, Rect};
use crate::palette::Color;
use crate::text::{Anchor, Text, Weight};

/// One step of a path [px].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Verb {
    Move(Point),
    Line(Point),
    /// Control point and end.
    Quadratic(Point, Point),
    Close,
}

/// Lines and curves [px].
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Path {
    pub(crate) verbs: Vec<Verb>,
}

impl Path {
    pub(crate) fn push(&mut self, verb: Verb) {
        self.verbs.push(verb);
    }

    pub(crate) fn add_line(&mut self, points: &[Point]) {
        for (i, &p) in points.iter().enumerate() {
            self.push(if i == 0 { Verb::Move(p) } else { Verb::Line(p) });
        }
    }

    pub(crate) fn add_ring(&mut self, points: &[Point]) {
        self.add_line(points);
        if !points.is_empty() {
            self.push(Verb::Close);
        }
    }

    pub(crate) fn line(points: &[Point]) -> Self {
        let mut path = Self::default();
        path.add_line(points);
        path
    }

    pub(crate) fn lines(lines: &[Vec<Point>]) -> Self {
        let mut path = Self::default();
        lines.iter().for_each(|line| path.add_line(line));
        path
    }

    pub(crate) fn ring(points: &[Point]) -> Self {
        let mut path = Self::default();
        path.add_ring(points);
        path
    }

    pub(crate) fn rect(rect: &Rect) -> Self {
        Self::ring(&rect.corners())
    }

    /// A circle of eight parabolas: off by less than a thousandth of its radius.
    pub(crate) fn circle(center: Point, radius: f64) -> Self {
        let at = |eighth: f64, radius: f64| {
            let (sin, cos) = (eighth * std::f64::consts::FRAC_PI_4).sin_cos();
            [center[0] + radius * cos, center[1] + radius * sin]
        };
        let control = radius / std::f64::consts::FRAC_PI_8.cos();
        let mut path = Self::default();
        path.push(Verb::Move(at(0.0, radius)));
        for i in 0..8 {
            let i = f64::from(i);
            path.push(Verb::Quadratic(at(i + 0.5, control), at(i + 1.0, radius)));
        }
        path.push(Verb::Close);
        path
    }
}

/// How the line of a path is drawn; ends and corners are round.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) color: Color,
    /// Width [px].
    pub(crate) width: f64,
    /// Lengths of strokes and gaps [px]; empty for a solid line.
    pub(crate) dash: Vec<f64>,
    /// From 0 (invisible) to 1.
    pub(crate) opacity: f64,
}

impl Stroke {
    pub(crate) fn new(color: Color, width: f64) -> Self {
        Self { color, width, dash: Vec::new(), opacity: 1.0 }
    }

    pub(crate) fn with_dash(self, dash: Vec<f64>) -> Self {
        Self { dash, ..self }
    }

    pub(crate) fn with_opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}

/// A path with its paint. The stroke lies under the fill, as a halo lies under letters.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mark {
    pub(crate) path: Path,
    /// Filled by the even-odd rule.
    pub(crate) is_even_odd: bool,
    pub(crate) fill: Option<Color>,
    /// Of the fill, from 0 (invisible) to 1.
    pub(crate) opacity: f64,
    pub(crate) stroke: Option<Stroke>,
    /// The text that the path spells.
    pub(crate) text: Option<String>,
}

impl Mark {
    fn new(path: Path, fill: Option<Color>, stroke: Option<Stroke>) -> Self {
        Self { path, is_even_odd: false, fill, opacity: 1.0, stroke, text: None }
    }
}

/// Coloured pixels, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Image {
    pub(crate) width: usize,
    pub(crate) pixels: Vec<Color>,
}

impl Image {
    pub(crate) fn height(&self) -> usize {
        self.pixels.len() / self.width.max(1)
    }
}

/// A part of a picture.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Item {
    Mark(Mark),
    /// An image, stretched over a rectangle [px].
    Image(Rect, Image),
}

/// A picture [px].
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Drawing {
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) title: String,
    pub(crate) description: String,
    pub(crate) items: Vec<Item>,
}

/// How a text is painted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TextPaint {
    pub(crate) color: Color,
    /// Colour and width [px] of a rim that sets the text off from what is below.
    pub(crate) halo: Option<(Color, f64)>,
}

impl Drawing {
    pub(crate) fn fill(&mut self, path: Path, color: Color) {
        self.push(Mark::new(path, Some(color), None));
    }

    pub(crate) fn stroke(&mut self, path: Path, stroke: Stroke) {
        self.push(Mark::new(path, None, Some(stroke)));
    }

    /// Fills `path` by the even-odd rule, with an `opacity` from 0 (invisible) to 1.
    pub(crate) fn fill_rings(&mut self, path: Path, color: Color, opacity: f64) {
        self.push(Mark { is_even_odd: true, opacity, ..Mark::new(path, Some(color), None) });
    }

    /// Draws `image` over `rect`.
    pub(crate) fn image(&mut self, rect: Rect, image: Image) {
        self.items.push(Item::Image(rect, image));
    }

    /// Fills `path` over its own `rim`.
    pub(crate) fn fill_with_rim(&mut self, path: Path, color: Color, rim: Stroke) {
        self.push(Mark::new(path, Some(color), Some(rim)));
    }

    pub(crate) fn text(&mut self, text: &Text<'_>, paint: TextPaint) {
        let halo = paint.halo.map(|(color, width)| Stroke::new(color, width));
        let mark = Mark::new(text.outline(), Some(paint.color), halo);
        self.push(Mark { text: Some(text.text.to_owned()), ..mark });
    }

    /// A horizontal line of text.
    pub(crate) fn label(&mut self, text: &str, at: Point, anchor: Anchor, style: TextStyle) {
        let TextStyle { size, weight, color } = style;
        let text = Text { text, at, size, weight, anchor, angle: 0.0 };
        self.text(&text, TextPaint { color, halo: None });
    }

    fn push(&mut self, mark: Mark) {
        if !mark.path.verbs.is_empty() {
            self.items.push(Item::Mark(mark));
        }
    }
}

/// Size, weight and colour of a text.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TextStyle {
    pub(crate) size: f64,
    pub(crate) weight: Weight,
    pub(crate) color: Color,
}

impl TextStyle {
    pub(crate) const TITLE: Self = Self::new(19.0, Weight::SemiBold, Color::INK);
    pub(crate) const SUBTITLE: Self = Self::new(14.5, Weight::SemiBold, Color::INK);
    pub(crate) const CAPTION: Self = Self::new(13.0, Weight::Regular, Color::MUTED);
    pub(crate) const AXIS: Self = Self::new(13.0, Weight::Regular, Color::INK);
    pub(crate) const TICK: Self = Self::new(12.0, Weight::Regular, Color::MUTED);
    pub(crate) const TILE: Self = Self::new(11.8, Weight::SemiBold, Color::INK);
    pub(crate) const LEGEND: Self = Self::new(13.0, Weight::Regular, Color::INK);

    const fn new(size: f64, weight: Weight, color: Color) -> Self {
        Self { size, weight, color }
    }

    pub(crate) fn width(&self, text: &str) -> f64 {
        crate::text::width(text, self.size, self.weight)
    }
}
