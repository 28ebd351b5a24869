// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The trace of a run: every tick as a row. The columns are documented in
//! `docs/formats.md`.

use std::io::Write;

use palpate::field::{Pose, Rotation, Vector};
use palpate::scene::BuiltScene;
use palpate::servo_loop::{Recorder, TraceRow};

use crate::input::AXES;
use crate::outcome::Failure;

/// The names of the columns. Those of a tool with a shape come last, followed by those of a
/// device with rotation; those of bodies that move follow.
pub(crate) fn header<const D: usize>(has_tool: bool, turns_hand: bool) -> Vec<String> {
    let mut names = vec!["time_s".to_owned(), "point".to_owned()];
    let vectors =
        [("device", "_m"), ("proxy", "_m"), ("wanted", "_n"), ("force", "_n"), ("normal", "")];
    for (vector, unit) in vectors {
        names.extend(AXES[..D].iter().map(|axis| format!("{vector}_{axis}{unit}")));
    }
    let rest = ["contact", "body", "slipping", "taken_j", "given_j", "kept_j"];
    names.extend(rest.map(str::to_owned));
    names.extend(["evaluations", "cost_ns", "lateness_ns"].map(str::to_owned));
    if has_tool {
        for (vector, unit) in [("torque", "_nm"), ("turn", "_rad")] {
            names.extend(turns::<_, D>(AXES).map(|axis| format!("{vector}_{axis}{unit}")));
        }
        names.extend(["contacts", "resolution_m", "degraded"].map(str::to_owned));
    }
    if turns_hand {
        names.extend(turns::<_, D>(AXES).map(|axis| format!("given_torque_{axis}_nm")));
    }
    names
}

/// The components of a rotation: about all axes in space, about z in the plane.
fn turns<T, const D: usize>(axes: [T; 3]) -> impl Iterator<Item = T> {
    axes.into_iter().skip(if D == 2 { 2 } else { 0 })
}

fn fields<const D: usize>(row: &TraceRow<D>) -> Vec<String> {
    let mut fields = vec![row.time_s.to_string(), row.point.to_string()];
    for Vector(components) in [row.device, row.proxy, row.wanted, row.force, row.normal] {
        fields.extend(components.iter().map(f64::to_string));
    }
    fields.extend([
        row.contact.to_string(),
        row.body.to_string(),
        row.is_slipping.to_string(),
        row.energy.taken.to_string(),
        row.energy.given.to_string(),
        row.energy.kept.to_string(),
        row.evaluations.to_string(),
        row.cost_ns.to_string(),
        row.lateness_ns.to_string(),
    ]);
    if let Some(tool) = &row.tool {
        for Vector(components) in [tool.torque, tool.turn] {
            fields.extend(turns::<_, D>(components).map(|x| x.to_string()));
        }
        fields.extend([
            tool.contacts.to_string(),
            tool.resolution.to_string(),
            tool.is_degraded.to_string(),
        ]);
        if let Some(Vector(given)) = tool.given {
            fields.extend(turns::<_, D>(given).map(|x| x.to_string()));
        }
    }
    fields
}

/// The names of the columns for the poses of bodies that move.
fn pose_header<const D: usize>(body: usize) -> Vec<String> {
    let along = AXES[..D].iter().map(|axis| format!("body_{body}_{axis}_m"));
    let about = turns::<_, D>(AXES).map(|axis| format!("body_{body}_turn_{axis}_rad"));
    along.chain(about).collect()
}

fn pose_fields<const D: usize>(pose: &Pose<D>) -> Vec<String> {
    let turn = Rotation::identity().turn_to(&pose.rotation);
    let numbers = pose.translation.0.into_iter().chain(turns::<_, D>(turn.0));
    numbers.map(|x| x.to_string()).collect()
}

/// Writes all rows of `recorder` to `out`, and where the moving bodies of `scene` are.
pub(crate) fn write<const D: usize>(
    scene: &BuiltScene<D>,
    recorder: &Recorder<D>,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    let mut writer = csv::Writer::from_writer(out);
    let tools = || recorder.rows().iter().filter_map(|row| row.tool.as_ref());
    let (has_tool, turns_hand) =
        (tools().next().is_some(), tools().any(|tool| tool.given.is_some()));
    let poses = scene.moving().flat_map(pose_header::<D>);
    writer.write_record(header::<D>(has_tool, turns_hand).into_iter().chain(poses))?;
    for row in recorder.rows() {
        let poses =
            scene.moving().flat_map(|body| pose_fields(&scene.pose_at(body, row.time_s)));
        writer.write_record(fields(row).into_iter().chain(poses))?;
    }
    Ok(writer.flush()?)
}
