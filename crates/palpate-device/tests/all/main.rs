// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! All tests of the crate in one program.
#![allow(clippy::float_cmp, reason = "tests compare exact numbers")]
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod mailbox;
