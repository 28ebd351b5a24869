// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! When bodies that move by the motions of a scene touch first.

use std::fmt;
use std::sync::atomic::AtomicBool;

use palpate_query::{
    FirstTouch, Moving, Placed, Stop, SweepSettings, SweepWorkspace, Verdict, sweep,
};
use serde::{Deserialize, Serialize};

use super::{AskError, FEW_PAIRS, is_set, pairs_of, write_bound_fields};
use crate::Repeat;
use crate::build::BuiltScene;
use crate::text::{counted, decimals, rounded, shown};

/// The gap over the size of the smallest body.
const GAP: f64 = 1e-6;

/// The tolerance of times over the part of a motion in which bodies touch.
const TOLERANCE: f64 = 1e-4;

/// The most parts of motions that are looked at.
const MOST_PARTS: f64 = 1e5;

/// When do bodies that move touch first?
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct SweepQuestion {
    /// Only pairs with one of these bodies; all pairs if there are none.
    pub bodies: Vec<String>,
    /// Whether pairs that are apart are listed too. They always are where at most 66 pairs are
    /// asked about ([`FEW_PAIRS`]).
    pub every_pair: bool,
    /// The end of the time that is looked at [s]. Default: the end of the last motion. A motion
    /// that repeats counts as one period: a loop once through, one that goes back and forth there and
    /// back.
    pub until: Option<f64>,
    /// The largest separation at which bodies touch [m]. Default: a millionth of the smallest
    /// body. Separations between half of `gap` and `gap` may be reported as apart.
    pub gap: Option<f64>,
    /// How far apart the bounds of a time may be [s]; if left out, 1e-4 of the part of a motion
    /// that is searched.
    pub tolerance: Option<f64>,
    /// The most evaluations in the search of each pair in each part of a motion. Default: 5 000 000
    /// ([`SweepSettings::BUDGET`]).
    pub budget: Option<u32>,
}

/// When bodies that move touch first.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct SweepAnswer<const D: usize> {
    /// The end of the time that was looked at [s].
    pub until: f64,
    /// The largest separation at which bodies touch [m].
    pub gap: f64,
    /// The most evaluations for each pair and part of a motion.
    pub budget: u32,
    /// The names of all bodies.
    pub bodies: Vec<String>,
    /// Bodies whose fields are bounds outside: separations from others are lower bounds of
    /// distances.
    pub bound_fields: Vec<String>,
    /// How many pairs are apart all the time, listed or not.
    pub apart: usize,
    /// How many pairs were not searched, because both bodies have no bounds.
    pub unbounded: usize,
    /// The pairs of which one body moves at least, the first touch first.
    pub pairs: Vec<SweepPair<D>>,
    /// Whether no pair is missing; `false` if the search was stopped.
    pub is_whole: bool,
}

/// When two bodies touch first.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct SweepPair<const D: usize> {
    /// Their names.
    pub bodies: [String; 2],
    /// Their places in the scene.
    #[serde(skip)]
    pub indices: [usize; 2],
    /// Whether they touch.
    pub verdict: Verdict,
    /// When they touch; its times are in seconds.
    #[serde(flatten)]
    pub touch: FirstTouch<D>,
    /// How far apart the bounds of the time may be [s].
    pub tolerance: f64,
    /// The part of the motions that was searched last.
    #[serde(skip)]
    pub part: SweptPart,
    /// What a local search found, if one ran beside.
    pub local: Option<LocalFinding>,
}

/// A part of motions between two times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweptPart {
    /// Its start [s].
    pub from: f64,
    /// Its end [s].
    pub to: f64,
}

/// The first touch that a local search of the literature found, which proves nothing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LocalFinding {
    /// The name of the method.
    pub method: String,
    /// When it found a touch [s]; `None` if it found none.
    pub time: Option<f64>,
    /// Where [m].
    pub point: Option<Vec<f64>>,
    /// The value of the field there [m].
    pub value: Option<f64>,
    /// How many elements or starts were searched.
    pub searched: u32,
    /// How often fields were evaluated.
    pub evaluations: u32,
}

