// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What most programs need: `use palpate::prelude::*`.

pub use palpate_device::Device;
pub use palpate_field::{Pose, Rotation, Shape, Vector};
#[cfg(feature = "std-loop")]
pub use palpate_haptics::servo_loop::{Run, Seconds};
pub use palpate_haptics::{Body, Material, Servo};
pub use palpate_mesh::TriangleMesh as Mesh;
pub use palpate_query::Query;
#[cfg(feature = "scene")]
pub use palpate_scene::Scene;

pub use crate::Error;
