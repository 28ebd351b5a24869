// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Blocks: many points evaluated together, one array a coordinate.

use std::fmt;
use std::mem::MaybeUninit;

use super::lanes::{Lane, LaneArray};
use crate::pose::Rotation;
use crate::scalar::Model;
use crate::vector::{Point, Vector, array, unrolled};

/// The most points that a block holds.
pub const BLOCK: usize = 64;

/// Per-lane storage, initialised up to `written()`.
pub(crate) trait Rows {
    type Item: Copy;

    /// The number of initialised lanes, from the first on.
    fn written(&self) -> usize;

    /// The item in lane `i`.
    ///
    /// # Safety
    ///
    /// `i` must be less than `written()`.
    unsafe fn read(&self, i: usize) -> Self::Item;
}

/// [`Rows`] that a loop can fill.
pub(crate) trait RowsMut: Rows {
    /// All lanes there are.
    const WIDTH: usize;
    /// Lanes are filled in lines of this many.
    const LINE: usize;

    /// Puts an item into lane `i`.
    fn write(&mut self, i: usize, item: Self::Item);

    /// Declares the first `count` lanes written.
    ///
    /// # Safety
    ///
    /// They must be.
    unsafe fn set_written(&mut self, count: usize);
}

/// The lanes to fill for `count` points: whole lines, so that no scalar remainder
/// is left over.
#[inline(always)]
pub(super) fn filled<R: RowsMut>(count: usize) -> usize {
    if R::WIDTH <= R::LINE {
        R::WIDTH
    } else {
        (count.div_ceil(R::LINE) * R::LINE).min(R::WIDTH)
    }
}

/// No input.
impl Rows for () {
    type Item = ();

    #[inline(always)]
    fn written(&self) -> usize {
        usize::MAX
    }

    #[inline(always)]
    unsafe fn read(&self, _: usize) {}
}

/// Up to `W` numbers, one a point.
#[derive(Clone, Copy)]
pub struct Column<S: Lane, const W: usize = BLOCK> {
    lanes: S::Lanes<W>,
    written: usize,
}

impl<S: Lane, const W: usize> Column<S, W> {
    /// All zero.
    #[must_use]
    pub fn zero() -> Self {
        let mut column = Self::scratch();
        column.fill(W, |_| S::constant(0.0));
        column
    }

    /// Memory for answers. No lane is written yet; [`zero`](Self::zero) would write all of them.
    #[inline(always)]
    #[must_use]
    pub fn scratch() -> Self {
        // Written through pointers: of a literal the compiler would make a constant, and copy all of
        // its lanes.
        let mut column = MaybeUninit::<Self>::uninit();
        let place = column.as_mut_ptr();
        // SAFETY: `place` is valid for writes, and both fields are written.
        unsafe {
            (&raw mut (*place).lanes).write(S::Lanes::unwritten());
            (&raw mut (*place).written).write(0);
            column.assume_init()
        }
    }

    /// The number in lane `i`.
    ///
    /// # Panics
    ///
    /// If there is no lane `i`, or the last evaluation did not write it.
    #[inline(always)]
    #[must_use]
    pub fn get(&self, i: usize) -> S {
        assert!(i < self.written, "lane {i} of {} is not written", self.written);
        // SAFETY: checked.
        unsafe { self.lanes.read(i) }
    }

    /// Puts a number into lane `i`.
    ///
    /// # Panics
    ///
    /// If there is no lane `i`, or nothing was written to it before.
    #[inline(always)]
    pub fn set(&mut self, i: usize, number: S) {
        assert!(i < self.written, "lane {i} of {} is not written", self.written);
        self.lanes.write(i, number);
    }

    /// `number` in the first `count` lanes.
    pub(crate) fn all(count: usize, number: S) -> Self {
        let mut column = Self::scratch();
        column.fill(count, |_| number);
        column
    }

