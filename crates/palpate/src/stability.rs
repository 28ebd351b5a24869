// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whether a wall comes to rest on a device that differs from its profile.
//!
//! What a device renders stably is computed from its profile, and a profile may be wrong. [`Press`]
//! lets a simulated hand press a wall on a device with another damping, friction or encoder, and
//! with a delay from reading to force, and tells how it rests.
//!
//! N. Diolaiti, G. Niemeyer, F. Barbagli, J. K. Salisbury, "Stability of haptic rendering:
//! discretization, quantization, time delay, and Coulomb effects" (2006).

use std::collections::VecDeque;

use palpate_device::{Device, DeviceError, DeviceProfile, NumberError, PointState, Reading};
use palpate_field::{Shape, Vector};
use palpate_haptics::{
    Bodies, Body, Material, Probe, Protection, Servo, ServoOptions, Surface,
};

use palpate_sim::{Hand, HandPath, Interpolation, SimulatedDevice, SimulationError};

use crate::error::Error;

/// Ticks a second [Hz].
const RATE: f64 = 1000.0;

/// Ticks of a press.
const TICKS: u32 = 10_000;

/// Ticks at its end in which the hand should rest.
const AT_REST: u32 = 3000;

/// Where the hand begins, above the wall [m].
const HEIGHT: f64 = 0.003;

/// The time in which it comes down [s].
const APPROACH: f64 = 0.5;

/// The radius of the probe [m].
const PROBE: f64 = 0.002;

/// The largest swing of a hand at rest [m].
const LARGEST_SWING: f64 = 2e-4;

/// The largest swing of a force at rest [N].
const LARGEST_FORCE_SWING: f64 = 0.5;

/// How a device differs from its profile, and the hand that holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Plant {
    /// The viscous damping of the device, over that of its profile.
    pub damping: f64,
    /// Its Coulomb friction, over that of its profile.
    pub friction: f64,
    /// Its encoder step, over that of its profile.
    pub encoder_step: f64,
    /// Ticks by which a force is later than in the tick of its reading.
    pub delay: usize,
    /// The damping of the hand [N·s/m].
    pub hand_damping: f64,
    /// The stiffness of its grip [N/m]; zero for a hand that only pushes.
    pub grip: f64,
    /// The mean speed at which a hand with a grip strokes the wall [m/s].
    pub stroke: f64,
    /// One of so many readings is missing; zero if none is.
    pub missing: u32,
}

impl Plant {
    /// A device as its profile, without a delay, which a hand with a damping of 1 N·s/m pushes.
    #[must_use]
    pub fn as_profile() -> Self {
        Self {
            damping: 1.0,
            friction: 1.0,
            encoder_step: 1.0,
            delay: 0,
            hand_damping: 1.0,
            grip: 0.0,
            stroke: 0.0,
            missing: 0,
        }
    }

    /// Devices with all of a tenth, one and three times the damping and the friction of their
    /// profile, with encoder steps of one and three times, a `delay` [ticks], and hands of 1 and
    /// 10 N·s/m with grips of 0, 100 and 1000 N/m.
    pub fn wrong(delay: usize) -> impl Iterator<Item = Self> {
        const FACTORS: [f64; 3] = [0.1, 1.0, 3.0];
        let factors = FACTORS.iter().flat_map(|a| FACTORS.iter().map(|b| (*a, *b)));
        factors.flat_map(move |(damping, friction)| {
            let hands = [1.0, 10.0].into_iter().flat_map(|hand| {
                [0.0, 100.0, 1000.0].into_iter().map(move |grip| (hand, grip))
            });
            hands.flat_map(move |(hand_damping, grip)| {
                [1.0, 3.0].into_iter().map(move |encoder_step| Self {
                    damping,
                    friction,
                    encoder_step,
                    delay,
                    hand_damping,
                    grip,
                    ..Self::as_profile()
                })
            })
        })
    }

    /// The device with a profile.
    fn of(&self, profile: &DeviceProfile) -> DeviceProfile {
        DeviceProfile {
            least_damping: profile.least_damping * self.damping,
            friction: profile.friction * self.friction,
            encoder_step: profile.encoder_step * self.encoder_step,
            ..profile.clone()
        }
    }
}

