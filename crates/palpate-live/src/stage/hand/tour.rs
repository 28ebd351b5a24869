// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The tour of a scene.

use palpate::field::SpaceShape;
use palpate::haptics::Probe;
use palpate::scene::BuiltScene;
use palpate::sim::{HandPath, SimulationError, Tour};

/// How long each contact point takes for a tour of a scene [s].
const TOUR: f64 = 20.0;

/// How far each contact point follows behind the one before on a tour [s].
pub(super) const LAG: f64 = 0.5;

/// The tour of a scene, for a hand of `count` contact points; `None` if the scene has no bounds.
/// It takes a part of a second, of a steep scene minutes.
pub(in crate::stage) fn tour<const D: usize>(
    scene: &BuiltScene<D>,
    count: usize,
) -> Option<Result<HandPath, SimulationError>> {
    let bounds = scene.bounds()?;
    let shapes: Vec<_> =
        scene.bodies.iter().map(|body| SpaceShape::from(&body.shape)).collect();
    let duration = TOUR + LAG * count as f64;
    let ball = scene.tool.as_ref().map_or(Probe::default().radius(), |tool| tool.radius);
    let tour = Tour::new(bounds, duration).and_then(|tour| tour.with_probe_radius(ball));
    Some(tour.and_then(|tour| tour.over_each(SpaceShape::from(&scene.whole).shape(), &shapes)))
}

/// The radius of what touches a scene [m]: of the balls at its contact points, or of a ball around the
/// origin of the tool that holds its shape.
pub(super) fn radius<const D: usize>(scene: &BuiltScene<D>) -> f64 {
    let Some(tool) = &scene.tool else { return Probe::default().radius() };
    let bounds = tool.shape.as_ref().and_then(|shape| shape.promise().bounds);
    let farthest = |aabb: palpate::field::Aabb<D>| {
        let corner = |axis: usize| aabb.min[axis].abs().max(aabb.max[axis].abs());
        (0..D).map(corner).fold(0.0, f64::hypot)
    };
    tool.radius + bounds.map_or(0.0, |bounds| farthest(bounds.aabb))
}
