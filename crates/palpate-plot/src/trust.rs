// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Promises and how values compare with them, as colours.

use crate::drawing::{Drawing, Image, Stroke};
use crate::error::PlotError;
use crate::geometry::{Point, Rect};
use crate::labels::Hatching;
use crate::legend::{Entry, Key};
use crate::overlay::Measured;
use crate::palette::Color;
use crate::scale::{draw_bar, write};
use crate::slope::Pixels;

/// The promise of a field's values f on one side of the surface, at the distance d from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Promised {
    /// |f| = d.
    Exact,
    /// |f| ≤ d.
    Bound,
    /// |f| ≤ L·d with this L.
    Lipschitz(f64),
}

/// A field's value at a point, beside bounds of the distance that it stands for.
///
/// # Examples
///
/// ```
/// use palpate_plot::Comparison;
///
/// let loose = Comparison { value: -0.1, distance: [0.2, 0.25] };
/// assert_eq!(loose.ratio(), [0.4, 0.5]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// The value \[m\].
    pub value: f64,
    /// The distance to the nearest surface is at least, and at most, this \[m\]; not negative,
    /// and infinite above where no surface was found.
    pub distance: [f64; 2],
}

impl Comparison {
    /// The value's size over the distance is at least, and at most, this.
    #[must_use]
    pub fn ratio(&self) -> [f64; 2] {
        let [nearest, farthest] = self.distance;
        let over = |distance: f64, at_zero: f64| {
            if distance > 0.0 { self.value.abs() / distance } else { at_zero }
        };
        [over(farthest, 0.0), over(nearest, f64::INFINITY)]
    }

    /// The ratio nearest to one that the bounds allow; `None` if they leave it open.
    fn measured(&self) -> Option<f64> {
        let [low, high] = self.ratio();
        (high - low <= OPEN).then(|| 1.0_f64.max(low).min(high))
    }
}

/// Colours of values that are too small and too large; the pair differs under colour
/// deficiencies.
const LOOSE: Color = Color::rgb(0x45, 0x1C, 0x70);
const STEEP: Color = Color::rgb(0xC4, 0x4A, 0x00);
/// A ratio is open if its bounds differ by more than this.
const OPEN: f64 = 0.1;
/// The colour where the ratio is open.
const UNKNOWN: Color = Color::rgb(0x8C, 0x92, 0x9B);
/// Lines of a hatching are this far apart [px].
const HATCH: f64 = 13.0;

impl Promised {
    pub(crate) fn tint(self) -> Color {
        match self {
            Self::Exact => Color::rgb(0xDD, 0xEE, 0xF0),
            Self::Bound => Color::rgb(0xFC, 0xF0, 0xC8),
            Self::Lipschitz(_) => Color::rgb(0xFA, 0xDD, 0xDF),
        }
    }

    /// The colour of a ratio: the tint for one, darker below and redder above.
    fn color(self, ratio: f64) -> Color {
        if ratio < 1.0 {
            self.tint().mix(LOOSE, 1.0 - ratio.max(0.0))
        } else {
            self.tint().mix(STEEP, (ratio - 1.0).clamp(0.0, 1.0))
        }
    }

    fn in_words(self) -> String {
        match self {
            Self::Exact => "exact: the value is the distance".to_owned(),
            Self::Bound => "bound: true distance may be larger".to_owned(),
            Self::Lipschitz(l) => {
                format!("Lipschitz, L = {}: value at most L times the distance", write(l, 0.01))
            }
        }
    }

    /// The legend of a side for all fields of a sheet.
    pub(crate) fn entry(self) -> Entry {
        let text = match self {
            Self::Lipschitz(_) => "Lipschitz: value at most L times the distance".to_owned(),
            _ => self.in_words(),
        };
        Entry::new(Key::Promised(self), text)
    }

    /// Hatches `area` [px] where it lies in as many of `regions` as `is_here` says.
    pub(crate) fn hatch(
        self,
        drawing: &mut Drawing,
        area: &Rect,
        regions: &[&[Vec<Point>]],
        is_here: impl Fn(usize) -> bool,
    ) {
        let slopes: &[f64] = match self {
            Self::Exact => &[],
            Self::Bound => &[-1.0],
            Self::Lipschitz(_) => &[-1.0, 1.0],
        };
        for &slope in slopes {
            let lines = Hatching { slope, spacing: HATCH }.over(area, regions, &is_here);
            drawing.stroke(lines, Stroke::new(Color::MUTED, 0.7).with_opacity(0.55));
        }
    }
}

/// Promises and measurements over a window.
#[derive(Debug, Clone)]
pub(crate) struct Trust {
    /// Outside and inside.
    pub(crate) promised: [Promised; 2],
    pub(crate) image: Image,
    pub(crate) measured: Option<Measured>,
}

impl Trust {
    /// Colours `pixels` by their comparisons, row by row from the top.
    ///
    /// # Errors
    ///
    /// [`PlotError::Comparisons`] if their number is wrong.
    pub(crate) fn paint(
        pixels: &Pixels,
        promised: [Promised; 2],
        comparisons: &[Comparison],
    ) -> Result<Self, PlotError> {
        let places: Vec<Point> = pixels.rows().flatten().collect();
        if places.len() != comparisons.len() {
            let (count, expected) = (comparisons.len(), places.len());
            return Err(PlotError::Comparisons { count, expected });
        }
        let ratios: Vec<Option<f64>> = comparisons.iter().map(Comparison::measured).collect();
        let color = |(comparison, ratio): (&Comparison, &Option<f64>)| {
            let side = promised[usize::from(comparison.value < 0.0)];
            ratio.map_or(UNKNOWN, |ratio| side.color(ratio))
        };
        let colors = comparisons.iter().zip(&ratios).map(color).collect();
        let image = Image { width: pixels.width(), pixels: colors };
        let measured = Measured::of(places.into_iter().zip(ratios));
        Ok(Self { promised, image, measured })
    }

