// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Errors of hand paths, tours and simulated devices.

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
