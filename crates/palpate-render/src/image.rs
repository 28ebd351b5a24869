// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Pictures of pixels, and their files.

use std::io::Write;

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError};

use crate::color::SrgbColor;
use crate::error::RenderError;

/// A picture of pixels, row by row from the upper left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    width: u32,
    pixels: Vec<SrgbColor>,
}

impl Image {
    /// Rows of `width` pixels.
    pub(crate) fn new(width: u32, pixels: Vec<SrgbColor>) -> Self {
        Self { width, pixels }
    }

    /// The width [pixels].
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// The height [pixels].
    #[must_use]
    pub fn height(&self) -> u32 {
        (self.pixels.len() / self.width as usize) as u32
    }

    /// Width and height [pixels].
    fn size(&self) -> [u32; 2] {
        [self.width, self.height()]
    }

    /// The pixels.
    #[must_use]
    pub fn pixels(&self) -> &[SrgbColor] {
        &self.pixels
    }

    /// Lays pixels over the picture: red, green, blue and opacity of each, in the same order.
    /// Pixels past the last of either are left out.
    ///
    /// ```
    /// use palpate_field::Shape;
    /// use palpate_render::{Camera, SrgbColor, Lens, Settings, Sight, Subject, render};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let subject = Subject::of_shapes([Shape::ball(0.05)?])?;
    /// let sight = Sight::from_angles(0.6, 0.4)?;
    /// let camera = Camera::fitting(&subject.corners(), sight, Lens::USUAL, 1.0)?;
    /// let drawn = render(&subject, &camera, &Settings::new(8, 8), &|_| true)?;
    /// let mut image = drawn.ok_or("the watch ended it")?.image;
    /// image.lay_over(&[[255, 0, 0, 255]]);
    /// assert_eq!(image.pixels()[0], SrgbColor([255, 0, 0]));
    /// # Ok(())
    /// # }
    /// ```
    pub fn lay_over(&mut self, layer: &[[u8; 4]]) {
        for (SrgbColor(below), [red, green, blue, opacity]) in self.pixels.iter_mut().zip(layer)
        {
            let share = f64::from(*opacity) / 255.0;
            for (below, above) in below.iter_mut().zip([red, green, blue]) {
                let mixed = f64::from(*below) * (1.0 - share) + f64::from(*above) * share;
                *below = mixed.round() as u8;
            }
        }
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    ///
    /// [`RenderError::Png`] if `out` cannot be written.
    pub fn write_png(&self, out: impl Write) -> Result<(), RenderError> {
        write(std::slice::from_ref(self), None, out)
    }
}

/// Writes pictures of one size as an animated PNG that repeats without end, each shown for
/// `delay_ms` [ms]; programs that know no animations show the first.
///
/// ```
/// use palpate_field::{Shape, Vector};
/// use palpate_render::{Camera, Lens, Settings, Sight, Subject, render, write_animation};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let subject = Subject::of_shapes([Shape::cuboid([0.1; 3])?])?;
/// let sight = Sight::from_angles(0.6, 0.4)?;
/// let camera = Camera::fitting(&subject.corners(), sight, Lens::USUAL, 1.0)?;
/// let mut frames = Vec::new();
/// for angle in [0.0, 0.5] {
///     let camera = camera.turned(angle, Vector::ZERO);
///     let drawn = render(&subject, &camera, &Settings::new(8, 8), &|_| true)?;
///     frames.push(drawn.ok_or("the watch ended it")?.image);
/// }
/// let mut file = Vec::new();
/// write_animation(&frames, 100, &mut file)?;
/// assert!(file.starts_with(b"\x89PNG"));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// [`RenderError::NoPicture`], [`RenderError::OtherSize`]; [`RenderError::Png`] if `out` cannot be
/// written.
pub fn write_animation(
    frames: &[Image],
    delay_ms: u16,
    out: impl Write,
) -> Result<(), RenderError> {
    write(frames, Some(delay_ms), out)
}

fn write(frames: &[Image], delay_ms: Option<u16>, out: impl Write) -> Result<(), RenderError> {
    let failed = |error: EncodingError| RenderError::Png { reason: error.to_string() };
    let first = frames.first().ok_or(RenderError::NoPicture)?;
    if let Some(other) = frames.iter().find(|frame| frame.size() != first.size()) {
        return Err(RenderError::OtherSize { first: first.size(), other: other.size() });
    }
    let mut encoder = Encoder::new(out, first.width, first.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::High);
    if let Some(delay) = delay_ms {
        encoder.set_animated(frames.len() as u32, 0).map_err(failed)?;
        encoder.set_frame_delay(delay, 1000).map_err(failed)?;
    }
    let mut writer = encoder.write_header().map_err(failed)?;
    for frame in frames {
        let bytes: Vec<u8> = frame.pixels.iter().flat_map(|color| color.0).collect();
        writer.write_image_data(&bytes).map_err(failed)?;
    }
    writer.finish().map_err(failed)
}
