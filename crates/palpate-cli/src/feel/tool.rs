// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The tool of a scene, if it has a shape, and where the built-in hand takes it.

use palpate::devices::{HandPath, Interpolation, Tour};
use palpate::field::{Aabb, Shape, Vector};
use palpate::haptics::Tool;
use palpate::scene::{BuiltScene, BuiltTool};

use crate::arguments::FeelOptions;
use crate::input;
use crate::outcome::Failure;

/// Points of the tool that the built-in hand thinks of: those of the coarsest shell.
const POINTS: usize = 16;

/// How far the built-in hand turns the tool about an axis, to and fro [rad]: enough to be felt,
/// and not so much that the tour leads it elsewhere.
const SWING: f64 = 0.15;

/// In what times it does, about each axis [s]: none a multiple of another.
const SWINGS: [f64; 3] = [3.1, 4.3, 5.7];

/// Points of that path a second.
const SWING_POINTS: f64 = 20.0;

/// A tool with a shape, and where its origin cannot be.
pub(super) struct Held<const D: usize> {
    pub(super) tool: Tool<D>,
    obstacle: Shape<D>,
    /// What holds both the bodies and the places from which the tool touches them.
    pub(super) bounds: Aabb<D>,
}

/// The tool of the scene; `None` if contact points touch.
pub(super) fn of_scene<const D: usize>(
    scene: &BuiltScene<D>,
    options: &FeelOptions,
) -> Result<Option<Held<D>>, Failure> {
    let tool = scene.tool.as_ref().map_or(Ok(None), BuiltTool::in_hand);
    let Some(tool) = tool.map_err(Failure::input)? else { return Ok(None) };
    if options.points.is_some() {
        let problem = "--points is for contact points: the tool of the scene has a shape";
        return Err(Failure::input(problem));
    }
    // As the device holds it.
    let rotation = scene.device_rotation();
    let obstacle =
        tool.shell().obstacle(&rotation, &scene.whole, POINTS).map_err(Failure::input)?;
    let bounds = scene.bounds_with(&tool);
    let bounds = bounds.ok_or_else(|| Failure::input(input::NO_BOUNDS))?;
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

/// How the built-in hand turns a device that turns, for `duration` [s].
pub(super) fn turns(duration: f64) -> Result<HandPath<3>, Failure> {
    let steps = (SWING_POINTS * duration).ceil().max(1.0) as usize;
    let times: Vec<_> = (0..=steps).map(|i| i as f64 / SWING_POINTS).collect();
    let turn = |time: &f64| {
        Vector(SWINGS.map(|period| SWING * (std::f64::consts::TAU * time / period).sin()))
    };
    let turns = times.iter().map(turn).collect();
    HandPath::new(times, turns, Interpolation::Smooth).map_err(Failure::input)
}
