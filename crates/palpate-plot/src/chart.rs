// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Charts: axes and layers.

use crate::drawing::{Drawing, Path, Stroke, TextPaint, TextStyle};
use crate::error::{PlotError, finite_points};
use crate::geometry::{Point, Rect, distance};
use crate::legend::{self, Entry, Key, Symbol, draw_arrow};
use crate::overlay::Dash;
use crate::palette::Color;
use crate::png;
use crate::scale::{multiples, round_up, write};
use crate::text::{Anchor, CAP_HEIGHT, Text, Weight, shorten};

/// Height of a chart's plot [px].
const HEIGHT: f64 = 210.0;
/// The desired distance of ticks, across and up [px].
const TICK_SPACING: [f64; 2] = [95.0, 34.0];
/// Room above the highest and below the lowest value, as a share of the span.
const MARGIN: f64 = 0.06;
/// Width of the lines [px].
const LINE: f64 = 1.9;

/// The quantity and unit of an axis of a chart.
///
/// # Examples
///
/// ```
/// use palpate_plot::ChartQuantity;
///
/// assert_eq!(ChartQuantity::new("force", "N").label(), "force [N]");
/// assert_eq!(ChartQuantity::new("friction", "").label(), "friction");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChartQuantity {
    name: String,
    unit: String,
}

impl ChartQuantity {
    /// The quantity `name` measured in `unit`; an empty unit for pure numbers.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }

    /// Name and unit as written at the axis.
    #[must_use]
    pub fn label(&self) -> String {
        if self.unit.is_empty() {
            self.name.clone()
        } else {
            format!("{} [{}]", self.name, self.unit)
        }
    }
}

/// A named line of a chart.
///
/// # Examples
///
/// ```
/// use palpate_plot::Series;
///
/// let force = Series::new("normal force", [[0.0, 0.0], [0.001, 0.8]])?;
/// assert!(Series::new("normal force", [[0.0, f64::INFINITY]]).is_err());
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    name: String,
    points: Vec<[f64; 2]>,
    color: Option<Color>,
    dash: Option<Dash>,
}

impl Series {
    /// The line through `points`, each `[x, y]` in the units of the chart's axes.
    ///
    /// # Errors
    ///
    /// [`PlotError::Point`].
    pub fn new(
        name: impl Into<String>,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> Result<Self, PlotError> {
        let (name, points) = (name.into(), Vec::from_iter(points));
        finite_points(&name, &points)?;
        Ok(Self { name, points, color: None, dash: None })
    }

    /// With this colour instead of the next of the palette.
    #[must_use]
    pub fn with_color(self, color: Color) -> Self {
        Self { color: Some(color), ..self }
    }

    /// With this dash instead of the next in order.
    #[must_use]
    pub fn with_dash(self, dash: Dash) -> Self {
        Self { dash: Some(dash), ..self }
    }
}

/// Lines over an axis, with ticks, grid and legend.
///
/// # Examples
///
/// ```
/// use palpate_plot::{Chart, Figure, ChartQuantity, Series};
///
/// let force = Series::new("normal", (0..1000).map(|i| {
///     let time = f64::from(i) * 1e-3;
///     [time, (6.0 * time).sin().max(0.0)]
/// }))?;
/// let chart = Chart::new(ChartQuantity::new("time", "s"), ChartQuantity::new("force", "N")).with_series(force);
/// let png = Figure::new("Press").with_chart(chart).to_png(800)?;
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    x: ChartQuantity,
    y: ChartQuantity,
    title: String,
    series: Vec<Series>,
}

impl Chart {
    /// An empty chart of `y` over `x`.
    #[must_use]
    pub fn new(x: ChartQuantity, y: ChartQuantity) -> Self {
        Self { x, y, title: String::new(), series: Vec::new() }
    }

