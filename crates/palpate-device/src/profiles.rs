// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Profiles of known devices.
//!
//! Largest force, stiffness, damping and the radius of the workspace are those in the drivers
//! of CHAI3D 3.3.0 (Conti et al., 2024), which publish nothing else. All other numbers are
//! assumed, and listed as such: of the order of makers' data sheets, and consistent with the
//! published numbers. The least damping is `K T / 2` at `T` = 1 ms, the smallest that makes the
//! largest stiffness `K` passive (Colgate and Schenkel 1997); friction and encoder step satisfy
//! `K ≤ 2 f_c / Δ` (Abbott and Okamura 2005); the full force rises within 2 ms; a
//! hand moves by at most 5 m/s and 500 m/s². The rotational
//! numbers follow the same rules, for the worst axis, with at most 50 rad/s and 10 000 rad/s² of a
//! hand; each profile names its sources.

use std::borrow::Cow;

use palpate_field::UnknownName;

use crate::profile::DeviceProfile;
use crate::turning_profile::TurningProfile;
use crate::wrists::{OMEGA, PREMIUM, SIGMA, VIRTUOSE_6D, turning};

/// The source of the numbers, and the names of assumed ones.
pub(crate) struct Origin {
    pub(crate) source: &'static str,
    pub(crate) assumed: &'static [&'static str],
}

const DRIVERS: Origin = Origin {
    source: "device specifications in the drivers of CHAI3D 3.3.0 (Conti et al., 2024)",
    assumed: &[
        "continuous_force",
        "max_force_rate",
        "mass",
        "least_damping",
        "friction",
        "encoder_step",
        "max_speed",
        "max_acceleration",
    ],
};

/// For a device that is known from articles, without published numbers.
const ASSUMED: Origin = Origin {
    source: "none: all of the order of the maker's data sheet",
    assumed: DeviceProfile::NUMBERS,
};

/// Numbers from the drivers.
struct Published {
    force: f64,
    stiffness: f64,
    damping: f64,
    workspace: f64,
}

/// Assumed numbers.
struct Assumed {
    continuous_force: f64,
    mass: f64,
    least_damping: f64,
    friction: f64,
    encoder_step: f64,
}

/// The largest rate of force over the largest force [1/s]: the full force rises within 2 ms.
pub(crate) const FORCE_RISES: f64 = 500.0;

/// More than a hand moves a desktop device, whose workspace it would cross in 40 ms [m/s].
const MAX_SPEED: f64 = 5.0;

/// Several times that by which the largest forces move the apparent masses [m/s²].
const MAX_ACCELERATION: f64 = 500.0;

const fn profile(
    origin: &Origin,
    name: &'static str,
    published: Published,
    assumed: Assumed,
) -> DeviceProfile {
    turning_profile(origin, name, published, assumed, None)
}

/// The rotational profile of a device, if it has one.
const fn turning_profile(
    origin: &Origin,
    name: &'static str,
    published: Published,
    assumed: Assumed,
    turning: Option<TurningProfile>,
) -> DeviceProfile {
    DeviceProfile {
        name: Cow::Borrowed(name),
        max_force: published.force,
        continuous_force: assumed.continuous_force,
        max_force_rate: published.force * FORCE_RISES,
        max_stiffness: published.stiffness,
        max_damping: published.damping,
        workspace_radius: published.workspace,
        mass: assumed.mass,
        least_damping: assumed.least_damping,
        friction: assumed.friction,
        encoder_step: assumed.encoder_step,
        max_speed: MAX_SPEED,
        max_acceleration: MAX_ACCELERATION,
        turning,
        gripper: None,
        buttons: Cow::Borrowed(&[]),
        source: Cow::Borrowed(origin.source),
        assumed: Cow::Borrowed(origin.assumed),
    }
}

