// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scales, levels and numbers.

use crate::drawing::{Drawing, Image, Path, Stroke, TextStyle};
use crate::error::PlotError;
use crate::geometry::{Point, Rect};
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

/// The largest of 1, 2, 5 times a power of ten that is at most `x`.
///
/// `x` must be positive and finite.
pub(crate) fn round_down(x: f64) -> f64 {
    let exponent = x.log10().floor() as i32;
    // One decade down guards against a logarithm rounded up; the factor against 0.2 < 0.2.
    (exponent - 1..=exponent + 1)
        .flat_map(|e| [1, 2, 5].map(|digit| power(digit, e)))
        .take_while(|&candidate| candidate <= x * (1.0 + 1e-12))
        .last()
        .unwrap_or(x)
}

/// The smallest of 1, 2, 5 times a power of ten that is at least `x`.
///
/// `x` must be positive and finite.
pub(crate) fn round_up(x: f64) -> f64 {
    let exponent = x.log10().floor() as i32;
    (exponent - 1..=exponent + 1)
        .flat_map(|e| [1, 2, 5].map(|digit| power(digit, e)))
        .find(|&candidate| candidate >= x * (1.0 - 1e-12))
        .unwrap_or(x)
}

/// `digit · 10^exponent`, correctly rounded.
fn power(digit: u8, exponent: i32) -> f64 {
    format!("{digit}e{exponent}").parse().unwrap_or(f64::NAN)
}

/// The largest multiple whose neighbours differ: 64-bit floats have 53 bits.
const COUNTABLE: f64 = 1e15;

/// Multiples of `step` in `[low, high]`, ascending; none if there are over `most`.
pub(crate) fn multiples(low: f64, high: f64, step: f64, most: usize) -> Vec<f64> {
    // A multiple that misses the end only by rounding belongs to the interval.
    let slack = 1e-9;
    let first = (low / step - slack).ceil();
    let last = (high / step + slack).floor();
    if last - first >= most as f64 || first.abs().max(last.abs()) > COUNTABLE {
        return Vec::new();
    }
    (first as i64..=last as i64).map(|k| multiple(k, step)).collect()
}

/// `k · step` in decimal arithmetic: 3 · 0.1 is 0.3.
fn multiple(k: i64, step: f64) -> f64 {
    let inverse = 1.0 / step;
    if step < 1.0 && (inverse - inverse.round()).abs() < 1e-9 * inverse {
        k as f64 / inverse.round()
    } else {
        k as f64 * step
    }
}

/// Writes `value` with the digits that tell it from its neighbours `step` away.
///
/// Decimal where that is short, scientific (`2×10⁻⁷`) beyond.
pub(crate) fn write(value: f64, step: f64) -> String {
    let place = place_of(step);
    let largest = value.abs().max(step);
    if value.abs() < step / 1e6 {
        return "0".to_owned();
    }
    let text = if place >= -5 && largest < 1e6 {
        format!("{value:.*}", usize::try_from(-place).unwrap_or(0))
    } else {
        let exponent = value.abs().log10().floor() as i32;
        let digits = usize::try_from(exponent - place).unwrap_or(0).min(15);
        let scientific = format!("{value:.digits$e}");
        let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
        format!("{mantissa}×10{}", superscript(exponent))
    };
    text.replace('-', "−")
}

/// The decimal place of the last digit of `step` that is not zero, for steps of up to 3 digits.
fn place_of(step: f64) -> i32 {
    let scientific = format!("{step:.2e}");
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let digits = mantissa.trim_end_matches('0').trim_end_matches('.');
    exponent - i32::try_from(digits.len().saturating_sub(2)).unwrap_or(0)
}

fn superscript(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            digit => {
                digit.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(digit)
            }
        })
        .collect()
}