    /// With another line.
    #[must_use]
    pub fn with_series(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// With a heading above the chart, for figures of several parts.
    #[must_use]
    pub fn with_title(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// Room for the left axis [px].
    pub(crate) fn gutter(&self) -> f64 {
        self.axis(1, HEIGHT).gutter()
    }

    fn axis(&self, index: usize, length: f64) -> Axis {
        axis_of(&[self], index, length, TICK_SPACING[index])
    }

    /// Draws the chart into `area` from its top; its plot starts `gutter` right of its left
    /// edge. Returns the height used. All [px].
    pub(crate) fn draw(&self, drawing: &mut Drawing, area: &Rect, gutter: f64) -> f64 {
        let mut top = area.min[1];
        let left = area.min[0] + gutter;
        if !self.title.is_empty() {
            let style = TextStyle::SUBTITLE;
            let at = [left, top + CAP_HEIGHT * style.size];
            let title = shorten(&self.title, style.size, style.weight, area.max[0] - left);
            drawing.label(&title, at, Anchor::Start, style);
            top += 24.0;
        }
        let plot = Rect::new(left, top, area.max[0] - left, HEIGHT);
        let (x, y) = (self.axis(0, plot.width()), self.axis(1, HEIGHT));
        let entries = self.draw_lines(drawing, &plot, &[&x, &y]);
        x.draw_below(drawing, &plot);
        y.draw_left(drawing, &plot, area.min[0]);
        let origin = [left, plot.max[1] + BELOW + 10.0];
        let height = legend::draw(drawing, &entries, origin, plot.width());
        origin[1] + height - area.min[1]
    }

    /// Draws the grid and the lines over these axes into `plot` [px]; returns the legend.
    pub(crate) fn draw_lines(
        &self,
        drawing: &mut Drawing,
        plot: &Rect,
        [x, y]: &[&Axis; 2],
    ) -> Vec<Entry> {
        draw_grid(drawing, plot, x, y);
        let mut entries = Vec::new();
        for (index, series) in self.series.iter().enumerate() {
            let dash = series.dash.unwrap_or(Dash::of_series(index)).lengths(LINE);
            let color = series.color.unwrap_or(Color::of_series(index));
            let stroke = Stroke::new(color, LINE).with_dash(dash);
            let pixels: Vec<Point> = series
                .points
                .iter()
                .map(|p| {
                    let (s, t) = (x.fraction(p[0]), y.fraction(p[1]));
                    [plot.min[0] + s * plot.width(), plot.max[1] - t * plot.height()]
                })
                .collect();
            drawing.stroke(Path::line(&thin(&pixels)), stroke.clone());
            entries.push(Entry::new(Key::Line(stroke), &*series.name));
        }
        entries
    }

    pub(crate) fn title(&self) -> &str {
        &self.title
    }
}

/// The axis of all `charts`, across (0) or up (1), on a side of `length` with ticks about
/// `spacing` apart, both [px]. It has the name of the first chart's.
pub(crate) fn axis_of(charts: &[&Chart], index: usize, length: f64, spacing: f64) -> Axis {
    let series = charts.iter().flat_map(|chart| &chart.series);
    let values = series.flat_map(|series| &series.points).map(|p| p[index]);
    let (low, high) = values
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let margin = if index == 0 { 0.0 } else { MARGIN };
    let name = charts.first().map(|chart| [&chart.x, &chart.y][index].label());
    Axis::new(&name.unwrap_or_default(), widened(low, high, margin), length, spacing)
}

/// A range that holds `[low, high]` with a `margin` relative to its span, and is never empty.
fn widened(low: f64, high: f64, margin: f64) -> [f64; 2] {
    if low > high {
        return [0.0, 1.0]; // no data
    }
    let span = high - low;
    // A span below rounding has no ticks; the value is shown as a level line.
    if span <= 1e-9 * low.abs().max(high.abs()) {
        let room = if low == 0.0 { 1.0 } else { 0.5 * low.abs() };
        return [low - room, high + room];
    }
    [low - margin * span, high + margin * span]
}

fn draw_grid(drawing: &mut Drawing, plot: &Rect, x: &Axis, y: &Axis) {
    let mut grid = Path::default();
    for &tick in &x.ticks {
        let x = plot.min[0] + x.fraction(tick) * plot.width();
        grid.add_line(&[[x, plot.min[1]], [x, plot.max[1]]]);
    }
    for &tick in &y.ticks {
        let y = plot.max[1] - y.fraction(tick) * plot.height();
        grid.add_line(&[[plot.min[0], y], [plot.max[0], y]]);
    }
    drawing.stroke(grid, Stroke::new(Color::RULE, 1.0));
    if y.start < 0.0 && y.end > 0.0 {
        let zero = plot.max[1] - y.fraction(0.0) * plot.height();
        let line = Path::line(&[[plot.min[0], zero], [plot.max[0], zero]]);
        drawing.stroke(line, Stroke::new(Color::MUTED, 1.0));
    }
    let axes = Path::line(&[plot.min, [plot.min[0], plot.max[1]], plot.max]);
    drawing.stroke(axes, Stroke::new(Color::MUTED, 1.0));
}

/// Drops samples that do not change the picture: of those in one column of pixels, the first,
/// the highest, the lowest and the last stay, in their order.
fn thin(pixels: &[Point]) -> Vec<Point> {
    /// Width of a column [px]: fine enough for a picture at twice the size.
    const COLUMN: f64 = 0.5;
    let mut thinned: Vec<Point> = Vec::new();
    let column = |p: &Point| (p[0] / COLUMN).floor();
    for run in pixels.chunk_by(|a, b| column(a) == column(b)) {
        let extreme = |sign: f64| {
            let order =
                |a: &usize, b: &usize| (sign * run[*a][1]).total_cmp(&(sign * run[*b][1]));
            (0..run.len()).max_by(order).unwrap_or(0)
        };
        let mut kept = [0, extreme(1.0), extreme(-1.0), run.len() - 1];
        kept.sort_unstable();
        for index in kept {
            if thinned.last().is_none_or(|&last| distance(last, run[index]) > 0.02) {
                thinned.push(run[index]);
            }
        }
    }
    thinned
}

/// Length of a tick [px].
const TICK: f64 = 4.0;
/// The least distance of labels from the edge of the picture [px]; closer ones are left out.
const EDGE: f64 = 4.0;
/// Space between tick, label and axis name [px].
const GAP: f64 = 6.0;
/// Height below a plot taken by ticks, tick labels and the axis name [px].
pub(crate) const BELOW: f64 = TICK + GAP + 12.0 + 6.0 + 13.0;

/// An axis of a plot: a range of numbers along one side of a rectangle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Axis {
    pub(crate) name: String,
    /// Number at the left or lower end.
    pub(crate) start: f64,
    /// Number at the right or upper end; below `start` if the axis runs backwards.
    pub(crate) end: f64,
    step: f64,
    /// Ticks, within the range.
    pub(crate) ticks: Vec<f64>,
}

impl Axis {
    /// An axis with round ticks about `spacing` apart on a side of `length`, both [px].
    pub(crate) fn new(name: &str, [start, end]: [f64; 2], length: f64, spacing: f64) -> Self {
        let (low, high) = (start.min(end), start.max(end));
        let step = round_up((high - low) / (length / spacing).max(1.5));
        let ticks = multiples(low, high, step, 100);
        Self { name: name.to_owned(), start, end, step, ticks }
    }

