// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Devices that the model fits badly, and one without friction.

use palpate_device::{DeviceProfile, profile_named};
use palpate_sim::{Hand, IdentifyOptions, SimulatedDevice};

use super::{START, check, free, identify};

/// Once its damping was three times too large, with a stated error of 0.2 %.
#[test]
fn a_hand_too_soft_to_be_noticed_leaves_no_number_that_is_seen() {
    let profile = profile_named("omega").unwrap();
    for seed in 0..2 {
        let hand = Hand::free(START).unwrap().with_mass(0.1).unwrap();
        let hand = hand.with_spring(3.9, 5.0).unwrap();
        let mut device = SimulatedDevice::new(profile.clone(), vec![hand]).unwrap();
        let options = IdentifyOptions { seed, ..IdentifyOptions::new(1000.0) };
        let found = identify(&mut device, options).unwrap();
        for axis in &found.axes {
            assert!(axis.damping.is_seen() && !axis.is_fitted() && !axis.is_seen(), "{axis:?}");
        }
        let better = found.profile(&profile, "strokes");
        for name in ["mass", "least_damping", "friction"] {
            assert!(better.assumed.contains(&name), "{better:?}");
        }
        assert!(!better.assumed.contains(&"encoder_step"), "{better:?}");
        // What a hand may have added does not count.
        assert_eq!(
            (better.mass, better.least_damping, better.friction),
            (profile.mass, profile.least_damping, profile.friction.min(better.friction))
        );
        let soft = DeviceProfile { least_damping: 99.0, ..profile.clone() };
        assert!(found.profile(&soft, "strokes").least_damping < 10.0);
    }
}

/// Once no numbers fitted for this seed: the first fit ended at a friction of zero, of which the next
/// took its steps.
#[test]
#[ignore = "slow: cargo xtask test --thorough"]
fn a_device_without_friction_is_identified() {
    let profile = DeviceProfile { friction: 0.0, ..profile_named("omega").unwrap() };
    let options = IdentifyOptions { seed: 1, ..IdentifyOptions::new(1000.0) };
    let found = identify(&mut free(profile.clone()), options).unwrap();
    for axis in &found.axes {
        // A friction of zero is never known to a part of it.
        assert_eq!(check(&profile, axis, "omega"), 1);
        assert!(axis.is_fitted() && axis.mass.is_seen() && axis.damping.is_seen());
    }
}
