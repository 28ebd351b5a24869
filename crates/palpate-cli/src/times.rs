// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Times, as text.

/// A time [ns] as text.
pub(crate) fn microseconds(ns: u64) -> String {
    format!("{:.2} µs", 1e-3 * ns as f64)
}
