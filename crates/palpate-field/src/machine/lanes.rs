// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Lanes of numbers, and how far they reach.

use std::fmt;
use std::mem::MaybeUninit;

use super::block::{Block, Rows};
use crate::bounds::BoundingBall;
use crate::pose::{Placement, Pose};
use crate::scalar::{AffineModel, Float, Scalar, TurnedBoxes};
use crate::vector::{Vector, array, unrolled};

/// Room for `W` numbers, aligned to a cache line.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub struct Lanes<T: Copy, const W: usize>([MaybeUninit<T>; W]);

/// Room for `W` models of `N` parameters, one array for each of their parts.
#[derive(Clone, Copy)]
pub struct ModelLanes<const N: usize, const W: usize> {
    value: Lanes<f64, W>,
    gradient: [Lanes<f64, W>; N],
    lower: Lanes<f64, W>,
    upper: Lanes<f64, W>,
}

impl<T: Copy, const W: usize> fmt::Debug for Lanes<T, W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Lanes<{W}>")
    }
}

impl<const N: usize, const W: usize> fmt::Debug for ModelLanes<N, W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ModelLanes<{W}>")
    }
}

/// A place for as many numbers as a block has points.
pub trait LaneArray<S>: Copy + Send + Sync {
    /// Memory that holds nothing yet.
    fn unwritten() -> Self;

    /// The number in lane `i`.
    ///
    /// # Safety
    ///
    /// A number must have been written to lane `i`.
    unsafe fn read(&self, i: usize) -> S;

    /// Puts a number into lane `i`.
    fn write(&mut self, i: usize, number: S);
}

/// A number that blocks hold.
pub trait Lane: Scalar + Send + Sync + 'static {
    /// Storage for `W` numbers.
    type Lanes<const W: usize>: LaneArray<Self>;

    /// The lanes of a line: loops run over whole lines.
    const LINE: usize;

    /// The smallest and the largest value that the number stands for.
    fn range(&self) -> (f64, f64);

    /// `true` if these are the coordinates of a box along the axes, without remainders:
    /// then [`box_to_body`](Self::box_to_body) may move it. A number is no box.
    #[inline(always)]
    fn is_box<const D: usize>(_: &[Self; D]) -> bool {
        false
    }

    /// A box in a body's frame.
    #[inline(always)]
    fn box_to_body<const D: usize>(p: [Self; D], placement: &Placement<D>) -> [Self; D] {
        placement.to_body(Vector(p)).0
    }

    /// A box of those that are all turned alike, in a body's frame.
    #[inline(always)]
    fn turned_to_body<const D: usize>(
        p: [Self; D],
        placement: &Placement<D>,
        _: &TurnedBoxes<D>,
    ) -> [Self; D] {
        placement.to_body(Vector(p)).0
    }
}

impl<T: Float, const W: usize> LaneArray<T> for Lanes<T, W> {
    #[inline(always)]
    fn unwritten() -> Self {
        Self([MaybeUninit::uninit(); W])
    }

    #[inline(always)]
    unsafe fn read(&self, i: usize) -> T {
        // SAFETY: the caller promises that lane `i` was written, so there is one.
        unsafe { self.0.get_unchecked(i).assume_init() }
    }

    #[inline(always)]
    fn write(&mut self, i: usize, number: T) {
        self.0[i].write(number);
    }
}

impl<T: Float, const W: usize> Lanes<T, W> {
    /// The first `written` lanes.
    ///
    /// # Safety
    ///
    /// Numbers must have been written to all of them.
    #[inline(always)]
    pub(super) unsafe fn as_slice(&self, written: usize) -> &[T] {
        // SAFETY: the caller promises that they are written, and a written
        // `MaybeUninit<T>` has the layout of a `T`.
        unsafe { self.0[..written].assume_init_ref() }
    }
}

impl<const N: usize, const W: usize> LaneArray<AffineModel<N>> for ModelLanes<N, W> {
    #[inline(always)]
    fn unwritten() -> Self {
        let none = Lanes::unwritten();
        Self { value: none, gradient: [none; N], lower: none, upper: none }
    }

    #[inline(always)]
    unsafe fn read(&self, i: usize) -> AffineModel<N> {
        // SAFETY: the caller promises that lane `i` was written, and `write`
        // writes every part.
        unsafe {
            AffineModel {
                value: self.value.read(i),
                gradient: array!(k < N => self.gradient[k].read(i)),
                lower: self.lower.read(i),
                upper: self.upper.read(i),
            }
        }
    }

