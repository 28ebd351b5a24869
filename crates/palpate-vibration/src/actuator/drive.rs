// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Drives: the level that makes an actuator shake as strongly as wanted, as soon as it can.
//!
//! A slow actuator is pushed beyond its steady level until it has the wanted amplitude, and pushed
//! backwards to stop: overdrive and braking, as drivers of such actuators do (Texas Instruments,
//! "DRV2605 haptic driver", data sheet SLOS825E, section 7.3.2.3). Here both follow from the
//! inverse of the actuator's own model: in every step the level is the one that would reach the
//! wanted amplitude at the end of the step, within the largest.
//!
//! A wanted strength is an amplitude in units of the skin's threshold at its frequency.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{PI, TAU};

use super::model::Rotor;
use crate::cue::level;
use crate::sensation_level::perceptual_weight;
use crate::strength::CLEARLY_FELT;

/// The speeds of a motor whose strengths are listed: between two of them the strength is a straight
/// line to a part in a thousand.
const SPEEDS: usize = 128;

/// The longest time for which a tap waits for its actuator [s]: a later tap would not belong to the
/// touch.
const LONGEST_REACH: f64 = 0.15;

/// The strongest part of the reachable amplitude for which a tap waits: the last part is reached
/// slowly.
const REACHED: f64 = 0.95;

/// The strengths at which a motor starts and stops, 4 dB and 2 dB above the threshold: apart, so that
/// a strength that trembles does not start and brake it in turns.
const STARTS: f64 = 0.5 * CLEARLY_FELT;
const STOPS: f64 = 0.4 * CLEARLY_FELT;

/// Drives a rotating mass by a level, negative to brake; 1 is the largest level.
#[derive(Clone, Debug)]
pub(crate) struct MotorDrive {
    /// Whether the motor is to turn.
    is_on: bool,
    rotor: Rotor,
    overdrive: f64,
    start_level: f64,
    /// The strength at speeds from the start level to the rated level, rising.
    strengths: Vec<(f64, f64)>,
    rise: f64,
}

/// What a motor is made of: the figures of [`Mechanism::RotatingMass`](super::Mechanism).
#[derive(Clone, Copy)]
pub(crate) struct Motor {
    pub(crate) frequency: f64,
    pub(crate) start_level: f64,
    pub(crate) overdrive: f64,
    pub(crate) rise: f64,
    pub(crate) fall: f64,
}

impl MotorDrive {
    pub(crate) fn new(motor: Motor, sample_rate: f64) -> Self {
        let Motor { frequency, start_level, overdrive, rise, fall } = motor;
        let speed =
            |i: usize| start_level + (1.0 - start_level) * i as f64 / (SPEEDS - 1) as f64;
        let mut strongest = 0.0_f64;
        let strengths = (0..SPEEDS).map(speed).map(|speed| {
            // Above 250 Hz the skin feels less again; a list that rises is one that can be searched.
            strongest = strongest.max(speed * speed / perceptual_weight(speed * frequency));
            (strongest, speed)
        });
        Self {
            is_on: false,
            strengths: strengths.collect(),
            rotor: Rotor::new(start_level, rise, fall, 1.0 / sample_rate),
            overdrive,
            start_level,
            rise,
        }
    }

    /// The speed at which the motor is felt with `strength`; the start level for a weaker one, and
    /// the rated speed for a stronger one.
    fn speed(&self, strength: f64) -> f64 {
        let above = self.strengths.partition_point(|(known, _)| *known < strength);
        let of = |i: usize| self.strengths.get(i).copied();
        match (above.checked_sub(1).and_then(of), of(above)) {
            (Some((weaker, slow)), Some((stronger, fast))) => {
                slow + (fast - slow) * (strength - weaker) / (stronger - weaker)
            }
            (None, _) => self.start_level,
            (Some(_), None) => 1.0,
        }
    }

    /// The level of this step for a wanted strength, in [−1, 1]; and the part of the strength that
    /// the motor has at its rated speed, at most 1.
    pub(crate) fn step(&mut self, strength: f64) -> (f64, f64) {
        self.is_on = strength >= if self.is_on { STOPS } else { STARTS };
        let wanted = if self.is_on { self.speed(strength) } else { 0.0 };
        let mut level = self.rotor.level_for(wanted, self.overdrive);
        // A motor at rest needs its start level, and one that has stopped must not turn back.
        if self.rotor.speed == 0.0 {
            level = if wanted > 0.0 { level.max(self.start_level) } else { 0.0 };
        }
        self.rotor.advance(level);
        let largest = self.strengths.last().map_or(0.0, |(largest, _)| *largest);
        (level / self.overdrive, largest / strength.max(largest))
    }

    /// The time until the motor is felt with `strength`, at its largest level [s].
    pub(crate) fn reach(&self, strength: f64) -> f64 {
        reach(
            self.rise,
            self.rotor.speed / self.overdrive,
            self.speed(strength) / self.overdrive,
        )
    }
}

/// Drives a resonant actuator by the envelope of a carrier at its resonance; 1 is the largest
/// level.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CarrierDrive {
    /// The phase in turns, in [0, 1).
    phase: f64,
    phase_a_step: f64,
    /// The amplitude that the actuator has, as its model says.
    amplitude: f64,
    constant: f64,
    /// What is left of a difference of amplitude after a step.
    left: f64,
    overdrive: f64,
    weight: f64,
}

impl CarrierDrive {
    pub(crate) fn new(
        resonance: f64,
        bandwidth: f64,
        overdrive: f64,
        sample_rate: f64,
    ) -> Self {
        let constant = 1.0 / (PI * bandwidth);
        Self {
            phase: 0.0,
            phase_a_step: resonance / sample_rate,
            amplitude: 0.0,
            constant,
            left: libm::exp(-1.0 / (constant * sample_rate)),
            overdrive,
            weight: perceptual_weight(resonance),
        }
    }

