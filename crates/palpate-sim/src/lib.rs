// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Simulated haptic devices, and the hands that hold them.
//!
//! A [`SimulatedDevice`] moves like a device that a [`Hand`] holds: with mass, damping, friction,
//! encoders, and forces that are held between two writes; with six degrees of freedom it also
//! rotates and holds a torque. The motion is integrated in closed form, so the energy that a
//! servo puts into the hand is known to rounding. A [`RecordedDevice`] and the fingers of a [`Glove`]
//! follow hand paths; a [`Tour`] makes one over a shape. Another thread leads the hand of a
//! [`SteeredDevice`].
//!
//! A [`SimulatedTransport`] lets readings of any device jitter, repeat, stay away or come late by a
//! plan, loses the device, or sets the pace by it.
//!
//! [`identify()`] measures mass, damping, friction and encoder step of any [`Device`].
//!
//! # Examples
//!
//! A hand pushes a stylus onto a wall of 1000 N/m with 1 N, and rests where the wall balances the
//! push, up to the friction of the device:
//!
//! ```
//! use palpate_device::{Device, PointState, profile_named};
//! use palpate_field::Vector;
//! use palpate_sim::{Hand, SimulatedDevice};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let hand = Hand::resting(Vector([0.0, 0.01, 0.0]))?
//!     .with_spring(0.0, 5.0)?
//!     .with_push(Vector([0.0, -1.0, 0.0]))?;
//! let mut device = SimulatedDevice::new(profile_named("omega")?, vec![hand])?;
//! let mut points = [PointState::at_rest(Vector::ZERO)];
//! for tick in 0..2000 {
//!     device.read(1e-3 * f64::from(tick), &mut points)?;
//!     let depth = (-points[0].position[1]).max(0.0);
//!     device.write(&[Vector([0.0, 1000.0 * depth, 0.0])])?;
//! }
//! let force = -1000.0 * points[0].position[1];
//! assert!((force - 1.0).abs() < device.profile().friction + 0.05);
//! # Ok(())
//! # }
//! ```
//!
//! [`Device`]: palpate_device::Device
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod error;
mod glove;
mod hand;
mod hand_path;
mod identify;
mod instances;
mod motion;
mod oscillator;
mod recorded;
mod simulated;
mod steered;
mod tour;
mod transport;
mod turning;

pub use error::{Fault, FaultKind, SimulationError};
pub use glove::Glove;
pub use hand::Hand;
pub use hand_path::{HandPath, Interpolation};
pub use identify::{
    DeviceAxis, EncoderStep, Estimate, Identified, IdentifiedAxis, IdentifyError,
    IdentifyOptions, IdentifyProgress, identify,
};
#[doc(hidden)]
pub use instances::instances;
pub use motion::Energies;
pub use recorded::{RecordedDevice, VibrationRecorder};
pub use simulated::SimulatedDevice;
pub use steered::{SteeredDevice, Steering};
pub use tour::Tour;
pub use transport::{Calls, SimulatedTransport};
