// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! When moving bodies touch first.

mod ball;

pub use ball::cast_ball;
