// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Promises and how values compare with them, as colours.

use crate::drawing::{Drawing, Image, Path, Stroke};
use crate::error::PlotError;
use crate::geometry::{Point, Rect};
use crate::legend::{Entry, Key};
use crate::numbers::write;
use crate::palette::Color;
use crate::scale::draw_bar;
use crate::slope::{Pixels, Slope};

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

/// The number that is compared with the promise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gauge {
    /// |f| over the distance to the surface that the picture shows. Only for fields in the
    /// plane: on a slice through space, the nearest surface may lie outside the slice.
    Distance,
    /// The length of the gradient, which is one where the value is a distance, and possibly
    /// elsewhere.
    Steepness,
}

/// The extremes of a [`Gauge`], or of other numbers, over a picture, with their places in plane
/// coordinates \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The smallest number; of a gauge, that of the loosest value.
    pub smallest: f64,
    /// The first place where it was found.
    pub smallest_at: [f64; 2],
    /// The largest number; of a gauge, above one where values are too steep.
    pub largest: f64,
    /// The first place where it was found.
    pub largest_at: [f64; 2],
}

impl Measured {
    /// Extends the `extremes` known so far to `x` at a place.
    pub(crate) fn include(extremes: &mut Option<Self>, at: Point, x: f64) {
        let first = Self { smallest: x, smallest_at: at, largest: x, largest_at: at };
        let known = extremes.get_or_insert(first);
        if x < known.smallest {
            (known.smallest, known.smallest_at) = (x, at);
        }
        if x > known.largest {
            (known.largest, known.largest_at) = (x, at);
        }
    }
}

/// Colours of values that are too small and too large; the pair differs under colour
/// deficiencies.
const LOOSE: Color = Color::rgb(0x45, 0x1C, 0x70);
const STEEP: Color = Color::rgb(0xC4, 0x4A, 0x00);
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

    /// The colour where `measured`: the tint for one, darker below and redder above.
    fn color(self, measured: Option<f64>) -> Color {
        match measured {
            Some(low) if low < 1.0 => self.tint().mix(LOOSE, 1.0 - low.max(0.0)),
            Some(high) => self.tint().mix(STEEP, (high - 1.0).clamp(0.0, 1.0)),
            None => self.tint(),
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

    /// The slopes of the lines that hatch the side, with y down.
    fn hatching(self) -> &'static [f64] {
        match self {
            Self::Exact => &[],
            Self::Bound => &[-1.0],
            Self::Lipschitz(_) => &[-1.0, 1.0],
        }
    }

    /// Hatches the part of `area` [px] where `is_here` is true, tested at each pixel.
    pub(crate) fn hatch(
        self,
        drawing: &mut Drawing,
        area: &Rect,
        is_here: impl Fn(Point) -> bool,
    ) {
        let mut lines = Path::default();
        for &slope in self.hatching() {
            let start = if slope < 0.0 { area.min[1] } else { area.min[1] - area.width() };
            let count = ((area.width() + area.height()) / HATCH) as usize;
            for i in 0..=count {
                let y = start + (i as f64 + 0.5) * HATCH;
                let mut line: Vec<Point> = Vec::new();
                for step in 0..=area.width() as usize {
                    let x = step as f64;
                    let p = [area.min[0] + x, y + slope * x];
                    if area.contains(p) && is_here(p) {
                        line.push(p);
                    } else {
                        add_ends(&mut lines, &mut line);
                    }
                }
                add_ends(&mut lines, &mut line);
            }
        }
        drawing.stroke(lines, Stroke::new(Color::MUTED, 0.7).with_opacity(0.55));
    }
}

/// Adds the straight `line` to `path` by its ends, and empties it.
fn add_ends(path: &mut Path, line: &mut Vec<Point>) {
    if let [first, .., last] = line[..] {
        path.add_line(&[first, last]);
    }
    line.clear();
}

