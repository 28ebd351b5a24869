// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Advice from the measured lateness of loops.

use palpate::servo_loop::{Distribution, Priority};

use super::{Measured, Waiting};
use crate::output::microseconds;

/// A loop is steady if 99 % of its ticks are late by at most this share of a period, and 99.9 % by
/// at most a period. Then forces are held for about the period that the passivity of a wall
/// assumes.
const STEADY: f64 = 0.1;

/// One loop is better than another if its lateness is at most this share of the other's.
const BETTER: f64 = 0.5;

/// The system throttled a loop that was late by this much [s]: Linux throttles real-time
/// threads for 50 ms.
const HELD_BACK: f64 = 0.045;

/// Fewer ticks do not give a quantile of 99.9 %.
const ENOUGH: u64 = 1000;

/// Advice in sentences, at least one.
pub(super) fn advice(measured: &[Measured], priority: &Priority, rate: f64) -> Vec<String> {
    let period = 1.0 / rate;
    let [Some(normal), raised] = [false, true].map(|is_raised| Ways::of(measured, is_raised))
    else {
        return vec!["measure for longer: the loops had no tick".to_owned()];
    };
    let is_worth_it = |raised: &Ways<'_>| is_better(raised.mixed.p999, normal.mixed.p999);
    let mut advice = vec![about_priority(&normal, raised.as_ref(), priority)];
    // Further advice is for the priority advised here.
    let best = raised.as_ref().filter(|raised| is_worth_it(raised)).unwrap_or(&normal);
    advice.push(way_to_wait(best, period));
    // A loop that does not sleep is late only if the system takes its processor away.
    let taken = best.spin.max.min(best.mixed.max);
    if taken > period {
        advice.push(format!(
            "the processor was taken away for {} from loops that did not sleep: stop other \
             programs; give a virtual machine its own processors, or use a physical one",
            microseconds(taken),
        ));
    }
    if let Some(held_back) = raised.map(|raised| raised.spin.max)
        && held_back >= HELD_BACK
    {
        advice.push(format!(
            "never spin alone with a raised priority: the system stopped the loop for {}, as \
             Linux does to real-time threads that do not sleep (sched_rt_runtime_us)",
            microseconds(held_back),
        ));
    }
    if normal.sleep.count < ENOUGH {
        advice.push(format!(
            "measure for longer: {} ticks per loop are too few to show rare delays",
            normal.sleep.count,
        ));
    }
    advice
}

/// Loops of one priority.
struct Ways<'a> {
    sleep: &'a Distribution,
    mixed: &'a Distribution,
    spin: &'a Distribution,
    is_raised: bool,
}

impl<'a> Ways<'a> {
    fn of(measured: &'a [Measured], is_raised: bool) -> Option<Self> {
        let find = |waiting| {
            let is_it = |m: &&Measured| m.waiting == waiting && m.is_raised == is_raised;
            measured.iter().find(is_it)?.lateness.times.as_ref()
        };
        Some(Self {
            sleep: find(Waiting::Sleep)?,
            mixed: find(Waiting::SleepThenSpin)?,
            spin: find(Waiting::Spin)?,
            is_raised,
        })
    }
}

fn is_better(a: f64, b: f64) -> bool {
    a <= BETTER * b
}

/// Chooses by the 99 % quantiles the steady way to wait that costs the least power.
fn way_to_wait(ways: &Ways<'_>, period: f64) -> String {
    let Ways { sleep, mixed, spin, is_raised } = ways;
    let is_steady = |times: &Distribution| times.p99 <= STEADY * period && times.p999 <= period;
    let p99 = |times: &Distribution| microseconds(times.p99);
    let with = if *is_raised { "with it, " } else { "" };
    // What is told of a way to wait that is left for another.
    let both = |times: &Distribution| {
        format!("{} (99 %) and {} (99.9 %)", p99(times), microseconds(times.p999))
    };
    if is_steady(sleep) {
        let (sleep, mixed) = (p99(sleep), p99(mixed));
        format!(
            "{with}sleep alone suffices: 99 % of the ticks are at most {sleep} late, or {mixed} \
             if the loop spins after sleeping, as the servo does"
        )
    } else if is_steady(mixed) {
        let (from, to) = (both(sleep), both(mixed));
        format!("{with}sleep, then spin, as the servo does: lateness is {to}, not {from}")
    } else if is_steady(spin) || is_better(spin.p99, mixed.p99) {
        let (from, to) = (both(mixed), both(spin));
        format!("{with}spin alone: lateness is {to}, not {from}; it occupies a processor")
    } else {
        let least =
            |of: fn(&Distribution) -> f64| microseconds(of(sleep).min(of(mixed)).min(of(spin)));
        format!(
            "{with}no way to wait is steady here: 1 % of the ticks are more than {} late, and 0.1 % \
             more than {}, for a period of {}; stop other programs, or lower the rate",
            least(|times| times.p99),
            least(|times| times.p999),
            microseconds(period),
        )
    }
}

