// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Traces: rows of ticks as CSV.

use std::fmt::{self, Write as _};
use std::io;

use crate::HeldTool;
use palpate_field::{Pose, Rotation, Vector};

use super::recorder::TraceRow;

/// The names of axes.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Writes rows as CSV, in the columns that `docs/formats.md` describes: those of every contact
/// point; then, if the first row has a [tool](TraceRow::tool), those of a tool; then, if a device
/// turns it, those of the torque on the hand; then the poses of
/// [bodies that move](Self::with_poses).
///
/// Numbers are written so that reading them gives the same bits. Writing to a file is slower than
/// ticks may be: write rows in another thread, taken from [`Records`](super::Records), or in a
/// [sink](super::RunOptions::sink).
///
/// # Examples
///
/// ```
/// use palpate_field::Vector;
/// use palpate_haptics::servo_loop::{TraceRow, TraceWriter};
///
/// # fn main() -> std::io::Result<()> {
/// let mut trace = TraceWriter::new(Vec::new()).in_plane();
/// trace.write(&TraceRow::free(0.001, 0, Vector([0.25, 0.5, 0.0])))?;
/// let csv = String::from_utf8(trace.finish()?).unwrap_or_default();
/// assert!(csv.starts_with("time_s,point,device_x_m,device_y_m,proxy_x_m,proxy_y_m,"));
/// assert!(csv.contains("\n0.001,0,0.25,0.5,0.25,0.5,"));
/// # Ok(())
/// # }
/// ```
pub struct TraceWriter<'a, W: io::Write> {
    csv: csv::Writer<W>,
    /// The columns, once they are written.
    columns: Option<Columns>,
    bodies: Vec<usize>,
    pose_at: PoseAt<'a>,
    /// The number of axes along which positions and forces have columns.
    dimension: usize,
    /// The text of a field, kept to save its memory.
    field: String,
    rows: u64,
}

/// The pose of a body by its number and the time [s].
type PoseAt<'a> = Box<dyn Fn(usize, f64) -> Pose<3> + Send + 'a>;

/// Which columns a trace has beside those that all have.
#[derive(Clone, Copy)]
struct Columns {
    has_tool: bool,
    turns_hand: bool,
}

impl<'a, W: io::Write> TraceWriter<'a, W> {
    /// A trace that goes to `out`, which is flushed by [`finish`](Self::finish).
    #[must_use]
    pub fn new(out: W) -> Self {
        Self {
            csv: csv::Writer::from_writer(out),
            columns: None,
            bodies: Vec::new(),
            pose_at: Box::new(|_, _| Pose::identity()),
            dimension: 3,
            field: String::new(),
            rows: 0,
        }
    }

    /// The same trace of a planar scene: without the columns of what is zero in it, along z and about
    /// x and y.
    #[must_use]
    pub fn in_plane(self) -> Self {
        Self { dimension: 2, ..self }
    }

    /// The same trace with the pose of each of these bodies, by their numbers from 0, at the times
    /// of the rows.
    #[must_use]
    pub fn with_poses(
        self,
        bodies: impl IntoIterator<Item = usize>,
        pose_at: impl Fn(usize, f64) -> Pose<3> + Send + 'a,
    ) -> Self {
        Self { bodies: bodies.into_iter().collect(), pose_at: Box::new(pose_at), ..self }
    }

    /// Writes a row, before the first one the names of the columns.
    ///
    /// # Errors
    ///
    /// That `out` cannot be written.
    pub fn write(&mut self, row: &TraceRow) -> io::Result<()> {
        let columns = match self.columns {
            Some(columns) => columns,
            None => self.write_names(Columns {
                has_tool: row.tool.is_some(),
                turns_hand: row.tool.is_some_and(|tool| tool.given.is_some()),
            })?,
        };
        self.field(row.time_s)?;
        self.field(row.point)?;
        for Vector(components) in [row.device, row.proxy, row.wanted, row.force, row.normal] {
            self.fields(self.along(components))?;
        }
        self.field(row.contact)?;
        self.field(row.body)?;
        self.field(row.is_slipping)?;
        self.field(row.is_lifted)?;
        self.fields([row.energy.taken, row.energy.given, row.energy.kept])?;
        self.field(row.evaluations)?;
        self.field(row.cost_ns)?;
        self.field(row.lateness_ns)?;
        if columns.has_tool {
            self.write_tool(row.tool.as_ref())?;
        }
        if columns.turns_hand {
            self.optional(self.turns(given(row.tool.as_ref())))?;
        }
        for body in 0..self.bodies.len() {
            let pose = (self.pose_at)(self.bodies[body], row.time_s);
            self.fields(self.along(pose.translation.0))?;
            self.fields(self.turns(Rotation::identity().turn_to(&pose.rotation).0))?;
        }
        self.end_row()?;
        self.rows += 1;
        Ok(())
    }

