// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Compiles servos, proxies and tools in this crate.
//! [`compile`] says why.

use palpate_field::compile;

use crate::servo::Renderer;
use crate::{
    Bodies, Body, Control, Curve, Guide, Nearby, Protected, Protection, Proxy, Servo, Shell,
    Tool, Unprotected,
};

fn touch() {
    compile![
        Body::at,
        Body::passing,
        Bodies::new,
        Nearby::look,
        Nearby::nearest,
        Nearby::gradient,
        Proxy::new,
        Proxy::forget_bodies,
        Proxy::follow,
        Proxy::carry_out,
        Shell::capsule,
        Shell::from_field::<3>,
        Shell::from_mesh::<3, 3>,
        Shell::from_field::<2>,
        Tool::new,
        Tool::hover,
        Tool::step,
        Curve::polyline,
        Curve::smooth,
        Guide::along_curve,
        Guide::down,
        Guide::force,
        Guide::lines_within,
        Protection::accept,
        Protection::accept_guides,
        Protection::accepted_bodies,
        Renderer::of_points,
        Renderer::of_tool,
        Renderer::requested_coupling,
        Renderer::set_map,
        Renderer::set_ports,
        Renderer::set_pose,
        Renderer::adopt,
        Renderer::exchange,
        Renderer::guide,
        Renderer::exchange_guides,
        Renderer::limit_force,
        Renderer::limit_torque,
        Renderer::lift,
        Renderer::stop,
        Renderer::step,
        Renderer::rehearse,
        Renderer::safety,
        Renderer::stage_effects,
        Servo::<Unprotected>::protected,
        Servo::<Protected>::guide,
        Control::set_poses,
        Control::replace_guides,
        Control::latest,
    ];
}

#[cfg(feature = "loop")]
fn loops() {
    use crate::servo_loop::{ServoThread, run_on, ticks::ServoLoop};
    compile![
        ServoLoop::new,
        ServoLoop::run,
        run_on,
        ServoThread::start,
        ServoThread::end,
        ServoThread::join,
    ];
}

/// Never called. It names functions so that this crate compiles them.
#[doc(hidden)]
#[inline(never)]
pub fn instances() {
    touch();
    #[cfg(feature = "loop")]
    loops();
}
