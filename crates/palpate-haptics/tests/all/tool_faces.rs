// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Tools that slide over flat faces without friction.

use crate::common::tools::{STIFFNESS, box_mesh, smooth, springs};
use crate::common::{cuboid, half_space};
use palpate_field::{Pose, Rotation, Shape, Vector};
use palpate_haptics::{Bodies, Body, Shell, Surface, Tool, ToolState};

const TICKS: u32 = 4000;

/// The length of a tick [s].
const STEP: f64 = 1e-3;

/// The velocity of faces that move [m/s].
const DRIFT: Vector<f64, 3> = Vector([0.03, 0.0, -0.05]);

/// How far the tool may lag behind the hand over a face that moves [m]: it rests when its next
/// motion is below a thousandth of the hand's, and no point goes farther than 0.3 mm in a tick.
const LAG: f64 = 3e-7;

/// More than the hand presses any point of a tool down in a tick [m]: 80 µm by its turn, 3 µm by its
/// way, and 55 µm by the steps of its readings.
const MOST_PRESSING: f64 = 2e-4;

/// The steps of a device's readings [m] and [rad]; zero for a device without steps.
#[derive(Clone, Copy, Debug)]
struct Steps {
    length: f64,
    angle: f64,
}

const SMOOTH: Steps = Steps { length: 0.0, angle: 0.0 };
const COARSE: Steps = Steps { length: 1.5e-5, angle: 2.5e-4 };

fn rounded(v: Vector<f64, 3>, step: f64) -> Vector<f64, 3> {
    if step == 0.0 { v } else { Vector(v.0.map(|x| (x / step).round() * step)) }
}

/// The hand after a time [s], over a face that rests. It circles at 0.1 m/s, turns by up to
/// 0.9 rad/s, and is at most 3 mm below the height `touching` at which the upright tool touches.
fn hand(time: f64, touching: f64, steps: Steps) -> Pose<3> {
    let [along, across] = [0.02 * (4.0 * time).cos(), 0.025 * (4.0 * time).sin()];
    let height = touching + 0.001 - 0.002 * (1.0 - (1.7 * time).cos());
    let place = rounded(Vector([along, height, across]), steps.length);
    let turn = Vector([0.3, -0.2, 0.4]) * (0.3 * (5.3 * time).sin());
    Pose::new(Rotation::identity().turned(rounded(turn, steps.angle)), place)
}

/// A stylus with its tip below.
fn stylus() -> Shell {
    let shaft = Shape::<3>::cylinder(0.004, 0.08).unwrap().translated([0.0, 0.046, 0.0]);
    let shape = Shape::union([shaft.unwrap(), Shape::cone(0.004, 0.012).unwrap()]).unwrap();
    Shell::from_field(&shape, 500, 0.0).unwrap()
}

/// A capsule that leans by an angle [rad].
fn capsule(lean: f64) -> Shell {
    let end = Vector([-lean.sin(), lean.cos(), 0.0]) * 0.026;
    Shell::capsule([-end, end], 0.004, 27).unwrap()
}

fn tools() -> Vec<Shell> {
    let block = Shell::from_mesh(&box_mesh([0.02, 0.03, 0.025]), 400, 0.0).unwrap();
    let mut tools = vec![block, stylus()];
    tools.extend([0.0, 0.4, 0.8, 1.1, 1.4].map(capsule));
    tools
}

/// A body with its top at height zero.
fn level(shape: Shape<3>, place: [f64; 3]) -> Body {
    let body = Body::new(shape, Surface::new(&smooth()).unwrap()).unwrap();
    body.at(Pose::translation(Vector(place))).unwrap()
}

/// Level faces: endless, of a box, and of two boxes side by side.
fn faces() -> [Vec<Body>; 3] {
    let plate = |x| level(cuboid([0.3, 0.1, 0.6]), [x, -0.05, 0.0]);
    let ground = level(half_space([0.0, 1.0, 0.0], 0.0), [0.0; 3]);
    [vec![ground], vec![plate(0.0)], vec![plate(-0.15), plate(0.15)]]
}

/// A tool on a face that moves at a velocity [m/s].
fn slide(shell: &Shell, face: Vec<Body>, velocity: Vector<f64, 3>, steps: Steps) {
    let places: Vec<_> = face.iter().map(|body| *body.world_from_body()).collect();
    let mut bodies = Bodies::new(face).unwrap();
    let mut tool = Tool::new(shell.clone(), springs()).unwrap();
    let depths = shell.points().iter().map(|point| point.radius - point.centre[1]);
    let touching = depths.fold(f64::NEG_INFINITY, f64::max);
    let is_moving = velocity != Vector::ZERO;
    let (mut contacts, mut last) = (0, Vector::ZERO);
    for tick in 0..TICKS {
        let time = f64::from(tick) * STEP;
        let way = velocity * time;
        for (body, place) in places.iter().enumerate().filter(|_| is_moving) {
            bodies.set_pose(body, Pose::translation(place.translation + way));
        }
        let hand = hand(time, touching, steps);
        let hand = Pose::new(hand.rotation, hand.translation + way);
        let touch = tool.step(&mut bodies, &ToolState::at_rest(hand));
        assert!(!touch.is_degraded && !touch.is_covered, "{tick}: {touch:?}");
        // Springs without friction: the lateral force is the stiffness times the way by which the
        // tool lags behind the hand.
        let [along, _, across] = touch.force.0;
        let lag = if is_moving { LAG } else { 0.0 };
        let most = 1e-6 * touch.force.norm() + STIFFNESS * lag;
        assert!(along.hypot(across) <= most, "{tick}: {touch:?}");
        assert!((touch.force - last).norm() < STIFFNESS * MOST_PRESSING, "{tick}: {touch:?}");
        last = touch.force;
        contacts += u32::from(touch.contact);
    }
    assert!(contacts > TICKS / 2, "{contacts}");
}

/// Once, a tool that came to lie a little inside took the correction for rest, and stayed where it
/// was in the last tick.
#[test]
fn flat_faces_push_along_their_normal() {
    for shell in tools() {
        for steps in [SMOOTH, COARSE] {
            for velocity in [Vector::ZERO, DRIFT] {
                for face in faces() {
                    slide(&shell, face, velocity, steps);
                }
            }
        }
    }
}
