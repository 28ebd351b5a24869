// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Numbers as colours, with a bar in the legend that says which.

use crate::drawing::{Drawing, Image, Path, Stroke, TextStyle};
use crate::error::PlotError;
use crate::geometry::{Point, Rect};
use crate::numbers::{round_up, write};
use crate::palette::Color;
use crate::text::Anchor;

/// Colours of the largest numbers below and above zero: the pair differs under colour
/// deficiencies.
const BELOW: Color = Color::rgb(0x12, 0x3C, 0x7A);
const ABOVE: Color = Color::rgb(0xA8, 0x3A, 0x00);
/// Colours from the smallest to the largest positive number, each darker than the one before.
const DECADES: [Color; 4] = [
    Color::rgb(0xFD, 0xF8, 0xE6),
    Color::rgb(0xF2, 0xB2, 0x5C),
    Color::rgb(0xB8, 0x3E, 0x4C),
    Color::rgb(0x35, 0x12, 0x5C),
];
/// Where there is no number.
const MISSING: Color = Color::rgb(0xC4, 0xC8, 0xCE);

/// What the numbers of a picture are, and how they become colours.
///
/// # Examples
///
/// ```
/// use palpate_plot::Scale;
///
/// let difference = Scale::signed("difference of both distances", "m");
/// let error = Scale::decades("error", "degrees", 1e-3, 180.0)?.with_missing("no direction");
/// let refused = Scale::decades("error", "degrees", 0.0, 180.0).unwrap_err();
/// assert_eq!(
///     refused.to_string(),
///     "the ends of a scale of decades must be positive, the lower one first, got 0 and 180"
/// );
/// # Ok::<(), palpate_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    name: String,
    unit: String,
    missing: String,
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Signed,
    Decades([f64; 2]),
}

impl Scale {
    /// Numbers `name` \[`unit`\] of either sign: blue below zero, white at zero, brown above. The
    /// ends are a round number and its negative, which hold all numbers of the picture.
    #[must_use]
    pub fn signed(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self::new(name.into(), unit.into(), Kind::Signed)
    }

    /// Positive numbers `name` \[`unit`\] by their logarithms, darker from `low` to `high`.
    /// Numbers beyond an end have its colour, and several pictures have one scale.
    ///
    /// # Errors
    ///
    /// [`PlotError::Scale`] unless `low` is positive and less than a finite `high`.
    pub fn decades(
        name: impl Into<String>,
        unit: impl Into<String>,
        low: f64,
        high: f64,
    ) -> Result<Self, PlotError> {
        if low > 0.0 && low < high && high.is_finite() {
            Ok(Self::new(name.into(), unit.into(), Kind::Decades([low, high])))
        } else {
            Err(PlotError::Scale { low, high })
        }
    }

    fn new(name: String, unit: String, kind: Kind) -> Self {
        Self { name, unit, missing: "no value".to_owned(), kind }
    }

    /// With these words for places without a number.
    #[must_use]
    pub fn with_missing(self, words: impl Into<String>) -> Self {
        Self { missing: words.into(), ..self }
    }

    pub(crate) fn missing(&self) -> &str {
        &self.missing
    }

    /// Name and unit in the legend.
    pub(crate) fn label(&self) -> String {
        format!("{} [{}]", self.name, self.unit)
    }

    /// The colours of a picture whose numbers reach `largest` from zero.
    pub(crate) fn ramp(&self, largest: f64) -> Ramp {
        match self.kind {
            Kind::Signed if largest > 0.0 => Ramp::Signed(round_up(largest)),
            // All are zero, and any end will do.
            Kind::Signed => Ramp::Signed(1.0),
            Kind::Decades(ends) => Ramp::Decades(ends),
        }
    }
}

/// The colours between two numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Ramp {
    /// From the negative of this number to it.
    Signed(f64),
    /// Between these, by logarithms.
    Decades([f64; 2]),
}

/// Size of the bar in a legend, and the room at its ends for long labels [px].
pub(crate) const SIZE: [f64; 2] = [284.0, 40.0];
const ROOM: f64 = 12.0;

impl Ramp {
    /// The colour of a number, or of a place without one.
    pub(crate) fn color(self, value: Option<f64>) -> Color {
        value.map_or(MISSING, |value| self.color_at(self.share(value)))
    }

    /// Where a number lies, from 0 to 1.
    fn share(self, value: f64) -> f64 {
        match self {
            Self::Signed(end) => 0.5 + 0.5 * (value / end).clamp(-1.0, 1.0),
            Self::Decades([low, high]) => {
                let value = value.clamp(low, high);
                (value / low).ln() / (high / low).ln()
            }
        }
    }

