// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Values of a field on a grid over the window.

use crate::error::PlotError;
use crate::geometry::Point;
use crate::view::PlaneView;

/// How finely a field is sampled for a picture.
///
/// # Examples
///
/// ```
/// use palpate_plot::Sampling;
///
/// let fine = Sampling::new(1200)?;
/// let error = Sampling::new(2).unwrap_err().to_string();
/// assert_eq!(error, "a picture is sampled with 8 to 4096 cells a side, got 2");
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    cells: usize,
}

impl Sampling {
    /// Fewest cells: what a golden test can print.
    const MIN: usize = 8;
    /// Most cells: 16 million samples.
    const MAX: usize = 4096;

    /// Samples with `cells` cells along the longer side of the window.
    ///
    /// # Errors
    ///
    /// [`PlotError::Cells`] outside 8 to 4096.
    pub fn new(cells: usize) -> Result<Self, PlotError> {
        if (Self::MIN..=Self::MAX).contains(&cells) {
            Ok(Self { cells })
        } else {
            Err(PlotError::Cells { cells, min: Self::MIN, max: Self::MAX })
        }
    }
}

impl Sampling {
    /// Cells along the longer side.
    pub(crate) fn cells(self) -> usize {
        self.cells
    }
}

impl Default for Sampling {
    /// 420 cells: two pixels each at 800 px, and isolines off by well under one.
    fn default() -> Self {
        Self { cells: 420 }
    }
}

/// Values at the centres of square cells that cover a window and one cell around it.
#[derive(Debug, Clone)]
pub(crate) struct Samples {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    /// Edge of a cell [m].
    pub(crate) cell: f64,
    /// Lower left corner of the grid, a cell outside the window [m].
    pub(crate) origin: Point,
    /// Row by row from the bottom, left to right [m].
    pub(crate) values: Vec<f64>,
}

impl Samples {
    /// Samples `field`, row by row.
    ///
    /// # Errors
    ///
    /// [`PlotError::Sample`] for the first value that is not a length.
    pub(crate) fn new(
        view: &PlaneView,
        sampling: Sampling,
        mut field: impl FnMut(&[[f64; 2]], &mut [f64]),
    ) -> Result<Self, PlotError> {
        let cell = view.width().max(view.height()) / sampling.cells as f64;
        // At least the window, and a border whose contours are clipped away.
        let count = |size: f64| (size / cell - 1e-6).ceil().max(1.0) as usize + 2;
        let (columns, rows) = (count(view.width()), count(view.height()));
        let origin = view.min().map(|x| x - cell);
        let mut values = vec![0.0; columns * rows];
        let mut points = vec![[0.0; 2]; columns];
        for (row, out) in values.chunks_exact_mut(columns).enumerate() {
            for (column, p) in points.iter_mut().enumerate() {
                *p = [
                    origin[0] + (column as f64 + 0.5) * cell,
                    origin[1] + (row as f64 + 0.5) * cell,
                ];
            }
            field(&points, out);
            for (&at, &value) in points.iter().zip(&*out) {
                PlotError::check_sample(at, value)?;
            }
        }
        Ok(Self { columns, rows, cell, origin, values })
    }

    /// The samples of the field with the other sign.
    pub(crate) fn negated(&self) -> Self {
        Self { values: self.values.iter().map(|value| -value).collect(), ..*self }
    }

    /// Whether the field is nowhere negative, but zero somewhere as far as samples can tell.
    ///
    /// Where a distance is zero, the nearest sample is at most half a cell's diagonal away.
    pub(crate) fn has_thin_surface(&self) -> bool {
        let low = self.range().0;
        low >= 0.0 && low <= std::f64::consts::FRAC_1_SQRT_2 * self.cell
    }

    /// Smallest and largest value [m].
    pub(crate) fn range(&self) -> (f64, f64) {
        self.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| {
            (low.min(v), high.max(v))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_cover_the_window() {
        let view = PlaneView::new([1.0, 2.0], 0.4, 0.3).unwrap();
        let samples = Samples::new(&view, Sampling::new(40).unwrap(), |points, out| {
            for (p, v) in points.iter().zip(out) {
                *v = p[0] + 100.0 * p[1];
            }
        })
        .unwrap();
        assert_eq!((samples.columns, samples.rows), (42, 32));
        let first = 0.795 + 100.0 * 1.845;
        assert!((samples.values[0] - first).abs() < 1e-12);
        assert!((samples.range().1 - (1.205 + 100.0 * 2.155)).abs() < 1e-9);
    }

    #[test]
    fn names_the_place_of_a_bad_sample() {
        let view = PlaneView::new([0.0, 0.0], 8.0, 8.0).unwrap();
        let sampling = Sampling::new(8).unwrap();
        let error = Samples::new(&view, sampling, |points, out| {
            for (p, v) in points.iter().zip(out) {
                *v = if p[0] > 2.0 && p[1] > 1.0 { f64::NAN } else { 0.0 };
            }
        })
        .unwrap_err();
        assert_eq!(
            error.to_string(),
            "the field is NaN at (2.5, 1.5) m of the plane; it must be finite"
        );
        for value in [f64::INFINITY, -1e200] {
            assert!(Samples::new(&view, sampling, |_, out| out.fill(value)).is_err());
        }
    }
}
