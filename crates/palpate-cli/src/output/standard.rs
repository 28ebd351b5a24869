// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Standard output, which may be closed.

use std::io::{self, ErrorKind, Write};

#[cfg(unix)]
use rustix::fs::OFlags;

/// Standard output. It refuses what is written if it is closed: the standard library would take it,
/// and lose it.
#[derive(Debug)]
pub(super) struct StandardOutput {
    out: io::Stdout,
    is_open: bool,
}

impl StandardOutput {
    pub(super) fn new() -> Self {
        Self { out: io::stdout(), is_open: is_open() }
    }
}

impl Write for StandardOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.is_open { self.out.write(bytes) } else { Err(closed()) }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Refuses if nothing can be written to standard output.
pub(super) fn check() -> io::Result<()> {
    if is_open() { Ok(()) } else { Err(closed()) }
}

fn closed() -> io::Error {
    io::Error::new(ErrorKind::NotConnected, "standard output is closed")
}

/// Whether standard output takes what is written. Where it is closed, `src/closed.c` has opened
/// something that can only be read.
fn is_open() -> bool {
    #[cfg(unix)]
    return rustix::fs::fcntl_getfl(io::stdout())
        .is_ok_and(|flags| flags.intersects(OFlags::WRONLY | OFlags::RDWR));
    #[cfg(not(unix))]
    true
}
