// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Compiles devices and hands in this crate.
//! [`compile`] says why.

use palpate_device::Device;
use palpate_field::compile;

use crate::{Glove, HandPath, RecordedDevice, SimulatedDevice, SteeredDevice, Tour, identify};

/// Never called. It names functions so that this crate compiles them.
#[doc(hidden)]
#[inline(never)]
pub fn instances() {
    compile![
        HandPath::new,
        HandPath::state_at,
        Tour::new::<2>,
        Tour::new::<3>,
        Tour::over,
        Tour::over_each,
        SimulatedDevice::new,
        <SimulatedDevice as Device>::read,
        SteeredDevice::new,
        <SteeredDevice as Device>::read,
        RecordedDevice::new,
        Glove::new,
        Glove::from_hand,
        identify,
    ];
}