    #[inline(always)]
    fn write(&mut self, i: usize, number: AffineModel<N>) {
        self.value.write(i, number.value);
        unrolled!(k < N => self.gradient[k].write(i, number.gradient[k]));
        self.lower.write(i, number.lower);
        self.upper.write(i, number.upper);
    }
}

macro_rules! float_lane {
    ($t:ident) => {
        impl Lane for $t {
            type Lanes<const W: usize> = Lanes<$t, W>;
            const LINE: usize = <$t as Float>::LINE;

            #[inline(always)]
            fn range(&self) -> (f64, f64) {
                (f64::from(*self), f64::from(*self))
            }
        }
    };
}

float_lane!(f32);
float_lane!(f64);

impl<const N: usize> Lane for AffineModel<N> {
    type Lanes<const W: usize> = ModelLanes<N, W>;
    const LINE: usize = 8;

    #[inline(always)]
    fn range(&self) -> (f64, f64) {
        (self.minimum(), self.maximum())
    }

    #[inline(always)]
    fn is_box<const D: usize>(p: &[Self; D]) -> bool {
        (0..D).all(|i| p[i].is_side(i))
    }

    #[inline(always)]
    fn box_to_body<const D: usize>(p: [Self; D], placement: &Placement<D>) -> [Self; D] {
        let Pose { rotation, translation } = &placement.world_from_body;
        Self::cell_to_body(p, &translation.0, rotation.matrix())
    }

    #[inline(always)]
    fn turned_to_body<const D: usize>(
        p: [Self; D],
        placement: &Placement<D>,
        turned: &TurnedBoxes<D>,
    ) -> [Self; D] {
        let Pose { rotation, translation } = &placement.world_from_body;
        Self::turned_to_body(p, &translation.0, rotation.matrix(), turned)
    }
}

/// Independent minima kept side by side, so that none waits for the one before.
const AT_ONCE: usize = 4;

impl<S: Lane, const D: usize, const W: usize> Block<S, D, W> {
    /// A ball around the first `count` points or cells, about the centre of their box; often
    /// much smaller than the ball around the box.
    ///
    /// # Panics
    ///
    /// If not so many lanes are written.
    #[doc(hidden)]
    pub fn ball_around(&self, count: usize) -> BoundingBall<D> {
        let mut low = [[f64::INFINITY; AT_ONCE]; D];
        let mut high = [[f64::NEG_INFINITY; AT_ONCE]; D];
        self.for_each_point(count, |j, p| {
            for k in 0..D {
                let (least, most) = p[k].range();
                low[k][j] = Scalar::min(low[k][j], least);
                high[k][j] = Scalar::max(high[k][j], most);
            }
        });
        let low = low.map(|low| low.into_iter().fold(f64::INFINITY, Scalar::min));
        let high = high.map(|high| high.into_iter().fold(f64::NEG_INFINITY, Scalar::max));
        let centre = (Vector(low) + Vector(high)) * 0.5;
        let mut farthest = [0.0; AT_ONCE];
        self.for_each_point(count, |j, p| {
            let mut squared = 0.0;
            for k in 0..D {
                let (least, most) = p[k].range();
                let apart = Scalar::max(most - centre[k], centre[k] - least);
                squared += apart * apart;
            }
            farthest[j] = Scalar::max(farthest[j], squared);
        });
        let farthest = farthest.into_iter().fold(0.0, Scalar::max);
        BoundingBall { centre, radius: farthest.sqrt() * (1.0 + 8.0 * f64::EPSILON) }
    }

    /// Calls `look` with each of the first `count` points and which of [`AT_ONCE`] it is; with
    /// some twice.
    #[inline(always)]
    fn for_each_point(&self, count: usize, mut look: impl FnMut(usize, Vector<S, D>)) {
        let written = self.written();
        assert!(count <= written, "{count} points of {written} are written");
        // SAFETY: every `i` below is less than `count`.
        let point = |i| unsafe { self.read(i) };
        if count < AT_ONCE {
            (0..count).for_each(|i| look(i, point(i)));
            return;
        }
        for first in (0..count).step_by(AT_ONCE) {
            let first = first.min(count - AT_ONCE);
            for j in 0..AT_ONCE {
                look(j, point(first + j));
            }
        }
    }
}