    /// The amplitude that is felt with `strength`, at most the largest steady one.
    fn wanted(&self, strength: f64) -> f64 {
        level(strength * self.weight)
    }

    /// The sample of this step for a wanted strength, in [−1, 1]; and the part of the strength that
    /// the actuator has at its rated level, at most 1.
    pub(crate) fn step(&mut self, strength: f64) -> (f64, f64) {
        let wanted = self.wanted(strength);
        let envelope = (wanted - self.amplitude * self.left) / (1.0 - self.left);
        let envelope = envelope.clamp(-self.overdrive, self.overdrive);
        self.amplitude = envelope + (self.amplitude - envelope) * self.left;
        let sample = envelope / self.overdrive * libm::sin(TAU * self.phase);
        self.phase += self.phase_a_step;
        self.phase -= libm::floor(self.phase);
        (sample, 1.0 / (strength * self.weight).max(1.0))
    }

    /// The time until the actuator is felt with `strength`, at its largest level [s].
    pub(crate) fn reach(&self, strength: f64) -> f64 {
        let parts = [self.amplitude, self.wanted(strength)].map(|a| a / self.overdrive);
        reach(self.constant, parts[0], parts[1])
    }
}

/// The time [s] in which a first-order response with this time constant [s] gets from a part of the
/// largest to another, `constant ln((1 − from) / (1 − to))`, at the largest level; at most
/// [`LONGEST_REACH`].
fn reach(constant: f64, from: f64, to: f64) -> f64 {
    let to = to.min(REACHED);
    let time = constant * libm::log((1.0 - from) / (1.0 - to));
    // Written so that NaN, of a level beyond the largest, does not wait.
    if time > 0.0 { time.min(LONGEST_REACH) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOTOR: Motor =
        Motor { frequency: 200.0, start_level: 0.75, overdrive: 1.5, rise: 0.04, fall: 0.08 };

    #[test]
    fn a_motor_is_as_strong_as_asked() {
        let drive = MotorDrive::new(MOTOR, 1000.0);
        for strength in [60.0, 90.0, 120.0, 150.0] {
            let speed = drive.speed(strength);
            let felt = speed * speed / perceptual_weight(speed * 200.0);
            assert!((felt / strength - 1.0).abs() < 1e-3, "{strength}: {felt}");
        }
        assert_eq!((drive.speed(0.1), drive.speed(1e9)), (0.75, 1.0));
    }

    #[test]
    fn a_motor_is_pushed_to_start_and_braked_to_stop_and_never_turns_back() {
        let mut drive = MotorDrive::new(MOTOR, 1000.0);
        assert_eq!(drive.step(100.0), (1.0, 1.0));
        let risen = (1..200).find(|_| drive.step(100.0).0 < 1.0).unwrap();
        // From rest to speed s at 1.5: rise · ln(1.5 / (1.5 − s)).
        let speed = drive.speed(100.0);
        let time = 0.04 * (1.5 / (1.5 - speed)).ln();
        assert!((f64::from(risen) * 1e-3 - time).abs() <= 2e-3, "{risen} ms, not {time} s");
        let (steady, _) = drive.step(100.0);
        assert!((steady - speed / 1.5).abs() < 1e-9);
        assert_eq!(drive.step(0.0).0, -1.0);
        let stopped = (1..200).find(|_| {
            drive.step(0.0);
            drive.rotor.speed == 0.0
        });
        // From s to rest at −1.5: rise · ln((1.5 + s) / 1.5).
        let time = 0.04 * ((1.5 + speed) / 1.5).ln();
        assert!((f64::from(stopped.unwrap()) * 1e-3 - time).abs() <= 2e-3);
        assert_eq!((drive.step(0.0).0, drive.rotor.speed), (0.0, 0.0));
    }

    #[test]
    fn a_strength_that_trembles_does_not_start_and_stop_a_motor() {
        let mut drive = MotorDrive::new(MOTOR, 1000.0);
        let trembling = |tick: u32| STARTS * if tick.is_multiple_of(2) { 1.05 } else { 0.95 };
        let levels: Vec<_> = (0..400).map(|tick| drive.step(trembling(tick)).0).collect();
        assert!(levels.iter().all(|level| *level > 0.0));
        drive.step(0.95 * STOPS);
        (0..400).for_each(|_| assert!(drive.step(0.95 * STARTS).0 <= 0.0));
    }

    #[test]
    fn a_carrier_has_the_wanted_envelope_as_far_as_its_drive_reaches() {
        let mut drive = CarrierDrive::new(170.0, 10.0, 1.2, 8000.0);
        let weight = perceptual_weight(170.0);
        let until = drive.reach(0.6 / weight);
        assert!((until - (1.2_f64 / 0.6).ln() / (10.0 * PI)).abs() < 1e-12);
        for _ in 0..(until * 8000.0) as usize + 2 {
            drive.step(0.6 / weight);
        }
        assert!((drive.amplitude - 0.6).abs() < 1e-12);
        drive.step(0.0);
        assert!(drive.amplitude < 0.6);
        for _ in 0..800 {
            drive.step(0.0);
        }
        assert!(drive.amplitude.abs() < 1e-12);
    }

    #[test]
    fn no_time_is_reached_beyond_the_largest() {
        assert_eq!(reach(1e9, 0.0, 0.5), LONGEST_REACH);
        assert_eq!((reach(0.05, 2.0, 0.5), reach(0.05, 0.5, 0.2)), (0.0, 0.0));
    }
}
