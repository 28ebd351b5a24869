// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The device that the hand holds, and its workspace.

use palpate::device::Device;
use palpate::field::Vector;
use palpate::haptics::Tool;
use palpate::safety::WorkspaceMap;
use palpate::scene::BuiltScene;
use palpate::sim::{Glove, Hand, HandPath, RecordedDevice, SimulatedDevice, SimulationError};
use serde::Serialize;

use crate::arguments::DeviceChoice;
use crate::outcome::Failure;
use palpate::scene::text::rounded;

/// The workspace map: that of the scene; else, for a simulated device, one whose workspace
/// holds `bounds`, of the scene or of the places of a tool.
pub(super) fn map<const D: usize>(
    scene: &BuiltScene<D>,
    tool: Option<&Tool>,
    choice: &DeviceChoice,
) -> Result<WorkspaceMap, Failure> {
    match choice {
        DeviceChoice::Simulated(choice) => {
            scene.workspace_of(&choice.profile, tool).map_err(Failure::input)
        }
        DeviceChoice::Recorded | DeviceChoice::Glove => Ok(scene.workspace.unwrap_or_default()),
    }
}

/// `true` if the workspace map is made to hold the scene, and not given by it.
pub(super) fn is_fitted<const D: usize>(scene: &BuiltScene<D>, choice: &DeviceChoice) -> bool {
    let is_limited = match choice {
        DeviceChoice::Simulated(choice) => choice.profile.workspace_radius < f64::INFINITY,
        DeviceChoice::Recorded | DeviceChoice::Glove => false,
    };
    is_limited && scene.workspace.is_none() && scene.bounds().is_some()
}

/// How far paths leave the workspace of a simulated device.
#[derive(Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Beyond {
    #[serde(skip)]
    device: String,
    /// The largest distance from the workspace, at the device [m].
    distance: f64,
    /// World metres for each metre of the device.
    scale: f64,
    /// The least scale with which all paths are in the workspace, rounded up.
    sufficient_scale: f64,
    /// Where the centre of the workspace is in the world [m].
    center: Vec<f64>,
}

impl Beyond {
    /// For a scene of `D` dimensions.
    pub(super) fn of<const D: usize>(
        choice: &DeviceChoice,
        paths: &[HandPath],
        map: &WorkspaceMap,
    ) -> Option<Self> {
        let DeviceChoice::Simulated(choice) = choice else { return None };
        let profile = &choice.profile;
        let (scale, radius) = (map.scale(), profile.workspace_radius);
        let places = paths.iter().flat_map(HandPath::positions);
        let farthest =
            places.map(|point| map.point_to_device(*point).norm()).fold(0.0, f64::max);
        let distance = farthest - radius;
        // What rounding adds to a workspace that is fitted is nothing.
        (distance > 1e-9 * radius).then(|| Self {
            device: profile.name.to_string(),
            distance,
            scale,
            sufficient_scale: rounded_up(scale * farthest / radius),
            center: map.point_to_world(Vector::ZERO).truncated::<D>().0.to_vec(),
        })
    }

    /// What is said before the run.
    pub(super) fn warning(&self) -> String {
        let Self { device, distance, scale, sufficient_scale, center } = self;
        let center: Vec<_> = center.iter().map(|x| rounded(*x)).collect();
        format!(
            "the path leaves the workspace of the {device} by up to {} mm at the device, where a hand \
             cannot follow it: the workspace has a scale of {} m of the scene for each metre of the \
             device; around the same centre, [{}] m, a scale of {} would suffice: see `workspace` of \
             the scene's `tool`",
            rounded(1e3 * distance),
            rounded(*scale),
            center.join(", "),
            rounded(*sufficient_scale),
        )
    }
}

/// A positive number with four significant digits that is no less.
fn rounded_up(number: f64) -> f64 {
    let unit = 10.0_f64.powi(number.log10().floor() as i32 - 3);
    (number / unit).ceil() * unit
}

/// The device, with a hand for each path in world coordinates. `turns` is the rotation of the
/// hand over time, for a device with rotation.
pub(super) fn device(
    choice: &DeviceChoice,
    paths: &[HandPath],
    turns: Option<&HandPath>,
    map: &WorkspaceMap,
) -> Result<Box<dyn Device + Send>, SimulationError> {
    let paths = paths.iter().map(|path| path.mapped(|point| map.point_to_device(point)));
    let paths = paths.collect::<Result<Vec<_>, _>>()?;
    Ok(match choice {
        DeviceChoice::Recorded => Box::new(RecordedDevice::new(paths)?),
        DeviceChoice::Glove => Box::new(Glove::new(paths)?),
        DeviceChoice::Simulated(choice) => {
            let hand = |path| match turns {
                Some(turns) => Hand::new(path).with_turns(turns.clone()),
                None => Hand::new(path),
            };
            let hands = paths.into_iter().map(hand).collect();
            Box::new(SimulatedDevice::new(choice.profile.clone(), hands)?)
        }
    })
}
