// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Many points at once: their samples are gathered one after another, and interpolated side by side.

use std::ops::{Add, Mul, Sub};

use palpate_field::{Aabb, Point, Vector, Wide, wide};

use crate::grid::Grid;
use crate::samples::{Code, Codes, Window, row_place};
use crate::spline::{
    GridKernel, MOST_ROWS, Number, OfTaps, QUADRATIC, Spline, TRILINEAR, value, value_slope,
};

/// Points whose samples are gathered together, and as many numbers as go side by side.
const TOGETHER: usize = 16;
const SIDE: usize = 4;

/// Numbers side by side.
#[derive(Clone, Copy)]
struct Pack([f64; SIDE]);

impl Pack {
    #[inline(always)]
    fn of<T: Copy + Into<f64>>(all: &[T; TOGETHER], first: usize) -> Self {
        Self(std::array::from_fn(|k| all[first + k].into()))
    }

    #[inline(always)]
    fn with(self, other: Self, join: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|k| join(self.0[k], other.0[k])))
    }

    #[inline(always)]
    fn write(self, all: &mut [f64; TOGETHER], first: usize) {
        all[first..first + SIDE].copy_from_slice(&self.0);
    }
}

impl Number for Pack {
    #[inline(always)]
    fn constant(number: f64) -> Self {
        Self([number; SIDE])
    }
}

impl Add for Pack {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl Sub for Pack {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl Mul for Pack {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl<const D: usize> Grid<D> {
    /// The values at points [m].
    pub(crate) fn values_at(&self, points: &[Point<D>], values: &mut [f64]) {
        match &self.samples.codes {
            Codes::F32(codes) => self.values_of(codes, points, values),
            Codes::I16(codes) => self.values_of(codes, points, values),
            Codes::I8(codes) => self.values_of(codes, points, values),
        }
    }

    fn values_of<T: Code>(&self, codes: &[T], points: &[Point<D>], values: &mut [f64]) {
        let job = Job { grid: self, codes, points };
        match self.kernel() {
            GridKernel::Quadratic => wide(Values::<T, QUADRATIC, D> { job, values }),
            GridKernel::Trilinear => wide(Values::<T, TRILINEAR, D> { job, values }),
        }
    }

    /// The values at points [m] and their gradients.
    pub(crate) fn all_at(
        &self,
        points: &[Point<D>],
        values: &mut [f64],
        slopes: &mut [Vector<f64, D>],
    ) {
        match &self.samples.codes {
            Codes::F32(codes) => self.all_of(codes, points, values, slopes),
            Codes::I16(codes) => self.all_of(codes, points, values, slopes),
            Codes::I8(codes) => self.all_of(codes, points, values, slopes),
        }
    }

    fn all_of<T: Code>(
        &self,
        codes: &[T],
        points: &[Point<D>],
        values: &mut [f64],
        slopes: &mut [Vector<f64, D>],
    ) {
        let job = Job { grid: self, codes, points };
        match self.kernel() {
            GridKernel::Quadratic => wide(Slopes::<T, QUADRATIC, D> { job, values, slopes }),
            GridKernel::Trilinear => wide(Slopes::<T, TRILINEAR, D> { job, values, slopes }),
        }
    }
}

/// Points that a grid is asked about, and its samples as they are stored.
struct Job<'a, T, const D: usize> {
    grid: &'a Grid<D>,
    codes: &'a [T],
    points: &'a [Point<D>],
}

/// The samples of the cells of points, and where in them these lie. A point that has none, outside the
/// lattice or far from the surface, has some that are not used.
struct Gathered<T, const K: usize, const D: usize> {
    /// By the row and the place in it, those of all points.
    taps: [[[T; TOGETHER]; K]; MOST_ROWS],
    local: [[f64; TOGETHER]; D],
    are_known: [bool; TOGETHER],
}

impl<T: Code, const K: usize, const D: usize> Gathered<T, K, D> {
    #[inline(always)]
    fn empty() -> Self {
        Self {
            taps: [[[T::default(); TOGETHER]; K]; MOST_ROWS],
            local: [[0.0; TOGETHER]; D],
            are_known: [false; TOGETHER],
        }
    }

    #[inline(always)]
    fn fill(&mut self, grid: &Grid<D>, codes: &[T], points: &[Point<D>]) {
        let firsts = self.locate(grid, points);
        let (mut places, mut ways) = ([0; TOGETHER], [0; D]);
        for (i, place) in places.iter_mut().enumerate() {
            if !self.are_known[i] {
                continue;
            }
            let first = std::array::from_fn(|axis| firsts[axis][i] as usize);
            match grid.samples.window(first, K) {
                Window::Stored { first, strides } => (*place, ways) = (first, strides),
                Window::Far { .. } => self.are_known[i] = false,
            }
        }
        let rows = std::array::from_fn(|row| row_place::<K, D>(row, ways));
        self.take(codes, &places, &rows);
    }