fn about_priority(normal: &Ways<'_>, raised: Option<&Ways<'_>>, priority: &Priority) -> String {
    match (raised, priority) {
        (Some(raised), _) => {
            let [from, to] = [normal, raised].map(|ways| ways.mixed.p999);
            let is_lower = is_better(to, from);
            let (from, to) = (microseconds(from), microseconds(to));
            if is_lower {
                format!(
                    "raise the priority (`with_raised_priority` of `ThreadOptions`, which is on by \
                     default; `raise_priority` in a thread of your own): lateness (99.9 %) falls from \
                     {from} to {to}"
                )
            } else {
                format!(
                    "a raised priority changes little: lateness (99.9 %) is {from}, and {to} with it"
                )
            }
        }
        (None, Priority::Refused { .. }) => {
            "allow a raised priority and measure again: on Linux by CAP_SYS_NICE, or by a limit \
             rtprio in /etc/security/limits.conf"
                .to_owned()
        }
        (None, _) => "a raised priority was not measured".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use palpate::servo_loop::Lateness;

    use super::*;

    fn loop_of(waiting: Waiting, is_raised: bool, us: [u64; 3]) -> Measured {
        let [p99, p999, max] = us.map(|us| us as f64 / 1e6);
        let mut times = Distribution::default();
        times.count = 5000;
        (times.p99, times.p999, times.max) = (p99, p999, max);
        let mut lateness = Lateness::default();
        lateness.times = Some(times);
        lateness.missed = u64::from(max > 1e-3);
        Measured { waiting, is_raised, lateness }
    }

    fn said(loops: &[Measured], priority: &Priority, words: &[&str]) {
        let advice = advice(loops, priority, 1000.0);
        assert_eq!(advice.len(), words.len(), "{advice:?}");
        for (sentence, start) in advice.iter().zip(words) {
            assert!(sentence.starts_with(start), "{sentence}");
        }
    }

    #[test]
    fn the_least_way_that_is_steady_is_advised() {
        let refused = Priority::Refused { reason: String::new() };
        let of = |us: [u64; 3]| {
            Waiting::ALL.iter().zip(us).map(|(w, us)| loop_of(*w, false, [us, 2 * us, 3 * us]))
        };
        let of = |us| of(us).collect::<Vec<_>>();
        said(&of([90, 5, 5]), &refused, &["allow", "sleep alone"]);
        said(&of([150, 5, 5]), &refused, &["allow", "sleep, then spin"]);
        said(&of([300, 150, 20]), &refused, &["allow", "spin alone"]);
        said(&of([300, 200, 190]), &refused, &["allow", "no way"]);
    }

    #[test]
    fn priority_and_load_are_judged_by_what_they_did() {
        let of = |is_raised, us: [u64; 3]| Waiting::ALL.map(|w| loop_of(w, is_raised, us));
        let both = |normal, raised| [of(false, normal), of(true, raised)].concat();
        let raised = Priority::Raised;
        let words = ["raise the priority", "with it, sleep alone"];
        said(&both([500, 900, 2000], [50, 100, 950]), &raised, &words);
        let words = ["a raised priority changes little", "sleep alone", "the processor was"];
        said(&both([75, 900, 2000], [50, 800, 950]), &raised, &words);
        let mut held_back = both([75, 900, 950], [50, 100, 950]);
        held_back[5] = loop_of(Waiting::Spin, true, [1, 60, 50_000]);
        let words = ["raise the priority", "with it, sleep alone", "never spin alone"];
        said(&held_back, &raised, &words);
    }

    /// "Sleep alone suffices" once stood beside a lateness of 4874 µs in one tick of a thousand.
    #[test]
    fn a_way_with_rare_ticks_beyond_a_period_does_not_suffice() {
        let refused = Priority::Refused { reason: String::new() };
        let of = |p999: [u64; 3]| {
            let ways = Waiting::ALL.iter().zip(p999);
            ways.map(|(w, us)| loop_of(*w, false, [90, us, us])).collect::<Vec<_>>()
        };
        said(&of([4874, 500, 900]), &refused, &["allow", "sleep, then spin"]);
        let words = ["allow", "no way to wait is steady here", "the processor was"];
        said(&of([4874, 4000, 3000]), &refused, &words);
        let advice = advice(&of([4874, 4000, 3000]), &refused, 1000.0);
        assert!(advice[1].contains("0.1 % more than 3000.00 µs"), "{}", advice[1]);
    }

    #[test]
    fn no_tick_asks_for_more() {
        said(&[], &Priority::Normal, &["measure for longer"]);
    }
}
