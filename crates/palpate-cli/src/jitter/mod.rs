// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate jitter`: measures how late a loop wakes on this machine.

mod advice;

use std::fmt::Write as _;
use std::io::Write as _;
use std::time::Duration;

use palpate::device::NumberError;
use palpate::haptics::HapticsError;
use palpate::servo_loop::{Lateness, Priority, WallClock, raise_priority};
use serde_json::{Value, json};

use crate::arguments::JitterOptions;
use crate::outcome::{Failure, Outcome};
use crate::output;
use palpate::scene::text::plain;

/// The highest rate [Hz], which is that of the fastest servo.
const MOST_RATE: f64 = 10_000.0;

/// The longest measurement [s]: a working day.
const MOST_DURATION: f64 = 28_800.0;

/// How a loop waits for its next tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Waiting {
    Sleep,
    SleepThenSpin,
    Spin,
}

impl Waiting {
    const ALL: [Self; 3] = [Self::Sleep, Self::SleepThenSpin, Self::Spin];

    fn name(self) -> &'static str {
        match self {
            Self::Sleep => "sleep",
            Self::SleepThenSpin => "sleep, then spin",
            Self::Spin => "spin",
        }
    }

    /// The clock of a loop; one that sleeps, then spins, waits as a servo of that priority
    /// does.
    fn clock(self, priority: &Priority) -> WallClock {
        match self {
            Self::Sleep => WallClock::spinning_for(Duration::ZERO),
            Self::SleepThenSpin => WallClock::suited_to(priority),
            Self::Spin => WallClock::spinning_for(Duration::MAX),
        }
    }
}

/// A loop that was measured.
#[derive(Clone, Debug)]
struct Measured {
    waiting: Waiting,
    is_raised: bool,
    lateness: Lateness,
}

impl Measured {
    fn title(&self) -> String {
        let priority = if self.is_raised { ", with a raised priority" } else { "" };
        format!("{}{priority}", self.waiting.name())
    }
}

pub(crate) fn run(options: &JitterOptions) -> Result<Outcome, Failure> {
    let rate = NumberError::check_rate(options.rate).map_err(Failure::input)?;
    let duration = NumberError::check_positive("duration", options.duration, "s")
        .map_err(Failure::input)?;
    if rate > MOST_RATE {
        return Err(Failure::input(format!(
            "--rate must be at most {MOST_RATE} Hz, got {rate} Hz"
        )));
    }
    if duration > MOST_DURATION {
        let problem = format!("--duration must be at most {MOST_DURATION} s, got {duration} s");
        return Err(Failure::input(problem));
    }
    // Asked for in a thread that ends at once, so the priority ends with it.
    let priority = in_thread(raise_priority);
    let priorities: &[bool] =
        if priority == Priority::Raised { &[false, true] } else { &[false] };
    let loops = (priorities.len() * Waiting::ALL.len()) as f64;
    let share = duration / loops;
    // A loop of half a period or more has a tick.
    if (share * rate).round() < 1.0 {
        let [duration, rate, least] = [duration, rate, 0.5 * loops / rate].map(plain);
        return Err(Failure::input(format!(
            "--duration {duration} s is shared by {loops} loops, which have no tick at {rate} Hz; \
             the least duration is {least} s"
        )));
    }
    let mut measured = Vec::new();
    for is_raised in priorities {
        for waiting in Waiting::ALL {
            let lateness = measure(waiting, *is_raised, rate, share);
            let lateness = lateness.map_err(Failure::input)?;
            measured.push(Measured { waiting, is_raised: *is_raised, lateness });
        }
    }
    let advice = advice::advice(&measured, &priority, rate);
    let mut out = output::answer();
    if options.json {
        let described: Vec<_> = measured.iter().map(described).collect();
        let answer = json!({
            "rate_hz": rate,
            "duration_s": duration,
            "raised_priority": priority,
            "loops": described,
            "advice": advice,
        });
        out.json(&answer)?;
    } else {
        write!(out, "{}", text(&measured, &priority, &advice, rate))?;
    }
    Ok(Outcome::Yes)
}

fn measure(
    waiting: Waiting,
    is_raised: bool,
    rate: f64,
    duration: f64,
) -> Result<Lateness, HapticsError> {
    in_thread(|| {
        let priority = if is_raised { raise_priority() } else { Priority::Normal };
        Lateness::measure(&mut waiting.clock(&priority), rate, duration)
    })
}

/// Runs `work` in a thread of its own, because a raised priority lasts until its thread ends.
fn in_thread<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let joined = std::thread::scope(|scope| scope.spawn(work).join());
    joined.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

fn described(measured: &Measured) -> Value {
    json!({
        "waits_by": measured.waiting.name(),
        "is_raised": measured.is_raised,
        "lateness": measured.lateness.times,
        "missed": measured.lateness.missed,
    })
}

fn text(measured: &[Measured], priority: &Priority, advice: &[String], rate: f64) -> String {
    let mut out = String::new();
    write_text(&mut out, measured, priority, advice, rate).unwrap_or_default();
    out
}

fn write_text(
    out: &mut String,
    measured: &[Measured],
    priority: &Priority,
    advice: &[String],
    rate: f64,
) -> std::fmt::Result {
    writeln!(out, "how late a loop of {rate} Hz wakes on this machine")?;
    for loop_measured in measured {
        let Lateness { times, missed, .. } = &loop_measured.lateness;
        writeln!(out, "{}", loop_measured.title())?;
        let Some(times) = times else {
            writeln!(out, "  no tick: raise --duration")?;
            continue;
        };
        writeln!(out, "  lateness       {times:#}")?;
        writeln!(out, "  missed         {missed} of {} ticks", times.count)?;
    }
    if let Priority::Refused { reason } = priority {
        writeln!(out, "the system does not allow a raised priority: {reason}")?;
    }
    writeln!(out, "advice")?;
    for sentence in advice {
        writeln!(out, "  - {sentence}")?;
    }
    Ok(())
}
