// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The errors of rendered pictures.

use palpate_field::ShapeError;
use palpate_query::QueryError;

use crate::settings::{MOST_PIXELS, MOST_SAMPLES};

/// Why a picture cannot be rendered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// There is nothing to draw.
    #[error("a picture must show at least 1 body, got 0")]
    NoBody,
    /// A number breaks its rule.
    #[error("{what} must be {rule}, got {value:?}{unit}")]
    Number {
        /// What the number was for.
        what: &'static str,
        /// The rule.
        rule: &'static str,
        /// The number.
        value: f64,
        /// A space and the symbol of the unit; empty for a plain number.
        unit: &'static str,
    },
    /// A camera that looks from a point at the same point.
    #[error("a camera must look at another point than its own, got {at:?} m for both")]
    NoSight {
        /// The point [m].
        at: [f64; 3],
    },
    /// A direction that has no length, or two that lie on one line.
    #[error("{what} must have a direction, got {got:?}")]
    NoPlane {
        /// What the direction was for.
        what: &'static str,
        /// The direction.
        got: [f64; 3],
    },
    /// A camera within a body, which sees nothing else.
    #[error("the camera at {from:?} m is inside body {body}: move it out")]
    Inside {
        /// The number of the body.
        body: usize,
        /// Where the camera is [m].
        from: [f64; 3],
    },
    /// A picture without pixels, or with too many.
    #[error("a picture must have 1 to {MOST_PIXELS} pixels, got {width} x {height}")]
    Size {
        /// The width [pixels].
        width: u32,
        /// The height [pixels].
        height: u32,
    },
    /// Too few or too many samples.
    #[error(
        "an edge must have 1 to {MOST_SAMPLES} samples along a pixel's side, got {samples}"
    )]
    Samples {
        /// The number that was asked for.
        samples: u32,
    },
    /// An animation without pictures.
    #[error("an animation must have at least 1 picture, got 0")]
    NoPicture,
    /// Pictures of an animation that differ in size.
    #[error(
        "the pictures of an animation must be alike in size, got {} x {} and {} x {} pixels",
        first[0], first[1], other[0], other[1]
    )]
    OtherSize {
        /// The size of the first [pixels].
        first: [u32; 2],
        /// The size of another [pixels].
        other: [u32; 2],
    },
    /// A body cannot be cut or thickened.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A point or length cannot be computed with.
    #[error(transparent)]
    Query(#[from] QueryError),
    /// A picture cannot be written as PNG.
    #[error("the picture cannot be written as PNG: {reason}")]
    Png {
        /// What the encoder said.
        reason: String,
    },
}

impl RenderError {
    /// Refuses a number that is not more than zero, or too large to compute with.
    pub(crate) fn check_positive(
        what: &'static str,
        value: f64,
        unit: &'static str,
    ) -> Result<f64, Self> {
        let rule = "positive and at most 1e15";
        // Written so that NaN is refused.
        if value > 0.0 && value <= palpate_field::LARGEST_LENGTH {
            Ok(value)
        } else {
            Err(Self::Number { what, rule, value, unit })
        }
    }
}
