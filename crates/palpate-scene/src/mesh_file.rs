// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes of mesh files.

use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use palpate_field::Shape;
use palpate_mesh::{Findings, Solid, read_file};
use serde::Deserialize;

use crate::problem::Problem;

/// How many solids are kept, so that an edit of a scene does not read its files anew.
const KEPT: usize = 16;

/// Those that were used last, the last one last.
static SOLIDS: Mutex<Vec<(Stamp, BuiltMesh)>> = Mutex::new(Vec::new());

/// The solid of a mesh file, as a scene uses it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct BuiltMesh {
    /// The file, as the scene names it.
    pub file: String,
    /// Metres for a unit of the file.
    pub scale: f64,
    /// What was found in it, and mended.
    pub findings: Findings<3>,
    /// The solid.
    pub shape: Shape<3>,
}

impl BuiltMesh {
    /// Whether it is the same file at the same scale.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.file == other.file && self.scale.to_bits() == other.scale.to_bits()
    }
}

/// What tells whether a file is as it was, and what is made of it.
#[derive(Clone, Debug, PartialEq)]
struct Stamp {
    path: PathBuf,
    modified: Option<SystemTime>,
    bytes: u64,
    scale: f64,
}

/// A mesh as a file gives it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub(crate) struct WrittenMesh {
    file: String,
    #[serde(default = "one")]
    scale: f64,
}

fn one() -> f64 {
    1.0
}

impl WrittenMesh {
    /// The solid of the file, which is looked for in `folder`.
    pub(crate) fn built(&self, folder: Option<&Path>) -> Result<BuiltMesh, Problem> {
        let of_file = |message: String| Problem::new(message).under("file");
        let Some(folder) = folder else {
            let message = "a mesh is a file beside the scene's: this scene is in no file";
            return Err(of_file(message.to_owned()));
        };
        if self.scale.is_nan() || self.scale <= 0.0 || self.scale.is_infinite() {
            let message = format!("scale must be positive, got {}", self.scale);
            return Err(Problem::new(message).under("scale"));
        }
        let file = Path::new(&self.file);
        let is_below = file.components().all(|part| matches!(part, Component::Normal(_)));
        if self.file.is_empty() || !is_below {
            return Err(of_file(format!(
                "a mesh is a file in the scene's folder or below it, got {:?}",
                self.file
            )));
        }
        let path = folder.join(file);
        let cannot =
            |why: &dyn std::fmt::Display| of_file(format!("{}: {why}", path.display()));
        let metadata = std::fs::metadata(&path).map_err(|error| cannot(&error))?;
        let stamp = Stamp {
            path: path.canonicalize().unwrap_or_else(|_| path.clone()),
            modified: metadata.modified().ok(),
            bytes: metadata.len(),
            scale: self.scale,
        };
        if let Some(known) = kept(&stamp) {
            return Ok(BuiltMesh { file: self.file.clone(), ..known });
        }
        let mesh = read_file(&path).map_err(|error| of_file(error.to_string()))?;
        let mesh = mesh.scaled(self.scale).map_err(|error| cannot(&error))?;
        let (solid, findings) = Solid::from_mesh(&mesh).map_err(|error| cannot(&error))?;
        let built = BuiltMesh {
            file: self.file.clone(),
            scale: self.scale,
            findings,
            shape: solid.into(),
        };
        keep(stamp, &built);
        Ok(built)
    }
}

fn kept(stamp: &Stamp) -> Option<BuiltMesh> {
    let mut solids = SOLIDS.lock().unwrap_or_else(PoisonError::into_inner);
    let found = solids.iter().position(|(known, _)| known == stamp)?;
    let used = solids.remove(found);
    let built = used.1.clone();
    solids.push(used);
    Some(built)
}

fn keep(stamp: Stamp, built: &BuiltMesh) {
    let mut solids = SOLIDS.lock().unwrap_or_else(PoisonError::into_inner);
    if solids.len() >= KEPT {
        solids.remove(0);
    }
    solids.push((stamp, built.clone()));
}
