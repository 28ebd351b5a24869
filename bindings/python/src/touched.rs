// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a servo tells: its state, events, report and ticks.

use palpate::field::Vector;
use palpate::haptics::{Event, EventKind, HeldTool, Snapshot};
use palpate::servo_loop::TraceRow;
use pyo3::prelude::*;

use crate::answers::Fields;
use crate::arrays::{row, table};
use crate::scene::matrices;

/// The newest state of a servo of a scene of so many dimensions.
pub(crate) fn snapshot<'py>(
    py: Python<'py>,
    now: &Snapshot,
    names: &[String],
    dimension: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let vector = |v: Vector<f64, 3>| row(py, v.0[..dimension].to_vec());
    let touch = |touch: &palpate::haptics::Touch| {
        Fields::new(py)
            .with("device", vector(touch.device))?
            .with("velocity", vector(touch.velocity))?
            .with("proxy", vector(touch.proxy))?
            .with("wanted", vector(touch.wanted))?
            .with("force", vector(touch.force))?
            .with("normal", vector(touch.normal))?
            .with("body", touch.contact.then(|| names.get(touch.body as usize)).flatten())?
            .with("is_slipping", touch.is_slipping)?
            .of_class("Touch")
    };
    let touches: PyResult<Vec<_>> = now.touches.iter().map(touch).collect();
    let tool = tools(py, now.tool.as_slice(), dimension)?;
    let tool = tool.map(|all| all.first()?.of_class("HeldTool")).transpose()?;
    Fields::new(py)
        .with("time", now.progress.time)?
        .with("ticks", now.progress.ticks)?
        .with("force", now.progress.force)?
        .with("depth", now.progress.depth)?
        .with("touches", pyo3::types::PyTuple::new(py, touches?)?)?
        .with("tool", tool)?
        .with("is_stopped", now.is_stopped)?
        .with("is_lifted", now.is_lifted)?
        .with("events_lost", now.events_lost)?
        .of_class("Snapshot")
}

pub(crate) fn event<'py>(
    py: Python<'py>,
    found: &Event,
    names: &[String],
) -> PyResult<Bound<'py, PyAny>> {
    let (kind, speed, force, button) = match found.kind {
        EventKind::Touch { speed } => ("touch", Some(speed), None, None),
        EventKind::Leave => ("leave", None, None, None),
        EventKind::Slip => ("slip", None, None, None),
        EventKind::Stick => ("stick", None, None, None),
        EventKind::Pop { force } => ("pop", None, Some(force), None),
        EventKind::Carried { .. } => ("carried", None, None, None),
        EventKind::Placed => ("placed", None, None, None),
        EventKind::Squeezed => ("squeezed", None, None, None),
        EventKind::ButtonDown { button } => ("button_down", None, None, Some(button)),
        EventKind::ButtonUp { button } => ("button_up", None, None, Some(button)),
        _ => ("other", None, None, None),
    };
    let distance = match found.kind {
        EventKind::Carried { distance } => Some(distance),
        _ => None,
    };
    // Buttons are of no body.
    let body = names.get(found.body as usize).filter(|_| button.is_none());
    Fields::new(py)
        .with("tick", found.tick)?
        .with("point", found.point)?
        .with("body", body)?
        .with("button", button)?
        .with("kind", kind)?
        .with("speed", speed)?
        .with("force", force)?
        .with("distance", distance)?
        .of_class("Event")
}

/// The ticks of a servo of a scene of so many dimensions.
pub(crate) fn trace<'py>(
    py: Python<'py>,
    rows: &[TraceRow],
    lost: u64,
    dimension: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let vectors = |of: fn(&TraceRow) -> Vector<f64, 3>| {
        let along = |row| of(row).0.into_iter().take(dimension);
        table(py, rows.iter().flat_map(along).collect(), dimension)
    };
    let held: Vec<_> = rows.iter().filter_map(|row| row.tool).collect();
    let tool = tools(py, &held, dimension)?.map(|all| all.of_class("HeldTool")).transpose()?;
    Fields::new(py)
        .with("time", row(py, rows.iter().map(|row| row.time_s).collect()))?
        .with("point", row(py, rows.iter().map(|row| row.point).collect()))?
        .with("device", vectors(|row| row.device)?)?
        .with("proxy", vectors(|row| row.proxy)?)?
        .with("wanted", vectors(|row| row.wanted)?)?
        .with("force", vectors(|row| row.force)?)?
        .with("normal", vectors(|row| row.normal)?)?
        .with("contact", row(py, rows.iter().map(|row| row.contact).collect()))?
        .with("body", row(py, rows.iter().map(|row| row.body).collect()))?
        .with("is_slipping", row(py, rows.iter().map(|row| row.is_slipping).collect()))?
        .with("is_lifted", row(py, rows.iter().map(|row| row.is_lifted).collect()))?
        .with("taken", row(py, rows.iter().map(|row| row.energy.taken).collect()))?
        .with("given", row(py, rows.iter().map(|row| row.energy.given).collect()))?
        .with("kept", row(py, rows.iter().map(|row| row.energy.kept).collect()))?
        .with("tool", tool)?
        .with("evaluations", row(py, rows.iter().map(|row| row.evaluations).collect()))?
        .with("cost_ns", row(py, rows.iter().map(|row| row.cost_ns).collect()))?
        .with("lateness_ns", row(py, rows.iter().map(|row| row.lateness_ns).collect()))?
        .with("lost", lost)?
        .of_class("Trace")
}

/// Tools of a scene of so many dimensions as arrays with a row for each; `None` if there are none.
fn tools<'py>(
    py: Python<'py>,
    all: &[HeldTool],
    dimension: usize,
) -> PyResult<Option<Fields<'py>>> {
    if all.is_empty() {
        return Ok(None);
    }
    // In the plane, turns and torques are about z alone.
    let is_flat = dimension == 2;
    let about = |of: fn(&HeldTool) -> Vector<f64, 3>| {
        if is_flat {
            return Ok(row(py, all.iter().map(|tool| of(tool).0[2]).collect()));
        }
        table(py, all.iter().flat_map(|tool| of(tool).0).collect(), 3)
    };
    let poses = all.iter().map(|tool| tool.pose);
    let poses = if is_flat {
        matrices(py, poses.map(|pose| pose.truncated::<2>()))?
    } else {
        matrices(py, poses)?
    };
    Fields::new(py)
        .with("pose", poses)?
        .with("turn", about(|tool| tool.turn)?)?
        .with("torque", about(|tool| tool.torque)?)?
        .with("given_torque", about(|tool| tool.given.unwrap_or(Vector([f64::NAN; 3])))?)?
        .with("contacts", row(py, all.iter().map(|tool| tool.contacts).collect()))?
        .with("resolution", row(py, all.iter().map(|tool| tool.resolution).collect()))?
        .with("is_degraded", row(py, all.iter().map(|tool| tool.is_degraded).collect()))?
        .with("is_covered", row(py, all.iter().map(|tool| tool.is_covered).collect()))
        .map(Some)
}
