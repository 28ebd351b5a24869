// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The picture of a field in a plane: bands, isolines, bodies and overlays.

mod draw;

use crate::body_picture::DrawnBody;
use crate::drawing::Image;
use crate::error::PlotError;
use crate::outline::SurfaceLines;
use crate::overlay::{Arrows, Markers, Measured, Overlay, Polyline};
use crate::palette::Color;
use crate::scale::Levels;
use crate::slice::{PlaneView, Samples, Sampling, Slice};
use crate::slope::{Pixels, SampledSlope};
use crate::trust::{Comparison, Promised, Trust};
use crate::values::Values;
use crate::wheel;

pub(crate) use draw::{ABOVE_LEGEND, MOST_HEIGHT};

/// Bands and isolines of a field in a window of a plane, with overlays.
///
/// Blue bands are inside (negative values), orange ones outside, lighter with the value; the
/// heavy line is the surface, where the field is zero. Thin isolines at round levels carry
/// their value in metres. A surface without interior, such as a curve or a sheet, is drawn too:
/// if no sample is negative and one is within half a cell's diagonal of zero, the surface is what
/// lies within a cell of zero.
///
/// # Examples
///
/// A disc of 3 cm, with a point on it:
///
/// ```
/// use palpate_plot::{Figure, Isolines, Markers, Sampling, Slice, PlaneView};
///
/// let view = PlaneView::new([0.0, 0.0], 0.2, 0.15)?;
/// let disc = |points: &[[f64; 2]], values: &mut [f64]| {
///     for (p, value) in points.iter().zip(values) {
///         *value = p[0].hypot(p[1]) - 0.03;
///     }
/// };
/// let isolines = Isolines::sample(&Slice::planar(), &view, Sampling::default(), disc)?
///     .with_step(0.01)?
///     .with_markers(Markers::new("contact", [[0.03, 0.0]])?);
/// let svg = Figure::new("Disc").with_isolines(isolines).to_svg();
/// assert!(svg.starts_with("<svg"));
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Isolines {
    slice: Slice,
    pub(crate) view: PlaneView,
    samples: Samples,
    outline: SurfaceLines,
    bodies: Vec<DrawnBody>,
    is_in_ink: bool,
    levels: Levels,
    pub(crate) pixels: Pixels,
    pub(crate) ground: Ground,
    title: String,
    pub(crate) overlays: Vec<Overlay>,
}

/// The ground below the lines.
#[derive(Debug, Clone)]
pub(crate) enum Ground {
    /// Bands of distance, with isolines.
    Distance,
    /// The direction of the gradient, and how it was found if not from the field.
    Gradient(Image, Option<String>),
    /// Promises, and how values compare with them.
    Promise(Box<Trust>),
    /// Other numbers.
    Values(Box<Values>),
}

impl Isolines {
    /// Samples `field` in the window `view` of `slice`.
    ///
    /// `field` is called with the plane coordinates of some points \[m\] and a slice of the
    /// same length for their values \[m\]; [`Slice::point`] gives the points in space. Points
    /// lie up to a cell outside the window.
    ///
    /// # Errors
    ///
    /// [`PlotError::Sample`] for the first value that is NaN, infinite or over 1e150.
    pub fn sample(
        slice: &Slice,
        view: &PlaneView,
        sampling: Sampling,
        field: impl FnMut(&[[f64; 2]], &mut [f64]),
    ) -> Result<Self, PlotError> {
        let samples = Samples::new(view, sampling, field)?;
        let (low, high) = samples.range();
        Ok(Self {
            slice: slice.clone(),
            view: *view,
            levels: Levels::choose(low, high, view.width().min(view.height())),
            outline: SurfaceLines::of_samples(&samples),
            bodies: Vec::new(),
            is_in_ink: false,
            samples,
            pixels: Pixels::of(view, sampling),
            ground: Ground::Distance,
            title: String::new(),
            overlays: Vec::new(),
        })
    }

    /// With this surface, [followed](SurfaceLines::follow) in the same window, instead of the one that
    /// the samples show.
    #[must_use]
    pub fn with_outline(self, outline: SurfaceLines) -> Self {
        Self { outline, ..self }
    }

