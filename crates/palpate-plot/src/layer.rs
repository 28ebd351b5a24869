// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A legend, points and arrows, to be laid over a picture of pixels.

use crate::drawing::Drawing;
use crate::error::{PlotError, finite_points};
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
/// use palpate_plot::{Color, Layer};
///
/// let layer = Layer::new(320, 240).with_entry(Color::GREEN, "ball");
/// let pixels = layer.pixels()?;
/// assert_eq!(pixels.len(), 320 * 240);
/// assert_eq!(pixels[0], [0, 0, 0, 0]); // nothing is drawn here
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Layer {
    size: [u32; 2],
    entries: Vec<Entry>,
    points: Vec<([f64; 2], Color)>,
    arrows: Vec<([[f64; 2]; 2], Color)>,
}

impl Layer {
    /// Nothing yet, over a picture of this size [px].
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        let size = [width, height];
        Self { size, entries: Vec::new(), points: Vec::new(), arrows: Vec::new() }
    }

    /// With an entry of the legend: a colour and what has it.
    #[must_use]
    pub fn with_entry(mut self, color: Color, text: impl Into<String>) -> Self {
        self.entries.push(Entry::new(Key::Swatch(color), text));
        self
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

    /// Red, green, blue and opacity of each pixel, row by row from the upper left.
    ///
    /// # Errors
    ///
    /// [`PlotError::PictureSize`] if there are no pixels.
    pub fn pixels(&self) -> Result<Vec<[u8; 4]>, PlotError> {
        let scale = f64::from(self.size[1]) / USUAL_HEIGHT;
        let [width, height] = self.size.map(|side| f64::from(side) / scale);
        let mut drawing = Drawing { width, height, ..Drawing::default() };
        let place = |point: [f64; 2]| point.map(|x| x / scale);
        for ([tail, tip], color) in &self.arrows {
            draw_arrow(&mut drawing, place(*tail), place(*tip), *color);
        }
        for (point, color) in &self.points {
            Symbol::Disc.draw(&mut drawing, place(*point), *color);
        }
        let room = width - 2.0 * BORDER;
        let rows = legend::draw(&mut Drawing::default(), &self.entries, [0.0; 2], room);
        let corner = [BORDER, height - BORDER - rows];
        legend::draw(&mut drawing, &self.entries, corner, room);
        png::transparent(&drawing, self.size, scale).ok_or(PlotError::PictureSize {
            width: self.size[0],
            height: f64::from(self.size[1]),
            min: 1,
            max: png::MAX_SIDE,
        })
    }
}
