// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Dimension lines over isolines.

use crate::drawing::{Drawing, Path, Stroke};
use crate::error::{PlotError, finite_points};
use crate::geometry::{Point, clip_line, clip_segment, distance};
use crate::isolines::Isolines;
use crate::labels::{Occupied, place_along, place_at_point};
use crate::legend::Frame;
use crate::overlay::Overlay;
use crate::palette::Color;
use crate::text::Text;

/// Width of the line and of extension lines [px].
const LINE: f64 = 1.8;
const EXTENSION: f64 = 0.9;
/// Length of an arrow head [px], and its half width as a share of it.
const HEAD: f64 = 9.0;
const SLENDER: f64 = 0.34;
/// Shares of the line where its label may stand, the best first.
const PLACES: [f64; 5] = [0.5, 0.65, 0.35, 0.8, 0.2];

/// A line with an arrow head at each end that shows a length or, along an arc, an angle. In plane
/// coordinates \[m\].
///
/// # Examples
///
/// ```
/// use palpate_plot::DimensionLine;
///
/// let below = DimensionLine::new("width: from side to side", [[-0.1, -0.2], [0.1, -0.2]])?
///     .with_label("width 0.2 m")
///     .with_extensions([[[-0.1, -0.15], [-0.1, -0.2]], [[0.1, -0.15], [0.1, -0.2]]])?;
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DimensionLine {
    pub(crate) name: String,
    pub(crate) color: Option<Color>,
    label: String,
    points: Vec<[f64; 2]>,
    extensions: Vec<[[f64; 2]; 2]>,
    has_tail: bool,
}

impl DimensionLine {
    /// A line along `points` \[m\], called `name` in the legend.
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
        let (label, extensions) = (String::new(), Vec::new());
        Ok(Self { name, color: None, label, points, extensions, has_tail: true })
    }

    /// With a label beside the middle.
    #[must_use]
    pub fn with_label(self, label: impl Into<String>) -> Self {
        Self { label: label.into(), ..self }
    }

    /// With thin lines \[m\] from what is measured to the ends, where the line lies beside it.
    ///
    /// # Errors
    ///
    /// [`PlotError::Point`].
    pub fn with_extensions(
        self,
        extensions: impl IntoIterator<Item = [[f64; 2]; 2]>,
    ) -> Result<Self, PlotError> {
        let extensions = Vec::from_iter(extensions);
        finite_points(&self.name, extensions.as_flattened())?;
        Ok(Self { extensions, ..self })
    }

    /// With a head at the last point alone, as an arrow.
    #[must_use]
    pub fn one_way(self) -> Self {
        Self { has_tail: false, ..self }
    }

    /// With this colour instead of the next of the palette.
    #[must_use]
    pub fn with_color(self, color: Color) -> Self {
        Self { color: Some(color), ..self }
    }

    /// How its line is drawn.
    pub(crate) fn stroke(color: Color) -> Stroke {
        Stroke::new(color, LINE)
    }

    /// Marks the room that the line covers as occupied.
    pub(crate) fn occupy(&self, frame: &Frame, occupied: &mut Occupied) {
        clip_line(&frame.pixels(&self.points), &frame.plot)
            .into_iter()
            .for_each(|piece| occupied.add_line(piece));
    }

    /// Finds a place for the label.
    pub(crate) fn place_label(
        &self,
        frame: &Frame,
        occupied: &mut Occupied,
    ) -> Option<Text<'_>> {
        if self.label.is_empty() {
            return None;
        }
        let line = frame.pixels(&self.points);
        if let [a, b] = line[..]
            && let Some((a, b)) = clip_segment(a, b, &frame.plot)
            && let Some(text) = place_along([a, b], &self.label, &frame.plot, occupied)
        {
            return Some(text);
        }
        let places = PLACES.iter().map(|share| along(&line, *share));
        let mut inside = places.filter(|place| frame.plot.contains(*place));
        inside.find_map(|place| place_at_point(place, &self.label, &frame.plot, occupied))
    }

    pub(crate) fn draw(&self, drawing: &mut Drawing, frame: &Frame, color: Color) {
        let mut thin = Path::default();
        for extension in &self.extensions {
            let pieces = clip_line(&frame.pixels(extension), &frame.plot);
            pieces.iter().for_each(|piece| thin.add_line(piece));
        }
        drawing.stroke(thin, Stroke::new(color, EXTENSION));
        let line = frame.pixels(&self.points);
        let mut path = Path::default();
        clip_line(&line, &frame.plot).iter().for_each(|piece| path.add_line(piece));
        let rim = Stroke::new(Color::WHITE, LINE + 2.0).with_opacity(0.85);
        drawing.stroke(path.clone(), rim);
        drawing.stroke(path, Self::stroke(color));
        if let [first, second, ..] = line[..]
            && let [.., before, last] = line[..]
        {
            let length: f64 = line.windows(2).map(|pair| distance(pair[0], pair[1])).sum();
            let heads = [(second, first, self.has_tail), (before, last, true)];
            for (from, tip, is_drawn) in heads {
                if is_drawn && frame.plot.contains(tip) {
                    draw_head(drawing, [from, tip], length, color);
                }
            }
        }
    }
}

impl Isolines {
    /// With a dimension line over the isolines.
    #[must_use]
    pub fn with_dimension(mut self, line: DimensionLine) -> Self {
        self.overlays.push(Overlay::Dimension(line));
        self
    }
}

/// Draws the head of an arrow that comes from the first of both points; half of a short line at
/// most.
fn draw_head(drawing: &mut Drawing, [from, tip]: [Point; 2], length: f64, color: Color) {
    let span = distance(from, tip);
    if span == 0.0 {
        return;
    }
    let head = HEAD.min(0.45 * length);
    let back = [0, 1].map(|k| head * (from[k] - tip[k]) / span);
    let side = [-SLENDER * back[1], SLENDER * back[0]];
    let corner = |sign: f64| [0, 1].map(|k| tip[k] + back[k] + sign * side[k]);
    let ring = [tip, corner(1.0), corner(-1.0)];
    let rim = Stroke::new(Color::WHITE, 1.6).with_opacity(0.85);
    drawing.fill_with_rim(Path::ring(&ring), color, rim);
}

/// The point at a share of the length of a line.
fn along(line: &[Point], share: f64) -> Point {
    let lengths = line.windows(2).map(|pair| distance(pair[0], pair[1]));
    let mut rest = share * lengths.sum::<f64>();
    for pair in line.windows(2) {
        let length = distance(pair[0], pair[1]);
        if rest <= length && length > 0.0 {
            return [0, 1].map(|k| pair[0][k] + rest / length * (pair[1][k] - pair[0][k]));
        }
        rest -= length;
    }
    line.last().copied().unwrap_or([f64::NAN; 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_of_a_line_counts_its_length() {
        let line = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0]];
        assert_eq!(along(&line, 0.5), [2.0, 0.0]);
        assert_eq!(along(&line, 0.875), [3.0, 0.5]);
        assert!(along(&[], 0.5)[0].is_nan());
    }

    #[test]
    fn points_must_be_finite() {
        let error = DimensionLine::new("radius", [[0.0, 0.0], [f64::NAN, 0.0]]).unwrap_err();
        assert_eq!(error.to_string(), "point 1 of \"radius\" must be finite, got (NaN, 0)");
        let line = DimensionLine::new("radius", [[0.0, 0.0], [1.0, 0.0]]).unwrap();
        assert!(line.with_extensions([[[0.0, 0.0], [0.0, f64::INFINITY]]]).is_err());
    }
}
