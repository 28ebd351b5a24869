// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Many points at once: their samples are gathered one after another, and interpolated side by side.

use palpate_field::{Point, Vector, Wide, wide};

use crate::control::MOST_TAPS;
use crate::grid::Grid;
use crate::samples::{Code, Codes, Window, row_place};
use crate::spline::{Kernel, OfTaps, QUADRATIC, Spline, TRILINEAR, value, value_slope};

/// Points that are interpolated together.
const TOGETHER: usize = 16;

impl<const D: usize> Grid<D> {
    /// The values at points [m].
    pub(crate) fn values_at(&self, points: &[Point<D>], values: &mut [f64]) {
        let groups = points.chunks(TOGETHER).zip(values.chunks_mut(TOGETHER));
        for (points, values) in groups {
            match self.kernel() {
                Kernel::Quadratic => {
                    wide(Values::<QUADRATIC, D> { grid: self, points, values })
                }
                Kernel::Trilinear => {
                    wide(Values::<TRILINEAR, D> { grid: self, points, values })
                }
            }
        }
    }

    /// The values at points [m] and their gradients.
    pub(crate) fn all_at(
        &self,
        points: &[Point<D>],
        values: &mut [f64],
        slopes: &mut [Vector<f64, D>],
    ) {
        let groups = values.chunks_mut(TOGETHER).zip(slopes.chunks_mut(TOGETHER));
        for (points, (values, slopes)) in points.chunks(TOGETHER).zip(groups) {
            match self.kernel() {
                Kernel::Quadratic => {
                    wide(Slopes::<QUADRATIC, D> { grid: self, points, values, slopes });
                }
                Kernel::Trilinear => {
                    wide(Slopes::<TRILINEAR, D> { grid: self, points, values, slopes });
                }
            }
        }
    }
}

/// The samples of the cells of points, and where in them these lie. A point that has none, outside the
/// lattice or far from the surface, has some that are not used.
struct Gathered<const K: usize, const D: usize> {
    taps: [[f64; TOGETHER]; MOST_TAPS],
    local: [[f64; TOGETHER]; D],
    are_known: [bool; TOGETHER],
}

impl<const K: usize, const D: usize> Gathered<K, D> {
    #[inline(always)]
    fn of(grid: &Grid<D>, points: &[Point<D>]) -> Self {
        let mut places = [0; TOGETHER];
        let mut ways = [0; D];
        let mut gathered = Self {
            taps: [[0.0; TOGETHER]; MOST_TAPS],
            local: [[0.0; TOGETHER]; D],
            are_known: [false; TOGETHER],
        };
        for (i, p) in points.iter().enumerate() {
            if !grid.region().contains(*p) {
                continue;
            }
            let (first, local) = grid.lattice().locate::<K>(*p);
            if let Window::Stored { first, strides } = grid.samples.window(first, K) {
                (places[i], ways, gathered.are_known[i]) = (first, strides, true);
                for (axis, x) in local.into_iter().enumerate() {
                    gathered.local[axis][i] = x;
                }
            }
        }
        match &grid.samples.codes {
            Codes::F32(codes) => gathered.take(codes, &places, ways),
            Codes::I16(codes) => gathered.take(codes, &places, ways),
            Codes::I8(codes) => gathered.take(codes, &places, ways),
        }
        gathered
    }

    #[inline(always)]
    fn take<T: Code>(&mut self, codes: &[T], places: &[usize; TOGETHER], ways: [usize; D]) {
        for (i, place) in places.iter().enumerate() {
            for row in 0..K.pow(D as u32 - 1) {
                let from = place + row_place::<K, D>(row, ways);
                let row_codes = &codes[from..from + K];
                for (tap, code) in row_codes.iter().enumerate() {
                    self.taps[row * K + tap][i] = (*code).into();
                }
            }
        }
    }

    /// A row of the samples of a point.
    #[inline(always)]
    fn row(&self, i: usize, row: usize) -> [f64; K] {
        std::array::from_fn(|tap| self.taps[row * K + tap][i])
    }

    #[inline(always)]
    fn local(&self, i: usize) -> [f64; D] {
        std::array::from_fn(|axis| self.local[axis][i])
    }
}

struct Values<'a, const K: usize, const D: usize> {
    grid: &'a Grid<D>,
    points: &'a [Point<D>],
    values: &'a mut [f64],
}

impl<const K: usize, const D: usize> Wide for Values<'_, K, D>
where
    OfTaps<K>: Spline<K>,
{
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let Self { grid, points, values } = self;
        let gathered = Gathered::<K, D>::of(grid, points);
        let mut found = [0.0; TOGETHER];
        for (i, found) in found.iter_mut().enumerate() {
            *found = value(|row| gathered.row(i, row), gathered.local(i)) * grid.samples.scale;
        }
        for (i, out) in values.iter_mut().enumerate() {
            let is_plain = gathered.are_known[i] && !grid.may_be_clamped(found[i]);
            *out = if is_plain { found[i] } else { grid.value_at(points[i]) };
        }
    }
}

struct Slopes<'a, const K: usize, const D: usize> {
    grid: &'a Grid<D>,
    points: &'a [Point<D>],
    values: &'a mut [f64],
    slopes: &'a mut [Vector<f64, D>],
}

impl<const K: usize, const D: usize> Wide for Slopes<'_, K, D>
where
    OfTaps<K>: Spline<K>,
{
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let Self { grid, points, values, slopes } = self;
        let gathered = Gathered::<K, D>::of(grid, points);
        let mut found = [0.0; TOGETHER];
        let mut rises = [[0.0; TOGETHER]; D];
        let (scale, inverse) = (grid.samples.scale, 1.0 / grid.lattice().cell);
        for (i, found) in found.iter_mut().enumerate() {
            let (value, slope) = value_slope(|row| gathered.row(i, row), gathered.local(i));
            *found = value * scale;
            for (axis, rises) in rises.iter_mut().enumerate() {
                rises[i] = slope[axis] * scale * inverse;
            }
        }
        for (i, (value, slope)) in values.iter_mut().zip(slopes).enumerate() {
            let is_plain = gathered.are_known[i] && !grid.may_be_clamped(found[i]);
            (*value, *slope) = if is_plain {
                (found[i], Vector(std::array::from_fn(|axis| rises[axis][i])))
            } else {
                grid.at(points[i])
            };
        }
    }
}
