// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Any numbers over a window in place of the bands.

use crate::drawing::Image;
use crate::error::PlotError;
use crate::isolines::{Ground, Isolines};
use crate::legend::{Entry, Key};
use crate::overlay::Measured;
use crate::scale::{self, Ramp, Scale};
use crate::slope::Pixels;

/// Numbers over a window, as colours.
#[derive(Debug, Clone)]
pub(crate) struct Values {
    scale: Scale,
    ramp: Ramp,
    pub(crate) image: Image,
    pub(crate) measured: Option<Measured>,
}

impl Values {
    /// Calls `field` at each pixel.
    fn paint(
        pixels: &Pixels,
        scale: Scale,
        field: impl FnMut(&[[f64; 2]], &mut [Option<f64>]),
    ) -> Result<Self, PlotError> {
        let mut values = Vec::with_capacity(pixels.number());
        pixels.visit(field, |at, value: &Option<f64>| {
            values.push((at, *value));
            value.map_or(Ok(()), |value| PlotError::check_sample(at, value))
        })?;
        let measured = Measured::of(values.iter().copied());
        let largest = measured.map_or(0.0, |m| m.largest.abs().max(m.smallest.abs()));
        let ramp = scale.ramp(largest);
        let colors = values.iter().map(|(_, value)| ramp.color(*value)).collect();
        let image = Image { width: pixels.width(), pixels: colors };
        Ok(Self { scale, ramp, image, measured })
    }

    /// The legend.
    pub(crate) fn entries(&self) -> Vec<Entry> {
        let mut entries = vec![Entry::new(Key::Values(self.ramp), self.scale.label())];
        if self.measured.is_none_or(|measured| measured.open > 0.0) {
            entries.push(Entry::new(Key::Swatch(scale::missing()), self.scale.missing()));
        }
        entries
    }
}

impl Isolines {
    /// With numbers as colours in place of the bands, and the surface as the only line.
    ///
    /// `field` is called with the plane coordinates of some points \[m\] and a slice of the same
    /// length for their numbers; `None` where there is none, which is drawn grey.
    /// [`measured`](Self::measured) gives the extremes.
    ///
    /// # Errors
    ///
    /// [`PlotError::Sample`] for the first number that is NaN, infinite or over 1e150.
    ///
    /// # Examples
    ///
    /// By how much a square's distance exceeds that of the disc in it:
    ///
    /// ```
    /// use palpate_plot::{Isolines, Sampling, Scale, Slice, PlaneView};
    ///
    /// let view = PlaneView::new([0.0, 0.0], 0.2, 0.15)?;
    /// let disc = |p: &[f64; 2]| p[0].hypot(p[1]) - 0.03;
    /// let square = |p: &[f64; 2]| p[0].abs().max(p[1].abs()) - 0.03; // a bound
    /// fn all(f: impl Fn(&[f64; 2]) -> f64) -> impl Fn(&[[f64; 2]], &mut [f64]) {
    ///     move |points, values| points.iter().zip(values).for_each(|(p, v)| *v = f(p))
    /// }
    /// let picture = Isolines::sample(&Slice::planar(), &view, Sampling::default(), all(disc))?;
    /// let difference = |points: &[[f64; 2]], values: &mut [Option<f64>]| {
    ///     points.iter().zip(values).for_each(|(p, v)| *v = Some(square(p) - disc(p)));
    /// };
    /// let picture = picture.with_values(Scale::signed("square less disc", "m"), difference)?;
    /// let measured = picture.measured().unwrap();
    /// assert!(measured.largest <= 0.0 && measured.largest > -1e-4); // equal along the axes
    /// assert!(measured.smallest < -0.03); // in the corners
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    pub fn with_values(
        mut self,
        scale: Scale,
        field: impl FnMut(&[[f64; 2]], &mut [Option<f64>]),
    ) -> Result<Self, PlotError> {
        let values = Values::paint(&self.pixels, scale, field)?;
        self.ground = Ground::Values(Box::new(values));
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Figure, PlaneView, Sampling, Slice};

    fn disc() -> Isolines {
        let view = PlaneView::new([0.0, 0.0], 4.0, 4.0).unwrap();
        let values = |points: &[[f64; 2]], values: &mut [f64]| {
            points.iter().zip(values).for_each(|(p, value)| *value = p[0].hypot(p[1]) - 1.0);
        };
        Isolines::sample(&Slice::planar(), &view, Sampling::new(100).unwrap(), values).unwrap()
    }

    /// The half plane x < 0 has no numbers; those of the other are x.
    fn half(scale: Scale, factor: f64) -> Isolines {
        let field = |points: &[[f64; 2]], values: &mut [Option<f64>]| {
            for (p, value) in points.iter().zip(values) {
                *value = (p[0] > 0.0).then_some(factor * p[0]);
            }
        };
        disc().with_values(scale, field).unwrap()
    }

    #[test]
    fn extremes_and_missing_numbers_are_told() {
        let scale = Scale::signed("x", "m").with_missing("nothing");
        let picture = half(scale, 1.0);
        let measured = picture.measured().unwrap();
        // Centres of pixels of 16 mm: 4 m in 250.
        assert!((measured.largest - 1.992).abs() < 1e-12, "{measured:?}");
        assert!((measured.smallest - 0.008).abs() < 1e-12, "{measured:?}");
        assert!((measured.largest_at[0] - 1.992).abs() < 1e-12);
        let Ground::Values(values) = &picture.ground else { panic!("other colours") };
        let texts: Vec<_> = values.entries().into_iter().map(|entry| entry.text).collect();
        assert_eq!(texts, ["x [m]", "nothing"]);
        assert_eq!(picture.pixels(), 250 * 250);
        let coarse = picture.with_pixels(Sampling::new(10).unwrap());
        assert_eq!(coarse.pixels(), 10 * 10);
    }

    #[test]
    fn a_number_that_is_none_is_named_by_its_place() {
        let scale = Scale::decades("error", "degrees", 0.1, 1.0).unwrap();
        let field = |_: &[[f64; 2]], values: &mut [Option<f64>]| values.fill(Some(f64::NAN));
        let error = disc().with_values(scale, field).unwrap_err().to_string();
        assert_eq!(
            error,
            "the field is NaN at (-1.992, 1.992) m of the plane; it must be finite"
        );
    }

    /// Two pictures share the entry of a scale if its ends are the same.
    #[test]
    fn scales_of_other_ends_have_entries_of_their_own() {
        let scale = || Scale::signed("x", "m");
        let count = |factor: f64| {
            let tiles = [half(scale(), 1.0), half(scale(), factor)];
            let svg = Figure::new("").with_sheet(2, tiles).to_svg();
            svg.matches("aria-label=\"x [m]\"").count()
        };
        assert_eq!((count(1.0), count(10.0)), (1, 2));
    }
}
