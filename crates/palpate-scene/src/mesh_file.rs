// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes of mesh files.

use std::path::Path;

use palpate_field::Shape;
use palpate_mesh::{Findings, Solid, read_file};
use serde::Deserialize;

use crate::beside::{Beside, Kept, Stamp};
use crate::problem::Problem;

/// The solids of files, in the units of the files, up to as many triangles: a few GB.
static SOLIDS: Kept<Stamp, (Shape<3>, Findings<3>)> = Kept::new(1 << 22);

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
        if self.scale.is_nan() || self.scale <= 0.0 || self.scale.is_infinite() {
            let message = format!("scale must be positive, got {}", self.scale);
            return Err(Problem::new(message).under("scale"));
        }
        let Beside { path, stamp } = Beside::of("a mesh", &self.file, folder)
            .map_err(|problem| problem.under("file"))?;
        let of_file = |message: String| Problem::new(message).under("file");
        let (shape, findings) = match SOLIDS.of(&stamp) {
            Some(known) => known,
            None => {
                let mesh = read_file(&path).map_err(|error| of_file(error.to_string()))?;
                let (solid, findings) = Solid::from_mesh(&mesh)
                    .map_err(|error| of_file(format!("{}: {error}", path.display())))?;
                let (made, faces) = ((solid.into(), findings), mesh.elements().len());
                SOLIDS.keep(stamp.clone(), &made, faces, |known| known.is_of_same_file(&stamp));
                made
            }
        };
        let scaled = shape.scaled(self.scale);
        Ok(BuiltMesh {
            file: self.file.clone(),
            scale: self.scale,
            findings: findings.scaled(self.scale),
            shape: scaled.map_err(|error| Problem::new(error.to_string()).under("scale"))?,
        })
    }
}
