// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The picture of a field in a plane: bands, isolines and overlays.

use crate::axis::{Axis, BELOW};
use crate::drawing::{Drawing, Image, Path, Stroke, TextStyle};
use crate::error::PlotError;
use crate::frame::Frame;
use crate::geometry::Rect;
use crate::labels::Occupied;
use crate::legend::{self, Entry, Key};
use crate::levels::Levels;
use crate::numbers::write;
use crate::outline::Outline;
use crate::overlay::{Arrows, Markers, Overlay, Polyline};
use crate::overlay_picture::Overlays;
use crate::palette::{self, Color, Side};
use crate::picture::{Lines, Picture, isoline_stroke, surface_stroke};
use crate::sampling::{Samples, Sampling};
use crate::slice::{Slice, SliceAxis};
use crate::slope::{Pixels, Slope};
use crate::surface::Surface;
use crate::text::{Anchor, CAP_HEIGHT};
use crate::trust::{Gauge, Measured, Promised, Trust};
use crate::values::Values;
use crate::view::View;
use crate::wheel::{self, AxisArrow};

/// Highest plot [px]; taller windows are drawn narrower.
pub(crate) const MOST_HEIGHT: f64 = 720.0;
/// Between a picture and its legend [px].
pub(crate) const ABOVE_LEGEND: f64 = 10.0;
/// The desired distance of ticks, across and up [px].
const TICK_SPACING: [f64; 2] = [80.0, 70.0];

/// The axes of the plane in a small picture.
fn axis_stroke() -> Stroke {
    Stroke::new(Color::INK, 1.0).with_dash(vec![1.5, 3.0])
}

/// Bands and isolines of a field in a window of a plane, with overlays.
///
/// Blue bands are inside (negative values), orange ones outside, lighter with the value; the
/// heavy line is the surface, where the field is zero. Thin isolines at round levels carry
/// their value in metres. A surface without interior, such as a curve or a sheet, is also drawn
/// as a line: where a field that is nowhere negative comes closer to zero than a sampling cell.
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
    pub(crate) view: View,
    samples: Samples,
    outline: Outline,
    levels: Levels,
    pub(crate) sampling: Sampling,
    pub(crate) ground: Ground,
    title: String,
    pub(crate) overlays: Vec<Overlay>,
}

