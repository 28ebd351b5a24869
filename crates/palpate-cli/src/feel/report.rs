// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The report of a run, as text.

use std::fmt::Write;

use palpate::haptics::{Body, Distribution, Ending, Progress, RunReport, Servo, Surface};

/// The widest bar of a histogram.
const BAR: u64 = 40;

/// What is shown while the servo runs.
pub(crate) fn live_line(progress: &Progress) -> String {
    format!(
        "{:7.2} s  {:2} in contact  {:5.2} N  {:5.2} mm deep  {:3} evaluations  {:6.2} µs",
        progress.time,
        progress.contacts,
        progress.force,
        1e3 * progress.depth,
        progress.evaluations,
        1e-3 * progress.cost_ns as f64,
    )
}

pub(crate) fn title(name: &str, report: &RunReport) -> String {
    let points = if report.points == 1 { "one point" } else { "several points" };
    format!("{}, felt with {points}", file_name(name))
}

fn file_name(name: &str) -> String {
    let name = std::path::Path::new(name).file_stem().unwrap_or_default();
    name.to_string_lossy().replace('_', " ")
}

/// The whole report.
pub(crate) fn text<const D: usize>(name: &str, report: &RunReport, servo: &Servo<D>) -> String {
    let mut out = String::new();
    write_report(&mut out, name, report, servo).unwrap_or_default();
    out
}

fn write_report<const D: usize>(
    out: &mut String,
    name: &str,
    report: &RunReport,
    servo: &Servo<D>,
) -> std::fmt::Result {
    let options = servo.options();
    let surfaces = || servo.bodies().bodies().iter().map(Body::surface);
    writeln!(out, "{name}, felt with {} contact point(s)", report.points)?;
    writeln!(
        out,
        "  stiffness {} N/m, damping {} N·s/m, at most {} N, probe of {} mm",
        range(surfaces().map(Surface::stiffness)),
        range(surfaces().map(Surface::damping)),
        options.max_force,
        1e3 * options.probe.radius(),
    )?;
    match &report.ending {
        Ending::Finished => {}
        Ending::DeviceLost { reason } => writeln!(out, "  the device was lost: {reason}")?,
        Ending::Panicked { message } => {
            writeln!(
                out,
                "  the servo stopped on a defect, forces were set to zero: {message}"
            )?;
        }
    }
    let share = 100.0 * report.contact_time / report.duration.max(f64::MIN_POSITIVE);
    writeln!(out, "  ticks          {} at {} Hz", report.ticks, report.rate)?;
    writeln!(
        out,
        "  contact time   {:.3} s of {:.3} s ({share:.0} %)",
        report.contact_time, report.duration
    )?;
    writeln!(out, "  largest force  {:.3} N", report.largest_force)?;
    writeln!(out, "  largest depth  {:.3} mm", 1e3 * report.largest_depth)?;
    let evaluations = &report.evaluations;
    writeln!(
        out,
        "  evaluations    {:.2} a tick, {} at most",
        evaluations.mean, evaluations.max
    )?;
    if evaluations.budget_spent > 0 {
        writeln!(
            out,
            "                 {} ticks spent their budget",
            evaluations.budget_spent
        )?;
    }
    if let Some(cost) = &report.cost {
        writeln!(out, "  cost a tick    {}", quantiles(cost))?;
    }
    if let Some(lateness) = &report.lateness {
        writeln!(out, "  lateness       {}", quantiles(lateness))?;
        write_histogram(out, lateness)?;
        writeln!(
            out,
            "  missed         {} ticks more than a period late",
            report.missed_deadlines
        )?;
    }
    Ok(())
}

/// The numbers of all bodies: one, or from the least to the largest.
fn range(numbers: impl Iterator<Item = f64> + Clone) -> String {
    let least = numbers.clone().fold(f64::INFINITY, f64::min);
    let largest = numbers.fold(f64::NEG_INFINITY, f64::max);
    if least < largest { format!("{least} to {largest}") } else { least.to_string() }
}

fn quantiles(times: &Distribution) -> String {
    let microseconds = |ns: u64| format!("{:.2} µs", 1e-3 * ns as f64);
    format!(
        "p50 {}, p99 {}, p99.9 {}, max {}",
        microseconds(times.p50_ns),
        microseconds(times.p99_ns),
        microseconds(times.p999_ns),
        microseconds(times.max_ns),
    )
}

fn write_histogram(out: &mut String, times: &Distribution) -> std::fmt::Result {
    let most = times.buckets.iter().map(|bucket| bucket.count).max().unwrap_or(1).max(1);
    for bucket in &times.buckets {
        // Never no bar for a bucket that is not empty.
        let length = (bucket.count * BAR).div_ceil(most) as usize;
        let up_to = bucket.up_to_ns / 1000;
        writeln!(out, "    up to {up_to:>8} µs {:>8} {}", bucket.count, "█".repeat(length))?;
    }
    Ok(())
}
