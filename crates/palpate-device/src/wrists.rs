// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rotational profiles of known devices: the numbers of the worst axis of each.

use std::borrow::Cow;

use crate::profiles::{FORCE_RISES, Origin};
use crate::turning_profile::TurningProfile;

/// The rotational numbers of a device, without those that are assumed for all devices.
pub(crate) struct Torques {
    torque: f64,
    continuous_torque: f64,
    stiffness: f64,
    damping: f64,
    inertia: f64,
    friction: f64,
    encoder_step: f64,
    origin: Origin,
}

/// The least damping of a wrist that senses its orientation but gives no torque [N·m·s/rad]; no
/// limit depends on it.
const FREE_WRIST: f64 = 1e-3;

const DRIVERS: &str =
    "largest torque, stiffness and damping: drivers of CHAI3D 3.3.0 (Conti et al., 2024)";

/// Names of the assumed numbers if the drivers state the largest torque, stiffness and damping.
const BUT_LARGEST: &[&str] = &[
    "continuous_torque",
    "max_torque_rate",
    "inertia",
    "least_damping",
    "friction",
    "encoder_step",
    "max_speed",
    "max_acceleration",
];

/// The gimbal of the Phantom Premium 1.5 6DOF and 3.0 6DOF.
pub(crate) const PREMIUM: Torques = Torques {
    torque: 0.188,
    continuous_torque: 0.048,
    stiffness: 0.3,
    damping: 0.004,
    inertia: 5e-5,
    friction: 2e-3,
    // 0.0080°
    encoder_step: 1.4e-4,
    origin: Origin { source: DRIVERS, assumed: BUT_LARGEST },
};

/// The wrist of the omega.6 and the omega.7.
pub(crate) const OMEGA: Torques = Torques {
    torque: 0.0,
    continuous_torque: 0.0,
    stiffness: 0.0,
    damping: 0.0,
    inertia: 1e-4,
    friction: 2e-3,
    // 0.09°
    encoder_step: 1.57e-3,
    origin: Origin {
        source: "drivers of CHAI3D 3.3.0 (Conti et al., 2024): senses turns and gives no torque",
        assumed: &[
            "inertia",
            "least_damping",
            "friction",
            "encoder_step",
            "max_speed",
            "max_acceleration",
        ],
    },
};

/// The wrist of the sigma.7 and the lambda.7.
pub(crate) const SIGMA: Torques = Torques {
    torque: 0.2,
    continuous_torque: 0.2,
    stiffness: 1.0,
    damping: 0.07,
    inertia: 2e-4,
    friction: 4e-3,
    // 0.013°
    encoder_step: 2.27e-4,
    origin: Origin { source: DRIVERS, assumed: BUT_LARGEST },
};

/// The wrist of the Virtuose 6D.
pub(crate) const VIRTUOSE_6D: Torques = Torques {
    torque: 3.1,
    continuous_torque: 1.0,
    stiffness: 20.0,
    damping: 0.5,
    inertia: 5e-3,
    friction: 0.05,
    encoder_step: 2e-4,
    origin: Origin {
        source: "none: all of the order of the maker's data sheet",
        assumed: TurningProfile::NUMBERS,
    },
};

/// More than the fastest rotation of an arm in the tennis serves of world-class players, 2420°/s or
/// 42 rad/s at the shoulder and 1950°/s at the wrist (means of Fleisig, Nicholls, Elliott and
/// Escamilla 2003) [rad/s].
const MAX_SPEED: f64 = 50.0;

/// More than the 8000 rad/s² by which the strongest supination, 16 N·m (O'Sullivan and Gallwey 2002),
/// turns a hand and a forearm of the order of 0.002 kg·m² about their length, and more than twice
/// that by which the largest torques turn the apparent inertias [rad/s²].
const MAX_ACCELERATION: f64 = 1e4;

/// The profile of a wrist.
pub(crate) const fn turning(torques: &Torques) -> TurningProfile {
    // K T / 2 at 1 kHz.
    let least_damping =
        if torques.torque > 0.0 { 0.5e-3 * torques.stiffness } else { FREE_WRIST };
    TurningProfile {
        max_torque: torques.torque,
        continuous_torque: torques.continuous_torque,
        max_torque_rate: torques.torque * FORCE_RISES,
        max_stiffness: torques.stiffness,
        max_damping: torques.damping,
        inertia: torques.inertia,
        least_damping,
        friction: torques.friction,
        encoder_step: torques.encoder_step,
        max_speed: MAX_SPEED,
        max_acceleration: MAX_ACCELERATION,
        source: Cow::Borrowed(torques.origin.source),
        assumed: Cow::Borrowed(torques.origin.assumed),
    }
}
