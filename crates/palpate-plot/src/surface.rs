// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Distances from the surface that a picture finds.

use crate::contours::rings;
use crate::error::PlotError;
use crate::geometry::{Point, Rect, distance};
use crate::nearest::Nearest;
use crate::sampling::{Samples, Sampling};
use crate::slope::Slope;
use crate::view::View;

/// The surface is searched in a square this many window sizes wide.
const WIDER: f64 = 3.0;

/// The surface in and around a window, in plane coordinates [m].
#[derive(Debug, Clone)]
pub(crate) struct Surface {
    /// The surface found in the window, and the one found around it.
    parts: Vec<Part>,
    /// The searched part of the plane.
    region: Rect,
}

/// The surface as one grid finds it.
#[derive(Debug, Clone)]
struct Part {
    nearest: Nearest,
    /// The largest distance between the found and the true surface.
    error: f64,
    /// The last evaluated point and its distance, since the next point is mostly beside it.
    last: (Point, f64),
}

impl Surface {
    /// The zero isolines of `samples` in `view`, and around it those of samples three times as
    /// coarse. Samples on creases at zero count as surface too, because curves without interior
    /// and slits without width have no zero isoline.
    ///
    /// # Errors
    ///
    /// [`PlotError::Sample`] for the first value that is not a length.
    pub(crate) fn find(
        view: &View,
        samples: &Samples,
        sampling: Sampling,
        mut field: impl FnMut(&[[f64; 2]], &mut [Slope]),
    ) -> Result<Self, PlotError> {
        let window = rect(view);
        let is_in_window = |p: &Point| window.contains(*p);
        let size = view.width().max(view.height());
        let inner = Part::new(samples, size, is_in_window);
        // Windows close to the largest are not widened.
        let Ok(wide) = View::new(view.center(), WIDER * view.width(), WIDER * view.height())
        else {
            return Ok(Self { parts: vec![inner], region: window });
        };
        let region = rect(&wide);
        let mut slopes = Vec::new();
        let around = Samples::new(&wide, sampling, |points, values| {
            slopes.resize(points.len(), Slope::default());
            field(points, &mut slopes);
            values.iter_mut().zip(&slopes).for_each(|(value, slope)| *value = slope.value);
        })?;
        let outer = Part::new(&around, size, |p| region.contains(*p) && !is_in_window(p));
        Ok(Self { parts: vec![inner, outer], region })
    }

    /// `value` [m] over the distance of `p` from the surface. Of the ratios that the picture's
    /// error allows, it is the one nearest to one, so a ratio other than one is certain. `None`
    /// where a nearer surface may lie outside the searched part.
    pub(crate) fn ratio(&mut self, p: Point, value: f64) -> Option<f64> {
        let mut range = [f64::INFINITY; 2];
        for part in &mut self.parts {
            let found = part.distance(p);
            range = [range[0].min(found - part.error), range[1].min(found + part.error)];
        }
        let to_edge = (0..2)
            .map(|i| (p[i] - self.region.min[i]).min(self.region.max[i] - p[i]))
            .fold(f64::INFINITY, f64::min);
        let [nearest, farthest] = range;
        if nearest > to_edge {
            return None;
        }
        let least = value.abs() / farthest;
        // Within the error of the surface, any ratio is possible.
        let most = if nearest > 0.0 { value.abs() / nearest } else { f64::INFINITY };
        Some(1.0_f64.max(least).min(most))
    }
}

impl Part {
    /// The segments of surface in `samples` that have an end where `is_here`.
    fn new(samples: &Samples, size: f64, is_here: impl Fn(&Point) -> bool) -> Self {
        let mut segments = segments(samples);
        segments.retain(|[a, b]| is_here(a) || is_here(b));
        Self {
            nearest: Nearest::new(segments, size),
            error: samples.cell,
            last: ([0.0; 2], 0.0),
        }
    }

    fn distance(&mut self, p: Point) -> f64 {
        let (before, distance_before) = self.last;
        let found = self.nearest.distance(p, distance_before - distance(before, p));
        self.last = (p, if found.is_finite() { found } else { 0.0 });
        found
    }
}

fn rect(view: &View) -> Rect {
    Rect { min: view.min(), max: view.max() }
}

