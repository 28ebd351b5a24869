// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Channels of actuators.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{PI, TAU};

use palpate_device::{DeviceError, DeviceLost, NumberError};
use palpate_field::Point;

use crate::cue::{Tone, level};
use crate::publisher::Command;
use crate::ringing::Tones;

/// Combines tones for an actuator that plays one at a time: the frequency of the strongest
/// tone, and the amplitude `√(Σ a²)` of all, at most one.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
///
/// ```
/// use palpate_vibration::{Tone, Tones, one_channel};
///
/// let tones = Tones {
///     hold: Tone { frequency: 60.0, amplitude: 0.375 },
///     slide: Tone { frequency: 150.0, amplitude: 0.5 },
///     ..Tones::default()
/// };
/// assert_eq!(one_channel(&tones), Tone { frequency: 150.0, amplitude: 0.625 });
/// ```
#[must_use]
pub fn one_channel(tones: &Tones) -> Tone {
    let all = [tones.hold, tones.slide, tones.tap];
    let power: f64 = all.iter().map(|tone| tone.amplitude * tone.amplitude).sum();
    let strongest = all.iter().fold(Tone::default(), |strongest, tone| {
        if tone.amplitude > strongest.amplitude { *tone } else { strongest }
    });
    Tone { frequency: strongest.frequency, amplitude: level(power.sqrt()) }
}

/// The amplitudes of a strong, slow motor and of a weak, fast one, in [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TwoChannels {
    /// The amplitude of the strong motor: pressure, and the part of a tap below the split.
    pub low: f64,
    /// The amplitude of the weak motor: texture, and the part of a tap above the split.
    pub high: f64,
}

/// Distributes tones between two motors at `split` [Hz]; 72.5 to 80 Hz is usual.
///
/// The power spectrum of `exp(−d t) sin(2π f t)` is a Lorentz line of half width d about f, of
/// which `½ + atan(2π (split − f) / d) / π` lies below the split; amplitudes go as the square
/// root. A tap that does not decay lies on one side.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
///
/// ```
/// use palpate_vibration::{Tone, Tones, TwoChannels, two_channels};
///
/// let tones = Tones {
///     hold: Tone { frequency: 60.0, amplitude: 0.5 },
///     slide: Tone { frequency: 150.0, amplitude: 0.25 },
///     ..Tones::default()
/// };
/// assert_eq!(two_channels(&tones, 80.0), TwoChannels { low: 0.5, high: 0.25 });
/// ```
#[must_use]
pub fn two_channels(tones: &Tones, split: f64) -> TwoChannels {
    let Tone { frequency, amplitude } = tones.tap;
    let below = 0.5 + libm::atan2(TAU * (split - frequency), tones.tap_decay) / PI;
    let below = level(below);
    let (low, high) = (amplitude * below.sqrt(), amplitude * (1.0 - below).sqrt());
    let together = |a: f64, b: f64| level((a * a + b * b).sqrt());
    TwoChannels {
        low: together(tones.hold.amplitude, low),
        high: together(tones.slide.amplitude, high),
    }
}

/// The amplitudes of two actuators that together feel like one actuator of amplitude
/// `amplitude` (A) between them, at the fraction `beta` (β) from the first to the second: `√(1
/// − β) A` and `√β A`.
///
/// Israr and Poupyrev, "Tactile Brush: drawing on skin with a tactile grid display" (2011): the
/// phantom has the sum of their powers.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
///
/// ```
/// use palpate_vibration::phantom;
///
/// assert_eq!(phantom(0.8, 0.0), [0.8, 0.0]);
/// assert_eq!(phantom(0.5, 0.75), [0.25, 0.5 * 0.75_f64.sqrt()]);
/// ```
#[must_use]
pub fn phantom(amplitude: f64, beta: f64) -> [f64; 2] {
    let (amplitude, beta) = (level(amplitude), level(beta));
    [(1.0 - beta).sqrt() * amplitude, beta.sqrt() * amplitude]
}

/// The most actuators that play one point.
const NEAREST: usize = 3;

/// Actuators at places on the skin; points between them are played by several.
///
/// A point is played by its three nearest actuators, each with the weight `max(0, 1 − d /
/// reach)` of its distance d, divided by the weight of the nearest, which plays the full
/// amplitude. Points that share an actuator do not add up: the actuator plays the strongest. A
/// point beyond `reach` of every actuator is silent.
///
/// ```
/// use palpate_field::Vector;
/// use palpate_vibration::ActuatorArray;
///
/// # fn main() -> Result<(), palpate_device::DeviceError> {
/// let places = [0.0, 0.25, 0.5, 0.75].map(|x| Vector([x, 0.0, 0.0]));
/// let vest = ActuatorArray::new(places.to_vec(), 0.5)?;
/// let mut amplitudes = [0.0; 4];
/// vest.play(Vector([0.25, 0.0, 0.0]), 0.5, &mut amplitudes);
/// assert_eq!(amplitudes, [0.25, 0.5, 0.25, 0.0]);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct ActuatorArray {
    places: Vec<Point<3>>,
    reach: f64,
}

