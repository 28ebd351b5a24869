// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A picture of one or more parts, one below the other.

use crate::chart::Chart;
use crate::drawing::{Drawing, TextStyle};
use crate::error::PlotError;
use crate::geometry::Rect;
use crate::isolines::Isolines;
use crate::panels::Panels;
use crate::sheet::Sheet;
use crate::text::{Anchor, CAP_HEIGHT, LINE_HEIGHT, wrap};
use crate::views::Views;
use crate::{png, svg};

/// Width of every figure [px]. Text and lines are sized for it.
const WIDTH: f64 = 800.0;
/// Around the figure [px].
const MARGIN: f64 = 20.0;
/// Between two parts [px].
const BETWEEN: f64 = 26.0;

/// A titled picture: isolines and charts, stacked, 800 px wide, on white.
///
/// The same figure gives the same bytes, on every machine: text is drawn from a font in this
/// crate, as outlines.
///
/// # Examples
///
/// ```
/// use palpate_plot::{Chart, Figure, ChartQuantity};
///
/// let chart = Chart::new(ChartQuantity::new("time", "s"), ChartQuantity::new("force", "N"));
/// let figure = Figure::new("Nothing felt").with_caption("no samples yet").with_chart(chart);
/// assert!(figure.to_svg().contains("<title>Nothing felt</title>"));
/// ```
#[derive(Debug, Clone)]
pub struct Figure {
    title: String,
    caption: String,
    parts: Vec<Part>,
}

#[derive(Debug, Clone)]
enum Part {
    Isolines(Box<Isolines>),
    Views(Views),
    Sheet(Sheet),
    Chart(Chart),
    Panels(Panels),
}