/// Segments of zero isolines, and samples that a curve or a slit may touch.
fn segments(samples: &Samples) -> Vec<[Point; 2]> {
    let points =
        (0..samples.values.len()).filter(|&i| touches_crease(samples, i)).map(|index| {
            let place = [index % samples.columns, index / samples.columns];
            [[0, 1].map(|i| samples.origin[i] + (place[i] as f64 + 0.5) * samples.cell); 2]
        });
    let rings = rings(samples, 0.0);
    let edges = rings.iter().flat_map(|ring| ring.windows(2).map(|pair| [pair[0], pair[1]]));
    edges.chain(points).collect()
}

/// `true` if a sample is within half a cell's diagonal of zero and on a crease, as a distance
/// has across a curve. If the distance is exact, then along one axis the sum of the sample's
/// neighbours exceeds twice its value by at least 0.7 cells.
fn touches_crease(samples: &Samples, index: usize) -> bool {
    const LEAST_CREASE: f64 = 0.5;
    let size = |index: usize| samples.values.get(index).map(|value| value.abs());
    let here = samples.values[index].abs();
    let is_crease = |stride: usize| {
        let around = index.checked_sub(stride).and_then(size).zip(size(index + stride));
        around.is_some_and(|(a, b)| a + b - 2.0 * here > LEAST_CREASE * samples.cell)
    };
    here <= std::f64::consts::FRAC_1_SQRT_2 * samples.cell
        && (is_crease(1) || is_crease(samples.columns))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(field: fn(Point) -> f64) -> (Surface, f64) {
        let view = View::new([0.5, 0.0], 4.0, 3.0).unwrap();
        let sampling = Sampling::new(200).unwrap();
        let samples = Samples::new(&view, sampling, |points, values| {
            points.iter().zip(values).for_each(|(p, value)| *value = field(*p));
        })
        .unwrap();
        let slopes = |points: &[[f64; 2]], slopes: &mut [Slope]| {
            points.iter().zip(slopes).for_each(|(p, slope)| slope.value = field(*p));
        };
        let cell = samples.cell;
        (Surface::find(&view, &samples, sampling, slopes).unwrap(), cell)
    }

    #[test]
    fn exact_distances_have_the_ratio_one() {
        let disc = |p: Point| p[0].hypot(p[1]) - 1.0;
        let circle = |p: Point| (p[0].hypot(p[1]) - 1.0).abs();
        let beyond = |p: Point| p[0] - 2.7; // its surface is right of the window
        for field in [disc, circle, beyond] {
            let (mut surface, _) = surface(field);
            for i in 0..50 {
                let i = f64::from(i);
                let p = [4.0 * (0.618 * i).fract() - 1.5, 3.0 * (0.414 * i).fract() - 1.5];
                // The edge of the searched part is at least 3 away.
                let ratio = surface.ratio(p, field(p));
                assert!(ratio == Some(1.0) || ratio.is_none() && field(p).abs() > 2.9, "{p:?}");
            }
        }
    }

    #[test]
    fn loose_and_steep_values_have_their_ratios() {
        let (mut surface, cell) = surface(|p| 0.25 * (p[0].hypot(p[1]) - 1.0));
        let ratio = surface.ratio([2.0, 0.0], 0.25).unwrap();
        assert!(ratio >= 0.25 && ratio < 0.25 / (1.0 - 3.0 * cell), "{ratio}");
        let steep = surface.ratio([2.0, 0.0], 2.0).unwrap();
        assert!(steep <= 2.0 && steep > 2.0 / (1.0 + 3.0 * cell), "{steep}");
    }

    #[test]
    fn a_value_of_zero_on_the_surface_has_the_ratio_one() {
        let (mut surface, _) = surface(|p| p[0]);
        assert_eq!(surface.ratio([0.0, 0.3], 0.0), Some(1.0));
        assert_eq!(surface.ratio([0.5, 0.3], 0.0), Some(0.0));
    }

    #[test]
    fn nothing_is_said_where_the_surface_may_be_out_of_sight() {
        let (mut surface, _) = surface(|_| 1.0);
        assert_eq!(surface.ratio([0.5, 0.0], 1.0), None);
    }
}
