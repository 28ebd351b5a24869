// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Numbers for readers.

/// A number with four significant digits.
pub(crate) fn rounded(number: f64) -> String {
    if number.abs() < f64::MIN_POSITIVE {
        return "0".to_owned();
    }
    let digits = 3 - number.abs().max(f64::MIN_POSITIVE).log10().floor() as i32;
    let unit = 10.0_f64.powi(-digits);
    let text = format!("{:.*}", digits.max(0) as usize, (number / unit).round() * unit);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}
