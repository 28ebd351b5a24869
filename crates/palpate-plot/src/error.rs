// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The errors of figures.

use crate::slice::{MAX_ASPECT, MAX_SIZE, MIN_SIZE};

/// Why a figure cannot be made. Every variant carries the offending numbers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// A coordinate given to a plane, a window or an overlay is NaN or infinite.
    #[error("{what} must be finite, got {value}")]
    NotFinite {
        /// What the number was for.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// The two directions of a free plane are parallel, or one of them is zero.
    #[error("the directions of a plane must not be parallel or zero, got {u:?} and {v:?}")]
    DegeneratePlane {
        /// First direction, as given.
        u: [f64; 3],
        /// Second direction, as given.
        v: [f64; 3],
    },
    /// The width or height of a window is not a positive length a picture can show.
    #[error("view {side} must be between {MIN_SIZE:e} m and {MAX_SIZE:e} m, got {size} m")]
    ViewSize {
        /// `"width"` or `"height"`.
        side: &'static str,
        /// The size \[m\].
        size: f64,
    },
    /// The window is a sliver.
    #[error(
        "view of {width} m by {height} m is too narrow: the sides may differ {MAX_ASPECT} times"
    )]
    ViewAspect {
        /// Width \[m\].
        width: f64,
        /// Height \[m\].
        height: f64,
    },
    /// The window is so far from the origin that its points cannot be told apart.
    #[error(
        "view of {size} m around {center:?} m is too far from the origin for 64-bit numbers"
    )]
    ViewFar {
        /// Centre, in plane coordinates \[m\].
        center: [f64; 2],
        /// The shorter side \[m\].
        size: f64,
    },
    /// The number of cells of the sampling grid is out of range.
    #[error("a picture is sampled with {min} to {max} cells a side, got {cells}")]
    Cells {
        /// The number asked for.
        cells: usize,
        /// Fewest cells.
        min: usize,
        /// Most cells.
        max: usize,
    },
    /// The field gave a value that is NaN, infinite, or beyond any length.
    #[error("the field is {value} at ({s}, {t}) m of the plane; it must be finite", s = at[0], t = at[1])]
    Sample {
        /// Plane coordinates of the sample \[m\].
        at: [f64; 2],
        /// The value \[m\].
        value: f64,
    },
    /// The field gave a gradient that is NaN, infinite, or beyond any number.
    #[error("the gradient is {gradient:?} at ({s}, {t}) m of the plane; it must be finite", s = at[0], t = at[1])]
    Gradient {
        /// Plane coordinates of the sample \[m\].
        at: [f64; 2],
        /// Its parts to the right, up, and towards the viewer.
        gradient: [f64; 3],
    },
    /// There are more or fewer comparisons than places in the picture.
    #[error("the picture compares values at {expected} places, got {count}")]
    Comparisons {
        /// The comparisons given.
        count: usize,
        /// The places.
        expected: usize,
    },
    /// The ends of a scale of decades are no interval of positive numbers.
    #[error(
        "the ends of a scale of decades must be positive, the lower one first, got {low} and {high}"
    )]
    Scale {
        /// The lower end, in the unit of the scale.
        low: f64,
        /// The upper end.
        high: f64,
    },
    /// The distance between isolines is not a positive number.
    #[error("the step between isolines must be positive, got {step} m")]
    Step {
        /// The step \[m\].
        step: f64,
    },
    /// The step is so fine that the isolines would merge.
    #[error("a step of {step} m draws {count} isolines; at most {max} can be told apart")]
    TooManyLevels {
        /// The step \[m\].
        step: f64,
        /// Isolines it would draw.
        count: f64,
        /// Most isolines.
        max: usize,
    },
    /// A point of an overlay or a chart is NaN or infinite.
    #[error("point {index} of \"{name}\" must be finite, got ({x}, {y})", x = point[0], y = point[1])]
    Point {
        /// Name of the overlay or series.
        name: String,
        /// Which point, from 0.
        index: usize,
        /// The point.
        point: [f64; 2],
    },
    /// The width of the picture is out of range, or makes the picture too high.
    #[error(
        "a picture {width} px wide would be {height:.0} px high; \
         the width must be at least {min} px and neither side above {max} px"
    )]
    PictureSize {
        /// Width asked for \[px\].
        width: u32,
        /// The height that follows \[px\].
        height: f64,
        /// Smallest width \[px\].
        min: u32,
        /// Largest width and height \[px\].
        max: u32,
    },
    /// The picture could not be written as PNG.
    #[error("the picture could not be written as PNG: {reason}")]
    Png {
        /// What the encoder said.
        reason: String,
    },
}

impl PlotError {
    /// Refuses the value of a field at a point of the plane if it is not a length.
    pub(crate) fn check_sample(at: [f64; 2], value: f64) -> Result<(), Self> {
        let is_length = value.abs() <= LARGEST;
        if is_length { Ok(()) } else { Err(Self::Sample { at, value }) }
    }
}

/// `value`, or an error that names `what` it was for.
pub(crate) fn finite(what: &'static str, value: f64) -> Result<f64, PlotError> {
    if value.is_finite() { Ok(value) } else { Err(PlotError::NotFinite { what, value }) }
}

/// Checks the points of an overlay or series called `name`.
pub(crate) fn finite_points(name: &str, points: &[[f64; 2]]) -> Result<(), PlotError> {
    match points.iter().position(|p| !is_drawable(p)) {
        None => Ok(()),
        Some(index) => {
            Err(PlotError::Point { name: name.to_owned(), index, point: points[index] })
        }
    }
}

/// Finite, and small enough that differences and products stay finite.
fn is_drawable(point: &[f64; 2]) -> bool {
    point.iter().all(|x| x.abs() <= LARGEST)
}

/// The largest value drawn. Its square is finite, so lengths and spans are too.
pub(crate) const LARGEST: f64 = 1e150;
