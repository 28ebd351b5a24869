// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a report says of guides.

use std::fmt::Write;

use super::report::Felt;
use crate::numbers::rounded;

/// A line for each guide.
pub(super) fn write<const D: usize>(out: &mut String, felt: &Felt<'_, D>) -> std::fmt::Result {
    let guides = felt.servo.guides(0).iter().zip(&felt.report.guides);
    for (number, (guide, report)) in guides.enumerate() {
        let label = format!("guide {number}");
        let kind = guide.kind_name();
        if report.time > 0.0 {
            writeln!(
                out,
                "  {label:14} a {kind}, held the hand for {} s with at most {} N; {} mJ taken from \
                 the hand, {} mJ given",
                rounded(report.time),
                rounded(report.largest_force),
                rounded(1e3 * report.taken),
                rounded(1e3 * report.given),
            )?;
        } else {
            writeln!(out, "  {label:14} a {kind}, did not hold the hand")?;
        }
    }
    Ok(())
}
