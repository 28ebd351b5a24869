// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that hold meshes, as grids: for a servo, whose ticks must all be short.

use palpate_field::Shape;
use palpate_grid::{GridError, GridOptions};
use palpate_mesh::{MeshSheet, Solid};

use crate::build::BuiltScene;
use crate::resources::Resources;

/// Cells along the longest side of a body unless another size is asked for.
const CELLS: f64 = 128.0;

/// A body that holds a mesh, as it is touched.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct BakedBody {
    /// Its name.
    pub name: String,
    /// Its grid, or why it is touched as it is.
    pub grid: Result<BakedGrid, GridError>,
}

/// The grid of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BakedGrid {
    /// The size of its cells [m].
    pub cell: f64,
    /// How far its values are off those of the shape at most [m].
    pub deviation: f64,
}

/// A scene whose bodies that hold meshes are grids.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct MeshesBaked<const D: usize> {
    /// The scene.
    pub scene: BuiltScene<D>,
    /// The bodies that hold meshes, in the order of the scene.
    pub bodies: Vec<BakedBody>,
}

impl<const D: usize> BuiltScene<D> {
    /// The scene with each body that holds a mesh sampled on a grid: its distance and gradient then take the same
    /// short time everywhere, and the gradient is continuous. Cells are of a size [m], or a 128th of the longest
    /// side of each body. All samples are kept, without a band: beside fine cells a probe is so large that its centre would rest beyond the band.
    /// A body that makes no grid, or one of which no deviation is certified, stays as it is.
    ///
    /// # Errors
    ///
    /// If the progress of the resources stops the work, or the bodies make no union.
    pub fn meshes_baked(
        &self,
        cell: Option<f64>,
        resources: &Resources,
    ) -> Result<MeshesBaked<D>, GridError> {
        let (mut scene, mut bodies) = (self.clone(), Vec::new());
        for body in &mut scene.bodies {
            let kinds = [
                std::any::type_name::<Solid<3, 3>>(),
                std::any::type_name::<MeshSheet<3, 3>>(),
            ];
            if !kinds.iter().any(|kind| body.shape_in_body.holds(kind)) {
                continue;
            }
            let made = baked(&body.shape_in_body, cell, resources).and_then(|(grid, told)| {
                Ok((grid.clone().placed(&body.world_from_body)?, grid, told))
            });
            let grid = match made {
                Ok((placed, grid, told)) => {
                    (body.shape, body.shape_in_body) = (placed, grid);
                    Ok(told)
                }
                Err(GridError::Stopped) => return Err(GridError::Stopped),
                Err(error) => Err(error),
            };
            bodies.push(BakedBody { name: body.name.clone(), grid });
        }
        if !bodies.is_empty() {
            scene.whole = Shape::union(scene.bodies.iter().map(|body| body.shape.clone()))?;
        }
        Ok(MeshesBaked { scene, bodies })
    }
}

/// The grid of a body's shape, and what is told of it.
fn baked<const D: usize>(
    shape: &Shape<D>,
    cell: Option<f64>,
    resources: &Resources,
) -> Result<(Shape<D>, BakedGrid), GridError> {
    let bounds = shape.promise().bounds.ok_or(GridError::Unbounded)?.aabb;
    let longest = bounds.half_extents().0.into_iter().fold(0.0, f64::max) * 2.0;
    let options = GridOptions::with_cell(cell.unwrap_or(longest / CELLS));
    let grid = resources.bake(shape, &options)?;
    let (cell, deviation) = (grid.lattice().cell, grid.deviation());
    if deviation.is_infinite() {
        return Err(GridError::Unknown { cell });
    }
    Ok((grid.into(), BakedGrid { cell, deviation }))
}
