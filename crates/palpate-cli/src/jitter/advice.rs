// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the lateness of loops suggests.

use palpate::haptics::{Distribution, Priority};

use super::{Measured, Waiting};
use crate::times::microseconds;

/// A loop is steady if 99 % of its ticks are late by at most this part of a period: a force is
/// then applied for about as long as the passivity of a wall assumes.
const STEADY: f64 = 0.1;

/// One loop is better than another if its lateness is at most this part of the other's.
const BETTER: f64 = 0.5;

/// Fewer ticks say nothing of one in a thousand.
const ENOUGH: u64 = 1000;

/// What to do, in sentences; there is one at least.
pub(super) fn advice(measured: &[Measured], priority: &Priority, rate: f64) -> Vec<String> {
    let period_ns = 1e9 / rate;
    let find = |waiting, is_raised| {
        measured.iter().find_map(|m| {
            let times = m.lateness.times.as_ref();
            times.filter(|_| m.waiting == waiting && m.is_raised == is_raised)
        })
    };
    let ways = Waiting::ALL.map(|waiting| find(waiting, false));
    let [Some(sleep), Some(mixed), Some(spin)] = ways else {
        return vec!["measure for longer: there was no tick".to_owned()];
    };
    let mut advice = vec![way_to_wait([sleep, mixed, spin], period_ns)];
    advice.push(about_priority(mixed, find(Waiting::SleepThenSpin, true), priority));
    // Nobody is late who does not sleep, unless the processor is taken away.
    let taken_ns = spin.max_ns.min(mixed.max_ns);
    if taken_ns as f64 > period_ns {
        advice.push(format!(
            "the processor was taken away for {} from loops that were awake: end other load; \
             in a virtual machine, give it processors of its own, or use a real one",
            microseconds(taken_ns),
        ));
    }
    if sleep.count < ENOUGH {
        advice.push(format!(
            "measure for longer: {} ticks a loop say little of rare delays",
            sleep.count,
        ));
    }
    advice
}

fn is_better(a_ns: u64, b_ns: u64) -> bool {
    a_ns as f64 <= BETTER * b_ns as f64
}

/// By their 99 %: the least that is steady costs the least power.
fn way_to_wait([sleep, mixed, spin]: [&Distribution; 3], period_ns: f64) -> String {
    let is_steady = |times: &Distribution| times.p99_ns as f64 <= STEADY * period_ns;
    let p99 = |times: &Distribution| microseconds(times.p99_ns);
    if is_steady(sleep) {
        format!("sleep alone will do: 99 % of the ticks are at most {} late", p99(sleep))
    } else if is_steady(mixed) {
        let (from, to) = (p99(sleep), p99(mixed));
        format!("sleep, then spin, as the servo does: it brings the 99 % from {from} to {to}")
    } else if is_steady(spin) || is_better(spin.p99_ns, mixed.p99_ns) {
        let (from, to) = (p99(mixed), p99(spin));
        format!("spin alone: it brings the 99 % from {from} to {to}, and takes a processor")
    } else {
        let least = sleep.p99_ns.min(mixed.p99_ns).min(spin.p99_ns);
        format!(
            "no way to wait is steady here: 1 % of the ticks are more than {} late, of a period \
             of {}; a lower rate asks for less",
            microseconds(least),
            microseconds(period_ns as u64),
        )
    }
}

fn about_priority(
    normal: &Distribution,
    raised: Option<&Distribution>,
    priority: &Priority,
) -> String {
    match (raised, priority) {
        (Some(raised), _) => {
            let (from, to) = (microseconds(normal.p999_ns), microseconds(raised.p999_ns));
            if is_better(raised.p999_ns, normal.p999_ns) {
                format!("raise the priority: it brings the 99.9 % from {from} to {to}")
            } else {
                format!(
                    "a raised priority changes little: the 99.9 % are {from}, and {to} with it"
                )
            }
        }
        (None, Priority::Refused { .. }) => {
            "allow a raised priority and measure again; on Linux, CAP_SYS_NICE or a limit \
             rtprio in /etc/security/limits.conf"
                .to_owned()
        }
        (None, _) => "a raised priority was not measured".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use palpate::haptics::Lateness;

    use super::*;

    fn loop_of(waiting: Waiting, is_raised: bool, us: [u64; 3]) -> Measured {
        let [p99_ns, p999_ns, max_ns] = us.map(|us| 1000 * us);
        let times = Distribution {
            count: 5000,
            mean_ns: 0.0,
            p50_ns: 0,
            p99_ns,
            p999_ns,
            max_ns,
            buckets: Vec::new(),
        };
        let lateness = Lateness { times: Some(times), missed: u64::from(max_ns > 1_000_000) };
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
        let [sleep, mixed, spin] = Waiting::ALL;
        let of = |us: [u64; 3]| {
            [(sleep, us[0]), (mixed, us[1]), (spin, us[2])]
                .map(|(waiting, us)| loop_of(waiting, false, [us, 2 * us, 3 * us]))
        };
        said(&of([90, 5, 5]), &refused, &["sleep alone", "allow"]);
        said(&of([150, 5, 5]), &refused, &["sleep, then spin", "allow"]);
        said(&of([300, 150, 20]), &refused, &["spin alone", "allow"]);
        said(&of([300, 200, 190]), &refused, &["no way", "allow"]);
    }

    #[test]
    fn priority_and_load_are_judged_by_what_they_did() {
        let [sleep, mixed, spin] = Waiting::ALL;
        let normal = |max| {
            [sleep, mixed, spin].map(|waiting| loop_of(waiting, false, [150 / 2, 900, max]))
        };
        let with = |p999, max| {
            let raised = loop_of(mixed, true, [50, p999, 950]);
            normal(max).into_iter().chain([raised]).collect::<Vec<_>>()
        };
        said(&with(100, 950), &Priority::Raised, &["sleep alone", "raise the priority"]);
        let words = ["sleep alone", "a raised priority changes little", "the processor was"];
        said(&with(800, 2000), &Priority::Raised, &words);
    }

    #[test]
    fn no_tick_asks_for_more() {
        said(&[], &Priority::Normal, &["measure for longer"]);
    }
}
