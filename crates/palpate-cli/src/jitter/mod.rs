// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate jitter`: measures how late ticks start.

use std::fmt;
use std::time::Duration;

use clap::Args;
use palpate::device::NumberError;
use palpate::haptics::HapticsError;
use palpate::scene::text::plain;
use palpate::servo_loop::{Lateness, Priority, WallClock, raise_priority};
use serde::Serialize;

use crate::arguments::numbers::positive;
use crate::outcome::{Failure, Outcome};
use crate::output;

mod advice;

/// The highest rate [Hz], which is that of the fastest servo.
const MOST_RATE: f64 = 10_000.0;

/// The longest measurement [s]: a working day.
const MOST_DURATION: f64 = 28_800.0;

/// How a loop waits for its next tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(test, derive(schemars::JsonSchema))]
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
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Measured {
    /// How it waits.
    waiting: Waiting,
    /// `true` with a raised priority.
    is_raised: bool,
    /// How late it woke: the distribution of `times`, and the ticks `missed`.
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
    let answer = Answer { rate, duration, priority, loops: measured, advice };
    output::answer().print(&answer, options.json)?;
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

/// The answer of `palpate jitter`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answer {
    /// Ticks a second [Hz].
    rate: f64,
    /// The time of all loops together [s].
    duration: f64,
    /// Whether the system raised the priority.
    priority: Priority,
    /// The loops that were measured.
    loops: Vec<Measured>,
    /// What to do, in sentences.
    advice: Vec<String>,
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "how late a loop of {} Hz wakes on this machine", self.rate)?;
        for measured in &self.loops {
            let Lateness { times, missed, .. } = &measured.lateness;
            writeln!(f, "{}", measured.title())?;
            let Some(times) = times else {
                writeln!(f, "  no tick: raise --duration")?;
                continue;
            };
            writeln!(f, "  lateness       {times:#}")?;
            writeln!(f, "  missed         {missed} of {} ticks", times.count)?;
        }
        if let Priority::Refused { reason } = &self.priority {
            writeln!(f, "the system does not allow a raised priority: {reason}")?;
        }
        writeln!(f, "advice")?;
        self.advice.iter().try_for_each(|sentence| writeln!(f, "  - {sentence}"))
    }
}

pub(crate) const EXAMPLES: &str =
    "Examples:\n  palpate jitter\n  palpate jitter --rate 4000 --duration 20 --json";

/// The options of `palpate jitter`.
#[derive(Args, Debug)]
pub(crate) struct JitterOptions {
    /// Ticks a second, at most 10 kHz [Hz].
    #[arg(long, allow_negative_numbers = true, default_value = "1000", value_parser = positive("Hz"))]
    pub(crate) rate: f64,
    /// How long to measure in all, shared by the ways to wait [s]: each has at least a tick.
    #[arg(long, allow_negative_numbers = true, default_value = "5", value_parser = positive("s"))]
    pub(crate) duration: f64,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}
