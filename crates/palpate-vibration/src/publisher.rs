// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! From the servo's rate to that of a slow device, without losing a tap.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use super::cue::{Tone, level};
use palpate_device::{DeviceError, NumberError};

/// A command to a device: what to play on a channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// The tone.
    pub tone: Tone,
    /// The duration [s]: the device stops by itself without a further command.
    pub duration: f64,
}

/// The duration of a command in publishing periods: a device may miss one or two commands, and
/// falls silent soon after its program has died.
const PERIODS: f64 = 2.5;

/// Holds the strongest tone of each channel until it is time to publish.
///
/// A tap of 5 ms between two commands 20 ms apart is therefore played at full amplitude. Each
/// command has a duration of 2.5 periods, so that no tone gets stuck.
///
/// ```
/// use palpate_vibration::{Publisher, Tone};
///
/// # fn main() -> Result<(), palpate_device::DeviceError> {
/// let mut publisher = Publisher::new(1, 1000.0, 50.0)?;
/// let tap = Tone { frequency: 200.0, amplitude: 0.75 };
/// for tick in 1..20 {
///     let tone = if tick < 5 { tap } else { Tone::default() };
///     assert!(publisher.mix(&[tone]).is_none());
/// }
/// let commands = publisher.mix(&[Tone::default()]).unwrap_or_default();
/// assert_eq!((commands[0].tone, commands[0].duration), (tap, 0.05));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Publisher {
    held: Vec<Tone>,
    commands: Vec<Command>,
    servo_rate: f64,
    publish_rate: f64,
    /// Commands due, in units of `1 / servo_rate`.
    due: f64,
}

impl Publisher {
    /// A publisher of `channels` channels that takes tones at `servo_rate` [Hz] and publishes
    /// commands at `publish_rate` [Hz].
    ///
    /// # Errors
    ///
    /// [`DeviceError::NoContactPoint`] without a channel; [`DeviceError::Number`] if a rate
    /// is not positive, or the publish rate exceeds the servo rate.
    pub fn new(
        channels: usize,
        servo_rate: f64,
        publish_rate: f64,
    ) -> Result<Self, DeviceError> {
        if channels == 0 {
            return Err(DeviceError::NoContactPoint);
        }
        NumberError::check_positive("servo_rate", servo_rate, "Hz")?;
        NumberError::check_positive("publish_rate", publish_rate, "Hz")?;
        if publish_rate > servo_rate {
            let (parameter, rule) = ("publish_rate", "at most the servo's rate");
            let (value, unit) = (publish_rate, "Hz");
            return Err(NumberError::new(parameter, rule, value, unit).into());
        }
        let (held, commands) =
            (vec![Tone::default(); channels], vec![Command::default(); channels]);
        Ok(Self { held, commands, servo_rate, publish_rate, due: 0.0 })
    }

    /// One tick of the servo: the tone of each channel, silence for those missing. Returns the
    /// commands in the ticks in which they are due.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn mix(&mut self, tones: &[Tone]) -> Option<&[Command]> {
        for (held, tone) in self.held.iter_mut().zip(tones) {
            // Written so that NaN is not held.
            if tone.amplitude > held.amplitude {
                *held = Tone { amplitude: level(tone.amplitude), ..*tone };
            }
        }
        self.due += self.publish_rate;
        if self.due < self.servo_rate {
            return None;
        }
        self.due -= self.servo_rate;
        let duration = PERIODS / self.publish_rate;
        for (command, held) in self.commands.iter_mut().zip(&mut self.held) {
            *command = Command { tone: std::mem::take(held), duration };
        }
        Some(&self.commands)
    }
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "tests know their lengths")]
mod tests {
    use super::*;

    #[test]
    fn no_tap_is_lost_at_any_time_or_rate() {
        for publish_rate in [50.0, 60.0, 90.0, 333.0, 1000.0] {
            for at in 0..100 {
                let mut publisher = Publisher::new(2, 1000.0, publish_rate).unwrap();
                let mut strongest: f64 = 0.0;
                for tick in 0..200 {
                    let amplitude = if tick == at { 0.9 } else { 0.1 };
                    let tones = [Tone::default(), Tone { frequency: 100.0, amplitude }];
                    if let Some(commands) = publisher.mix(&tones) {
                        assert_eq!(commands[0].tone.amplitude, 0.0);
                        strongest = strongest.max(commands[1].tone.amplitude);
                    }
                }
                assert_eq!(strongest, 0.9, "{publish_rate} Hz, tick {at}");
            }
        }
    }

    #[test]
    fn as_many_are_published_as_asked_and_each_ends() {
        let mut publisher = Publisher::new(1, 1000.0, 60.0).unwrap();
        let mut published = 0;
        for _ in 0..10_000 {
            if let Some(commands) = publisher.mix(&[]) {
                let duration = commands[0].duration;
                assert!((2.0 / 60.0..=3.0 / 60.0).contains(&duration));
                published += 1;
            }
        }
        assert_eq!(published, 600);
    }

    #[test]
    fn silence_follows_a_tap_and_nan_is_silence() {
        let mut publisher = Publisher::new(1, 100.0, 50.0).unwrap();
        let nan = Tone { frequency: f64::NAN, amplitude: f64::NAN };
        let loud = Tone { frequency: 100.0, amplitude: f64::INFINITY };
        assert!(publisher.mix(&[loud]).is_none());
        assert_eq!(publisher.mix(&[nan]).unwrap()[0].tone.amplitude, 1.0);
        assert!(publisher.mix(&[nan]).is_none());
        assert_eq!(publisher.mix(&[nan]).unwrap()[0].tone, Tone::default());
    }

    #[test]
    fn wrong_rates_are_named() {
        let error = Publisher::new(1, 50.0, 60.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "publish_rate must be at most the servo's rate, got 60 Hz"
        );
        assert!(Publisher::new(0, 1000.0, 50.0).is_err());
        assert!(Publisher::new(1, f64::NAN, 50.0).is_err());
    }
}
