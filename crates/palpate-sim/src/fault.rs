// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What goes wrong between a device and a servo, and when.

use palpate_device::NumberError;

/// The most ticks by which readings may be delayed.
const MOST_DELAY: u32 = 10_000;

/// A fault of a [`SimulatedTransport`](crate::SimulatedTransport). Several may last at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// When it begins [s].
    pub start: f64,
    /// How long it lasts [s]; a loss lasts until the device is opened again.
    pub duration: f64,
    /// What goes wrong.
    pub kind: FaultKind,
}

/// What goes wrong between a device and a servo.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FaultKind {
    /// Times of measurements differ from those of the ticks by numbers drawn evenly from
    /// [−`most`, `most`], as far as measurements keep their order. Readings tell the true times.
    Jitter {
        /// The largest difference [s].
        most: f64,
    },
    /// Nothing new comes.
    Stale,
    /// The device has no state.
    NotReady,
    /// Readings come a number of ticks after they were made, with the time at which they were made.
    Delay {
        /// The number of ticks.
        ticks: u32,
    },
    /// Positions are displaced along the first axis.
    Glitch {
        /// The displacement [m].
        distance: f64,
    },
    /// The device is lost. [`Device::open`](palpate_device::Device::open) fails until it was called
    /// `attempts` times.
    Lost {
        /// The number of the attempt that succeeds, at least 1.
        attempts: u32,
    },
}

impl Fault {
    /// # Errors
    ///
    /// The number that breaks its rule.
    pub(crate) fn check(&self) -> Result<(), NumberError> {
        NumberError::check_not_negative("start of a fault", self.start, "s")?;
        NumberError::check_not_negative("duration of a fault", self.duration, "s")?;
        match self.kind {
            FaultKind::Jitter { most } => {
                NumberError::check_not_negative("jitter", most, "s")?;
            }
            FaultKind::Glitch { distance } => {
                NumberError::check_not_negative("size of a glitch", distance.abs(), "m")?;
            }
            FaultKind::Delay { ticks } if ticks > MOST_DELAY => {
                let (rule, value) = ("at most 10000 ticks", f64::from(ticks));
                return Err(NumberError::new("delay", rule, value, ""));
            }
            FaultKind::Lost { attempts: 0 } => {
                return Err(NumberError::new("attempts", "at least 1", 0.0, ""));
            }
            FaultKind::Stale
            | FaultKind::NotReady
            | FaultKind::Delay { .. }
            | FaultKind::Lost { .. } => {}
        }
        Ok(())
    }
}
