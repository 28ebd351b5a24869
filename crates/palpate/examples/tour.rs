// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Distances, booleans, closest points, contacts, a mesh against a field.

use palpate::prelude::*;

fn main() -> Result<(), Error> {
    let plate = Shape::cuboid([0.2, 0.02, 0.2])?;
    let ball = Shape::ball(0.05)?.translated([0.0, 0.0595, 0.0])?;
    let drilled = &plate - &Shape::cylinder(0.02, 0.1)?;
    println!("{drilled} promises {}", drilled.promise());
    println!("above the plate: {} m", plate.distance([0.0, 0.13, 0.0]));
    println!("above both: {} m", (&plate | &ball).distance([0.0, 0.13, 0.0]));

    let mut query = Query::new();
    let nearest = query.closest_points(&plate, &ball)?;
    println!("separation: between {} and {} m", nearest.lower, nearest.upper);
    for contact in query.manifold(&plate, &ball)?.contacts {
        println!("they touch: {contact}");
    }

    let nut =
        Mesh::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/meshes/nut.ply"))?;
    let nut = nut.scaled(0.001)?; // from millimetres
    let table = plate.translated([0.081, -0.105, -0.081])?; // where its maker put the nut
    let touching = query.mesh_contacts(&table, &nut)?;
    println!(
        "the nut's {} faces have {} contacts",
        nut.elements().len(),
        touching.contacts.len()
    );
    Ok(())
}
