// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A hundred bodies in a world, asked once a step as a physics engine would.

use palpate::prelude::*;
use palpate::query::{World, WorldSettings};

fn main() -> Result<(), Error> {
    let mut world = World::new(WorldSettings::of_size(0.1))?;
    let floor = world.add(Shape::half_space([0.0, 1.0, 0.0], 0.0)?, Pose::identity())?;
    let shapes = [Shape::ball(0.05)?, Shape::cuboid([0.1; 3])?, Shape::torus(0.05, 0.015)?];
    let mut bodies = Vec::new();
    for i in 0..99 {
        let place = [0.15 * f64::from(i % 10), 0.2, 0.15 * f64::from(i / 10)];
        let shape = shapes[i as usize % shapes.len()].clone();
        bodies.push((world.add(shape, Pose::translation(place))?, place));
    }
    for step in 0..60 {
        // All fall at 0.5 m/s, in steps of 1/60 s, until their origins are 49 mm above the floor:
        // balls and cubes are then 1 mm deep in it.
        let height = (0.2 - 0.5 * f64::from(step) / 60.0).max(0.049);
        let poses =
            bodies.iter().map(|(body, [x, _, z])| (*body, Pose::translation([*x, height, *z])));
        world.set_poses(&poses.collect::<Vec<_>>())?;
        let touching = world.step();
        if step % 15 == 14 {
            let on_floor = touching.iter().filter(|pair| pair.bodies[0] == floor).count();
            let contacts: usize = touching.iter().map(|pair| pair.contacts().len()).sum();
            println!("step {step}: {on_floor} bodies at the floor, {contacts} contacts");
        }
    }
    Ok(())
}
