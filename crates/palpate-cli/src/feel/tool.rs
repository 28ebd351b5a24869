// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The tool of a scene, if it has a shape, and the built-in hand's tour with it.

use palpate::devices::{HandPath, Interpolation, Tour};
use palpate::field::{Aabb, Shape, Vector};
use palpate::haptics::Tool;
use palpate::scene::{BuiltScene, BuiltTool};

use crate::arguments::FeelOptions;
use crate::input;
use crate::outcome::Failure;

/// The points of the tool that a tour is planned for: those of the coarsest shell.
const POINTS: usize = 16;

/// How far the built-in hand swings the tool about each axis [rad]: enough to be felt, too
/// little to leave the tour.
const SWING: f64 = 0.15;

/// The periods of the swings about the axes [s]: none is a multiple of another.
const SWINGS: [f64; 3] = [3.1, 4.3, 5.7];

/// Points of the swinging path per second.
const SWING_POINTS: f64 = 20.0;

/// The most points of the swinging path: those of half a day.
const MOST_SWING_POINTS: f64 = 1e6;

/// A tool with a shape, and the places that its origin cannot take.
pub(super) struct Held<const D: usize> {
    pub(super) tool: Tool<D>,
    obstacle: Shape<D>,
    /// The part of them that each body makes.
    obstacles: Vec<Shape<D>>,
    /// A box that holds the bodies, and the places of the origin from which the tool touches
    /// them.
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
        let problem = "--points is not for this scene: the tool of the scene has a shape";
        return Err(Failure::input(problem));
    }
    // The workspace map turns the tool as the device holds it.
    let rotation = scene.device_rotation();
    let around = |shape: &Shape<D>| {
        tool.shell().obstacle(&rotation, shape, POINTS).map_err(Failure::input)
    };
    let obstacle = around(&scene.whole)?;
    let obstacles = scene.bodies.iter().map(|body| around(&body.shape));
    let obstacles = obstacles.collect::<Result<_, _>>()?;
    let bounds = scene.bounds_with(&tool);
    let bounds = bounds.ok_or_else(|| Failure::input(input::NO_BOUNDS))?;
    Ok(Some(Held { tool, obstacle, obstacles, bounds }))
}

impl<const D: usize> Held<D> {
    /// A tour of `duration` [s] that presses the tool as deep as a tour presses a probe.
    pub(super) fn path(&self, duration: f64) -> Result<HandPath<D>, Failure> {
        let radius = self.tool.shell().points().first().map_or(0.0, |point| point.radius);
        Tour::new(self.bounds, duration)
            .and_then(|tour| tour.with_probe_radius(radius))
            .and_then(|tour| tour.over_each(&self.obstacle, &self.obstacles))
            .map_err(Failure::input)
    }
}

/// The rotation of the built-in hand over `duration` [s], for a device with rotation.
pub(super) fn turns(duration: f64) -> Result<HandPath<3>, Failure> {
    let steps = (SWING_POINTS * duration).ceil().max(1.0);
    if steps > MOST_SWING_POINTS {
        let longest = MOST_SWING_POINTS / SWING_POINTS;
        let problem =
            format!("the built-in hand turns a tool for at most {longest} s, got {duration} s");
        return Err(Failure::input(problem));
    }
    let steps = steps as usize;
    let times: Vec<_> = (0..=steps).map(|i| i as f64 / SWING_POINTS).collect();
    let turn = |time: &f64| {
        Vector(SWINGS.map(|period| SWING * (std::f64::consts::TAU * time / period).sin()))
    };
    let turns = times.iter().map(turn).collect();
    HandPath::new(times, turns, Interpolation::Smooth).map_err(Failure::input)
}
