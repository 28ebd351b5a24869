// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Finds mass, damping, friction and encoder step of a device from small motions of its own.

mod axis;
mod error;
mod fit;
mod observed;
mod options;
mod port;
mod report;
mod steps;
mod strokes;

use palpate_haptics::{Device, DeviceProfile, NumberError};

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

/// TODO
pub fn identify<const D: usize>(
    device: &mut dyn Device<D>,
    options: IdentifyOptions,
    next_tick: &mut NextTick<'_>,
) -> Result<Identified, IdentifyError> {
    options.check()?;
    let profile = device.profile().clone();
    check_forces(&profile)?;
    let along = (0..D).map(|i| (DeviceAxis::Along(i), options.along(&profile)));
    let about = options.about(&profile);
    let turns = if D < 3 { 2..3 } else { 0..3 };
    let turns = turns.filter_map(|i| about.map(|bounds| (DeviceAxis::About(i), bounds)));
    let axes: Vec<_> = along.chain(turns).collect();
    let mut port = Port::new(device, options, next_tick);
    port.progress.axes = axes.len();
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
    Ok(())
}
