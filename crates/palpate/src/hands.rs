// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Where a simulated hand goes in a scene: on a tour over its bodies, or along a path.

use std::f64::consts::TAU;

use palpate_field::{Shape, SpaceShape, Vector};
use palpate_haptics::{Probe, Tool};
use palpate_scene::{BuiltScene, BuiltTool};
use palpate_sim::{HandPath, Interpolation, SimulationError, Tour};

use crate::Error;

/// How far each contact point on a tour lags behind the one before [s].
const LAG: f64 = 0.5;

/// The points of a tool that a tour is planned for: those of the coarsest shell.
const TOOL_POINTS: usize = 16;

/// How far a hand swings a tool about each axis [rad]: enough to be felt, too little to leave a tour.
const SWING: f64 = 0.15;

/// The periods of the swings about the axes [s]: none is a multiple of another.
const SWINGS: [f64; 3] = [3.1, 4.3, 5.7];

/// Points of a swinging path per second.
const SWING_POINTS: f64 = 20.0;

/// The longest swing [s]: half a day.
const LONGEST_SWING: f64 = 43_200.0;

/// A way of the hand through a scene [m], and the contact points that go along it.
///
/// ```
/// use palpate::hands::HandWay;
/// use palpate::scene::{AnyScene, Scene};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let text = r#"{ "palpate": 1, "dimension": 3,
///     "bodies": [ { "name": "ball", "shape": { "ball": { "radius": 0.05 } } } ],
///     "tool": { "points": [ [-0.01, 0, 0], [0.01, 0, 0] ] } }"#;
/// let AnyScene::Spatial(scene) = Scene::from_json(text)?.build()? else { unreachable!() };
/// let paths = HandWay::tour(&scene, 5.0, 1)?.paths()?;
/// // The two points of the tool go side by side.
/// assert_eq!(paths.len(), 2);
/// assert!((paths[1].positions()[0][0] - paths[0].positions()[0][0] - 0.02).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct HandWay {
    path: HandPath,
    /// How far each contact point is behind [s] and beside the path [m].
    points: Vec<(f64, Vector<f64, 3>)>,
}

impl HandWay {
    /// A tour over all bodies for `duration` [s]. The contact points of the scene's tool go side by side, a tool with a
    /// shape is one; without a tool `points` contact points follow each other, half a second apart.
    ///
    /// # Errors
    ///
    /// If no body has bounds or a surface, the duration is not positive, or the tool makes no shell.
    pub fn tour<const D: usize>(
        scene: &BuiltScene<D>,
        duration: f64,
        points: usize,
    ) -> Result<Self, Error> {
        let tool = scene.tool.as_ref().map_or(Ok(None), BuiltTool::in_hand)?;
        if let Some(tool) = tool {
            return Ok(Self::along(scene, with_tool(scene, &tool, duration)?));
        }
        let bounds = scene.bounds().ok_or(SimulationError::NoBounds)?;
        let arms: Vec<_> = scene.contact_points().collect();
        let points: Vec<_> = if arms.is_empty() {
            (0..points).map(|point| (LAG * point as f64, Vector::ZERO)).collect()
        } else {
            arms.into_iter().map(|arm| (0.0, arm)).collect()
        };
        let lag = points.last().map_or(0.0, |(behind, _)| *behind);
        let radius = scene.tool.as_ref().map_or(Probe::default().radius(), |tool| tool.radius);
        let whole = SpaceShape::from(&scene.whole);
        let bodies: Vec<_> = scene.bodies.iter().map(|body| (&body.shape).into()).collect();
        let tour = Tour::new(bounds, duration + lag)?.with_probe_radius(radius)?;
        Ok(Self { path: tour.over_each(whole.shape(), &bodies)?, points })
    }

    /// Along a path [m], which carries the contact points of the scene's tool. Without such points, one contact point
    /// follows the path.
    pub fn along<const D: usize>(scene: &BuiltScene<D>, path: HandPath) -> Self {
        let mut points: Vec<_> = scene.contact_points().map(|arm| (0.0, arm)).collect();
        if points.is_empty() {
            points.push((0.0, Vector::ZERO));
        }
        Self { path, points }
    }

    /// The path of the hand.
    #[must_use]
    pub fn path(&self) -> &HandPath {
        &self.path
    }

    /// How many contact points go along it.
    #[must_use]
    pub fn points(&self) -> usize {
        self.points.len()
    }

    /// The path of each contact point.
    ///
    /// # Errors
    ///
    /// If a place is farther away than 1e15 m.
    pub fn paths(&self) -> Result<Vec<HandPath>, Error> {
        let path = |(behind, beside): &(f64, Vector<f64, 3>)| {
            let times = self.path.times().iter().map(|time| time - behind).collect();
            let places = self.path.positions().iter().map(|place| *place + *beside).collect();
            Ok(HandPath::new(times, places, self.path.interpolation())?)
        };
        self.points.iter().map(path).collect()
    }
}

/// A tour that presses a tool as deep as a tour presses a probe.
fn with_tool<const D: usize>(
    scene: &BuiltScene<D>,
    tool: &Tool,
    duration: f64,
) -> Result<HandPath, Error> {
    // The workspace map turns the tool as the device holds it.
    let rotation = scene.device_rotation();
    let around =
        |shape: &Shape<D>| tool.shell().obstacle(&rotation, &shape.into(), TOOL_POINTS);
    let obstacle = around(&scene.whole)?;
    let obstacles = scene.bodies.iter().map(|body| around(&body.shape));
    let obstacles = obstacles.collect::<Result<Vec<_>, _>>()?;
    let bounds = scene.bounds_with(tool).ok_or(SimulationError::NoBounds)?;
    let radius = tool.shell().points().first().map_or(0.0, |point| point.radius);
    let tour = Tour::new(bounds, duration)?.with_probe_radius(radius)?;
    Ok(tour.over_each(obstacle.shape(), &obstacles)?)
}

/// How a hand turns a tool for `duration` [s] in a scene of `D` dimensions, as rotation vectors [rad]: it swings about
/// each axis, in the plane about z alone.
///
/// # Errors
///
/// If the duration is not positive or is longer than half a day.
///
/// ```
/// let turns = palpate::hands::swing::<3>(2.0)?;
/// assert!(turns.positions().iter().all(|turn| turn.norm() < 0.3));
/// # Ok::<(), palpate::Error>(())
/// ```
pub fn swing<const D: usize>(duration: f64) -> Result<HandPath, Error> {
    let is_good = duration > 0.0 && duration <= LONGEST_SWING;
    if !is_good {
        return Err(SimulationError::SwingDuration { longest: LONGEST_SWING, duration }.into());
    }
    let steps = (SWING_POINTS * duration).ceil() as usize;
    let times: Vec<_> = (0..=steps).map(|i| i as f64 / SWING_POINTS).collect();
    let turn = |time: &f64| {
        let turn = SWINGS.map(|period| SWING * (TAU * time / period).sin());
        Vector(if D == 2 { [0.0, 0.0, turn[2]] } else { turn })
    };
    let turns = times.iter().map(turn).collect();
    Ok(HandPath::new(times, turns, Interpolation::Smooth)?)
}