/// The ground below the lines.
#[derive(Debug, Clone)]
pub(crate) enum Ground {
    /// Bands of distance, with isolines.
    Distance,
    /// The direction of the gradient.
    Gradient(Image),
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
            outline: Outline::of_samples(&samples),
            samples,
            sampling,
            ground: Ground::Distance,
            title: String::new(),
            overlays: Vec::new(),
        })
    }

    /// With this surface, [followed](Outline::follow) in the same window, instead of the one that
    /// the samples show.
    #[must_use]
    pub fn with_outline(self, outline: Outline) -> Self {
        Self { outline, ..self }
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

    /// With the promises in place of the bands, and the surface as the only line.
    ///
    /// Each side of the surface has the tint and hatching of what is `promised` outside and
    /// inside. The tint itself means that `gauge` measures one; darker is less (the value falls
    /// short of the distance), redder is more. [`Gauge::Distance`] shows only differences
    /// larger than the picture's error, a cell of the grid, and nothing where a nearer surface
    /// may lie more than a window's size outside the window.
    ///
    /// `field` is called as in [`with_gradient`](Self::with_gradient), and for
    /// [`Gauge::Distance`] up to a window's size outside the window.
    ///
    /// # Errors
    ///
    /// As [`with_gradient`](Self::with_gradient).
    ///
    /// # Examples
    ///
    /// Half the distance to a disc is a bound of it:
    ///
    /// ```
    /// use palpate_plot::{Gauge, Isolines, Promised, Sampling, Slice, Slope, View};
    ///
    /// let view = View::new([0.0, 0.0], 0.2, 0.15)?;
    /// let half = |p: &[f64; 2]| 0.5 * (p[0].hypot(p[1]) - 0.03);
    /// let values = |points: &[[f64; 2]], values: &mut [f64]| {
    ///     points.iter().zip(values).for_each(|(p, value)| *value = half(p));
    /// };
    /// let slopes = |points: &[[f64; 2]], slopes: &mut [Slope]| {
    ///     points.iter().zip(slopes).for_each(|(p, slope)| slope.value = half(p));
    /// };
    /// let promised = [Promised::Bound, Promised::Bound];
    /// let picture = Isolines::sample(&Slice::planar(), &view, Sampling::default(), values)?
    ///     .with_promise(promised, Gauge::Distance, slopes)?;
    /// let measured = picture.measured().unwrap();
    /// assert!(measured.smallest > 0.5 && measured.smallest < 0.51);
    /// assert_eq!(measured.largest, 1.0); // so close to the surface that it may be
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    pub fn with_promise(
        self,
        promised: [Promised; 2],
        gauge: Gauge,
        mut field: impl FnMut(&[[f64; 2]], &mut [Slope]),
    ) -> Result<Self, PlotError> {
        let pixels = Pixels::of(&self.view, self.sampling);
        let trust = match gauge {
            Gauge::Distance => {
                let Self { view, samples, sampling, .. } = &self;
                let mut surface = Surface::find(view, samples, *sampling, &mut field)?;
                let ratio = |at, slope: &Slope| surface.ratio(at, slope.value);
                Trust::paint(&pixels, promised, gauge, field, ratio)
            }
            Gauge::Steepness => {
                let steepness = |_, slope: &Slope| Some(slope.steepness());
                Trust::paint(&pixels, promised, gauge, field, steepness)
            }
        }?;
        Ok(Self { ground: Ground::Promise(Box::new(trust)), ..self })
    }

    /// The extremes of what [`with_promise`](Self::with_promise) measured, or of the numbers of
    /// [`with_values`](Self::with_values).
    #[must_use]
    pub fn measured(&self) -> Option<Measured> {
        match &self.ground {
            Ground::Promise(trust) => trust.measured,
            Ground::Values(values) => values.measured,
            _ => None,
        }
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
        let picture =
            Picture { samples: &self.samples, outline: &self.outline, levels: &levels, frame };
        let overlays = Overlays::new(frame, &self.overlays);
        let lines = picture.lines();
        let mut occupied = Occupied::default();
        lines.occupy(&mut occupied);
        overlays.occupy(&mut occupied);
        let labels = overlays.place_labels(&mut occupied);
        self.draw_ground(drawing, &picture, &lines);
        picture.draw_lines(drawing, &lines);
        picture.draw_labels(drawing, &lines, &mut occupied);
        overlays.draw(drawing, &labels);
        drawing.stroke(Path::rect(&plot), Stroke::new(Color::MUTED, 1.0));
        self.axis(0, plot.width()).draw_below(drawing, &plot);
        self.axis(1, plot.height()).draw_left(drawing, &plot, plot.min[0] - gutter);
        let mut bottom = plot.max[1] + BELOW;
        bottom += picture.draw_scale_bar(drawing, bottom);
        (bottom - area.min[1], [self.legend(), overlays.entries].concat())
    }

    /// Draws the field alone into `plot` [px], with the axes of the plane.
    pub(crate) fn draw_tile(&self, drawing: &mut Drawing, plot: Rect) {
        let frame = Frame::new(self.view, plot);
        let levels = self.drawn_levels();
        let picture =
            Picture { samples: &self.samples, outline: &self.outline, levels: &levels, frame };
        let lines = picture.lines();
        self.draw_ground(drawing, &picture, &lines);
        let [x, y] = frame.pixel([0.0; 2]);
        let axes = [[[x, plot.min[1]], [x, plot.max[1]]], [[plot.min[0], y], [plot.max[0], y]]];
        for axis in axes.iter().filter(|axis| plot.contains(axis[0])) {
            drawing.stroke(Path::line(axis), axis_stroke());
        }
        picture.draw_lines(drawing, &lines);
        drawing.stroke(Path::rect(&plot), Stroke::new(Color::MUTED, 0.75));
    }

    /// What [`draw_tile`](Self::draw_tile) draws.
    pub(crate) fn tile_legend(&self) -> Vec<Entry> {
        let mut entries = self.legend();
        // Each tile has its own step, and its own promises of both sides.
        entries.retain(|entry| !matches!(&entry.key, Key::Line(line) if line.width < 1.0));
        for entry in &mut entries {
            if let Key::Promised(promised) = entry.key {
                *entry = promised.entry();
            }
        }
        let [right, up] = self.axis_arrows();
        let way = if up.sign > 0.0 { "up" } else { "down" };
        let text = format!("axes through the origin: {} right, {} {way}", right.name, up.name);
        entries.push(Entry::new(Key::Line(axis_stroke()), text));
        entries
    }

    pub(crate) fn title(&self) -> &str {
        &self.title
    }

    fn draw_ground(&self, drawing: &mut Drawing, picture: &Picture<'_>, lines: &Lines) {
        let frame = picture.frame;
        match &self.ground {
            Ground::Distance => picture.draw_bands(drawing),
            Ground::Gradient(image) => {
                drawing.image(frame.plot, image.clone());
                picture.draw_casing(drawing, lines);
            }
            Ground::Values(values) => {
                drawing.image(frame.plot, values.image.clone());
                picture.draw_casing(drawing, lines);
            }
            Ground::Promise(trust) => {
                drawing.image(frame.plot, trust.image.clone());
                trust.hatch(drawing, &frame.plot, |p| self.samples.value_near(frame.point(p)));
                picture.draw_casing(drawing, lines);
            }
        }
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

    /// The levels whose lines are drawn: only the surface where colours show something other
    /// than the distance.
    fn drawn_levels(&self) -> Levels {
        let mut levels = self.levels.clone();
        if !matches!(self.ground, Ground::Distance) {
            levels.values.retain(|level| *level == 0.0);
        }
        levels
    }

    fn surface_entry(&self) -> Entry {
        let window = Rect { min: self.view.min(), max: self.view.max() };
        if self.outline.bounds(&window).is_some() {
            Entry::new(Key::Line(surface_stroke()), "surface")
        } else {
            Entry::new(Key::None, "no surface in view")
        }
    }

    fn legend(&self) -> Vec<Entry> {
        match &self.ground {
            Ground::Distance => self.distance_legend(),
            Ground::Gradient(_) => self.gradient_legend(),
            Ground::Values(values) => {
                let mut entries = values.entries();
                entries.push(self.surface_entry());
                entries
            }
            Ground::Promise(trust) => {
                let (low, high) = self.samples.range();
                let mut entries = trust.entries([high > 0.0, low < 0.0]);
                entries.push(self.surface_entry());
                entries
            }
        }
    }

    /// The axes of the picture without their units.
    fn axis_arrows(&self) -> [AxisArrow; 2] {
        self.slice.axes().map(|SliceAxis { name, sign }| {
            let name = name.split(' ').next().unwrap_or(name).to_owned();
            AxisArrow { name, sign }
        })
    }

    fn gradient_legend(&self) -> Vec<Entry> {
        vec![
            Entry::new(
                Key::Wheel(self.axis_arrows()),
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
