// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Marks over a picture.

use crate::dimension::DimensionLine;
use crate::error::{LARGEST, PlotError, finite_points};
use crate::geometry::{Point, distance, nearest_on_segment};
use crate::palette::Color;

/// How a line is broken, which tells lines apart without colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dash {
    /// Unbroken.
    Solid,
    /// Long strokes.
    Dashed,
    /// Dots.
    Dotted,
}

impl Dash {
    /// The dash of line number `index`, if none is given.
    pub(crate) fn of_series(index: usize) -> Self {
        [Self::Solid, Self::Dashed, Self::Dotted][index % 3]
    }

    /// Lengths of strokes and gaps [px] of a line `width` [px] wide with round ends.
    pub(crate) fn lengths(self, width: f64) -> Vec<f64> {
        match self {
            Self::Solid => Vec::new(),
            Self::Dashed => vec![3.2 * width, 2.8 * width],
            Self::Dotted => vec![0.1, 2.7 * width],
        }
    }
}

/// A named path over the isolines, in plane coordinates \[m\].
///
/// Project points of space with [`Slice::project`](crate::Slice::project).
///
/// # Examples
///
/// ```
/// use palpate_plot::{Color, Dash, Polyline};
///
/// let hand = Polyline::new("hand", [[0.0, 0.0], [0.1, 0.02]])?
///     .with_color(Color::PURPLE)
///     .with_dash(Dash::Dashed);
/// let error = Polyline::new("hand", [[0.0, f64::NAN]]).unwrap_err();
/// assert_eq!(error.to_string(), "point 0 of \"hand\" must be finite, got (0, NaN)");
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    pub(crate) name: String,
    pub(crate) pieces: Vec<Vec<[f64; 2]>>,
    pub(crate) color: Option<Color>,
    pub(crate) dash: Option<Dash>,
    pub(crate) is_faint: bool,
}

impl Polyline {
    /// The path through `points` \[m\], called `name` in the legend.
    ///
    /// # Errors
    ///
    /// [`PlotError::Point`].
    pub fn new(
        name: impl Into<String>,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> Result<Self, PlotError> {
        Self::of_pieces(name, [Vec::from_iter(points)])
    }

    /// The path of which only `pieces` \[m\] are drawn, such as those near a slice.
    ///
    /// # Errors
    ///
    /// [`PlotError::Point`], with the index counted through all pieces.
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_plot::Polyline;
    ///
    /// let pieces = [vec![[0.0, 0.0], [0.1, 0.0]], vec![[0.2, 0.0], [0.3, 0.1]]];
    /// let behind = Polyline::of_pieces("behind the slice", pieces)?.faint();
    /// # Ok::<(), palpate_plot::PlotError>(())
    /// ```
    pub fn of_pieces(
        name: impl Into<String>,
        pieces: impl IntoIterator<Item = Vec<[f64; 2]>>,
    ) -> Result<Self, PlotError> {
        let (name, pieces) = (name.into(), Vec::from_iter(pieces));
        finite_points(&name, &pieces.concat())?;
        Ok(Self { name, pieces, color: None, dash: None, is_faint: false })
    }

    /// Thin and grey, for lines that matter less; unbroken unless a dash is given.
    #[must_use]
    pub fn faint(self) -> Self {
        Self { is_faint: true, ..self }
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

/// A vector drawn from a point of the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrow {
    /// Where it starts, in plane coordinates \[m\].
    pub tail: [f64; 2],
    /// The vector, along the axes of the plane, in its own unit.
    pub vector: [f64; 2],
}

/// Named arrows over the isolines: forces, velocities, normals.
///
/// # Examples
///
/// ```
/// use palpate_plot::{Arrow, Arrows};
///
/// let forces = [Arrow { tail: [0.02, 0.0], vector: [1.5, 0.0] }];
/// let forces = Arrows::new("contact force", "N", forces)?; // the legend shows its scale
/// let normals = [Arrow { tail: [0.02, 0.0], vector: [1.0, 0.0] }];
/// let normals = Arrows::directions("normal", normals)?; // all of one length
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Arrows {
    pub(crate) name: String,
    /// Unit of the vectors, or `None` where only the direction counts.
    pub(crate) unit: Option<String>,
    pub(crate) arrows: Vec<Arrow>,
    pub(crate) color: Option<Color>,
    /// The length of the vector drawn at full length, in its unit; that of the longest if
    /// `None`.
    pub(crate) full: Option<f64>,
}

impl Arrows {
    /// Arrows in proportion to their vectors, whose `unit` the legend names.
    ///
    /// # Errors
    ///
    /// [`PlotError::Point`] for a tail or vector that is not finite.
    pub fn new(
        name: impl Into<String>,
        unit: impl Into<String>,
        arrows: impl IntoIterator<Item = Arrow>,
    ) -> Result<Self, PlotError> {
        Ok(Self { unit: Some(unit.into()), ..Self::directions(name, arrows)? })
    }

    /// Arrows of one length in the directions of their vectors; zero vectors are left out.
    ///
    /// # Errors
    ///
    /// [`PlotError::Point`] for a tail or vector that is not finite.
    pub fn directions(
        name: impl Into<String>,
        arrows: impl IntoIterator<Item = Arrow>,
    ) -> Result<Self, PlotError> {
        let (name, arrows) = (name.into(), Vec::from_iter(arrows));
        let points = |part: fn(&Arrow) -> [f64; 2]| Vec::from_iter(arrows.iter().map(part));
        finite_points(&name, &points(|arrow| arrow.tail))?;
        finite_points(&name, &points(|arrow| arrow.vector))?;
        Ok(Self { name, unit: None, arrows, color: None, full: None })
    }

    /// With this colour instead of the next of the palette.
    #[must_use]
    pub fn with_color(self, color: Color) -> Self {
        Self { color: Some(color), ..self }
    }

    /// With this length \[unit\] drawn at full length instead of the largest of these arrows,
    /// for several pictures of one scale. Ignored unless positive.
    #[must_use]
    pub fn with_full_length(self, length: f64) -> Self {
        let full = (length > 0.0 && length <= LARGEST).then_some(length);
        Self { full, ..self }
    }

    /// The length of the vector drawn longest, in its unit.
    pub(crate) fn longest(&self) -> f64 {
        let lengths = self.arrows.iter().map(|arrow| arrow.vector[0].hypot(arrow.vector[1]));
        self.full.unwrap_or_else(|| lengths.fold(0.0, f64::max))
    }
}

/// Named points over the isolines, with or without labels, in plane coordinates \[m\].
///
/// # Examples
///
/// ```
/// use palpate_plot::Markers;
///
/// let contacts = Markers::new("contact", [[0.02, 0.0], [-0.02, 0.0]])?.with_labels(["A", "B"]);
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Markers {
    pub(crate) name: String,
    pub(crate) points: Vec<[f64; 2]>,
    pub(crate) labels: Vec<String>,
    pub(crate) color: Option<Color>,
    pub(crate) is_small: bool,
}

impl Markers {
    /// Marks `points` \[m\], called `name` in the legend.
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
        Ok(Self { name, points, labels: Vec::new(), color: None, is_small: false })
    }

    /// Dots of half the size, for many points along a line. They take no symbol from the
    /// others.
    #[must_use]
    pub fn small(self) -> Self {
        Self { is_small: true, ..self }
    }

    /// With a label at each point, in order; points beyond the last label have none.
    #[must_use]
    pub fn with_labels<T: Into<String>>(self, labels: impl IntoIterator<Item = T>) -> Self {
        Self { labels: labels.into_iter().map(Into::into).collect(), ..self }
    }

    /// With this colour instead of the next of the palette.
    #[must_use]
    pub fn with_color(self, color: Color) -> Self {
        Self { color: Some(color), ..self }
    }
}

/// An overlay of isolines.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Overlay {
    Polyline(Polyline),
    Arrows(Arrows),
    Markers(Markers),
    Dimension(DimensionLine),
}

