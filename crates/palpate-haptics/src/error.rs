// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Errors of materials, hand paths, tools and servos.

use std::convert::Infallible;

use palpate_safety::{NumberError, SafetyError};

/// Why a material, hand path, tool or servo is refused. Every variant carries the offending
/// numbers.
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
    /// There must be at least one contact point, or one actuator or channel in its place.
    #[error("there must be at least one contact point, actuator or channel")]
    NoContactPoint,
    /// The servo and the device disagree about the number of contact points.
    #[error("the servo has {servo} contact points, the device {device}")]
    ContactPoints {
        /// Contact points of the servo.
        servo: usize,
        /// Contact points of the device.
        device: usize,
    },
    /// Not one item for each contact point.
    #[error("{points} contact points need as many {items}, got {given}")]
    OneForEach {
        /// What is given.
        items: &'static str,
        /// How many there are.
        given: usize,
        /// The number of contact points.
        points: usize,
    },
    /// The list of bodies is empty.
    #[error("there must be at least one body to touch")]
    NoBody,
    /// No body has this index.
    #[error("there is no body {body}; there are {bodies}, counted from 0")]
    NoSuchBody {
        /// The index that was asked for.
        body: usize,
        /// The number of bodies.
        bodies: usize,
    },
    /// A hand-off has fewer places than there are bodies.
    #[error("the hand-off has room for {most} bodies, got {bodies}")]
    TooManyBodies {
        /// The number of bodies.
        bodies: usize,
        /// The capacity.
        most: usize,
    },
    /// Bodies were accepted for another servo.
    #[error("the bodies were accepted for another servo, whose device may render more")]
    OtherServo,
    /// A thread for the servo could not be started.
    #[error("the servo's thread did not start: {reason}")]
    ThreadNotStarted {
        /// The error of the operating system.
        reason: String,
    },
    /// A number of a pose is not finite or exceeds 1e15.
    #[error("the numbers of a pose must be finite and at most 1e15 in size")]
    Pose,
    /// A shape cannot carry the texture of a surface.
    #[error(transparent)]
    Shape(#[from] palpate_field::ShapeError),
    /// A guide must have exactly one target.
    #[error("a guide needs one target, got {count}")]
    GuideTargets {
        /// The number of targets.
        count: usize,
    },
    /// A curve needs two different points.
    #[error("a curve needs at least 2 different points, got {count}")]
    NoCurve {
        /// The number of different points, one or none.
        count: usize,
    },
    /// The shape of a tool has no bounded surface.
    #[error("a tool needs a bounded surface, and none was found")]
    NothingToTouchWith,
    /// The box of a tour contains no surface.
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
