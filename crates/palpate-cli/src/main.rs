// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The palpate program: signed distance functions that can be touched.

use std::io;
use std::process::ExitCode;
#[cfg(unix)]
use std::sync::Arc;

use mimalloc::MiMalloc;
use palpate_cli::{Interrupt, run_until};
#[cfg(target_os = "linux")]
use signal_hook::consts::SIGHUP;
#[cfg(unix)]
use signal_hook::consts::SIGXFSZ;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
#[cfg(unix)]
use signal_hook::iterator::Signals;

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

/// Lets Ctrl-C, SIGTERM and the end of the terminal ask the run to end.
fn listen(interrupt: &Interrupt) -> io::Result<()> {
    let status = Interrupt::STATUS.into();
    for signal in [SIGINT, SIGTERM] {
        // The order matters: a signal ends the process only if an earlier one asked the run to
        // end.
        flag::register_conditional_shutdown(signal, status, interrupt.at_once())?;
        flag::register(signal, interrupt.at_once())?;
        flag::register(signal, interrupt.asked())?;
    }
    // A shell and the system may both say that a terminal has ended: the second time must not cut
    // off what the first one asked for. `nohup` starts a run that ignores it.
    #[cfg(target_os = "linux")]
    if !is_ignored(SIGHUP) {
        flag::register_conditional_shutdown(SIGHUP, status, interrupt.unheeded())?;
        flag::register(SIGHUP, interrupt.asked())?;
    }
    #[cfg(unix)]
    stop_forces(interrupt)?;
    // A file that becomes too large for the user's limit is then an error, which names it.
    #[cfg(unix)]
    flag::register(SIGXFSZ, Arc::default())?;
    Ok(())
}

/// Presses the emergency stop for each signal, in a thread that does nothing else.
#[cfg(unix)]
fn stop_forces(interrupt: &Interrupt) -> io::Result<()> {
    let mut signals = vec![SIGINT, SIGTERM];
    #[cfg(target_os = "linux")]
    if !is_ignored(SIGHUP) {
        signals.push(SIGHUP);
    }
    let mut signals = Signals::new(signals)?;
    let switch = interrupt.stop_switch();
    let work = move || signals.forever().for_each(|_| _ = switch.stop());
    std::thread::Builder::new().name("palpate signals".to_owned()).spawn(work)?;
    Ok(())
}

/// `true` if the process ignores `signal`.
#[cfg(target_os = "linux")]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let signals = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    signals.is_some_and(|signals| (signals >> (signal - 1)) & 1 == 1)
}
