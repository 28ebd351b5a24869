// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The touches of a running servo as commands to a device that vibrates.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::{HapticsError, Material, Servo, Touch};
use palpate_vibration::{
    Command, Cue, Mapping, Publisher, Tap, Tone, Vibrates, Voice, one_channel,
};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// How often commands are sent unless asked otherwise [Hz]: what wireless gloves and vests take.
const COMMAND_RATE: f64 = 50.0;

/// Plays the touches of each contact point on an actuator of a device, in a
/// [run](super::RunOptions::vibration) or in a
/// [thread](super::ThreadOptions::vibration).
///
/// # Examples
///
/// A finger that taps on wood is felt as a tap, then as a pressure:
///
/// ```
/// use palpate_sim::{Glove, HandPath, Interpolation, VibrationRecorder};
/// use palpate_field::Shape;
/// use palpate_haptics::{Bodies, Body, Material, Servo, Surface};
/// use palpate_haptics::servo_loop::{Pace, RunOptions, Vibration, run};
/// use palpate_vibration::{Mapping, MappingOptions};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ends = vec![[0.0, 0.03, 0.0].into(), [0.0, -0.001, 0.0].into()];
/// let mut glove = Glove::new(vec![HandPath::new(vec![0.0, 0.5], ends, Interpolation::Smooth)?])?;
/// let wood = Material::preset("wood")?;
/// let table = Body::new(Shape::half_space([0.0, 1.0], 0.0)?, Surface::new(&wood)?)?;
/// let mut servo = Servo::for_device(Bodies::new(vec![table])?, &glove)?;
///
/// let mut vest = VibrationRecorder::new(1);
/// let mapping = Mapping::new(MappingOptions::default())?;
/// let vibration = Vibration::new(mapping, &mut vest).with_materials(&[wood]);
/// let options = RunOptions {
///     pace: Pace::AsFastAsPossible,
///     vibration: Some(vibration),
///     ..RunOptions::new(1.0)
/// };
/// let report = run(&mut servo, &mut glove, options)?;
/// assert_eq!(report.vibration.map(|played| played.commands), Some(50));
/// let amplitudes = vest.played().map(|commands| commands[0].tone.amplitude);
/// assert!(amplitudes.clone().next() == Some(0.0) && amplitudes.fold(0.0, f64::max) > 0.1);
/// # Ok(())
/// # }
/// ```
pub struct Vibration<'a> {
    mapping: Mapping,
    command_rate: f64,
    /// For each body the wavelength of its texture [m], and the ringing of a tap.
    materials: Vec<(Option<f64>, Option<Tap>)>,
    device: Box<dyn Vibrates + Send + 'a>,
}

impl<'a> Vibration<'a> {
    /// Plays touches by `mapping` on `device`, which has an actuator for each contact point; 50
    /// times a second, on smooth and mute bodies. The device may be borrowed; a thread needs one
    /// of its own.
    #[must_use]
    pub fn new(mapping: Mapping, device: impl Vibrates + Send + 'a) -> Self {
        let device = Box::new(device);
        Self { mapping, command_rate: COMMAND_RATE, materials: Vec::new(), device }
    }

    /// The same with commands sent so often [Hz], at most as often as the servo ticks.
    #[must_use]
    pub fn with_command_rate(self, command_rate: f64) -> Self {
        Self { command_rate, ..self }
    }

    /// The same with the textures and taps of bodies of these materials, in the order of bodies.
    #[must_use]
    pub fn with_materials(mut self, materials: &[Material]) -> Self {
        let felt = |material: &Material| {
            let texture = material.texture.as_ref();
            (texture.map(|texture| texture.wavelength), material.impact.as_ref().map(Tap::from))
        };
        self.materials = materials.iter().map(felt).collect();
        self
    }

    /// The device.
    #[must_use]
    pub fn into_device(self) -> Box<dyn Vibrates + Send + 'a> {
        self.device
    }

    /// Begins to play the touches of `servo`.
    pub(crate) fn start(self, servo: &Servo) -> Result<Player<'a>, HapticsError> {
        let (points, rate) = (servo.touches().len(), servo.options().rate);
        let channels = self.device.channels();
        if channels != points {
            return Err(HapticsError::ContactPoints { servo: points, device: channels });
        }
        Ok(Player {
            voices: vec![Voice::new(&self.mapping, rate)?; points],
            publisher: Publisher::new(points, rate, self.command_rate)?,
            tones: vec![Tone::default(); points],
            touched: vec![false; points],
            silence: vec![Command::default(); points],
            vibration: self,
            report: VibrationReport::default(),
        })
    }
}

