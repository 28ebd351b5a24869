// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The server as a program on the same machine sees it.

#![expect(clippy::unwrap_used, reason = "tests")]

mod budgets;
mod guard;
mod hand;
mod load;
mod shaders;
mod speech;
mod stop;
mod talk;
mod types;