    /// With the bodies of which this is the union. If there are several, each has a colour, and
    /// what lies in more than one is hatched; one alone is drawn as without it, and named. Their
    /// surfaces, [followed](SurfaceLines::follow) in the same window, are drawn instead of that of the
    /// union.
    ///
    /// The first twelve bodies have colours of their own; the thirteenth has that of the first,
    /// and so on. Outlines that run together differ in width and dash too.
    #[must_use]
    pub fn with_bodies(self, bodies: impl IntoIterator<Item = DrawnBody>) -> Self {
        Self { bodies: bodies.into_iter().collect(), ..self }
    }

    /// With all bodies in ink, for pictures in which colours tell something else apart.
    #[must_use]
    pub fn in_ink(self) -> Self {
        Self { is_in_ink: true, ..self }
    }

    /// With isolines at multiples of `step` \[m\] instead of a round step that gives about ten.
    ///
    /// # Errors
    ///
    /// [`PlotError::Step`] if it is not positive, [`PlotError::TooManyLevels`] above 200.
    pub fn with_step(self, step: f64) -> Result<Self, PlotError> {
        let (low, high) = self.samples.range();
        Ok(Self { levels: Levels::with_step(low, high, step)?, ..self })
    }

    /// With the direction of the gradient as colour in place of the bands, and the surface as
    /// the only line.
    ///
    /// Lightness and hue show the direction in which the field grows in the plane; the disc in
    /// the legend explains them. Colours fade to grey where the gradient's part in the plane is
    /// shorter than one, because the field is flat or the gradient leans out of the plane. They
    /// darken where it is longer.
    ///
    /// `field` is called with the plane coordinates of some points \[m\] and a slice of the
    /// same length for their [`SampledSlope`]s.
    ///
    /// # Errors
    ///
    /// [`PlotError::Sample`] for the first value that is NaN, infinite or over 1e150,
    /// [`PlotError::Gradient`] for the first such gradient.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::{Figure, Isolines, Sampling, Slice, SampledSlope, PlaneView};
    ///
    /// let view = PlaneView::new([0.0, 0.0], 0.2, 0.15)?;
    /// let disc = |p: [f64; 2]| {
    ///     let r = p[0].hypot(p[1]);
    ///     SampledSlope { value: r - 0.03, gradient: [p[0] / r, p[1] / r, 0.0] }
    /// };
    /// let values = |points: &[[f64; 2]], values: &mut [f64]| {
    ///     points.iter().zip(values).for_each(|(p, value)| *value = disc(*p).value);
    /// };
    /// let slopes = |points: &[[f64; 2]], slopes: &mut [SampledSlope]| {
    ///     points.iter().zip(slopes).for_each(|(p, slope)| *slope = disc(*p));
    /// };
    /// let picture = Isolines::sample(&Slice::planar(), &view, Sampling::default(), values)?
    ///     .with_gradient(slopes)?;
    /// let svg = Figure::new("Disc").with_isolines(picture).to_svg();
    /// assert!(svg.contains("direction in which the field grows"));
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    pub fn with_gradient(
        self,
        field: impl FnMut(&[[f64; 2]], &mut [SampledSlope]),
    ) -> Result<Self, PlotError> {
        let image = self.pixels.paint(field, wheel_color)?;
        Ok(Self { ground: Ground::Gradient(image, None), ..self })
    }

    /// As [`with_gradient`](Self::with_gradient), with directions that were found in another way
    /// than from the field: the legend says that they are those of `method`. Where it finds none,
    /// the slope's gradient is zero.
    ///
    /// # Errors
    ///
    /// As of [`with_gradient`](Self::with_gradient).
    pub fn with_directions(
        self,
        method: impl Into<String>,
        field: impl FnMut(&[[f64; 2]], &mut [SampledSlope]),
    ) -> Result<Self, PlotError> {
        let image = self.pixels.paint(field, wheel_color)?;
        Ok(Self { ground: Ground::Gradient(image, Some(method.into())), ..self })
    }

    /// With `grid` pixels along the longer side for [gradients](Self::with_gradient),
    /// [directions](Self::with_directions) and [numbers](Self::with_values) that are drawn
    /// afterwards, instead of 2.5 pixels for each cell of the isolines: fewer for what takes long
    /// to find.
    #[must_use]
    pub fn with_pixels(self, grid: Sampling) -> Self {
        Self { pixels: self.compared(grid), ..self }
    }

    /// The places whose values [`with_promise`](Self::with_promise) compares, in plane
    /// coordinates \[m\]: the centres of equal rectangles that cover the window, about as many
    /// along its longer side as `grid` has cells, row by row from the top.
    #[must_use]
    pub fn compared_places(&self, grid: Sampling) -> Vec<[f64; 2]> {
        self.compared(grid).rows().flatten().collect()
    }

