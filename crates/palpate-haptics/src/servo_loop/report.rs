// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The report of a run.

use super::connection::ConnectionReport;
use super::guide_report::{GuideReport, GuideTally};
use super::recorder::TickTimes;
use super::start_report::{StartInside, StartTally};
use super::statistics::{Distribution, Times};
use super::texture_report::TextureReport;
use super::tool_report::{ToolReport, ToolTally};
use super::vibration::VibrationReport;
use crate::{EventCounts, Progress, Servo};
use palpate_device::DeviceLost;
use palpate_safety::SafetyReport;

/// The report of a run of a servo.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct RunReport {
    /// Why the run ended.
    pub ending: Ending,
    /// `true` if the device accepted the final zero forces; a lost device may have refused them.
    pub is_released: bool,
    /// Ticks a second [Hz].
    pub rate: f64,
    /// Contact points.
    pub points: usize,
    /// Ticks done.
    pub ticks: u64,
    /// The servo's time that passed: ticks over rate [s].
    pub duration: f64,
    /// The time during which at least one point was in contact [s].
    pub contact_time: f64,
    /// The largest force on a contact point [N].
    pub largest_force: f64,
    /// The largest depth of a contact point [m]; for a tool, the largest distance of its origin
    /// from the device point.
    pub largest_depth: f64,
    /// Evaluations of the shape a tick, all points together.
    pub evaluations: EvaluationCounts,
    /// The duration of the servo's step in a tick, for all points together, without the device;
    /// `None` if there was no tick.
    pub cost: Option<Distribution>,
    /// How late ticks started; `None` in a run without pacing.
    pub lateness: Option<Distribution>,
    /// Ticks that started more than a period late.
    pub missed_deadlines: u64,
    /// Rows that were not kept, because a recorder was full or a reader of rows fell behind.
    pub rows_dropped: u64,
    /// Counts of events at the contact points.
    pub events: EventCounts,
    /// The report of each contact point's safety chain; empty for a device that gives no force.
    pub safety: Vec<SafetyReport>,
    /// The contact points that were inside a body in the first tick.
    pub starts_inside: Vec<StartInside>,
    /// The report of the connection to the device.
    pub connection: ConnectionReport,
    /// The report of each guide of the servo; none if the device gives no force.
    pub guides: Vec<GuideReport>,
    /// The report of height textures; `None` if none was touched.
    pub texture: Option<TextureReport>,
    /// The report of the tool; `None` if the servo renders contact points.
    pub tool: Option<ToolReport>,
    /// The report of a device that vibrates; `None` without one.
    pub vibration: Option<VibrationReport>,
}

impl RunReport {
    /// The report of a run that ended as asked: for callers who take any other ending for an
    /// error.
    ///
    /// # Errors
    ///
    /// [`RunError`] if the device was lost or did not take the zero forces at the end, or if the
    /// loop panicked.
    pub fn unless_failed(self) -> Result<Self, RunError> {
        let lost = |reason: &str| Err(DeviceLost { reason: reason.to_owned() }.into());
        match &self.ending {
            Ending::DeviceLost { reason } => lost(reason),
            Ending::Panicked { message } => {
                let (message, is_released) = (message.clone(), self.is_released);
                Err(RunError::Panicked { message, is_released })
            }
            _ if !self.is_released => lost("it did not take the zero forces at the end"),
            _ => Ok(self),
        }
    }
}

/// Why a run did not end as asked.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The device was lost, or did not take the zero forces at the end.
    #[error(transparent)]
    DeviceLost(#[from] DeviceLost),
    /// The loop panicked, which is a defect.
    #[error("the servo's loop panicked, which is a defect: {message}")]
    Panicked {
        /// The panic's message.
        message: String,
        /// `true` if the device accepted the zero forces.
        is_released: bool,
    },
}

/// How often the shape was evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct EvaluationCounts {
    /// In all ticks.
    pub total: u64,
    /// The mean of a tick.
    pub mean: f64,
    /// The most in a tick.
    pub max: u64,
    /// Ticks in which a contact point or a tool used up its budget.
    pub budget_spent: u64,
}

/// Why a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Ending {
    /// The duration was over, or the handle of the servo's thread ended the run.
    Finished,
    /// The [interrupt flag](super::RunOptions::interrupt) of the run was set.
    Interrupted,
    /// The device was lost.
    DeviceLost {
        /// The message of the transport.
        reason: String,
    },
    /// The loop panicked, which is a defect. [`RunReport::is_released`] says whether the device
    /// took the zero forces after it.
    Panicked {
        /// The panic's message.
        message: String,
    },
}

