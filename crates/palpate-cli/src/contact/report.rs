// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The report of `palpate contact`, as text and as JSON.

use std::io::Write;

use palpate::query::{Contact, NormalSource, Stop, Verdict};
use serde_json::{Value, json};

use super::question::{Pair, Question};
use crate::bound_fields::BoundFields;
use crate::numbers::{decimal, decimals};
use crate::outcome::Failure;
use crate::output::{self, counted, shown};

/// The pairs of a scene, to be reported.
pub(super) struct Report<'a, const D: usize> {
    pub(super) question: &'a Question,
    /// The names of the bodies.
    pub(super) names: &'a [&'a str],
    pub(super) bounds: &'a BoundFields,
    pub(super) pairs: &'a [Pair<D>],
    /// How many pairs were asked about.
    pub(super) count: usize,
    /// The time that was asked for [s].
    pub(super) time: Option<f64>,
    /// Whether no body moves.
    pub(super) is_still: bool,
}

impl<const D: usize> Report<'_, D> {
    pub(super) fn print(&self) -> Result<(), Failure> {
        let mut out = output::answer();
        if let Some(time) = self.time {
            let still = if self.is_still { ", as at any time: no body moves" } else { "" };
            writeln!(out, "at {time} s{still}")?;
        }
        for pair in self.pairs {
            writeln!(out, "{}", self.in_words(pair))?;
        }
        let tolerance = self.question.settings.limits.tolerance;
        let is_open = |pair: &Pair<D>| {
            pair.separation.is_some_and(|found| found.upper - found.lower > tolerance)
        };
        if self.pairs.iter().any(is_open) {
            writeln!(
                out,
                "Each separation lies between its bounds; of searches that ended early they may \
                 be farther apart than the tolerance, {} mm.",
                millimetres(tolerance)
            )?;
        }
        let is_above = |pair: &&Pair<D>| pair.separation.is_some_and(|found| found.upper > 0.0);
        let above = self.pairs.iter().filter(is_above).map(|pair| pair.bodies);
        self.bounds.say(&mut out, self.names, above)?;
        let count = |verdict| self.pairs.iter().filter(|pair| pair.verdict == verdict).count();
        let [touching, open] = [Verdict::Touching, Verdict::Undecided].map(count);
        writeln!(
            out,
            "{}: {} (gap up to {} mm), {} apart, {open} undecided",
            counted(self.names.len(), "body", "bodies"),
            counted(touching, "pair touches", "pairs touch"),
            millimetres(self.question.settings.manifold.margin),
            self.count - touching - open,
        )?;
        Ok(())
    }

    /// A pair with its contacts, a line each.
    fn in_words(&self, pair: &Pair<D>) -> String {
        let [a, b] = pair.bodies.map(|i| shown(self.names[i]));
        let mut words = format!("{a} – {b}: {}", pair.verdict);
        words += &match &pair.separation {
            Some(found) => {
                let digits = digits_of(found.upper - found.lower);
                format!(
                    ", separation {} to {} mm ({}; {} evaluations with its contacts)",
                    decimal(1e3 * found.lower, digits),
                    decimal(1e3 * found.upper, digits),
                    found.stop,
                    found.evaluations
                )
            }
            None => match pair.empty {
                Some(empty) => format!(", {} has no point", shown(self.names[empty])),
                None => ", neither has bounds; intersect one with a box".to_owned(),
            },
        };
        if let (Verdict::Undecided, Some(why)) = (pair.verdict, self.undecided(pair)) {
            words += &format!("\n       undecided: {why}");
        }
        if pair.verdict == Verdict::Apart {
            return words;
        }
        words.extend(pair.contacts.iter().map(contact_in_words));
        if pair.dropped > 0 {
            words += &format!("\n       and {} more within these", pair.dropped);
        }
        if let Some(why) = self.cut_off(pair.region_stop) {
            words += &format!("\n       and maybe others: {why}");
        }
        words
    }

    /// Why the bounds of a pair do not tell, and what helps.
    fn undecided(&self, pair: &Pair<D>) -> Option<String> {
        let found = pair.separation.as_ref()?;
        let settings = &self.question.settings;
        let (budget, margin) = (settings.limits.budget, settings.manifold.margin);
        Some(match found.stop {
            Stop::Converged | Stop::SignKnown if found.upper <= margin => format!(
                "fields are bounds there, and no points of both bodies within the margin of {} mm \
                 are found; they may be farther apart",
                millimetres(margin)
            ),
            Stop::BudgetSpent => {
                format!("the budget of {budget} evaluations is spent; raise --budget")
            }
            Stop::MemoryFull => {
                "the memory of the search is full, and a larger --budget does not \
                 help; another --margin may"
                    .to_owned()
            }
            Stop::RoundingReached => {
                "rounding allows no closer bounds; another --margin decides".to_owned()
            }
            Stop::Converged | Stop::SignKnown => format!(
                "the margin of {} mm lies between the bounds; lower --tolerance, or take another \
                 --margin",
                millimetres(margin)
            ),
        })
    }

    /// Why the region of contact was not searched to its end, and what helps; `None` if it was.
    fn cut_off(&self, stop: Stop) -> Option<String> {
        let budget = self.question.settings.limits.budget;
        match stop {
            Stop::Converged | Stop::SignKnown | Stop::RoundingReached => None,
            Stop::BudgetSpent => Some(format!(
                "the search for contacts spent its budget of {budget} evaluations; raise --budget \
                 or --spacing"
            )),
            Stop::MemoryFull => Some(
                "the memory of the search is full, and a larger --budget does not help; raise \
                 --spacing"
                    .to_owned(),
            ),
        }
    }

    /// Writes infinite bounds as null.
    pub(super) fn print_json(&self) -> Result<(), Failure> {
        let settings = &self.question.settings;
        let pairs: Vec<Value> = self.pairs.iter().map(|pair| self.described(pair)).collect();
        let mut answer = json!({
            "margin_m": settings.manifold.margin,
            "spacing_m": settings.manifold.spacing,
            "tolerance_m": settings.limits.tolerance,
            "budget": settings.limits.budget,
            "bodies": self.names,
            "pairs": pairs,
        });
        if let Some(time) = self.time {
            answer["time_s"] = json!(time);
        }
        output::answer().json(&answer)?;
        Ok(())
    }

    fn described(&self, pair: &Pair<D>) -> Value {
        let contacts: Vec<Value> = pair
            .contacts
            .iter()
            .map(|contact| {
                let mut said = as_json(contact);
                said["id"] = json!(contact.id);
                said
            })
            .collect();
        let mut said = json!({
            "bodies": pair.bodies.map(|i| self.names[i]),
            "verdict": pair.verdict.to_string(),
            "dropped": pair.dropped,
            "is_whole": !pair.region_stop.is_early(),
            "groups": pair.groups,
        });
        let key = if pair.verdict == Verdict::Apart { "witnesses" } else { "contacts" };
        said[key] = json!(contacts);
        if let Some(empty) = pair.empty {
            said["empty"] = json!(self.names[empty]);
        }
        if let Some(found) = &pair.separation {
            said["separation_m"] = json!({ "lower": found.lower, "upper": found.upper });
            said["distance_at_most_m"] = json!(pair.distance_at_most);
            said["stop"] = json!(found.stop.to_string());
            said["evaluations"] = json!(found.evaluations);
        }
        said
    }
}

