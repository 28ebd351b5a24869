// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Simulated devices beside theory. One test program, so that it is linked once; what needs an
//! allocator of its own is `real_time.rs`.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]
#![expect(clippy::float_cmp, reason = "tests compare exact numbers")]

mod identify;
mod integration;
mod real_time;
