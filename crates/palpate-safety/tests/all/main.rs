// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! All tests of the crate in one program, which links faster than many.
#![allow(clippy::float_cmp, reason = "tests compare exact numbers")]
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use assert_no_alloc::AllocDisabler;

mod chain;
mod free_forces;

/// Aborts where a test forbids to allocate.
#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;
