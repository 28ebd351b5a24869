// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The energy that passes between a hand and a servo.

/// Energy at a contact point since the start [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Energy {
    /// What the forces took from the hand.
    pub taken: f64,
    /// What they gave to it.
    pub given: f64,
    /// What the wanted forces would have given, but those written did not.
    pub kept: f64,
}
