// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Paths of hands, and how near they come.

use std::path::Path;

use palpate::device::Device;
use palpate::field::{Aabb, Vector};
use palpate::hands::HandWay;
use palpate::haptics::Tool;
use palpate::plot::{Color, Dash, Isolines, PlaneView, PlotError, Polyline, Sampling, Slice};
use palpate::safety::WorkspaceMap;
use palpate::scene::BuiltScene;
use palpate::scene::text::rounded;
use palpate::sim::{Glove, Hand, HandPath, RecordedDevice, SimulatedDevice, SimulationError};
use serde::Serialize;

use super::limits;
use crate::feel::{DeviceChoice, FeelOptions};
use crate::input;
use crate::outcome::Failure;
use crate::picture::{self, Dimensions, Drawable};

/// The contact points of the built-in hand on the built-in gallery: two hands.
const FINGERS: usize = 10;

/// The longest time that a hand may rest before its path begins, unless a duration is given [s].
const LONGEST_REST: f64 = 86_400.0;

/// How many contact points follow each other on a tour, if the scene's tool has none.
fn following(options: &FeelOptions) -> usize {
    options.points.unwrap_or(if options.scene.is_none() { FINGERS } else { 1 })
}

/// How many contact points a run without a file has.
pub(super) fn count<const D: usize>(scene: &BuiltScene<D>, options: &FeelOptions) -> usize {
    match scene.contact_points().count() {
        0 => following(options),
        points => points,
    }
}

/// The paths of the contact points over `duration` [s], on a tour of the scene.
pub(super) fn on_tour<const D: usize>(
    scene: &BuiltScene<D>,
    options: &FeelOptions,
    duration: f64,
) -> Result<Vec<HandPath>, Failure> {
    let way = HandWay::tour(scene, duration, following(options)).map_err(Failure::input)?;
    paths(&way)
}

/// The paths of the contact points that go a way, if they do not take too much memory.
fn paths(way: &HandWay) -> Result<Vec<HandPath>, Failure> {
    limits::paths(way.points(), way.path().times().len())?;
    way.paths().map_err(Failure::input)
}

/// The paths in a file. A path of one contact point carries the points of the scene's tool, which
/// lie beside it; paths of as many contact points as the tool has lead each of them.
///
/// # Errors
///
/// If the file is no hand path, or has another number of contact points.
pub(super) fn in_file<const D: usize>(
    scene: &BuiltScene<D>,
    options: &FeelOptions,
    file: &Path,
) -> Result<Vec<HandPath>, Failure> {
    if options.points.is_some() {
        return Err(Failure::input(
            "--points is about the built-in hand; with --path, the column `point` of the file, or the \
             `points` of the scene's tool, say how many there are",
        ));
    }
    let all = input::read::<D>(file, options.reading)?;
    match (&all[..], scene.contact_points().count()) {
        (_, 0) => Ok(all),
        ([hand], _) => paths(&HandWay::along(scene, hand.clone())),
        (_, points) if all.len() == points => Ok(all),
        (_, points) => {
            let given = all.len();
            let problem = format!(
                "there are {given} contact points, and the tool of the scene has {points}; \
                 give one, which carries the tool, or {points}, one for each point"
            );
            Err(Failure::file(file, problem))
        }
    }
}

/// How near paths come to the scene, at some of their samples [m].
pub(super) fn nearest<const D: usize>(scene: &BuiltScene<D>, paths: &[HandPath]) -> f64 {
    /// Samples of a path that are looked at.
    const LOOKED_AT: usize = 1000;
    let seen = paths.iter().flat_map(|path| {
        let step = path.positions().len().div_ceil(LOOKED_AT).max(1);
        path.positions().iter().step_by(step)
    });
    seen.map(|point| scene.whole.distance(point.truncated::<D>())).fold(f64::INFINITY, f64::min)
}

/// When the last path ends [s].
pub(super) fn end(paths: &[HandPath]) -> f64 {
    paths.iter().map(|path| path.start() + path.duration()).fold(f64::NEG_INFINITY, f64::max)
}

/// Refuses paths along which the hand does not move in the run.
pub(super) fn check_times(
    file: &Path,
    paths: &[HandPath],
    duration: Option<f64>,
) -> Result<(), Failure> {
    let first = paths.iter().map(HandPath::start).fold(f64::INFINITY, f64::min);
    let last = end(paths);
    if last > 0.0 && first < duration.unwrap_or(LONGEST_REST) {
        return Ok(());
    }
    let run = match duration {
        Some(duration) => format!("the run goes from 0 s to {duration} s"),
        None => "the run begins at 0 s".to_owned(),
    };
    let problem = format!(
        "the hand moves from {first} s to {last} s, and {run}: times count from the start of the run"
    );
    Err(Failure::file(file, problem))
}

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

/// Pieces of a line, in plane coordinates [m].
pub(super) type Pieces = Vec<Vec<[f64; 2]>>;

/// The pieces of a line, by the side of the slice on which they lie.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Seen {
    pub(super) near: Pieces,
    pub(super) in_front: Pieces,
    pub(super) behind: Pieces,
}

/// Where a point lies for the viewer of a slice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Near,
    InFront,
    Behind,
}

