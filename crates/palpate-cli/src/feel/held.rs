// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What the hand holds, and where its workspace lies.

use palpate::devices::{Device, Glove, Hand, RecordedDevice, SimulatedDevice};
use palpate::devices::{HandPath, Interpolation};
use palpate::haptics::{HapticsError, WorkspaceMap};
use palpate::scene::BuiltScene;

use super::tool::Held;
use crate::arguments::DeviceChoice;
use crate::outcome::Failure;

/// Where the workspace of the device lies: where the scene says, or else, that of a simulated
/// device, so that it holds the scene, or what holds the places of a tool.
pub(super) fn map<const D: usize>(
    scene: &BuiltScene<D>,
    tool: Option<&Held<D>>,
    choice: &DeviceChoice,
) -> Result<WorkspaceMap<D>, Failure> {
    match choice {
        DeviceChoice::Simulated(profile) => {
            let tool = tool.map(|held| &held.tool);
            scene.workspace_of(profile, tool).map_err(Failure::input)
        }
        DeviceChoice::Recorded | DeviceChoice::Glove => Ok(scene.workspace.unwrap_or_default()),
    }
}

/// The device, with a hand on each path of the world, which turns one that turns by `turns`.
pub(super) fn device<const D: usize>(
    choice: &DeviceChoice,
    (paths, turns): (Vec<HandPath<D>>, Option<HandPath<3>>),
    map: &WorkspaceMap<D>,
) -> Result<Box<dyn Device<D> + Send>, HapticsError> {
    let paths = paths.iter().map(|path| at_device(path, map)).collect::<Result<Vec<_>, _>>()?;
    Ok(match choice {
        DeviceChoice::Recorded => Box::new(RecordedDevice::new(paths)?),
        DeviceChoice::Glove => Box::new(Glove::new(paths)?),
        DeviceChoice::Simulated(profile) => {
            let hand = |path| match &turns {
                Some(turns) => Hand::new(path).with_turns(turns.clone()),
                None => Hand::new(path),
            };
            let hands = paths.into_iter().map(hand).collect();
            Box::new(SimulatedDevice::new((**profile).clone(), hands)?)
        }
    })
}

/// A path of the world in the coordinates of the device.
fn at_device<const D: usize>(
    path: &HandPath<D>,
    map: &WorkspaceMap<D>,
) -> Result<HandPath<D>, HapticsError> {
    let positions = path.positions().iter().map(|point| map.point_to_device(*point)).collect();
    HandPath::new(path.times().to_vec(), positions, Interpolation::Smooth)
}