    /// The same axis with another name.
    pub(crate) fn named(&self, name: &str) -> Self {
        Self { name: name.to_owned(), ..self.clone() }
    }

    /// The place of `value` between start (0) and end (1).
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        (value - self.start) / (self.end - self.start)
    }

    fn label(&self, tick: f64) -> String {
        write(tick, self.step)
    }

    fn widest_label(&self) -> f64 {
        let widths = self.ticks.iter().map(|&t| TextStyle::TICK.width(&self.label(t)));
        widths.fold(0.0, f64::max)
    }

    /// Room that the axis needs at the left of a plot [px].
    pub(crate) fn gutter(&self) -> f64 {
        TextStyle::AXIS.size + GAP + self.widest_label() + GAP + TICK
    }

    /// Draws ticks, labels and name below `plot`.
    pub(crate) fn draw_below(&self, drawing: &mut Drawing, plot: &Rect) {
        let mut ticks = Path::default();
        let style = TextStyle::TICK;
        let baseline = plot.max[1] + TICK + GAP + CAP_HEIGHT * style.size;
        let room = plot.width() / (self.ticks.len().max(2) - 1) as f64;
        // Labels that would touch are thinned, keeping the first.
        let every = ((self.widest_label() + 8.0) / room).ceil().max(1.0) as usize;
        for (i, &tick) in self.ticks.iter().enumerate() {
            let x = plot.min[0] + self.fraction(tick) * plot.width();
            ticks.add_line(&[[x, plot.max[1]], [x, plot.max[1] + TICK]]);
            let label = self.label(tick);
            let half = style.width(&label) / 2.0 + EDGE;
            let is_inside = half <= x && x <= drawing.width - half;
            if i % every == 0 && is_inside {
                drawing.label(&label, [x, baseline], Anchor::Middle, style);
            }
        }
        drawing.stroke(ticks, Stroke::new(Color::MUTED, 1.0));
        let at = [(plot.min[0] + plot.max[0]) / 2.0, plot.max[1] + BELOW];
        drawing.label(&self.name, at, Anchor::Middle, TextStyle::AXIS);
    }