/// How a run ended, and what others than the [`Tally`] saw of it.
#[derive(Debug)]
pub(crate) struct Ended {
    pub(crate) ending: Ending,
    pub(crate) is_released: bool,
    pub(crate) rows_dropped: u64,
    pub(crate) safety: Vec<SafetyReport>,
    pub(crate) connection: ConnectionReport,
    pub(crate) vibration: Option<VibrationReport>,
}

/// Counts during a run, in preallocated memory.
#[derive(Debug)]
pub(crate) struct Tally {
    points: usize,
    rate: f64,
    ticks: u64,
    contact_ticks: u64,
    missed_deadlines: u64,
    budget_spent: u64,
    evaluations: u64,
    most_evaluations: u64,
    largest_force: f64,
    largest_depth: f64,
    cost: Times,
    lateness: Times,
    events: EventCounts,
    starts: StartTally,
    guides: GuideTally,
    texture: TextureReport,
    tool: Option<ToolTally>,
}

impl Tally {
    pub(crate) fn new(servo: &Servo) -> Self {
        let points = servo.touches().len();
        Self {
            points,
            rate: servo.options().rate,
            ticks: 0,
            contact_ticks: 0,
            missed_deadlines: 0,
            budget_spent: 0,
            evaluations: 0,
            most_evaluations: 0,
            largest_force: 0.0,
            largest_depth: 0.0,
            cost: Times::new(),
            lateness: Times::new(),
            events: EventCounts::default(),
            starts: StartTally::new(points),
            guides: GuideTally::new(servo),
            texture: TextureReport::default(),
            tool: None,
        }
    }

    /// Counts how late a tick started.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn late(&mut self, lateness_ns: u64, missed: bool) {
        self.lateness.record(lateness_ns);
        self.missed_deadlines += u64::from(missed);
    }

    /// Counts a tick, and returns the progress for other threads.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn tick(&mut self, times: TickTimes, servo: &Servo) -> Progress {
        let (touches, mut budget) = (servo.touches(), servo.options().probe.budget());
        if let Some(tool) = servo.tool() {
            budget = tool.options().budget;
            let is_turned = servo.held_tool().is_some_and(|held| held.given.is_some());
            let written = is_turned.then(|| servo.torque());
            self.tool.get_or_insert_default().tick(tool, written);
        }
        self.starts.tick(servo);
        self.guides.tick(servo);
        self.texture.tick(servo);
        servo.events().iter().for_each(|event| self.events.count(event));
        self.ticks += 1;
        self.cost.record(times.cost_ns);
        let mut progress = Progress {
            ticks: self.ticks,
            time: times.time_s,
            cost_ns: times.cost_ns,
            ..Progress::default()
        };
        let mut is_spent = false;
        for touch in touches {
            progress.contacts += u64::from(touch.contact);
            progress.evaluations += u64::from(touch.evaluations);
            progress.force = progress.force.max(touch.force.norm());
            progress.depth = progress.depth.max(touch.depth());
            is_spent |= touch.evaluations >= budget;
        }
        self.contact_ticks += u64::from(progress.contacts > 0);
        self.budget_spent += u64::from(is_spent);
        self.evaluations += progress.evaluations;
        self.most_evaluations = self.most_evaluations.max(progress.evaluations);
        self.largest_force = self.largest_force.max(progress.force);
        self.largest_depth = self.largest_depth.max(progress.depth);
        progress
    }

    pub(crate) fn report(&self, ended: Ended) -> RunReport {
        let Ended { ending, is_released, rows_dropped, safety, connection, vibration } = ended;
        let ticks = self.ticks as f64;
        RunReport {
            ending,
            is_released,
            rate: self.rate,
            points: self.points,
            ticks: self.ticks,
            duration: ticks / self.rate,
            contact_time: self.contact_ticks as f64 / self.rate,
            largest_force: self.largest_force,
            largest_depth: self.largest_depth,
            evaluations: EvaluationCounts {
                total: self.evaluations,
                mean: if self.ticks > 0 { self.evaluations as f64 / ticks } else { 0.0 },
                max: self.most_evaluations,
                budget_spent: self.budget_spent,
            },
            cost: self.cost.distribution(),
            lateness: self.lateness.distribution(),
            missed_deadlines: self.missed_deadlines,
            rows_dropped,
            events: self.events,
            safety,
            connection,
            vibration,
            starts_inside: self.starts.reports(self.rate),
            guides: self.guides.reports(self.rate),
            texture: Some(self.texture).filter(|texture| texture.ticks > 0),
            tool: self.tool.as_ref().map(ToolTally::report),
        }
    }
}
