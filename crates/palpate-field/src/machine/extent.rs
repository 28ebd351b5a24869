// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The ball around the points of a block.

use super::block::{Block, Rows};
use super::lanes::Lane;
use crate::bounds::BoundingBall;
use crate::scalar::Scalar;
use crate::vector::Vector;

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
