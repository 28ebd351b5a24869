// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whether a ball touches a scene, with a proof, beside the memoir's test f(C) < r (section 3.1).

use std::fmt;

use palpate_field::{LARGEST_LENGTH, Point, Quality, Shape};
use palpate_query::{
    AtPoint, BallWorkspace, Certified, Contact, Limits, QueryError, Stop, contact_ball,
    touches_ball,
};
use serde::Serialize;

use super::AskError;
use crate::build::BuiltScene;
use crate::text::joined;

/// How far apart the bounds of a gap may be, as a share of the scene's longest edge.
const TOLERANCE: f64 = 1e-4;

/// The same question about balls of one radius.
#[derive(Clone, Copy, Debug)]
pub struct Balls<'a, const D: usize> {
    shape: &'a Shape<D>,
    radius: f64,
    /// The longest edge of the scene's box, if it has one [m].
    size: Option<f64>,
}

impl<'a, const D: usize> Balls<'a, D> {
    /// Questions about balls of this radius [m] and the bodies of a scene.
    ///
    /// # Errors
    ///
    /// [`AskError::Refused`] for a radius out of range.
    pub fn new(scene: &'a BuiltScene<D>, radius: f64) -> Result<Self, AskError> {
        if !(0.0..=LARGEST_LENGTH).contains(&radius) {
            let rule = format!("from 0 m to {LARGEST_LENGTH:e} m, got {radius:?} m");
            return Err(AskError::Refused(format!("the radius must be {rule}")));
        }
        let longest = |half: &[f64]| 2.0 * half.iter().copied().fold(0.0, f64::max);
        let size = scene.bounds().map(|bounds| longest(&bounds.half_extents().0));
        Ok(Self { shape: &scene.whole, radius, size })
    }

    /// Asks about the ball around a point.
    ///
    /// # Errors
    ///
    /// [`AskError::Query`] for a point out of range.
    pub fn ask(
        &self,
        at: &AtPoint<D>,
        workspace: &mut BallWorkspace<D>,
    ) -> Result<BallAnswer<D>, AskError> {
        let found = self.search(at, workspace)?;
        let touches = found.is_hit();
        let is_test = at.distance < self.radius;
        Ok(BallAnswer {
            radius: self.radius,
            touches,
            lower: found.lower,
            upper: found.upper,
            contact: found.best,
            stop: found.stop,
            evaluations: found.evaluations,
            value: at.distance,
            quality: at.quality,
            memoir_test: is_test,
            memoir_test_is_right: touches.map(|touches| touches == is_test),
        })
    }

    /// The gap. If the bounds straddle zero, a second search goes on until the sign is known.
    fn search(
        &self,
        at: &AtPoint<D>,
        workspace: &mut BallWorkspace<D>,
    ) -> Result<Certified<Option<Contact<D>>>, QueryError> {
        let Self { shape, radius, size } = *self;
        // Without bounds, the ball and its distance are the only lengths there are.
        let size = size.unwrap_or(2.0 * radius + at.distance.abs());
        let limits = Limits::new(TOLERANCE * size);
        let mut found = contact_ball(shape, at.point, radius, &limits, workspace)?;
        if found.is_hit().is_none() {
            let limits = limits.with_tolerance(0.0);
            let sign = touches_ball(shape, at.point, radius, &limits, workspace)?;
            found.lower = found.lower.max(sign.lower);
            if sign.upper < found.upper {
                (found.upper, found.best) = (sign.upper, sign.best);
            }
            found.evaluations += sign.evaluations;
            found.stop = sign.stop;
        }
        Ok(found)
    }
}

/// Whether a ball touches a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct BallAnswer<const D: usize> {
    /// The radius of the ball [m].
    pub radius: f64,
    /// Whether it touches; `None` if neither is proven.
    pub touches: Option<bool>,
    /// The gap is at least this [m].
    pub lower: f64,
    /// The gap is at most this [m].
    pub upper: f64,
    /// The nearest points of the surface (a) and of the ball (b), if any were found.
    pub contact: Option<Contact<D>>,
    /// Why the search ended.
    pub stop: Stop,
    /// How often the field was evaluated.
    pub evaluations: u32,
    /// The field of the body at the centre [m].
    pub value: f64,
    /// What the field of the body promises at the centre.
    pub quality: Quality,
    /// The memoir's test: the value at the centre is less than the radius.
    pub memoir_test: bool,
    /// Whether the memoir's test gives the proven answer; `None` if none is proven.
    pub memoir_test_is_right: Option<bool>,
}

impl<const D: usize> BallAnswer<D> {
    /// The nearest point of the surface, if one was found [m].
    #[must_use]
    pub fn surface_point(&self) -> Option<Point<D>> {
        self.contact.map(|contact| contact.point_a)
    }

    /// What the memoir's test is worth here.
    fn verdict(&self) -> String {
        let promise = match self.quality {
            Quality::Exact => "exact",
            Quality::Bound => "a bound",
            Quality::Lipschitz => "neither exact nor a bound",
        };
        let verdict = match self.memoir_test_is_right {
            Some(true) => "right",
            Some(false) => "wrong",
            None => "not decided",
        };
        if self.value < 0.0 {
            return format!("{verdict}; the centre is inside");
        }
        let proves = match (self.quality, self.memoir_test) {
            (Quality::Exact, _) | (Quality::Bound, false) => "proves this",
            _ => "proves nothing",
        };
        format!("{verdict}; the field is {promise} outside, so it {proves}")
    }
}

impl<const D: usize> fmt::Display for BallAnswer<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { radius, lower, upper, evaluations, .. } = self;
        let said = said(self.touches);
        writeln!(f, "ball           of {radius} m: meets the scene: {said}")?;
        let bounds = joined(&[*lower, *upper]);
        writeln!(f, "gap            [{bounds}] m, proven ({evaluations} evaluations)")?;
        match self.contact {
            Some(contact) => {
                writeln!(f, "nearest        {} m on the surface", joined(&contact.point_a.0))?;
                writeln!(f, "               {} m on the ball", joined(&contact.point_b.0))?;
            }
            None => writeln!(f, "nearest        no surface found")?,
        }
        let test = if self.memoir_test { "yes" } else { "no" };
        writeln!(f, "f(C) < r       {test}: the memoir's test is {}", self.verdict())
    }
}

/// An answer that may be open.
fn said(answer: Option<bool>) -> &'static str {
    match answer {
        Some(true) => "yes",
        Some(false) => "no",
        None => "undecided",
    }
}
