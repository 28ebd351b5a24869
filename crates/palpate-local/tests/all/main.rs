// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches and ways to a gradient. One test program, so that it is linked once.
#![expect(clippy::unwrap_used, reason = "these are tests")]

mod descents;
mod gradients;
mod methods;
mod naive;
mod sweeps;
