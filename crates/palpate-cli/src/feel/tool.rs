// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The tool of a scene, if it has a shape.

use palpate::haptics::Tool;
use palpate::scene::{BuiltScene, BuiltTool};

use crate::feel::FeelOptions;
use crate::outcome::Failure;

/// The tool of the scene; `None` if contact points touch.
pub(super) fn of_scene<const D: usize>(
    scene: &BuiltScene<D>,
    options: &FeelOptions,
) -> Result<Option<Tool>, Failure> {
    let tool = scene.tool.as_ref().map_or(Ok(None), BuiltTool::in_hand);
    let tool = tool.map_err(Failure::input)?;
    if tool.is_some() && options.points.is_some() {
        let problem = "--points is not for this scene: the tool of the scene has a shape";
        return Err(Failure::input(problem));
    }
    Ok(tool)
}
