// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Values and gradients of a field over a window, pixel by pixel.

use crate::drawing::Image;
use crate::error::{LARGEST, PlotError};
use crate::geometry::Point;
use crate::palette::Color;
use crate::sampling::Sampling;
use crate::view::View;

/// The value of a field at a point of a plane, and its gradient there.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Slope {
    /// The value \[m\].
    pub value: f64,
    /// The gradient's parts to the right, up, and towards the viewer
    /// ([`Slice::project_gradient`](crate::Slice::project_gradient)).
    pub gradient: [f64; 3],
}

impl Slope {
    /// The length of the gradient.
    #[must_use]
    pub fn steepness(&self) -> f64 {
        let [x, y, z] = self.gradient;
        x.hypot(y).hypot(z)
    }

    /// Refuses a slope at the point `at` that is not a number, or beyond all numbers drawn.
    ///
    /// # Errors
    ///
    /// [`PlotError::Sample`] or [`PlotError::Gradient`].
    pub(crate) fn check(&self, at: Point) -> Result<(), PlotError> {
        let Self { value, gradient } = *self;
        PlotError::check_sample(at, value)?;
        if gradient.iter().any(|x| x.is_nan() || x.abs() > LARGEST) {
            return Err(PlotError::Gradient { at, gradient });
        }
        Ok(())
    }
}

/// Pixels for each cell of the grid of isolines. Lines are interpolated between samples but
/// colours are not, so colours need more samples.
const FINER: f64 = 2.5;

/// A grid of pixels that covers a window exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pixels {
    min: Point,
    size: [f64; 2],
    count: [usize; 2],
}

impl Pixels {
    /// The pixels of `view`: [`FINER`] pixels for each cell of `sampling`.
    pub(crate) fn of(view: &View, sampling: Sampling) -> Self {
        let cells = (FINER * sampling.cells() as f64).round();
        let edge = view.width().max(view.height()) / cells;
        let sides = [view.width(), view.height()];
        let count = sides.map(|side| (side / edge).round().max(1.0) as usize);
        Self { min: view.min(), size: [0, 1].map(|i| sides[i] / count[i] as f64), count }
    }

    /// Evaluates `field` at the centres of the pixels, a row at a time, and colours each by
    /// `color` of its place and slope.
    ///
    /// # Errors
    ///
    /// [`PlotError::Sample`] for the first value that is not a length, [`PlotError::Gradient`]
    /// for the first gradient without a finite length.
    pub(crate) fn paint(
        &self,
        field: impl FnMut(&[[f64; 2]], &mut [Slope]),
        mut color: impl FnMut(Point, &Slope) -> Color,
    ) -> Result<Image, PlotError> {
        let mut pixels = Vec::with_capacity(self.number());
        self.visit(field, |at, slope| {
            slope.check(at)?;
            pixels.push(color(at, slope));
            Ok(())
        })?;
        Ok(Image { width: self.width(), pixels })
    }

    /// How many there are.
    pub(crate) fn number(&self) -> usize {
        self.count[0] * self.count[1]
    }

    /// Pixels in a row.
    pub(crate) fn width(&self) -> usize {
        self.count[0]
    }

    /// Evaluates `field` at the centres of the pixels, a row at a time, and shows each place with
    /// what was found to `see`, from the top left corner, until that fails.
    pub(crate) fn visit<T: Clone + Default>(
        &self,
        mut field: impl FnMut(&[[f64; 2]], &mut [T]),
        mut see: impl FnMut(Point, &T) -> Result<(), PlotError>,
    ) -> Result<(), PlotError> {
        let [width, height] = self.count;
        let mut points = vec![[0.0; 2]; width];
        let mut found = vec![T::default(); width];
        for row in (0..height).rev() {
            for (column, p) in points.iter_mut().enumerate() {
                let place = [column, row].map(|i| i as f64 + 0.5);
                *p = [0, 1].map(|i| self.min[i] + place[i] * self.size[i]);
            }
            field(&points, &mut found);
            for (&at, found) in points.iter().zip(&found) {
                see(at, found)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_cover_the_window_from_its_top_left_corner() {
        let view = View::new([1.0, 2.0], 0.4, 0.2).unwrap();
        let pixels = Pixels::of(&view, Sampling::new(8).unwrap());
        let mut places = Vec::new();
        let color = |at: Point, _: &Slope| {
            places.push(at);
            Color::WHITE
        };
        let image = pixels.paint(|_, _| {}, color).unwrap();
        assert_eq!((image.width, image.height()), (20, 10));
        for (place, expected) in [(places[0], [0.81, 2.09]), (places[199], [1.19, 1.91])] {
            assert!((0..2).all(|i| (place[i] - expected[i]).abs() < 1e-15), "{place:?}");
        }
    }

    #[test]
    fn names_the_place_of_a_bad_gradient() {
        let view = View::new([0.0, 0.0], 20.0, 20.0).unwrap();
        let pixels = Pixels::of(&view, Sampling::new(8).unwrap());
        let field = |_: &[[f64; 2]], slopes: &mut [Slope]| {
            slopes.fill(Slope { value: 1.0, gradient: [1.0, f64::NAN, 0.0] });
        };
        let error = pixels.paint(field, |_, _| Color::WHITE).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the gradient is [1.0, NaN, 0.0] at (-9.5, 9.5) m of the plane; it must be finite"
        );
    }
}
