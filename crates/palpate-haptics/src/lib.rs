// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Touching signed distance fields: the haptic proxy, its force and the servo.
//!
//! A [`Proxy`] follows a device point but cannot enter the shape; a [`Material`] turns the
//! distance between the two into a force; a [`Servo`] does both for every contact point of a
//! [`Device`], a thousand times a second and more. Through a [`handoff`](handoff()), another
//! thread changes what is touched and sees what happens, and never makes the servo wait.
//!
//! The loop around a servo, which paces, counts, records and reports, is in `palpate-loop`.
//!
//! A rigid [`Tool`] with a shape is felt as a whole, with force and torque: it is coupled to the hand
//! by a spring, and bodies stop it. A servo renders it [instead](Servo::for_tool) of contact
//! points; on a device that turns, with six degrees of freedom, it turns with the hand and gives
//! it a torque.
//!
//! In free space, a [`Guide`] holds the hand to a point, line, plane or curve, or draws it into a
//! well or down a field.
//!
//! Devices to touch with, simulated, recorded or made up, are in `palpate-devices`; vibration for
//! devices that shake instead of push is in `palpate-vibration`.
//!
//! # What is promised
//!
//! - *Nothing is crossed.* The proxy moves only where an evaluation and the field's Lipschitz
//!   constant prove the way free, at any speed of the hand.
//! - *The step is total.* [`Servo::step`] allocates nothing, takes no lock, does not panic and
//!   evaluates the shape at most [`Probe::budget`] times a point. Out of budget, a proxy lags
//!   behind; it never ends up inside.
//! - *The force never pulls*, is finite, and no larger than the device's largest.
//! - *No lengths are built in.* Every tolerance follows from the shape's size, the probe and the
//!   motion, so scenes of a micrometre and of a kilometre feel alike.
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod accepted_bodies;
mod bend;
mod bodies;
mod contact;
mod contact_point;
mod energy;
mod error;
mod event;
mod friction;
mod guide;
mod half_spaces;
mod handoff;
mod live;
mod material;
mod nearby;
mod planes;
mod protection;
mod proxy;
mod sampler;
mod servo;
mod surface;
mod tool;

pub use accepted_bodies::AcceptedBodies;
pub use bodies::{Bodies, Body};
pub use contact_point::Touch;
pub use energy::Energy;
pub use error::HapticsError;
pub use event::{Event, EventCounts, EventKind, Reaction};
pub use guide::{Curve, Guide, GuideOptions, Slope};
pub use handoff::{
    Control, HandoffOptions, LatestReader, LatestWriter, ServoEnd, StopSwitch, handoff,
    latest_value,
};
pub use live::{Progress, Snapshot};
pub use material::{
    Impact, Layer, Magnet, Material, PopThrough, Texture, TextureKind, UnknownMaterial,
};
pub use nearby::Nearby;
pub use palpate_safety::{
    Acceptance, Accepted, ContinuousReport, Device, DeviceLost, DeviceProfile, Effect,
    Impedance, NumberError, PassivityReport, PointState, PortState, Rule, SafetyChain,
    SafetyError, SafetyOptions, SafetyReport, TurnState, TurningProfile, TurningReport,
    VelocityEstimator, WatchdogReport, WorkspaceMap, limited, not_negative, positive,
    turn_between, turned,
};
pub use protection::Protection;
pub use proxy::{DEFAULT_BUDGET, Following, Probe, Proxy};
pub use servo::{Renderer, Servo, ServoOptions, UnprotectedServo};
pub use surface::Surface;
pub use tool::{
    Coupling, HeldTool, MOST_POINTS, Shell, ShellPoint, Tool, ToolOptions, ToolState, ToolTouch,
};
