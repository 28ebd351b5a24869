// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a tick of a tool with a shape costs.
//!
//! A rounded block of 40 mm, in 1000 balls, is pressed 3 mm into a scene, and moved and turned
//! over it, always touching.

use std::error::Error;
use std::hint::black_box;

use palpate::field::{Point, Pose, Rotation, Shape, Vector, kernel::RoundedCuboid};
use palpate::haptics::{Bodies, Body, Material, Shell, Surface, Tool, ToolOptions, ToolState};

use super::times::Times;
use super::{Case, DEPTH, LANDING, Motion, PASSES, TICKS, orbit};

/// Points of the tool.
const POINTS: usize = 1000;

/// The radius of its balls [m].
const BALLS: f64 = 5e-4;

/// How fast the tool turns about each axis [rad a tick].
const TURNS: [f64; 3] = [2.3e-4, 3.1e-4, 1.7e-4];

/// What a tick of a tool costs that touches `shape`.
pub(super) fn ticks<'a>(
    key: &'a str,
    shape: &'a Shape<3>,
    motion: Motion,
) -> Result<Case<'a>, Box<dyn Error>> {
    let block = RoundedCuboid::new(Vector([0.04, 0.024, 0.03]), 0.004)?;
    let shell = Shell::from_field(&Shape::from_kernel(block), POINTS, BALLS)?;
    let path = orbit::around(shape, 0);
    let mut states = Vec::with_capacity(path.len());
    for (tick, place) in path.iter().enumerate() {
        let ToolState { pose, .. } = state(&shell, shape, (tick, *place))?;
        let translation = pose.translation + motion(tick);
        states.push(ToolState::at_rest(Pose { translation, ..pose }));
    }
    let moves = motion(1) != motion(0);
    Ok(Box::new(move |rows| {
        let mut times = Times::new();
        let (mut evaluations, mut contacts) = (0_u64, 0_u64);
        let (mut touching, mut degraded) = (0_u64, 0_u64);
        for pass in 0..PASSES {
            let mut bodies = bodies(shape)?;
            let mut tool = Tool::new(shell.clone(), options())?;
            for (number, state) in states.iter().enumerate() {
                let tick = number.checked_sub(LANDING);
                let way = motion(number);
                let touch = times.time(tick, || {
                    if moves {
                        bodies.set_pose(0, Pose::translation(way));
                    }
                    black_box(tool.step(&mut bodies, black_box(state)))
                });
                if pass == 0 && tick.is_some() {
                    evaluations += u64::from(touch.evaluations);
                    contacts += touch.contacts.len() as u64;
                    touching += u64::from(touch.contact);
                    degraded += u64::from(touch.is_degraded);
                }
            }
        }
        times.insert(key, rows);
        rows.insert(format!("{key}.evaluations"), evaluations as f64 / TICKS as f64);
        rows.insert(format!("{key}.contacts"), contacts as f64 / TICKS as f64);
        rows.insert(format!("{key}.touching"), touching as f64 / TICKS as f64);
        rows.insert(format!("{key}.degraded"), degraded as f64 / TICKS as f64);
        Ok(())
    }))
}

/// The hand in a tick: turned a little further, and so high above the path that the deepest
/// point of the tool is as deep as hands press.
fn state(
    shell: &Shell,
    shape: &Shape<3>,
    (tick, place): (usize, Point<3>),
) -> Result<ToolState, Box<dyn Error>> {
    let time = tick as f64;
    let [a, b, c] = TURNS.map(|turn| turn * time);
    let about = |axis, angle| Rotation::from_axis_angle(Vector(axis), angle);
    let rotation =
        about([1.0, 0.0, 0.0], a)? * about([0.0, 1.0, 0.0], b)? * about([0.0, 0.0, 1.0], c)?;
    let (_, gradient) = shape.distance_gradient(place);
    let up = gradient.normalized().ok_or("a path without a normal")?;
    let mut centres: Vec<Point<3>> = Vec::with_capacity(shell.points().len());
    let mut depths = vec![0.0; shell.points().len()];
    let mut height = shell.reach();
    // Down until the deepest point is that deep.
    for _ in 0..64 {
        let pose = Pose::new(rotation, place + up * height);
        centres.clear();
        centres.extend(shell.points().iter().map(|p| pose.transform_point(p.centre)));
        shape.distances(&centres, &mut depths);
        let least = depths.iter().copied().fold(f64::INFINITY, f64::min) - BALLS;
        let above = least + landing_depth(tick);
        if above.abs() < 1e-6 {
            break;
        }
        height -= above;
    }
    Ok(ToolState::at_rest(Pose::new(rotation, place + up * height)))
}

/// How deep the tool is pressed in a tick [m]: from above the surface, in the first ticks.
fn landing_depth(tick: usize) -> f64 {
    let part = (tick as f64 / LANDING as f64).min(1.0);
    DEPTH * (2.0 * part - 1.0)
}

fn options() -> ToolOptions {
    ToolOptions {
        stiffness: 1000.0,
        max_force: Some(f64::INFINITY),
        max_torque: f64::INFINITY,
        ..ToolOptions::default()
    }
}

/// One body with friction.
fn bodies(shape: &Shape<3>) -> Result<Bodies, Box<dyn Error>> {
    let material =
        Material { static_friction: 0.5, dynamic_friction: 0.3, ..Material::default() };
    Ok(Bodies::new(vec![Body::new(shape.clone(), Surface::new(&material)?)?])?)
}
