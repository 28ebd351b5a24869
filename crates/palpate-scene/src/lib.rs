// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scene files: bodies to be touched, with their tool and guides, as data.
//!
//! A [`Scene`] is read from JSON with [`Scene::from_json`], which names the path
//! and the line of whatever is wrong; it is plain data, written back with
//! [`Scene::to_json`] without loss. [`Scene::build`] makes [`AnyScene`]: bodies with
//! their [`Shape`](palpate_field::Shape)s.
//!
//! A [`WrittenShape`] is a primitive of the catalogue of `palpate-field`, an operator, or a
//! reference to a named shape. Reading, writing and the [`schema`] follow the catalogue; this
//! crate has no list of primitives. Shapes made in code become a scene with
//! [`Scene::with_bodies`] and read back to the same bits.
//!
//! Materials are those of `palpate-haptics`; a scene makes its bodies, world and servo with
//! [`BuiltScene::bodies`], [`BuiltScene::world`] and [`BuiltScene::servo`], and is where its
//! [`Motion`]s have taken it with [`BuiltScene::at`]. [`View`]s are for programs that draw.
//!
//! ```
//! use palpate_scene::{Scene, AnyScene};
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
//! let AnyScene::Spatial(world) = scene.build()? else { unreachable!("dimension is 3") };
//! assert_eq!(world.bodies[0].material.stiffness, 800.0);
//! assert_eq!(world.whole.distance([0.0, 0.01, 0.0]), 0.004);
//! # Ok(())
//! # }
//! ```
#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare exact numbers"))]

mod advice;
mod angle;
mod ask;
mod attitude;
mod build;
mod catalogue;
mod device_file;
mod emptiness;
mod encoding;
mod file;
mod grids;
mod guide;
mod hidden;
mod instances;
mod json;
mod keys;
mod material;
mod mesh_file;
mod motion;
mod names;
mod pose;
mod problem;
mod scene;
mod schema;
mod shape;
pub mod text;
mod tool;
mod touch;
mod view;
mod write;

pub use ask::{
    ANSWER_VERSION, Answer, AskError, BallAnswer, Balls, BodyMass, ContactsAnswer,
    ContactsQuestion, FEW_PAIRS, LocalFinding, MassAnswer, MassQuestion, PairContacts,
    PenetrationBounds, PointAnswer, PointQuestion, Question, Separation, SweepAnswer,
    SweepPair, SweepQuestion, SweptPart, Versioned, Weighed,
};
pub use build::{
    AnyScene, BuiltBody, BuiltMotion, BuiltScene, BuiltTool, MotionJump, MotionSpeed,
};
pub use catalogue::described_primitive;
pub use device_file::{device_from_file, device_from_json, device_to_json};
pub use emptiness::is_empty;
pub use encoding::{NotUtf8, utf8};
pub use file::{LARGEST_FILE, read_file, too_large};
pub use grids::{BakedBody, BakedGrid, MeshesBaked};
pub use guide::{GuideCurve, GuideLine, GuidePlane, GuideSegment, GuideWell, WrittenGuide};
pub use hidden::Hidden;
#[doc(hidden)]
pub use instances::instances;
pub use material::WrittenMaterial;
pub use mesh_file::{BakeProgress, BuiltMesh, Resources, Samples};
pub use motion::{Repeat, WrittenMotion};
pub use names::{near as near_names, shortened, unknown as unknown_name};
pub use pose::{AxisAngle, WrittenPose, WrittenRotation};
pub use problem::{SceneCause, SceneError, SceneProblem};
pub use scene::{Dimension, Scene, WrittenBody};
pub use schema::{schema, schema_text};
pub use shape::WrittenShape;
pub use tool::{WrittenCoupling, WrittenTool, WrittenWorkspace};
pub use touch::ServoSettings;
pub use view::{FreePlane, ViewPlane, WrittenView};
pub use write::SceneBody;
