// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The tool of a scene, if it has a shape, and where the built-in hand takes it.

use palpate::field::{Aabb, Rotation, Shape};
use palpate::haptics::{HandPath, Tool, Tour};
use palpate::scene::BuiltScene;

use crate::arguments::FeelOptions;
use crate::input::{self, Named};
use crate::outcome::Failure;

/// Points of the tool that the built-in hand thinks of: those of the coarsest shell.
const POINTS: usize = 16;

/// A tool with a shape, and where its origin cannot be.
pub(super) struct Held<const D: usize> {
    pub(super) tool: Tool<D>,
    obstacle: Shape<D>,
    /// What holds both the bodies and the places from which the tool touches them.
    pub(super) bounds: Aabb<D>,
}

/// The tool of the scene; none if contact points touch.
pub(super) fn of_scene<const D: usize>(
    named: &Named,
    scene: &BuiltScene<D>,
    options: &FeelOptions,
) -> Result<Option<Held<D>>, Failure> {
    let Some((data, shape)) = named.tool.as_ref().zip(scene.tool.as_ref()) else {
        return Ok(None);
    };
    if options.points.is_some() {
        let problem = "--points is for contact points: the tool of the scene has a shape";
        return Err(Failure::input(problem));
    }
    let mut data = data.clone();
    data.radius = options.radius.unwrap_or(data.radius);
    let tool = Tool::from_data(&data, shape).map_err(Failure::input)?;
    // As the device holds it.
    let rotation = scene.workspace.map_or_else(Rotation::identity, |(pose, _)| pose.rotation);
    let obstacle =
        tool.shell().obstacle(&rotation, &scene.whole, POINTS).map_err(Failure::input)?;
    let bodies = input::bounds(scene)?;
    let bounds = tool.shell().points().iter().fold(bodies, |all, point| {
        let arm = rotation.rotate(point.centre);
        all.union(&Aabb { min: bodies.min - arm, max: bodies.max - arm })
    });
    Ok(Some(Held { tool, obstacle, bounds }))
}

impl<const D: usize> Held<D> {
    /// A tour of `duration` [s] that presses the tool as deep as it would a probe.
    pub(super) fn path(&self, duration: f64) -> Result<HandPath<D>, Failure> {
        let radius = self.tool.shell().points().first().map_or(0.0, |point| point.radius);
        Tour::new(self.bounds, duration)
            .and_then(|tour| tour.with_probe_radius(radius))
            .and_then(|tour| tour.over(&self.obstacle))
            .map_err(Failure::input)
    }
}
