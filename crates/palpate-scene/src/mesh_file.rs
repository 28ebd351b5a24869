// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes of mesh files, and of surfaces in volumes.

use std::path::Path;

use palpate_field::Shape;
use palpate_grid::{Inside, Volume};
use palpate_mesh::{Findings, Solid, TriangleMesh, read_file};
use serde::Deserialize;

use crate::beside::{Beside, Kept, Stamp};
use crate::grids::named;
use crate::problem::Problem;

/// The solids of files, in the units of the files, up to as many triangles: a few GB.
static SOLIDS: Kept<Key, (Shape<3>, Findings<3>)> = Kept::new(1 << 22);

/// A file, and in a volume the value of the surface, by its bits, and the side asked for.
type Key = (Stamp, Option<u64>, Option<Inside>);

/// The solid of a mesh file or of a surface in a volume, as a scene uses it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct BuiltMesh {
    /// The file, as the scene names it.
    pub file: String,
    /// Metres for a unit of the file; of a volume, whose head tells lengths, a factor.
    pub scale: f64,
    /// The value of the surface in a volume; `None` of a mesh.
    pub value: Option<f64>,
    /// The side of the value that is inside, where the scene says it; else the file does.
    pub inside: Option<Inside>,
    /// What was found in it, and mended.
    pub findings: Findings<3>,
    /// The solid.
    pub shape: Shape<3>,
}

impl BuiltMesh {
    /// Whether it is the same file at the same scale.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let numbers = |mesh: &Self| (mesh.scale.to_bits(), mesh.value.map(f64::to_bits));
        let is_same_side = self.inside == other.inside;
        self.file == other.file && numbers(self) == numbers(other) && is_same_side
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

/// The surface of a volume as a file gives it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub(crate) struct WrittenVolume {
    file: String,
    value: f64,
    #[serde(default = "one")]
    scale: f64,
    inside: Option<String>,
}

/// The surface of a file that a solid is within.
#[derive(Clone, Copy)]
struct Asked<'a> {
    /// The kind of file, for messages.
    what: &'a str,
    file: &'a str,
    scale: f64,
    value: Option<f64>,
    inside: Option<Inside>,
}

fn one() -> f64 {
    1.0
}

impl WrittenMesh {
    /// The solid of the file, which is looked for in `folder`.
    pub(crate) fn built(&self, folder: Option<&Path>) -> Result<BuiltMesh, Problem> {
        let read = |path: &Path| read_file(path).map_err(|error| error.to_string());
        let (file, scale) = (self.file.as_str(), self.scale);
        let asked = Asked { what: "a mesh", file, scale, value: None, inside: None };
        built(asked, folder, read)
    }
}

impl WrittenVolume {
    /// The solid within the surface, in the volume of a file, which is looked for in `folder`.
    pub(crate) fn built(&self, folder: Option<&Path>) -> Result<BuiltMesh, Problem> {
        let sides = Inside::ALL.map(|side| (side.name(), side));
        let inside = self.inside.as_deref().map(|name| named(name, "inside", sides));
        let inside = inside.transpose()?;
        let surface = |path: &Path| {
            let mut volume = Volume::open(path).map_err(|error| error.to_string())?;
            volume.inside = inside.unwrap_or(volume.inside);
            let surface = volume.surface(self.value);
            surface.map_err(|problem| format!("{}: {problem}", path.display()))
        };
        let (file, scale) = (self.file.as_str(), self.scale);
        let asked = Asked { what: "a volume", file, scale, value: Some(self.value), inside };
        built(asked, folder, surface)
    }
}

/// The solid of what `read` makes of a file.
fn built(
    Asked { what, file, scale, value, inside }: Asked<'_>,
    folder: Option<&Path>,
    read: impl FnOnce(&Path) -> Result<TriangleMesh, String>,
) -> Result<BuiltMesh, Problem> {
    if scale.is_nan() || scale <= 0.0 || scale.is_infinite() {
        return Err(Problem::new(format!("scale must be positive, got {scale}")).under("scale"));
    }
    let of_file = |message: String| Problem::new(message).under("file");
    let Beside { path, stamp } =
        Beside::of(what, file, folder).map_err(|problem| problem.under("file"))?;
    let key = (stamp, value.map(f64::to_bits), inside);
    let (shape, findings) = match SOLIDS.of(&key) {
        Some(known) => known,
        None => {
            let mesh = read(&path).map_err(of_file)?;
            let (solid, findings) = Solid::from_mesh(&mesh)
                .map_err(|error| of_file(format!("{}: {error}", path.display())))?;
            let (made, faces) = ((solid.into(), findings), mesh.elements().len());
            // Another state of the file is of no use any more.
            SOLIDS.keep(key.clone(), &made, faces, |(known, other, side)| {
                known.is_of_same_file(&key.0)
                    && (*known != key.0 || (*other, *side) == (key.1, key.2))
            });
            made
        }
    };
    let scaled = shape.scaled(scale);
    Ok(BuiltMesh {
        file: file.to_owned(),
        scale,
        value,
        inside,
        findings: findings.scaled(scale),
        shape: scaled.map_err(|error| Problem::new(error.to_string()).under("scale"))?,
    })
}