    fn compared(&self, grid: Sampling) -> Pixels {
        Pixels::along(&self.view, grid.cells() as f64)
    }

    /// With the promises in place of the bands, and the surface as the only line.
    ///
    /// Each side of the surface has the tint and hatching of what is `promised` outside and
    /// inside. The tint itself means that the value is the true distance. Darker means that the
    /// value is less, redder that it is more. Grey means that this is open: the bounds of value
    /// over distance are more than 0.1 apart. Of the ratios that the bounds allow, the one nearest
    /// to one is shown, so what has another colour than the tint is certain.
    ///
    /// `comparisons` are those at the [`compared_places`](Self::compared_places) of `grid`.
    ///
    /// # Errors
    ///
    /// [`PlotError::Comparisons`] if there are more or fewer comparisons than places.
    ///
    /// # Examples
    ///
    /// Half the distance to a disc is a bound of it:
    ///
    /// ```
    /// use palpate_plot::{Comparison, Isolines, Promised, Sampling, Slice, PlaneView};
    ///
    /// let view = PlaneView::new([0.0, 0.0], 0.2, 0.15)?;
    /// let distance = |p: &[f64; 2]| p[0].hypot(p[1]) - 0.03;
    /// let values = |points: &[[f64; 2]], values: &mut [f64]| {
    ///     points.iter().zip(values).for_each(|(p, value)| *value = 0.5 * distance(p));
    /// };
    /// let picture = Isolines::sample(&Slice::planar(), &view, Sampling::default(), values)?;
    /// let grid = Sampling::new(100)?;
    /// let places = picture.compared_places(grid);
    /// let comparisons = Vec::from_iter(places.iter().map(|p| {
    ///     let distance = distance(p);
    ///     Comparison { value: 0.5 * distance, distance: [distance.abs(); 2] }
    /// }));
    /// let picture = picture.with_promise([Promised::Bound; 2], grid, &comparisons)?;
    /// let measured = picture.measured().unwrap();
    /// assert_eq!((measured.smallest, measured.largest, measured.open), (0.5, 0.5, 0.0));
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    pub fn with_promise(
        self,
        promised: [Promised; 2],
        grid: Sampling,
        comparisons: &[Comparison],
    ) -> Result<Self, PlotError> {
        let trust = Trust::paint(&self.compared(grid), promised, comparisons)?;
        Ok(Self { ground: Ground::Promise(Box::new(trust)), ..self })
    }

    /// The extremes of what [`with_promise`](Self::with_promise) measured, or of the numbers of
    /// [`with_values`](Self::with_values); `None` without, or if there is no number.
    #[must_use]
    pub fn measured(&self) -> Option<Measured> {
        match &self.ground {
            Ground::Promise(trust) => trust.measured,
            Ground::Values(values) => values.measured,
            _ => None,
        }
    }

    /// How many pixels gradients, directions and numbers have in this window, for progress bars.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.pixels.number()
    }

    /// With a heading above the picture, for figures of several parts.
    #[must_use]
    pub fn with_title(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// With a path over the isolines.
    #[must_use]
    pub fn with_polyline(mut self, polyline: Polyline) -> Self {
        self.overlays.push(Overlay::Polyline(polyline));
        self
    }

    /// With arrows over the isolines.
    #[must_use]
    pub fn with_arrows(mut self, arrows: Arrows) -> Self {
        self.overlays.push(Overlay::Arrows(arrows));
        self
    }

    /// With points over the isolines.
    #[must_use]
    pub fn with_markers(mut self, markers: Markers) -> Self {
        self.overlays.push(Overlay::Markers(markers));
        self
    }

    /// The window.
    #[must_use]
    pub fn view(&self) -> PlaneView {
        self.view
    }

    /// Distance between neighbouring isolines \[m\].
    #[must_use]
    pub fn step(&self) -> f64 {
        self.levels.step
    }

    /// Levels of the isolines \[m\], ascending.
    #[must_use]
    pub fn levels(&self) -> &[f64] {
        &self.levels.values
    }

    /// Smallest and largest value sampled \[m\].
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        self.samples.range()
    }
}

/// The direction of a gradient in the plane, as a colour.
fn wheel_color(slope: &SampledSlope) -> Color {
    wheel::color([slope.gradient[0], slope.gradient[1]])
}