impl ActuatorArray {
    /// Actuators at `places` [m] that play points within `reach` [m].
    ///
    /// # Errors
    ///
    /// [`DeviceError::NoContactPoint`] without a place; [`DeviceError::Number`] if the reach
    /// is not positive, or a coordinate not finite.
    pub fn new(places: Vec<Point<3>>, reach: f64) -> Result<Self, DeviceError> {
        if places.is_empty() {
            return Err(DeviceError::NoContactPoint);
        }
        for value in places.iter().flat_map(|place| place.0) {
            if !value.is_finite() {
                let (parameter, rule, unit) = ("place", "finite", "m");
                return Err(NumberError::new(parameter, rule, value, unit).into());
            }
        }
        Ok(Self { places, reach: NumberError::check_positive("reach", reach, "m")? })
    }

    /// The places of the actuators [m].
    #[must_use]
    pub fn places(&self) -> &[Point<3>] {
        &self.places
    }

    /// Plays `amplitude` at `point` [m]: raises each of `amplitudes`, one per actuator, to at
    /// least the actuator's part of it.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; looks at each actuator once.
    pub fn play(&self, point: Point<3>, amplitude: f64, amplitudes: &mut [f64]) {
        let nearest = self.nearest(point);
        let [(largest, _), ..] = nearest;
        for (weight, actuator) in nearest {
            if weight > 0.0 {
                raise(amplitudes, actuator, level(amplitude) * (weight / largest));
            }
        }
    }

    /// Plays `amplitude` at `point` [m] as a [`phantom`] between the two nearest actuators
    /// within reach, at the point of their connecting segment closest to `point`; with one
    /// actuator if no second is in reach. Raises `amplitudes` as [`play`](Self::play) does.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; looks at each actuator once.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_vibration::ActuatorArray;
    ///
    /// # fn main() -> Result<(), palpate_device::DeviceError> {
    /// let places = [0.0, 0.25, 0.5].map(|x| Vector([x, 0.0, 0.0]));
    /// let sleeve = ActuatorArray::new(places.to_vec(), 0.5)?;
    /// let mut amplitudes = [0.0; 3];
    /// sleeve.play_between(Vector([0.3125, 0.125, 0.0]), 1.0, &mut amplitudes);
    /// assert_eq!(amplitudes, [0.0, 0.75_f64.sqrt(), 0.5]);
    /// # Ok(())
    /// # }
    /// ```
    pub fn play_between(&self, point: Point<3>, amplitude: f64, amplitudes: &mut [f64]) {
        let [(weight, first), (other_weight, second), _] = self.nearest(point);
        if weight <= 0.0 {
            return;
        }
        let places = (self.places.get(first), self.places.get(second));
        let beta = match places {
            (Some(from), Some(to)) if other_weight > 0.0 => {
                let way = *to - *from;
                (point - *from).dot(way) / way.dot(way)
            }
            _ => 0.0,
        };
        // If both are at one place, `level` gives zero and the first plays alone.
        let [near, far] = phantom(amplitude, beta);
        raise(amplitudes, first, near);
        raise(amplitudes, second, far);
    }

    /// Weights and indices of the nearest actuators, nearest first; weight zero if missing or
    /// out of reach.
    fn nearest(&self, point: Point<3>) -> [(f64, usize); NEAREST] {
        // The largest weights so far with their actuators; the first of equals.
        let mut nearest = [(0.0, usize::MAX); NEAREST];
        for (actuator, place) in self.places.iter().enumerate() {
            let mut candidate = (1.0 - (*place - point).norm() / self.reach, actuator);
            for held in &mut nearest {
                // Written so that NaN is never held.
                if candidate.0 > held.0 {
                    std::mem::swap(held, &mut candidate);
                }
            }
        }
        nearest
    }
}

fn raise(amplitudes: &mut [f64], actuator: usize, amplitude: f64) {
    if let Some(place) = amplitudes.get_mut(actuator) {
        *place = place.max(amplitude);
    }
}

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

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "tests know their lengths")]
mod tests {
    use palpate_field::Vector;

    use super::*;
    use palpate_testkit::cases::each as cases;

    fn tapped(frequency: f64, decay: f64) -> Tones {
        let tap = Tone { frequency, amplitude: 0.5 };
        Tones { tap, tap_decay: decay, ..Tones::default() }
    }

