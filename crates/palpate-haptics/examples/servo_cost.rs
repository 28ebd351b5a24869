// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a tick of the servo costs: `cargo run --release --example servo_cost`.
//!
//! A hand tours each shape for a minute of the servo's time, as fast as possible.

use std::error::Error;

use palpate_device::Device;
use palpate_field::kernel::{Ball, Cuboid, Cylinder, Torus};
use palpate_field::{Shape, Vector};
use palpate_haptics::servo_loop::{Pace, RunOptions, run};
use palpate_haptics::{Probe, Protection, Servo, ServoOptions};
use palpate_sim::{RecordedDevice, Tour};

const DURATION: f64 = 60.0;

fn main() -> Result<(), Box<dyn Error>> {
    println!("shape    points  contact  evaluations mean, max  cost p50  p99  p99.9 [ns]");
    for radius in [0.002, 0.0] {
        println!("probe of {radius} m");
        measure("ball", &Shape::from_kernel(Ball::new(0.05)?), radius, 1)?;
        measure("box", &Shape::from_kernel(Cuboid::new(Vector([0.1; 3]))?), radius, 1)?;
        measure("cup", &cup()?, radius, 1)?;
        measure("gallery", &gallery()?, radius, 1)?;
        measure("gallery", &gallery()?, radius, 10)?;
    }
    Ok(())
}

fn measure(
    name: &str,
    shape: &Shape<3>,
    radius: f64,
    points: usize,
) -> Result<(), Box<dyn Error>> {
    let bounds = shape.promise().bounds.ok_or("the shape has no bounds")?;
    let path = Tour::new(bounds.aabb, DURATION)?.with_probe_radius(radius)?.over(shape)?;
    let mut device = RecordedDevice::new(vec![path; points])?;
    let options = ServoOptions { probe: Probe::new(radius)?, ..ServoOptions::default() };
    let mut servo = Servo::new(shape.clone(), points, options)?
        .protected(&Protection::new(device.profile().clone()))?;
    let pace = Pace::AsFastAsPossible;
    let report =
        run(&mut servo, &mut device, RunOptions { pace, ..RunOptions::new(DURATION) })?;
    let cost = report.cost.ok_or("there was no tick")?;
    println!(
        "{name:<8} {points:>6} {:>7.0}% {:>16.2} {:>4} {:>10.0} {:>4.0} {:>6.0}",
        100.0 * report.contact_time / report.duration,
        report.evaluations.mean,
        report.evaluations.max,
        1e9 * cost.p50,
        1e9 * cost.p99,
        1e9 * cost.p999,
    );
    Ok(())
}

fn cup() -> Result<Shape<3>, Box<dyn Error>> {
    let wall = Shape::from_kernel(Cylinder::new(0.04, 0.09)?);
    let inside = Shape::from_kernel(Cylinder::new(0.034, 0.09)?);
    Ok(wall.difference([inside.translated(Vector([0.0, 0.01, 0.0]))?])?)
}

/// A union of eight bodies, of eleven primitives with a difference and an intersection.
fn gallery() -> Result<Shape<3>, Box<dyn Error>> {
    let cube = || Cuboid::new(Vector([0.08; 3])).map(Shape::from_kernel);
    let ball = |radius| Ball::new(radius).map(Shape::from_kernel);
    let bodies = [
        ball(0.05)?,
        cube()?,
        Shape::from_kernel(Torus::new(0.035, 0.015)?),
        Shape::from_kernel(Cylinder::new(0.03, 0.1)?),
        cup()?,
        cube()?.difference([ball(0.05)?])?,
        Shape::intersection([cube()?, ball(0.05)?])?,
        ball(0.03)?,
    ];
    let mut placed = Vec::new();
    for (i, body) in (0_u8..).zip(bodies) {
        let (column, row) = (f64::from(i % 4), f64::from(i / 4));
        placed.push(body.translated(Vector([0.13 * column, 0.0, 0.13 * row]))?);
    }
    Ok(Shape::union(placed)?)
}