/// The extremes of the numbers that the colours of a picture show, with their places in plane
/// coordinates \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The smallest number; of ratios, that of the loosest value.
    pub smallest: f64,
    /// The first place where it was found.
    pub smallest_at: [f64; 2],
    /// The largest number; of ratios, above one where values are too steep.
    pub largest: f64,
    /// The first place where it was found.
    pub largest_at: [f64; 2],
    /// The share of the picture without a number: of ratios, where the bounds of the distance
    /// leave them open.
    pub open: f64,
}

impl Measured {
    /// The extremes of the numbers at some places; `None` if there is no number.
    pub(crate) fn of(
        numbers: impl ExactSizeIterator<Item = (Point, Option<f64>)>,
    ) -> Option<Self> {
        let count = numbers.len();
        let known: Vec<_> = numbers.filter_map(|(at, x)| Some((at, x?))).collect();
        let smallest = known.iter().copied().reduce(|a, b| if b.1 < a.1 { b } else { a })?;
        let largest = known.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a })?;
        Some(Self {
            smallest: smallest.1,
            smallest_at: smallest.0,
            largest: largest.1,
            largest_at: largest.0,
            open: 1.0 - known.len() as f64 / count as f64,
        })
    }
}

/// Buckets along the longer side: few segments in each, and few empty ones to cross.
const BUCKETS: f64 = 24.0;

/// Segments, sorted into square buckets.
#[derive(Debug, Clone)]
pub(crate) struct Nearest {
    segments: Vec<[Point; 2]>,
    min: Point,
    /// Edge of a bucket.
    edge: f64,
    count: [i64; 2],
    /// Indices of the segments whose boxes meet a bucket.
    buckets: Vec<Vec<usize>>,
}

