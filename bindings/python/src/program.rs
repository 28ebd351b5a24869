// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The program `palpate`.

use pyo3::prelude::*;

use crate::ending::detach;

/// Runs a command line, the program's name first, and returns the exit status.
#[pyfunction]
pub(crate) fn main(py: Python<'_>, arguments: Vec<std::ffi::OsString>) -> u8 {
    detach(py, || palpate_cli::run(arguments))
}
