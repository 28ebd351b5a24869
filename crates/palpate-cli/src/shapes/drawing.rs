// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Drawings of primitives with their parameters.

use palpate::field::catalogue::Entry;
use palpate::field::kernel::{Argument, Mark, MarkKind, Parameter};
use palpate::field::{Aabb, Shape, Vector};
use palpate::plot::{
    Color, DimensionLine, Figure, Isolines, Markers, PlaneView, PlotError, Sampling, Slice,
};

use crate::outcome::Failure;
use crate::picture::{self, Dimensions, Drawable};

/// The colours of parameters, in their order.
const COLORS: [Color; 5] =
    [Color::PURPLE, Color::GREEN, Color::NAVY, Color::VERMILION, Color::INK];
/// From the primitive to a line beside it, as a share of its longest edge.
const BESIDE: f64 = 0.09;
/// Around the primitive and its lines, as a share of its longest edge.
const MARGIN: f64 = 0.14;

/// Isolines are so many times as far apart as in other pictures: the lines of the parameters
/// matter more.
const COARSER: f64 = 2.0;

/// A primitive's example with what is shown of it.
struct Specimen<'a, const D: usize> {
    entry: &'a Entry<D>,
    arguments: Vec<Argument>,
    shape: Shape<D>,
    marks: Vec<Mark<D>>,
    bounds: Aabb<D>,
}

/// The figure with views of the example of a primitive below.
pub(super) fn add<const D: usize>(figure: Figure, entry: &Entry<D>) -> Result<Figure, Failure>
where
    Dimensions: Drawable<D>,
{
    let specimen = Specimen::of(entry)?;
    let views = specimen.views().map_err(Failure::input)?;
    Ok(figure.with_views(views))
}

impl<'a, const D: usize> Specimen<'a, D>
where
    Dimensions: Drawable<D>,
{
    fn of(entry: &'a Entry<D>) -> Result<Self, Failure> {
        let arguments = entry.example_arguments().map_err(Failure::input)?;
        let shape = entry.build(&arguments).map_err(Failure::input)?;
        let marks = entry.marks(&arguments).map_err(Failure::input)?;
        let bounds = picture::shown_bounds(&shape);
        // Lengths of zero cannot be seen.
        let can_be_seen = |mark: &Mark<D>| mark.kind != MarkKind::Length || mark.length() > 0.0;
        let marks = marks.into_iter().filter(can_be_seen).collect();
        Ok(Self { entry, arguments, shape, marks, bounds })
    }

    /// A view for each plane that is needed; each mark is in the first that holds it.
    fn views(&self) -> Result<Vec<Isolines>, PlotError> {
        let planes = planes_of(&self.marks, &self.bounds)?;
        let mut left: Vec<&Mark<D>> = self.marks.iter().collect();
        let mut views = Vec::new();
        for plane in &planes {
            let (here, rest) = left.into_iter().partition(|mark| plane.holds(mark));
            left = rest;
            views.push(self.view(plane, here)?);
        }
        let step = COARSER * views.iter().map(Isolines::step).fold(0.0, f64::max);
        views.into_iter().map(|view| view.with_step(step)).collect()
    }

    fn view(&self, plane: &Named, marks: Vec<&Mark<D>>) -> Result<Isolines, PlotError> {
        let Named { slice, title } = plane;
        let window = Dimensions::view(slice, &self.bounds, 0.0)?;
        let longest = window.width().max(window.height());
        let mut sheet = Sheet { slice, step: BESIDE * longest, window, lines: Vec::new() };
        let mut positions = Vec::new();
        for mark in marks {
            match mark.kind {
                MarkKind::Position => positions.push(mark),
                _ => sheet.add(mark),
            }
        }
        let view = sheet.view(&positions, MARGIN * longest)?;
        let mut isolines = picture::isolines(&self.shape, slice, &view, Sampling::default())?
            .with_title(title);
        if slice.elevation([0.0; 3]).abs() < ON_PLANE {
            let origin = Markers::new("origin", [slice.project([0.0; 3])])?;
            isolines = isolines.with_markers(origin.with_color(Color::INK).small());
        }
        for line in sheet.lines {
            isolines = isolines.with_dimension(self.line(line)?);
        }
        if positions.is_empty() {
            return Ok(isolines);
        }
        let places = positions.iter().map(|mark| slice.project(mark.points[0].in_space().0));
        let names = positions.iter().map(|mark| mark.name());
        Ok(isolines.with_markers(
            Markers::new("points given", places)?.with_color(Color::INK).with_labels(names),
        ))
    }

    /// A dimension line of a mark, with the name of its parameter and the number.
    fn line(&self, line: Line<'_, D>) -> Result<DimensionLine, PlotError> {
        let place = self.entry.parameters.iter().position(|p| p.name == line.mark.parameter);
        let place = place.unwrap_or_default();
        let Parameter { name, about, .. } = self.entry.parameters[place];
        let value = match (line.mark.kind, &self.arguments[place]) {
            (MarkKind::Direction, _) => String::new(),
            (MarkKind::Angle, Argument::Number(angle)) => {
                format!(" {}°", written(angle.to_degrees(), 10.0))
            }
            (_, Argument::Number(number)) => format!(" {} m", written(*number, 1000.0)),
            _ => format!(" {} m", written(line.mark.length(), 1000.0)),
        };
        let color = COLORS[place % COLORS.len()];
        let drawn = DimensionLine::new(format!("{name}: {about}"), line.points)?
            .with_label(format!("{}{value}", line.mark.name()))
            .with_extensions(line.extensions)?
            .with_color(color);
        Ok(if line.mark.kind == MarkKind::Direction { drawn.one_way() } else { drawn })
    }
}