/// The question with its defaults filled in.
struct Search {
    until: f64,
    tolerance: Option<f64>,
    settings: SweepSettings,
}

impl SweepQuestion {
    pub(super) fn answer<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
        stop: &AtomicBool,
    ) -> Result<SweepAnswer<D>, AskError> {
        let search = self.search(scene)?;
        let asked = scene.numbers_of(&self.bodies)?;
        let times = scene.times_of_motion(search.until);
        let moving: Vec<usize> = scene.moving().collect();
        let count = scene.bodies.len();
        let is_every = self.every_pair || pairs_of(count, asked.len()) <= FEW_PAIRS;
        let mut answer = SweepAnswer {
            until: search.until,
            gap: search.settings.gap,
            budget: search.settings.budget,
            bodies: scene.names(),
            bound_fields: scene.bound_fields(),
            apart: 0,
            unbounded: 0,
            pairs: Vec::new(),
            is_whole: true,
        };
        let is_asked = |pair: &[usize; 2]| {
            (asked.is_empty() || pair.iter().any(|body| asked.contains(body)))
                && pair.iter().any(|body| moving.contains(body))
        };
        let all = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
        for indices in all.filter(is_asked) {
            if are_unbounded(scene, indices) {
                answer.unbounded += 1;
                continue;
            }
            let Some(pair) = search.first_touch(scene, indices, &times, stop)? else {
                answer.is_whole = false;
                break;
            };
            let is_apart = pair.verdict == Verdict::Apart;
            answer.apart += usize::from(is_apart);
            answer.pairs.extend((is_every || !is_apart).then_some(pair));
        }
        answer.pairs.sort_by(|a, b| a.touch.upper.total_cmp(&b.touch.upper));
        Ok(answer)
    }

    fn search<const D: usize>(&self, scene: &BuiltScene<D>) -> Result<Search, AskError> {
        let ends = scene.motions.iter().map(|motion| {
            let ways = if motion.repeat == Repeat::BackAndForth { 2.0 } else { 1.0 };
            motion.start + ways * motion.duration
        });
        let Some(end) = ends.reduce(f64::max) else {
            return Err(AskError::Refused(
                "sweep is about bodies that move, and there are no `motions`: give some to the \
                 scene, or a file of them by --motion; palpate contact tells where bodies at rest \
                 touch"
                    .to_owned(),
            ));
        };
        let until = self.until.unwrap_or(end);
        let parts: f64 = scene.motions.iter().map(|motion| motion.parts_until(until)).sum();
        if parts.is_nan() || parts > MOST_PARTS {
            return Err(AskError::Refused(format!(
                "until {until} s the motions have {parts:e} parts (repetitions, and turns of less \
                 than a half), of which {MOST_PARTS:e} are looked at; lower --until"
            )));
        }
        let usual = || GAP * smallest_diagonal(scene).unwrap_or(1.0);
        let settings = SweepSettings {
            gap: self.gap.unwrap_or_else(usual),
            budget: self.budget.unwrap_or(SweepSettings::BUDGET),
            ..SweepSettings::of_size(1.0)
        };
        Ok(Search { until, tolerance: self.tolerance, settings })
    }
}

/// The diagonal of the smallest bounded body [m].
fn smallest_diagonal<const D: usize>(scene: &BuiltScene<D>) -> Option<f64> {
    let bounds = scene.bodies.iter().filter_map(|body| body.shape.promise().bounds);
    bounds.map(|bounds| 2.0 * bounds.aabb.half_extents().norm()).reduce(f64::min)
}

impl Search {
    /// How far apart the bounds of a time in a part may be [s].
    fn tolerance_in(&self, part: SweptPart) -> f64 {
        self.tolerance.unwrap_or(TOLERANCE * (part.to - part.from))
    }

