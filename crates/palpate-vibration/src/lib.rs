// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Vibration for devices that cannot push: what a touch is to an actuator that shakes.
//!
//! A [`Cue`] says what a contact point meets in a tick; a [`Mapping`] turns it into a
//! [`Sensation`]: a level that holds, a tone that slides, a tap that rings. From there two ways:
//!
//! - *Commands*, for motors: a [`Voice`] lets taps ring down, [`one_channel`], [`two_channels`]
//!   and an [`ActuatorArray`] share the [`Tones`] out, and a [`Publisher`] holds the largest
//!   until a slow device takes it.
//! - *Audio*, for voice coils: a [`Synthesiser`] makes samples, and [`write_wav`] a file of them.

#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod audio;
mod channels;
mod cue;
mod publisher;
mod ringing;
mod threshold;
mod wav;

pub use audio::Synthesiser;
pub use channels::{ActuatorArray, TwoChannels, one_channel, phantom, two_channels};
pub use cue::{Cue, Mapping, MappingOptions, Sensation, Tap, Tone};
pub use publisher::{Command, Publisher};
pub use ringing::{Tones, Voice};
pub use threshold::{perceptual_weight, threshold_db};
pub use wav::write_wav;
