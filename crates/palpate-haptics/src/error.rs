// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What can be wrong with a material, a hand path or a servo.

use std::convert::Infallible;

use palpate_safety::{NumberError, SafetyError};

/// Why something cannot be touched as asked. Every variant carries the offending numbers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HapticsError {
    /// A number breaks the rule of its parameter.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// A device cannot be protected as asked.
    #[error(transparent)]
    Safety(SafetyError),
    /// A hand path needs a beginning and an end.
    #[error("a hand path needs at least 2 samples, got {count}")]
    TooFewSamples {
        /// How many there were.
        count: usize,
    },
    /// The times of a hand path and its positions are not pairs.
    #[error("a hand path has {times} times but {positions} positions")]
    UnpairedSamples {
        /// How many times.
        times: usize,
        /// How many positions.
        positions: usize,
    },
    /// A time or coordinate of a hand path is NaN, infinite or beyond any scene.
    #[error("sample {index} of the hand path must be finite and at most 1e15, got {value}")]
    SampleNotFinite {
        /// Which sample, from 0.
        index: usize,
        /// The time [s] or coordinate [m].
        value: f64,
    },
    /// The times of a hand path do not increase.
    #[error(
        "sample {index} of the hand path is at {time} s, which must be later than {previous} s"
    )]
    TimeNotIncreasing {
        /// Which sample, from 0.
        index: usize,
        /// The time of the sample before [s].
        previous: f64,
        /// The time of the sample [s].
        time: f64,
    },
    /// A device must have at least one contact point.
    #[error("a device needs at least one contact point")]
    NoContactPoint,
    /// The servo and the device disagree about the number of contact points.
    #[error("the servo has {servo} contact points, the device {device}")]
    ContactPoints {
        /// Contact points of the servo.
        servo: usize,
        /// Contact points of the device.
        device: usize,
    },
    /// There is nothing to touch.
    #[error("there must be at least one body to touch")]
    NoBody,
    /// There is no body of that number.
    #[error("there is no body {body}; there are {bodies}, counted from 0")]
    NoSuchBody {
        /// The number asked for.
        body: usize,
        /// How many bodies there are.
        bodies: usize,
    },
    /// A hand-off has no room for so many bodies.
    #[error("the hand-off has room for {most} bodies, got {bodies}")]
    TooManyBodies {
        /// How many bodies there are.
        bodies: usize,
        /// How many it has room for.
        most: usize,
    },
    /// A thread for the servo could not be started.
    #[error("the servo's thread did not start: {reason}")]
    ThreadNotStarted {
        /// What the system said.
        reason: String,
    },
    /// A pose has numbers that are not finite or beyond any scene.
    #[error("the numbers of a pose must be finite and at most 1e15")]
    Pose,
    /// A shape cannot be what a surface asks for.
    #[error(transparent)]
    Shape(#[from] palpate_field::ShapeError),
    /// A guide leads to one target.
    #[error("a guide needs one target, got {count}")]
    GuideTargets {
        /// How many it has.
        count: usize,
    },
    /// A tool has no surface to sample.
    #[error("a tool needs a bounded surface, and none was found")]
    NothingToTouchWith,
    /// A tour finds nothing to touch in its box.
    #[error("no surface was found in the box of a hand path over a shape")]
    NothingToTouch,
}

impl From<SafetyError> for HapticsError {
    fn from(error: SafetyError) -> Self {
        match error {
            SafetyError::Number(number) => Self::Number(number),
            error => Self::Safety(error),
        }
    }
}

impl From<Infallible> for HapticsError {
    fn from(never: Infallible) -> Self {
        match never {}
    }
}
