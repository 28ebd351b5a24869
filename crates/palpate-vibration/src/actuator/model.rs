// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Models of actuators.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use palpate_device::NumberError;

use super::{Actuator, Mechanism, check_sample_rate};

/// A second-order high pass, `g s² / (s² + s ω₀ / Q + ω₀²)`, by the bilinear transform: exact at
/// ω₀.
#[derive(Clone, Copy, Debug)]
struct HighPass {
    gain: f64,
    /// Of the last two outputs.
    back: [f64; 2],
    inputs: [f64; 2],
    outputs: [f64; 2],
}

impl HighPass {
    /// At `frequency` [Hz], with the gain `g` at high frequencies.
    fn new(frequency: f64, quality: f64, gain: f64, sample_rate: f64) -> Self {
        let warped = libm::tan(PI * frequency / sample_rate);
        let (damping, square) = (warped / quality, warped * warped);
        let scale = 1.0 / (1.0 + damping + square);
        Self {
            gain: gain * scale,
            back: [2.0 * (square - 1.0) * scale, (1.0 - damping + square) * scale],
            inputs: [0.0; 2],
            outputs: [0.0; 2],
        }
    }

    fn step(&mut self, input: f64) -> f64 {
        let [last, before] = self.inputs;
        let [a, b] = self.back;
        let [previous, earlier] = self.outputs;
        let output = self.gain * (input - 2.0 * last + before) - a * previous - b * earlier;
        self.inputs = [input, last];
        self.outputs = [output, previous];
        output
    }
}

/// A first-order low pass by the bilinear transform.
#[derive(Clone, Copy, Debug)]
struct LowPass {
    gain: f64,
    back: f64,
    input: f64,
    output: f64,
}

impl LowPass {
    fn new(frequency: f64, sample_rate: f64) -> Self {
        let warped = libm::tan(PI * frequency / sample_rate);
        let scale = 1.0 / (1.0 + warped);
        Self { gain: warped * scale, back: (warped - 1.0) * scale, input: 0.0, output: 0.0 }
    }

    fn step(&mut self, input: f64) -> f64 {
        self.output = self.gain * (input + self.input) - self.back * self.output;
        self.input = input;
        self.output
    }
}

#[derive(Clone, Copy, Debug)]
enum Moving {
    Turning { rotor: Rotor, overdrive: f64, turns: f64, turns_a_step: f64 },
    Resonating { mass: HighPass, overdrive: f64 },
    Following { mass: HighPass, coil: LowPass },
}

/// How an actuator shakes when it is driven, as a part of its largest steady amplitude.
///
/// - A rotating mass turns at the speed s, as a part of the rated one, which follows the level
///   with a time constant; it shakes with `s² sin φ`, as the centrifugal force is `m r ω²`.
/// - A resonant actuator moves its mass as an oscillator of quality `Q = f₀ / B`; the force on the
///   skin is that which accelerates the mass, so the response to a level is
///   `s² / (s² + s ω₀ / Q + ω₀²) / Q`: 1 at the resonance.
/// - A voice coil has a high pass of second order (a mass on a soft spring, Q = 1/√2) at the lower
///   end of its band, and a low pass of first order (its inductance) at the upper end.
///
/// The model is for tests, reports and pictures: it says what a drive is worth on an actuator.
/// Levels are those that a [`Synthesiser`](crate::Synthesiser) makes for the actuator, in which 1
/// is the largest level that the actuator takes for a short time.
///
/// ```
/// use palpate_vibration::{ActuatorModel, actuator_named};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let motor = actuator_named("erm")?;
/// let mut model = ActuatorModel::new(&motor, 8000.0)?;
/// // Half of the largest level, 4.5 V, is below the 2.3 V at which the motor starts.
/// assert!((0..8000).all(|_| model.step(0.5) == 0.0));
/// assert!((0..8000).any(|_| model.step(0.6) != 0.0));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ActuatorModel {
    moving: Moving,
}

