// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The report of `palpate sweep`, as text and as JSON.

use std::io::Write;

use palpate::query::{FirstTouch, Start, Stop};
use serde_json::{Value, json};

use super::{Pair, Question};
use crate::bound_fields::BoundFields;
use crate::contact::as_json;
use crate::numbers::{decimals, rounded};
use crate::outcome::Failure;
use crate::output::{self, counted, shown};

/// The pairs of a scene, the first touch first.
pub(super) struct Report<'a, const D: usize> {
    pub(super) question: &'a Question,
    /// The names of the bodies.
    pub(super) names: &'a [&'a str],
    pub(super) bounds: &'a BoundFields,
    /// Those that are listed.
    pub(super) pairs: &'a [Pair<D>],
    /// How many pairs are apart, listed or not.
    pub(super) apart: usize,
    /// Of how many pairs both bodies have no bounds.
    pub(super) unbounded: usize,
}

impl<const D: usize> Report<'_, D> {
    pub(super) fn print(&self) -> Result<(), Failure> {
        let mut out = output::answer();
        for pair in self.pairs {
            writeln!(out, "{}", self.in_words(pair))?;
        }
        let touch = self.pairs.iter().filter(|pair| pair.found.touches() == Some(true));
        self.bounds.say(&mut out, self.names, touch.map(|pair| pair.bodies))?;
        let count =
            |touches| self.pairs.iter().filter(|pair| pair.found.touches() == touches).count();
        writeln!(
            out,
            "{} until {} s: {} (separation up to {} m), {} apart, {} undecided",
            counted(self.names.len(), "body", "bodies"),
            rounded(self.question.until),
            counted(count(Some(true)), "pair touches", "pairs touch"),
            rounded(self.question.settings.gap),
            self.apart,
            count(None),
        )?;
        if self.unbounded > 0 {
            let pairs = counted(self.unbounded, "pair", "pairs");
            writeln!(
                out,
                "{pairs} not searched: both bodies have no bounds, and no search ends"
            )?;
        }
        Ok(())
    }

    pub(super) fn in_words(&self, pair: &Pair<D>) -> String {
        let [a, b] = pair.bodies.map(|body| shown(self.names[body]));
        let found = &pair.found;
        let cost = counted(found.evaluations, "evaluation", "evaluations");
        let what = match (found.touches(), found.start) {
            (Some(false), _) => {
                "apart all the time by more than half of the gap, proven".to_owned()
            }
            (Some(true), Some(start)) if found.upper == 0.0 => {
                format!("touching at the start, {}", in_a_word(start))
            }
            (Some(true), _) => {
                let proven = format!("touching at {:.9} s{}", found.upper, apart_before(found));
                if found.stop.is_early() {
                    format!("{proven}; they may touch earlier: {}", self.why(found.stop))
                } else {
                    proven
                }
            }
            (None, _) => format!("undecided{}; {}", apart_before(found), self.why(found.stop)),
        };
        let mut words = format!("{a} – {b}: {what} ({cost})");
        if let Some(contact) = &found.contact {
            words += &format!(
                "\n    gap {} mm  at ({})  normal ({})",
                rounded(1e3 * contact.gap),
                decimals(&contact.point_a.0, 6),
                decimals(&contact.normal.0, 6)
            );
        }
        if let (Some(local), Some(search)) = (&pair.local, &self.question.local) {
            let cost = counted(local.evaluations, "evaluation", "evaluations");
            let what = match &local.touch {
                Some(touch) => {
                    format!("a touch at {:.9} s, {}", touch.time, against(touch.time, found))
                }
                None if found.touches() == Some(true) => "no touch: missed".to_owned(),
                None => "no touch, which proves nothing".to_owned(),
            };
            words += &format!("\n    {} finds {what} ({cost})", search.name());
        }
        words
    }

    fn why(&self, stop: Stop) -> String {
        match stop {
            Stop::BudgetSpent => format!(
                "the budget of {} evaluations is spent; raise --budget, --tolerance or --gap",
                self.question.settings.budget
            ),
            Stop::MemoryFull => {
                "the memory for waiting boxes is full, as where large surfaces slide closely past each \
                 other; raise --tolerance or --gap, or ask palpate contact at single times by --time"
                    .to_owned()
            }
            _ => "no closer bounds of their separation are found; raise --gap".to_owned(),
        }
    }

    /// Writes infinite times as null.
    pub(super) fn print_json(&self) -> Result<(), Failure> {
        let pairs: Vec<_> = self.pairs.iter().map(|pair| self.described(pair)).collect();
        output::answer().json(&json!({
            "until_s": self.question.until,
            "gap_m": self.question.settings.gap,
            "budget": self.question.settings.budget,
            "bodies": self.names,
            "apart": self.apart,
            "unbounded": self.unbounded,
            "pairs": pairs,
        }))?;
        Ok(())
    }

    fn described(&self, pair: &Pair<D>) -> Value {
        let found = &pair.found;
        json!({
            "bodies": pair.bodies.map(|body| self.names[body]),
            "verdict": match found.touches() {
                Some(true) => "touching",
                Some(false) => "apart",
                None => "undecided",
            },
            "lower_s": found.lower,
            "upper_s": found.upper,
            "start": found.start.map(in_a_word),
            "contact": found.contact.as_ref().map(as_json),
            "tolerance_s": self.question.tolerance_in(pair.part),
            "stop": found.stop.to_string(),
            "evaluations": found.evaluations,
            "local": pair.local.as_ref().zip(self.question.local.as_ref()).map(|(local, search)| {
                json!({
                    "method": search.name(),
                    "time_s": local.touch.map(|touch| touch.time),
                    "point_m": local.touch.map(|touch| touch.point.0.to_vec()),
                    "value_m": local.touch.map(|touch| touch.value),
                    "searched": local.searched,
                    "evaluations": local.evaluations,
                })
            }),
        })
    }
}

/// Until when bodies are proven apart, if they are at all.
fn apart_before<const D: usize>(found: &FirstTouch<D>) -> String {
    let words =
        || format!("; before {:.9} s apart by more than half of the gap, proven", found.lower);
    if found.lower > 0.0 { words() } else { String::new() }
}

/// How a time that a local search found stands to the proven ones.
fn against<const D: usize>(time: f64, found: &FirstTouch<D>) -> String {
    let (late, early) = (time - found.upper, found.lower - time);
    match () {
        () if late > 0.0 && late.is_finite() => format!("late by {late:.3e} s"),
        () if early > 0.0 => {
            format!("early by {early:.3e} s: the elements of its surface lie off the body")
        }
        () if found.stop.is_early() => "between bounds that are far apart".to_owned(),
        () => "within the proven bounds".to_owned(),
    }
}

fn in_a_word(start: Start) -> &'static str {
    match start {
        Start::Approaching => "approaching",
        Start::Receding => "receding",
        Start::Sliding => "sliding",
        Start::Resting => "resting",
    }
}
