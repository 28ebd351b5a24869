// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How many ticks, rows and samples of paths a run may have.

use palpate::field::Point;
use palpate::servo_loop::TraceRow;

use crate::outcome::Failure;
use palpate::scene::text::plain;

/// The most rows that a run keeps: an hour of one contact point at 1 kHz.
const MOST_ROWS: f64 = 3.6e6;

/// The most ticks of a run: eleven days at 1 kHz.
const MOST_TICKS: f64 = 1e9;

/// The most memory for the paths of a hand [bytes]: beside the rows of [`MOST_ROWS`], which take
/// half as much, a machine with 2 GB has room for it.
const MOST_PATHS: f64 = 1e9;

/// The ticks of a run.
pub(super) fn ticks(duration: f64, rate: f64) -> Result<f64, Failure> {
    let ticks = (duration * rate).round();
    if ticks < 1.0 {
        let [duration, rate, least] = [duration, rate, 0.5 / rate].map(plain);
        return Err(Failure::input(format!(
            "a run of {duration} s has no tick at {rate} Hz; the least duration is {least} s"
        )));
    }
    if ticks > MOST_TICKS {
        return Err(Failure::input(format!(
            "a run has at most {MOST_TICKS:e} ticks; {duration} s at {rate} Hz are {ticks:e}"
        )));
    }
    Ok(ticks)
}

/// The rows of a run that are kept, if they are not too many, and the system has memory for them.
pub(super) fn rows(count: f64) -> Result<usize, Failure> {
    const SHORTEN: &str = "shorten --duration, lower --rate, or use fewer contact points";
    if count > MOST_ROWS {
        let problem =
            format!("--plot and --wav keep {MOST_ROWS} rows at most, got {count}; {SHORTEN}");
        return Err(Failure::input(problem));
    }
    let rows = count.max(0.0).ceil() as usize;
    // Memory that is only reserved costs nothing; a recorder that gets none would end the program.
    if Vec::<TraceRow>::new().try_reserve_exact(rows).is_err() {
        let memory = 1e-9 * (rows * size_of::<TraceRow>()) as f64;
        return Err(Failure::input(format!(
            "--plot and --wav keep {rows} rows of this run, {memory:.1} GB of memory, \
             which the system does not give; {SHORTEN}"
        )));
    }
    Ok(rows)
}

/// Refuses paths for so many contact points along a way of so many samples, if they take too
/// much memory: time, place and velocity of each sample, in the world and at the device.
pub(super) fn paths(points: usize, samples: usize) -> Result<(), Failure> {
    let bytes = 2 * (size_of::<f64>() + 2 * size_of::<Point<3>>());
    let memory = bytes as f64 * points as f64 * samples as f64;
    if memory > MOST_PATHS {
        return Err(Failure::input(format!(
            "the paths of {points} contact points with {samples} samples each would take \
             {:.1} GB of memory, more than {} GB; shorten the path, or use fewer contact points",
            1e-9 * memory,
            1e-9 * MOST_PATHS,
        )));
    }
    Ok(())
}
