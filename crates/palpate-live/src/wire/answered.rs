// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The answers to questions about a scene.

use std::time::Instant;

use palpate::field::{Point, Vector};
use palpate::local::Descent;
use palpate::query::{Certified, Contact, Nearest, Penetration, Start, Stop};
use palpate::scene::{Answer, Versioned};
use serde::Serialize;

/// An answer, by its `do`.
#[derive(Debug, Serialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub(crate) enum Answered<const D: usize> {
    /// To a question that every door of the program takes.
    Answer(Timed<ToQuestion<D>>),
    /// The least distance over an element.
    Element {
        certified: Timed<Certified<Point<D>>>,
        /// What a local search found; not of a point.
        local: Option<Timed<Local<D>>>,
        /// The smallest ball around it; not of a point.
        enclosing: Option<Enclosing<D>>,
    },
    /// The separation of two bodies.
    Pair {
        certified: Timed<Certified<Nearest<D>>>,
        /// How far the second must move to leave the first; only of bodies that overlap.
        penetration: Option<Timed<Certified<Penetration<D>>>>,
        /// The points of both surfaces, if they were found.
        contact: Option<Contact<D>>,
        /// What a local search found from each start.
        local: Vec<Timed<Local<D>>>,
    },
    /// The first touch of an element that moves.
    Sweep(Timed<Swept<D>>),
    /// The way of a ball that falls.
    Fall(Timed<Fell<D>>),
}

/// An answer, and how long it took.
#[derive(Debug, Serialize)]
pub(crate) struct Timed<T> {
    #[serde(flatten)]
    pub(crate) result: T,
    /// How long it took [s].
    pub(crate) time: f64,
}

impl<T> Timed<T> {
    /// What `work` gives, timed.
    ///
    /// # Errors
    ///
    /// Those of `work`.
    pub(crate) fn of<E>(work: impl FnOnce() -> Result<T, E>) -> Result<Self, E> {
        let start = Instant::now();
        Ok(Self { result: work()?, time: start.elapsed().as_secs_f64() })
    }
}

/// An answer to a question that every door takes.
#[derive(Debug, Serialize)]
pub(crate) struct ToQuestion<const D: usize> {
    pub(crate) answer: Versioned<Answer<D>>,
    /// How many boxes of proofs are left out.
    pub(crate) boxes_left_out: usize,
}

/// What a local search found, which proves nothing.
#[derive(Debug, Serialize)]
pub(crate) struct Local<const D: usize> {
    /// The name of the search.
    pub(crate) method: &'static str,
    /// The best point [m].
    pub(crate) best: Point<D>,
    /// The value there [m]; between two bodies, the larger one of both fields.
    pub(crate) value: f64,
    pub(crate) steps: u32,
    pub(crate) evaluations: u32,
    /// The points of the path, from the start on [m].
    pub(crate) path: Vec<Point<D>>,
}

impl<const D: usize> Local<D> {
    pub(crate) fn new(method: &'static str, found: Descent<D>) -> Self {
        let Descent { best, value, steps, evaluations, path, .. } = found;
        Self { method, best, value, steps, evaluations, path }
    }
}

/// The smallest ball around an element, and the memoir's first test.
#[derive(Debug, Serialize)]
pub(crate) struct Enclosing<const D: usize> {
    pub(crate) centre: Point<D>,
    pub(crate) radius: f64,
    /// The field at the centre [m].
    pub(crate) value: f64,
    /// Whether the value exceeds the radius.
    pub(crate) excludes: bool,
}

/// The first touch of an element that moves for 1 s.
#[derive(Debug, Serialize)]
pub(crate) struct Swept<const D: usize> {
    /// Whether it touches; `None` if neither is proven.
    pub(crate) touches: Option<bool>,
    /// Before this time it is proven to touch nothing [s].
    pub(crate) lower: f64,
    /// At this time it touches [s]; infinite if no touch was found.
    pub(crate) upper: f64,
    pub(crate) contact: Option<Contact<D>>,
    /// How it moves on, if it touches at the start.
    pub(crate) start: Option<Start>,
    pub(crate) stop: Stop,
    pub(crate) evaluations: u32,
}

/// The way of a ball that fell.
#[derive(Debug, Serialize)]
pub(crate) struct Fell<const D: usize> {
    /// The time from each place of the path to the next [s].
    pub(crate) step: f64,
    /// The centres [m].
    pub(crate) path: Vec<Point<D>>,
    pub(crate) bounces: Vec<Bounce<D>>,
    /// How the way ends.
    pub(crate) end: FallEnd,
    pub(crate) evaluations: u32,
}

/// A touch after which a ball leaves the surface.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Bounce<const D: usize> {
    /// When [s].
    pub(crate) time: f64,
    /// The centre of the ball [m].
    pub(crate) centre: Point<D>,
    pub(crate) normal: Vector<f64, D>,
    /// The speed along the normal [m/s].
    pub(crate) speed: f64,
}

/// How the way of a ball ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FallEnd {
    /// It rests.
    Rests,
    /// It is below the bounds of the scene, or beside them.
    Leaves,
    /// It still moves after the last step.
    Time,
    /// It begins in a body.
    Inside,
    /// The search used up its evaluations, or its time.
    Budget,
}