    /// Joins what is in the given lanes with the numbers of the first lanes of another column, in
    /// their order.
    #[inline(always)]
    pub(crate) fn join(&mut self, lanes: &[u8], with: &Self, join: impl Fn(S, S) -> S) {
        for (k, lane) in lanes.iter().enumerate() {
            let lane = usize::from(*lane);
            self.set(lane, join(self.get(lane), with.get(k)));
        }
    }

    /// Copies the written lanes of another column.
    pub(crate) fn copy_from(&mut self, from: &Self) {
        for i in 0..from.written {
            // SAFETY: lane `i` is written.
            self.lanes.write(i, unsafe { from.lanes.read(i) });
        }
        self.written = from.written;
    }

    /// Writes the first `count` lanes, and what completes their line with the
    /// last of them.
    pub(crate) fn fill(&mut self, count: usize, mut number: impl FnMut(usize) -> S) {
        let lanes = filled::<Self>(count);
        for i in 0..lanes {
            self.lanes.write(i, number(i.min(count.max(1) - 1)));
        }
        self.written = lanes;
    }
}

macro_rules! float_column {
    ($t:ident) => {
        impl<const W: usize> Column<$t, W> {
            /// The initialised numbers: those of the points asked for, and of those that complete
            /// their line.
            #[inline(always)]
            #[must_use]
            pub fn as_slice(&self) -> &[$t] {
                // SAFETY: the first `written` lanes are.
                unsafe { self.lanes.as_slice(self.written) }
            }
        }
    };
}

float_column!(f32);
float_column!(f64);

impl<S: Lane, const W: usize> Rows for Column<S, W> {
    type Item = S;

    #[inline(always)]
    fn written(&self) -> usize {
        self.written
    }

    #[inline(always)]
    unsafe fn read(&self, i: usize) -> S {
        // SAFETY: the caller promises that `i` is less than `written`.
        unsafe { self.lanes.read(i) }
    }
}

impl<S: Lane, const W: usize> RowsMut for Column<S, W> {
    const WIDTH: usize = W;
    const LINE: usize = S::LINE;

    #[inline(always)]
    fn write(&mut self, i: usize, number: S) {
        self.lanes.write(i, number);
    }

    #[inline(always)]
    unsafe fn set_written(&mut self, count: usize) {
        self.written = count;
    }
}

impl<S: Lane + fmt::Debug, const W: usize> fmt::Debug for Column<S, W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries((0..self.written).map(|i| self.get(i))).finish()
    }
}

/// Up to `W` points in `D` dimensions.
///
/// ```
/// use palpate_field::{BLOCK, Block, Vector};
///
/// let mut points = Block::<f64, 2, BLOCK>::zero();
/// points.set(3, Vector([1.0, 2.0]));
/// assert_eq!(points.get(3), Vector([1.0, 2.0]));
/// ```
#[derive(Clone)]
pub struct Block<S: Lane, const D: usize, const W: usize = BLOCK> {
    columns: [Column<S, W>; D],
    boxes: Boxes<D>,
}

/// The shape that all points of a block are known to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Boxes<const D: usize> {
    /// Points, or cells of any shape.
    No,
    /// Boxes along the axes: [`Lane::is_box`].
    Straight,
    /// Boxes turned by the rotation of these rows: [`Block::fill_boxes`].
    Turned([[f64; D]; D]),
}

impl<S: Lane, const D: usize, const W: usize> Block<S, D, W> {
    /// All points at the origin.
    #[must_use]
    pub fn zero() -> Self {
        Self { columns: std::array::from_fn(|_| Column::zero()), boxes: Boxes::Straight }
    }

    /// Memory for answers. No lane is written yet; [`zero`](Self::zero) would write all of them.
    #[inline(always)]
    #[must_use]
    pub fn scratch() -> Self {
        Self { columns: [Column::scratch(); D], boxes: Boxes::No }
    }

    /// The point in lane `i`.
    ///
    /// # Panics
    ///
    /// If there is no lane `i`, or the last evaluation did not write it.
    #[inline(always)]
    #[must_use]
    pub fn get(&self, i: usize) -> Vector<S, D> {
        Vector(array!(k < D => self.columns[k].get(i)))
    }

