// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Draws a drawing as PNG.

use tiny_skia::{
    FillRule, FilterQuality, LineCap, LineJoin, Paint, PathBuilder, Pattern, Pixmap,
    PremultipliedColorU8, SpreadMode, StrokeDash, Transform,
};

use crate::drawing::{Drawing, Image, Item, Mark, Path, Stroke, Verb};
use crate::error::PlotError;
use crate::geometry::{Point, Rect};
use crate::palette::Color;

/// Smallest width [px]: below it no label can be read.
const MIN_WIDTH: u32 = 64;
/// Largest width and height [px]: a gigabyte of pixels.
pub(crate) const MAX_SIDE: u32 = 16_384;

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
    paint_drawing(&mut pixels, drawing, scale);
    encode(&pixels)
}

/// The drawing over nothing, `scale` pixels for each of its own: red, green, blue and opacity of
/// pixels of `width` by `height`. `None` if there are none.
pub(crate) fn transparent(
    drawing: &Drawing,
    [width, height]: [u32; 2],
    scale: f64,
) -> Option<Vec<[u8; 4]>> {
    let mut pixels = Pixmap::new(width, height)?;
    paint_drawing(&mut pixels, drawing, scale);
    let straight = pixels.pixels().iter().map(|pixel| {
        let color = pixel.demultiply();
        [color.red(), color.green(), color.blue(), color.alpha()]
    });
    Some(straight.collect())
}

fn paint_drawing(pixels: &mut Pixmap, drawing: &Drawing, scale: f64) {
    let transform = Transform::from_scale(scale as f32, scale as f32);
    for item in &drawing.items {
        match item {
            Item::Mark(mark) => paint_mark(pixels, mark, transform),
            Item::Image(rect, image) => paint_image(pixels, rect, image, transform),
        }
    }
}

/// The image as a PNG file of its own size.
///
/// # Errors
///
/// [`PlotError::Png`].
pub(crate) fn write_image(image: &Image) -> Result<Vec<u8>, PlotError> {
    match pixmap(image) {
        Some(pixels) => encode(&pixels),
        None => Err(PlotError::Png { reason: "an image without pixels".to_owned() }),
    }
}

fn encode(pixels: &Pixmap) -> Result<Vec<u8>, PlotError> {
    pixels.encode_png().map_err(|error| PlotError::Png { reason: error.to_string() })
}

fn pixmap(image: &Image) -> Option<Pixmap> {
    let [width, height] =
        [image.width, image.height()].map(|side| u32::try_from(side).unwrap_or(0));
    let mut pixmap = Pixmap::new(width, height)?;
    for (pixel, color) in pixmap.pixels_mut().iter_mut().zip(&image.pixels) {
        let Color { red, green, blue } = *color;
        *pixel = PremultipliedColorU8::from_rgba(red, green, blue, u8::MAX)?;
    }
    Some(pixmap)
}

/// Paints `image` over `rect`, its pixels blended where they are enlarged.
fn paint_image(pixels: &mut Pixmap, rect: &Rect, image: &Image, transform: Transform) {
    let (Some(source), Some(path)) = (pixmap(image), build(&Path::rect(rect))) else {
        return;
    };
    let scale = |size: f64, count: usize| (size / count as f64) as f32;
    let to_rect = Transform::from_row(
        scale(rect.width(), image.width),
        0.0,
        0.0,
        scale(rect.height(), image.height()),
        rect.min[0] as f32,
        rect.min[1] as f32,
    );
    let quality = FilterQuality::Bilinear;
    let paint = Paint {
        shader: Pattern::new(source.as_ref(), SpreadMode::Pad, quality, 1.0, to_rect),
        ..Paint::default()
    };
    pixels.fill_path(&path, &paint, FillRule::Winding, transform, None);
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
