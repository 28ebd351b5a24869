// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the heads of several formats have in common: frames, units of lengths, lists of numbers.

use std::str::FromStr;

/// The longest head of text [bytes].
pub(super) const LONGEST_HEAD: usize = 1 << 16;

/// The millimetre [m], which is meant where a head names no unit.
pub(super) const MILLIMETRE: f64 = 1e-3;

/// What turns coordinates to the left, the back and the top of a patient into those that all volumes have, as NIfTI: to
/// the right, the front and the top.
pub(super) const LEFT_POSTERIOR: [f64; 3] = [-1.0, -1.0, 1.0];

/// The units that heads name, for messages.
pub(super) const UNITS: &str = "um, mm, cm or m";

/// The length [m] of a unit.
pub(super) fn unit(name: &str) -> Option<f64> {
    match name {
        "m" | "meter" | "metre" | "meters" | "metres" => Some(1.0),
        "cm" | "centimeter" | "centimetre" | "centimeters" | "centimetres" => Some(1e-2),
        "mm" | "millimeter" | "millimetre" | "millimeters" | "millimetres" => Some(MILLIMETRE),
        // The micro sign and the Greek letter.
        "um" | "\u{b5}m" | "\u{3bc}m" | "micron" | "microns" | "micrometer" | "micrometre" => {
            Some(1e-6)
        }
        _ => None,
    }
}

/// The numbers of a text, `N` of them.
pub(super) fn list<T: FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    all(text.split(|c: char| c.is_whitespace() || c == ','))
}

/// The numbers of a text with spaces between them, `N` of them, all finite.
pub(super) fn spaced<const N: usize>(text: &str) -> Option<[f64; N]> {
    all(text.split_whitespace())
        .filter(|numbers: &[f64; N]| numbers.iter().all(|x| x.is_finite()))
}

fn all<'a, T: FromStr, const N: usize>(parts: impl Iterator<Item = &'a str>) -> Option<[T; N]> {
    let parsed: Option<Vec<T>> =
        parts.filter(|part| !part.is_empty()).map(|part| part.parse().ok()).collect();
    parsed?.try_into().ok()
}
