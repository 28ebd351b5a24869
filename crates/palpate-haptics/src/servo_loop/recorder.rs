// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A recording of every tick in preallocated memory.

use crate::{Energy, HeldTool, Servo};
use palpate_field::{Point, Vector};

/// One contact point in one tick: a row of a trace. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TraceRow {
    /// The time of the tick since the servo started [s].
    pub time_s: f64,
    /// The index of the contact point, from 0.
    pub point: u32,
    /// The device point [m].
    pub device: Point<3>,
    /// The proxy [m]; the device point itself in free space.
    pub proxy: Point<3>,
    /// The force of the touched body, before the limits of the device and the rest of the safety
    /// chain [N]; its stiffness is the accepted one.
    pub wanted: Vector<f64, 3>,
    /// The written force on the hand [N].
    pub force: Vector<f64, 3>,
    /// The unit normal of the surface that the proxy last reached, pointing out.
    pub normal: Vector<f64, 3>,
    /// `true` if the surface keeps the proxy from the device point.
    pub contact: bool,
    /// The index of the body whose surface the proxy last reached.
    pub body: u32,
    /// `true` if the proxy moves along the surface against friction.
    pub is_slipping: bool,
    /// `true` if the hand is lifted off the bodies, and passes through them.
    pub is_lifted: bool,
    /// Energy that the forces took from the hand and gave to it so far, and what the safety
    /// chain held back [J], at the device.
    pub energy: Energy,
    /// The tool coupled to the point; `None` for a contact point.
    pub tool: Option<HeldTool>,
    /// Evaluations of the shape for this point in this tick.
    pub evaluations: u32,
    /// The duration of the tick, for all points together [ns].
    pub cost_ns: u64,
    /// How late the tick started [ns]; zero in a run without pacing.
    pub lateness_ns: u64,
}

impl TraceRow {
    /// A contact point at `device` [m] that touches nothing at this time [s].
    #[must_use]
    pub fn free(time_s: f64, point: u32, device: Point<3>) -> Self {
        Self {
            time_s,
            point,
            device,
            proxy: device,
            wanted: Vector::ZERO,
            force: Vector::ZERO,
            normal: Vector::ZERO,
            contact: false,
            body: 0,
            is_slipping: false,
            is_lifted: false,
            energy: Energy::default(),
            tool: None,
            evaluations: 0,
            cost_ns: 0,
            lateness_ns: 0,
        }
    }
}

/// Times of a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TickTimes {
    pub(crate) time_s: f64,
    pub(crate) cost_ns: u64,
    pub(crate) lateness_ns: u64,
}

/// Keeps the rows of a run, up to a fixed number.
///
/// A run whose rows are more than memory holds goes to a [sink](super::RunOptions::sink);
/// those of a [`ServoThread`](super::ServoThread) are taken while it runs, as [`Records`].
#[derive(Clone, Debug)]
pub struct Recorder {
    rows: Vec<TraceRow>,
    capacity: usize,
    dropped: u64,
}

impl Recorder {
    /// A recorder with memory for `capacity` rows, one for each tick and contact point.
    #[must_use]
    pub fn new(capacity: usize) -> Self {
        Self { rows: Vec::with_capacity(capacity), capacity, dropped: 0 }
    }

    /// The rows of the run, in order of time, then of contact point.
    #[must_use]
    pub fn rows(&self) -> &[TraceRow] {
        &self.rows
    }

    /// The number of rows dropped because the recorder was full.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn keep(&mut self, row: TraceRow) {
        if self.rows.len() < self.capacity {
            self.rows.push(row);
        } else {
            self.dropped += 1;
        }
    }
}

/// The rows of contact points after a tick of `servo`, in their order.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
pub(crate) fn rows(times: TickTimes, servo: &Servo) -> impl Iterator<Item = TraceRow> {
    (0..).zip(servo.touches()).map(move |(point, touch)| TraceRow {
        proxy: touch.proxy,
        wanted: touch.wanted,
        force: touch.force,
        normal: touch.normal,
        contact: touch.contact,
        body: touch.body,
        is_slipping: touch.is_slipping,
        is_lifted: servo.is_lifted(),
        energy: servo.energy(point),
        tool: servo.held_tool(),
        evaluations: touch.evaluations,
        cost_ns: times.cost_ns,
        lateness_ns: times.lateness_ns,
        ..TraceRow::free(times.time_s, point, touch.device)
    })
}
