// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The palpate program: signed distance functions that can be touched.

use std::io;
use std::process::ExitCode;

use mimalloc::MiMalloc;
use palpate_cli::{Interrupt, run_until};
#[cfg(unix)]
use signal_hook::consts::SIGHUP;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// Worlds are many small nodes, which this allocator frees fast: `docs/decisions/allocator.md`.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    let interrupt = Interrupt::new();
    if let Err(error) = listen(&interrupt) {
        eprintln!("palpate: signals to end a run cannot be handled: {error}");
    }
    ExitCode::from(run_until(std::env::args_os(), &interrupt))
}

/// Lets signals ask the run to end; a second signal ends the process at once.
fn listen(interrupt: &Interrupt) -> io::Result<()> {
    for signal in requests() {
        // The order matters: a signal ends the process only if an earlier one asked the run to
        // end.
        let status = Interrupt::STATUS.into();
        flag::register_conditional_shutdown(signal, status, interrupt.at_once())?;
        flag::register(signal, interrupt.at_once())?;
        flag::register(signal, interrupt.asked())?;
    }
    Ok(())
}

/// The signals that ask a run to end: Ctrl-C, SIGTERM, and the end of its terminal.
#[cfg(unix)]
fn requests() -> Vec<i32> {
    let mut signals = vec![SIGINT, SIGTERM];
    // `nohup` starts a run that outlives its terminal: such a run ignores the signal.
    if !is_ignored(SIGHUP) {
        signals.push(SIGHUP);
    }
    signals
}

/// The signals that ask a run to end: Ctrl-C and SIGTERM.
#[cfg(not(unix))]
fn requests() -> Vec<i32> {
    vec![SIGINT, SIGTERM]
}

/// `true` if the process ignores `signal`; `false` where the system does not say it, as only
/// Linux does.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let signals = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    signals.is_some_and(|signals| (signals >> (signal - 1)) & 1 == 1)
}
