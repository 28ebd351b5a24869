// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Distributions of times, as text.

use std::fmt::Write;

use palpate::servo_loop::Distribution;

/// The widest bar of a histogram.
const BAR: u64 = 40;

/// The quantiles in a line.
pub(crate) fn quantiles(times: &Distribution) -> String {
    format!(
        "p50 {}, p99 {}, p99.9 {}, max {}",
        microseconds(times.p50_ns),
        microseconds(times.p99_ns),
        microseconds(times.p999_ns),
        microseconds(times.max_ns),
    )
}

/// Writes a line with a bar for each bucket.
pub(crate) fn write_histogram(out: &mut String, times: &Distribution) -> std::fmt::Result {
    let most = times.buckets.iter().map(|bucket| bucket.count).max().unwrap_or(1).max(1);
    for bucket in &times.buckets {
        // A bucket that is not empty has a bar of at least one block.
        let length = (bucket.count * BAR).div_ceil(most) as usize;
        let up_to = bucket.up_to_ns / 1000;
        writeln!(out, "    up to {up_to:>8} µs {:>8} {}", bucket.count, "█".repeat(length))?;
    }
    Ok(())
}

/// A time as text.
pub(crate) fn microseconds(ns: u64) -> String {
    format!("{:.2} µs", 1e-3 * ns as f64)
}
