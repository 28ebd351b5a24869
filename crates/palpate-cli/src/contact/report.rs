// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The report of `palpate contact`, as text and as JSON.

use std::io::Write;

use palpate::query::Verdict;
use serde_json::{Value, json};

use super::question::{Pair, Question};
use crate::outcome::Failure;
use crate::output::{self, shown};

/// The pairs of a scene, to be reported.
pub(super) struct Report<'a, const D: usize> {
    pub(super) question: &'a Question,
    /// The names of the bodies.
    pub(super) names: &'a [&'a str],
    pub(super) pairs: &'a [Pair<D>],
}

impl<const D: usize> Report<'_, D> {
    pub(super) fn print(&self) -> Result<(), Failure> {
        let mut out = output::answer();
        for pair in self.pairs {
            let [a, b] = pair.bodies.map(|i| shown(self.names[i]));
            write!(out, "{a} – {b}: {}", pair.verdict)?;
            match &pair.separation {
                Some(found) => writeln!(
                    out,
                    ", separation {} to {} mm ({}, {} evaluations)",
                    millimetres(found.lower),
                    millimetres(found.upper),
                    found.stop,
                    found.evaluations
                )?,
                None => writeln!(out, ": undecided, neither has bounds")?,
            }
            if pair.verdict == Verdict::Apart {
                continue;
            }
            for contact in &pair.contacts {
                writeln!(
                    out,
                    "  {:>3}  gap {} mm  at ({})  normal ({})",
                    contact.id,
                    millimetres(contact.gap),
                    joined(contact.point_a.0, 6),
                    joined(contact.normal.0, 4)
                )?;
            }
            if pair.dropped > 0 {
                writeln!(out, "       and {} more within these", pair.dropped)?;
            }
            if !pair.is_whole {
                writeln!(
                    out,
                    "       and maybe others: the budget of {} evaluations is spent; raise --budget or --spacing",
                    self.question.settings.limits.budget
                )?;
            }
        }
        let count = |verdict| self.pairs.iter().filter(|pair| pair.verdict == verdict).count();
        let [touching, open] = [Verdict::Touching, Verdict::Undecided].map(count);
        let bodies = self.names.len();
        let apart = bodies * bodies.saturating_sub(1) / 2 - touching - open;
        writeln!(
            out,
            "{bodies} bodies: {touching} pairs touch (gap up to {} mm), {apart} are apart, {open} undecided",
            millimetres(self.question.settings.manifold.margin)
        )?;
        Ok(())
    }

    /// Writes infinite bounds as null.
    pub(super) fn print_json(&self) -> Result<(), Failure> {
        let settings = &self.question.settings;
        let pairs: Vec<Value> = self.pairs.iter().map(|pair| self.described(pair)).collect();
        let answer = json!({
            "margin_m": settings.manifold.margin,
            "spacing_m": settings.manifold.spacing,
            "tolerance_m": settings.limits.tolerance,
            "bodies": self.names,
            "pairs": pairs,
        });
        output::answer().json(&answer)?;
        Ok(())
    }

    fn described(&self, pair: &Pair<D>) -> Value {
        let contacts: Vec<Value> = pair
            .contacts
            .iter()
            .map(|contact| {
                json!({
                    "id": contact.id,
                    "gap_m": contact.gap,
                    "point_a_m": contact.point_a.0.to_vec(),
                    "point_b_m": contact.point_b.0.to_vec(),
                    "normal": contact.normal.0.to_vec(),
                })
            })
            .collect();
        let mut said = json!({
            "bodies": pair.bodies.map(|i| self.names[i]),
            "verdict": pair.verdict.to_string(),
            "dropped": pair.dropped,
            "is_whole": pair.is_whole,
            "groups": pair.groups,
        });
        let key = if pair.verdict == Verdict::Apart { "witnesses" } else { "contacts" };
        said[key] = json!(contacts);
        if let Some(found) = &pair.separation {
            said["separation_m"] = json!({ "lower": found.lower, "upper": found.upper });
            said["stop"] = json!(found.stop.to_string());
            said["evaluations"] = json!(found.evaluations);
        }
        said
    }
}

fn millimetres(length: f64) -> String {
    format!("{:.4}", 1e3 * length)
}

fn joined<const D: usize>(numbers: [f64; D], digits: usize) -> String {
    // Adding zero turns −0 into 0.
    numbers.map(|x| format!("{:.digits$}", x + 0.0)).join(", ")
}
