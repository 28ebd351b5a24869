// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The charts of a run: forces or levels, torques, energies.

use palpate::field::Vector;
use palpate::haptics::{Energy, HeldTool};
use palpate::plot::{Chart, ChartQuantity, Color, Dash, Figure, PlotError, Series};
use palpate::servo_loop::TraceRow;
use palpate::vibration::Tones;

use super::points::{Points, every};
use crate::feel::vibration::Vibration;
use crate::outcome::Failure;

/// Up to so many contact points have their forces in one chart.
const TOGETHER: usize = 3;

/// Up to so many contact points have a panel each: two hands with twelve points.
const MOST_PANELS: usize = 24;

/// A chart of a quantity over time.
fn over_time(name: &str, unit: &str) -> Chart {
    Chart::new(ChartQuantity::new("time", "s"), ChartQuantity::new(name, unit))
}

/// `figure` with the forces of all contact points.
pub(super) fn with_forces(figure: Figure, points: &Points<'_>) -> Result<Figure, PlotError> {
    let count = points.count();
    if count > MOST_PANELS {
        let name = format!("largest force on one of {count} points");
        let series = Series::new(name, points.largest_force())?.with_color(points.color(0));
        return Ok(figure.with_chart(over_time("force", "N").with_series(series)));
    }
    let series = |number: usize, name: String| {
        let series = Series::new(name, points.force(number))?;
        Ok(series.with_color(points.color(number)).with_dash(Dash::Solid))
    };
    if count <= TOGETHER {
        let mut chart = over_time("force", "N");
        for number in 0..count {
            chart = chart.with_series(series(number, points.named("force", number))?);
        }
        return Ok(figure.with_chart(chart));
    }
    let panel = |number: usize| {
        let chart = over_time("force", "N").with_series(series(number, "force".to_owned())?);
        Ok(chart.with_title(format!("point {number}")))
    };
    let panels = (0..count).map(panel).collect::<Result<Vec<_>, PlotError>>()?;
    Ok(figure.with_panels(panels))
}

/// The level of a kind of tone, as a part of the actuator's largest.
type Level = fn(&Tones) -> f64;

/// The kinds of tones, with the dashes of their lines.
const KINDS: [(&str, Dash, Level); 3] = [
    ("pressure", Dash::Solid, |tones| tones.hold.amplitude),
    ("slide", Dash::Dashed, |tones| tones.slide.amplitude),
    ("tap", Dash::Dotted, |tones| tones.tap.amplitude),
];

/// `figure` with the levels of all actuators, one a contact point.
pub(super) fn with_levels(
    figure: Figure,
    points: &Points<'_>,
    vibration: &Vibration,
) -> Result<Figure, Failure> {
    let (times, tones) = (vibration.times(), vibration.tones()?);
    if tones.len() > MOST_PANELS {
        let all: Vec<_> = tones.iter().map(Vec::as_slice).collect();
        let chart = levels(times, &all, points.color(0)).map_err(Failure::input)?;
        let title = format!("Largest level of {} actuators", tones.len());
        return Ok(figure.with_chart(chart.with_title(title)));
    }
    if let [alone] = &tones[..] {
        let chart = levels(times, &[alone], points.color(0)).map_err(Failure::input)?;
        return Ok(figure.with_chart(chart));
    }
    let panel = |(number, tones): (usize, &Vec<Tones>)| {
        let chart = levels(times, &[tones], points.color(number))?;
        Ok(chart.with_title(format!("actuator {number}")))
    };
    let panels = tones.iter().enumerate().map(panel).collect::<Result<Vec<_>, PlotError>>();
    Ok(figure.with_panels(panels.map_err(Failure::input)?))
}

/// The largest levels of some actuators at `times` [s].
fn levels(times: &[f64], actuators: &[&[Tones]], color: Color) -> Result<Chart, PlotError> {
    let every = every(times.len());
    let mut chart = over_time("level", "1 = largest");
    for (name, dash, level) in KINDS {
        // The largest until the next place, so that no tap is left out.
        let largest = |start: usize| {
            let ticks = start..(start + every).min(times.len());
            let levels =
                actuators.iter().flat_map(|tones| tones[ticks.clone()].iter().map(level));
            [times[start], levels.fold(0.0, f64::max)]
        };
        let line = (0..times.len()).step_by(every).map(largest);
        let series = Series::new(name, line)?.with_dash(dash).with_color(color);
        chart = chart.with_series(series);
    }
    Ok(chart)
}

/// The torque of a tool over time, and the torque written to a device with rotation, both in the
/// world. `None` for contact points.
pub(super) fn torques(rows: &[TraceRow]) -> Result<Option<Chart>, PlotError> {
    let every = every(rows.len());
    let of = |torque: fn(&HeldTool) -> Option<Vector<f64, 3>>| {
        let torque = |row: &TraceRow| {
            Some([row.time_s, 1e3 * row.tool.as_ref().and_then(torque)?.norm()])
        };
        rows.iter().step_by(every).filter_map(torque).collect::<Vec<_>>()
    };
    let (wanted, given) = (of(|tool| Some(tool.torque)), of(|tool| tool.given));
    if wanted.is_empty() {
        return Ok(None);
    }
    let chart =
        over_time("torque in the world", "mN·m").with_series(Series::new("torque", wanted)?);
    Ok(Some(if given.is_empty() {
        chart
    } else {
        chart.with_series(Series::new("given to the hand", given)?.with_dash(Dash::Dashed))
    }))
}

/// The energies of all contact points together over time; `None` if there are none.
pub(super) fn energies(rows: &[TraceRow], points: usize) -> Result<Option<Chart>, PlotError> {
    if rows.iter().all(|row| row.energy == Energy::default()) {
        return Ok(None);
    }
    let names = ["taken from the hand", "given to it", "kept back"];
    let dashes = [Dash::Solid, Dash::Dashed, Dash::Dotted];
    let ticks: Vec<&[TraceRow]> = rows.chunks_exact(points.max(1)).collect();
    let every = every(ticks.len());
    let mut chart = over_time("energy", "mJ");
    for (curve, (name, dash)) in names.into_iter().zip(dashes).enumerate() {
        let points = ticks.iter().step_by(every).map(|tick| {
            let energies = tick.iter().map(|row| &row.energy);
            let sum: f64 = energies.map(|e| [e.taken, e.given, e.kept][curve]).sum();
            [tick[0].time_s, 1e3 * sum]
        });
        chart = chart.with_series(Series::new(name, points)?.with_dash(dash));
    }
    Ok(Some(chart))
}
