// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Compiles scenes in this crate, for the plane and for space.
//! [`compile`] says why.

use palpate_field::compile;

use crate::build::{BuiltMotion, BuiltScene, BuiltTool};
use crate::catalogue::described_primitive;
use crate::scene::Scene;

fn in_dimension<const D: usize>() {
    compile![
        Scene::with_all::<D>,
        described_primitive::<D>,
        BuiltTool::<D>::in_hand,
        BuiltMotion::<D>::pose,
        BuiltScene::<D>::bounds,
        BuiltScene::<D>::bounds_with,
        BuiltScene::<D>::device_rotation,
        BuiltScene::<D>::workspace_of,
        BuiltScene::<D>::bodies,
        BuiltScene::<D>::world_with,
        BuiltScene::<D>::smallest_size,
        BuiltScene::<D>::servo_for,
        BuiltScene::<D>::pose_at,
        BuiltScene::<D>::times_of_motion,
        BuiltScene::<D>::way,
        BuiltScene::<D>::at,
    ];
}

/// Never called. It names functions so that this crate compiles them.
#[doc(hidden)]
#[inline(never)]
pub fn instances() {
    in_dimension::<2>();
    in_dimension::<3>();
}
