// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes made in code, written as a scene file, and read back to the same bits.

use palpate::prelude::*;
use palpate::scene::{AnyScene, Dimension, SceneBody};

fn main() -> Result<(), Error> {
    let hole = Shape::cylinder(0.006, 0.1)?;
    let mut plate = Shape::cuboid([0.2, 0.02, 0.1])?;
    for i in 0..5 {
        plate = plate - hole.clone().translated([0.03 * f64::from(i) - 0.06, 0.0, 0.0])?;
    }
    let peg = Shape::capsule(0.0058, 0.08)?;
    let scene = Scene::new(Dimension::Three).with_bodies([
        SceneBody::new("plate", plate.clone()).made_of(Material::steel()),
        SceneBody::new("peg", peg).at(Pose::translation([0.03, 0.05, 0.0])),
    ])?;
    let text = scene.to_json();
    println!("{text}");

    let AnyScene::Spatial(read) = Scene::from_json(&text)?.build()? else { unreachable!() };
    assert_eq!(read.bodies[0].shape_in_body, plate);
    println!("read back: {}", read.bodies[0].shape_in_body);
    println!("pairs that touch: {}", read.world()?.step().len());
    Ok(())
}
