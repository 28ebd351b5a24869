// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A legend, points and arrows, to be laid over a picture of pixels.

use crate::drawing::{Drawing, Path};
use crate::error::{PlotError, finite_points};
use crate::geometry::Rect;
use crate::legend::{self, Entry, Key, Symbol, draw_arrow};
use crate::palette::Color;
use crate::png;

/// The height of a picture in whose pixels texts have their usual size.
const USUAL_HEIGHT: f64 = 700.0;

/// Between legend and border, at the usual height [px].
const BORDER: f64 = 14.0;

/// A legend, points and arrows, to be laid over a picture of pixels that was made elsewhere.
///
/// Places are in pixels from the left and upper edge of the picture.
///
/// # Examples
///
/// ```
/// use palpate_plot::{Color, PixelLayer};
///
/// let layer = PixelLayer::new(320, 240).with_entry(Color::GREEN, "ball");
/// let pixels = layer.pixels()?;
/// assert_eq!(pixels.len(), 320 * 240);
/// assert_eq!(pixels[0], [0, 0, 0, 0]); // nothing is drawn here
/// assert_eq!(layer.legend_height(), 240.0 / 700.0 * 50.0);
/// let pixels = layer.with_band(Color::rgb(255, 255, 255)).pixels()?;
/// assert_eq!((pixels[0], pixels[320 * 239]), ([0, 0, 0, 0], [255, 255, 255, 255]));
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone)]
pub struct PixelLayer {
    size: [u32; 2],
    band: Option<Color>,
    entries: Vec<Entry>,
    points: Vec<([f64; 2], Color)>,
    arrows: Vec<([[f64; 2]; 2], Color)>,
}

impl PixelLayer {
    /// Nothing yet, over a picture of this size [px].
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        let size = [width, height];
        let (entries, points, arrows) = (Vec::new(), Vec::new(), Vec::new());
        Self { size, band: None, entries, points, arrows }
    }

    /// With an entry of the legend: a colour and what has it.
    #[must_use]
    pub fn with_entry(mut self, color: Color, text: impl Into<String>) -> Self {
        self.entries.push(Entry::new(Key::Swatch(color), text));
        self
    }

    /// With the legend on a band of this colour, as wide as the picture, which hides what is below.
    #[must_use]
    pub fn with_band(self, color: Color) -> Self {
        Self { band: Some(color), ..self }
    }

    /// With words in the legend.
    #[must_use]
    pub fn with_words(mut self, text: impl Into<String>) -> Self {
        self.entries.push(Entry::new(Key::None, text));
        self
    }

    /// With points, which the legend calls `name`.
    ///
    /// # Errors
    ///
    /// [`PlotError::Point`].
    pub fn with_points(
        mut self,
        name: &str,
        color: Color,
        points: Vec<[f64; 2]>,
    ) -> Result<Self, PlotError> {
        finite_points(name, &points)?;
        self.entries.push(Entry::new(Key::Point(Symbol::Disc, color), name));
        self.points.extend(points.into_iter().map(|point| (point, color)));
        Ok(self)
    }

    /// With arrows from tails to tips, which the legend calls `name`.
    ///
    /// # Errors
    ///
    /// [`PlotError::Point`].
    pub fn with_arrows(
        mut self,
        name: &str,
        color: Color,
        arrows: Vec<[[f64; 2]; 2]>,
    ) -> Result<Self, PlotError> {
        finite_points(name, arrows.as_flattened())?;
        self.entries.push(Entry::new(Key::Arrow(color, 24.0), name));
        self.arrows.extend(arrows.into_iter().map(|arrow| (arrow, color)));
        Ok(self)
    }

    /// The height of the legend below a picture, with borders [px].
    #[must_use]
    pub fn legend_height(&self) -> f64 {
        if self.entries.is_empty() { 0.0 } else { self.scale() * (self.rows() + 2.0 * BORDER) }
    }

    /// Pixels for each of the drawing.
    fn scale(&self) -> f64 {
        f64::from(self.size[1]) / USUAL_HEIGHT
    }

    /// The width of the legend, in the drawing.
    fn room(&self) -> f64 {
        f64::from(self.size[0]) / self.scale() - 2.0 * BORDER
    }

    /// The height of the rows of the legend, in the drawing.
    fn rows(&self) -> f64 {
        legend::draw(&mut Drawing::default(), &self.entries, [0.0; 2], self.room())
    }

    /// Red, green, blue and opacity of each pixel, row by row from the upper left.
    ///
    /// # Errors
    ///
    /// [`PlotError::PictureSize`] if there are no pixels.
    pub fn pixels(&self) -> Result<Vec<[u8; 4]>, PlotError> {
        let scale = self.scale();
        let [width, height] = self.size.map(|side| f64::from(side) / scale);
        let mut drawing = Drawing { width, height, ..Drawing::default() };
        let place = |point: [f64; 2]| point.map(|x| x / scale);
        for ([tail, tip], color) in &self.arrows {
            draw_arrow(&mut drawing, place(*tail), place(*tip), *color);
        }
        for (point, color) in &self.points {
            Symbol::Disc.draw(&mut drawing, place(*point), *color);
        }
        let below = self.legend_height() / scale;
        if let Some(color) = self.band {
            let band = Rect::new(0.0, height - below, width, below);
            drawing.fill(Path::rect(&band), color);
        }
        let corner = [BORDER, height - BORDER - self.rows()];
        legend::draw(&mut drawing, &self.entries, corner, self.room());
        png::transparent(&drawing, self.size, scale).ok_or(PlotError::PictureSize {
            width: self.size[0],
            height: f64::from(self.size[1]),
            min: 1,
            max: png::MAX_SIDE,
        })
    }
}
