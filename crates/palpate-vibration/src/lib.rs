// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Touches as vibration, for devices that shake instead of push.
//!
//! A [`Cue`] describes the touch of a contact point in a tick. A [`Mapping`] turns a cue into a
//! [`Sensation`]: tones of pressure and of sliding, and a tap. A sensation becomes either:
//!
//! - *Commands*, for motors: a [`Voice`] lets taps decay; [`one_channel`], [`two_channels`] and
//!   an [`ActuatorArray`] distribute the [`Tones`]; a [`Publisher`] holds the strongest tone
//!   until a slow device takes it.
//! - *Audio*, for voice coils: a [`Synthesiser`] makes samples, and [`write_wav`] writes them
//!   to a file.

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
