// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What happened in a run of the servo.

use crate::recorder::TickTimes;
use crate::statistics::{Distribution, Times};
use crate::tool_report::{ToolReport, ToolTally};
use palpate_haptics::{EventCounts, Progress, SafetyReport, Servo};

/// A run of the servo in numbers.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct RunReport {
    /// How it ended.
    pub ending: Ending,
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
    /// The largest depth a contact point was pressed to [m]; of a tool with a shape, how far
    /// bodies held its origin from the hand.
    pub largest_depth: f64,
    /// Evaluations of the shape a tick, all points together.
    pub evaluations: Evaluations,
    /// What the servo's step cost a tick, all points together, without the device; `None` if
    /// there was no tick.
    pub cost: Option<Distribution>,
    /// How late ticks started; `None` where they were not paced.
    pub lateness: Option<Distribution>,
    /// Ticks that started more than a period late.
    pub missed_deadlines: u64,
    /// Rows that the recorder had no room for.
    pub rows_dropped: u64,
    /// What happened at the contact points.
    pub events: EventCounts,
    /// What the safety chain of each contact point did; empty on a device that gives no force.
    pub safety: Vec<SafetyReport>,
    /// What a tool with a shape felt; none of contact points.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub tool: Option<ToolReport>,
}

/// How often the shape was evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Evaluations {
    /// In all ticks together.
    pub total: u64,
    /// In a tick, on average.
    pub mean: f64,
    /// In the tick that needed most.
    pub max: u64,
    /// Ticks in which a point, or a tool with a shape, spent its whole budget.
    pub budget_spent: u64,
}

/// Why a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
pub enum Ending {
    /// Its time was over.
    Finished,
    /// The caller asked it to end before its time was over.
    Interrupted,
    /// The device no longer answered.
    DeviceLost {
        /// What its transport said.
        reason: String,
    },
    /// Something in the loop panicked, which is a defect; the forces were set to zero.
    Panicked {
        /// The panic's message.
        message: String,
    },
}

/// Counts while a run runs, in memory set aside beforehand.
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
    tool: Option<ToolTally>,
}

impl Tally {
    pub(crate) fn new(points: usize, rate: f64) -> Self {
        Self {
            points,
            rate,
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

    /// Counts a tick; returns it as others may see it.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn tick<const D: usize>(
        &mut self,
        times: TickTimes,
        servo: &Servo<D>,
    ) -> Progress {
        let (touches, mut budget) = (servo.touches(), servo.options().probe.budget());
        if let Some(tool) = servo.tool() {
            budget = tool.options().budget;
            let is_turned = servo.held_tool().is_some_and(|held| held.given.is_some());
            let written = is_turned.then(|| servo.torque());
            self.tool.get_or_insert_default().tick(tool, written);
        }
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

    pub(crate) fn report(
        &self,
        ending: Ending,
        rows_dropped: u64,
        safety: Vec<SafetyReport>,
    ) -> RunReport {
        let ticks = self.ticks as f64;
        RunReport {
            ending,
            rate: self.rate,
            points: self.points,
            ticks: self.ticks,
            duration: ticks / self.rate,
            contact_time: self.contact_ticks as f64 / self.rate,
            largest_force: self.largest_force,
            largest_depth: self.largest_depth,
            evaluations: Evaluations {
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
            tool: self.tool.as_ref().map(ToolTally::report),
        }
    }
}