/// All known devices, by their names on the command line.
///
/// ```
/// use palpate_device::PROFILES;
///
/// let at_least = |newtons: f64| PROFILES.iter().filter(|(_, p)| p.max_force >= newtons).count();
/// assert_eq!((PROFILES.len(), at_least(20.0)), (16, 4));
/// ```
pub static PROFILES: [(&str, DeviceProfile); 16] = [
    (
        "touch",
        profile(
            &DRIVERS,
            "Phantom Touch",
            Published { force: 3.3, stiffness: 400.0, damping: 4.0, workspace: 0.075 },
            Assumed {
                continuous_force: 0.9,
                mass: 0.045,
                least_damping: 0.2,
                friction: 0.2,
                encoder_step: 5.5e-5,
            },
        ),
    ),
    (
        "omni",
        profile(
            &DRIVERS,
            "Phantom Omni",
            Published { force: 3.3, stiffness: 700.0, damping: 5.0, workspace: 0.1 },
            Assumed {
                continuous_force: 0.9,
                mass: 0.045,
                least_damping: 0.35,
                friction: 0.2,
                encoder_step: 5.5e-5,
            },
        ),
    ),
    (
        "desktop",
        profile(
            &DRIVERS,
            "Phantom Desktop",
            Published { force: 7.9, stiffness: 1000.0, damping: 5.0, workspace: 0.1 },
            Assumed {
                continuous_force: 1.75,
                mass: 0.045,
                least_damping: 0.5,
                friction: 0.05,
                encoder_step: 2.5e-5,
            },
        ),
    ),
    (
        "premium15",
        turning_profile(
            &DRIVERS,
            "Phantom Premium 1.5 6DOF",
            Published { force: 8.5, stiffness: 800.0, damping: 5.0, workspace: 0.12 },
            Assumed {
                continuous_force: 1.4,
                mass: 0.1,
                least_damping: 0.4,
                friction: 0.04,
                encoder_step: 3e-5,
            },
            Some(turning(&PREMIUM)),
        ),
    ),
    (
        "premium15-high-force",
        profile(
            &ASSUMED,
            "Phantom Premium 1.5 High Force",
            Published { force: 37.5, stiffness: 3500.0, damping: 5.0, workspace: 0.12 },
            Assumed {
                continuous_force: 6.0,
                mass: 0.15,
                least_damping: 1.75,
                friction: 0.2,
                encoder_step: 1e-5,
            },
        ),
    ),
    (
        "premium30",
        turning_profile(
            &DRIVERS,
            "Phantom Premium 3.0 6DOF",
            Published { force: 22.0, stiffness: 1000.0, damping: 5.0, workspace: 0.25 },
            Assumed {
                continuous_force: 3.0,
                mass: 0.16,
                least_damping: 0.5,
                friction: 0.2,
                encoder_step: 2e-5,
            },
            Some(turning(&PREMIUM)),
        ),
    ),
    (
        "falcon",
        profile(
            &DRIVERS,
            "Novint Falcon",
            Published { force: 8.0, stiffness: 3000.0, damping: 20.0, workspace: 0.04 },
            Assumed {
                continuous_force: 4.0,
                mass: 0.25,
                least_damping: 1.5,
                friction: 0.3,
                encoder_step: 6e-5,
            },
        ),
    ),
    (
        "omega",
        profile(
            &DRIVERS,
            "Force Dimension omega",
            Published { force: 12.0, stiffness: 5000.0, damping: 30.0, workspace: 0.075 },
            Assumed {
                continuous_force: 12.0,
                mass: 0.2,
                least_damping: 2.5,
                friction: 0.1,
                encoder_step: 1e-5,
            },
        ),
    ),
    (
        "sigma",
        profile(
            &DRIVERS,
            "Force Dimension sigma",
            Published { force: 12.0, stiffness: 4000.0, damping: 30.0, workspace: 0.075 },
            Assumed {
                continuous_force: 12.0,
                mass: 0.3,
                least_damping: 2.0,
                friction: 0.15,
                encoder_step: 1e-5,
            },
        ),
    ),
    (
        "lambda",
        profile(
            &DRIVERS,
            "Force Dimension lambda",
            Published { force: 12.0, stiffness: 8000.0, damping: 30.0, workspace: 0.1125 },
            Assumed {
                continuous_force: 12.0,
                mass: 0.35,
                least_damping: 4.0,
                friction: 0.2,
                encoder_step: 1e-5,
            },
        ),
    ),
    (
        "delta",
        profile(
            &DRIVERS,
            "Force Dimension delta.3",
            Published { force: 20.0, stiffness: 5000.0, damping: 30.0, workspace: 0.15 },
            Assumed {
                continuous_force: 20.0,
                mass: 0.3,
                least_damping: 2.5,
                friction: 0.2,
                encoder_step: 3e-5,
            },
        ),
    ),
    (
        "omega6",
        turning_profile(
            &DRIVERS,
            "Force Dimension omega.6",
            Published { force: 12.0, stiffness: 5000.0, damping: 30.0, workspace: 0.075 },
            Assumed {
                continuous_force: 12.0,
                mass: 0.25,
                least_damping: 2.5,
                friction: 0.1,
                encoder_step: 1e-5,
            },
            Some(turning(&OMEGA)),
        ),
    ),
    (
        "omega7",
        turning_profile(
            &DRIVERS,
            "Force Dimension omega.7",
            Published { force: 12.0, stiffness: 5000.0, damping: 30.0, workspace: 0.075 },
            Assumed {
                continuous_force: 12.0,
                mass: 0.25,
                least_damping: 2.5,
                friction: 0.1,
                encoder_step: 1e-5,
            },
            Some(turning(&OMEGA)),
        ),
    ),
    (
        "sigma7",
        turning_profile(
            &DRIVERS,
            "Force Dimension sigma.7",
            Published { force: 12.0, stiffness: 4000.0, damping: 30.0, workspace: 0.075 },
            Assumed {
                continuous_force: 12.0,
                mass: 0.3,
                least_damping: 2.0,
                friction: 0.15,
                encoder_step: 1e-5,
            },
            Some(turning(&SIGMA)),
        ),
    ),
    (
        "lambda7",
        turning_profile(
            &DRIVERS,
            "Force Dimension lambda.7",
            Published { force: 12.0, stiffness: 8000.0, damping: 30.0, workspace: 0.1125 },
            Assumed {
                continuous_force: 12.0,
                mass: 0.35,
                least_damping: 4.0,
                friction: 0.2,
                encoder_step: 1e-5,
            },
            Some(turning(&SIGMA)),
        ),
    ),
    (
        "virtuose6d",
        turning_profile(
            &ASSUMED,
            "Haption Virtuose 6D",
            Published { force: 35.0, stiffness: 2000.0, damping: 30.0, workspace: 0.3 },
            Assumed {
                continuous_force: 10.0,
                mass: 1.0,
                least_damping: 1.0,
                friction: 0.5,
                encoder_step: 6e-5,
            },
            Some(turning(&VIRTUOSE_6D)),
        ),
    ),
];

