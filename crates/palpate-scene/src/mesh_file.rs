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

/// How many triangles are kept in solids, so that an edit of a scene does not read its files anew: a few GB.
const KEPT: usize = 1 << 22;

/// Those that were used last, the last one last, in units of their files.
static SOLIDS: Mutex<Vec<(Stamp, Kept)>> = Mutex::new(Vec::new());

/// The solid of a file, in its units.
#[derive(Clone)]
struct Kept {
    shape: Shape<3>,
    findings: Findings<3>,
}

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
        let real = path.canonicalize().map_err(|error| cannot(&error))?;
        let folder = folder.canonicalize().map_err(|error| cannot(&error))?;
        if !real.starts_with(&folder) {
            return Err(cannot(&"it is a link out of the scene's folder"));
        }
        let metadata = std::fs::metadata(&real).map_err(|error| cannot(&error))?;
        let (modified, bytes) = (metadata.modified().ok(), metadata.len());
        let stamp = Stamp { path: real, modified, bytes };
        let solid = match kept(&stamp) {
            Some(known) => known,
            None => {
                let mesh = read_file(&path).map_err(|error| of_file(error.to_string()))?;
                let (solid, findings) =
                    Solid::from_mesh(&mesh).map_err(|error| cannot(&error))?;
                let solid = Kept { shape: solid.into(), findings };
                keep(stamp, &solid);
                solid
            }
        };
        let scaled = solid.shape.scaled(self.scale);
        Ok(BuiltMesh {
            file: self.file.clone(),
            scale: self.scale,
            findings: solid.findings.scaled(self.scale),
            shape: scaled.map_err(|error| Problem::new(error.to_string()).under("scale"))?,
        })
    }
}

fn kept(stamp: &Stamp) -> Option<Kept> {
    let mut solids = SOLIDS.lock().unwrap_or_else(PoisonError::into_inner);
    let found = solids.iter().position(|(known, _)| known == stamp)?;
    let used = solids.remove(found);
    let solid = used.1.clone();
    solids.push(used);
    Some(solid)
}

fn keep(stamp: Stamp, solid: &Kept) {
    let mut solids = SOLIDS.lock().unwrap_or_else(PoisonError::into_inner);
    // An older state of the file is of no use.
    solids.retain(|(known, _)| known.path != stamp.path);
    solids.push((stamp, solid.clone()));
    let mut triangles: usize = solids.iter().map(|(_, solid)| solid.findings.faces).sum();
    while triangles > KEPT && solids.len() > 1 {
        triangles -= solids.remove(0).1.findings.faces;
    }
}
