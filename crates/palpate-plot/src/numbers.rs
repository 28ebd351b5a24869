// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Round numbers, and how numbers are written in a figure.

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

#[cfg(test)]
mod tests {
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
