// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The planes on which a primitive's marks can be seen.

use palpate::field::kernel::{Mark, MarkKind};
use palpate::field::{Aabb, Vector};
use palpate::plot::{PlotError, Slice};

use super::drawing::written;

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
/// through the marks. What is seen from above is cut at half its height, if that holds them too.
pub(super) fn of<const D: usize>(
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