/// A contact as JSON, but for its id.
pub(crate) fn as_json<const D: usize>(contact: &Contact<D>) -> Value {
    json!({
        "gap_m": contact.gap,
        "point_a_m": contact.point_a.0.to_vec(),
        "point_b_m": contact.point_b.0.to_vec(),
        "normal": contact.normal.0.to_vec(),
        "normal_from": contact.normal_from.to_string(),
        "on_surfaces": contact.on_surfaces,
    })
}

/// A contact, on a line that follows another.
fn contact_in_words<const D: usize>(contact: &Contact<D>) -> String {
    let from = match contact.normal_from {
        NormalSource::Gradients => String::new(),
        source => format!("  from {source}"),
    };
    let estimated = if contact.on_surfaces || contact.gap <= 0.0 { "" } else { " estimated" };
    format!(
        "\n  {:>3}  gap {} mm{estimated}  at ({})  normal ({}){from}",
        contact.id,
        millimetres(contact.gap),
        decimals(&contact.point_a.0, 6),
        decimals(&contact.normal.0, 4)
    )
}

/// Decimals of millimetres that tell numbers apart which differ by a length [m].
fn digits_of(length: f64) -> usize {
    (4..12).find(|&digits| 1e3 * length >= 10_f64.powi(-(digits as i32))).unwrap_or(12)
}

fn millimetres(length: f64) -> String {
    decimal(1e3 * length, 4)
}
