// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whether a ball about a point meets the scene, with a proof, beside the memoir's test
//! f(C) < r (section 3.1).

use std::io::{self, Write};

use palpate::field::{LARGEST_LENGTH, Point, Quality, Shape};
use palpate::query::{
    AtPoint, BallWorkspace, Certified, Contact, Limits, QueryError, contact_ball, touches_ball,
};
use palpate::scene::BuiltScene;
use serde_json::{Value, json};

use crate::input::{AXES, joined, longest_edge};
use crate::outcome::Failure;

/// How far apart the bounds of a gap may be, as a share of the scene's longest edge.
const TOLERANCE: f64 = 1e-4;

/// The same question about balls of one radius.
#[derive(Clone, Copy)]
pub(super) struct Balls<'a, const D: usize> {
    shape: &'a Shape<D>,
    radius: f64,
    /// The longest edge of the scene's box, if it has one [m].
    size: Option<f64>,
}

impl<'a, const D: usize> Balls<'a, D> {
    pub(super) fn of(scene: &'a BuiltScene<D>, radius: f64) -> Result<Self, Failure> {
        if !(0.0..=LARGEST_LENGTH).contains(&radius) {
            let rule = format!("from 0 m to {LARGEST_LENGTH:e} m, got {radius:?} m");
            return Err(Failure::input(format!("--radius must be {rule}")));
        }
        let size = scene.bounds().map(|bounds| longest_edge(&bounds));
        Ok(Self { shape: &scene.whole, radius, size })
    }

    /// Asks about the ball around a point.
    pub(super) fn ask(
        &self,
        at: &AtPoint<D>,
        workspace: &mut BallWorkspace<D>,
    ) -> Result<Ball<D>, Failure> {
        let found = self.search(at, workspace).map_err(Failure::input)?;
        let Self { radius, .. } = *self;
        Ok(Ball { radius, value: at.distance, quality: at.quality, found })
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

/// What is known of a ball.
pub(super) struct Ball<const D: usize> {
    radius: f64,
    /// The field at the centre [m], and what it promises there.
    value: f64,
    quality: Quality,
    found: Certified<Option<Contact<D>>>,
}

impl<const D: usize> Ball<D> {
    /// Whether the ball meets the scene; `None` if neither is proven.
    pub(super) fn meets(&self) -> Option<bool> {
        self.found.is_hit()
    }

    /// The nearest point of the surface, if one was found [m].
    pub(super) fn surface_point(&self) -> Option<Point<D>> {
        self.found.best.map(|contact| contact.point_a)
    }

    /// The memoir's test.
    fn test(&self) -> bool {
        self.value < self.radius
    }

    /// Whether the memoir's test gives the proven answer.
    fn is_test_right(&self) -> Option<bool> {
        self.meets().map(|meets| meets == self.test())
    }

    /// As JSON, where a bound that is infinite is `null`.
    pub(super) fn to_json(&self) -> Value {
        let contact = self.found.best;
        json!({
            "radius_m": self.radius,
            "meets": self.meets(),
            "gap_lower_m": self.found.lower,
            "gap_upper_m": self.found.upper,
            "surface_point_m": contact.map(|contact| contact.point_a.0.to_vec()),
            "ball_point_m": contact.map(|contact| contact.point_b.0.to_vec()),
            "stop": self.found.stop.to_string(),
            "evaluations": self.found.evaluations,
            "memoir_test": self.test(),
            "memoir_test_is_right": self.is_test_right(),
            "quality": self.quality.word(),
        })
    }

    pub(super) fn print(&self, out: &mut impl Write) -> io::Result<()> {
        let Certified { lower, upper, evaluations, .. } = self.found;
        writeln!(
            out,
            "ball           of {} m: meets the scene: {}",
            self.radius,
            said(self.meets())
        )?;
        let bounds = joined(&[lower, upper]);
        writeln!(out, "gap            [{bounds}] m, proven ({evaluations} evaluations)")?;
        match self.found.best {
            Some(contact) => {
                writeln!(
                    out,
                    "nearest        {} m on the surface",
                    joined(&contact.point_a.0)
                )?;
                writeln!(out, "               {} m on the ball", joined(&contact.point_b.0))?;
            }
            None => writeln!(out, "nearest        no surface found")?,
        }
        let test = said(Some(self.test()));
        writeln!(out, "f(C) < r       {test}: the memoir's test is {}", self.verdict())
    }

    /// What the memoir's test is worth here.
    fn verdict(&self) -> String {
        let promise = match self.quality {
            Quality::Exact => "exact",
            Quality::Bound => "a bound",
            Quality::Lipschitz => "neither exact nor a bound",
        };
        let verdict = match self.is_test_right() {
            Some(true) => "right",
            Some(false) => "wrong",
            None => "not decided",
        };
        if self.value < 0.0 {
            return format!("{verdict}; the centre is inside");
        }
        let proves = match (self.quality, self.test()) {
            (Quality::Exact, _) | (Quality::Bound, false) => "proves this",
            _ => "proves nothing",
        };
        format!("{verdict}; the field is {promise} outside, so it {proves}")
    }

    /// The columns of a row.
    pub(super) fn header() -> Vec<String> {
        let axes = &AXES[..D];
        let mut header =
            ["radius_m", "meets", "gap_lower_m", "gap_upper_m"].map(str::to_owned).to_vec();
        header.extend(axes.iter().map(|axis| format!("nearest_{axis}_m")));
        header.extend(axes.iter().map(|axis| format!("ball_{axis}_m")));
        header.extend(["memoir_test", "memoir_test_is_right"].map(str::to_owned));
        header
    }

    /// The row; what is not known is empty, and `meets` is `undecided`.
    pub(super) fn row(&self) -> Vec<String> {
        let mut row = vec![self.radius.to_string(), said(self.meets()).to_owned()];
        row.extend([self.found.lower, self.found.upper].map(|gap| gap.to_string()));
        match self.found.best {
            Some(contact) => {
                row.extend(contact.point_a.0.iter().map(f64::to_string));
                row.extend(contact.point_b.0.iter().map(f64::to_string));
            }
            None => row.extend(vec![String::new(); 2 * D]),
        }
        row.push(self.test().to_string());
        row.push(self.is_test_right().map_or_else(String::new, |right| right.to_string()));
        row
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
