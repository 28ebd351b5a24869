// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scene files: what is there to be touched, as data.
//!
//! A [`Scene`] is read from JSON with [`Scene::from_json`], which names the path
//! and the line of whatever is wrong; it is plain data, written back with
//! [`Scene::to_json`] without loss. [`Scene::build`] makes [`World`]: bodies with
//! their [`Shape`](palpate_field::Shape)s.
//!
//! Shapes are [`Node`]s: primitives of the catalogue of `palpate-field`,
//! operators, and references to shapes that have a name. The primitives are
//! listed nowhere in this crate: reading, writing and the [`schema`] follow the
//! catalogue.
//!
//! [`Material`], [`Tool`], [`Guide`], [`Motion`] and [`View`] are data that other crates
//! give a meaning to.
//!
//! ```
//! use palpate_scene::{Scene, World};
//!
//! # fn main() -> Result<(), palpate_scene::SceneError> {
//! let scene = Scene::from_json(
//!     r#"{ "palpate": 1, "dimension": 3,
//!          "shapes": { "bead": { "difference": [
//!            { "ball": { "radius": 0.01 } },
//!            { "ball": { "radius": 0.004 } } ] } },
//!          "bodies": [ { "name": "bead", "shape": "bead",
//!                        "pose": { "translation": [0, 0.01, 0] },
//!                        "material": { "stiffness": 800 } } ] }"#,
//! )?;
//! let World::Spatial(world) = scene.build()? else { unreachable!("dimension is 3") };
//! assert_eq!(world.bodies[0].material.stiffness, 800.0);
//! assert_eq!(world.whole.distance([0.0, 0.01, 0.0]), 0.004);
//! # Ok(())
//! # }
//! ```
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod build;
mod catalogue;
mod check;
mod error;
mod guide;
mod json;
mod material;
mod motion;
mod node;
mod pose;
mod presets;
mod problem;
mod scene;
mod schema;
mod tool;
mod view;
mod written_material;

pub use build::{BuiltBody, BuiltScene, World};
pub use error::SceneError;
pub use guide::{Guide, GuideCurve, GuideLine, GuidePlane, GuideSegment, GuideWell};
pub use material::{Impact, Layer, Magnet, Material, PopThrough, Texture, TextureKind};
pub use motion::{Motion, Repeat};
pub use node::{Axis, Boolean, Factor, Form, Node, Primitive, Profile, Row, Rows};
pub use pose::{AxisAngle, WrittenPose, WrittenRotation};
pub use scene::{Body, Dimension, Scene};
pub use schema::{schema, schema_text};
pub use tool::{Coupling, Tool, Workspace};
pub use view::{FreePlane, View, ViewPlane};
pub use written_material::WrittenMaterial;
