// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Tests of meshes.

#![expect(clippy::unwrap_used, reason = "tests")]

mod contours;
mod files;
mod gltf;
mod hard;
mod joins;
mod long_faces;
mod planes;
mod samples;
mod solids;
mod text;
#[cfg(feature = "files")]
mod writing;
