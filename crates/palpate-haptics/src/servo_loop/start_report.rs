// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contact points that are inside a body when a run begins.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::Servo;

/// Forces below this are not felt [N]: a hundredth of the weight of a gram.
const FELT: f64 = 1e-4;

/// A contact point that is inside a body in the first tick of a run.
///
/// A proxy follows from outside; of a point that begins inside, none is known. As soon as one is
/// found outside the body, the force rises from zero; until then, or until the point leaves, there
/// is none.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct StartInside {
    /// The number of the contact point, from 0.
    pub point: u32,
    /// The index of the body.
    pub body: u32,
    /// How deep the point itself, not its probe, is in the body [m]: `−f`, with the field f of the
    /// body.
    pub depth: f64,
    /// Ticks from the start without a force, as long as the point has not left the body.
    pub ticks_without_force: u64,
    /// The time of these ticks [s].
    pub time_without_force: f64,
    /// `true` if a force was felt before the point left: more than 0.1 mN.
    pub is_felt: bool,
    /// `true` if point and probe left the body during the run.
    pub has_left: bool,
}

/// The points that begin inside, in preallocated memory.
#[derive(Clone, Debug)]
pub(crate) struct StartTally {
    starts: Vec<Option<StartInside>>,
    has_begun: bool,
}

impl StartTally {
    pub(crate) fn new(points: usize) -> Self {
        Self { starts: vec![None; points], has_begun: false }
    }

    /// Counts a tick. A point that began inside costs an evaluation of the bodies about it in
    /// each tick until it has left.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic unless a custom field does.
    pub(crate) fn tick(&mut self, servo: &Servo) {
        let is_first = !std::mem::replace(&mut self.has_begun, true);
        let radius = if servo.tool().is_some() { 0.0 } else { servo.options().probe.radius() };
        for ((point, touch), start) in (0..).zip(servo.touches()).zip(&mut self.starts) {
            if is_first && touch.device.is_finite() {
                let (value, nearest) = servo.bodies().everything().nearest(touch.device);
                *start = (value < 0.0).then_some(StartInside {
                    point,
                    body: nearest,
                    depth: -value,
                    ticks_without_force: 0,
                    time_without_force: 0.0,
                    is_felt: false,
                    has_left: false,
                });
            }
            let Some(start) = start.as_mut().filter(|start| !start.has_left) else { continue };
            let value = |at| servo.bodies().everything().nearest(at).0;
            start.has_left = !touch.contact && value(touch.device) >= radius;
            if start.has_left {
                continue;
            }
            start.is_felt |= touch.force.norm() > FELT;
            start.ticks_without_force += u64::from(!start.is_felt);
        }
    }

    /// The points that began inside.
    pub(crate) fn reports(&self, rate: f64) -> Vec<StartInside> {
        let of = |start: &StartInside| StartInside {
            time_without_force: start.ticks_without_force as f64 / rate,
            ..*start
        };
        self.starts.iter().flatten().map(of).collect()
    }
}
