// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How a safety chain protects: every setting and its default.

use crate::acceptance::Acceptance;
use crate::rise::Recovery;

/// Energy that a hand does not feel [J].
const RESERVE: f64 = 1e-4;

/// The time constant with which motors are taken to cool [s]: makers do not state it.
const COOLING_TIME: f64 = 2.0;

/// How fast a force rises under a hand at rest without lifting it as a blow would [N/s].
const RISE_RATE: f64 = 20.0;

/// Five ticks of 1 ms that are late together: fewer are the jitter of an ordinary machine [s].
const LATE_TIME: f64 = 0.005;

/// A force that falls in this time is felt as soft [s].
const FALL_TIME: f64 = 0.02;

/// How a safety chain protects, beside the limits of its device.
///
/// ```
/// use palpate_safety::SafetySettings;
///
/// let settings = SafetySettings { rise_rate: 10.0, ..SafetySettings::default() };
/// assert_eq!((settings.rise_rate, settings.fall_time), (10.0, 0.02));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SafetySettings {
    /// What the device renders of materials, tools and guides.
    pub acceptance: Acceptance,
    /// Whether materials, tools and guides are refused of which the device renders less than all.
    pub is_strict: bool,
    /// Whether the passivity controllers, of walls and of [free
    /// forces](crate::PortState::free_force), and the stage of limit cycles act; the observers always
    /// run. A wanted force that must do work on the hand is incompatible with the controller. On a
    /// device of infinite damping, neither the controllers nor that stage act.
    pub has_passivity_control: bool,
    /// Energy that each controller lets out before the hand has put any in [J].
    pub reserve: f64,
    /// The time constant with which the motors cool [s].
    pub cooling_time: f64,
    /// How a force comes back after a beginning in a body: the start, an emergency stop, a hand
    /// that is set down, a device that was not ready. After all else it comes back at once.
    pub recovery: Recovery,
    /// How fast a force rises after it was zeroed [N/s], infinite for at once: after the start, a
    /// placement, late ticks, lost readings, an input that is not finite, or an emergency stop. A
    /// torque rises as fast in the units of its coupling, `√(κ/K)` metres a radian.
    pub rise_rate: f64,
    /// The time by which ticks are late together when the force falls to zero [s]. Each tick in
    /// time takes a period from that sum, and two once the force falls; when the sum is zero, the
    /// force rises again.
    pub late_time: f64,
    /// The time over which late ticks lower the force to zero [s].
    pub fall_time: f64,
}

impl Default for SafetySettings {
    /// Every stage acts. The device renders what it can ([`Acceptance::Device`]); the reserve is
    /// 0.1 mJ, which a hand does not feel; motors cool within 2 s; forces rise by 20 N/s, and fall
    /// within 0.02 s when ticks are late by 5 ms.
    fn default() -> Self {
        Self {
            acceptance: Acceptance::Device,
            is_strict: false,
            has_passivity_control: true,
            reserve: RESERVE,
            cooling_time: COOLING_TIME,
            recovery: Recovery::Rise,
            rise_rate: RISE_RATE,
            late_time: LATE_TIME,
            fall_time: FALL_TIME,
        }
    }
}
