// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Touching signed distance fields: the haptic proxy, its force and its servo loop.
//!
//! A [`Proxy`] follows a device point but cannot enter the shape; a [`Material`] turns the
//! distance between the two into a force; a [`Servo`] does both for every contact point of a
//! [`Device`], a thousand times a second and more; [`run`] is the loop around it, which paces,
//! counts, records and reports. A [`ServoThread`] runs the same loop beside a program, whose
//! [`Control`] changes what is touched and sees what happens, and never makes the servo wait.
//!
//! A rigid [`Tool`] with a shape is felt as a whole, with force and torque: it is coupled to the hand
//! by a spring, and bodies stop it. A servo renders it [instead](Servo::for_tool) of contact
//! points; on a device that turns, with six degrees of freedom, it turns with the hand and gives
//! it a torque.
//!
//! In free space, a [`Guide`] holds the hand to a point, line, plane or curve, or draws it into a
//! well or down a field. For devices that shake instead of push, [`vibrotactile`] turns touches
//! into vibration.
//!
//! Without hardware, a [`RecordedDevice`] follows a [`HandPath`], recorded or made up by a
//! [`Tour`] of the shape.
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
//!
//! # Examples
//!
//! ```
//! use palpate_field::{Shape, kernel::Ball};
//! use palpate_haptics::{
//!     Pace, RecordedDevice, RunOptions, Servo, Tour, run,
//! };
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
//! let bounds = ball.promise().bounds.ok_or("a ball has bounds")?;
//! let hand = Tour::new(bounds.aabb, 5.0)?.over(&ball)?;
//! let mut device = RecordedDevice::new(vec![hand])?;
//! let mut servo = Servo::for_device(ball, &device)?;
//!
//! let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(5.0) };
//! let report = run(&mut servo, &mut device, options)?;
//! assert!(report.contact_time > 2.5 && report.largest_force < 1.0);
//! assert!(report.evaluations.mean < 4.0);
//! # Ok(())
//! # }
//! ```
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod accepted_bodies;
mod bend;
mod bodies;
#[cfg(test)]
#[path = "../tests/all/common/cases.rs"]
mod cases;
mod clock;
mod contact;
mod contact_point;
mod device;
mod error;
mod event;
mod friction;
mod guide;
mod half_spaces;
mod hand_path;
mod handoff;
mod impedance;
mod limit;
mod live;
mod nearby;
mod pacer;
mod planes;
mod priority;
mod protection;
mod proxy;
mod recorded;
mod recorder;
mod report;
mod rotation;
mod run;
mod safety;
mod sampler;
mod servo;
mod servo_loop;
mod statistics;
mod surface;
mod thread;
mod tool;
mod tour;
mod velocity;
pub mod vibrotactile;
mod workspace;

pub use accepted_bodies::AcceptedBodies;
pub use bodies::{Bodies, Body};
pub use clock::{Clock, ClockDriver, VirtualClock, WallClock};
pub use contact_point::Touch;
pub use device::{Device, DeviceLost, DeviceProfile, PointState, TurnState, TurningProfile};
pub use error::{HapticsError, not_negative, positive};
pub use event::{Event, EventCounts, EventKind, Reaction};
pub use guide::{Curve, Guide, GuideOptions, Slope};
pub use hand_path::{HandPath, Interpolation};
pub use handoff::{Control, HandoffOptions, ServoEnd, StopSwitch, handoff};
pub use impedance::Impedance;
pub use limit::limited;
pub use live::{Progress, Snapshot};
pub use nearby::Nearby;
pub use pacer::Lateness;
pub use palpate_scene::Material;
pub use priority::{Priority, raise_priority};
pub use protection::Protection;
pub use proxy::{DEFAULT_BUDGET, Following, Probe, Proxy};
pub use recorded::RecordedDevice;
pub use recorder::{Energy, Recorder, TraceRow};
pub use report::{Ending, Evaluations, RunReport};
pub use rotation::{turn_between, turned};
pub use run::{Pace, RunOptions, Watch, run, run_on};
pub use safety::{
    Acceptance, Accepted, ContinuousReport, Effect, PassivityReport, PortState, Rule,
    SafetyChain, SafetyOptions, SafetyReport, TurningReport, WatchdogReport,
};
pub use servo::{Renderer, Servo, ServoOptions, UnprotectedServo};
pub use statistics::{Bucket, Distribution};
pub use surface::Surface;
pub use thread::{EndedThread, ServoThread, ThreadOptions};
pub use tool::{
    Coupling, HeldTool, MOST_POINTS, Shell, ShellPoint, Tool, ToolOptions, ToolReport,
    ToolState, ToolTouch,
};
pub use tour::Tour;
pub use velocity::VelocityEstimator;
pub use workspace::WorkspaceMap;