    fn color_at(self, share: f64) -> Color {
        match self {
            Self::Signed(_) if share < 0.5 => BELOW.mix(Color::WHITE, 2.0 * share),
            Self::Signed(_) => Color::WHITE.mix(ABOVE, 2.0 * share - 1.0),
            Self::Decades(_) => {
                let spans = DECADES.len() - 1;
                let place = share * spans as f64;
                let from = (place as usize).min(spans - 1);
                DECADES[from].mix(DECADES[from + 1], place - from as f64)
            }
        }
    }

    /// Numbers along the bar, with their labels.
    fn ticks(self) -> Vec<(f64, String)> {
        let at = |value: f64, step: f64| (self.share(value), write(value, step));
        match self {
            Self::Signed(end) => {
                [-1.0, -0.5, 0.0, 0.5, 1.0].map(|part| at(part * end, 0.5 * end)).to_vec()
            }
            Self::Decades([low, high]) => {
                let decades = low.log10().ceil() as i32..=high.log10().floor() as i32;
                decades
                    .map(|exponent| at(10_f64.powi(exponent), 10_f64.powi(exponent)))
                    .collect()
            }
        }
    }

    /// Draws the bar with its labels: to the right of `at`, and centred on its height [px].
    pub(crate) fn draw(self, drawing: &mut Drawing, at: Point) {
        let [x, y] = at;
        let place = [x + ROOM, y];
        let color = |share| self.color_at(share);
        draw_bar(drawing, place, SIZE[0] - 2.0 * ROOM, color, &self.ticks());
    }
}

/// The colour of places without a number.
pub(crate) fn missing() -> Color {
    MISSING
}

/// Draws the colours of the shares from 0 to 1 as a bar that takes `width`, from `x` and centred
/// on `y`, with labels at some shares [px].
pub(crate) fn draw_bar(
    drawing: &mut Drawing,
    [x, y]: Point,
    width: f64,
    color: impl Fn(f64) -> Color,
    ticks: &[(f64, String)],
) {
    let style = TextStyle::TICK;
    let (left, width) = (x + 8.0, width - 16.0);
    let count = 2 * width as usize;
    let pixels = (0..count).map(|i| color((i as f64 + 0.5) / count as f64)).collect();
    let bar = Rect::new(left, y - 7.0, width, 12.0);
    drawing.image(bar, Image { width: count, pixels });
    drawing.stroke(Path::rect(&bar), Stroke::new(Color::MUTED, 0.75));
    for (share, label) in ticks {
        drawing.label(label, [left + width * share, y + 18.0], Anchor::Middle, style);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lightness(color: Color) -> f64 {
        color.to_oklab()[0]
    }

    #[test]
    fn zero_is_white_and_both_ends_are_dark() {
        let ramp = Scale::signed("difference", "m").ramp(0.0173);
        assert_eq!(ramp, Ramp::Signed(0.02));
        assert_eq!(ramp.color(Some(0.0)), Color::WHITE);
        for end in [-0.02, 0.02] {
            assert!(lightness(ramp.color(Some(end))) < 0.55);
            assert_eq!(ramp.color(Some(end)), ramp.color(Some(7.0 * end)));
            let nearer = (0..=10).map(|i| ramp.color(Some(end * f64::from(i) / 10.0)));
            let lightness: Vec<f64> = nearer.map(lightness).collect();
            assert!(lightness.windows(2).all(|pair| pair[1] < pair[0] - 0.02), "{lightness:?}");
        }
        let labels: Vec<_> = ramp.ticks().into_iter().map(|(_, label)| label).collect();
        assert_eq!(labels, ["−0.02", "−0.01", "0", "0.01", "0.02"]);
    }

    #[test]
    fn decades_are_equally_wide_and_darker_each() -> Result<(), PlotError> {
        let ramp = Scale::decades("error", "degrees", 1e-3, 180.0)?.ramp(0.0);
        let ticks = ramp.ticks();
        let labels: Vec<&str> = ticks.iter().map(|(_, label)| label.as_str()).collect();
        assert_eq!(labels, ["0.001", "0.01", "0.1", "1", "10", "100"]);
        let width = ticks[1].0 - ticks[0].0;
        assert!(ticks.windows(2).all(|pair| (pair[1].0 - pair[0].0 - width).abs() < 1e-12));
        let colors = (0..=20).map(|i| ramp.color_at(f64::from(i) / 20.0));
        let lightness: Vec<f64> = colors.map(lightness).collect();
        assert!(lightness.windows(2).all(|pair| pair[1] < pair[0] - 0.01), "{lightness:?}");
        assert_eq!(ramp.color(Some(0.0)), ramp.color(Some(1e-3)));
        assert_ne!(ramp.color(None), ramp.color(Some(0.0)));
        Ok(())
    }
}
