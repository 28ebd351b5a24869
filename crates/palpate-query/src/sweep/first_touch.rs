// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The first touch of what moves: how exactly it is asked for, the answer, its proof.

use std::fmt;

use palpate_field::{Aabb, Pose, Vector};

use super::motion::Moving;
use super::pair::{SweepWorkspace, swept};
use crate::certified::Stop;
use crate::contact::Contact;
use crate::error::QueryError;

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
    /// Before this time the bodies are proven apart, rounding included: their separation is
    /// more than half of the gap. Of an element or a mesh, the field is more than half of the
    /// gap at every point.
    pub lower: f64,
    /// At this time the separation is at most the gap. Infinite if no touch was found; the end
    /// of the time if the bodies are proven apart all the time.
    pub upper: f64,
    /// The deepest contact at `upper`; `None` if there is none.
    pub contact: Option<Contact<D>>,
    /// How the bodies move on, if they touch at the start and a field gives the normal there.
    pub start: Option<Start>,
    /// Why the search stopped: `converged` at a touch, `sign_known` if there is none.
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

/// Bodies that are apart by more than this share of the gap are free. It is less than one: a separation
/// that is known to a quarter of the gap proves a touch, or a step without one.
pub(super) const FREE: f64 = 0.5;

/// How often the time between the bounds is halved in the end, to find an earlier touch.
pub(super) const HALVES: u32 = 8;

/// How exactly a first touch is asked for.
///
/// ```
/// use palpate_query::SweepSettings;
///
/// let settings = SweepSettings { time_tolerance: 1e-6, ..SweepSettings::of_size(0.2) };
/// assert_eq!((settings.gap, settings.time_tolerance), (2e-7, 1e-6));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepSettings {
    /// Bodies whose separation is at most this touch [m]; those more than half of it apart may be called
    /// apart.
    pub gap: f64,
    /// How far apart the bounds of the time may be, as a share of the motion, which takes the time from 0
    /// to 1.
    pub time_tolerance: f64,
    /// How often the search in boxes evaluates fields at most; a round may exceed it. Conservative
    /// advancement and samples after an early end, and the contact, may use about as many again.
    pub budget: u32,
}

impl SweepSettings {
    /// The budget unless another is given.
    pub const BUDGET: u32 = 5_000_000;

    /// For bodies of a size [m]: a gap of a millionth of it, times to 1e-4 of the motion.
    #[must_use]
    pub const fn of_size(size: f64) -> Self {
        Self { gap: 1e-6 * size, time_tolerance: 1e-4, budget: Self::BUDGET }
    }

    /// A field that is at most this at a point of an element touches it [m].
    pub(super) fn touch_level(&self) -> f64 {
        (1.0 - FREE) * self.gap
    }

    /// Why a search ends that knows these bounds of the time; `None` if it goes on.
    pub(super) fn decided(&self, lower: f64, upper: f64) -> Option<Stop> {
        if upper < f64::INFINITY && lower >= upper - self.time_tolerance {
            return Some(Stop::Converged);
        }
        (lower >= 1.0).then_some(Stop::SignKnown)
    }

    pub(crate) fn check(&self) -> Result<(), QueryError> {
        for (what, value) in [("gap", self.gap), ("time_tolerance", self.time_tolerance)] {
            let limit = palpate_field::LARGEST_LENGTH;
            // Written so that NaN is refused.
            if !(value > 0.0 && value <= limit) {
                return Err(QueryError::Setting { what, value });
            }
        }
        Ok(())
    }
}

/// A box that is free before a time: no point of it is in both bodies, nor within a quarter of the gap
/// of both.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreeBox<const D: usize> {
    /// The box, in the coordinates of a body.
    pub aabb: Aabb<D>,
    /// Before this time it is free; 1 if it is all the time.
    pub until: f64,
}

/// When two bodies touch first, and the boxes that prove it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SweepProof<const D: usize> {
    /// The answer, as [`sweep`](crate::sweep) gives it.
    pub answer: FirstTouch<D>,
    /// The body in whose coordinates the boxes are: 0 or 1.
    pub body: usize,
    /// From the coordinates of that body to the world's, at the answer's upper time.
    pub world_from_boxes: Pose<D>,
    /// Boxes that hold the body but for what its own field proves free. Each is free before its own time.
    /// That is at least the answer's lower one, unless the search went on by conservative advancement:
    /// the answer's lower time is then proven by separations.
    pub boxes: Vec<FreeBox<D>>,
}

/// When two bodies that move touch first, as [`sweep`](crate::sweep), with its proof.
///
/// ```
/// use palpate_field::{Pose, Screw, Shape};
/// use palpate_query::{Moving, SweepSettings, SweepWorkspace, sweep_proof};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let block = Shape::<2>::cuboid([1.0, 1.0])?;
/// let [from, to] = [3.0, 0.0].map(|y| Pose::translation([0.0, y]));
/// let falling = Moving::new(&block, Screw::new(from, to, 0)?);
/// let settings = SweepSettings::of_size(1.0);
/// let proof = sweep_proof(&block, falling, &settings, &mut SweepWorkspace::new())?;
/// let lower = proof.answer.lower;
/// assert!(!proof.boxes.is_empty() && proof.boxes.iter().all(|part| part.until >= lower));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// As of [`sweep`](crate::sweep).
pub fn sweep_proof<'a, const D: usize>(
    a: impl Into<Moving<'a, D>>,
    b: impl Into<Moving<'a, D>>,
    settings: &SweepSettings,
    workspace: &mut SweepWorkspace<D>,
) -> Result<SweepProof<D>, QueryError> {
    let bodies = [a.into(), b.into()];
    let mut boxes = Vec::new();
    let (answer, body) = swept(bodies, settings, workspace, Some(&mut boxes))?;
    let world_from_boxes = bodies[body].motion.pose(answer.upper.min(1.0));
    Ok(SweepProof { answer, body, world_from_boxes, boxes })
}
