// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a tick of the servo costs.
//!
//! Hands go round a scene at 0.1 m/s, nearly straight on, pressed 3 mm below
//! where a probe of 2 mm rests, with friction. A tick is all contact points from their states
//! to their forces. Each is timed alone, in five passes a run over the same path; what counts of
//! a tick is the fastest pass, since all do the same work. What reading the clock takes is timed
//! likewise, between ticks, and taken off.

mod orbit;
mod times;
mod tool;

use std::error::Error;
use std::hint::black_box;

use palpate::device::PointState;
use palpate::field::{Point, Pose, Shape, Vector, kernel::Ball};
use palpate::grid::{Grid, GridOptions};
use palpate::haptics::{
    Bodies, Body, Material, Probe, Servo, ServoOptions, Surface, Unprotected,
};

use crate::fields::Rows;
use crate::reference::Reference;
use crate::{rounds, scenes};
use times::Times;

/// Ticks of a path: 20 s at 1 kHz.
const TICKS: usize = 20_000;

/// Ticks before the path, in which the hands land.
const LANDING: usize = 300;

/// Times that a path is gone in a run.
const PASSES: u32 = 5;

/// The radius of the sphere and of the ball that S3 is scaled to [m].
const RADIUS: f64 = 0.05;

/// Cells of the grid of S3 along its longest side.
const CELLS: f64 = 160.0;

/// The radius of the probe [m].
const PROBE: f64 = 0.002;

/// How deep hands press [m].
const DEPTH: f64 = 0.003;

/// Work that is prepared, and measured again and again: it adds the rows of one run.
type Case<'a> = Box<dyn FnMut(&mut Rows) -> Result<(), Box<dyn Error>> + 'a>;

/// All rows of the suite: medians of so many runs.
pub(crate) fn measure(runs: u32) -> Result<Rows, Box<dyn Error>> {
    let reference = Reference::new()?;
    let sphere = Shape::from_kernel(Ball::new(RADIUS)?);
    let s3 = scenes::s3()?.shape.scaled(RADIUS)?;
    let thousand = scenes::thousand()?.shape;
    let longest = 2.0 * RADIUS;
    let grid = Grid::bake(&s3, &GridOptions::with_cell(longest / CELLS))?.into();
    let mut cases = vec![
        ticks("tick.sphere", &sphere, 1, rest),
        ticks("tick.S3", &s3, 1, rest),
        ticks("tick.moving_S3", &s3, 1, to_and_fro),
        ticks("tick.grid_S3", &grid, 1, rest),
        ticks("tick.union_1000", &thousand, 1, rest),
        ticks("tick.ten_fingers_S3", &s3, 10, rest),
        ticks("tick.24_points_union_1000", &thousand, 24, rest),
        tool::ticks("tick.tool_1000_points_S3", &s3, rest)?,
        tool::ticks("tick.tool_moving", &s3, to_and_fro)?,
    ];
    let mut all = Vec::new();
    for run in 1..=runs {
        eprintln!("measuring run {run} of {runs} …");
        for case in &mut cases {
            all.push(reference.beside(&mut *case)?);
        }
    }
    let mut rows = rounds::medians(all);
    for (key, other, over) in [
        ("tick.grid_S3", "tick.S3", "tick_S3"),
        ("tick.moving_S3", "tick.S3", "tick_S3"),
        ("tick.tool_moving", "tick.tool_1000_points_S3", "tool_at_rest"),
    ] {
        let [of, beside] = [key, other].map(|key| format!("{key}.p50_ns"));
        if let Some((of, beside)) = rows.get(&of).zip(rows.get(&beside)) {
            let ratio = of / beside;
            rows.insert(format!("{key}.p50.over_{over}"), ratio);
        }
    }
    Ok(rows)
}

/// Where the body is in a tick [m].
type Motion = fn(usize) -> Vector<f64, 3>;

/// A body that does not move.
fn rest(_: usize) -> Vector<f64, 3> {
    Vector::ZERO
}

/// A body that goes to and fro by 10 mm, once a second; hands go with it.
fn to_and_fro(tick: usize) -> Vector<f64, 3> {
    let angle = 2.0 * std::f64::consts::PI * 1e-3 * tick as f64;
    Vector([0.01 * angle.sin(), 0.005 * angle.cos() - 0.005, 0.0])
}

/// What a tick costs with so many contact points.
fn ticks<'a>(key: &'a str, shape: &'a Shape<3>, points: usize, motion: Motion) -> Case<'a> {
    let paths: Vec<Vec<Point<3>>> =
        (0..points).map(|hand| orbit::around(shape, hand)).collect();
    let states: Vec<Vec<PointState>> = (0..LANDING + TICKS)
        .map(|tick| paths.iter().map(|path| carried(state(path, tick), motion, tick)).collect())
        .collect();
    // A body at rest is not told where it is.
    let moves = motion(1) != motion(0);
    Box::new(move |rows| {
        let mut times = Times::new();
        let (mut evaluations, mut contacts, mut most) = (0_u64, 0_u64, 0);
        // Where a device that was just read leaves its states.
        let mut read = vec![PointState::at_rest(Vector::ZERO); points];
        for pass in 0..PASSES {
            let mut servo = servo(shape, points)?;
            for (number, states) in states.iter().enumerate() {
                read.copy_from_slice(states);
                let tick = number.checked_sub(LANDING);
                let way = motion(number);
                let touches = times.time(tick, || {
                    if moves {
                        servo.set_pose(0, Pose::translation(way));
                    }
                    black_box(servo.step(black_box(&read)))
                });
                if pass == 0 && tick.is_some() {
                    for touch in touches {
                        evaluations += u64::from(touch.evaluations);
                        contacts += u64::from(touch.contact);
                        most = most.max(touch.evaluations);
                    }
                }
            }
        }
        let visits = (TICKS * points) as f64;
        times.insert(key, rows);
        rows.insert(format!("{key}.evaluations"), evaluations as f64 / visits);
        rows.insert(format!("{key}.most_evaluations"), f64::from(most));
        rows.insert(format!("{key}.contact"), contacts as f64 / visits);
        Ok(())
    })
}

/// Where a hand is in a tick, and how fast.
fn state(path: &[Point<3>], tick: usize) -> PointState {
    let velocity = (path[tick] - path[tick.saturating_sub(1)]) * 1000.0;
    PointState { position: path[tick], velocity }
}

/// A state of a hand that goes with the body.
fn carried(state: PointState, motion: Motion, tick: usize) -> PointState {
    let (way, before) = (motion(tick), motion(tick.saturating_sub(1)));
    let velocity = state.velocity + (way - before) * 1000.0;
    PointState { position: state.position + way, velocity }
}

/// A servo of one body with friction.
fn servo(shape: &Shape<3>, points: usize) -> Result<Servo<Unprotected>, Box<dyn Error>> {
    let material = Material {
        stiffness: 1000.0,
        static_friction: 0.5,
        dynamic_friction: 0.3,
        ..Material::default()
    };
    let body = Body::new(shape.clone(), Surface::new(&material)?)?;
    let probe = Probe::new(PROBE)?;
    let options = ServoOptions { probe, max_force: f64::INFINITY, ..ServoOptions::default() };
    Ok(Servo::new(Bodies::new(vec![body])?, points, options)?)
}
