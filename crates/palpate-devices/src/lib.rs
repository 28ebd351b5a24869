// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Haptic devices: profiles of known devices, simulated devices, gloves, and the trait for new
//! ones.
//!
//! [`profile_named`] gives the limits of real devices, each with its source. A
//! [`SimulatedDevice`] moves like a device that a [`Hand`] holds: with mass, damping, friction,
//! encoders, and forces that are held between two writes; with six degrees of freedom it also
//! rotates and holds a torque. The motion is integrated in closed form, so the energy that a
//! servo puts into the hand is known to rounding. A [`Glove`] has many fingers that follow hand
//! paths.
//!
//! Another thread leads the hand of a [`SteeredDevice`]; a [`MailboxDevice`] takes its positions
//! from a driver in another thread, and leaves its forces there.
//!
//! A [`SimulatedTransport`] lets readings of any device jitter, repeat, stay away or come late by a
//! plan, loses the device, or sets the pace by it.
//!
//! A new device implements [`Device`]; `palpate/examples/custom_device.rs` is one.
//!
//! # Examples
//!
//! A simulated stylus is pushed onto a ball with 1 N, and rests where the ball's stiffness
//! balances the push:
//!
//! ```
//! use palpate_devices::{Device, Hand, SimulatedDevice, profile_named};
//! use palpate_field::{Shape, Vector, kernel::Ball};
//! use palpate_haptics::{Bodies, Body, Servo, Surface};
//! use palpate_loop::{Pace, RunOptions, run};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let hand = Hand::resting(Vector([0.0, 0.06, 0.0]))?
//!     .with_spring(0.0, 5.0)?
//!     .with_push(Vector([0.0, -1.0, 0.0]))?;
//! let mut device = SimulatedDevice::new(profile_named("omega")?, vec![hand])?;
//! let ball = Body::new(Shape::from_kernel(Ball::new(0.05)?), Surface::smooth(1000.0, 0.0)?)?;
//! let mut servo = Servo::for_device(Bodies::new(vec![ball])?, &device)?;
//! let paced = RunOptions::new(2.0).with_pace(Pace::AsFastAsPossible);
//! run(&mut servo, &mut device, paced)?;
//!
//! let friction = device.profile().friction;
//! let depth = servo.touches()[0].depth();
//! assert!((depth * 1000.0 - 1.0).abs() < friction + 0.05);
//! # Ok(())
//! # }
//! ```
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod error;
mod fault;
mod glove;
mod hand;
mod hand_path;
mod identify;
mod instances;
mod mailbox;
mod motion;
mod oscillator;
mod profiles;
mod recorded;
mod script;
mod simulated;
pub mod stability;
mod steered;
mod tour;
mod transport;
mod turning;
mod vibration_recorder;
mod wrists;

pub use error::DeviceError;
pub use fault::{Fault, FaultKind};
pub use glove::Glove;
pub use hand::Hand;
pub use hand_path::{HandPath, Interpolation};
pub use identify::{
    DeviceAxis, EncoderStep, Estimate, Identified, IdentifiedAxis, IdentifyError,
    IdentifyOptions, IdentifyProgress, identify,
};
#[doc(hidden)]
pub use instances::instances;
pub use mailbox::{Mailbox, MailboxDevice};
pub use motion::Energies;
pub use palpate_haptics::{
    Buttons, Device, DeviceLost, DeviceProfile, GripperProfile, GripperState, PointState,
    Reading, TurnState, TurningProfile,
};
pub use profiles::{PROFILES, UnknownDevice, profile_named};
pub use recorded::RecordedDevice;
pub use simulated::SimulatedDevice;
pub use steered::{SteeredDevice, Steering};
pub use tour::Tour;
pub use transport::{Calls, SimulatedTransport};
pub use vibration_recorder::VibrationRecorder;
