// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Tables in memory that belongs to others: rows of numbers with strides, as arrays have.

use crate::error::ShapeError;

/// Where the numbers of a table are in a slice: the number in row `i` and column `k` at
/// `start + i · row_stride + k · column_stride`. Strides count numbers, not bytes, and may
/// be negative or zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// The place of the first number of the first row.
    pub start: usize,
    /// How many rows there are: one for each point.
    pub rows: usize,
    /// From one row to the next.
    pub row_stride: isize,
    /// From one number of a row to the next.
    pub column_stride: isize,
}

impl Layout {
    /// Rows of `columns` numbers, one after the other.
    #[must_use]
    pub fn contiguous(rows: usize, columns: usize) -> Self {
        Self { start: 0, rows, row_stride: columns.cast_signed(), column_stride: 1 }
    }

    /// Checks that every number of `columns` columns is among `length` of them.
    fn check(&self, columns: usize, length: usize) -> Result<(), ShapeError> {
        let last = |count: usize, stride: isize| {
            i128::try_from(count.saturating_sub(1))
                .map(|last| last.saturating_mul(stride as i128))
        };
        let inside = || {
            let start = i128::try_from(self.start).ok()?;
            let row = last(self.rows, self.row_stride).ok()?;
            let column = last(columns, self.column_stride).ok()?;
            let least = start.saturating_add(row.min(0)).saturating_add(column.min(0));
            let most = start.saturating_add(row.max(0)).saturating_add(column.max(0));
            Some(least >= 0 && most < length as i128)
        };
        if self.rows == 0 || inside() == Some(true) {
            return Ok(());
        }
        let rule = format!("every number of {} rows of {columns}", self.rows).into();
        Err(ShapeError::Count { parameter: "array".into(), rule, count: length })
    }

    /// The place of a number that [`check`](Self::check) found inside.
    #[inline(always)]
    fn place(&self, row: usize, column: usize) -> usize {
        let offset = row.cast_signed().wrapping_mul(self.row_stride);
        let offset = offset.wrapping_add(column.cast_signed().wrapping_mul(self.column_stride));
        self.start.wrapping_add_signed(offset)
    }
}

/// Rows of `N` numbers to read.
#[derive(Clone, Copy, Debug)]
pub struct Strided<'a, T, const N: usize> {
    data: &'a [T],
    layout: Layout,
}

impl<'a, T: Copy, const N: usize> Strided<'a, T, N> {
    /// The rows that `layout` finds in `data`.
    ///
    /// # Errors
    ///
    /// If a number is outside `data`.
    pub fn new(data: &'a [T], layout: Layout) -> Result<Self, ShapeError> {
        layout.check(N, data.len())?;
        Ok(Self { data, layout })
    }

    /// How many rows there are.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.layout.rows
    }

    /// A row.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, row: usize) -> [T; N] {
        assert!(row < self.layout.rows, "row {row} of {}", self.layout.rows);
        std::array::from_fn(|column| self.data[self.layout.place(row, column)])
    }
}

/// Rows of `N` numbers to write.
#[derive(Debug)]
pub struct StridedMut<'a, T, const N: usize> {
    data: &'a mut [T],
    layout: Layout,
}

impl<'a, T: Copy, const N: usize> StridedMut<'a, T, N> {
    /// The rows that `layout` finds in `data`.
    ///
    /// # Errors
    ///
    /// If a number is outside `data`.
    pub fn new(data: &'a mut [T], layout: Layout) -> Result<Self, ShapeError> {
        layout.check(N, data.len())?;
        Ok(Self { data, layout })
    }

    /// How many rows there are.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.layout.rows
    }

    /// Writes a row.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    #[inline(always)]
    pub fn set_row(&mut self, row: usize, numbers: [T; N]) {
        assert!(row < self.layout.rows, "row {row} of {}", self.layout.rows);
        for (column, number) in numbers.into_iter().enumerate() {
            self.data[self.layout.place(row, column)] = number;
        }
    }
}
