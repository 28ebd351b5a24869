// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a driver of a haptic device needs.
//!
//! A new device implements [`Device`]; `palpate/examples/custom_device.rs` is one. A
//! [`DeviceProfile`] holds its limits, [`profile_named`] those of known devices, each with its
//! source. Where a driver runs in a thread of its own, or in another language, the servo uses a
//! [`MailboxDevice`], and the driver its [`Mailbox`].
//!
//! Two channels connect an ordinary thread to one that must not wait: [`latest_value`] for values
//! of which the newest counts, and [`edit_channel`] for changes that arrive together.
//!
//! Simulated devices are in `palpate-sim`, the safety chain in `palpate-safety`, the servo in
//! `palpate-haptics`.
// Every tick runs through this crate: it must not panic.
#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod buttons;
mod device;
mod edits;
mod error;
mod gripper_profile;
mod latest;
mod limit;
mod mailbox;
mod number;
mod place;
mod profile;
mod profiles;
mod state;
mod turning_profile;
mod wrists;

pub use buttons::Buttons;
pub use device::{Device, DeviceLost};
pub use edits::{EditReceiver, EditSender, Parcel, edit_channel};
pub use error::DeviceError;
pub use gripper_profile::GripperProfile;
pub use latest::{LatestReader, LatestWriter, latest_value};
pub use limit::{limited, shortened, shortening};
pub use mailbox::{Mailbox, MailboxDevice};
pub use number::{NumberError, Short};
pub use profile::DeviceProfile;
pub use profiles::{PROFILES, profile_named};
pub use state::{GripperState, PointState, Reading, TurnState};
pub use turning_profile::TurningProfile;
