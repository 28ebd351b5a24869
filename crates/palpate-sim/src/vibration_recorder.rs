// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A device that shakes without hardware.

use palpate_device::DeviceLost;
use palpate_vibration::{Command, Vibrates};

/// Keeps the commands to a device that vibrates, for tests and for looking at what would be played.
///
/// ```
/// use palpate_sim::VibrationRecorder;
/// use palpate_vibration::{Command, Tone, Vibrates};
///
/// let mut glove = VibrationRecorder::new(2);
/// let tap = Command { tone: Tone { frequency: 200.0, amplitude: 0.5 }, duration: 0.05 };
/// glove.play(&[tap, Command::default()])?;
/// assert_eq!(glove.played().next(), Some(&[tap, Command::default()][..]));
/// # Ok::<(), palpate_device::DeviceLost>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VibrationRecorder {
    channels: usize,
    commands: Vec<Command>,
}

impl VibrationRecorder {
    /// A device with so many actuators.
    #[must_use]
    pub fn new(channels: usize) -> Self {
        Self { channels, commands: Vec::new() }
    }

    /// The commands, in order of time: one for each actuator at a time.
    pub fn played(&self) -> impl Iterator<Item = &[Command]> + Clone {
        self.commands.chunks(self.channels.max(1))
    }
}

impl Vibrates for VibrationRecorder {
    fn channels(&self) -> usize {
        self.channels
    }

    /// Allocates: not for a servo that runs in real time.
    fn play(&mut self, commands: &[Command]) -> Result<(), DeviceLost> {
        let missing = self.channels.saturating_sub(commands.len());
        self.commands.extend(commands.iter().take(self.channels));
        self.commands.extend(std::iter::repeat_n(Command::default(), missing));
        Ok(())
    }
}
