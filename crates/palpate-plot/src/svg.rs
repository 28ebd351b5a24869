// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Writes a drawing as SVG.

use std::fmt::Write;

use crate::drawing::{Drawing, Image, Item, Mark, Path, Stroke, Verb};
use crate::geometry::{Point, Rect};
use crate::palette::Color;
use crate::png;

/// The drawing as an SVG document, the same bytes for the same drawing.
pub(crate) fn write(drawing: &Drawing) -> String {
    let (width, height) = (Number(drawing.width), Number(drawing.height));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" role=\"img\" stroke-linecap=\"round\" \
         stroke-linejoin=\"round\">\n"
    );
    for (tag, text) in [("title", &drawing.title), ("desc", &drawing.description)] {
        if !text.is_empty() {
            svg.push_str(&format!("<{tag}>{}</{tag}>\n", escape(text)));
        }
    }
    let white = Color::WHITE.hex();
    svg.push_str(&format!("<path fill=\"{white}\" d=\"M0 0H{width}V{height}H0z\"/>\n"));
    for item in &drawing.items {
        match item {
            Item::Mark(mark) => write_mark(&mut svg, mark),
            Item::Image(rect, image) => write_image(&mut svg, rect, image),
        }
    }
    svg.push_str("</svg>\n");
    svg
}

/// A stroke lies under its fill, as a halo does. A mark with both becomes two paths: not every
/// renderer knows `paint-order`, and without it the halos of labels would cover their text.
fn write_mark(svg: &mut String, mark: &Mark) {
    if let Some(stroke) = &mark.stroke {
        svg.push_str("<path fill=\"none\"");
        write_stroke(svg, stroke);
        if mark.text.is_some() {
            svg.push_str(" aria-hidden=\"true\"");
        }
        write_data(svg, mark);
    }
    if let Some(fill) = mark.fill {
        svg.push_str(&format!("<path fill=\"{}\"", fill.hex()));
        if mark.is_even_odd {
            svg.push_str(" fill-rule=\"evenodd\"");
        }
        if mark.opacity < 1.0 {
            svg.push_str(&format!(" fill-opacity=\"{}\"", Number(mark.opacity)));
        }
        if let Some(text) = &mark.text {
            svg.push_str(&format!(" aria-label=\"{}\"", escape(text)));
        }
        write_data(svg, mark);
    }
}

fn write_data(svg: &mut String, mark: &Mark) {
    svg.push_str(" d=\"");
    write_path(svg, &mark.path);
    svg.push_str("\"/>\n");
}

/// Writes an image as PNG within the document, as a data URL (RFC 2397).
fn write_image(svg: &mut String, rect: &Rect, image: &Image) {
    // Writing to memory fails only for an image without pixels, which is invisible.
    let Ok(png) = png::write_image(image) else { return };
    let [x, y] = rect.min.map(Number);
    let (width, height) = (Number(rect.width()), Number(rect.height()));
    svg.push_str(&format!(
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
         preserveAspectRatio=\"none\" href=\"data:image/png;base64,"
    ));
    write_base64(svg, &png);
    svg.push_str("\"/>\n");
}

/// Writes bytes in base 64 (RFC 4648).
fn write_base64(text: &mut String, bytes: &[u8]) {
    const DIGITS: &[u8; 64] =
        b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for three in bytes.chunks(3) {
        let byte = |i: usize| three.get(i).map_or(0, |&byte| u32::from(byte));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let is_filled = digit <= three.len();
            let index = (bits >> (18 - 6 * digit) & 63) as usize;
            text.push(if is_filled { char::from(DIGITS[index]) } else { '=' });
        }
    }
}

fn write_stroke(svg: &mut String, stroke: &Stroke) {
    let (color, width) = (stroke.color.hex(), Number(stroke.width));
    svg.push_str(&format!(" stroke=\"{color}\" stroke-width=\"{width}\""));
    if !stroke.dash.is_empty() {
        let dash: Vec<String> = stroke.dash.iter().map(|&x| Number(x).to_string()).collect();
        svg.push_str(&format!(" stroke-dasharray=\"{}\"", dash.join(" ")));
    }
    if stroke.opacity < 1.0 {
        svg.push_str(&format!(" stroke-opacity=\"{}\"", Number(stroke.opacity)));
    }
}

