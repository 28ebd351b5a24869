// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Touches as vibration, for devices that shake instead of push.
//!
//! A [`Cue`] describes the touch of a contact point in a tick. A [`Mapping`] turns a cue into a
//! [`Sensation`]: tones of pressure and of sliding, and a tap. A sensation becomes either:
//!
//! - *Commands*, for motors: a [`Voice`] lets taps decay; [`one_channel`], [`two_channels`] and
//!   an [`ActuatorArray`] distribute the [`Tones`]; a [`Publisher`] holds the strongest tone
//!   until a slow device, which [`Vibrates`], takes it.
//! - *Audio*: a [`Synthesiser`] makes the samples of an actuator, and [`write_wav`] writes those
//!   of several actuators to a file.
//!
//! An [`Actuator`] is one of three kinds, each with a profile whose figures name their source: a
//! rotating mass, which has one level for speed and strength and starts late; a resonant actuator,
//! which has one frequency; a voice coil, which has a band. A [`Synthesiser`] for an actuator moves
//! a touch to what the actuator can play, with the strength that it has above the threshold of the
//! skin ([`threshold_db`]). An [`ActuatorModel`] says how the actuator shakes then, and
//! [`sensation_level`] how strongly that is felt.

#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod actuator;
mod audio;
mod channels;
mod cue;
mod limiter;
mod publisher;
mod ringing;
mod sensation_level;
mod strength;

pub use actuator::{ACTUATORS, Actuator, ActuatorModel, Mechanism, actuator_named};
pub use audio::{Synthesiser, write_wav};
pub use channels::{ActuatorArray, TwoChannels, Vibrates, one_channel, phantom, two_channels};
pub use cue::{Cue, Mapping, MappingOptions, Sensation, Tap, Tone};
pub use limiter::Limiting;
pub use publisher::{Command, Publisher};
pub use ringing::{Tones, Voice};
pub use sensation_level::{
    Adaptation, Faded, perceptual_weight, sensation_level, threshold_db,
};