    /// The first sample of each point's cell, as [`Lattice::locate`] finds it for one.
    #[inline(always)]
    fn locate(&mut self, grid: &Grid<D>, points: &[Point<D>]) -> [[i32; TOGETHER]; D] {
        for (i, is_known) in self.are_known.iter_mut().enumerate() {
            *is_known = i < points.len();
        }
        let lattice = grid.lattice();
        let inverse = 1.0 / lattice.cell;
        let shift = 0.5 * K as f64 - 1.0;
        let mut firsts = [[0; TOGETHER]; D];
        for axis in 0..D {
            let mut along = [0.0; TOGETHER];
            for (along, p) in along.iter_mut().zip(points) {
                *along = p[axis];
            }
            let Aabb { min, max } = grid.region();
            let last = (lattice.counts[axis] - K) as i32;
            for i in 0..TOGETHER {
                let x = along[i];
                self.are_known[i] &= (min[axis] <= x) & (x <= max[axis]);
                let x = (x - lattice.origin[axis]) * inverse - shift;
                let first = (x as i32).min(last);
                firsts[axis][i] = first;
                self.local[axis][i] = x - f64::from(first);
            }
        }
        firsts
    }

    #[inline(always)]
    fn take(&mut self, codes: &[T], places: &[usize; TOGETHER], rows: &[usize; MOST_ROWS]) {
        for (i, place) in places.iter().enumerate() {
            let taps = self.taps[..K.pow(D as u32 - 1)].iter_mut();
            for (taps, row) in taps.zip(rows) {
                let codes = &codes[place + row..][..K];
                for (taps, code) in taps.iter_mut().zip(codes) {
                    taps[i] = *code;
                }
            }
        }
    }

    /// A row of the samples of the points from `first` on.
    #[inline(always)]
    fn row(&self, first: usize, row: usize) -> [Pack; K] {
        std::array::from_fn(|tap| Pack::of(&self.taps[row][tap], first))
    }

    #[inline(always)]
    fn local(&self, first: usize) -> [Pack; D] {
        std::array::from_fn(|axis| Pack::of(&self.local[axis], first))
    }
}

struct Values<'a, T, const K: usize, const D: usize> {
    job: Job<'a, T, D>,
    values: &'a mut [f64],
}

impl<T: Code, const K: usize, const D: usize> Wide for Values<'_, T, K, D>
where
    OfTaps<K>: Spline<K>,
{
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let Self { job: Job { grid, codes, points }, values } = self;
        let scale = Pack::constant(grid.samples.scale);
        let mut gathered = Gathered::<T, K, D>::empty();
        let mut found = [0.0; TOGETHER];
        for (points, values) in points.chunks(TOGETHER).zip(values.chunks_mut(TOGETHER)) {
            gathered.fill(grid, codes, points);
            for first in (0..TOGETHER).step_by(SIDE) {
                let value = value(|row| gathered.row(first, row), gathered.local(first));
                (value * scale).write(&mut found, first);
            }
            for (i, out) in values.iter_mut().enumerate() {
                let is_plain = gathered.are_known[i] && !grid.may_be_clamped(found[i]);
                *out = if is_plain { found[i] } else { grid.value_at(points[i]) };
            }
        }
    }
}

struct Slopes<'a, T, const K: usize, const D: usize> {
    job: Job<'a, T, D>,
    values: &'a mut [f64],
    slopes: &'a mut [Vector<f64, D>],
}

impl<T: Code, const K: usize, const D: usize> Wide for Slopes<'_, T, K, D>
where
    OfTaps<K>: Spline<K>,
{
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let Self { job: Job { grid, codes, points }, values, slopes } = self;
        let scale = Pack::constant(grid.samples.scale);
        let inverse = Pack::constant(1.0 / grid.lattice().cell);
        let mut gathered = Gathered::<T, K, D>::empty();
        let (mut found, mut rises) = ([0.0; TOGETHER], [[0.0; TOGETHER]; D]);
        let out = values.chunks_mut(TOGETHER).zip(slopes.chunks_mut(TOGETHER));
        for (points, (values, slopes)) in points.chunks(TOGETHER).zip(out) {
            gathered.fill(grid, codes, points);
            for first in (0..TOGETHER).step_by(SIDE) {
                let (value, slope) =
                    value_slope(|row| gathered.row(first, row), gathered.local(first));
                (value * scale).write(&mut found, first);
                for (rises, slope) in rises.iter_mut().zip(slope.0) {
                    (slope * scale * inverse).write(rises, first);
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
}
