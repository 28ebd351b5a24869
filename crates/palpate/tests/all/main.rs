// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Tests of the examples.

#![expect(clippy::unwrap_used, reason = "tests")]

mod coming_from;
mod examples;
mod planar_scenes;
mod wrong_plants;
