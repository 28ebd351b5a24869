// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The report of a run as lines, each with what it is about before it.

use std::fmt::{Display, Formatter, Result};

use palpate_safety::{Effect, PassivityReport, SafetyReport, StageEffects};

use super::connection::ConnectionReport;
use super::display::NOT_RELEASED;
use super::report::{Ending, RunReport, ToolReport};

/// A line that begins with what it is about; one that continues the line before has no label.
pub(crate) fn line(f: &mut Formatter<'_>, label: &str, what: impl Display) -> Result {
    writeln!(f, "  {label:14} {what}")
}

/// Writes all lines.
pub(crate) fn write(f: &mut Formatter<'_>, report: &RunReport) -> Result {
    match &report.ending {
        Ending::Finished => {}
        Ending::Interrupted => {
            writeln!(f, "  interrupted: this report covers the run until then")?
        }
        ending => writeln!(f, "  {ending}")?,
    }
    if !report.is_released {
        writeln!(f, "  {NOT_RELEASED}")?;
    }
    line(f, "ticks", format_args!("{} at {} Hz", report.ticks, report.rate))?;
    let (contact, duration) = (report.contact_time, report.duration);
    let share = 100.0 * contact / duration.max(f64::MIN_POSITIVE);
    let said = format_args!("{contact:.3} s of {duration:.3} s ({share:.0} %)");
    line(f, "contact time", said)?;
    // A device that gives no force has no safety chain.
    if !report.safety.is_empty() {
        line(f, "largest force", format_args!("{:.3} N", report.largest_force))?;
    }
    line(f, "largest depth", format_args!("{:.3} mm", 1e3 * report.largest_depth))?;
    if let Some(tool) = &report.tool {
        write_tool(f, tool, &report.safety)?;
    }
    line(f, "evaluations", report.evaluations)?;
    if report.evaluations.budget_spent > 0 {
        let spent = report.evaluations.budget_spent;
        line(f, "", format_args!("{spent} ticks spent their budget"))?;
    }
    line(f, "events", report.events)?;
    if report.rows_dropped > 0 {
        let said = "ticks were faster than their rows were written";
        line(f, "rows lost", format_args!("{}; {said}", report.rows_dropped))?;
    }
    for (number, guide) in report.guides.iter().enumerate() {
        line(f, &format!("guide {number}"), guide)?;
    }
    if let Some(texture) = report.texture.filter(|texture| texture.faded_ticks > 0) {
        line(f, "texture", texture)?;
    }
    write_safety(f, &report.safety)?;
    // A device that gives no force has nothing to let go.
    let is_quiet = report.safety.is_empty() && report.connection == ConnectionReport::default();
    if !is_quiet {
        line(f, "device", &report.connection)?;
    }
    if let Some(vibration) = &report.vibration {
        line(f, "vibration", vibration)?;
    }
    if let Some(cost) = &report.cost {
        line(f, "cost a tick", cost)?;
    }
    if let Some(lateness) = &report.lateness {
        line(f, "lateness", format_args!("{lateness:#}"))?;
        let missed = report.missed_deadlines;
        line(f, "missed", format_args!("{missed} ticks more than a period late"))?;
    }
    Ok(())
}

/// The lines of a tool that contact points do not have.
fn write_tool(f: &mut Formatter<'_>, tool: &ToolReport, safety: &[SafetyReport]) -> Result {
    let torque = 1e3 * tool.largest_torque;
    match tool.largest_torque_written {
        Some(written) => {
            let written = 1e3 * written;
            let turning = safety.iter().filter_map(|point| point.turning.as_ref());
            let at_device = 1e3 * turning.map(|t| t.largest_torque).fold(0.0, f64::max);
            let said =
                format_args!("{torque:.3} mN·m, {written:.3} mN·m written, in the world");
            line(f, "largest torque", said)?;
            line(f, "", format_args!("{at_device:.3} mN·m written to the device"))?;
        }
        None => line(f, "largest torque", format_args!("{torque:.3} mN·m, in the world"))?,
    }
    let (mean, most) = (tool.mean_contacts, tool.most_contacts);
    let said = format_args!("{mean:.2} on average in contact, {most} at most");
    line(f, "contacts", said)?;
    let said = format_args!(
        "{:.3} mm, in the worst tick {:.3} mm; {} ticks with a coarser shell",
        1e3 * tool.resolution,
        1e3 * tool.coarsest_resolution,
        tool.degraded_ticks,
    );
    line(f, "resolution", said)?;
    if tool.covered_ticks > 0 {
        line(f, "", format_args!("{} ticks covered by bodies", tool.covered_ticks))?;
    }
    Ok(())
}

/// The actions of the safety chains of all points together.
fn write_safety(f: &mut Formatter<'_>, safety: &[SafetyReport]) -> Result {
    if safety.is_empty() {
        return Ok(());
    }
    let energy = |of: fn(&PassivityReport) -> f64| -> f64 {
        1e3 * safety.iter().map(|point| of(&point.passivity)).sum::<f64>()
    };
    let said = format_args!(
        "contacts took {:.3} mJ from the hand and gave {:.3} mJ; {:.3} mJ were kept back",
        energy(|p| p.energy_in),
        energy(|p| p.energy_out),
        energy(|p| p.dissipated),
    );
    line(f, "energy", said)?;
    let driven = 1e3 * safety.iter().map(|point| point.drives.driven).sum::<f64>();
    if driven != 0.0 {
        let said =
            "by the motion of the hand relative to the bodies; the motion of the bodies did";
        line(f, "", format_args!("{said} {driven:.3} mJ of work on it"))?;
    }
    let credited = energy(|p| p.credited);
    if credited > 0.0 {
        let said =
            "mJ may be given beyond that: by forces that rise from zero or are handed over";
        line(f, "", format_args!("{credited:.3} {said}"))?;
    }
    let ticks = |of: fn(&SafetyReport) -> u64| safety.iter().map(of).sum::<u64>();
    let stages: StageEffects = safety.iter().map(StageEffects::from).sum();
    let acted = stages.named().filter(|(_, effect)| effect.ticks > 0);
    let acted: Vec<_> = acted.map(|(stage, effect)| acted_in_words(stage, effect)).collect();
    let acted = if acted.is_empty() { "nothing to do".to_owned() } else { acted.join(", ") };
    line(f, "safety, ticks", acted)?;
    let least = safety.iter().map(|point| point.limit_cycles.least_part).fold(1.0, f64::min);
    if least < 1.0 {
        let said = "oscillated against bodies, which became softer: check its profile";
        line(f, "", format_args!("the device {said}; {least:.3} of the stiffness at least"))?;
    }
    let trips = ticks(|point| point.watchdog.trips);
    // A stop is one of all contact points.
    match safety.iter().map(|point| point.stops).max().unwrap_or_default() {
        0 => line(f, "", format_args!("{trips} watchdog trips")),
        1 => line(f, "", format_args!("{trips} watchdog trips, 1 emergency stop")),
        stops => line(f, "", format_args!("{trips} watchdog trips, {stops} emergency stops")),
    }
}

/// A stage with its ticks, and the most that it changed a force or a torque by.
fn acted_in_words(stage: &str, Effect { ticks, largest, .. }: Effect) -> String {
    let unit = if stage.contains("torque") { "N·m" } else { "N" };
    if largest > 0.0 {
        format!("{stage} {ticks} (up to {largest:.3} {unit})")
    } else {
        format!("{stage} {ticks}")
    }
}
