// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Times, as text.

/// A time [s] as text.
pub(crate) fn microseconds(time: f64) -> String {
    format!("{:.2} µs", 1e6 * time)
}
