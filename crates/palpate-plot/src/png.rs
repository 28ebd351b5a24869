// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Draws a drawing as PNG.

use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, StrokeDash, Transform,
};

use crate::drawing::{Drawing, Mark, Path, Stroke, Verb};
use crate::error::PlotError;
use crate::geometry::Point;
use crate::palette::Color;

/// Smallest width [px]: below it no label can be read.
const MIN_WIDTH: u32 = 64;
/// Largest width and height [px]: a gigabyte of pixels.
const MAX_SIDE: u32 = 16_384;

/// The drawing as a PNG file of `width` pixels, the same bytes for the same drawing.
///
/// # Errors
///
/// [`PlotError::PictureSize`] or [`PlotError::Png`].
pub(crate) fn write(drawing: &Drawing, width: u32) -> Result<Vec<u8>, PlotError> {
    let scale = f64::from(width) / drawing.width;
    let height = (drawing.height * scale).ceil();
    let size_error = PlotError::PictureSize { width, height, min: MIN_WIDTH, max: MAX_SIDE };
    if !(MIN_WIDTH..=MAX_SIDE).contains(&width) || height > f64::from(MAX_SIDE) {
        return Err(size_error);
    }
    let mut pixels = Pixmap::new(width, height as u32).ok_or(size_error)?;
    pixels.fill(tiny_skia::Color::WHITE);
    let transform = Transform::from_scale(scale as f32, scale as f32);
    for mark in &drawing.marks {
        paint_mark(&mut pixels, mark, transform);
    }
    pixels.encode_png().map_err(|error| PlotError::Png { reason: error.to_string() })
}

fn paint_mark(pixels: &mut Pixmap, mark: &Mark, transform: Transform) {
    let Some(path) = build(&mark.path) else {
        return;
    };
    if let Some(stroke) = &mark.stroke {
        let paint = paint(stroke.color, stroke.opacity);
        pixels.stroke_path(&path, &paint, &pen(stroke), transform, None);
    }
    if let Some(color) = mark.fill {
        let rule = if mark.is_even_odd { FillRule::EvenOdd } else { FillRule::Winding };
        pixels.fill_path(&path, &paint(color, 1.0), rule, transform, None);
    }
}

fn build(path: &Path) -> Option<tiny_skia::Path> {
    let mut builder = PathBuilder::new();
    let single = |p: Point| (p[0] as f32, p[1] as f32);
    for verb in &path.verbs {
        match *verb {
            Verb::Move(p) => {
                let (x, y) = single(p);
                builder.move_to(x, y);
            }
            Verb::Line(p) => {
                let (x, y) = single(p);
                builder.line_to(x, y);
            }
            Verb::Quadratic(c, p) => {
                let ((cx, cy), (x, y)) = (single(c), single(p));
                builder.quad_to(cx, cy, x, y);
            }
            Verb::Close => builder.close(),
        }
    }
    builder.finish()
}

fn paint(color: Color, opacity: f64) -> Paint<'static> {
    let mut paint = Paint::default();
    let alpha = (255.0 * opacity.clamp(0.0, 1.0)).round() as u8;
    paint.set_color_rgba8(color.red, color.green, color.blue, alpha);
    paint
}

fn pen(stroke: &Stroke) -> tiny_skia::Stroke {
    tiny_skia::Stroke {
        width: stroke.width as f32,
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        dash: StrokeDash::new(stroke.dash.iter().map(|&x| x as f32).collect(), 0.0),
        ..tiny_skia::Stroke::default()
    }
}
