// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a report says of contact points that began inside a body.

use std::fmt::Write;

use palpate::servo_loop::StartInside;

use super::report::Felt;
use crate::output::shown;
use palpate::scene::text::rounded;

/// So many points have a line each; of more, the number is told.
const MOST_LINES: usize = 5;

/// A line for each point that began inside, up to [`MOST_LINES`].
pub(super) fn write<const D: usize>(out: &mut String, felt: &Felt<'_, D>) -> std::fmt::Result {
    let starts = &felt.report.starts_inside;
    let what = |start: &StartInside| {
        if felt.report.tool.is_some() {
            "the tool".to_owned()
        } else {
            format!("contact point {}", start.point)
        }
    };
    for start in starts.iter().take(MOST_LINES) {
        let depth = rounded(1e3 * start.depth);
        let body = shown(felt.name_of(start.body));
        let after = if felt.device.max_force > 0.0 { after(start) } else { String::new() };
        let what = what(start);
        writeln!(
            out,
            "  start          {what} started {depth} mm inside body \"{body}\"{after}"
        )?;
    }
    match starts.len().saturating_sub(MOST_LINES) {
        0 => Ok(()),
        1 => writeln!(out, "                 1 more contact point started inside a body"),
        more => {
            writeln!(out, "                 {more} more contact points started inside bodies")
        }
    }
}

/// What became of the force of a point that began inside.
fn after(start: &StartInside) -> String {
    let time = rounded(start.time_without_force);
    match (start.ticks_without_force, start.is_felt, start.has_left) {
        (0, _, _) => ": its force rose from zero".to_owned(),
        (_, true, _) => format!(": no force for {time} s"),
        (_, false, true) => format!(": no force for {time} s, until it left"),
        (_, false, false) => format!(": no force for {time} s, to the end"),
    }
}