    /// Draws ticks, labels and name at the left of `plot`, the name at `left` [px].
    pub(crate) fn draw_left(&self, drawing: &mut Drawing, plot: &Rect, left: f64) {
        let mut ticks = Path::default();
        let style = TextStyle::TICK;
        for &tick in &self.ticks {
            let y = plot.max[1] - self.fraction(tick) * plot.height();
            ticks.add_line(&[[plot.min[0] - TICK, y], [plot.min[0], y]]);
            let at = [plot.min[0] - TICK - GAP, y + CAP_HEIGHT * style.size / 2.0];
            drawing.label(&self.label(tick), at, Anchor::End, style);
        }
        drawing.stroke(ticks, Stroke::new(Color::MUTED, 1.0));
        let TextStyle { size, color, .. } = TextStyle::AXIS;
        let text = Text {
            text: &self.name,
            at: [left + CAP_HEIGHT * size, (plot.min[1] + plot.max[1]) / 2.0],
            size,
            weight: Weight::Regular,
            anchor: Anchor::Middle,
            angle: -std::f64::consts::FRAC_PI_2,
        };
        drawing.text(&text, TextPaint { color, halo: None });
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_peaks() {
        let noise: Vec<Point> = (0..100_000)
            .map(|i| [f64::from(i) * 0.007, f64::from(i * 7919 % 1000) / 10.0])
            .collect();
        let thinned = thin(&noise);
        assert!(thinned.len() <= 4 * 1401, "{}", thinned.len());
        let highest = |points: &[Point]| points.iter().fold(0.0_f64, |m, p| m.max(p[1]));
        assert_eq!(highest(&thinned), highest(&noise));
    }

    #[test]
    fn ranges_are_never_empty() {
        assert_eq!(widened(f64::INFINITY, f64::NEG_INFINITY, 0.1), [0.0, 1.0]);
        assert_eq!(widened(0.0, 0.0, 0.1), [-1.0, 1.0]);
        assert_eq!(widened(-4.0, -4.0, 0.1), [-6.0, -2.0]);
        assert_eq!(widened(0.0, 10.0, 0.5), [-5.0, 15.0]);
    }
}

#[cfg(test)]
mod axis_tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within_the_range() {
        let axis = Axis::new("x [m]", [-0.13, 0.21], 700.0, 90.0);
        assert_eq!(axis.ticks, [-0.1, -0.05, 0.0, 0.05, 0.1, 0.15, 0.2]);
        let backwards = Axis::new("z [m]", [1.0, -1.0], 300.0, 90.0);
        assert_eq!(backwards.ticks, [-1.0, 0.0, 1.0]);
        assert_eq!(backwards.fraction(1.0), 0.0);
    }
}