impl std::fmt::Debug for Vibration<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Vibration")
            .field("mapping", &self.mapping)
            .field("command_rate", &self.command_rate)
            .finish_non_exhaustive()
    }
}

/// What a run played on a device that vibrates.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct VibrationReport {
    /// How often commands were sent.
    pub commands: u64,
    /// The strongest amplitude, as a part of the actuators' largest.
    pub strongest: f64,
    /// Why the device plays no more; `None` if it does.
    pub lost: Option<String>,
}

/// Plays the touches of a servo that runs.
#[derive(Debug)]
pub(crate) struct Player<'a> {
    vibration: Vibration<'a>,
    voices: Vec<Voice>,
    publisher: Publisher,
    tones: Vec<Tone>,
    /// Whether each contact point was in contact in the tick before.
    touched: Vec<bool>,
    silence: Vec<Command>,
    report: VibrationReport,
}

impl<'a> Player<'a> {
    /// Plays a tick.
    ///
    /// Real-time: allocates nothing until the device is lost, takes no lock, cannot panic unless
    /// the device does.
    pub(crate) fn tick(&mut self, servo: &Servo) {
        let Self { vibration, voices, publisher, tones, touched, report, .. } = self;
        if report.lost.is_some() {
            return;
        }
        let points = servo.touches().iter().zip(voices).zip(tones.iter_mut()).zip(touched);
        for (((touch, voice), tone), touched) in points {
            let was_touched = std::mem::replace(touched, touch.contact);
            let began = touch.contact && !was_touched;
            let cue = vibration.cue(touch, began);
            *tone = one_channel(&voice.step(&vibration.mapping.feel(&cue)));
        }
        let Some(commands) = publisher.mix(tones) else { return };
        report.commands += 1;
        let amplitudes = commands.iter().map(|command| command.tone.amplitude);
        report.strongest = amplitudes.fold(report.strongest, f64::max);
        report.lost = vibration.device.play(commands).err().map(|lost| lost.reason);
    }

    /// Silences the device, and returns what was played.
    pub(crate) fn finish(&mut self) -> VibrationReport {
        if self.report.lost.is_none() {
            let silenced = AssertUnwindSafe(|| self.vibration.device.play(&self.silence));
            self.report.lost = match catch_unwind(silenced) {
                Ok(played) => played.err().map(|lost| lost.reason),
                Err(_) => Some("it panicked".to_owned()),
            };
        }
        std::mem::take(&mut self.report)
    }

    pub(crate) fn into_vibration(self) -> Vibration<'a> {
        self.vibration
    }
}

impl Vibration<'_> {
    /// The cue of a touch, on the material of its body.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    fn cue(&self, touch: &Touch, began: bool) -> Cue {
        let cue = touch.cue(began);
        match self.materials.get(touch.body as usize).filter(|_| touch.contact) {
            Some(&(wavelength, impact)) => Cue { wavelength, impact, ..cue },
            None => cue,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Protection, Servo, ServoOptions};
    use assert_no_alloc::assert_no_alloc;
    use palpate_device::{DeviceProfile, PointState};
    use palpate_field::{Shape, Vector};
    use palpate_vibration::MappingOptions;

    use super::*;

    /// A motor that keeps its last amplitude.
    struct Motor(f64);

    impl Vibrates for Motor {
        fn channels(&self) -> usize {
            1
        }
        fn play(&mut self, commands: &[Command]) -> Result<(), palpate_device::DeviceLost> {
            self.0 = commands.iter().map(|command| command.tone.amplitude).sum();
            Ok(())
        }
    }

    #[test]
    fn playing_allocates_and_frees_nothing() {
        let circle = Shape::circle(0.05).unwrap();
        let servo = Servo::new(circle, 1, ServoOptions::default()).unwrap();
        let profile = DeviceProfile::unlimited("finger");
        let mut servo = servo.protected(&Protection::new(profile)).unwrap();
        let mapping = Mapping::new(MappingOptions::default()).unwrap();
        let mut motor = Motor(0.0);
        let wood = Material::preset("wood").unwrap();
        let vibration = Vibration::new(mapping, &mut motor).with_materials(&[wood]);
        let mut player = vibration.start(&servo).unwrap();
        for tick in 0..1000 {
            // In and out of the circle, ten times.
            let height = if tick % 100 < 50 { 0.06 } else { 0.045 };
            let at = [PointState::at_rest(Vector([0.0, height, 0.0]))];
            assert_no_alloc(|| {
                servo.step(&at);
                player.tick(&servo);
            });
        }
        let report = assert_no_alloc(|| player.finish());
        assert!(report.commands == 50 && report.strongest > 0.1, "{report:?}");
        drop(player);
        assert_eq!(motor.0, 0.0);
    }
}
