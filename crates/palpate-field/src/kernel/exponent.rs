// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The exponent of the norm in which a shape is measured: a parameter of the kernel, the
//! same for every lane.

use crate::error::{ShapeError, Unit};
use crate::promise::Promise;
use crate::scalar::Scalar;

/// The exponent of a norm other than the Euclidean.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Exponent {
    Four,
    Six,
    Eight,
}

impl Exponent {
    /// The norm with this `exponent`.
    pub(crate) fn new(parameter: &'static str, exponent: u32) -> Result<Self, ShapeError> {
        Self::named(exponent).ok_or_else(|| refused(parameter, "4, 6 or 8", exponent))
    }

    /// As [`new`](Self::new), `None` for the Euclidean norm.
    pub(crate) fn or_euclidean(
        parameter: &'static str,
        exponent: u32,
    ) -> Result<Option<Self>, ShapeError> {
        match Self::named(exponent) {
            None if exponent != 2 => Err(refused(parameter, "2, 4, 6 or 8", exponent)),
            other => Ok(other),
        }
    }

    /// The exponent as a number.
    pub(crate) fn number(self) -> u32 {
        match self {
            Self::Four => 4,
            Self::Six => 6,
            Self::Eight => 8,
        }
    }

    fn named(exponent: u32) -> Option<Self> {
        match exponent {
            4 => Some(Self::Four),
            6 => Some(Self::Six),
            8 => Some(Self::Eight),
            _ => None,
        }
    }

    /// `(Σ|xᵢ|^P)^(1/P)`.
    #[inline(always)]
    pub(crate) fn norm<S: Scalar, const N: usize>(self, x: [S; N]) -> S {
        match self {
            Self::Four => S::power_norm::<4, N>(x),
            Self::Six => S::power_norm::<6, N>(x),
            Self::Eight => S::power_norm::<8, N>(x),
        }
    }

    /// `‖max(q, 0)‖_P + min(max qᵢ, 0)`.
    #[inline(always)]
    pub(crate) fn orthant<S: Scalar, const N: usize>(self, q: [S; N]) -> S {
        match self {
            Self::Four => S::power_orthant::<4, N>(q),
            Self::Six => S::power_orthant::<6, N>(q),
            Self::Eight => S::power_orthant::<8, N>(q),
        }
    }

    /// The reach of a unit ball in this norm along its diagonals: `N^(1/2 − 1/P)`, rounded up.
    pub(crate) fn reach<const N: usize>(self) -> f64 {
        (N as f64).sqrt() / self.norm([1.0; N]) * (1.0 + 8.0 * f64::EPSILON)
    }
}

fn refused(parameter: &'static str, rule: &'static str, exponent: u32) -> ShapeError {
    ShapeError::number(parameter, rule, f64::from(exponent), Unit::One)
}

/// The promise of an `exact` field whose norm is replaced by one of these.
///
/// The norm is at most the Euclidean, so the field has no slope above one and its values
/// are bounds on both sides. Far from the shape they may be less than the distance to its
/// box.
pub(crate) fn in_another_norm<const D: usize>(exact: Promise<D>) -> Promise<D> {
    Promise { above_bounds: false, ..exact.bound() }
}