    #[test]
    fn a_tap_at_the_split_is_shared_and_one_without_end_is_not() {
        let shared = two_channels(&tapped(75.0, 40.0), 75.0);
        assert!((shared.low - 0.125_f64.sqrt()).abs() < 1e-15);
        assert!((shared.high - shared.low).abs() < 1e-15);
        let high = two_channels(&tapped(300.0, 0.0), 75.0);
        assert_eq!(high, TwoChannels { low: 0.0, high: 0.5 });
        let low = two_channels(&tapped(30.0, 0.0), 75.0);
        assert_eq!(low, TwoChannels { low: 0.5, high: 0.0 });
    }

    #[test]
    fn two_channels_have_the_power_of_the_tap() {
        cases(500, |u| {
            let mut number = |most: i32| u.int_in_range(0..=most).map(f64::from);
            let both = two_channels(&tapped(number(500)?, number(400)?), number(200)?);
            assert!((both.low * both.low + both.high * both.high - 0.25).abs() < 1e-12);
            Ok(())
        });
    }

    #[test]
    fn a_phantom_has_the_power_of_what_it_stands_for() {
        for step in 0..=100 {
            let [a, b] = phantom(0.7, f64::from(step) / 100.0);
            assert!((a * a + b * b - 0.49).abs() < 1e-15);
        }
        assert_eq!(phantom(f64::NAN, 0.5), [0.0, 0.0]);
    }

    #[test]
    fn at_most_three_play_and_the_nearest_in_full() {
        cases(500, |u| {
            let mut number = || u.int_in_range(-100..=100).map(|i: i32| f64::from(i) * 1e-2);
            let mut places = Vec::new();
            for _ in 0..8 {
                places.push(Vector([number()?, number()?, number()?]));
            }
            let point = Vector([number()?, number()?, number()?]);
            let array = ActuatorArray::new(places, 0.7).unwrap();
            let mut amplitudes = [0.0; 8];
            array.play(point, 0.6, &mut amplitudes);
            let distance = |i: usize| (array.places()[i] - point).norm();
            let nearest = (0..8).map(distance).fold(f64::INFINITY, f64::min);
            let playing: Vec<_> = (0..8).filter(|i| amplitudes[*i] > 0.0).collect();
            assert!(playing.len() <= 3);
            assert_eq!(playing.is_empty(), nearest >= 0.7);
            for i in playing {
                let weight = (1.0 - distance(i) / 0.7) / (1.0 - nearest / 0.7);
                assert!((amplitudes[i] - 0.6 * weight).abs() < 1e-12);
            }
            Ok(())
        });
    }

    #[test]
    fn a_phantom_moves_from_one_actuator_to_the_next() {
        let array =
            ActuatorArray::new(vec![Vector([0.0, 0.0, 0.0]), Vector([1.0, 0.0, 0.0])], 2.0);
        let array = array.unwrap();
        let at = |x: f64| {
            let mut amplitudes = [0.0; 2];
            array.play_between(Vector([x, 0.1, 0.0]), 1.0, &mut amplitudes);
            amplitudes
        };
        assert_eq!((at(-0.2), at(1.2)), ([1.0, 0.0], [0.0, 1.0]));
        for step in 0..=10 {
            let beta = f64::from(step) / 10.0;
            let [first, second] = at(beta);
            assert!((first - (1.0 - beta).sqrt()).abs() < 1e-12);
            assert!((second - beta.sqrt()).abs() < 1e-12);
        }
        assert_eq!((at(5.0), at(f64::NAN)), ([0.0; 2], [0.0; 2]));
        let twins = ActuatorArray::new(vec![Vector([0.0, 0.0, 0.0]); 2], 2.0).unwrap();
        let mut amplitudes = [0.0; 2];
        twins.play_between(Vector([0.5, 0.0, 0.0]), 0.5, &mut amplitudes);
        assert_eq!(amplitudes, [0.5, 0.0]);
    }

    #[test]
    fn points_that_are_no_numbers_and_lists_that_are_short_play_nothing() {
        let array =
            ActuatorArray::new(vec![Vector([0.0, 0.0, 0.0]), Vector([1.0, 0.0, 0.0])], 2.0);
        let array = array.unwrap();
        let mut amplitudes = [0.0; 2];
        array.play(Vector([f64::NAN, 0.0, 0.0]), 1.0, &mut amplitudes);
        array.play(Vector([0.0, 0.0, 0.0]), f64::NAN, &mut amplitudes);
        assert_eq!(amplitudes, [0.0, 0.0]);
        let mut short = [0.0];
        array.play(Vector([1.0, 0.0, 0.0]), 1.0, &mut short);
        assert_eq!(short, [0.5]);
        assert!(ActuatorArray::new(Vec::new(), 1.0).is_err());
        assert!(ActuatorArray::new(vec![Vector([f64::NAN, 0.0, 0.0])], 1.0).is_err());
    }
}
