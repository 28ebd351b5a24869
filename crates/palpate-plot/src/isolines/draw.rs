// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Draws isolines with their axes and their legend.

use super::{Ground, Isolines};
use crate::body_picture::{self, Bodies};
use crate::chart::{Axis, BELOW};
use crate::drawing::{Drawing, Path, Stroke, TextStyle};
use crate::geometry::{Point, Rect};
use crate::labels::Occupied;
use crate::legend::{self, Entry, Frame, Key};
use crate::outline::SurfaceLines;
use crate::overlay_picture::Overlays;
use crate::palette::{self, Color, Side};
use crate::picture::{Picture, isoline_stroke, surface_stroke};
use crate::scale::{Levels, write};
use crate::slice::SliceAxis;
use crate::text::{Anchor, CAP_HEIGHT};
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

impl Isolines {
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
        let bodies =
            Bodies::new(&frame, &self.bodies, self.bodies.len() > 1 && !self.is_in_ink);
        let picture = self.picture(&levels, frame, bodies.inside());
        let overlays = Overlays::new(frame, &self.overlays);
        let lines = picture.lines();
        let mut occupied = Occupied::default();
        lines.occupy(&mut occupied);
        bodies.occupy(&mut occupied);
        overlays.occupy(&mut occupied);
        let labels = overlays.place_labels(&mut occupied);
        let names = bodies.place_names(&plot, &mut occupied);
        let insides = self.insides(&frame);
        self.draw_ground(drawing, &picture, &insides);
        match self.ground {
            Ground::Distance => bodies.draw_insides(drawing, &frame),
            _ if self.bodies.is_empty() => picture.draw_casing(drawing, &lines),
            _ => bodies.draw_rims(drawing),
        }
        picture.draw_lines(drawing, &lines);
        if self.bodies.is_empty() {
            picture.draw_surface(drawing, &lines);
        }
        bodies.draw_outlines(drawing, &frame);
        picture.draw_labels(drawing, &lines, &bodies, &mut occupied);
        body_picture::draw_names(drawing, &names);
        overlays.draw(drawing, &labels);
        drawing.stroke(Path::rect(&plot), Stroke::new(Color::MUTED, 1.0));
        self.axis(0, plot.width()).draw_below(drawing, &plot);
        self.axis(1, plot.height()).draw_left(drawing, &plot, plot.min[0] - gutter);
        let mut bottom = plot.max[1] + BELOW;
        bottom += picture.draw_scale_bar(drawing, bottom);
        (bottom - area.min[1], [self.legend(&bodies), overlays.entries].concat())
    }

    /// Draws field and overlays into `plot` [px], with the axes of the plane and no names.
    /// Returns the entries of the legend.
    pub(crate) fn draw_tile(&self, drawing: &mut Drawing, plot: Rect) -> Vec<Entry> {
        let frame = Frame::new(self.view, plot);
        let levels = self.drawn_levels();
        let picture = self.picture(&levels, frame, Side::Inside);
        let lines = picture.lines();
        self.draw_ground(drawing, &picture, &self.insides(&frame));
        if !matches!(self.ground, Ground::Distance) {
            picture.draw_casing(drawing, &lines);
        }
        let [x, y] = frame.pixel([0.0; 2]);
        let axes = [[[x, plot.min[1]], [x, plot.max[1]]], [[plot.min[0], y], [plot.max[0], y]]];
        let seen = axes.iter().filter(|axis| plot.contains(axis[0]));
        let has_axes = seen.clone().count() > 0;
        seen.for_each(|axis| drawing.stroke(Path::line(axis), axis_stroke()));
        picture.draw_lines(drawing, &lines);
        picture.draw_surface(drawing, &lines);
        let overlays = Overlays::new(frame, &self.overlays);
        let labels = overlays.place_labels(&mut Occupied::default());
        overlays.draw(drawing, &labels);
        drawing.stroke(Path::rect(&plot), Stroke::new(Color::MUTED, 0.75));
        [self.tile_legend(has_axes), overlays.entries].concat()
    }

    fn tile_legend(&self, has_axes: bool) -> Vec<Entry> {
        let mut entries = self.legend(&Bodies::default());
        // Each tile has its own step, and its own promises of both sides.
        entries.retain(|entry| !matches!(&entry.key, Key::Line(line) if line.width < 1.0));
        for entry in &mut entries {
            if let Key::Promised(promised) = entry.key {
                *entry = promised.entry();
            }
        }
        if !has_axes {
            return entries;
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

    fn picture<'a>(&'a self, levels: &'a Levels, frame: Frame, inside: Side) -> Picture<'a> {
        Picture { samples: &self.samples, outline: &self.outline, inside, levels, frame }
    }

    /// Rings around the inside, of the union or of each body [px].
    fn insides(&self, frame: &Frame) -> Vec<Vec<Vec<Point>>> {
        let pixels = |outline: &SurfaceLines| -> Vec<_> {
            outline.rings.iter().map(|ring| frame.pixels(ring)).collect()
        };
        match self.bodies[..] {
            [] => vec![pixels(&self.outline)],
            ref bodies => bodies.iter().map(|body| pixels(&body.outline)).collect(),
        }
    }

    fn draw_ground(
        &self,
        drawing: &mut Drawing,
        picture: &Picture<'_>,
        insides: &[Vec<Vec<Point>>],
    ) {
        let plot = &picture.frame.plot;
        match &self.ground {
            Ground::Distance => picture.draw_bands(drawing, insides),
            Ground::Gradient(image, _) => drawing.image(*plot, image.clone()),
            Ground::Values(values) => drawing.image(*plot, values.image.clone()),
            Ground::Promise(trust) => {
                drawing.image(*plot, trust.image.clone());
                let insides: Vec<_> = insides.iter().map(Vec::as_slice).collect();
                trust.hatch(drawing, plot, &insides);
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

    fn surface_entries(&self, bodies: &Bodies<'_>) -> Vec<Entry> {
        let of_bodies = bodies.entries(matches!(self.ground, Ground::Distance));
        let window = Rect { min: self.view.min(), max: self.view.max() };
        if !of_bodies.is_empty() {
            of_bodies
        } else if self.outline.bounds(&window).is_some() {
            vec![Entry::new(Key::Line(surface_stroke()), "surface")]
        } else {
            vec![Entry::new(Key::None, "no surface in view")]
        }
    }

    fn legend(&self, bodies: &Bodies<'_>) -> Vec<Entry> {
        match &self.ground {
            Ground::Distance => self.distance_legend(bodies),
            Ground::Gradient(_, method) => self.gradient_legend(method.as_deref(), bodies),
            Ground::Values(values) => [values.entries(), self.surface_entries(bodies)].concat(),
            Ground::Promise(trust) => {
                let (low, high) = self.samples.range();
                let mut entries = trust.entries([high > 0.0, low < 0.0]);
                entries.extend(self.surface_entries(bodies));
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

    fn gradient_legend(&self, method: Option<&str>, bodies: &Bodies<'_>) -> Vec<Entry> {
        let wheel = Key::Wheel(self.axis_arrows());
        let direction = match method {
            Some(method) => format!("direction that {method} finds"),
            None => {
                "direction in which the field grows; at the rim its gradient is 1".to_owned()
            }
        };
        let mut entries = vec![Entry::new(wheel, direction)];
        entries.extend(self.surface_entries(bodies));
        let [flat, steep] =
            [[0.0; 2], [0.0, -2.0]].map(|slope| Key::Swatch(wheel::color(slope)));
        if method.is_some() {
            entries.push(Entry::new(flat, "none, or leaning out of the plane"));
        } else {
            entries.push(Entry::new(flat, "flat, or leaning out of the plane"));
            entries.push(Entry::new(steep, "darker: steeper than 1"));
        }
        entries
    }

    fn distance_legend(&self, bodies: &Bodies<'_>) -> Vec<Entry> {
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
            entries.push(Entry::new(bands(bodies.inside(), inside), "inside"));
        }
        entries.extend(self.surface_entries(bodies));
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
