// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the program tells a page without being asked.

use serde::Serialize;

/// A message to a page, by its `do`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub(crate) enum Told {
    /// Forces are held at zero.
    Stopped {
        /// The number of the last stop, which a release repeats.
        number: u64,
        /// Whether this page pressed it.
        mine: bool,
        /// The time until this page may release it [s].
        release_after: f64,
    },
    /// A stop was released.
    Released {
        /// Its number.
        number: u64,
    },
}
