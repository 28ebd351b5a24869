// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rods in the wedge of two faces, of one body or of two, that rests, moves or closes.

use crate::common::half_space;
use crate::common::tools::{STIFFNESS, smooth, springs};
use palpate_field::{Point, Pose, Rotation, Shape, Vector};
use palpate_haptics::{Bodies, Body, Shell, Surface, Tool, ToolState};

const PERIOD: f64 = 1e-3;
const SECONDS: f64 = 4.0;
const RADIUS: f64 = 0.004;

/// A rod along z.
fn rod() -> Tool {
    let ends = [-0.02, 0.02].map(|z| Vector([0.0, 0.0, z]));
    Tool::new(Shell::capsule(ends, RADIUS, 27).unwrap(), springs()).unwrap()
}

fn body(shape: Shape<3>) -> Body {
    Body::new(shape, Surface::new(&smooth()).unwrap()).unwrap()
}

/// The half-space on one side of a wedge whose faces lean by `angle` [rad] from the vertical.
fn side(sign: f64, angle: f64) -> Shape<3> {
    half_space([sign * angle.cos(), angle.sin(), 0.0], 0.0)
}

/// Where the axis of a rod lies at the bottom of a wedge.
fn bottom(angle: f64) -> Point<3> {
    Vector([0.0, RADIUS / angle.sin(), 0.0])
}

/// The hand from the bottom of a wedge: pressed down by at most 3 mm, and aside by as much as the faces
/// bear.
fn pressed(time: f64, angle: f64) -> Vector<f64, 3> {
    let press = 0.001 - 0.002 * (3.0 * time).cos();
    let aside = (0.3 / angle.tan()).min(1.0) * (7.0 * time).sin();
    Vector([aside * press, -press, 0.0])
}

/// Runs a rod among `bodies`, which `place` moves, under a hand at `pressed` from `bottom`. Returns the
/// largest difference of the force from the stiffness times the way to the bottom [N].
fn worst(
    mut bodies: Bodies,
    place: impl Fn(&mut Bodies, f64),
    bottom: impl Fn(f64) -> Point<3>,
    pressed: impl Fn(f64) -> Vector<f64, 3>,
) -> f64 {
    let (mut tool, mut worst) = (rod(), 0.0_f64);
    for tick in 0..(SECONDS / PERIOD) as u32 {
        let time = f64::from(tick) * PERIOD;
        place(&mut bodies, time);
        let pressed = pressed(time);
        let hand = Pose::translation(bottom(time) + pressed);
        let touch = tool.step(&mut bodies, &ToolState::at_rest(hand));
        if pressed[1] < 0.0 {
            worst = worst.max((touch.force + pressed * STIFFNESS).norm());
        }
    }
    worst
}

/// Once, a ball of the rod saw one of the two faces at a time: below 30 degrees the rod gave no force
/// for most of the time.
#[test]
fn a_rod_lies_at_the_bottom_of_a_wedge() {
    for angle in [70.0, 45.0, 30.0, 20.0, 10.0_f64].map(f64::to_radians) {
        let sides = [1.0, -1.0].map(|sign| side(sign, angle));
        let one = vec![body(Shape::union(sides.clone()).unwrap())];
        for bodies in [one, sides.map(body).to_vec()] {
            for velocity in [Vector::ZERO, Vector([0.02, 0.03, 0.01])] {
                let place = |bodies: &mut Bodies, time: f64| {
                    for index in 0..bodies.bodies().len() {
                        if velocity != Vector::ZERO {
                            bodies.set_pose(index, Pose::translation(velocity * time));
                        }
                    }
                };
                let count = bodies.len();
                let worst = worst(
                    Bodies::new(bodies.clone()).unwrap(),
                    place,
                    |time| bottom(angle) + velocity * time,
                    |time| pressed(time, angle),
                );
                assert!(worst < 1e-3, "{angle} rad, {count} bodies, {velocity:?}: {worst} N");
            }
        }
    }
}

#[test]
fn a_wedge_that_closes_lifts_a_rod() {
    let at = |time: f64| (60.0 - 10.0 * time).to_radians();
    let turned = |sign: f64, time: f64| {
        let turn = sign * (at(0.0) - at(time));
        Pose::rotation(Rotation::from_axis_angle(Vector([0.0, 0.0, 1.0]), turn).unwrap())
    };
    let bodies = [1.0, -1.0].map(|sign| body(side(sign, at(0.0))));
    let place = |bodies: &mut Bodies, time: f64| {
        bodies.set_pose(0, turned(-1.0, time));
        bodies.set_pose(1, turned(1.0, time));
    };
    let bodies = Bodies::new(bodies.to_vec()).unwrap();
    let worst = worst(bodies, place, |time| bottom(at(time)), |time| pressed(time, at(time)));
    assert!(worst < 1e-3, "{worst} N");
}
