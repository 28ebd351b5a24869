// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The palpate program: signed distance functions that can be touched.

use std::io;
use std::process::ExitCode;

use mimalloc::MiMalloc;
use palpate_cli::{Interrupt, run_until};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// Worlds are many small nodes, which this allocator frees fast: `docs/decisions/allocator.md`.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    let interrupt = Interrupt::new();
    if let Err(error) = listen(&interrupt) {
        eprintln!("palpate: cannot handle Ctrl-C and SIGTERM: {error}");
    }
    ExitCode::from(run_until(std::env::args_os(), &interrupt))
}

/// Lets Ctrl-C and SIGTERM ask the run to end; a second signal ends the process at once.
fn listen(interrupt: &Interrupt) -> io::Result<()> {
    for signal in [SIGINT, SIGTERM] {
        // The order matters: a signal ends the process only if an earlier one asked the run to
        // end.
        let status = Interrupt::STATUS.into();
        flag::register_conditional_shutdown(signal, status, interrupt.at_once())?;
        flag::register(signal, interrupt.at_once())?;
        flag::register(signal, interrupt.asked())?;
    }
    Ok(())
}
