// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Text as outlines, so that a figure looks the same with any installed fonts.

use std::sync::LazyLock;

use skrifa::instance::{LocationRef, Size};
use skrifa::metrics::GlyphMetrics;
use skrifa::outline::{DrawSettings, OutlineGlyphCollection, OutlinePen};
use skrifa::{FontRef, MetadataProvider, charmap::Charmap};

use crate::drawing::{Path, Verb};
use crate::geometry::{Point, Rect};

/// Weight of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weight {
    Regular,
    SemiBold,
}

/// The point of a text that its position gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Height of a capital or digit over the text size, in Inter: for centring lines vertically.
pub(crate) const CAP_HEIGHT: f64 = 0.727;
/// Distance of baselines over the text size.
pub(crate) const LINE_HEIGHT: f64 = 1.42;

struct Face {
    charmap: Charmap<'static>,
    metrics: GlyphMetrics<'static>,
    outlines: OutlineGlyphCollection<'static>,
}

/// The bundled fonts; `None` cannot happen, because a test reads them both.
static FACES: LazyLock<[Option<Face>; 2]> = LazyLock::new(|| {
    [
        Face::new(include_bytes!("../fonts/Inter-Regular.ttf")),
        Face::new(include_bytes!("../fonts/Inter-SemiBold.ttf")),
    ]
});

impl Face {
    fn new(data: &'static [u8]) -> Option<Self> {
        let font = FontRef::new(data).ok()?;
        let em = Size::new(1.0);
        Some(Self {
            charmap: font.charmap(),
            metrics: font.glyph_metrics(em, LocationRef::default()),
            outlines: font.outline_glyphs(),
        })
    }

    fn of(weight: Weight) -> Option<&'static Self> {
        match weight {
            Weight::Regular => FACES[0].as_ref(),
            Weight::SemiBold => FACES[1].as_ref(),
        }
    }

    /// The glyph of `c`; that of an empty box for characters the font lacks.
    fn glyph(&self, c: char) -> skrifa::GlyphId {
        self.charmap.map(c).unwrap_or_default()
    }

    fn advance(&self, c: char) -> f64 {
        f64::from(self.metrics.advance_width(self.glyph(c)).unwrap_or(0.0))
    }
}

/// Width of `text` at `size`, both in pixels.
pub(crate) fn width(text: &str, size: f64, weight: Weight) -> f64 {
    let Some(face) = Face::of(weight) else {
        return 0.0;
    };
    text.chars().map(|c| size * face.advance(c)).sum()
}

/// Breaks `text` at spaces into lines of at most `limit` pixels. Longer words stick out.
pub(crate) fn wrap(text: &str, size: f64, weight: Weight, limit: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        if let Some(line) = lines.last_mut() {
            let longer = format!("{line} {word}");
            if width(&longer, size, weight) <= limit {
                *line = longer;
                continue;
            }
        }
        lines.push(word.to_owned());
    }
    lines
}

/// `text` cut to at most `limit` pixels, with an ellipsis if it was longer.
pub(crate) fn shorten(text: &str, size: f64, weight: Weight, limit: f64) -> String {
    if width(text, size, weight) <= limit {
        return text.to_owned();
    }
    let mut kept: String = text.to_owned();
    while kept.pop().is_some() {
        let short = format!("{}…", kept.trim_end());
        if width(&short, size, weight) <= limit {
            return short;
        }
    }
    "…".to_owned()
}

/// A line of text in a picture.
#[derive(Debug, Clone)]
pub(crate) struct Text<'a> {
    pub(crate) text: &'a str,
    /// Where the anchor is, on the baseline [px].
    pub(crate) at: Point,
    /// Height of the em square [px].
    pub(crate) size: f64,
    pub(crate) weight: Weight,
    pub(crate) anchor: Anchor,
    /// Turn around the anchor, clockwise in the picture [rad].
    pub(crate) angle: f64,
}

