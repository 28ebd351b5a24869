// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Tools with a shape, and how tests move them.

use palpate_field::{Pose, Rotation, Shape, Vector};
use palpate_haptics::{
    Bodies, Material, Shell, Surface, Tool, ToolOptions, ToolState, ToolTouch,
};
use palpate_mesh::{Mesh, TriangleMesh};

use super::body;

/// The coupling's stiffness [N/m].
pub(crate) const STIFFNESS: f64 = 500.0;

/// Springs alone, without limits.
pub(crate) fn springs() -> ToolOptions {
    ToolOptions {
        stiffness: STIFFNESS,
        damping: 0.0,
        max_force: Some(f64::INFINITY),
        max_torque: f64::INFINITY,
        ..ToolOptions::default()
    }
}

/// A box of full edge lengths as a mesh.
pub(crate) fn box_mesh(edges: [f64; 3]) -> TriangleMesh {
    let corner = |i: usize| {
        Vector(std::array::from_fn(|k| edges[k] * if i >> k & 1 == 1 { 0.5 } else { -0.5 }))
    };
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles =
        quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh::new((0..8).map(corner).collect(), triangles).unwrap()
}

pub(crate) fn at(place: [f64; 3]) -> ToolState {
    ToolState::at_rest(Pose::translation(Vector(place)))
}

pub(crate) fn turned(axis: [f64; 3], angle: f64, place: [f64; 3]) -> ToolState {
    let rotation = Rotation::from_axis_angle(Vector(axis), angle).unwrap();
    ToolState::at_rest(Pose::new(rotation, Vector(place)))
}

/// Stays at a state until the tool rests.
pub(crate) fn rest(tool: &mut Tool, bodies: &mut Bodies, state: &ToolState) -> ToolTouch {
    for _ in 0..200 {
        tool.step(bodies, state);
    }
    tool.touch().clone()
}

/// A spring alone.
pub(crate) fn smooth() -> Material {
    Material {
        static_friction: 0.0,
        dynamic_friction: 0.0,
        damping: 0.0,
        ..Material::default()
    }
}

/// Where a tool is at a part of a closed path over the top of a ball of 50 mm.
pub(crate) fn on_a_loop(part: f64) -> (Vector<f64, 3>, ToolState) {
    let t = std::f64::consts::TAU * part;
    let place = Vector([0.012 * t.sin(), 0.055 + 0.004 * t.cos(), 0.01 * (2.0 * t).sin()]);
    (place, turned([0.0, 0.0, 1.0], 0.0, place.0))
}

/// A flat box on rough ground.
pub(crate) fn rough(shape: &Shape<3>) -> (Bodies, Tool) {
    let material = Material {
        static_friction: 0.5,
        dynamic_friction: 0.25,
        damping: 0.0,
        ..Material::default()
    };
    let bodies = body(shape, Surface::new(&material).unwrap());
    let shell = Shell::from_mesh(&box_mesh([0.06, 0.04, 0.05]), 600, 0.0).unwrap();
    (
        bodies,
        Tool::new(shell, ToolOptions { angular_stiffness: Some(5.0), ..springs() }).unwrap(),
    )
}
