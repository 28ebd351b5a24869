// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The window of a plane that a picture shows.

use crate::error::{PlotError, finite};
use crate::slice::Slice;

/// Shortest side of a window [m]. Below a nanometre there is nothing to touch.
pub(crate) const MIN_SIZE: f64 = 1e-9;
/// Longest side of a window [m].
pub(crate) const MAX_SIZE: f64 = 1e9;
/// Largest ratio of the sides: a sliver has no room for its labels.
pub(crate) const MAX_ASPECT: f64 = 20.0;
/// Largest ratio of a window's distance from the origin to its size: neighbours of 400 cells
/// then still differ by thousands of roundings.
const MAX_DISTANCE: f64 = 1e9;

/// A window of a [`Slice`]: centre, width and height in plane coordinates \[m\].
///
/// # Examples
///
/// ```
/// use palpate_plot::PlaneView;
///
/// let view = PlaneView::new([0.1, 0.0], 0.4, 0.3)?;
/// assert_eq!((view.min(), view.max()), ([-0.1, -0.15], [0.30000000000000004, 0.15]));
///
/// let error = PlaneView::new([0.0, 0.0], -0.2, 0.3).unwrap_err();
/// assert_eq!(error.to_string(), "view width must be between 1e-9 m and 1e9 m, got -0.2 m");
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneView {
    center: [f64; 2],
    size: [f64; 2],
}

impl PlaneView {
    /// The window of `width` by `height` \[m\] around `center`.
    ///
    /// # Errors
    ///
    /// [`PlotError::NotFinite`] for the centre, [`PlotError::ViewSize`] for a side outside
    /// 1e-9 m to 1e9 m, [`PlotError::ViewAspect`] for sides that differ more than 20 times,
    /// [`PlotError::ViewFar`] for a centre over 1e9 times the shorter side away.
    pub fn new(center: [f64; 2], width: f64, height: f64) -> Result<Self, PlotError> {
        for x in center {
            finite("the centre of a view", x)?;
        }
        for (side, size) in [("width", width), ("height", height)] {
            if !(MIN_SIZE..=MAX_SIZE).contains(&size) {
                return Err(PlotError::ViewSize { side, size });
            }
        }
        let shorter = width.min(height);
        if width.max(height) > MAX_ASPECT * shorter {
            return Err(PlotError::ViewAspect { width, height });
        }
        if center.iter().any(|x| x.abs() > MAX_DISTANCE * shorter) {
            return Err(PlotError::ViewFar { center, size: shorter });
        }
        Ok(Self { center, size: [width, height] })
    }

    /// The window around the box from `min` to `max` in plane coordinates \[m\], with `margin`
    /// times its longer side added on each side.
    ///
    /// A flat box is widened to a quarter of its length.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new), of the window with its margin. A box whose `max` is below its
    /// `min`, or a single point, is [`PlotError::ViewSize`].
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::PlaneView;
    ///
    /// let view = PlaneView::from_bounds([0.0, 0.0], [2.0, 1.0], 0.25)?;
    /// assert_eq!((view.center(), view.width(), view.height()), ([1.0, 0.5], 3.0, 2.0));
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    pub fn from_bounds(min: [f64; 2], max: [f64; 2], margin: f64) -> Result<Self, PlotError> {
        let [width, height] = [max[0] - min[0], max[1] - min[1]];
        let longer = width.max(height);
        let side = |size: f64| {
            if size >= 0.0 { size.max(longer / 4.0) + 2.0 * margin * longer } else { size }
        };
        let center = [0, 1].map(|i| min[i] / 2.0 + max[i] / 2.0);
        Self::new(center, side(width), side(height))
    }

    /// The window of `slice` that shows the projection of the box from `min` to `max` in space
    /// \[m\], with `margin` times its longer side added on each side.
    ///
    /// # Errors
    ///
    /// As [`from_bounds`](Self::from_bounds).
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::{Slice, PlaneView};
    ///
    /// let view = PlaneView::of_box(&Slice::xz(0.0)?, [0.0; 3], [2.0, 9.0, 1.0], 0.0)?;
    /// assert_eq!(view.center(), [1.0, -0.5]); // seen from above, z runs down the page
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    pub fn of_box(
        slice: &Slice,
        min: [f64; 3],
        max: [f64; 3],
        margin: f64,
    ) -> Result<Self, PlotError> {
        for x in min.into_iter().chain(max) {
            finite("a corner of a box", x)?;
        }
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for corner in 0..8 {
            let at = |i: usize| if corner >> i & 1 == 0 { min[i] } else { max[i] };
            let p = slice.project([at(0), at(1), at(2)]);
            for i in 0..2 {
                low[i] = low[i].min(p[i]);
                high[i] = high[i].max(p[i]);
            }
        }
        Self::from_bounds(low, high, margin)
    }

    /// Centre, in plane coordinates \[m\].
    #[must_use]
    pub fn center(&self) -> [f64; 2] {
        self.center
    }

    /// Width \[m\].
    #[must_use]
    pub fn width(&self) -> f64 {
        self.size[0]
    }

    /// Height \[m\].
    #[must_use]
    pub fn height(&self) -> f64 {
        self.size[1]
    }

    /// Lower left corner, in plane coordinates \[m\].
    #[must_use]
    pub fn min(&self) -> [f64; 2] {
        [0, 1].map(|i| self.center[i] - self.size[i] / 2.0)
    }

    /// Upper right corner, in plane coordinates \[m\].
    #[must_use]
    pub fn max(&self) -> [f64; 2] {
        [0, 1].map(|i| self.center[i] + self.size[i] / 2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_windows_without_extent() {
        for size in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-10, 1e10] {
            assert!(PlaneView::new([0.0; 2], size, 1.0).is_err(), "{size}");
            assert!(PlaneView::new([0.0; 2], 1.0, size).is_err(), "{size}");
        }
        assert!(PlaneView::new([f64::NAN, 0.0], 1.0, 1.0).is_err());
        assert!(PlaneView::new([1e12, 0.0], 1.0, 1.0).is_err());
        assert!(PlaneView::new([0.0; 2], 1.0, 30.0).is_err());
        assert!(PlaneView::from_bounds([1.0; 2], [0.0; 2], 0.1).is_err());
        assert!(PlaneView::from_bounds([1.0; 2], [1.0; 2], 0.1).is_err());
    }

    #[test]
    fn widens_flat_boxes() {
        let view = PlaneView::from_bounds([0.0, 1.0], [2.0, 1.0], 0.0).unwrap();
        assert_eq!((view.width(), view.height()), (2.0, 0.5));
    }
}
