// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The report of a tool in a run.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Vector;

use crate::Tool;

/// The report of a rigid tool in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct ToolReport {
    /// Points of its shell.
    pub points: u32,
    /// The largest distance of the tool's surface from the balls of the whole shell [m].
    pub resolution: f64,
    /// The coupling's stiffness [N/m].
    pub stiffness: f64,
    /// The coupling's damping [N·s/m].
    pub damping: f64,
    /// The largest torque that was wanted on the hand [N·m].
    pub largest_torque: f64,
    /// The largest torque written to a device with rotation [N·m], in device coordinates;
    /// `None` for other devices.
    pub largest_torque_written: Option<f64>,
    /// The most contacts that pushed in a tick.
    pub most_contacts: u32,
    /// The mean number of pushing contacts in ticks with contact.
    pub mean_contacts: f64,
    /// Ticks whose budget did not allow all levels of the shell.
    pub degraded_ticks: u64,
    /// The largest distance of the tool's surface from balls that were proven outside, in the
    /// worst tick in which the tool was not covered [m].
    pub coarsest_resolution: f64,
    /// Ticks in which bodies covered the tool.
    pub covered_ticks: u64,
}

/// Counts during a run.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ToolTally {
    report: ToolReport,
    contacts: u64,
    contact_ticks: u64,
}

impl ToolTally {
    /// Counts a tick with the torque written to a device with rotation.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn tick(&mut self, tool: &Tool, written: Option<Vector<f64, 3>>) {
        let (held, shell, report) = (tool.held(), tool.shell(), &mut self.report);
        report.points = shell.points().len() as u32;
        report.resolution = shell.resolution(shell.points().len());
        report.stiffness = tool.coupling().stiffness;
        report.damping = tool.coupling().damping;
        report.largest_torque = report.largest_torque.max(held.torque.norm());
        if let Some(written) = written {
            let largest = report.largest_torque_written.unwrap_or(0.0).max(written.norm());
            report.largest_torque_written = Some(largest);
        }
        report.most_contacts = report.most_contacts.max(held.contacts);
        report.degraded_ticks += u64::from(held.is_degraded);
        report.covered_ticks += u64::from(held.is_covered);
        if held.resolution.is_finite() {
            report.coarsest_resolution = report.coarsest_resolution.max(held.resolution);
        }
        self.contacts += u64::from(held.contacts);
        self.contact_ticks += u64::from(held.contacts > 0);
    }

    pub(crate) fn report(&self) -> ToolReport {
        let ticks = self.contact_ticks.max(1) as f64;
        ToolReport { mean_contacts: self.contacts as f64 / ticks, ..self.report }
    }
}
