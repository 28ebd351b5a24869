// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The face of a cut: bands of the depth below the surface, in the body's colour.

use crate::color::Light;

/// How much of the bands is white, one after the other.
const PALE: [f64; 2] = [0.58, 0.42];

/// How dark the lines between bands are, and the outline of the body.
const LINE: f64 = 0.38;
const OUTLINE: f64 = 0.85;

/// Half the widths of lines and outline [pixels].
const HALF_LINE: f64 = 0.5;
const HALF_OUTLINE: f64 = 1.5;

/// The light of a place whose field is `level` isolines from the surface, where a pixel is `pixel`
/// of the distance between isolines.
pub(crate) fn light(body: Light, level: f64, pixel: f64) -> Light {
    let nearest = level.round();
    let away = (level - nearest).abs() / pixel;
    let half = if nearest == 0.0 { HALF_OUTLINE } else { HALF_LINE };
    // A line is as sharp as a pixel.
    let line = (half + 0.5 - away).clamp(0.0, 1.0);
    let (below, above) = (band(level.floor()), band(level.floor() + 1.0));
    // So is the step from band to band, which a line covers.
    let share = ((level - level.floor() - 1.0) / pixel + 0.5).clamp(0.0, 1.0);
    let pale = below + share * (above - below);
    let dark = if nearest == 0.0 { OUTLINE } else { LINE };
    body.mixed(Light::white(1.0), pale) * (1.0 - dark * line)
}

/// How pale a band is.
fn band(index: f64) -> f64 {
    PALE[usize::from(index.rem_euclid(2.0) >= 1.0)]
}
