// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Touching signed distance fields: the haptic proxy, its force and the servo.
//!
//! A [`Proxy`] (a god-object with a radius) follows a device point but cannot enter the shape.
//! A [`Material`] turns the distance between proxy and device point into a force. A [`Servo`]
//! moves the proxies and computes the forces for every contact point of a [`Device`], a thousand
//! times a second and more.
//! Through a [`handoff`](handoff()), another thread replaces bodies and reads snapshots without
//! ever making the servo wait.
//!
//! The [`servo_loop`] runs a servo: it paces, counts, records and reports.
//!
//! A rigid [`Tool`] renders contact of a whole shape, with force and torque: a virtual coupling
//! connects it to the hand, and bodies stop it. A servo made by [`Servo::for_tool`] renders a tool
//! instead of contact points. On a device with six degrees of freedom the
//! tool turns with the hand and gives a torque.
//!
//! In free space, a [`Guide`] holds the hand to a point, line, plane or curve, or pulls it into
//! a well or along a field's negative gradient.
//!
//! A [`Device`](palpate_device::Device) is what the servo drives; simulated and recorded ones are in
//! `palpate-sim`. `palpate-vibration` turns [touches](Touch::cue) into vibration for devices that
//! shake instead of push.
//!
//! # What is promised
//!
//! - *The proxy crosses no surface.* It moves only where an evaluation and the field's
//!   Lipschitz constant prove the path free, at any speed of the hand. A probe that is a point may
//!   cross walls thinner than 1e-4 of the bounding radius.
//! - *The step always ends, in bounded work.* [`Servo::step`] allocates nothing, takes no lock,
//!   does not panic and evaluates the shape at most [`Probe::budget`] times for each contact
//!   point, and a few times more for magnets and textures. A proxy that runs out of budget lags
//!   behind; it does not enter a body.
//! - *The force of contact never pulls*, is finite, and is no larger than the device's largest
//!   force.
//! - *No lengths are built in.* Every tolerance follows from the size of the shape, the probe
//!   and the motion, so that scenes of a micrometre and of a kilometre feel alike if the probe is
//!   scaled with them.
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod accepted_bodies;
mod bodies;
mod contact;
mod contact_point;
mod coupled_tool;
mod crease;
mod curvature;
mod error;
mod event;
mod guide;
mod handoff;
mod instances;
mod live;
mod magnetism;
mod material;
mod nearby;
mod planes;
mod ports;
mod proxy;
mod sampler;
mod seam;
mod servo;
#[cfg(feature = "loop")]
pub mod servo_loop;
mod squeeze;
mod surface;
mod tool;

pub use accepted_bodies::{AcceptedBodies, AcceptedTexture, Protection};
pub use bodies::{Bodies, Body, NextPose};
pub use contact_point::Touch;
pub use error::{HapticsError, ServoOptions};
pub use event::{Energy, Event, EventCounts, EventKind, Reaction};
pub use guide::{Curve, Guide, GuideOptions, Slope};
pub use handoff::{Control, HandoffOptions, ServoEnd, StopSwitch, handoff, handoff_with};
#[doc(hidden)]
pub use instances::instances;
pub use live::{Progress, Snapshot};
pub use material::{Impact, Layer, Magnet, Material, PopThrough, Texture, TextureKind};
pub use nearby::Nearby;
pub use proxy::{DEFAULT_BUDGET, Edited, Following, Probe, Proxy};
pub use servo::{Kind, Protected, Renderer, Servo, Unprotected};
pub use surface::{Passing, Surface};
pub use tool::{
    Coupling, Handle, HeldTool, MOST_POINTS, Shell, ShellPoint, Tool, ToolOptions, ToolState,
    ToolTouch,
};