/// A number rounded to parts of one, as pictures write it.
pub(super) fn written(number: f64, parts: f64) -> String {
    // No −0.
    let rounded = (number * parts).round() / parts + 0.0;
    rounded.to_string().replace('-', "−")
}

/// A mark as a line in the plane [m].
struct Line<'a, const D: usize> {
    mark: &'a Mark<D>,
    points: Vec<[f64; 2]>,
    extensions: Vec<[[f64; 2]; 2]>,
}

/// The lines on a plane.
struct Sheet<'a, const D: usize> {
    slice: &'a Slice,
    /// What is around the primitive.
    window: PlaneView,
    /// From the primitive to a line beside it [m].
    step: f64,
    lines: Vec<Line<'a, D>>,
}

impl<'a, const D: usize> Sheet<'a, D> {
    fn add(&mut self, mark: &'a Mark<D>) {
        let project = |point: &Vector<f64, D>| self.slice.project(point.in_space().0);
        let points: Vec<_> = mark.points.iter().map(project).collect();
        let line = match mark.outwards {
            None => Line { mark, points, extensions: Vec::new() },
            Some(out) => {
                let out = self.slice.project_vector(out.in_space().0);
                let level = self.edge(out, &points) + self.step;
                let moved = |p: &[f64; 2]| {
                    let rise = level - dot(*p, out);
                    [p[0] + rise * out[0], p[1] + rise * out[1]]
                };
                let ends: Vec<_> = points.iter().map(moved).collect();
                let extensions = points.into_iter().zip(ends.iter().copied());
                let extensions = extensions.map(|(from, to)| [from, to]).collect();
                Line { mark, points: ends, extensions }
            }
        };
        self.lines.push(line);
    }

    /// How far the primitive reaches along `out`: its box along an axis, else what is measured.
    fn edge(&self, out: [f64; 2], points: &[[f64; 2]]) -> f64 {
        let measured = points.iter().map(|p| dot(*p, out)).fold(f64::NEG_INFINITY, f64::max);
        if out[0] != 0.0 && out[1] != 0.0 {
            return measured;
        }
        let half = [0.5 * self.window.width(), 0.5 * self.window.height()];
        let edge = dot(self.window.center(), out) + dot(half, out.map(f64::abs));
        edge.max(measured)
    }

