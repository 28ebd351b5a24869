// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a grid is asked for.

use palpate_field::{LARGEST_LENGTH, Quantity, SMALLEST_LENGTH, ShapeError, Unit};

use crate::error::GridError;
use crate::samples::Store;
use crate::spline::GridKernel;

/// How fine a grid is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// The size of a cell [m].
    Cell(f64),
    /// The largest difference from the source's values near the surface [m]: cells are made small enough.
    Tolerance(f64),
}

/// What a grid is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct GridOptions {
    /// How fine it is.
    pub resolution: Resolution,
    /// How samples are interpolated.
    pub kernel: GridKernel,
    /// How samples are stored.
    pub store: Store,
    /// `None` keeps every sample. With `Some`, values are clamped to so many cells on both sides of the surface,
    /// and only bricks of samples with smaller ones are stored: a seventh of the memory at 256 cells along each
    /// axis. Beyond the band a coarser lattice gives values that are smaller than the distance.
    pub band: Option<f64>,
    /// Without a band, values up to so many cells are compared with the source. A smooth union whose fill reaches as far
    /// as r from the surfaces needs r / cell.
    pub certified: f64,
    /// More nodes than these are refused.
    pub most_nodes: usize,
}

impl GridOptions {
    /// The smallest band: within less, values take clamped samples, and nothing would be certified.
    pub const SMALLEST_BAND: f64 = 4.5;

    /// Quadratic splines of samples in single precision, all of them, with cells of a size [m].
    #[must_use]
    pub const fn with_cell(cell: f64) -> Self {
        Self::with_resolution(Resolution::Cell(cell))
    }

    /// The same, with cells as small as a deviation takes [m].
    #[must_use]
    pub const fn with_tolerance(tolerance: f64) -> Self {
        Self::with_resolution(Resolution::Tolerance(tolerance))
    }

    /// The same, with either.
    #[must_use]
    pub const fn with_resolution(resolution: Resolution) -> Self {
        Self {
            resolution,
            kernel: GridKernel::Quadratic,
            store: Store::F32,
            band: None,
            certified: 1.0,
            most_nodes: 1 << 26,
        }
    }

    /// The same with a band, if there is none: wider than what is certified by half the diagonal of three cells for
    /// the samples that a value takes, by half that of one for its deviation, and by some room; for a source in `D`
    /// dimensions with a Lipschitz constant.
    pub(crate) fn with_narrow_band<const D: usize>(&self, lipschitz: f64) -> Self {
        let narrow = self.certified + 2.1 * (D as f64).sqrt() * lipschitz.max(1.0);
        Self { band: self.band.or(Some(narrow)), ..self.clone() }
    }

    pub(crate) fn check(&self) -> Result<(), GridError> {
        let (name, size) = match self.resolution {
            Resolution::Cell(cell) => ("cell", cell),
            Resolution::Tolerance(tolerance) => ("tolerance", tolerance),
        };
        let wrong = |parameter: &'static str, rule: &'static str, value: f64, unit: Unit| {
            Err(GridError::Number(ShapeError::Number {
                parameter: parameter.into(),
                rule: rule.into(),
                value: Quantity(value, unit),
            }))
        };
        if !(SMALLEST_LENGTH..=LARGEST_LENGTH).contains(&size) {
            return wrong(name, "from 1e-15 to 1e15 m", size, Unit::Metre);
        }
        if let Some(band) = self.band.filter(|band| !(Self::SMALLEST_BAND..=1e6).contains(band))
        {
            return wrong("band", "from 4.5 to 1e6 cells", band, Unit::One);
        }
        if !(0.0..=1e6).contains(&self.certified) {
            return wrong("certified", "from 0 to 1e6 cells", self.certified, Unit::One);
        }
        Ok(())
    }
}