    /// The number of rows written, without the names of the columns.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Ends the trace, and returns what it was written to. A trace without rows has the names of
    /// the columns of a contact point.
    ///
    /// # Errors
    ///
    /// That `out` cannot be written.
    pub fn finish(mut self) -> io::Result<W> {
        if self.columns.is_none() {
            self.write_names(Columns { has_tool: false, turns_hand: false })?;
        }
        self.csv.into_inner().map_err(|error| error.into_error())
    }

    /// Writes the names of the columns: those of all traces first, then those of a tool, of the
    /// torque on the hand, and of bodies that move.
    fn write_names(&mut self, columns: Columns) -> io::Result<Columns> {
        self.field("time_s")?;
        self.field("point")?;
        for (vector, unit) in [
            ("device", "_m"),
            ("proxy", "_m"),
            ("wanted", "_n"),
            ("force", "_n"),
            ("normal", ""),
        ] {
            self.names(&format!("{vector}_"), &AXES[..self.dimension], unit)?;
        }
        self.fields(["contact", "body", "slipping", "lifted", "taken_j", "given_j", "kept_j"])?;
        self.fields(["evaluations", "cost_ns", "lateness_ns"])?;
        let about: Vec<_> = self.turns(AXES).collect();
        if columns.has_tool {
            self.names("torque_", &about, "_nm")?;
            self.names("turn_", &about, "_rad")?;
            self.fields(["contacts", "resolution_m", "degraded"])?;
        }
        if columns.turns_hand {
            self.names("given_torque_", &about, "_nm")?;
        }
        for body in self.bodies.clone() {
            self.names(&format!("body_{body}_"), &AXES[..self.dimension], "_m")?;
            self.names(&format!("body_{body}_turn_"), &about, "_rad")?;
        }
        self.end_row()?;
        self.columns = Some(columns);
        Ok(columns)
    }

    /// The components along the axes that have columns.
    fn along<T>(&self, axes: [T; 3]) -> impl Iterator<Item = T> + use<T, W> {
        axes.into_iter().take(self.dimension)
    }

    /// The components of a rotation: about all axes in space, about z in the plane.
    fn turns<T>(&self, axes: [T; 3]) -> impl Iterator<Item = T> + use<T, W> {
        axes.into_iter().skip(if self.dimension == 2 { 2 } else { 0 })
    }

    /// Writes the columns of a tool, empty ones for a row without a tool.
    fn write_tool(&mut self, tool: Option<&HeldTool>) -> io::Result<()> {
        let of = |vector: fn(&HeldTool) -> Vector<f64, 3>| {
            tool.map_or([None; 3], |tool| vector(tool).0.map(Some))
        };
        self.optional(self.turns(of(|tool| tool.torque)))?;
        self.optional(self.turns(of(|tool| tool.turn)))?;
        self.optional([tool.map(|tool| tool.contacts)])?;
        self.optional([tool.map(|tool| tool.resolution)])?;
        self.optional([tool.map(|tool| tool.is_degraded)])
    }

    fn names(&mut self, before: &str, axes: &[&str], after: &str) -> io::Result<()> {
        axes.iter().try_for_each(|axis| self.field(format_args!("{before}{axis}{after}")))
    }

    fn fields(
        &mut self,
        values: impl IntoIterator<Item = impl fmt::Display>,
    ) -> io::Result<()> {
        values.into_iter().try_for_each(|value| self.field(value))
    }