impl Nearest {
    /// Sorts `segments`; a point is a segment of no length. `size` is about the extent of the
    /// points that [`distance`](Self::distance) is called with. It keeps the buckets of small
    /// sets of segments so large that a search crosses few.
    pub(crate) fn new(segments: Vec<[Point; 2]>, size: f64) -> Self {
        let ends = || segments.iter().flatten();
        let bound = |i: usize, start: f64, pick: fn(f64, f64) -> f64| {
            ends().map(|p| p[i]).fold(start, pick)
        };
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        let min = [0, 1].map(|i| bound(i, low, f64::min));
        let extent = [0, 1].map(|i| bound(i, high, f64::max) - min[i]);
        let edge = extent[0].max(extent[1]).max(size) / BUCKETS;
        let count = extent.map(|side| (side.max(0.0) / edge) as i64 + 1);
        let empty = vec![Vec::new(); (count[0] * count[1]) as usize];
        let mut nearest = Self { segments: Vec::new(), min, edge, count, buckets: empty };
        for (index, &[a, b]) in segments.iter().enumerate() {
            let (a, b) = (nearest.bucket(a), nearest.bucket(b));
            for row in a[1].min(b[1])..=a[1].max(b[1]) {
                for column in a[0].min(b[0])..=a[0].max(b[0]) {
                    if let Some(bucket) = nearest.index([column, row]) {
                        nearest.buckets[bucket].push(index);
                    }
                }
            }
        }
        Self { segments, ..nearest }
    }

    /// The distance from `p` to the nearest segment, infinite if there is none. The caller
    /// knows that it is `at_least` this.
    ///
    /// Searches rings of buckets around that of `p` until no farther ring can hold a nearer
    /// segment.
    pub(crate) fn distance(&self, p: Point, at_least: f64) -> f64 {
        if self.segments.is_empty() {
            return f64::INFINITY;
        }
        // The nearest point so far, and the square of its distance in edges: a square of a
        // length in metres could underflow.
        let (mut nearest, mut square) = ([f64::INFINITY; 2], f64::INFINITY);
        let per_edge = 1.0 / self.edge;
        let [x, y] = self.bucket(p);
        // The nearest and the farthest ring that meet the buckets, also from outside them.
        let gap = |i: i64, count: i64| (-i).max(i - count + 1).max(0);
        let far = |i: i64, count: i64| i.abs().max((count - 1 - i).abs());
        let first = gap(x, self.count[0]).max(gap(y, self.count[1]));
        let last = far(x, self.count[0]).max(far(y, self.count[1]));
        // Ring k reaches (k + 1)·√2 edges far; one ring more for rounding.
        let reached = (at_least / (std::f64::consts::SQRT_2 * self.edge)) as i64 - 2;
        for ring in first.max(reached)..=last {
            if square.sqrt() <= (ring - 1) as f64 {
                break;
            }
            for offset in -ring..=ring {
                let sides = [
                    [x + offset, y - ring],
                    [x + offset, y + ring],
                    [x - ring, y + offset],
                    [x + ring, y + offset],
                ];
                for bucket in sides.into_iter().filter_map(|at| self.index(at)) {
                    for &[a, b] in self.buckets[bucket].iter().map(|&i| &self.segments[i]) {
                        let q = nearest_on_segment(p, a, b);
                        let [dx, dy] = [0, 1].map(|i| (p[i] - q[i]) * per_edge);
                        if dx * dx + dy * dy < square {
                            (nearest, square) = (q, dx * dx + dy * dy);
                        }
                    }
                }
            }
        }
        distance(p, nearest)
    }

    /// The column and row of the bucket of `p`, also outside all buckets.
    fn bucket(&self, p: Point) -> [i64; 2] {
        [0, 1].map(|i| ((p[i] - self.min[i]) / self.edge).floor() as i64)
    }

    fn index(&self, [column, row]: [i64; 2]) -> Option<usize> {
        let is_inside =
            (0..self.count[0]).contains(&column) && (0..self.count[1]).contains(&row);
        is_inside.then_some((row * self.count[0] + column) as usize)
    }
}

#[cfg(test)]
mod nearest_tests {
    use super::*;
    use crate::geometry::distance_to_segment;

    #[test]
    fn distances_are_those_of_a_search_of_all() {
        let at = |i: usize, f: f64| (i as f64 * f).fract();
        let segments = Vec::from_iter((0..500).map(|i| {
            let a = [3.0 * at(i, 0.618), at(i, 0.414)];
            [a, [a[0] + 0.1 * at(i, 0.732), a[1] - 0.05 * at(i, 0.236)]]
        }));
        let nearest = Nearest::new(segments.clone(), 1.0);
        for i in 0..400 {
            let p = [6.0 * at(i, 0.302) - 2.0, 5.0 * at(i, 0.791) - 2.0];
            let expected = segments
                .iter()
                .map(|&[a, b]| distance_to_segment(p, a, b))
                .fold(f64::INFINITY, f64::min);
            for known in [0.0, 0.5, 0.999] {
                assert_eq!(nearest.distance(p, known * expected), expected, "{p:?}");
            }
        }
    }

    #[test]
    fn one_point_and_none_have_distances() {
        assert_eq!(Nearest::new(vec![[[1.0, 2.0]; 2]], 5.0).distance([4.0, 6.0], 0.0), 5.0);
        assert_eq!(Nearest::new(Vec::new(), 5.0).distance([4.0, 6.0], 0.0), f64::INFINITY);
    }
}
