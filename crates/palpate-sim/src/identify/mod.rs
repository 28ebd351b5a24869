// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Finds mass, damping, friction and encoder step of a device from small motions of its own.
//!
//! The handle is free. Its motors push it back and forth, and the parameters of
//!
//! ```text
//! m x'' + b x' + f_c sign(x') = F + f_0
//! ```
//!
//! are those whose motion under the same forces fits the readings best: an output-error method
//! (Ljung 1999, *System Identification*, section 7.2; Gautier, Janot and Vandanjon 2013 for
//! robots, IEEE Transactions on Control Systems Technology 21). Velocities and accelerations
//! are not needed, whose differences of encoder steps would be mostly noise at 1 kHz; how much
//! friction and quantisation matter to haptic rendering: Diolaiti et al. (2006), IEEE
//! Transactions on Robotics 22.
//!
//! Slow and fast strokes tell friction from damping, pushes of several forces the mass, and
//! both directions the constant force `f_0`. `axis.rs` decides how many, `strokes.rs` moves,
//! `observed.rs` says what readings tell, `fit.rs` fits.

mod axis;
mod error;
mod fit;
mod observed;
mod options;
mod port;
mod report;
mod strokes;

use palpate_device::{Device, DeviceProfile, NumberError};

pub use error::IdentifyError;
pub use options::IdentifyOptions;
pub use report::{DeviceAxis, EncoderStep, Estimate, Identified, IdentifiedAxis};

use port::{NextTick, Port};

/// How far an identification has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct IdentifyProgress {
    /// The axis that is moved.
    pub axis: DeviceAxis,
    /// Its number, from 1.
    pub axis_number: usize,
    /// The number of axes.
    pub axes: usize,
    /// Strokes along the axis so far.
    pub strokes: u64,
}

/// Moves the free handle of a device, and finds the mass, damping, friction and encoder step
/// of each axis, with their errors.
///
/// Nobody may hold the handle: the caller says so, and waits, before this is called. Along each
/// axis, and about it if the device gives torques, a force rises until the handle moves, then
/// rounds of 20 strokes follow until every number is known to 3 %, or 12 rounds are over. Other
/// contact points than the first get no force.
///
/// The device is opened, asked to take the force away by itself if nothing is written for 30 ms,
/// enabled, and closed at the end, as a loop does.
///
/// The handle stays within [`IdentifyOptions::travel`] and [`angle`](IdentifyOptions::angle) of
/// its start, and below a speed; forces stay within a part of the largest, and change no
/// faster than the profile allows. What breaks a limit ends the identification. However it
/// ends, zero forces are written last to a device that opened, after a panic of it too.
///
/// `next_tick` returns the time of each tick [s], when that has come, on any clock: a simulated
/// device needs no waiting. It returns `None` to stop. Ticks need not be even, as their times are
/// what counts; between rounds, without a force, one may be late by the time of the evaluation.
///
/// Found are the numbers of what moves: a device with a constant delay between a written force
/// and its reading, with static friction far above its Coulomb friction, or with elastic drives
/// moves otherwise, and [`IdentifiedAxis::misfit`] says so.
///
/// # Errors
///
/// [`IdentifyError`], which says what is wrong and what to do: a hand that holds the handle, a
/// handle that falls or is stuck, readings that are not numbers, a lost device, a wrong option.
///
/// # Examples
///
/// The simulated device differs from its profile:
///
/// ```
/// use palpate_device::{DeviceProfile, profile_named};
/// use palpate_sim::{Hand, IdentifyOptions, SimulatedDevice, identify};
/// use palpate_field::Vector;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let profile = profile_named("omega")?;
/// let built = DeviceProfile { mass: 0.3, least_damping: 1.2, friction: 0.15, ..profile.clone() };
/// let free = Hand::free(Vector([0.0, 0.0, 0.0]))?;
/// let mut device = SimulatedDevice::new(built, vec![free])?;
///
/// let mut tick = 0.0;
/// let found = identify(&mut device, IdentifyOptions::new(1000.0), &mut |_| {
///     tick += 1.0;
///     Some(tick / 1000.0)
/// })?;
/// let x = &found.axes[0];
/// assert!((x.mass.value / 0.3 - 1.0).abs() < 0.01 && x.mass.is_seen());
/// assert!((x.damping.value / 1.2 - 1.0).abs() < 0.05);
/// assert!((x.friction.value / 0.15 - 1.0).abs() < 0.05);
/// assert!((x.encoder_step.size() / 1e-5 - 1.0).abs() < 1e-9);
///
/// let better: DeviceProfile = found.profile(&profile, "strokes");
/// assert!(!better.assumed.contains(&"friction") && better.max_force == profile.max_force);
/// # Ok(())
/// # }
/// ```
#[inline(never)]
pub fn identify(
    device: &mut dyn Device,
    options: IdentifyOptions,
    next_tick: &mut NextTick<'_>,
) -> Result<Identified, IdentifyError> {
    let profile = device.profile().clone();
    options.check(&profile)?;
    check_forces(&profile)?;
    let along = (0..3).map(|i| (DeviceAxis::Along(i), options.along(&profile)));
    let about = options.about(&profile);
    let turns = (0..3).filter_map(|i| about.map(|bounds| (DeviceAxis::About(i), bounds)));
    let axes: Vec<_> = along.chain(turns).collect();
    let mut port = Port::new(device, options, next_tick);
    port.progress.axes = axes.len();
    port.open()?;
    let mut found = Vec::with_capacity(axes.len());
    for (axis, bounds) in axes {
        port.turn_to(axis, bounds)?;
        found.push(axis::identify_axis(&mut port, options.seed)?);
    }
    let axis = port.axis();
    port.release().map_err(|lost| IdentifyError::Lost { axis, lost })?;
    let is_turning_unknown = profile.turning.is_some() && about.is_none();
    Ok(Identified { axes: found, is_turning_unknown })
}

fn check_forces(profile: &DeviceProfile) -> Result<(), IdentifyError> {
    if profile.max_force == 0.0 {
        return Err(IdentifyError::NoForce { name: profile.name.to_string() });
    }
    NumberError::check_positive("max_force", profile.max_force, "N")?;
    NumberError::check_positive("continuous_force", profile.continuous_force, "N")?;
    NumberError::check_positive("max_force_rate", profile.max_force_rate, "N/s")?;
    if let Some(turning) = profile.turning.as_ref().filter(|t| t.max_torque != 0.0) {
        NumberError::check_positive("max_torque", turning.max_torque, "N·m")?;
        NumberError::check_positive("continuous_torque", turning.continuous_torque, "N·m")?;
        NumberError::check_positive("max_torque_rate", turning.max_torque_rate, "N·m/s")?;
    }
    Ok(())
}
