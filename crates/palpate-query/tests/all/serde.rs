// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Answers written as JSON and read back, to the bit.
#![cfg(feature = "serde")]

use palpate_field::kernel::{Ball, Cuboid};
use palpate_field::{Shape, Vector};
use palpate_query::{Certified, Contact, Manifold, Nearest, Query};

#[test]
fn answers_survive_json_to_the_bit() -> Result<(), Box<dyn std::error::Error>> {
    let plate = Shape::from_kernel(Cuboid::new(Vector([0.2, 0.02, 0.2]))?);
    let ball = Shape::from_kernel(Ball::new(0.05)?).translated(Vector([0.01, 0.0595, 0.0]))?;
    let mut query = Query::new();
    let nearest = query.separation(&plate, &ball)?;
    let again: Certified<Nearest<3>> = serde_json::from_str(&serde_json::to_string(&nearest)?)?;
    assert_eq!(again, nearest);
    let closest = query.closest_points(&plate, &ball)?;
    let again: Certified<Option<Contact<3>>> =
        serde_json::from_str(&serde_json::to_string(&closest)?)?;
    assert_eq!(again, closest);
    let touching = query.manifold(&plate, &ball)?;
    let again: Manifold<3> = serde_json::from_str(&serde_json::to_string(&touching)?)?;
    assert_eq!(again, touching);
    Ok(())
}