/// Promises and measurements over a window.
#[derive(Debug, Clone)]
pub(crate) struct Trust {
    /// Outside and inside.
    pub(crate) promised: [Promised; 2],
    pub(crate) gauge: Gauge,
    pub(crate) image: Image,
    pub(crate) measured: Option<Measured>,
}

impl Trust {
    /// Calls `measure` at each pixel.
    ///
    /// # Errors
    ///
    /// As [`Pixels::paint`].
    pub(crate) fn paint(
        pixels: &Pixels,
        promised: [Promised; 2],
        gauge: Gauge,
        field: impl FnMut(&[[f64; 2]], &mut [Slope]),
        mut measure: impl FnMut(Point, &Slope) -> Option<f64>,
    ) -> Result<Self, PlotError> {
        let mut extremes: Option<Measured> = None;
        let image = pixels.paint(field, |at, slope| {
            let measured = measure(at, slope);
            if let Some(x) = measured {
                Measured::include(&mut extremes, at, x);
            }
            promised[usize::from(slope.value < 0.0)].color(measured)
        })?;
        Ok(Self { promised, gauge, image, measured: extremes })
    }

    /// Hatches the plot; `value` gives the field at a pixel.
    pub(crate) fn hatch(
        &self,
        drawing: &mut Drawing,
        plot: &Rect,
        value: impl Fn(Point) -> f64,
    ) {
        let [outside, inside] = self.promised;
        outside.hatch(drawing, plot, |p| value(p) >= 0.0);
        inside.hatch(drawing, plot, |p| value(p) < 0.0);
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
        let name = match self.gauge {
            Gauge::Distance => "measured: value over true distance",
            Gauge::Steepness => "length of the gradient",
        };
        let largest = self.measured.map_or(1.0, |measured| measured.largest);
        let ends = if largest > 1.01 { [0.0, 2.0] } else { [0.0, 1.0] };
        entries.push(Entry::new(Key::Scale(outside, ends), name));
        entries
    }
}

/// Size of a scale [px].
pub(crate) const SCALE: [f64; 2] = [132.0, 40.0];

/// Draws the colours between two measured numbers with their labels from `x`, centred on `y`
/// [px].
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
    let color = |share| promised.color(Some(measured(share)));
    draw_bar(drawing, at, SCALE[0], color, &ticks);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{Item, Verb};

    fn lightness(color: Color) -> f64 {
        color.to_oklab()[0]
    }

    #[test]
    fn looser_values_are_darker_under_every_promise() {
        for promised in [Promised::Exact, Promised::Bound, Promised::Lipschitz(3.0)] {
            let colors = (0..=10).map(|i| promised.color(Some(f64::from(i) / 10.0)));
            let lightness: Vec<f64> = colors.map(lightness).collect();
            assert!(lightness.windows(2).all(|pair| pair[0] + 0.02 < pair[1]));
            assert_eq!(promised.color(Some(1.0)), promised.tint());
            assert_eq!(promised.color(None), promised.tint());
            assert_eq!(promised.color(Some(2.0)), promised.color(Some(f64::INFINITY)));
        }
    }

    #[test]
    fn hatching_stays_where_it_belongs() {
        let area = Rect::new(10.0, 20.0, 100.0, 60.0);
        for (promised, directions) in
            [(Promised::Exact, 0), (Promised::Bound, 1), (Promised::Lipschitz(2.0), 2)]
        {
            let mut drawing = Drawing::default();
            promised.hatch(&mut drawing, &area, |p| p[0] < 60.0);
            assert_eq!(drawing.items.is_empty(), directions == 0);
            for item in drawing.items {
                let Item::Mark(mark) = item else { panic!("an image") };
                for verb in mark.path.verbs {
                    let (Verb::Move(p) | Verb::Line(p)) = verb else { panic!("{verb:?}") };
                    assert!(area.contains(p) && p[0] < 60.0, "{p:?}");
                }
            }
        }
    }
}
