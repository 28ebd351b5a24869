// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Values and gradients of a field over a window, pixel by pixel.

use crate::drawing::Image;
use crate::error::{LARGEST, PlotError};
use crate::geometry::Point;
use crate::palette::Color;
use crate::slice::{PlaneView, Sampling};

/// The value of a field at a point of a plane, and its gradient there.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SampledSlope {
    /// The value \[m\].
    pub value: f64,
    /// The gradient's parts to the right, up, and towards the viewer
    /// ([`Slice::project_gradient`](crate::Slice::project_gradient)).
    pub gradient: [f64; 3],
}

impl SampledSlope {
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
    /// The pixels of `view` for colours that follow a gradient: [`FINER`] pixels for each cell of
    /// `sampling`.
    pub(crate) fn of(view: &PlaneView, sampling: Sampling) -> Self {
        Self::along(view, (FINER * sampling.cells() as f64).round())
    }

    /// The pixels of `view`, `count` along its longer side.
    pub(crate) fn along(view: &PlaneView, count: f64) -> Self {
        let edge = view.width().max(view.height()) / count;
        let sides = [view.width(), view.height()];
        let count = sides.map(|side| (side / edge).round().max(1.0) as usize);
        Self { min: view.min(), size: [0, 1].map(|i| sides[i] / count[i] as f64), count }
    }

    /// How many there are.
    pub(crate) fn number(&self) -> usize {
        self.count[0] * self.count[1]
    }

    /// The pixels in a row.
    pub(crate) fn width(&self) -> usize {
        self.count[0]
    }

    /// The centres of the pixels, row by row from the top.
    pub(crate) fn rows(&self) -> impl Iterator<Item = Vec<Point>> {
        let Self { min, size, count } = *self;
        let at = move |column: usize, row: usize| {
            let place = [column, row].map(|i| i as f64 + 0.5);
            [0, 1].map(|i| min[i] + place[i] * size[i])
        };
        let row = move |row: usize| (0..count[0]).map(|column| at(column, row)).collect();
        (0..count[1]).rev().map(row)
    }

    /// Evaluates `field` at the centres of the pixels, a row at a time, and colours each by
    /// `color` of its slope.
    ///
    /// # Errors
    ///
    /// [`PlotError::Sample`] for the first value that is not a length, [`PlotError::Gradient`]
    /// for the first gradient without a finite length.
    pub(crate) fn paint(
        &self,
        field: impl FnMut(&[[f64; 2]], &mut [SampledSlope]),
        color: impl Fn(&SampledSlope) -> Color,
    ) -> Result<Image, PlotError> {
        let mut pixels = Vec::with_capacity(self.number());
        self.visit(field, |at, slope| {
            slope.check(at)?;
            pixels.push(color(slope));
            Ok(())
        })?;
        Ok(Image { width: self.width(), pixels })
    }

    /// Evaluates `field` at the centres of the pixels, a row at a time, and shows each place with
    /// what was found to `see`, from the top left corner, until that fails.
    pub(crate) fn visit<T: Clone + Default>(
        &self,
        mut field: impl FnMut(&[[f64; 2]], &mut [T]),
        mut see: impl FnMut(Point, &T) -> Result<(), PlotError>,
    ) -> Result<(), PlotError> {
        let mut found = vec![T::default(); self.width()];
        for points in self.rows() {
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
        let view = PlaneView::new([1.0, 2.0], 0.4, 0.2).unwrap();
        let pixels = Pixels::of(&view, Sampling::new(8).unwrap());
        let places: Vec<Point> = pixels.rows().flatten().collect();
        let image = pixels.paint(|_, _| {}, |_| Color::WHITE).unwrap();
        assert_eq!((image.width, image.height()), (20, 10));
        for (place, expected) in [(places[0], [0.81, 2.09]), (places[199], [1.19, 1.91])] {
            assert!((0..2).all(|i| (place[i] - expected[i]).abs() < 1e-15), "{place:?}");
        }
    }

    #[test]
    fn names_the_place_of_a_bad_gradient() {
        let view = PlaneView::new([0.0, 0.0], 20.0, 20.0).unwrap();
        let pixels = Pixels::of(&view, Sampling::new(8).unwrap());
        let field = |_: &[[f64; 2]], slopes: &mut [SampledSlope]| {
            slopes.fill(SampledSlope { value: 1.0, gradient: [1.0, f64::NAN, 0.0] });
        };
        let error = pixels.paint(field, |_| Color::WHITE).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the gradient is [1.0, NaN, 0.0] at (-9.5, 9.5) m of the plane; it must be finite"
        );
    }
}