    /// Puts points into the first `count` lanes, and more of the last where evaluations
    /// work through whole lines; other lanes may not be read after that.
    ///
    /// # Panics
    ///
    /// If there are not so many lanes.
    #[inline(always)]
    pub fn fill(&mut self, count: usize, mut point: impl FnMut(usize) -> Vector<S, D>) {
        assert!(count <= W, "{count} points in {W} lanes");
        let lanes = if count == 0 { 0 } else { filled::<Column<S, W>>(count) };
        // Also if `point` panics.
        self.boxes = Boxes::No;
        let mut are_boxes = true;
        let mut put = |i: usize, point: Vector<S, D>| {
            are_boxes = are_boxes && S::is_box(&point.0);
            unrolled!(k < D => self.columns[k].lanes.write(i, point.0[k]));
        };
        for i in 0..count {
            put(i, point(i));
        }
        for i in count..lanes {
            put(i, point(count - 1));
        }
        self.boxes = if are_boxes { Boxes::Straight } else { Boxes::No };
        for column in &mut self.columns {
            column.written = lanes;
        }
    }

    /// Puts the points in the given lanes of another block into the first ones, as
    /// [`fill`](Self::fill) does; at least one.
    pub(crate) fn gather(&mut self, from: &Self, lanes: &[u8]) {
        let filled = filled::<Column<S, W>>(lanes.len());
        for i in 0..filled {
            let point = from.get(usize::from(lanes[i.min(lanes.len() - 1)]));
            unrolled!(k < D => self.columns[k].lanes.write(i, point.0[k]));
        }
        self.boxes = from.boxes;
        for column in &mut self.columns {
            column.written = filled;
        }
    }

    /// Puts a point into lane `i`.
    ///
    /// # Panics
    ///
    /// If there is no lane `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, point: Vector<S, D>) {
        if self.boxes != Boxes::Straight || !S::is_box(&point.0) {
            self.boxes = Boxes::No;
        }
        unrolled!(k < D => self.columns[k].set(i, point.0[k]));
    }

    /// One column for each coordinate.
    pub(crate) fn columns(&self) -> [&Column<S, W>; D] {
        self.columns.each_ref()
    }

    /// The shape that all points are known to have.
    #[inline(always)]
    pub(crate) fn boxes(&self) -> &Boxes<D> {
        &self.boxes
    }
}

impl<const D: usize, const W: usize> Block<Model, D, W> {
    /// Puts boxes into the first `count` lanes, as [`fill`](Self::fill) puts points: each has
    /// a centre and half side lengths, along the axes, or along the columns of one rotation.
    ///
    /// Fields that are moved move such boxes with fewer operations than cells of any form.
    ///
    /// ```
    /// use palpate_field::scalar::Model;
    /// use palpate_field::{BLOCK, Block, Rotation, Vector};
    ///
    /// let mut cells = Block::<Model, 2, BLOCK>::zero();
    /// let turn = Rotation::from_angle(0.1).unwrap();
    /// cells.fill_boxes(1, Some(&turn), |_| (Vector([3.0, 0.0]), Vector([0.5, 0.0])));
    /// let x = cells.get(0)[0];
    /// assert!(x.maximum() >= 3.0 + 0.5 * 0.1_f64.cos());
    /// ```
    ///
    /// # Panics
    ///
    /// If there are not so many lanes.
    #[inline(always)]
    pub fn fill_boxes(
        &mut self,
        count: usize,
        turn: Option<&Rotation<D>>,
        mut cell: impl FnMut(usize) -> (Point<D>, Vector<f64, D>),
    ) {
        let Some(turn) = turn else {
            return self.fill(count, |i| {
                let (centre, half) = cell(i);
                Vector(Model::cell(centre.0, half.0))
            });
        };
        self.fill(count, |i| {
            let (centre, half) = cell(i);
            Vector(Model::turned_cell(centre.0, half.0, turn.matrix()))
        });
        self.boxes = Boxes::Turned(*turn.matrix());
    }
}

