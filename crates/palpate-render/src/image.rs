// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Images and colours.

use std::io::Write;
use std::ops::{Add, AddAssign, Mul};

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError};

use crate::render::RenderError;

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

/// A colour of sRGB (IEC 61966-2-1): red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SrgbColor(pub [u8; 3]);

impl SrgbColor {
    /// The colours of bodies, in their order; a thirteenth body has the first again.
    ///
    /// The first eight are those of Okabe and Ito ("Color Universal Design", 2008), ordered so that
    /// neighbours differ most, and lightened where shading would make them black. The last four lie
    /// between their hues, and differ in lightness too.
    pub const BODIES: [Self; 12] = [
        Self([0x4A, 0x9B, 0xD4]),
        Self([0xE8, 0xA3, 0x1E]),
        Self([0x1F, 0xA5, 0x7E]),
        Self([0xD0, 0x80, 0xAC]),
        Self([0xEE, 0xE0, 0x5C]),
        Self([0xDC, 0x67, 0x2A]),
        Self([0x33, 0x62, 0xA8]),
        Self([0xA4, 0xA7, 0xAB]),
        Self([0x7A, 0x4F, 0x9E]),
        Self([0x9C, 0xC9, 0x5A]),
        Self([0x8F, 0x5B, 0x3A]),
        Self([0x6F, 0xD0, 0xD2]),
    ];

    /// What lies behind the bodies.
    pub const BACKGROUND: Self = Self([0xF5, 0xF6, 0xF8]);

    /// A point that the budget left undecided.
    pub const UNDECIDED: Self = Self([0xFF, 0x00, 0xFF]);

    /// The colour of body number `index`.
    #[must_use]
    pub fn of_body(index: usize) -> Self {
        Self::BODIES[index % Self::BODIES.len()]
    }

    /// The colour as light.
    pub(crate) fn light(self) -> Light {
        Light(self.0.map(|c| decoded(f64::from(c) / 255.0)))
    }
}

/// An amount of red, green and blue light; 1 is the brightest that a file holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Light(pub(crate) [f64; 3]);

impl Light {
    pub(crate) const NONE: Self = Self([0.0; 3]);

    /// The light of `self` for a share of 0, of `other` for 1.
    pub(crate) fn mixed(self, other: Self, share: f64) -> Self {
        self * (1.0 - share) + other * share
    }

    /// The same amount of every colour.
    pub(crate) fn white(amount: f64) -> Self {
        Self([amount; 3])
    }

    /// The colour; light brighter than a file holds is as bright as it holds.
    pub(crate) fn color(self) -> SrgbColor {
        SrgbColor(self.encoded().map(|c| (255.0 * c).round() as u8))
    }

    /// The numbers of sRGB, from 0 to 1.
    pub(crate) fn encoded(self) -> [f64; 3] {
        self.0.map(|c| encoded(c.clamp(0.0, 1.0)))
    }
}

impl Add for Light {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl AddAssign for Light {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul<f64> for Light {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|c| c * factor))
    }
}

/// The transfer of sRGB; `libm` gives the same bits on every system.
fn encoded(c: f64) -> f64 {
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * libm::pow(c, 1.0 / 2.4) - 0.055 }
}

fn decoded(c: f64) -> f64 {
    if c <= 0.040_45 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod color_tests {
    use super::*;

    #[test]
    fn every_colour_is_light_and_back() {
        for c in 0..=255 {
            let color = SrgbColor([c, 255 - c, c / 2]);
            assert_eq!(color.light().color(), color);
        }
        assert_eq!(Light([2.0, -1.0, 0.0]).color(), SrgbColor([255, 0, 0]));
    }
}
