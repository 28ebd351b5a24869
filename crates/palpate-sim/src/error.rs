// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Errors and faults.

use palpate_device::{DeviceError, NumberError};

/// Why a hand path, a tour, a hand or a device is refused. Every variant carries the offending
/// numbers.
///
/// ```
/// use palpate_sim::{HandPath, Interpolation, SimulationError};
///
/// let alone = HandPath::new(vec![0.0], vec![[0.0; 3].into()], Interpolation::Linear);
/// assert_eq!(alone, Err(SimulationError::TooFewSamples { count: 1 }));
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A number breaks the rule of its parameter.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// A device has no contact point, or not one item for each.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A hand path needs a beginning and an end.
    #[error("a hand path needs at least 2 samples, got {count}")]
    TooFewSamples {
        /// The number of samples.
        count: usize,
    },
    /// A hand path has not as many times as positions.
    #[error("a hand path has {times} times but {positions} positions")]
    UnpairedSamples {
        /// The number of times.
        times: usize,
        /// The number of positions.
        positions: usize,
    },
    /// A time or coordinate of a hand path is not finite or exceeds 1e15.
    #[error(
        "sample {index} of the hand path must be finite and at most 1e15 in size, got {value}"
    )]
    SampleNotFinite {
        /// The index of the sample, from 0.
        index: usize,
        /// The time [s] or coordinate [m].
        value: f64,
    },
    /// The times of a hand path do not increase.
    #[error(
        "sample {index} of the hand path is at {time} s, which must be later than {previous} s"
    )]
    TimeNotIncreasing {
        /// The index of the sample, from 0.
        index: usize,
        /// The time of the sample before [s].
        previous: f64,
        /// The time of the sample [s].
        time: f64,
    },
    /// The box of a tour contains no surface.
    #[error("no surface was found in the box of a hand path over a shape")]
    NothingToTouch,
    /// No body of a scene has bounds.
    #[error("the scene must have a body with bounds")]
    NoBounds,
    /// A hand swings a tool for no time, or too long.
    #[error("a hand swings a tool for more than 0 s and at most {longest} s, got {duration} s")]
    SwingDuration {
        /// The longest duration [s].
        longest: f64,
        /// The duration given [s].
        duration: f64,
    },
    /// A coordinate of a hand's target is not finite.
    #[error("target {index} must be finite, got {value} m")]
    TargetNotFinite {
        /// The index of the target, from 0.
        index: usize,
        /// The coordinate [m].
        value: f64,
    },
}

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