    /// Fields of which some are empty.
    fn optional(
        &mut self,
        values: impl IntoIterator<Item = Option<impl fmt::Display>>,
    ) -> io::Result<()> {
        values.into_iter().try_for_each(|value| match value {
            Some(value) => self.field(value),
            None => self.field(""),
        })
    }

    fn field(&mut self, value: impl fmt::Display) -> io::Result<()> {
        self.field.clear();
        write!(self.field, "{value}").map_err(io::Error::other)?;
        Ok(self.csv.write_field(&self.field)?)
    }

    /// Ends a row. A row with another number of fields than the first is an error.
    fn end_row(&mut self) -> io::Result<()> {
        Ok(self.csv.write_record(None::<&[u8]>)?)
    }
}

impl<W: io::Write> fmt::Debug for TraceWriter<'_, W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TraceWriter")
            .field("rows", &self.rows)
            .field("bodies", &self.bodies)
            .finish_non_exhaustive()
    }
}

/// The torque on the hand about each axis; `None` where the row has none.
fn given(tool: Option<&HeldTool>) -> [Option<f64>; 3] {
    tool.and_then(|tool| tool.given).map_or([None; 3], |Vector(torque)| torque.map(Some))
}

#[cfg(test)]
mod tests {
    use palpate_field::Point;

    use super::*;

    fn written(
        trace: impl FnOnce(&mut TraceWriter<'_, Vec<u8>>),
        is_flat: bool,
        poses: &[(usize, Pose<3>)],
    ) -> Vec<String> {
        let pose_at = |body, time: f64| {
            let (_, pose) = poses.iter().find(|(number, _)| *number == body).unwrap();
            Pose { translation: pose.translation * time, ..*pose }
        };
        let mut writer = TraceWriter::new(Vec::new())
            .with_poses(poses.iter().map(|(body, _)| *body), pose_at);
        if is_flat {
            writer = writer.in_plane();
        }
        trace(&mut writer);
        let text = String::from_utf8(writer.finish().unwrap()).unwrap();
        text.lines().map(str::to_owned).collect()
    }

    #[test]
    fn every_column_has_its_number() {
        let row = TraceRow {
            proxy: Vector([0.5, 0.75, 0.0]),
            wanted: Vector([1.0, 2.0, 0.0]),
            force: Vector([3.0, 4.0, 0.0]),
            normal: Vector([0.0, 1.0, 0.0]),
            contact: true,
            body: 7,
            is_slipping: true,
            evaluations: 11,
            cost_ns: 12,
            lateness_ns: 13,
            ..TraceRow::free(0.1, 6, Point::from([-0.1, 1e-20, 0.0]))
        };
        let lines = written(|trace| trace.write(&row).unwrap(), true, &[]);
        let names = "time_s,point,device_x_m,device_y_m,proxy_x_m,proxy_y_m,wanted_x_n,wanted_y_n,\
                     force_x_n,force_y_n,normal_x,normal_y,contact,body,slipping,lifted,taken_j,given_j,\
                     kept_j,evaluations,cost_ns,lateness_ns";
        let numbers = "0.1,6,-0.1,0.00000000000000000001,0.5,0.75,1,2,3,4,0,1,true,7,true,false,0,0,0,11,\
                       12,13";
        assert_eq!(lines, [names, numbers]);
    }

    #[test]
    fn a_trace_without_rows_has_the_names_of_columns() {
        let lines = written(|_| {}, false, &[]);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].starts_with("time_s,point,device_x_m,device_y_m,device_z_m,"));
        assert!(lines[0].ends_with(",lateness_ns"));
    }

    #[test]
    fn bodies_that_move_come_last_at_the_time_of_the_row() {
        let pose = Pose {
            rotation: Rotation::from_angle(0.5).unwrap().in_space(),
            ..Pose::translation(Vector([2.0, -4.0, 0.0]))
        };
        let row = TraceRow::free(0.5, 0, Vector([0.0, 0.0, 0.0]));
        let lines = written(|trace| trace.write(&row).unwrap(), true, &[(3, pose)]);
        assert!(lines[0].ends_with(",lateness_ns,body_3_x_m,body_3_y_m,body_3_turn_z_rad"));
        assert!(lines[1].ends_with(",0,1,-2,0.5"), "{}", lines[1]);
    }
}