/// How a hand rests on a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rest {
    /// The largest swing of the position in the last three seconds: a way that it went to and fro
    /// [m]. A drift has none.
    pub swing: f64,
    /// The largest swing of the force in the last three seconds [N].
    pub force_swing: f64,
    /// What the servo gave out in net in all ten seconds [J].
    pub energy_given: f64,
    /// The part of the stiffness that remained after limit cycles.
    pub stiffness_part: f64,
    /// The largest change from a tick to the next of what the passivity controller took [N].
    pub controller_step: f64,
}

impl Rest {
    /// Whether neither position nor force swings more than a hand feels: 0.2 mm and 0.5 N.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.swing <= LARGEST_SWING && self.force_swing <= LARGEST_FORCE_SWING
    }
}

/// A simulated hand that comes down on a wall within half a second, presses it at 1 kHz with half of
/// the force that the device bears for long, and should be at rest after ten seconds in all.
///
/// # Examples
///
/// A hand rests on steel, though the device has a tenth of the damping and friction that its
/// profile states, and its forces are two ticks late. The wall becomes softer meanwhile:
///
/// ```
/// use palpate::device::profile_named;
/// use palpate::haptics::Material;
/// use palpate::stability::{Plant, Press};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let (device, steel) = (profile_named("omega")?, Material::preset("steel")?);
/// let mut plant = Plant::as_profile();
/// assert_eq!(Press::new(&device, &steel)?.on(plant)?.stiffness_part, 1.0);
///
/// (plant.damping, plant.friction, plant.delay) = (0.1, 0.1, 2);
/// let rest = Press::new(&device, &steel)?.on(plant)?;
/// assert!(rest.is_at_rest() && rest.stiffness_part < 1.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Press {
    servo: Servo,
    profile: DeviceProfile,
    /// The force with which the hand presses [N].
    force: f64,
}

impl Press {
    /// On a wall of a material, as a device of `profile` renders it.
    ///
    /// # Errors
    ///
    /// [`Error::Device`] for a device that gives no force, or without a limit of its force;
    /// [`Error::Haptics`] if the material or the profile is refused.
    pub fn new(profile: &DeviceProfile, material: &Material) -> Result<Self, Error> {
        let lasting = profile.max_force.min(profile.continuous_force);
        if !(lasting > 0.0 && lasting < f64::INFINITY) {
            let rule = "positive and finite, so that a hand can press";
            let number = NumberError::new("max_force", rule, lasting, "N");
            return Err(DeviceError::Number(number).into());
        }
        let wall = Shape::half_space([0.0, 1.0], -PROBE)?;
        let body = Body::new(wall, Surface::new(material)?)?;
        let options = ServoOptions {
            rate: RATE,
            probe: Probe::new(PROBE)?,
            max_force: f64::INFINITY,
            ..ServoOptions::default()
        };
        let servo = Servo::new(Bodies::new(vec![body])?, 1, options)?;
        let servo = servo.protected(&Protection::new(profile.clone()))?;
        Ok(Self { servo, profile: profile.clone(), force: 0.5 * lasting })
    }

