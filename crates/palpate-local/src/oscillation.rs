// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whether a descent goes to and fro for ever.

use palpate_field::Vector;

use crate::Descent;

/// The last steps of a path that are looked at.
const LAST: usize = 8;

/// Steps do not shrink if the longest of the later half has at least this share of the longest of
/// the earlier half: a path that converges to and fro by less than 3 % a step counts as
/// oscillating.
const KEPT: f64 = 0.9;

/// Steps below so many roundings of the coordinates are rounding.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

impl<const D: usize> Descent<D> {
    /// The peak-to-peak amplitude of the oscillation that the path ends in [m]; `None` if it ends in
    /// none.
    ///
    /// A path oscillates if of its last 8 steps at least every other one turns back, by more than
    /// a right angle, and the longest of the later four has at least 0.9 of the length of the
    /// longest of the earlier four. The amplitude is the longest of the 8.
    ///
    /// Above the centre of a disc, steps of a constant length go to and fro across its deepest
    /// point:
    ///
    /// ```
    /// use palpate_field::{Shape, Vector};
    /// use palpate_local::NaiveDescent;
    /// use palpate_query::Element;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let disc = Shape::<2>::ball(1.0)?;
    /// let segment = Element::new([Vector([-3.0, 0.0]), Vector([3.5, 0.0])])?;
    /// let found = NaiveDescent::default().with_alpha(0.5).with_mu(0.5).descend(&disc, &segment);
    /// let amplitude = found.oscillation().ok_or("it converges")?;
    /// assert!((amplitude - 0.25).abs() < 1e-9); // α·µ
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn oscillation(&self) -> Option<f64> {
        let last = &self.path[self.path.len().checked_sub(LAST + 1)?..];
        let steps: Vec<_> = last.windows(2).map(|ends| ends[1] - ends[0]).collect();
        let turns = steps.windows(2).filter(|pair| pair[0].dot(pair[1]) < 0.0).count();
        let (earlier, later) = steps.split_at(LAST / 2);
        let [earlier, later] = [earlier, later].map(longest);
        let size = last.iter().fold(0.0_f64, |m, p| m.max(p.norm()));
        let is_kept = later >= KEPT * earlier && later > ROUNDINGS * size;
        (is_kept && 2 * turns >= steps.len() - 1).then_some(earlier.max(later))
    }
}

/// The length of the longest step [m].
fn longest<const D: usize>(steps: &[Vector<f64, D>]) -> f64 {
    steps.iter().map(|step| step.norm()).fold(0.0, f64::max)
}
