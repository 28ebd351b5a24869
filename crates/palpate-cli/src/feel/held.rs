// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The device that the hand holds, and its workspace.

use palpate::devices::HandPath;
use palpate::devices::{Device, DeviceError, Glove, Hand, RecordedDevice, SimulatedDevice};
use palpate::haptics::WorkspaceMap;
use palpate::scene::BuiltScene;

use super::tool::Held;
use crate::arguments::DeviceChoice;
use crate::numbers::rounded;
use crate::outcome::Failure;
use crate::output;

/// The workspace map: that of the scene; else, for a simulated device, one whose workspace
/// holds `bounds`, of the scene or of the places of a tool.
pub(super) fn map<const D: usize>(
    scene: &BuiltScene<D>,
    tool: Option<&Held<D>>,
    choice: &DeviceChoice,
) -> Result<WorkspaceMap<D>, Failure> {
    match choice {
        DeviceChoice::Simulated(choice) => {
            let tool = tool.map(|held| &held.tool);
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

/// Says how far paths leave the workspace of a simulated device.
pub(super) fn warn_of_workspace<const D: usize>(
    choice: &DeviceChoice,
    paths: &[HandPath<D>],
    map: &WorkspaceMap<D>,
) {
    let DeviceChoice::Simulated(choice) = choice else { return };
    let profile = &choice.profile;
    let places = paths.iter().flat_map(HandPath::positions);
    let farthest = places.map(|point| map.point_to_device(*point).norm()).fold(0.0, f64::max);
    let beyond = farthest - profile.workspace_radius;
    // What rounding adds to a workspace that is fitted is nothing.
    if beyond > 1e-9 * profile.workspace_radius {
        let beyond = rounded(1e3 * beyond);
        output::remark(format_args!(
            "the path leaves the workspace of the {} by up to {beyond} mm at the device, where a hand \
             cannot follow it; `workspace` of the scene's `tool` has a scale",
            profile.name,
        ));
    }
}

/// The device, with a hand for each path in world coordinates. `turns` is the rotation of the
/// hand over time, for a device with rotation.
pub(super) fn device<const D: usize>(
    choice: &DeviceChoice,
    paths: &[HandPath<D>],
    turns: Option<&HandPath<3>>,
    map: &WorkspaceMap<D>,
) -> Result<Box<dyn Device<D> + Send>, DeviceError> {
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
