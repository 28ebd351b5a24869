// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The energy that passes between a hand and a servo.

/// Energy at a contact point since the start [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Energy {
    /// Energy that the rendered forces took from the hand.
    pub taken: f64,
    /// Energy that the rendered forces gave to the hand.
    pub given: f64,
    /// Energy that the wanted forces would have given, but the rendered forces did not: what the
    /// safety chain held back (passivity controller, limits, ramps, stops).
    pub kept: f64,
}
