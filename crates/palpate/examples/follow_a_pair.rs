// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Two bodies that move against each other: a track keeps what is known from step to step, and
//! contacts keep their ids.

use palpate::prelude::*;
use palpate::query::{Limits, ManifoldSettings, PairWorkspace, Track};

fn main() -> Result<(), Error> {
    let table = Shape::cuboid([0.6, 0.04, 0.6])?;
    let tube = &Shape::cylinder(0.04, 0.09)? - &Shape::cylinder(0.034, 0.2)?;
    let mut track = Track::new(table, tube);
    let (limits, settings) = (Limits::new(1e-5), ManifoldSettings::of_size(0.09));
    let mut workspace = PairWorkspace::new();
    for step in 0..6 {
        // It slides by 1 mm a step, half a millimetre deep.
        let slid = Pose::translation([0.001 * f64::from(step), 0.0645, 0.0]);
        let poses = [Pose::identity(), slid];
        let manifold = track.manifold(poses, &settings, &limits, &mut workspace)?;
        let ids: Vec<_> = manifold.contacts.iter().map(|contact| contact.id).collect();
        let evaluations = manifold.separation.evaluations;
        println!("step {step}: contacts {ids:?}, {evaluations} evaluations");
    }
    Ok(())
}
