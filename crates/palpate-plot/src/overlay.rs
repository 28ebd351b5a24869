// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Overlays of isolines: paths, arrows and points.

use crate::dimension::DimensionLine;
use crate::error::{LARGEST, PlotError, finite_points};
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