    /// Hatches the plot, with the inside in any of `insides` [px].
    pub(crate) fn hatch(&self, drawing: &mut Drawing, plot: &Rect, insides: &[&[Vec<Point>]]) {
        let [outside, inside] = self.promised;
        outside.hatch(drawing, plot, insides, |count| count == 0);
        inside.hatch(drawing, plot, insides, |count| count > 0);
    }

    /// The legend, with the outside and the inside if there are any.
    pub(crate) fn entries(&self, [has_outside, has_inside]: [bool; 2]) -> Vec<Entry> {
        let [outside, inside] = self.promised;
        let mut entries = Vec::new();
        if has_outside && has_inside && outside == inside {
            entries.push(Entry::new(Key::Promised(outside), outside.in_words()));
        } else {
            for (is_there, side, promised) in
                [(has_outside, "outside", outside), (has_inside, "inside", inside)]
            {
                if is_there {
                    let text = format!("{side} {}", promised.in_words());
                    entries.push(Entry::new(Key::Promised(promised), text));
                }
            }
        }
        let largest = self.measured.map_or(1.0, |measured| measured.largest);
        let ends = if largest > 1.01 { [0.0, 2.0] } else { [0.0, 1.0] };
        entries.push(Entry::new(
            Key::Scale(outside, ends),
            "value over true distance: 1 where it is exact",
        ));
        if self.measured.is_none_or(|measured| measured.open > 0.0) {
            let text = "open: the search ended with bounds over 0.1 apart";
            entries.push(Entry::new(Key::Swatch(UNKNOWN), text));
        }
        entries
    }
}

/// Size of a scale [px].
pub(crate) const SCALE: [f64; 2] = [132.0, 40.0];

/// Draws the colours between two measured numbers with their labels: to the right of `at`, and
/// centred on its height [px].
pub(crate) fn draw_scale(
    drawing: &mut Drawing,
    at: Point,
    promised: Promised,
    [low, high]: [f64; 2],
) {
    let measured = |share: f64| low + share * (high - low);
    let ticks = [0.0, 0.5, 1.0].map(|share| {
        let tick = measured(share);
        let label = write(tick, if high > 1.0 { 1.0 } else { 0.5 });
        (share, if tick > 1.0 { format!("≥{label}") } else { label })
    });
    let color = |share| promised.color(measured(share));
    draw_bar(drawing, at, SCALE[0], color, &ticks);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lightness(color: Color) -> f64 {
        color.to_oklab()[0]
    }

    #[test]
    fn looser_values_are_darker_under_every_promise() {
        for promised in [Promised::Exact, Promised::Bound, Promised::Lipschitz(3.0)] {
            let colors = (0..=10).map(|i| promised.color(f64::from(i) / 10.0));
            let lightness: Vec<f64> = colors.map(lightness).collect();
            assert!(lightness.windows(2).all(|pair| pair[0] + 0.02 < pair[1]));
            assert_eq!(promised.color(1.0), promised.tint());
            assert_eq!(promised.color(2.0), promised.color(f64::INFINITY));
        }
    }

    #[test]
    fn the_ratio_nearest_to_one_is_measured() {
        let measured = |value: f64, nearest: f64, farthest: f64| {
            Comparison { value, distance: [nearest, farthest] }.measured()
        };
        assert_eq!(measured(1.0, 0.99, 1.02), Some(1.0));
        assert_eq!(measured(-1.0, 2.0, 2.0), Some(0.5));
        assert_eq!(measured(3.0, 2.0, 2.0), Some(1.5));
        // Nothing is known of it, or too little.
        assert_eq!(measured(1.0, 1.0, f64::INFINITY), None);
        assert_eq!(measured(0.0, 0.0, 0.0), None);
        assert_eq!(measured(1.0, 1.0, 1.2), None);
        assert_eq!(measured(0.0, 0.5, f64::INFINITY), Some(0.0));
    }

    #[test]
    fn what_is_open_is_counted_and_shown() {
        let view = crate::PlaneView::new([0.0, 0.0], 4.0, 1.0).unwrap();
        let pixels = Pixels::along(&view, 4.0);
        let distances = [[1.0, 1.0], [4.0, 4.0], [0.5, f64::INFINITY], [0.8, 0.8]];
        let comparisons = distances.map(|distance| Comparison { value: 1.0, distance });
        let promised = [Promised::Bound, Promised::Exact];
        let trust = Trust::paint(&pixels, promised, &comparisons).unwrap();
        let Measured { smallest, smallest_at, largest, largest_at, open } =
            trust.measured.unwrap();
        assert_eq!((smallest, smallest_at), (0.25, [-0.5, 0.0]));
        assert_eq!((largest, largest_at, open), (1.25, [1.5, 0.0], 0.25));
        assert_eq!(trust.image.pixels[2], UNKNOWN);
        assert!(trust.entries([true, true]).iter().any(|entry| entry.text.starts_with("open")));
        let error = Trust::paint(&pixels, promised, &comparisons[1..]).unwrap_err();
        assert_eq!(error.to_string(), "the picture compares values at 4 places, got 3");
    }
}