impl ActuatorModel {
    /// An actuator at rest, driven at `sample_rate` [Hz].
    ///
    /// # Errors
    ///
    /// [`NumberError`] if a figure of the actuator breaks its rule, or if the sample rate
    /// is less than twice the actuator's highest frequency.
    pub fn new(actuator: &Actuator, sample_rate: f64) -> Result<Self, NumberError> {
        let mechanism = &actuator.mechanism;
        mechanism.check()?;
        check_sample_rate(sample_rate, mechanism.highest_frequency())?;
        let moving = match *mechanism {
            Mechanism::RotatingMass { frequency, start_level, overdrive, rise, fall } => {
                Moving::Turning {
                    rotor: Rotor::new(start_level, rise, fall, 1.0 / sample_rate),
                    overdrive,
                    turns: 0.0,
                    turns_a_step: frequency / sample_rate,
                }
            }
            Mechanism::Resonant { resonance, bandwidth, overdrive } => {
                let quality = resonance / bandwidth;
                let mass = HighPass::new(resonance, quality, 1.0 / quality, sample_rate);
                Moving::Resonating { mass, overdrive }
            }
            Mechanism::VoiceCoil { lowest, highest } => Moving::Following {
                mass: HighPass::new(lowest, FRAC_1_SQRT_2, 1.0, sample_rate),
                coil: LowPass::new(highest, sample_rate),
            },
        };
        Ok(Self { moving })
    }

    /// The shaking after a step at `level`, as a part of the largest.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn step(&mut self, level: f64) -> f64 {
        match &mut self.moving {
            Moving::Turning { rotor, overdrive, turns, turns_a_step } => {
                rotor.advance(level * *overdrive);
                *turns += rotor.speed * *turns_a_step;
                *turns -= libm::floor(*turns);
                rotor.speed * rotor.speed * libm::sin(TAU * *turns)
            }
            Moving::Resonating { mass, overdrive } => mass.step(level * *overdrive),
            Moving::Following { mass, coil } => coil.step(mass.step(level)),
        }
    }
}

/// The speed below which the mass rests, as a part of the rated speed: a thousandth has a
/// millionth of the amplitude.
const AT_REST: f64 = 1e-3;

/// A mass that turns, with its speed as a part of the rated one.
///
/// The speed s follows the level u with a time constant: `s' = (u − s) / rise` while the motor is
/// driven faster or backwards, and `/ fall` while it slows by itself. At rest it needs a level of
/// at least `start_level` in either direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rotor {
    pub(super) speed: f64,
    start_level: f64,
    /// What is left of a difference of speed after a step, driven and coasting.
    driven: f64,
    coasting: f64,
}

impl Rotor {
    /// A mass at rest with these time constants [s], in steps of `period` [s].
    pub(super) fn new(start_level: f64, rise: f64, fall: f64, period: f64) -> Self {
        let left = |constant: f64| libm::exp(-period / constant);
        Self { speed: 0.0, start_level, driven: left(rise), coasting: left(fall) }
    }

    /// The speed after a step at this level, which may be negative.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn advance(&mut self, level: f64) {
        if self.speed == 0.0 && level.abs() < self.start_level {
            return;
        }
        let is_driven = level * self.speed < 0.0 || level.abs() > self.speed.abs();
        let left = if is_driven { self.driven } else { self.coasting };
        self.speed = level + (self.speed - level) * left;
        if self.speed.abs() < AT_REST && level.abs() < self.start_level {
            self.speed = 0.0;
        }
    }

    /// The level that brings the mass to `speed` in one step, within ± `overdrive`: the inverse of
    /// [`advance`](Self::advance).
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn level_for(&self, speed: f64, overdrive: f64) -> f64 {
        let inverse = |left: f64| (speed - self.speed * left) / (1.0 - left);
        let driven = inverse(self.driven);
        let level = if driven > self.speed || driven < 0.0 {
            driven
        } else {
            // Slower than it is: it coasts, at most down to level zero.
            inverse(self.coasting).clamp(0.0, self.speed.max(0.0))
        };
        level.clamp(-overdrive, overdrive)
    }
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "tests know their lengths")]
mod tests {
    use super::*;
    use crate::actuator_named;

    const RATE: f64 = 8000.0;

    /// The amplitude in the last tenth of a second of some, of a sine of this frequency and level.
    fn driven(name: &str, frequency: f64, level: f64, seconds: f64) -> f64 {
        let mut model = ActuatorModel::new(&actuator_named(name).unwrap(), RATE).unwrap();
        let count = (seconds * RATE) as usize;
        let sine = |i: usize| level * (TAU * frequency * i as f64 / RATE).sin();
        let shaking: Vec<f64> = (0..count).map(|i| model.step(sine(i))).collect();
        let last = &shaking[count - (0.1 * RATE) as usize..];
        last.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
    }

