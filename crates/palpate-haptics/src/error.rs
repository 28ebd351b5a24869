// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Errors of materials, hand paths, tools and servos.

use std::convert::Infallible;

/// Why a material, hand path, tool or servo is refused. Every variant carries the offending
/// numbers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HapticsError {
    /// A number breaks the rule of its parameter.
    #[error("{parameter} must be {rule}, got {value} {unit}")]
    Number {
        /// The parameter's name, as in scene files.
        parameter: &'static str,
        /// The rule: "positive".
        rule: &'static str,
        /// The value that was given, in `unit`.
        value: f64,
        /// The unit of the parameter: "N/m".
        unit: &'static str,
    },
    /// A device cannot render a material, and [`Acceptance`](crate::Acceptance) forbids a
    /// softer one.
    #[error(
        "a stiffness of {stiffness} N/m and a damping of {damping} N·s/m at the device break \
         {condition}; {factor} times both would not"
    )]
    MaterialRefused {
        /// Stiffness at the device [N/m].
        stiffness: f64,
        /// Damping at the device [N·s/m].
        damping: f64,
        /// The rule that is broken: "K ≤ 2 (b − |B|) / T".
        condition: &'static str,
        /// The factor by which both would have to be multiplied.
        factor: f64,
    },
    /// A device cannot render a tool's angular coupling, and [`Acceptance`](crate::Acceptance)
    /// forbids a softer one.
    #[error(
        "an angular stiffness of {stiffness} N·m/rad and an angular damping of {damping} \
         N·m·s/rad at the device break {condition}; {factor} times both would not"
    )]
    TurningRefused {
        /// Angular stiffness at the device [N·m/rad].
        stiffness: f64,
        /// Angular damping at the device [N·m·s/rad].
        damping: f64,
        /// The rule that is broken: "κ ≤ 2 (b − |β|) / T".
        condition: &'static str,
        /// The factor by which both would have to be multiplied.
        factor: f64,
    },
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
    #[error("sample {index} of the hand path must be finite and at most 1e15, got {value}")]
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
    /// A device has tighter limits than the device that the servo was made for.
    #[error(
        "the servo was made for a device with a {limit} of {servo} {unit}, but this device has \
         {device} {unit}: make the servo for this device"
    )]
    OtherDevice {
        /// The name of the limit: "max_force".
        limit: &'static str,
        /// The limit that the servo was made for, in `unit`.
        servo: f64,
        /// The limit of the device, in `unit`.
        device: f64,
        /// The unit of the limit: "N".
        unit: &'static str,
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
    /// A thread for the servo could not be started.
    #[error("the servo's thread did not start: {reason}")]
    ThreadNotStarted {
        /// The error of the operating system.
        reason: String,
    },
    /// A number of a pose is not finite or exceeds 1e15.
    #[error("the numbers of a pose must be finite and at most 1e15")]
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
    /// The shape of a tool has no bounded surface.
    #[error("a tool needs a bounded surface, and none was found")]
    NothingToTouchWith,
    /// The box of a tour contains no surface.
    #[error("no surface was found in the box of a hand path over a shape")]
    NothingToTouch,
}

impl From<Infallible> for HapticsError {
    fn from(never: Infallible) -> Self {
        match never {}
    }
}

/// Checks that `value` is positive and finite.
///
/// # Errors
///
/// [`HapticsError::Number`] with the name and the unit given, also for NaN.
pub fn positive(
    parameter: &'static str,
    value: f64,
    unit: &'static str,
) -> Result<f64, HapticsError> {
    // Written so that NaN fails.
    if value > 0.0 && value <= f64::MAX {
        Ok(value)
    } else {
        let rule = "positive and finite";
        Err(HapticsError::Number { parameter, rule, value, unit })
    }
}

/// Checks that `value` is zero or more, and finite.
///
/// # Errors
///
/// As [`positive`].
pub fn not_negative(
    parameter: &'static str,
    value: f64,
    unit: &'static str,
) -> Result<f64, HapticsError> {
    if (0.0..=f64::MAX).contains(&value) {
        Ok(value)
    } else {
        let rule = "zero or more and finite";
        Err(HapticsError::Number { parameter, rule, value, unit })
    }
}

/// Checks that `value` is positive; it may be infinite.
pub(crate) fn positive_or_infinite(
    parameter: &'static str,
    value: f64,
    unit: &'static str,
) -> Result<f64, HapticsError> {
    // Written so that NaN fails.
    if value > 0.0 {
        Ok(value)
    } else {
        let rule = "positive";
        Err(HapticsError::Number { parameter, rule, value, unit })
    }
}
