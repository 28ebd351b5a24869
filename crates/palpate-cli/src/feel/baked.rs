// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies of meshes, touched as grids.

use std::fmt::Write;

use palpate::scene::{BakedBody, BakedGrid, BuiltScene};
use serde::Serialize;

use crate::check::unit_hint;
use crate::feel::FeelOptions;
use crate::input::Bakes;
use crate::outcome::Failure;
use crate::output::{self, shown};
use palpate::scene::text::rounded;

/// The scene as it is touched, and its bodies of meshes; none with `--exact`.
pub(super) fn scene<const D: usize>(
    scene: &BuiltScene<D>,
    options: &FeelOptions,
) -> Result<(BuiltScene<D>, Vec<BakedBody>), Failure> {
    if options.exact {
        return Ok((scene.clone(), Vec::new()));
    }
    for mesh in &scene.meshes {
        if let (Some(file), Some(hint)) = (&mesh.file, unit_hint(mesh)) {
            output::remark(format_args!("{}: {hint}", shown(file)));
        }
    }
    if !scene.meshes.is_empty() {
        output::remark("meshes are sampled on grids first; --exact touches them as they are");
    }
    let bakes = Bakes::new(None);
    let baked = scene.meshes_baked(options.cell, &bakes.resources).map_err(Failure::input)?;
    Ok((baked.scene, baked.bodies))
}

/// A line for each body of meshes.
pub(super) fn write(out: &mut String, bodies: &[BakedBody]) -> std::fmt::Result {
    for BakedBody { name, grid, .. } in bodies {
        let name = shown(name);
        match grid {
            Ok(BakedGrid { cell, deviation, .. }) => writeln!(
                out,
                "  as a grid      {name}: cells of {} m, near the surface off the mesh's by at most {} m; \
                 --exact touches the mesh itself",
                rounded(*cell),
                rounded(*deviation),
            )?,
            Err(why) => writeln!(out, "  as a mesh      {name}: no grid was made, as {why}")?,
        }
    }
    Ok(())
}

/// A body of meshes, and the grid by which it is touched.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct AsGrid {
    /// The name of the body.
    name: String,
    /// The size of the grid's cells [m].
    cell: Option<f64>,
    /// How far its values are off the mesh's at most [m].
    deviation: Option<f64>,
    /// Why there is no grid.
    error: Option<String>,
}

impl From<&BakedBody> for AsGrid {
    fn from(BakedBody { name, grid, .. }: &BakedBody) -> Self {
        let (made, error) = (grid.as_ref().ok(), grid.as_ref().err());
        Self {
            name: name.clone(),
            cell: made.map(|grid| grid.cell),
            deviation: made.map(|grid| grid.deviation),
            error: error.map(ToString::to_string),
        }
    }
}