    /// When two bodies touch first; `None` if the search was stopped.
    fn first_touch<const D: usize>(
        &self,
        scene: &BuiltScene<D>,
        indices: [usize; 2],
        times: &[f64],
        stop: &AtomicBool,
    ) -> Result<Option<SweepPair<D>>, AskError> {
        let mut workspace = SweepWorkspace::new();
        let mut evaluations = 0_u32;
        let mut last = None;
        for part in times.windows(2) {
            let &[from, to] = part else { continue };
            if is_set(stop) {
                return Ok(None);
            }
            let part = SweptPart { from, to };
            let [a, b] = scene.ways(indices, part)?;
            let length = to - from;
            let time_tolerance = (self.tolerance_in(part) / length).min(1.0);
            let settings = SweepSettings { time_tolerance, ..self.settings };
            let mut touch = sweep(a, b, &settings, &mut workspace)?;
            evaluations = evaluations.saturating_add(touch.evaluations);
            touch.evaluations = evaluations;
            let verdict = match touch.touches() {
                Some(true) => Verdict::Touching,
                Some(false) => Verdict::Apart,
                None => Verdict::Undecided,
            };
            touch.lower = if touch.lower < 1.0 {
                // Rounded down: before it the bodies are apart.
                (from + length * touch.lower).next_down().max(from)
            } else {
                to
            };
            if touch.upper.is_finite() {
                touch.upper = (from + length * touch.upper).min(to);
            }
            let is_over = touch.stop != Stop::SignKnown;
            last = Some(SweepPair {
                bodies: indices.map(|body| scene.bodies[body].name.clone()),
                indices,
                verdict,
                touch,
                tolerance: self.tolerance_in(part),
                part,
                local: None,
            });
            if is_over {
                break;
            }
        }
        Ok(last)
    }
}

impl<const D: usize> BuiltScene<D> {
    /// Two bodies on their way in a part of the motions, over the time from 0 to 1.
    ///
    /// # Errors
    ///
    /// If a pose is out of range.
    #[inline(never)]
    pub fn ways(
        &self,
        indices: [usize; 2],
        part: SweptPart,
    ) -> Result<[Moving<'_, D>; 2], AskError> {
        let SweptPart { from, to } = part;
        let moving = |body: usize| {
            let shape = &self.bodies[body].shape_in_body;
            let way = self.way(body, from, to)?;
            let rest = || Placed::new(shape, self.pose_at(body, from)).into();
            Ok::<_, AskError>(way.map_or_else(rest, |way| Moving::new(shape, way)))
        };
        Ok([moving(indices[0])?, moving(indices[1])?])
    }
}

/// Whether both bodies have no bounds: no search of them ends.
fn are_unbounded<const D: usize>(scene: &BuiltScene<D>, bodies: [usize; 2]) -> bool {
    bodies.iter().all(|body| scene.bodies[*body].shape.promise().bounds.is_none())
}

impl<const D: usize> fmt::Display for SweepAnswer<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for pair in &self.pairs {
            self.write_pair(f, pair)?;
        }
        let touching = self.pairs.iter().filter(|pair| pair.verdict == Verdict::Touching);
        write_bound_fields(f, &self.bound_fields, touching.map(|pair| &pair.bodies))?;
        let count = |verdict| self.pairs.iter().filter(|pair| pair.verdict == verdict).count();
        writeln!(
            f,
            "{} until {} s: {} (separation up to {} m), {} apart, {} undecided",
            counted(self.bodies.len(), "body", "bodies"),
            rounded(self.until),
            counted(count(Verdict::Touching), "pair touches", "pairs touch"),
            rounded(self.gap),
            self.apart,
            count(Verdict::Undecided),
        )?;
        if self.unbounded > 0 {
            let pairs = counted(self.unbounded, "pair", "pairs");
            writeln!(
                f,
                "{pairs} not searched: both bodies have no bounds, and no search ends"
            )?;
        }
        Ok(())
    }
}

