// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Grids of a scene.

use std::path::Path;

use palpate_field::{Shape, Vector};
use palpate_grid::{Grid, GridError, GridKernel, GridOptions, Lattice, Resolution, Store};
use palpate_mesh::{MeshSheet, Solid};
use serde::{Deserialize, Serialize};

use crate::build::BuiltScene;
use crate::mesh_file::{Beside, Kept, Resources, Stamp};
use crate::problem::Problem;

/// The samples of all grids that are kept.
const MOST_SAMPLES: usize = 1 << 27;

/// The nodes of a grid that a scene bakes: more are made once, by a command, and read from a file.
const MOST_NODES: usize = 1 << 25;

pub(crate) static PLANAR: KeptGrids<2> = Kept::new(MOST_SAMPLES);
pub(crate) static SPATIAL: KeptGrids<3> = Kept::new(MOST_SAMPLES);

/// What a grid is made of.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Source<const D: usize> {
    File(Stamp),
    Shape(Shape<D>, GridOptions),
}

/// The grids that are kept.
pub(crate) type KeptGrids<const D: usize> = Kept<Source<D>, Shape<D>>;

/// A grid as a scene gives it: a file, or samples.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub(crate) struct WrittenGrid {
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    counts: Option<Vec<usize>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cell: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    origin: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    kernel: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    samples: Option<Vec<f64>>,
}

impl WrittenGrid {
    /// What a scene says of a grid of samples; `None` of one that samples alone do not make again.
    pub(crate) fn of<const D: usize>(grid: &Grid<D>) -> Option<Self> {
        let lattice = grid.lattice();
        let has_own_name = grid.kernel() != GridKernel::Quadratic;
        Some(Self {
            file: None,
            counts: Some(lattice.counts.to_vec()),
            cell: Some(lattice.cell),
            origin: Some(lattice.origin.0.to_vec()),
            kernel: has_own_name.then(|| grid.kernel().name().to_owned()),
            samples: Some(grid.samples()?),
        })
    }

    /// The grid; a file is looked for in `folder`.
    pub(crate) fn built<const D: usize>(
        &self,
        folder: Option<&Path>,
        kept: &KeptGrids<D>,
    ) -> Result<Shape<D>, Problem> {
        match self {
            Self {
                file: Some(file),
                counts: None,
                cell: None,
                origin: None,
                kernel: None,
                samples: None,
            } => of_file(file, folder, kept),
            Self {
                file: None,
                counts: Some(counts),
                cell: Some(cell),
                origin: Some(origin),
                kernel,
                samples: Some(samples),
            } => {
                let lattice = Lattice {
                    origin: Vector(along_axes(origin, "origin")?),
                    cell: *cell,
                    counts: along_axes(counts, "counts")?,
                };
                let kernel = match kernel {
                    None => GridKernel::Quadratic,
                    Some(name) => named(
                        name,
                        "kernel",
                        GridKernel::ALL.map(|kernel| (kernel.name(), kernel)),
                    )?,
                };
                let grid = Grid::from_samples(lattice, samples, kernel, Store::F32);
                grid.map(Shape::from).map_err(|error| Problem::new(error.to_string()))
            }
            _ => Err(Problem::new(
                "must have `file`, or `samples` with `counts`, `cell` and `origin`",
            )),
        }
    }
}

/// A number for each axis.
fn along_axes<T: Copy, const D: usize>(given: &[T], key: &str) -> Result<[T; D], Problem> {
    given.try_into().map_err(|_| {
        Problem::new(format!("must have {D} numbers, got {}", given.len())).under(key)
    })
}

/// The grid of a file.
fn of_file<const D: usize>(
    file: &str,
    folder: Option<&Path>,
    kept: &KeptGrids<D>,
) -> Result<Shape<D>, Problem> {
    let in_file = |problem: Problem| problem.under("file");
    let Beside { path, stamp } = Beside::of("a grid", file, folder).map_err(in_file)?;
    let source = Source::File(stamp.clone());
    if let Some(known) = kept.of(&source) {
        return Ok(known);
    }
    let grid =
        Grid::<D>::open(&path).map_err(|error| in_file(Problem::new(error.to_string())))?;
    let samples = grid.stored_samples();
    let shape = grid.into();
    kept.keep(
        source,
        &shape,
        samples,
        |known| matches!(known, Source::File(known) if known.is_of_same_file(&stamp)),
    );
    Ok(shape)
}

/// How a shape is baked, as a file gives it.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub(crate) struct WrittenBake {
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cell: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    kernel: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    store: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    band: Option<f64>,
}

impl WrittenBake {
    /// What a file says of these options.
    pub(crate) fn of(options: &GridOptions) -> Result<Self, Problem> {
        let own = GridOptions::with_resolution(options.resolution);
        if options.certified != own.certified {
            let message = format!(
                "files have no word for values certified to {} cells",
                options.certified
            );
            return Err(Problem::new(message));
        }
        let (tolerance, cell) = match options.resolution {
            Resolution::Tolerance(tolerance) => (Some(tolerance), None),
            Resolution::Cell(cell) => (None, Some(cell)),
        };
        let kernel = (options.kernel != own.kernel).then(|| options.kernel.name().to_owned());
        let store = (options.store != own.store).then(|| options.store.name().to_owned());
        Ok(Self { tolerance, cell, kernel, store, band: options.band })
    }

    fn options(&self) -> Result<GridOptions, Problem> {
        let resolution = match (self.tolerance, self.cell) {
            (Some(tolerance), None) => Resolution::Tolerance(tolerance),
            (None, Some(cell)) => Resolution::Cell(cell),
            _ => {
                let message = "bake takes either a tolerance [m] or the size of a cell [m]";
                return Err(Problem::new(message));
            }
        };
        let mut options =
            GridOptions { most_nodes: MOST_NODES, ..GridOptions::with_resolution(resolution) };
        if let Some(name) = &self.kernel {
            options.kernel =
                named(name, "kernel", GridKernel::ALL.map(|kernel| (kernel.name(), kernel)))?;
        }
        if let Some(name) = &self.store {
            options.store =
                named(name, "store", Store::ALL.map(|store| (store.name(), store)))?;
        }
        options.band = self.band;
        Ok(options)
    }

    /// Whether its numbers and names are good.
    pub(crate) fn check(&self) -> Result<(), Problem> {
        self.options().map(|_| ())
    }

    /// The grid of a shape.
    pub(crate) fn baked<const D: usize>(
        &self,
        shape: Shape<D>,
        kept: &KeptGrids<D>,
        resources: &Resources,
    ) -> Result<Shape<D>, Problem> {
        let source = Source::Shape(shape, self.options()?);
        if let Some(known) = kept.of(&source) {
            return Ok(known);
        }
        let Source::Shape(shape, options) = &source else { unreachable!("it was made above") };
        let grid = resources.bake(shape, options).map_err(|error| match error {
            GridError::Number(error) => Problem::of_shape(error),
            error => Problem::new(error.to_string()),
        })?;
        let samples = grid.stored_samples();
        let made = grid.into();
        kept.keep(source, &made, samples, |_| false);
        Ok(made)
    }
}

/// What a name stands for.
pub(crate) fn named<T: Copy, const N: usize>(
    name: &str,
    key: &str,
    known: [(&str, T); N],
) -> Result<T, Problem> {
    let found = known.iter().find(|(known, _)| *known == name);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names = known.map(|(known, _)| format!("{known:?}")).join(", ");
        Problem::new(format!("{key} must be one of {names}, got {name:?}")).under(key)
    })
}

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
