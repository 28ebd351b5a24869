// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches for the first touch of an element, a mesh or a body that moves.

mod approach;
mod course;
mod sampled;
mod space_time;

use std::fmt;

use palpate_field::Point;

pub use sampled::SampledSweep;
pub use space_time::SpaceTimeGoldenSection;

/// A touch that a local search found, of a motion over the time from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LocalTouch<const D: usize> {
    /// The time of the touch: nothing says that it is the first.
    pub time: f64,
    /// Where, in world coordinates [m].
    pub point: Point<D>,
    /// The field there, at most the gap that was asked for [m]; between two bodies, the larger of both.
    pub value: f64,
    /// The index of the mesh's element; zero of one element alone, and between two bodies.
    pub element: usize,
}

/// What a local search for a first touch found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LocalSweep<const D: usize> {
    /// The earliest touch that was found; `None` says that none was found, not that there is none.
    pub touch: Option<LocalTouch<D>>,
    /// How often fields were asked; a gradient counts twice.
    pub evaluations: u32,
    /// Elements that the broad phase left to the search; between two bodies, starts of searches.
    pub searched: u32,
}

impl<const D: usize> LocalSweep<D> {
    fn nothing() -> Self {
        Self { touch: None, evaluations: 0, searched: 0 }
    }

    fn asked(&mut self, evaluations: u32) {
        self.evaluations = self.evaluations.saturating_add(evaluations);
    }

    /// Keeps the touch if it is earlier.
    fn keep(&mut self, touch: LocalTouch<D>) {
        if self.touch.is_none_or(|known| touch.time < known.time) {
            self.touch = Some(touch);
        }
    }

    /// Keeps what is at most `gap`, if it is the lowest.
    fn keep_lower(&mut self, touch: LocalTouch<D>, gap: f64) {
        if touch.value <= gap && self.touch.is_none_or(|known| touch.value < known.value) {
            self.touch = Some(touch);
        }
    }
}

impl<const D: usize> fmt::Display for LocalSweep<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.touch {
            Some(touch) => write!(f, "a touch at {} at {:?} m", touch.time, touch.point.0)?,
            None => write!(f, "no touch found")?,
        }
        write!(f, ", {} evaluations", self.evaluations)
    }
}