impl<const D: usize> SweepAnswer<D> {
    /// The settings of the search in the last part of a pair.
    #[must_use]
    pub fn settings(&self, pair: &SweepPair<D>) -> SweepSettings {
        SweepSettings {
            gap: self.gap,
            budget: self.budget,
            time_tolerance: (pair.tolerance / (pair.part.to - pair.part.from)).min(1.0),
        }
    }

    /// Writes what is known of a pair.
    ///
    /// # Errors
    ///
    /// [`fmt::Error`] if `f` refuses the text.
    pub fn write_pair(&self, f: &mut impl fmt::Write, pair: &SweepPair<D>) -> fmt::Result {
        let [a, b] = pair.bodies.each_ref().map(|name| shown(name));
        let touch = &pair.touch;
        let cost = counted(touch.evaluations, "evaluation", "evaluations");
        let what = match (pair.verdict, touch.start) {
            (Verdict::Apart, _) => {
                "apart all the time by more than half of the gap, proven".to_owned()
            }
            (Verdict::Touching, Some(start)) if touch.upper == 0.0 => {
                format!("touching at the start, {start}")
            }
            (Verdict::Touching, _) => {
                let proven = format!("touching at {:.9} s{}", touch.upper, apart_before(touch));
                if touch.stop.is_early() {
                    format!("{proven}; they may touch earlier: {}", self.why(touch.stop))
                } else {
                    proven
                }
            }
            (Verdict::Undecided, _) => {
                format!("undecided{}; {}", apart_before(touch), self.why(touch.stop))
            }
        };
        writeln!(f, "{a} – {b}: {what} ({cost})")?;
        if let Some(contact) = &touch.contact {
            writeln!(
                f,
                "    gap {} mm  at ({})  normal ({})",
                rounded(1e3 * contact.gap),
                decimals(&contact.point_a.0, 6),
                decimals(&contact.normal.0, 6)
            )?;
        }
        let Some(local) = &pair.local else { return Ok(()) };
        let cost = counted(local.evaluations, "evaluation", "evaluations");
        let what = match local.time {
            Some(time) => format!("a touch at {time:.9} s, {}", against(time, touch)),
            None if pair.verdict == Verdict::Touching => "no touch: missed".to_owned(),
            None => "no touch, which proves nothing".to_owned(),
        };
        writeln!(f, "    {} finds {what} ({cost})", local.method)
    }

    fn why(&self, stop: Stop) -> String {
        match stop {
            Stop::BudgetSpent => format!(
                "the budget of {} evaluations is spent; raise the budget, the tolerance or the gap",
                self.budget
            ),
            Stop::MemoryFull => {
                "the memory for waiting boxes is full, as where large surfaces slide closely past \
                 each other; raise the tolerance or the gap, or ask for contacts at single times"
                    .to_owned()
            }
            _ => "no closer bounds of their separation are found; raise the gap".to_owned(),
        }
    }
}

/// Until when bodies are proven apart, if they are at all.
fn apart_before<const D: usize>(touch: &FirstTouch<D>) -> String {
    let words =
        || format!("; before {:.9} s apart by more than half of the gap, proven", touch.lower);
    if touch.lower > 0.0 { words() } else { String::new() }
}

/// How a time that a local search found stands to the proven ones.
fn against<const D: usize>(time: f64, touch: &FirstTouch<D>) -> String {
    let (late, early) = (time - touch.upper, touch.lower - time);
    match () {
        () if late > 0.0 && late.is_finite() => format!("late by {late:.3e} s"),
        () if early > 0.0 => {
            format!("early by {early:.3e} s: the elements of its surface lie off the body")
        }
        () if touch.stop.is_early() => "between bounds that are far apart".to_owned(),
        () => "within the proven bounds".to_owned(),
    }
}
