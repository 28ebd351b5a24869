// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The interface of a device that shakes.

use crate::publisher::Command;
use palpate_device::DeviceLost;

/// A device with actuators that play commands: a glove, a vest, a controller with a motor.
///
/// It may be a haptic device too, or stand beside one: forces and vibration often take different
/// ways, at different rates.
///
/// # Examples
///
/// A motor with one byte for its level:
///
/// ```
/// use palpate_device::DeviceLost;
/// use palpate_vibration::{Command, Tone, Vibrates};
///
/// struct Motor {
///     level: u8,
/// }
///
/// impl Vibrates for Motor {
///     fn channels(&self) -> usize {
///         1
///     }
///
///     fn play(&mut self, commands: &[Command]) -> Result<(), DeviceLost> {
///         for command in commands {
///             self.level = (255.0 * command.tone.amplitude).round() as u8;
///         }
///         Ok(())
///     }
/// }
///
/// let mut motor = Motor { level: 0 };
/// let tone = Tone { frequency: 170.0, amplitude: 0.6 };
/// motor.play(&[Command { tone, duration: 0.05 }])?;
/// assert_eq!(motor.level, 153);
/// # Ok::<(), DeviceLost>(())
/// ```
pub trait Vibrates {
    /// The number of actuators; it never changes.
    fn channels(&self) -> usize;

    /// Plays one command on each actuator, in place of what they play. An actuator falls silent by
    /// itself at the end of its command's duration; an amplitude of zero silences it at once.
    ///
    /// Real-time: called at the rate of the commands from the servo's loop, and must return well
    /// within a tick. A transport that blocks takes them through a queue of its own.
    ///
    /// # Errors
    ///
    /// [`DeviceLost`] if nothing more can be played.
    fn play(&mut self, commands: &[Command]) -> Result<(), DeviceLost>;
}

impl<V: Vibrates + ?Sized> Vibrates for &mut V {
    fn channels(&self) -> usize {
        (**self).channels()
    }

    fn play(&mut self, commands: &[Command]) -> Result<(), DeviceLost> {
        (**self).play(commands)
    }
}

impl<V: Vibrates + ?Sized> Vibrates for Box<V> {
    fn channels(&self) -> usize {
        (**self).channels()
    }

    fn play(&mut self, commands: &[Command]) -> Result<(), DeviceLost> {
        (**self).play(commands)
    }
}
