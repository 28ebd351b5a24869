// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Cells that are boxes, and how they move: with fewer operations than cells of any form.

use super::{AffineModel, NONE, UNIT};
use crate::vector::{array, unrolled};

/// Units by which a turned coordinate of a box may be off, as a share of the sum of its half
/// sides: three for each entry of the product of two rotations, eight for each half side that
/// is found again, one for their product, and two for the remainders of the sides that were
/// given; that twice.
const TURNED_UNITS: f64 = 28.0;

/// What moves boxes that are all turned alike by a rotation `M` into a body that is turned
/// by `R`.
#[derive(Clone, Copy, Debug)]
pub struct TurnedBoxes<const D: usize> {
    /// `Rᵀ·M`.
    product: [[f64; D]; D],
    /// `M`, its columns divided by their squares: half sides from the columns of `M·half`.
    sides: [[f64; D]; D],
}

impl<const D: usize> TurnedBoxes<D> {
    /// Given are the rows of the rotations of the boxes and of the body.
    #[inline(always)]
    pub(crate) fn new(turn: &[[f64; D]; D], rows: &[[f64; D]; D]) -> Self {
        let sum = |a: &[[f64; D]; D], i: usize, b: &[[f64; D]; D], k: usize| {
            let mut sum = NONE;
            unrolled!(j < D => sum += a[j][i] * b[j][k]);
            sum
        };
        let shares: [f64; D] = array!(k < D => 1.0 / sum(turn, k, turn, k));
        Self {
            product: std::array::from_fn(|i| array!(k < D => sum(rows, i, turn, k))),
            sides: std::array::from_fn(|i| array!(k < D => turn[i][k] * shares[k])),
        }
    }
}

impl<const N: usize> AffineModel<N> {
    /// The coordinates of the box with `half` side lengths, turned by the rotation of which
    /// `rows` are given about its `centre`.
    #[inline(always)]
    pub(crate) fn turned_cell<const D: usize>(
        centre: [f64; D],
        half: [f64; D],
        rows: &[[f64; D]; D],
    ) -> [Self; D] {
        array!(i < D => {
            let gradient = array!(k < N => if k < D { rows[i][k] * half[k] } else { 0.0 });
            let mut size = NONE;
            unrolled!(k < N => size += f64::abs(gradient[k]));
            let rounding = 2.0 * UNIT * size;
            Self { value: centre[i], gradient, lower: rounding, upper: rounding }
        })
    }

    /// `true` of coordinate `i` of a [`cell`](Self::cell).
    #[inline(always)]
    pub(crate) fn is_side(&self, i: usize) -> bool {
        let along_others = (0..N).filter(|k| *k != i).map(|k| self.gradient[k]);
        along_others.chain([self.lower, self.upper]).all(|part| part == 0.0)
    }

    /// `Rᵀ(p − t)` of the coordinates of a [`cell`](Self::cell), as
    /// [`weighted_sum`](crate::scalar::Scalar::weighted_sum) has it of any. Given are the
    /// rows of `R`.
    #[inline(always)]
    pub(crate) fn cell_to_body<const D: usize>(
        cell: [Self; D],
        translation: &[f64; D],
        rows: &[[f64; D]; D],
    ) -> [Self; D] {
        let centre = array!(k < D => cell[k].value - translation[k]);
        array!(i < D => {
            let gradient = array!(k < N => {
                if k < D { rows[k][i] * cell[k].gradient[k] } else { 0.0 }
            });
            let mut size = NONE;
            unrolled!(k < N => size += f64::abs(gradient[k]));
            Self::moved(i, &centre, rows, gradient, (D as f64 + 4.0) * size)
        })
    }

    /// The same of a [`turned_cell`](Self::turned_cell).
    #[inline(always)]
    pub(crate) fn turned_to_body<const D: usize>(
        cell: [Self; D],
        translation: &[f64; D],
        rows: &[[f64; D]; D],
        TurnedBoxes { product, sides }: &TurnedBoxes<D>,
    ) -> [Self; D] {
        let centre = array!(k < D => cell[k].value - translation[k]);
        let half: [f64; N] = array!(k < N => {
            let mut side = NONE;
            if k < D {
                unrolled!(i < D => side += sides[i][k] * cell[i].gradient[k]);
            }
            side
        });
        let mut size = NONE;
        unrolled!(k < N => size += f64::abs(half[k]));
        array!(i < D => {
            let gradient = array!(k < N => if k < D { product[i][k] * half[k] } else { 0.0 });
            Self::moved(i, &centre, rows, gradient, TURNED_UNITS * size)
        })
    }

    /// Coordinate `i` of `Rᵀ·centre` over a cell, where its sides are `gradient`, off by so
    /// many units.
    #[inline(always)]
    fn moved<const D: usize>(
        i: usize,
        centre: &[f64; D],
        rows: &[[f64; D]; D],
        gradient: [f64; N],
        units: f64,
    ) -> Self {
        let (mut value, mut size) = (NONE, NONE);
        unrolled!(k < D => {
            value += rows[k][i] * centre[k];
            size += f64::abs(rows[k][i]) * f64::abs(centre[k]);
        });
        let error = ((D as f64 + 4.0) * size + units) * UNIT;
        Self { value, gradient, lower: error, upper: error }
    }
}
