// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes of data: meshes beside parry's and those of Python packages, and grids.

mod beside;
mod bumpy;
mod grids;
mod meshes;
mod places;

use std::error::Error;

use palpate::mesh::TriangleMesh;

use crate::fields::Rows;
use crate::reference::Reference;

/// Questions of a run.
const QUESTIONS: usize = 1024;

/// All rows of the suite; those of peers of Python if they are asked for and there.
pub(crate) fn measure(peers: bool) -> Result<Rows, Box<dyn Error>> {
    let reference = Reference::new()?;
    let mesh = bumpy::mesh()?;
    let mut rows = Rows::new();
    eprintln!("measuring meshes …");
    meshes::measure(&mesh, &reference, &mut rows)?;
    eprintln!("measuring grids …");
    grids::measure(&mesh, &reference, &mut rows)?;
    if peers {
        beside::measure(&mesh, &mut rows)?;
    }
    Ok(rows)
}

/// The longest side of a mesh's box [m].
fn longest(mesh: &TriangleMesh) -> f64 {
    mesh.bounds().half_extents().0.into_iter().fold(0.0, f64::max) * 2.0
}

/// Adds the ratio of the times of two keys.
fn compare(rows: &mut Rows, [ours, theirs]: [&str; 2], key: &str) {
    if let Some((ours, theirs)) = rows.get(ours).zip(rows.get(theirs)) {
        let ratio = ours / theirs;
        rows.insert(key.to_owned(), ratio);
    }
}
