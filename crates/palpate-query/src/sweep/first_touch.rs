// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The first touch of what moves.

use std::fmt;

use palpate_field::Vector;

use crate::certified::Stop;
use crate::contact::Contact;

/// A relative velocity slides if less than this share of it is along the normal.
const SLIDES: f64 = 1e-3;

/// How bodies that touch at the start move on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Start {
    /// Into each other.
    Approaching,
    /// Away from each other.
    Receding,
    /// Along each other.
    Sliding,
    /// Not at all.
    Resting,
}

impl Start {
    /// By the velocity of body `b` as body `a` sees it, and the unit normal from `a` to `b`.
    pub(super) fn of<const D: usize>(relative: Vector<f64, D>, normal: Vector<f64, D>) -> Self {
        let (along, speed) = (relative.dot(normal), relative.norm());
        match () {
            () if speed == 0.0 => Self::Resting,
            () if along.abs() <= SLIDES * speed => Self::Sliding,
            () if along < 0.0 => Self::Approaching,
            () => Self::Receding,
        }
    }
}

impl fmt::Display for Start {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Approaching => "approaching",
            Self::Receding => "receding",
            Self::Sliding => "sliding",
            Self::Resting => "resting",
        })
    }
}

/// When two bodies touch first, of a motion over the time from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FirstTouch<const D: usize> {
    /// Before this time the bodies are proven apart, rounding included: two bodies by more than half
    /// of the gap; and of an element or a mesh, the field is more than half of the gap at every point.
    pub lower: f64,
    /// At this time their separation is at most the gap, or the field at a point of the element or
    /// the mesh; infinite if no such time was found, and 1 if they are proven to be apart all the time.
    pub upper: f64,
    /// The contact at `upper`, that of bodies the deepest as a [`manifold`](crate::manifold) has it; `None`
    /// if there is none, or no surface of an element was found there.
    pub contact: Option<Contact<D>>,
    /// How the bodies move on, if they touch at the start and a field gives the normal there.
    pub start: Option<Start>,
    /// Why the search stopped: [`Stop::Converged`] at a touch, [`Stop::SignKnown`] if there is none.
    pub stop: Stop,
    /// How often fields were evaluated; a gradient counts twice.
    pub evaluations: u32,
}

impl<const D: usize> FirstTouch<D> {
    /// Nothing is known.
    #[cfg(feature = "world")]
    pub(crate) fn unknown() -> Self {
        Self {
            lower: 0.0,
            upper: f64::INFINITY,
            contact: None,
            start: None,
            stop: Stop::BudgetSpent,
            evaluations: 0,
        }
    }

    /// `true` if the bodies touch, `false` if they are proven to be apart all the time; `None` if
    /// neither is known.
    #[must_use]
    pub fn touches(&self) -> Option<bool> {
        match self.stop {
            Stop::SignKnown => Some(false),
            _ => self.upper.is_finite().then_some(true),
        }
    }
}
