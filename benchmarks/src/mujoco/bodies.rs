// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! MuJoCo's plugins of signed distance fields, and the same bodies as our shapes.

use std::error::Error;
use std::f64::consts::FRAC_PI_2;

use palpate::field::kernel::{CutHollowSphere, Torus};
use palpate::field::{Rotation, Shape, Vector};

use super::exchange::Plugin;
use super::fastener;
use super::gear::Gear;

/// How far the edges of our gear are from the plugin's outline [m]: half a hundredth of the
/// smallest depth, which is known to a hundredth. More edges take longer.
const OUTLINE: f64 = 5e-7;

/// The radius of the roots of bolt and nut, as in MuJoCo's example [m].
const THREAD: f64 = 0.26;

/// A body for both.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// As keys name it.
    pub(super) name: &'static str,
    pub(super) plugin: Plugin,
    pub(super) shape: Shape<3>,
}

/// The pairs by their names, as places in the list of bodies.
pub(super) const PAIRS: [(&str, [usize; 2]); 7] = [
    ("torus_torus", [0, 0]),
    ("torus_bowl", [0, 1]),
    ("torus_gear", [0, 2]),
    ("gear_gear", [2, 2]),
    ("large_torus_torus", [3, 3]),
    ("large_torus_bolt", [3, 4]),
    ("bolt_nut", [4, 5]),
];

/// The bodies of the suite.
pub(super) fn all() -> Result<[Body; 6], Box<dyn Error>> {
    Ok([
        torus("torus", 0.035, 0.015)?,
        bowl(0.05, -0.01, 0.012)?,
        gear_of(Gear { diameter: 0.1, folds: 4 }, 0.02)?,
        torus("large_torus", 0.35, 0.15)?,
        threaded("bolt", "mujoco.sdf.bolt", fastener::bolt(THREAD)?)?,
        threaded("nut", "mujoco.sdf.nut", fastener::nut(THREAD)?)?,
    ])
}

/// `mujoco.sdf.torus`, about the z axis.
fn torus(name: &'static str, major: f64, minor: f64) -> Result<Body, Box<dyn Error>> {
    let attributes = vec![("radius1", major), ("radius2", minor)];
    Ok(Body {
        name,
        plugin: Plugin { plugin: "mujoco.sdf.torus", attributes },
        shape: upright(Shape::from_kernel(Torus::new(major, minor)?))?,
    })
}

/// `mujoco.sdf.bowl`, about the z axis, whose attribute is half the thickness.
fn bowl(radius: f64, height: f64, thickness: f64) -> Result<Body, Box<dyn Error>> {
    let attributes =
        vec![("height", height), ("radius", radius), ("thickness", 0.5 * thickness)];
    Ok(Body {
        name: "bowl",
        plugin: Plugin { plugin: "mujoco.sdf.bowl", attributes },
        shape: upright(Shape::from_kernel(CutHollowSphere::new(radius, height, thickness)?))?,
    })
}

/// `mujoco.sdf.gear`, along the z axis.
fn gear_of(gear: Gear, thickness: f64) -> Result<Body, Box<dyn Error>> {
    let attributes = vec![
        ("alpha", 0.0),
        ("diameter", gear.diameter),
        ("teeth", gear.teeth()),
        ("thickness", thickness),
        ("innerdiameter", 2.0 * gear.bore()),
    ];
    Ok(Body {
        name: "gear",
        plugin: Plugin { plugin: "mujoco.sdf.gear", attributes },
        shape: upright(gear.profile(OUTLINE)?.extruded(thickness)?)?,
    })
}

/// A plugin with a thread of radius [`THREAD`], along the z axis.
fn threaded(
    name: &'static str,
    plugin: &'static str,
    shape: Shape<3>,
) -> Result<Body, Box<dyn Error>> {
    let attributes = vec![("radius", THREAD)];
    Ok(Body { name, plugin: Plugin { plugin, attributes }, shape: upright(shape)? })
}

/// A shape about the y axis, about the z axis.
fn upright(shape: Shape<3>) -> Result<Shape<3>, Box<dyn Error>> {
    Ok(shape.rotated(Rotation::from_axis_angle(Vector([1.0, 0.0, 0.0]), FRAC_PI_2)?)?)
}
