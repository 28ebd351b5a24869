// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The picture of a field in a plane: bands, isolines, and what lies over them.

use crate::axis::{Axis, BELOW};
use crate::drawing::{Drawing, Image, Path, Stroke, TextStyle};
use crate::error::PlotError;
use crate::frame::Frame;
use crate::geometry::Rect;
use crate::labels::Occupied;
use crate::legend::{self, Entry, Key};
use crate::levels::Levels;
use crate::numbers::write;
use crate::overlay::{Arrows, Markers, Overlay, Polyline};
use crate::overlay_picture::Overlays;
use crate::palette::{self, Color, Side};
use crate::picture::{Picture, isoline_stroke, surface_stroke};
use crate::sampling::{Samples, Sampling};
use crate::slice::{Slice, SliceAxis};
use crate::slope::{Pixels, Slope};
use crate::text::{Anchor, CAP_HEIGHT};
use crate::view::View;
use crate::wheel::{self, AxisArrow};

/// Highest plot [px]; taller windows are drawn narrower.
pub(crate) const MOST_HEIGHT: f64 = 720.0;
/// Between a picture and its legend [px].
pub(crate) const ABOVE_LEGEND: f64 = 10.0;
/// Distance of ticks aimed at, across and up [px].
const TICK_SPACING: [f64; 2] = [80.0, 70.0];

/// Bands and isolines of a field in a window of a plane, with overlays.
///
/// Blue bands are inside (negative values), orange ones outside, lighter with the value; the
/// heavy line is the surface, where the field is zero. Thin isolines at round levels carry
/// their value in metres. A field that is nowhere negative but closer to zero than a sampling
/// cell (a curve or a sheet, which has no interior) shows its surface as a line all the same.
///
/// # Examples
///
/// A disc of 3 cm, with a point on it:
///
/// ```
/// use palpate_plot::{Figure, Isolines, Markers, Sampling, Slice, View};
///
/// let view = View::new([0.0, 0.0], 0.2, 0.15)?;
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
    view: View,
    samples: Samples,
    levels: Levels,
    sampling: Sampling,
    ground: Ground,
    title: String,
    overlays: Vec<Overlay>,
}

/// What lies under the lines.
#[derive(Debug, Clone)]
enum Ground {
    /// Bands of distance, with isolines.
    Distance,
    /// The direction of the gradient.
    Gradient(Image),
}

impl Isolines {
    /// Samples `field` in the window `view` of `slice`.
    ///
    /// `field` is called with the plane coordinates of some points \[m\] and a slice of the same
    /// length for their values \[m\]; use [`Slice::point`] to take the points to space. It is
    /// asked up to a cell outside the window.
    ///
    /// # Errors
    ///
    /// [`PlotError::Sample`] for the first value that is NaN, infinite or over 1e150.
    pub fn sample(
        slice: &Slice,
        view: &View,
        sampling: Sampling,
        field: impl FnMut(&[[f64; 2]], &mut [f64]),
    ) -> Result<Self, PlotError> {
        let samples = Samples::new(view, sampling, field)?;
        let (low, high) = samples.range();
        Ok(Self {
            slice: slice.clone(),
            view: *view,
            levels: Levels::choose(low, high, view.width().min(view.height())),
            samples,
            sampling,
            ground: Ground::Distance,
            title: String::new(),
            overlays: Vec::new(),
        })
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
    /// Lightness and hue say where the field grows in the plane, as the disc in the legend
    /// shows; colours fade to grey where the gradient is shorter than one there, because it is
    /// flatter or because it leans out of the plane, and darken where it is longer.
    ///
    /// `field` is called with the plane coordinates of some points \[m\] and a slice of the
    /// same length for their [`Slope`]s.
    ///
    /// # Errors
    ///
    /// [`PlotError::Sample`] for the first value that is NaN, infinite or over 1e150,
    /// [`PlotError::Gradient`] for the first such gradient.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::{Figure, Isolines, Sampling, Slice, Slope, View};
    ///
    /// let view = View::new([0.0, 0.0], 0.2, 0.15)?;
    /// let disc = |p: [f64; 2]| {
    ///     let r = p[0].hypot(p[1]);
    ///     Slope { value: r - 0.03, gradient: [p[0] / r, p[1] / r, 0.0] }
    /// };
    /// let values = |points: &[[f64; 2]], values: &mut [f64]| {
    ///     points.iter().zip(values).for_each(|(p, value)| *value = disc(*p).value);
    /// };
    /// let slopes = |points: &[[f64; 2]], slopes: &mut [Slope]| {
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
        field: impl FnMut(&[[f64; 2]], &mut [Slope]),
    ) -> Result<Self, PlotError> {
        let color = |_, slope: &Slope| wheel::color([slope.gradient[0], slope.gradient[1]]);
        let image = Pixels::of(&self.view, self.sampling).paint(field, color)?;
        Ok(Self { ground: Ground::Gradient(image), ..self })
    }

    /// With a heading of its own, for figures of several parts.
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

    /// Room for the left axis in a picture with `width` for the plot and it [px].
    pub(crate) fn gutter(&self, width: f64) -> f64 {
        let height = (width * self.view.height() / self.view.width()).min(MOST_HEIGHT);
        self.axis(1, height).gutter()
    }

    /// Width and height of the window [m].
    pub(crate) fn extent(&self) -> [f64; 2] {
        [self.view.width(), self.view.height()]
    }