    /// The window of the primitive and its lines, with `room` around them [m].
    fn view(&self, positions: &[&Mark<D>], room: f64) -> Result<PlaneView, PlotError> {
        let lines = self.lines.iter().flat_map(|line| line.points.iter().copied());
        let positions = positions.iter().flat_map(|mark| &mark.points);
        let positions = positions.map(|point| self.slice.project(point.in_space().0));
        let (mut min, mut max) = (self.window.min(), self.window.max());
        for point in lines.chain(positions) {
            for k in 0..2 {
                min[k] = min[k].min(point[k]);
                max[k] = max[k].max(point[k]);
            }
        }
        PlaneView::from_bounds(min.map(|x| x - room), max.map(|x| x + room), 0.0)
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// A point this far from a plane is on it [m]: more than rounding, less than a line is wide.
pub(super) const ON_PLANE: f64 = 1e-9;

/// A plane and what the picture calls it.
#[derive(Debug)]
pub(super) struct Named {
    pub(super) slice: Slice,
    pub(super) title: String,
}

impl Named {
    fn new(slice: Slice, title: impl Into<String>) -> Self {
        Self { slice, title: title.into() }
    }

    /// `true` if the plane holds all points of `mark`.
    pub(super) fn holds<const D: usize>(&self, mark: &Mark<D>) -> bool {
        let mut points = mark.points.iter().map(|point| point.in_space());
        points.all(|point| self.slice.elevation(point.0).abs() < ON_PLANE)
    }
}

/// The planes that show all of `marks`: those along the axes, if these are enough, or else planes
/// through the marks. If the plane z = 0 holds all marks, the view from above is at half the
/// height.
fn planes_of<const D: usize>(
    marks: &[Mark<D>],
    bounds: &Aabb<D>,
) -> Result<Vec<Named>, PlotError> {
    if D == 2 {
        return Ok(vec![Named::new(Slice::planar(), "in the plane")]);
    }
    let front = Named::new(Slice::xy(0.0)?, "z = 0, from the front");
    let above = Named::new(Slice::xz(0.0)?, "y = 0, from above");
    let beyond: Vec<_> = marks.iter().filter(|mark| !front.holds(mark)).collect();
    if beyond.is_empty() {
        // Rounded, so that the title is true.
        let y = (100.0 * bounds.centre()[1]).round() / 100.0;
        let title = format!("y = {}, from above", written(y, 100.0));
        return Ok(vec![front, Named::new(Slice::xz(y)?, title)]);
    }
    if beyond.iter().all(|mark| above.holds(mark)) {
        return Ok(vec![front, above]);
    }
    let first = through_first(marks)?;
    let (held, mut rest): (Vec<_>, Vec<_>) =
        marks.iter().cloned().partition(|mark| first.holds(mark));
    if rest.is_empty() {
        return Ok(vec![first]);
    }
    // What the first plane misses comes first.
    rest.extend(held);
    Ok(vec![first, through_first(&rest)?])
}

/// The plane through the first two points and the middle of the others.
fn through_first<const D: usize>(marks: &[Mark<D>]) -> Result<Named, PlotError> {
    let points: Vec<_> = marks
        .iter()
        .flat_map(|mark| mark.points.iter().map(|point| point.in_space()))
        .collect();
    let positions = marks.iter().filter(|mark| mark.kind == MarkKind::Position).take(2);
    let names: Vec<_> = positions.map(Mark::name).collect();
    let names = if names.is_empty() { "the origin".to_owned() } else { names.join(" and ") };
    Ok(Named::new(through(&points)?, format!("through {names}")))
}

/// The plane through two points and the middle of the others, with y as far up as it goes; if they
/// lie in a line, the upright plane through it.
fn through(points: &[Vector<f64, 3>]) -> Result<Slice, PlotError> {
    let [first, second, others @ ..] = points else { return Slice::xy(0.0) };
    let up = Vector::<f64, 3>::unit(1);
    let sum = others.iter().fold(Vector::ZERO, |sum, point| sum + *point);
    let middle = sum * (1.0 / others.len().max(1) as f64);
    let across = |to: Vector<f64, 3>| {
        let normal = (*second - *first).cross(to);
        (normal.norm() > ON_PLANE).then_some(normal).and_then(Vector::normalized)
    };
    let normal = across(middle - *first).or_else(|| across(up)).unwrap_or(Vector::unit(2));
    // Seen from the side of +z.
    let normal = if normal[2] < 0.0 { -normal } else { normal };
    let right = up.cross(normal).normalized().unwrap_or(Vector::unit(0));
    // The foot of the origin, so that coordinates in the plane are measured from there.
    let foot = normal * first.dot(normal);
    Slice::free(foot.0, right.0, normal.cross(right).0)
}