impl<S: Lane, const D: usize, const W: usize> Rows for Block<S, D, W> {
    type Item = Vector<S, D>;

    #[inline(always)]
    fn written(&self) -> usize {
        self.columns.iter().fold(usize::MAX, |least, column| least.min(column.written))
    }

    #[inline(always)]
    unsafe fn read(&self, i: usize) -> Vector<S, D> {
        // SAFETY: the caller promises that `i` is less than `written` of every
        // column.
        Vector(array!(k < D => unsafe { self.columns[k].lanes.read(i) }))
    }
}

impl<S: Lane, const D: usize, const W: usize> RowsMut for Block<S, D, W> {
    const WIDTH: usize = W;
    const LINE: usize = S::LINE;

    #[inline(always)]
    fn write(&mut self, i: usize, point: Vector<S, D>) {
        unrolled!(k < D => self.columns[k].lanes.write(i, point.0[k]));
    }

    #[inline(always)]
    unsafe fn set_written(&mut self, count: usize) {
        for column in &mut self.columns {
            column.written = count;
        }
    }
}

impl<S: Lane + fmt::Debug, const D: usize, const W: usize> fmt::Debug for Block<S, D, W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.columns).finish()
    }
}

/// The distances at up to `W` points, and their gradients.
#[derive(Clone, Debug)]
pub struct Gradients<T: Lane + fmt::Debug, const D: usize, const W: usize = BLOCK> {
    /// The distances [m].
    pub distance: Column<T, W>,
    /// The gradients.
    pub gradient: Block<T, D, W>,
}

impl<T: Lane + fmt::Debug, const D: usize, const W: usize> Gradients<T, D, W> {
    /// All zero.
    #[must_use]
    pub fn zero() -> Self {
        Self { distance: Column::zero(), gradient: Block::zero() }
    }

    /// Memory for answers. No lane is written yet; [`zero`](Self::zero) would write all of them.
    #[inline(always)]
    #[must_use]
    pub fn scratch() -> Self {
        Self { distance: Column::scratch(), gradient: Block::scratch() }
    }

    /// Copies the written lanes of `from`.
    pub(crate) fn copy_from(&mut self, from: &Self) {
        self.distance.copy_from(&from.distance);
        unrolled!(k < D => self.gradient.columns[k].copy_from(&from.gradient.columns[k]));
        self.gradient.boxes = from.gradient.boxes;
    }

    /// Writes the first `count` lanes, and what completes their line with the
    /// last of them.
    pub(crate) fn fill(
        &mut self,
        count: usize,
        mut item: impl FnMut(usize) -> (T, Vector<T, D>),
    ) {
        let lanes = filled::<Self>(count);
        for i in 0..lanes {
            self.write(i, item(i.min(count.max(1) - 1)));
        }
        // SAFETY: the loop wrote them.
        unsafe { self.set_written(lanes) };
    }
}

impl<T: Lane + fmt::Debug, const D: usize, const W: usize> Rows for Gradients<T, D, W> {
    type Item = (T, Vector<T, D>);

    #[inline(always)]
    fn written(&self) -> usize {
        self.distance.written.min(self.gradient.written())
    }

    #[inline(always)]
    unsafe fn read(&self, i: usize) -> (T, Vector<T, D>) {
        // SAFETY: the caller promises that `i` is less than `written` of both.
        unsafe { (self.distance.read(i), self.gradient.read(i)) }
    }
}

impl<T: Lane + fmt::Debug, const D: usize, const W: usize> RowsMut for Gradients<T, D, W> {
    const WIDTH: usize = W;
    const LINE: usize = T::LINE;

    #[inline(always)]
    fn write(&mut self, i: usize, (distance, gradient): (T, Vector<T, D>)) {
        self.distance.write(i, distance);
        self.gradient.write(i, gradient);
    }

    #[inline(always)]
    unsafe fn set_written(&mut self, count: usize) {
        // SAFETY: the caller promises it of both.
        unsafe {
            self.distance.set_written(count);
            self.gradient.set_written(count);
        }
    }
}
