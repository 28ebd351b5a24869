// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What must hold for the mesh of a shape, whatever it is.

use arbitrary::{Result, Unstructured};
use palpate_mesh::{ContourError, ContourOptions, Solid, TriangleMesh};
use palpate_testkit::arbitrary::tree;

/// Meshes a tree of at most `depth` in cells of which its box has up to `most` along its longest side, and
/// says what is wrong with the mesh, or whether there is one.
pub fn check(
    u: &mut Unstructured<'_>,
    depth: usize,
    most: u32,
) -> Result<std::result::Result<bool, String>> {
    let Ok(shape) = tree::<3>(u, depth)?.shape() else { return Ok(Ok(false)) };
    let promise = shape.promise();
    let Some(bounds) = promise.bounds else { return Ok(Ok(false)) };
    let longest = bounds.aabb.half_extents().0.into_iter().fold(0.0, f64::max) * 2.0;
    let cells = f64::from(u.int_in_range(2..=most)?) + 0.3;
    let cell = longest / cells;
    let mesh = match TriangleMesh::of_shape(&shape, &ContourOptions::with_cell(cell)) {
        Ok(mesh) => mesh,
        Err(ContourError::NoSurface { .. } | ContourError::Cell { .. }) => {
            return Ok(Ok(false));
        }
        Err(error) => return Ok(Err(error.to_string())),
    };
    let report = mesh.report();
    if !report.is_watertight() {
        return Ok(Err(report.to_string()));
    }
    match Solid::from_mesh(&mesh) {
        Ok((_, findings)) if findings.crossings == 0 => {}
        Ok((_, findings)) => return Ok(Err(findings.to_string())),
        Err(error) => return Ok(Err(error.to_string())),
    }
    // A vertex is in a cell at whose corners the field has both signs.
    let most = promise.lipschitz * 3.0_f64.sqrt() * cell;
    for vertex in mesh.vertices() {
        let rounding = promise.rounding.within(vertex.norm());
        let value = shape.distance(*vertex);
        // Written so that NaN is too far.
        let is_near = value.abs() <= most * (1.0 + 1e-9) + 2.0 * rounding;
        if !is_near {
            return Ok(Err(format!("{value} at the vertex {vertex:?}, with cells of {cell}")));
        }
    }
    Ok(Ok(true))
}
