// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contact points that are inside a body when a run begins.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_haptics::Servo;

/// Forces below this are not felt [N]: a hundredth of the weight of a paper clip's gram.
const FELT: f64 = 1e-4;

/// A contact point that is inside a body in the first tick of a run.
///
/// A proxy comes from outside, so a point that begins inside has none that it followed: its force
/// rises from zero, and what it would give to the hand, the passivity controller holds back, since
/// the hand has pressed nothing in.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct StartInside {
    /// The number of the contact point, from 0.
    pub point: u32,
    /// The index of the body.
    pub body: u32,
    /// How deep the point is below the surface offset by the probe's radius [m]: `r − f`.
    pub depth: f64,
    /// Ticks from the start without a force that is felt, as long as the point has not left the
    /// body.
    pub ticks_without_force: u64,
    /// The time of these ticks [s].
    pub time_without_force: f64,
    /// `true` if the point left the body during the run.
    pub has_left: bool,
}

/// The points that begin inside, in preallocated memory.
#[derive(Clone, Debug)]
pub(crate) struct StartTally {
    starts: Vec<Option<Start>>,
    has_begun: bool,
}

#[derive(Clone, Copy, Debug)]
struct Start {
    report: StartInside,
    /// `true` once a force was felt.
    is_felt: bool,
}

impl StartTally {
    pub(crate) fn new(points: usize) -> Self {
        Self { starts: vec![None; points], has_begun: false }
    }

    /// Counts a tick.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn tick<const D: usize>(&mut self, servo: &Servo<D>) {
        let is_first = !std::mem::replace(&mut self.has_begun, true);
        let radius = if servo.tool().is_some() { 0.0 } else { servo.options().probe.radius() };
        for ((point, touch), start) in (0..).zip(servo.touches()).zip(&mut self.starts) {
            if is_first && touch.device.is_finite() {
                let (value, body) = servo.bodies().everything().nearest(touch.device);
                let is_inside = touch.contact || value < 0.0;
                let (depth, body) = match touch.contact {
                    true => (touch.depth(), touch.body),
                    false => (radius - value, body),
                };
                let report = StartInside {
                    point,
                    body,
                    depth,
                    ticks_without_force: 0,
                    time_without_force: 0.0,
                    has_left: false,
                };
                *start = is_inside.then_some(Start { report, is_felt: false });
            }
            let Some(start) = start.as_mut().filter(|start| !start.report.has_left) else {
                continue;
            };
            let is_out = || servo.bodies().everything().nearest(touch.device).0 >= radius;
            start.report.has_left = !touch.contact && is_out();
            start.is_felt |= touch.force.norm() > FELT;
            let is_without = !start.report.has_left && !start.is_felt;
            start.report.ticks_without_force += u64::from(is_without);
        }
    }

    /// The points that began inside.
    pub(crate) fn reports(&self, rate: f64) -> Vec<StartInside> {
        let of = |start: &Start| StartInside {
            time_without_force: start.report.ticks_without_force as f64 / rate,
            ..start.report
        };
        self.starts.iter().flatten().map(of).collect()
    }
}