/// Writes a path with relative coordinates in hundredths of a pixel: short, and without drift,
/// because differences are taken between rounded points.
fn write_path(svg: &mut String, path: &Path) {
    let mut last = [0; 2];
    let mut command = ' ';
    let mut start = [0; 2];
    for verb in &path.verbs {
        let (next, points): (char, &[Point]) = match verb {
            Verb::Move(p) => ('m', &[*p]),
            Verb::Line(p) => ('l', &[*p]),
            Verb::Quadratic(c, p) => ('q', &[*c, *p]),
            Verb::Close => {
                svg.push('z');
                (command, last) = ('z', start);
                continue;
            }
        };
        let points: Vec<[i64; 2]> = points.iter().map(|p| p.map(hundredths)).collect();
        let end = points[points.len() - 1];
        if next == 'l' && end == last {
            continue;
        }
        if next != command {
            svg.push(next);
        }
        for (i, p) in points.iter().enumerate() {
            if next == command || i > 0 {
                separate(svg, p[0] - last[0]);
            }
            write_hundredths(svg, p[0] - last[0]);
            separate(svg, p[1] - last[1]);
            write_hundredths(svg, p[1] - last[1]);
        }
        if next == 'm' {
            start = end;
        }
        (command, last) = (next, end);
    }
}

fn hundredths(x: f64) -> i64 {
    (x * 100.0).round() as i64
}

/// A minus sign needs no space before it.
fn separate(svg: &mut String, next: i64) {
    if next >= 0 {
        svg.push(' ');
    }
}

fn write_hundredths(svg: &mut String, x: i64) {
    let sign = if x < 0 { "-" } else { "" };
    let (whole, part) = (x.abs() / 100, x.abs() % 100);
    let whole = if whole == 0 && part != 0 { String::new() } else { whole.to_string() };
    svg.push_str(sign);
    svg.push_str(&whole);
    if part % 10 != 0 {
        let _ = write!(svg, ".{part:02}"); // writing to a string cannot fail
    } else if part != 0 {
        let _ = write!(svg, ".{}", part / 10);
    }
}

/// A number of pixels, written to hundredths.
struct Number(f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = String::new();
        write_hundredths(&mut text, hundredths(self.0));
        f.write_str(&text)
    }
}

/// `text` with the special characters of XML escaped, and without those that XML forbids.
fn escape(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars() {
        match c {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            '"' => escaped.push_str("&quot;"),
            '\n' | '\t' => escaped.push(' '),
            c if c.is_control() || c == '\u{FFFE}' || c == '\u{FFFF}' => {}
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (x, text) in
            [(0.0, "0"), (-0.5, "-.5"), (12.3, "12.3"), (7.064, "7.06"), (-3.0, "-3")]
        {
            assert_eq!(Number(x).to_string(), text);
        }
    }

    #[test]
    fn paths_are_relative_and_do_not_drift() {
        let mut path = Path::line(&[[1.0, 2.0], [1.333, 2.0], [1.666, 1.5], [2.0, 1.5]]);
        path.push(Verb::Close);
        path.add_line(&[[5.0, 5.0], [5.0, 5.001], [6.0, 5.0]]);
        let mut svg = String::new();
        write_path(&mut svg, &path);
        assert_eq!(svg, "m1 2l.33 0 .34-.5 .33 0zm4 3l1 0");
    }

    /// The examples of RFC 4648, section 10.
    #[test]
    fn bytes_are_written_in_base_64() {
        for (bytes, expected) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg==")]
        {
            let mut text = String::new();
            write_base64(&mut text, bytes.as_bytes());
            assert_eq!(text, expected);
        }
    }

    #[test]
    fn text_is_escaped() {
        assert_eq!(escape("a<b & \"c\"\u{0}\n"), "a&lt;b &amp; &quot;c&quot; ");
    }
}