    /// Presses on a device that differs from the profile.
    ///
    /// # Errors
    ///
    /// As [`SimulatedDevice::new`] and [`Hand::with_spring`], if a factor is negative or not
    /// finite, for example.
    pub fn on(self, plant: Plant) -> Result<Rest, Error> {
        let Self { mut servo, profile, force } = self;
        let bodies = servo.bodies().bodies();
        let stiffness = bodies.iter().map(|body| body.surface().stiffness()).sum::<f64>();
        let hand = held(plant, force, stiffness)?;
        let mut device = SimulatedDevice::new(plant.of(&profile), vec![hand])?;
        let mut points = [PointState::at_rest(Vector::ZERO)];
        let mut on_their_way = VecDeque::from(vec![[Vector::ZERO]; plant.delay]);
        let (mut places, mut forces) = (Vec::new(), Vec::new());
        for tick in 0..TICKS {
            let time = f64::from(tick) / RATE;
            // A simulated device is never lost.
            let _ = device.read(time, &mut points);
            let is_missing = plant.missing > 0 && tick % plant.missing == plant.missing - 1;
            servo.set_reading(if is_missing {
                Reading::Stale
            } else {
                Reading::Fresh { time }
            });
            let force = servo.step(&points).first().map_or(Vector::ZERO, |touch| touch.force);
            on_their_way.push_back([force]);
            if let Some(arrived) = on_their_way.pop_front() {
                let _ = device.write(&arrived);
            }
            if tick >= TICKS - AT_REST {
                places.extend(device.states().map(|state| state.position[1]));
                forces.push(force.norm());
            }
        }
        let report = servo.safety().into_iter().next();
        let report = report.map(|report| (report.limit_cycles, report.passivity));
        let (cycles, passivity) = report.unwrap_or_default();
        Ok(Rest {
            swing: swing(&places),
            force_swing: swing(&forces),
            energy_given: device.energy_given(),
            stiffness_part: cycles.least_part,
            controller_step: passivity.largest_step,
        })
    }
}

/// The hand, which a wall of a `stiffness` [N/m] holds with a `force` [N].
fn held(plant: Plant, force: f64, stiffness: f64) -> Result<Hand, SimulationError> {
    let is_gripping = plant.grip > 0.0;
    let depth = if is_gripping { force / stiffness + force / plant.grip } else { 0.0 };
    let push = if is_gripping { 0.0 } else { force };
    let is_stroking = plant.stroke > 0.0 && is_gripping;
    let at = |time: f64, height: f64| Vector([plant.stroke * time, height, 0.0]);
    let mut times = vec![0.0, APPROACH];
    let mut way = vec![at(0.0, HEIGHT), at(APPROACH, -depth)];
    if is_stroking {
        let end = f64::from(TICKS) / RATE;
        times.push(end);
        way.push(at(end, -depth));
    }
    let interpolation =
        if is_stroking { Interpolation::Monotone } else { Interpolation::Smooth };
    let path = HandPath::new(times, way, interpolation)?;
    Hand::new(path)
        .with_spring(plant.grip, plant.hand_damping)?
        .with_push(Vector([0.0, -push, 0.0]))
}

/// The largest way to and fro: from a value to another, and as far back; infinite if a value is no
/// number.
fn swing(values: &[f64]) -> f64 {
    if !values.iter().all(|x| x.is_finite()) {
        return f64::INFINITY;
    }
    let mirrored: Vec<_> = values.iter().map(|x| -x).collect();
    summit(values).max(summit(&mirrored))
}

/// The height of the highest summit above both sides: of those before and after it, the higher
/// least value counts.
fn summit(values: &[f64]) -> f64 {
    let least = |least: &mut f64, x: &f64| {
        *least = least.min(*x);
        Some(*least)
    };
    let before: Vec<_> = values.iter().scan(f64::INFINITY, least).collect();
    let mut after: Vec<_> = values.iter().rev().scan(f64::INFINITY, least).collect();
    after.reverse();
    let sides = before.iter().zip(&after).map(|(before, after)| before.max(*after));
    values.iter().zip(sides).map(|(x, side)| x - side).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swing_goes_to_and_fro() {
        assert_eq!(swing(&[0.0, 1.0, 2.0, 3.0]), 0.0);
        assert_eq!(swing(&[0.0, 2.0, 1.0, 3.0]), 1.0);
        assert_eq!(swing(&[5.0, 1.0, 4.0]), 3.0);
        assert_eq!(swing(&[0.0, 3.0, -1.0]), 3.0);
        assert_eq!(swing(&[]), 0.0);
        assert_eq!(swing(&[0.0, f64::NAN, 0.0]), f64::INFINITY);
    }

    #[test]
    fn a_device_without_force_presses_nothing() {
        let glove = DeviceProfile { max_force: 0.0, ..DeviceProfile::unlimited("glove") };
        let error = Press::new(&glove, &Material::default()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "max_force must be positive and finite, so that a hand can press, got 0 N"
        );
    }
}