    #[test]
    fn a_resonance_is_one_at_its_top_and_half_the_power_at_the_ends_of_its_band() {
        let rated = 1.0 / 1.2;
        assert!((driven("lra", 170.0, rated, 1.0) - 1.0).abs() < 2e-3);
        // f₀ √(1 + 1/4Q²) ± B/2, with Q = 17.
        let middle = 170.0 * (1.0 + 0.25 / (17.0 * 17.0_f64)).sqrt();
        for side in [-5.0, 5.0] {
            let amplitude = driven("lra", middle + side, rated, 1.0);
            // Half the power is that of the speed; the force is the speed times the frequency.
            let grown = (middle + side) / 170.0;
            assert!((amplitude / grown - FRAC_1_SQRT_2).abs() < 0.01, "{amplitude}");
        }
    }

    #[test]
    fn a_resonance_rises_with_its_time_constant() {
        let lra = actuator_named("lra").unwrap();
        let mut model = ActuatorModel::new(&lra, RATE).unwrap();
        let constant = 1.0 / (PI * 10.0);
        let mut most = 0.0_f64;
        for i in 0..(constant * RATE) as usize {
            let sine = (TAU * 170.0 * i as f64 / RATE).sin() / 1.2;
            most = most.max(model.step(sine).abs());
        }
        assert!((most - (1.0 - (-1.0_f64).exp())).abs() < 0.05, "{most}");
    }

    #[test]
    fn a_voice_coil_has_half_the_power_at_the_ends_of_its_band() {
        // At each end the other end's filter is near 1: within 1 %.
        for end in [90.0, 1000.0] {
            let amplitude = driven("voice_coil", end, 1.0, 0.5);
            assert!((amplitude - FRAC_1_SQRT_2).abs() < 0.01, "{end} Hz: {amplitude}");
        }
        assert!((driven("voice_coil", 250.0, 1.0, 0.5) - 1.0).abs() < 0.05);
    }

    #[test]
    fn a_motor_at_its_rated_level_turns_at_its_rated_frequency() {
        let motor = actuator_named("erm").unwrap();
        let mut model = ActuatorModel::new(&motor, RATE).unwrap();
        let shaking: Vec<f64> = (0..16000).map(|_| model.step(1.0 / 1.5)).collect();
        let last = &shaking[8000..];
        let turns = last.windows(2).filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0).count();
        assert!((199..=201).contains(&turns), "{turns} turns in a second");
        // The sample that is nearest to a crest lies up to a 40th of half a turn beside it.
        let nearest = (PI / 40.0).cos();
        assert!((nearest..=1.0).contains(&last.iter().fold(0.0, |a: f64, x| a.max(*x))));
    }

    #[test]
    fn too_few_samples_are_refused() {
        let coil = actuator_named("voice_coil").unwrap();
        let error = ActuatorModel::new(&coil, 1500.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "sample_rate must be at least twice the highest frequency, got 1500 Hz"
        );
    }
}

#[cfg(test)]
mod rotor_tests {
    use super::*;

    fn rotor() -> Rotor {
        Rotor::new(0.7, 0.05, 0.1, 1e-3)
    }

    #[test]
    fn below_its_start_level_it_rests() {
        let mut motor = rotor();
        (0..1000).for_each(|_| motor.advance(0.69));
        assert_eq!(motor.speed, 0.0);
        motor.advance(0.7);
        assert!((motor.speed - 0.7 * (1.0 - (-0.02_f64).exp())).abs() < 1e-15);
    }

    #[test]
    fn after_a_time_constant_the_speed_is_at_63_percent_and_coasts_to_37() {
        let mut motor = rotor();
        (0..50).for_each(|_| motor.advance(1.0));
        let risen = 1.0 - (-1.0_f64).exp();
        assert!((motor.speed - risen).abs() < 1e-12);
        (0..100).for_each(|_| motor.advance(0.0));
        assert!((motor.speed - risen * (-1.0_f64).exp()).abs() < 1e-12);
    }

    #[test]
    fn the_level_for_a_speed_gives_that_speed() {
        for (from, to) in [(0.8, 0.81), (0.8, 0.795), (0.01, 0.0), (0.9, 0.9)] {
            let mut motor = Rotor { speed: from, ..rotor() };
            let level = motor.level_for(to, 1.5);
            assert!(level.abs() <= 1.5);
            motor.advance(level);
            assert!((motor.speed - to).abs() < 1e-12, "{from} to {to}: {}", motor.speed);
        }
    }
}