    /// Draws the part into `area` from its top; its plot starts `gutter` right of its left
    /// edge. Returns the height used. All [px].
    pub(crate) fn draw(&self, drawing: &mut Drawing, area: &Rect, gutter: f64) -> f64 {
        let (height, entries) = self.draw_plot(drawing, area, gutter);
        let origin = [area.min[0] + gutter, area.min[1] + height + ABOVE_LEGEND];
        origin[1] + legend::draw(drawing, &entries, origin, area.max[0] - origin[0])
            - area.min[1]
    }

    /// Draws all but the legend; returns the height used [px] and the legend.
    pub(crate) fn draw_plot(
        &self,
        drawing: &mut Drawing,
        area: &Rect,
        gutter: f64,
    ) -> (f64, Vec<Entry>) {
        let mut top = area.min[1];
        if !self.title.is_empty() {
            let style = TextStyle::SUBTITLE;
            let at = [area.min[0] + gutter, top + CAP_HEIGHT * style.size];
            drawing.label(&self.title, at, Anchor::Start, style);
            top += 24.0;
        }
        let plot = self.plot(area, gutter, top);
        let frame = Frame::new(self.view, plot);
        let levels = self.drawn_levels();
        let picture = Picture { samples: &self.samples, levels: &levels, frame };
        let overlays = Overlays::new(frame, &self.overlays);
        let lines = picture.lines();
        let mut occupied = Occupied::default();
        lines.occupy(&mut occupied);
        overlays.occupy(&mut occupied);
        let labels = overlays.place_labels(&mut occupied);
        match &self.ground {
            Ground::Distance => picture.draw_bands(drawing),
            Ground::Gradient(image) => {
                drawing.image(plot, image.clone());
                picture.draw_casing(drawing, &lines);
            }
        }
        picture.draw_lines(drawing, &lines, &mut occupied);
        overlays.draw(drawing, &labels);
        drawing.stroke(Path::rect(&plot), Stroke::new(Color::MUTED, 1.0));
        self.axis(0, plot.width()).draw_below(drawing, &plot);
        self.axis(1, plot.height()).draw_left(drawing, &plot, plot.min[0] - gutter);
        let mut bottom = plot.max[1] + BELOW;
        bottom += picture.draw_scale_bar(drawing, bottom);
        (bottom - area.min[1], [self.legend(), overlays.entries].concat())
    }

    /// The largest rectangle of the window's shape, centred.
    fn plot(&self, area: &Rect, gutter: f64, top: f64) -> Rect {
        let room = area.width() - gutter;
        let aspect = self.view.height() / self.view.width();
        let height = (room * aspect).min(MOST_HEIGHT);
        let width = height / aspect;
        Rect::new(area.min[0] + gutter + (room - width) / 2.0, top, width, height)
    }

    fn axis(&self, index: usize, length: f64) -> Axis {
        let axis = self.slice.axes()[index];
        let ends = [self.view.min()[index], self.view.max()[index]].map(|x| axis.sign * x);
        Axis::new(axis.name, ends, length, TICK_SPACING[index])
    }

    /// The levels whose lines are drawn: the surface alone where colours say something else
    /// than the distance.
    fn drawn_levels(&self) -> Levels {
        let mut levels = self.levels.clone();
        if !matches!(self.ground, Ground::Distance) {
            levels.values.retain(|level| *level == 0.0);
        }
        levels
    }

    fn surface_entry(&self) -> Entry {
        let (low, high) = self.samples.range();
        if low <= 0.0 && high >= 0.0 || self.samples.has_thin_surface() {
            Entry::new(Key::Line(surface_stroke()), "surface")
        } else {
            Entry::new(Key::None, "no surface in view")
        }
    }

    fn legend(&self) -> Vec<Entry> {
        match &self.ground {
            Ground::Distance => self.distance_legend(),
            Ground::Gradient(_) => self.gradient_legend(),
        }
    }

    fn gradient_legend(&self) -> Vec<Entry> {
        let axes = self.slice.axes().map(|SliceAxis { name, sign }| {
            let name = name.split(' ').next().unwrap_or(name).to_owned();
            AxisArrow { name, sign }
        });
        vec![
            Entry::new(
                Key::Wheel(axes),
                "direction in which the field grows; at the rim its gradient is 1",
            ),
            self.surface_entry(),
            Entry::new(
                Key::Swatch(wheel::color([0.0; 2])),
                "flat, or leaning out of the plane",
            ),
            Entry::new(Key::Swatch(wheel::color([0.0, -2.0])), "darker: steeper than 1"),
        ]
    }

    fn distance_legend(&self) -> Vec<Entry> {
        let (low, high) = self.samples.range();
        let (inside, outside) = self.levels.bands();
        let bands = |side, count: usize| {
            Key::Bands(
                (0..3)
                    .map(|i| palette::band(side, i * (count.max(3) - 1) / 2, count))
                    .collect(),
            )
        };
        let mut entries = Vec::new();
        if low < 0.0 {
            entries.push(Entry::new(bands(Side::Inside, inside), "inside"));
        }
        entries.push(self.surface_entry());
        if high > 0.0 {
            entries.push(Entry::new(bands(Side::Outside, outside), "outside"));
        }
        let side = if high > 0.0 { Side::Outside } else { Side::Inside };
        if !self.levels.values.is_empty() {
            let step = write(self.levels.step, self.levels.step);
            let text = format!("isolines every {step} m, labelled in metres");
            entries.push(Entry::new(Key::Line(isoline_stroke(side)), text));
        }
        entries
    }
}