impl Text<'_> {
    /// The outlines of the text.
    pub(crate) fn outline(&self) -> Path {
        let Some(face) = Face::of(self.weight) else {
            return Path::default();
        };
        let mut x = self.start();
        let mut pen = Pen { path: Path::default(), text: self, x };
        for c in self.text.chars() {
            pen.x = x;
            if let Some(glyph) = face.outlines.get(face.glyph(c)) {
                let settings = DrawSettings::unhinted(Size::new(1.0), LocationRef::default());
                // A glyph that cannot be drawn leaves a gap, as a space does.
                let _ = glyph.draw(settings, &mut pen);
            }
            x += self.size * face.advance(c);
        }
        pen.path
    }

    /// The line through the middle of the letters, from the first to the last.
    pub(crate) fn middle(&self) -> Path {
        const HEIGHT: f32 = 0.36;
        let pen = Pen { path: Path::default(), text: self, x: self.start() };
        let width = (width(self.text, self.size, self.weight) / self.size) as f32;
        let mut path = Path::default();
        path.push(Verb::Move(pen.place(0.0, HEIGHT)));
        path.push(Verb::Line(pen.place(width, HEIGHT)));
        path
    }

    /// Where the first letter starts, to the right of the anchor [px].
    fn start(&self) -> f64 {
        let width = width(self.text, self.size, self.weight);
        match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -width / 2.0,
            Anchor::End => -width,
        }
    }

    /// The box around the text, before its turn: from the baseline's descenders to the capitals.
    pub(crate) fn bounds(&self) -> Rect {
        let width = width(self.text, self.size, self.weight);
        let x = self.at[0] + self.start();
        let (ascent, descent) = (0.76 * self.size, 0.2 * self.size);
        Rect::new(x, self.at[1] - ascent, width, ascent + descent)
    }
}

/// Places glyph outlines (em units, y up) in the picture (pixels, y down).
struct Pen<'a> {
    path: Path,
    text: &'a Text<'a>,
    x: f64,
}

impl Pen<'_> {
    fn place(&self, x: f32, y: f32) -> Point {
        let (x, y) = (self.x + self.text.size * f64::from(x), -self.text.size * f64::from(y));
        let (sin, cos) = self.text.angle.sin_cos();
        [self.text.at[0] + cos * x - sin * y, self.text.at[1] + sin * x + cos * y]
    }
}

impl OutlinePen for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let p = self.place(x, y);
        self.path.push(Verb::Move(p));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let p = self.place(x, y);
        self.path.push(Verb::Line(p));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        let (c, p) = (self.place(cx, cy), self.place(x, y));
        self.path.push(Verb::Quadratic(c, p));
    }

    /// The bundled fonts are TrueType: their curves are quadratic.
    fn curve_to(&mut self, _: f32, _: f32, _: f32, _: f32, x: f32, y: f32) {
        self.line_to(x, y);
    }

    fn close(&mut self) {
        self.path.push(Verb::Close);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_fonts_have_what_figures_write() {
        for weight in [Weight::Regular, Weight::SemiBold] {
            let face = Face::of(weight).unwrap();
            for c in "−0123456789.×⁻⁰¹²³⁴⁵⁶⁷⁸⁹µmsN°·…≤≥αβγé[]/".chars()
            {
                assert!(face.charmap.map(c).is_some(), "{c}");
            }
        }
    }

    #[test]
    fn widths_are_those_of_the_font() {
        // Digits 1 and 0 of Inter are 833 and 1292 units of 2048 wide.
        let expected = 20.0 * (833.0 + 1292.0) / 2048.0;
        assert!((width("10", 20.0, Weight::Regular) - expected).abs() < 1e-4);
    }

    #[test]
    fn wraps_and_shortens_to_the_limit() {
        let text = "exact outside, a bound inside: steps by the field are safe";
        let lines = wrap(text, 12.0, Weight::Regular, 120.0);
        assert!(lines.len() > 2 && lines.join(" ") == text);
        assert!(lines.iter().all(|line| width(line, 12.0, Weight::Regular) <= 120.0));
        let short = shorten(text, 12.0, Weight::Regular, 100.0);
        assert!(short.ends_with('…') && width(&short, 12.0, Weight::Regular) <= 100.0);
    }
}