impl Figure {
    /// An empty figure. The title may be empty; characters outside Latin and Greek are boxes.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), caption: String::new(), parts: Vec::new() }
    }

    /// With a line below the title, such as what the field promises.
    #[must_use]
    pub fn with_caption(self, caption: impl Into<String>) -> Self {
        Self { caption: caption.into(), ..self }
    }

    /// With isolines below the parts so far.
    #[must_use]
    pub fn with_isolines(mut self, isolines: Isolines) -> Self {
        self.parts.push(Part::Isolines(Box::new(isolines)));
        self
    }

    /// With several views of one scene, such as slices along different planes, at one scale and
    /// with one legend. They stand side by side unless they are much larger one below the
    /// other.
    ///
    /// The legend has one entry for overlays of the same name. Give the views one
    /// [step](Isolines::with_step) and their arrows one
    /// [length](crate::Arrows::with_full_length).
    #[must_use]
    pub fn with_views(mut self, views: impl IntoIterator<Item = Isolines>) -> Self {
        self.parts.push(Part::Views(Views::new(views.into_iter().collect())));
        self
    }

    /// With many small pictures in rows of `columns` (1 to 8), each with its
    /// [title](Isolines::with_title), a scale bar and thin lines where the plane's axes lie,
    /// and with one legend. Labels and overlays are left out: there is no room for them.
    #[must_use]
    pub fn with_sheet(
        mut self,
        columns: usize,
        tiles: impl IntoIterator<Item = Isolines>,
    ) -> Self {
        self.parts.push(Part::Sheet(Sheet::new(tiles.into_iter().collect(), columns)));
        self
    }

    /// With a chart below the parts so far.
    #[must_use]
    pub fn with_chart(mut self, chart: Chart) -> Self {
        self.parts.push(Part::Chart(chart));
        self
    }

    /// With small charts of one quantity below the parts so far, two in a row, which share their
    /// axes. Each has its [title](Chart::with_title) above it; lines of the same name have one
    /// entry in the legend.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::{Chart, Color, Figure, ChartQuantity, Series};
    ///
    /// let finger = |number: usize| {
    ///     let force = Series::new("force", [[0.0, 0.0], [1.0, 0.2 * number as f64]])?;
    ///     let chart = Chart::new(ChartQuantity::new("time", "s"), ChartQuantity::new("force", "N"));
    ///     let chart = chart.with_series(force.with_color(Color::numbered(number)));
    ///     Ok(chart.with_title(format!("finger {number}")))
    /// };
    /// let fingers = (0..5).map(finger).collect::<Result<Vec<_>, palpate_plot::PlotError>>()?;
    /// let svg = Figure::new("A hand").with_panels(fingers).to_svg();
    /// assert_eq!(svg.matches("aria-label=\"force [N]\"").count(), 1);
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    #[must_use]
    pub fn with_panels(mut self, charts: impl IntoIterator<Item = Chart>) -> Self {
        self.parts.push(Part::Panels(Panels::new(charts.into_iter().collect())));
        self
    }

    /// The figure as an SVG document.
    #[must_use]
    pub fn to_svg(&self) -> String {
        svg::write(&self.draw())
    }

    /// The figure as a PNG file, `width` pixels wide.
    ///
    /// # Errors
    ///
    /// [`PlotError::PictureSize`] below 64 px, or above 16384 px in width or height;
    /// [`PlotError::Png`] if the encoder fails.
    pub fn to_png(&self, width: u32) -> Result<Vec<u8>, PlotError> {
        png::write(&self.draw(), width)
    }

    pub(crate) fn draw(&self) -> Drawing {
        let mut drawing = Drawing {
            width: WIDTH,
            title: self.title.clone(),
            description: self.caption.clone(),
            ..Drawing::default()
        };
        let mut y = self.draw_heading(&mut drawing);
        let room = WIDTH - 2.0 * MARGIN;
        let gutters = self.parts.iter().map(|part| match part {
            Part::Isolines(isolines) => isolines.gutter(room),
            Part::Views(views) => views.gutter(room),
            Part::Sheet(_) => 0.0,
            Part::Chart(chart) => chart.gutter(),
            Part::Panels(panels) => panels.gutter(),
        });
        // Parts share their left edge; the limit keeps very wide labels from pushing plots out.
        let gutter = gutters.fold(0.0, f64::max).min(0.4 * room);
        for (index, part) in self.parts.iter().enumerate() {
            if index > 0 {
                y += BETWEEN;
            }
            let area = Rect::new(MARGIN, y, room, 0.0);
            y += match part {
                Part::Isolines(isolines) => isolines.draw(&mut drawing, &area, gutter),
                Part::Views(views) => views.draw(&mut drawing, &area, gutter),
                Part::Sheet(sheet) => sheet.draw(&mut drawing, &area),
                Part::Chart(chart) => chart.draw(&mut drawing, &area, gutter),
                Part::Panels(panels) => panels.draw(&mut drawing, &area, gutter),
            };
        }
        drawing.height = (y + MARGIN).ceil();
        drawing
    }

    /// Draws title and caption; returns where the first part starts.
    fn draw_heading(&self, drawing: &mut Drawing) -> f64 {
        let mut y = MARGIN;
        for (text, style) in
            [(&self.title, TextStyle::TITLE), (&self.caption, TextStyle::CAPTION)]
        {
            for line in wrap(text, style.size, style.weight, WIDTH - 2.0 * MARGIN) {
                let baseline = y + CAP_HEIGHT * style.size;
                drawing.label(&line, [MARGIN, baseline], Anchor::Start, style);
                y += LINE_HEIGHT * style.size;
            }
        }
        if y > MARGIN { y + 4.0 } else { y }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{Item, Verb};
    use crate::{
        Arrow, Arrows, ChartQuantity, Markers, PlaneView, Polyline, Sampling, Series, Slice,
    };

    /// Checks that every coordinate lies in the figure, and so is finite.
    fn check(figure: &Figure) {
        let drawing = figure.draw();
        assert!(drawing.height > 0.0 && drawing.height < 3000.0, "{}", drawing.height);
        let inside = Rect::new(0.0, 0.0, drawing.width, drawing.height);
        for item in &drawing.items {
            let mark = match item {
                Item::Mark(mark) => mark,
                Item::Image(rect, _) => {
                    assert!(inside.contains_rect(rect), "{rect:?}");
                    continue;
                }
            };
            for verb in &mark.path.verbs {
                let is_inside = match *verb {
                    Verb::Move(p) | Verb::Line(p) => inside.contains(p),
                    Verb::Quadratic(c, p) => inside.contains(c) && inside.contains(p),
                    Verb::Close => true,
                };
                assert!(is_inside, "{verb:?} of {:?}", mark.text);
            }
        }
    }

    fn figure(scale: f64, field: impl Fn([f64; 2]) -> f64) -> Figure {
        let view =
            PlaneView::new([0.3 * scale, -0.1 * scale], 2.0 * scale, 1.5 * scale).unwrap();
        let sample = |points: &[[f64; 2]], values: &mut [f64]| {
            for (&p, value) in points.iter().zip(values) {
                *value = field(p);
            }
        };
        let far = [[-1e100, 0.0], [0.0, 0.0], [scale, scale], [1e150, -1e150]];
        let arrows = [1.0, 1e-320, 0.0, 1e150]
            .map(|x| Arrow { tail: [0.1 * scale, 0.0], vector: [x, -x] });
        let isolines =
            Isolines::sample(&Slice::planar(), &view, Sampling::new(60).unwrap(), sample)
                .unwrap()
                .with_title("part")
                .with_polyline(Polyline::new("path", far).unwrap())
                .with_polyline(Polyline::new("none", []).unwrap())
                .with_arrows(Arrows::new("force", "N", arrows).unwrap())
                .with_arrows(Arrows::directions("normal", arrows).unwrap())
                .with_markers(Markers::new("point", far).unwrap().with_labels(["a", "b", "c"]));
        let chart =
            Chart::new(ChartQuantity::new("time", "s"), ChartQuantity::new("force", "N"))
                .with_series(Series::new("f", [[0.0, scale], [scale, 2.0 * scale]]).unwrap());
        Figure::new("Test").with_isolines(isolines).with_chart(chart)
    }

    #[test]
    fn figures_are_finite_at_every_scale() {
        for scale in [1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e8] {
            check(&figure(scale, |p| p[0].hypot(p[1]) - 0.5 * scale));
        }
    }

    #[test]
    fn fields_of_every_kind_are_drawn() {
        let fields: [fn([f64; 2]) -> f64; 9] = [
            |_| 0.0,
            |_| 0.123,
            |_| -1e30,
            |p| p[0].hypot(p[1]) + 3.0,  // no surface in view
            |p| -p[0].hypot(p[1]) - 3.0, // all inside
            |p| p[0].hypot(p[1]),        // a point, without interior
            |p| 1e100 * p[0],
            |p| 1e-12 * p[0] + 1.0,
            |p| if p[0] > 0.0 { 1e150 } else { -1e150 },
        ];
        for field in fields {
            check(&figure(1.0, field));
        }
    }

    #[test]
    fn charts_of_every_kind_are_drawn() {
        let series: [&[[f64; 2]]; 7] = [
            &[],
            &[[1.0, 2.0]],
            &[[0.0, 5.0], [1.0, 5.0]],
            &[[0.0, -1e150], [1e150, 1e150]],
            &[[1e9, 1e-300], [1e9 + 1e-6, 0.0]],
            &[[3.0, 0.0], [1.0, 1.0], [2.0, -1.0]],
            &[[0.0, 1e-9], [1e-9, 2e-9]],
        ];
        for points in series {
            let name = "a name that is much too long for one line of the legend ".repeat(4);
            let series = Series::new(name, points.iter().copied()).unwrap();
            let chart = Chart::new(ChartQuantity::new("x", ""), ChartQuantity::new("y", ""));
            let chart = chart.with_series(series).with_title("a title ".repeat(20));
            check(&Figure::new("").with_chart(chart.clone()));
            for count in [0, 1, 2, 5] {
                check(&Figure::new("").with_panels(vec![chart.clone(); count]));
            }
        }
        check(&Figure::new(""));
        check(&Figure::new("title ".repeat(60)).with_caption("caption ".repeat(60)));
    }

    #[test]
    fn views_are_drawn() {
        check(&Figure::new("None").with_views([]));
        for scale in [1e-9, 1.0, 1e8] {
            let view = PlaneView::new([0.0, 0.0], scale, 1.5 * scale).unwrap();
            let sample = |points: &[[f64; 2]], values: &mut [f64]| {
                points.iter().zip(values).for_each(|(p, v)| *v = p[0] - 0.3 * p[1]);
            };
            let isolines =
                Isolines::sample(&Slice::planar(), &view, Sampling::default(), sample).unwrap();
            for count in 1..5 {
                check(&Figure::new("Views").with_views(vec![isolines.clone(); count]));
                check(&Figure::new("Sheet").with_sheet(3, vec![isolines.clone(); count]));
            }
        }
    }

    #[test]
    fn slivers_are_drawn() {
        for (width, height) in [(1.0, 0.05), (0.05, 1.0)] {
            let view = PlaneView::new([0.0, 0.0], width, height).unwrap();
            let field = |points: &[[f64; 2]], values: &mut [f64]| {
                points.iter().zip(values).for_each(|(p, v)| *v = p[0] + p[1]);
            };
            let slice = Slice::xz(0.0).unwrap();
            let isolines = Isolines::sample(&slice, &view, Sampling::default(), field).unwrap();
            let other = isolines.clone().with_title("twice");
            check(&Figure::new("Slivers").with_views([isolines.clone(), other]));
            check(&Figure::new("Sliver").with_isolines(isolines));
        }
    }
}
