// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Sizes that are those of another unit.

use palpate::scene::text::rounded;

/// Meshes larger than this are rarely touched, and often in millimetres [m].
const LARGE: f64 = 2.0;

/// Meshes larger than this are rarely meant [m].
const HUGE: f64 = 1e3;

/// Meshes smaller than this are rarely meant, and often in another unit [m].
const SMALL: f64 = 1e-5;

/// What to do if the size of a mesh [m] is that of another unit. `how` is where its scale is said, `scale` what is said
/// there.
pub(crate) fn hint(size: f64, how: &str, scale: Option<f64>) -> Option<String> {
    let across = rounded(size);
    match scale {
        _ if (SMALL..=LARGE).contains(&size) || size <= 0.0 => None,
        // Who says how large a unit is may mean a hall or a bridge.
        Some(_) if (LARGE..=HUGE).contains(&size) => None,
        Some(_) => Some(format!(
            "it is {across} m across: {how} says how many metres a unit of the file is, 0.001 of \
             a file in millimetres"
        )),
        None if size > LARGE => Some(format!(
            "it is {across} m across: if the file is in millimetres, {how} 0.001 makes that \
             {across} mm"
        )),
        None => Some(format!(
            "it is {across} m across: {how} enlarges it, if a unit of the file is more than a metre"
        )),
    }
}
