// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Compiles devices and hands in this crate, for the plane and for space.
//! [`compile`] says why.

use palpate_device::Device;
use palpate_field::compile;

use crate::{Glove, HandPath, RecordedDevice, SimulatedDevice, SteeredDevice, Tour, identify};

fn in_dimension<const D: usize>() {
    compile![
        HandPath::<D>::new,
        HandPath::<D>::state_at,
        Tour::<D>::new,
        Tour::<D>::over,
        Tour::<D>::over_each,
        SimulatedDevice::<D>::new,
        <SimulatedDevice<D> as Device<D>>::read,
        SteeredDevice::<D>::new,
        <SteeredDevice<D> as Device<D>>::read,
        RecordedDevice::<D>::new,
        Glove::<D>::new,
        Glove::<D>::from_hand,
        identify::<D>,
    ];
}

/// Never called. It names functions so that this crate compiles them.
#[doc(hidden)]
#[inline(never)]
pub fn instances() {
    in_dimension::<2>();
    in_dimension::<3>();
}
