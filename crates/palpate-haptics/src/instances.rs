// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Compiles servos, proxies and tools in this crate, for the plane and for space.
//! [`compile`] says why.

use palpate_field::compile;

use crate::servo::Renderer;
use crate::{
    Bodies, Body, Control, Curve, Guide, Nearby, Protected, Protection, Proxy, Servo, Shell,
    Tool, Unprotected,
};

fn in_dimension<const D: usize>() {
    compile![
        Body::<D>::at,
        Body::<D>::passing,
        Bodies::<D>::new,
        Nearby::<D>::look,
        Nearby::<D>::nearest,
        Nearby::<D>::gradient,
        Proxy::<D>::new,
        Proxy::<D>::forget_bodies,
        Proxy::<D>::follow,
        Proxy::<D>::carry_out,
        Shell::<D>::capsule,
        Shell::<D>::from_field,
        Shell::<D>::from_mesh::<D>,
        Shell::<D>::of_shape,
        Tool::<D>::new,
        Tool::<D>::hover,
        Tool::<D>::step,
        Curve::<D>::polyline,
        Curve::<D>::smooth,
        Guide::<D>::along_curve,
        Guide::<D>::down,
        Guide::<D>::force,
        Guide::<D>::lines_within,
        Protection::<D>::accept,
        Protection::<D>::accept_guides,
        Protection::<D>::accepted_bodies,
        Renderer::<D>::of_points,
        Renderer::<D>::of_tool,
        Renderer::<D>::requested_coupling,
        Renderer::<D>::set_map,
        Renderer::<D>::set_ports,
        Renderer::<D>::set_pose,
        Renderer::<D>::adopt,
        Renderer::<D>::exchange,
        Renderer::<D>::guide,
        Renderer::<D>::exchange_guides,
        Renderer::<D>::limit_force,
        Renderer::<D>::limit_torque,
        Renderer::<D>::lift,
        Renderer::<D>::stop,
        Renderer::<D>::step,
        Renderer::<D>::rehearse,
        Renderer::<D>::safety,
        Renderer::<D>::stage_ticks,
        Servo::<D, Unprotected>::protected,
        Servo::<D, Protected<D>>::guide,
        Control::<D>::set_poses,
        Control::<D>::replace_guides,
        Control::<D>::latest,
    ];
}

#[cfg(feature = "loop")]
fn loops_in_dimension<const D: usize>() {
    use crate::servo_loop::{ServoThread, run_on, ticks::ServoLoop};
    compile![
        ServoLoop::<D>::new,
        ServoLoop::<D>::run,
        run_on::<D>,
        ServoThread::<D>::start,
        ServoThread::<D>::end,
        ServoThread::<D>::join,
    ];
}

/// Never called. It names functions so that this crate compiles them.
#[doc(hidden)]
#[inline(never)]
pub fn instances() {
    in_dimension::<2>();
    in_dimension::<3>();
    #[cfg(feature = "loop")]
    {
        loops_in_dimension::<2>();
        loops_in_dimension::<3>();
    }
}