/// The profile of the device that the command line calls `name`.
///
/// # Errors
///
/// [`UnknownName`], which lists the known names.
///
/// # Examples
///
/// ```
/// use palpate_device::profile_named;
///
/// let omega = profile_named("omega").unwrap();
/// assert_eq!((omega.max_force, omega.max_stiffness), (12.0, 5000.0));
/// assert!(omega.assumed.contains(&"least_damping"));
/// let error = profile_named("omga").unwrap_err().to_string();
/// assert!(error.starts_with("there is no device \"omga\"; there are touch, omni, desktop,"));
/// ```
pub fn profile_named(name: &str) -> Result<DeviceProfile, UnknownName> {
    let found = PROFILES.iter().find(|(known, _)| *known == name);
    let known = || PROFILES.iter().map(|(known, _)| *known);
    found
        .map(|(_, profile)| profile.clone())
        .ok_or_else(|| UnknownName::new("device", name, known()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_profile_is_coherent() {
        for (name, profile) in &PROFILES {
            let numbers = [
                profile.max_force,
                profile.max_force_rate,
                profile.continuous_force,
                profile.max_stiffness,
                profile.max_damping,
                profile.workspace_radius,
                profile.mass,
                profile.least_damping,
                profile.friction,
                profile.encoder_step,
            ];
            assert!(numbers.iter().all(|x| *x > 0.0 && x.is_finite()), "{name}");
            assert!(profile.continuous_force <= profile.max_force, "{name}");
            // At 1 kHz, up to the rounding of decimals such as 0.35.
            let passive = 2000.0 * profile.least_damping;
            assert!(profile.max_stiffness <= passive * (1.0 + f64::EPSILON), "{name}");
            assert!(
                profile.max_stiffness <= 2.0 * profile.friction / profile.encoder_step,
                "{name}"
            );
            assert!(!profile.source.is_empty(), "{name}");
        }
    }

    #[test]
    fn every_profile_that_turns_is_coherent() {
        let mut torques = 0;
        for (name, profile) in &PROFILES {
            let Some(turning) = &profile.turning else { continue };
            let always = [turning.inertia, turning.least_damping, turning.friction];
            assert!(always.iter().all(|x| *x > 0.0 && x.is_finite()), "{name}");
            assert!(turning.encoder_step > 0.0 && !turning.source.is_empty(), "{name}");
            assert!(turning.max_speed.is_finite() && turning.max_speed > 0.0, "{name}");
            // The device alone cannot turn its handle so that readings are held back.
            assert!(turning.max_acceleration.is_finite(), "{name}");
            let by_torque = turning.max_torque / turning.inertia;
            assert!(turning.max_acceleration > 2.0 * by_torque, "{name}");
            let of_torque = [
                turning.max_torque,
                turning.continuous_torque,
                turning.max_torque_rate,
                turning.max_stiffness,
                turning.max_damping,
            ];
            if turning.max_torque > 0.0 {
                torques += 1;
                assert!(of_torque.iter().all(|x| *x > 0.0 && x.is_finite()), "{name}");
                assert!(turning.continuous_torque <= turning.max_torque, "{name}");
                let passive = 2000.0 * turning.least_damping;
                assert!(turning.max_stiffness <= passive * (1.0 + f64::EPSILON), "{name}");
                let seen = 2.0 * turning.friction / turning.encoder_step;
                assert!(turning.max_stiffness <= seen, "{name}");
            } else {
                assert_eq!(of_torque, [0.0; 5], "{name}");
            }
        }
        assert_eq!(torques, 5);
    }

    #[test]
    fn every_name_is_found_and_once() {
        for (name, profile) in &PROFILES {
            assert_eq!(&profile_named(name).unwrap(), profile);
            assert_eq!(PROFILES.iter().filter(|(other, _)| other == name).count(), 1);
        }
    }

    #[test]
    fn what_is_assumed_are_fields() {
        for (name, profile) in &PROFILES {
            let shown = format!("{profile:?}");
            for field in profile.assumed.iter() {
                assert!(shown.contains(&format!("{field}: ")), "{name}: {field}");
            }
            let shown = format!("{:?}", profile.turning);
            let turning = profile.turning.iter().flat_map(|turning| turning.assumed.iter());
            for field in turning {
                assert!(shown.contains(&format!("{field}: ")), "{name}: {field}");
            }
        }
    }
}