/// Writes a round `length` [m] with the unit that makes it short: `20 mm`, `5 km`.
pub(crate) fn write_length(length: f64) -> String {
    let units = [(1e3, "km"), (1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm")];
    let (size, unit) =
        units.into_iter().find(|(size, _)| length >= size * 0.999).unwrap_or((1e-9, "nm"));
    let count = length / size;
    format!("{} {unit}", write(count, round_down(count)))
}

/// The isolines are at most about so many if no step is given: enough to show slopes, few enough
/// to label.
const AIM: f64 = 14.0;
/// Most isolines of a figure. At 800 px they are then about 4 px apart.
const MOST: usize = 200;

/// The levels of a figure's isolines [m]: multiples of a step, zero among them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Levels {
    pub(crate) step: f64,
    /// Ascending; all within the range of the samples.
    pub(crate) values: Vec<f64>,
}

impl Levels {
    /// Levels for samples in `[low, high]` in a window with the shorter side `size`, all [m].
    ///
    /// The step is the round number (1, 2, 5 times a power of ten) that gives up to 14 levels.
    pub(crate) fn choose(low: f64, high: f64, size: f64) -> Self {
        let span = high - low;
        // A field that is constant, or constant to rounding, has no span to divide.
        let span = if span > 1e-9 * low.abs().max(high.abs()) { span } else { size };
        let step = round_up(span / AIM);
        Self { step, values: multiples(low, high, step, MOST) }
    }

    /// Levels at multiples of `step` in `[low, high]`, all [m].
    ///
    /// # Errors
    ///
    /// [`PlotError::Step`] or [`PlotError::TooManyLevels`].
    pub(crate) fn with_step(low: f64, high: f64, step: f64) -> Result<Self, PlotError> {
        if !(step > 0.0 && step.is_finite()) {
            return Err(PlotError::Step { step });
        }
        let count = (high / step).floor() - (low / step).ceil() + 1.0;
        if count > MOST as f64 {
            return Err(PlotError::TooManyLevels { step, count, max: MOST });
        }
        Ok(Self { step, values: multiples(low, high, step, MOST + 1) })
    }

    /// The number of bands inside and outside.
    pub(crate) fn bands(&self) -> (usize, usize) {
        let inside = self.values.iter().filter(|&&v| v < 0.0).count() + 1;
        let outside = self.values.iter().filter(|&&v| v > 0.0).count() + 1;
        (inside, outside)
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

#[cfg(test)]
mod numbers_tests {
    use super::*;

    #[test]
    fn rounds_to_the_series() {
        for (x, down, up) in [
            (1.0, 1.0, 1.0),
            (0.2, 0.2, 0.2),
            (0.3, 0.2, 0.5),
            (9.99, 5.0, 10.0),
            (7e-7, 5e-7, 1e-6),
            (1e150, 1e150, 1e150),
        ] {
            assert_eq!((round_down(x), round_up(x)), (down, up), "{x}");
        }
    }

    #[test]
    fn writes_numbers_as_a_reader_expects() {
        let cases = [
            (0.30000000000000004, 0.1, "0.3"),
            (-0.02, 0.02, "−0.02"),
            (0.0005, 0.0005, "0.0005"),
            (-1e-20, 0.1, "0"),
            (2e-7, 1e-7, "2×10⁻⁷"),
            (-1.2e-6, 1e-7, "−1.2×10⁻⁶"),
            (3e6, 1e6, "3×10⁶"),
            (1500.0, 500.0, "1500"),
            (0.75, 0.25, "0.75"),
        ];
        for (value, step, text) in cases {
            assert_eq!(write(value, step), text);
        }
        assert_eq!(write_length(0.02), "20 mm");
        assert_eq!(write_length(2e-6), "2 µm");
        assert_eq!(write_length(5e3), "5 km");
        assert_eq!(write_length(1.0), "1 m");
        assert_eq!(write_length(5e6), "5000 km");
    }

    #[test]
    fn multiples_are_decimal() {
        assert_eq!(multiples(-0.1, 0.3, 0.1, 10), [-0.1, 0.0, 0.1, 0.2, 0.3]);
        assert!(multiples(0.0, 1e9, 0.1, 10).is_empty());
    }
}

#[cfg(test)]
mod levels_tests {
    use super::*;

    #[test]
    fn contain_zero_and_cover_the_range() {
        for (low, high) in [(-0.1, 0.4), (-1.0, 1e6), (-3e-7, 2e-7), (-5.0, 0.001)] {
            let Levels { step, values } = Levels::choose(low, high, 1.0);
            assert!(values.contains(&0.0), "{low} {high}: {values:?}");
            assert!(values.len() >= 5 && values.len() <= 15, "{values:?}");
            assert!(values[0] - low < step * 1.000_001);
            assert!(high - values[values.len() - 1] < step * 1.000_001);
        }
    }

    #[test]
    fn constant_fields_have_a_step_and_no_lines() {
        let levels = Levels::choose(0.123, 0.123, 1.0);
        assert_eq!((levels.step, levels.values.len()), (0.1, 0));
        assert!(Levels::choose(1e9, 1e9, 1e-6).values.len() < 2);
    }

    #[test]
    fn refuses_steps_that_cannot_be_drawn() {
        assert!(Levels::with_step(-1.0, 1.0, f64::NAN).is_err());
        assert!(Levels::with_step(-1.0, 1.0, 0.0).is_err());
        let error = Levels::with_step(-1.0, 1.0, 1e-3).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a step of 0.001 m draws 2001 isolines; at most 200 can be told apart"
        );
    }
}
