// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How much of a file is read.

use std::io::{self, ErrorKind};
use std::path::Path;

use clap::Args;
use palpate::scene::{LARGEST_FILE, read_file};

use super::numbers::count;
use crate::outcome::Failure;

/// How much of a file is read: what has no end, such as a device, would fill the memory.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Reading {
    /// The largest scene or table that is read [bytes].
    #[arg(
        long,
        value_name = "BYTES",
        default_value_t = LARGEST_FILE,
        allow_negative_numbers = true,
        value_parser = count(1, u64::MAX)
    )]
    pub(crate) largest_file: u64,
}

impl Default for Reading {
    fn default() -> Self {
        Self { largest_file: LARGEST_FILE }
    }
}

impl Reading {
    /// The bytes of a file.
    pub(crate) fn bytes(self, path: &Path) -> Result<Vec<u8>, Failure> {
        read_file(path, self.largest_file).map_err(|error| unread(path, &error))
    }
}

/// The failure to read a file; if it is too large, with the option that raises the limit.
pub(crate) fn unread(path: &Path, error: &io::Error) -> Failure {
    match error.kind() {
        ErrorKind::FileTooLarge => {
            Failure::file(path, format_args!("{error}; --largest-file raises that"))
        }
        _ => Failure::file(path, error),
    }
}