/// The side of `plane` on which `point` lies; `near` [m] is the largest distance that counts as
/// near.
pub(super) fn side(plane: &Slice, near: f64, point: Vector<f64, 3>) -> Side {
    let elevation = plane.elevation(point.0);
    if elevation.abs() <= near {
        Side::Near
    } else if elevation > 0.0 {
        Side::InFront
    } else {
        Side::Behind
    }
}

/// Takes the line through `points` apart. Each piece begins where the one before ends, so there
/// are no gaps.
pub(super) fn taken_apart(
    plane: &Slice,
    near: f64,
    points: impl IntoIterator<Item = Vector<f64, 3>>,
) -> Seen {
    let mut seen = Seen::default();
    let mut last: Option<(Side, [f64; 2])> = None;
    for point in points {
        let (side, here) = (side(plane, near, point), plane.project(point.0));
        let pieces = match side {
            Side::Near => &mut seen.near,
            Side::InFront => &mut seen.in_front,
            Side::Behind => &mut seen.behind,
        };
        match (pieces.last_mut(), last) {
            (Some(piece), Some((before, _))) if before == side => piece.push(here),
            (_, Some((_, there))) => pieces.push(vec![there, here]),
            (_, None) => pieces.push(vec![here]),
        }
        last = Some((side, here));
    }
    seen
}

/// Times between the beginning and the end at which bodies are drawn, as shares of the run.
const BETWEEN: [f64; 3] = [0.25, 0.5, 0.75];

/// The box around the bodies that move, where they are drawn; `None` if there are none.
pub(super) fn bounds<const D: usize>(scene: &BuiltScene<D>, end: f64) -> Option<Aabb<D>> {
    let mut all: Option<Aabb<D>> = None;
    for share in BETWEEN.into_iter().chain([1.0]) {
        for body in scene.moving() {
            let shape = &scene.bodies[body].shape_in_body;
            let Some(bounds) = shape.promise().bounds else { continue };
            let there = bounds.placed(&scene.pose_at(body, share * end)).aabb;
            all = Some(all.map_or(there, |all| all.union(&there)));
        }
    }
    all
}

/// The isolines with outlines of the bodies that move.
pub(super) fn drawn_over<const D: usize>(
    isolines: Isolines,
    scene: &BuiltScene<D>,
    plane: &Slice,
    view: &PlaneView,
    end: f64,
) -> Result<Isolines, PlotError>
where
    Dimensions: Drawable<D>,
{
    if scene.motions.is_empty() {
        return Ok(isolines);
    }
    let mut between = Vec::new();
    for share in BETWEEN {
        between.extend(outlines(scene, plane, view, share * end)?);
    }
    let last = outlines(scene, plane, view, end)?;
    let between = Polyline::of_pieces("bodies on their way", between)?.faint();
    let last = Polyline::of_pieces(format!("bodies at {end} s"), last)?;
    let last = last.with_color(Color::INK).with_dash(Dash::Dashed);
    Ok(isolines.with_polyline(between).with_polyline(last))
}

/// The outlines of the bodies that move, at a time [s].
fn outlines<const D: usize>(
    scene: &BuiltScene<D>,
    plane: &Slice,
    view: &PlaneView,
    time: f64,
) -> Result<Vec<Vec<[f64; 2]>>, PlotError>
where
    Dimensions: Drawable<D>,
{
    let mut lines = Vec::new();
    for body in scene.moving() {
        let pose = scene.pose_at(body, time);
        // A pose that a scene accepted places every shape: `feel` has been there.
        let Ok(shape) = scene.bodies[body].shape_in_body.clone().placed(&pose) else {
            continue;
        };
        let outline = picture::outline(&shape, plane, view, Sampling::default())?;
        lines.extend(outline.lines().iter().cloned());
    }
    Ok(lines)
}

#[cfg(test)]
mod nearness_tests {
    use super::*;

    #[test]
    fn a_line_is_taken_apart_without_gaps() {
        let plane = Slice::xy(1.0).unwrap();
        let heights = [1.0, 1.1, 1.3, 1.2, 0.95, 0.5, 1.5];
        let points = (0..7).zip(heights).map(|(i, z)| Vector([f64::from(i), 5.0, z]));
        let seen = taken_apart(&plane, 0.15, points);
        let piece = |from: i32, to: i32| -> Vec<[f64; 2]> {
            (from..=to).map(|i| [f64::from(i), 5.0]).collect()
        };
        assert_eq!(seen.near, [piece(0, 1), piece(3, 4)]);
        assert_eq!(seen.in_front, [piece(1, 3), piece(5, 6)]);
        assert_eq!(seen.behind, [piece(4, 5)]);
    }

    #[test]
    fn sides_are_those_of_the_viewer() {
        // A slice across x is seen from −x.
        let plane = Slice::yz(0.5).unwrap();
        let at = |x: f64| side(&plane, 0.1, Vector([x, 2.0, 3.0]));
        assert_eq!([at(0.45), at(0.3), at(0.7)], [Side::Near, Side::InFront, Side::Behind]);
    }

    #[test]
    fn in_the_plane_all_is_near() {
        let points = [Vector([1.0, 2.0, 0.0]), Vector([3.0, -4.0, 0.0])];
        let seen = taken_apart(&Slice::planar(), f64::INFINITY, points);
        assert_eq!(seen.near, [vec![[1.0, 2.0], [3.0, -4.0]]]);
        assert!(seen.in_front.is_empty() && seen.behind.is_empty());
    }
}
